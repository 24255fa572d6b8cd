#include "hemi/pipeline/checkpoint.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/ranks.hpp"
#include "hemi/core/text.hpp"
#include "hemi/pipeline/observer.hpp"
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

void RowCheckpoint::tell_reused(std::size_t rows, Observer& observer) const {
    if (reused_ > 0) {
        observer.note(fmt::format("{} of {} taken from the checkpoint {}", count_text(reused_),
                                  plural(rows, "row", "rows"), path().string()));
    }
}

void RowCheckpoint::append(const RowBlock& block, std::span<const std::uint8_t> marks, Observer& observer) {
    try {
        file_->append(block, marks);
    } catch (const IoError& error) {
        observer.warning(fmt::format("{}; this run cannot be resumed", error.what()), {});
    }
}

} // namespace hemi
