#include "hemi/core/row_memory.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <new>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace hemi {

namespace {

/// Memory that lies in a file without a name. Every piece is a mapping of its own, so that there must be few:
/// a pool deals them out.
class FileMemory final : public std::pmr::memory_resource {
public:
    explicit FileMemory(const std::filesystem::path& folder) : folder_(folder) {
        file_ = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
        if (file_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
            std::string name = (folder / "hemi-rows-XXXXXX").string();
            file_ = mkostemp(name.data(), O_CLOEXEC);
            if (file_ >= 0) {
                unlink(name.c_str());
            }
        }
        if (file_ < 0) {
            throw InputError(fmt::format("{}: no file of rows can be made there: {}", folder.string(),
                                         std::strerror(errno)));
        }
    }
    ~FileMemory() override { close(file_); }
    FileMemory(const FileMemory&) = delete;
    FileMemory& operator=(const FileMemory&) = delete;

private:
    void* do_allocate(std::size_t bytes, std::size_t /*alignment*/) override {
        const std::lock_guard lock(mutex_);
        const std::size_t size = pages(bytes);
        // Room that is only promised would end the process when it is used.
        if (const int failed = posix_fallocate(file_, end_, static_cast<off_t>(size)); failed != 0) {
            throw OutOfMemory(fmt::format("{}: no room for {} more of rows, beside {} that are there: {}",
                                          folder_.string(), memory_text(size),
                                          memory_text(static_cast<std::uint64_t>(end_)),
                                          std::strerror(failed)),
                              {"scratch"});
        }
        void* const data = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file_, end_);
        if (data == MAP_FAILED) {
            throw std::bad_alloc();
        }
        places_[data] = end_;
        end_ += static_cast<off_t>(size);
        return data;
    }
    void do_deallocate(void* data, std::size_t bytes, std::size_t /*alignment*/) override {
        const std::lock_guard lock(mutex_);
        const std::size_t size = pages(bytes);
        munmap(data, size);
        const auto place = places_.extract(data);
        // Where the file system cannot, the room is taken until the end.
        (void)fallocate(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, place.mapped(),
                        static_cast<off_t>(size));
    }
    [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
        return this == &other;
    }

    static std::size_t pages(std::size_t bytes) {
        static const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        return (bytes + page - 1) / page * page;
    }

    std::filesystem::path folder_;
    int file_ = -1;
    off_t end_ = 0;
    std::map<void*, off_t> places_; ///< in the file
    std::mutex mutex_;
};

/// Pieces of a file of all sizes.
class RowFile {
public:
    explicit RowFile(const std::filesystem::path& folder)
        : memory_(folder), pool_({most_blocks, 0}, &memory_) {}
    [[nodiscard]] std::pmr::memory_resource& pool() { return pool_; }

private:
    static constexpr std::size_t most_blocks = 512; ///< that the pool asks for at once

    FileMemory memory_;
    std::pmr::synchronized_pool_resource pool_;
};

/// Of the process; null: there is none. Never taken down, since arrays may outlive all else.
std::atomic<std::pmr::memory_resource*> row_file{nullptr};

} // namespace

void keep_rows_in(const std::filesystem::path& folder) {
    row_file.store(&(new RowFile(folder))->pool());
}

bool rows_are_in_file() noexcept {
    return row_file.load(std::memory_order_relaxed) != nullptr;
}

std::pmr::memory_resource* row_memory() noexcept {
    std::pmr::memory_resource* const file = row_file.load(std::memory_order_relaxed);
    return file != nullptr ? file : std::pmr::new_delete_resource();
}

} // namespace hemi
