#include "hemi/pipeline/checkpoint.hpp"

#include "hemi/core/ranks.hpp"
#include "io/factors/checkpoint_file.hpp"

#include <fmt/format.h>

namespace hemi {

namespace {

/// Every rank keeps its own rows.
std::filesystem::path output_of_rank(std::filesystem::path output) {
    if (ranks().size() > 1) {
        output += fmt::format(".{}of{}", ranks().rank() + 1, ranks().size());
    }
    return output;
}

} // namespace

RowCheckpoint::RowCheckpoint(const std::filesystem::path& output, bool resume)
    : file_(std::make_unique<io::CheckpointFile>(output_of_rank(output), resume)) {}

RowCheckpoint::~RowCheckpoint() = default;

const std::filesystem::path& RowCheckpoint::path() const {
    return file_->path();
}

std::uint64_t RowCheckpoint::rows() const {
    return file_->rows();
}

void RowCheckpoint::discard() noexcept {
    file_->remove();
}

void RowCheckpoint::start_over() noexcept {
    file_->start_over();
    reused_ = 0;
}

} // namespace hemi
