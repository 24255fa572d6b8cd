#include "hemi/pipeline/checkpoint.hpp"

#include "io/factors/checkpoint_file.hpp"

namespace hemi {

RowCheckpoint::RowCheckpoint(const std::filesystem::path& output, bool resume)
    : file_(std::make_unique<io::CheckpointFile>(output, resume)) {}

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
