#include "hemi/io/output_file.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "hemi/core/ranks.hpp"

#include <algorithm>
#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <tuple>
#include <unistd.h>
#include <utility>

namespace hemi::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, int error) {
    throw IoError(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(error)));
}

/// What the names of temporary files of `path` begin with; a number and ".tmp" follow. Names may have 255
/// bytes: that leaves room for what is added.
std::string temporary_prefix(const fs::path& path) {
    return fmt::format(".{}.", path.filename().string().substr(0, 200));
}

/// A new file beside `path`, opened for writing and locked: a lock goes when its process does, however that
/// ends, so that what is left behind can be told from what is being written.
std::pair<int, fs::path> open_beside(const fs::path& path, mode_t mode) {
    for (int attempt = 0;; ++attempt) {
        const std::string number = attempt == 0 ? "" : fmt::format(".{}", attempt);
        fs::path temporary =
            path.parent_path() / fmt::format("{}{}{}.tmp", temporary_prefix(path), ::getpid(), number);
        const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (descriptor >= 0) {
            ::flock(descriptor, LOCK_EX); // not every file system can; nothing is removed there
            struct stat status {};
            if (::fstat(descriptor, &status) == 0 && status.st_nlink > 0) {
                return {descriptor, std::move(temporary)};
            }
            ::close(descriptor); // another run took it for left behind, before it was locked
        } else if (errno != EEXIST || attempt >= 100) {
            fail(path, errno);
        }
    }
}

/// Removes temporary files of `path` that a run left which was killed while it wrote.
void remove_left_behind(const fs::path& path) {
    const std::string prefix = temporary_prefix(path);
    std::error_code ignored;
    const fs::path directory = path.has_parent_path() ? path.parent_path() : fs::path(".");
    for (fs::directory_iterator entry(directory, ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
        const std::string name = entry->path().filename().string();
        if (name.size() <= prefix.size() + 4 || !name.starts_with(prefix) || !name.ends_with(".tmp") ||
            name.find_first_not_of("0123456789.", prefix.size()) != name.size() - 3) {
            continue;
        }
        const int descriptor = ::open(entry->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (descriptor >= 0) {
            if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
                ::unlink(entry->path().c_str());
            }
            ::close(descriptor);
        }
    }
}

/// Makes what was written last. False with errno if that failed.
bool sync(int descriptor) {
    // Not every file system can sync every kind of file; that is not a failed write.
    return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

/// Makes new names in a directory last, as far as that can be done.
void sync_directory(const fs::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0) {
        sync(descriptor);
        ::close(descriptor);
    }
}

/// Bytes of memory of the machine.
std::uint64_t physical_memory() {
    return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

} // namespace

OutputFile::OutputFile(fs::path path) : path_(std::move(path)) {
    if (ranks().rank() > 0) { // all have the same to write
        stream_ = std::fopen("/dev/null", "wbe");
        if (stream_ == nullptr) {
            fail(path_, errno);
        }
        return;
    }
    if (path_ == "-") {
        stream_ = stdout;
        return;
    }
    std::error_code ignored;
    if (fs::is_symlink(path_, ignored) && fs::exists(path_, ignored)) {
        fs::path target = fs::canonical(path_, ignored); // write to what the link names, keep the link
        if (!target.empty()) {                           // pipes have no such name
            path_ = std::move(target);
        }
    }
    struct stat status {};
    const bool exists = ::stat(path_.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) {
        fail(path_, EISDIR);
    }
    if (path_.filename().empty()) {
        fail(path_, path_.empty() ? ENOENT : EISDIR);
    }
    if (exists && ::access(path_.c_str(), W_OK) != 0) {
        fail(path_, errno);
    }
    if (exists && !S_ISREG(status.st_mode)) {
        stream_ = std::fopen(path_.c_str(), "wbe"); // a device or pipe must not be replaced by a file
        if (stream_ == nullptr) {
            fail(path_, errno);
        }
        return;
    }
    remove_left_behind(path_);
    std::tie(lock_, temporary_) = open_beside(path_, 0666);
    if (exists) {
        ::fchmod(lock_, status.st_mode & 07777);
    }
    const int descriptor = ::fcntl(lock_, F_DUPFD_CLOEXEC, 0); // the lock must outlive the stream
    stream_ = descriptor < 0 ? nullptr : ::fdopen(descriptor, "wb");
    if (stream_ == nullptr) {
        const int error = errno;
        ::close(descriptor);
        release();
        fail(path_, error);
    }
}

OutputFile::~OutputFile() {
    if (stream_ != nullptr && stream_ != stdout) {
        std::fclose(stream_);
    }
    release();
}

void OutputFile::release() noexcept {
    if (!temporary_.empty()) {
        ::unlink(temporary_.c_str());
        temporary_.clear();
    }
    if (lock_ >= 0) {
        ::close(std::exchange(lock_, -1));
    }
}

void OutputFile::write(std::string_view text) {
    write(text.data(), text.size());
}

void OutputFile::write(const void* data, std::size_t bytes) {
    if (stream_ == nullptr) {
        throw InvalidArgument(path_.string() + ": written to after it was complete");
    }
    constexpr std::size_t at_once = std::size_t{1} << 24;
    const auto* from = static_cast<const char*>(data);
    for (std::size_t done = 0; done < bytes; done += at_once) {
        stop_if_interrupted();
        const std::size_t part = std::min(at_once, bytes - done);
        if (std::fwrite(from + done, 1, part, stream_) != part) {
            fail(path_, errno);
        }
    }
}

void OutputFile::commit() {
    if (stream_ == nullptr) {
        return;
    }
    if (std::fflush(stream_) != 0) {
        fail(path_, errno);
    }
    if (stream_ == stdout) {
        stream_ = nullptr;
        return;
    }
    if (std::fclose(std::exchange(stream_, nullptr)) != 0) {
        fail(path_, errno);
    }
    if (temporary_.empty()) {
        return;
    }
    if (!sync(lock_) || std::rename(temporary_.c_str(), path_.c_str()) != 0) {
        fail(path_, errno);
    }
    temporary_.clear(); // it has the final name now
    release();
    sync_directory(path_.has_parent_path() ? path_.parent_path() : fs::path("."));
}

std::string read_file(const fs::path& path) {
    const auto refuse = [&path](int error) {
        throw InputError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(error)));
    };
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
        refuse(EISDIR);
    }
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(path.c_str(), "rbe"), &std::fclose);
    if (!stream) {
        refuse(errno);
    }
    std::string text;
    const auto size = fs::file_size(path, ignored);
    if (!ignored && size > physical_memory()) {
        throw InputError(fmt::format("{}: {} bytes; this machine has {} bytes of memory", path.string(), size,
                                     physical_memory()));
    }
    std::size_t used = 0;
    text.resize(ignored ? 0 : size + 1); // one more, to see the end
    for (;;) {
        if (used == text.size()) {
            text.resize(used + used / 2 + 65536); // what has no size: pipes, /proc
        }
        const std::size_t got = std::fread(text.data() + used, 1, text.size() - used, stream.get());
        used += got;
        if (got == 0) {
            break;
        }
    }
    if (std::ferror(stream.get()) != 0) {
        refuse(errno);
    }
    text.resize(used);
    return text;
}

} // namespace hemi::io
