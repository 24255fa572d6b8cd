#include "io/factors/checkpoint_file.hpp"

#include "hemi/core/error.hpp"
#include "io/factors/row_block_chunk.hpp"
#include "io/formats/chunk_file.hpp"
#include "io/formats/json_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace hemi::io {

namespace {

constexpr ChunkFormat checkpoint_format{"HEMIROW\n", 1, "rows of an unfinished run (.rows)"};

/// Whether a file starts as a checkpoint does, as far as it goes.
bool is_checkpoint(int descriptor) {
    std::string start(checkpoint_format.magic.size(), '\0');
    const ssize_t got = ::pread(descriptor, start.data(), start.size(), 0);
    return got >= 0 && checkpoint_format.magic.starts_with(start.substr(0, static_cast<std::size_t>(got)));
}

CheckpointKey read_key(ChunkReader& reader) {
    const Json document = parse_json(reader.chunk("HEAD").text(), reader.file());
    const JsonNode head(document, reader.file());
    CheckpointKey key;
    for (const auto& [name, value] : document.items()) {
        key[name] = head.member(name).any_text();
    }
    return key;
}

/// Marks of the rows of the next block.
std::vector<std::uint8_t> next_marks(ChunkReader& reader) {
    Payload payload = reader.chunk("MARK");
    std::vector<std::uint8_t> marks = payload.take_array<std::uint8_t>(payload.left());
    if (std::any_of(marks.begin(), marks.end(), [](std::uint8_t mark) { return mark > 1; })) {
        payload.fail("marks other than 0 and 1");
    }
    return marks;
}

/// Puts the next block into `rows` if it is sound and none of its known rows was there before.
/// @param marks  gets those of its rows, where there are clusters
/// @return these rows, ascending
std::vector<std::uint32_t> next_block(ChunkReader& reader, FormFactorMatrix& rows,
                                      std::vector<std::uint8_t>& marks, std::vector<bool>& seen) {
    std::vector<std::uint32_t> known;
    try {
        if (rows.clusters() != nullptr) {
            marks = next_marks(reader);
        }
        Payload payload = reader.chunk("ROWS");
        RowBlock block = take_row_block(payload);
        for (std::uint32_t r = 0; r < block.rows(); ++r) {
            if (block.known[r] != 0) {
                known.push_back(block.first_row + r);
            }
        }
        if (rows.clusters() != nullptr &&
            (marks.size() != block.rows() || block.visibility.size() != block.columns.size())) {
            return {};
        }
        rows.set_block(std::move(block));
    } catch (const InputError&) {
        return {};
    } catch (const InvalidArgument&) {
        return {};
    }
    if (std::any_of(known.begin(), known.end(), [&seen](std::uint32_t row) { return seen[row]; })) {
        return {};
    }
    for (const std::uint32_t row : known) {
        seen[row] = true;
    }
    return known;
}

/// Sets the block that a row is in back to unknown rows.
void forget(FormFactorMatrix& rows, std::uint32_t row) {
    const std::uint32_t first = row - row % FormFactorMatrix::block_rows;
    const std::size_t count = std::min(FormFactorMatrix::block_rows, rows.size() - first);
    RowBlock unknown;
    unknown.first_row = first;
    unknown.begin.assign(count + 1, 0);
    unknown.environment.assign(count, 0.0);
    unknown.blocked.assign(count, 0.0);
    unknown.known.assign(count, 0);
    rows.set_block(std::move(unknown));
}

} // namespace

std::optional<KeyDifference> difference(const CheckpointKey& here, const CheckpointKey& there) {
    const auto value = [](const CheckpointKey& key, const std::string& name) {
        const auto found = key.find(name);
        return found == key.end() ? "nothing" : found->second;
    };
    std::vector<std::string> names{kind_of_rows}; // on which the names that there are, and others, depend
    for (const CheckpointKey* const key : {&here, &there}) {
        for (const auto& [name, _] : *key) {
            names.push_back(name);
        }
    }
    std::sort(names.begin() + 1, names.end());
    for (const std::string& name : names) {
        if (value(here, name) != value(there, name)) {
            return KeyDifference{name, value(here, name), value(there, name)};
        }
    }
    return std::nullopt;
}

CheckpointFile::CheckpointFile(const std::filesystem::path& output, bool resume) : path_(output) {
    path_ += ".rows";
    const auto leave_alone = [&](const std::string& why) {
        usable_ = false;
        if (descriptor_ >= 0) {
            ::close(std::exchange(descriptor_, -1));
        }
        if (resume) {
            throw IoError(fmt::format("{}: {}; nothing can be resumed", path_.string(), why));
        }
    };
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor_ < 0) {
        if (errno != ENOENT) {
            leave_alone(std::strerror(errno));
        }
        return;
    }
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode) || !is_checkpoint(descriptor_)) {
        leave_alone("is there and holds no rows of an unfinished run");
    } else if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        leave_alone("another run is writing to it");
    } else if (!resume) {
        remove();
        usable_ = true;
    }
}

CheckpointFile::~CheckpointFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

void CheckpointFile::start(const CheckpointKey& key, FormFactorMatrix rows, const EachRow& each) {
    key_ = key;
    if (descriptor_ < 0) {
        return;
    }
    std::uint64_t sound = 0;
    std::optional<ChunkReader> reader;
    std::optional<CheckpointKey> stored;
    try {
        stored = read_key(reader.emplace(path_, checkpoint_format));
    } catch (const InputError&) { // it was killed before there was a row
    }
    if (stored) {
        if (const auto found = difference(key, *stored)) {
            throw InputError(fmt::format("{}: this checkpoint holds rows of another run: {} {}, here {}; do "
                                         "not resume from it, and it is replaced",
                                         path_.string(), found->name, found->there, found->here),
                             {"resume"});
        }
        std::vector<bool> seen(rows.size(), false);
        std::vector<std::uint8_t> marks;
        for (;;) {
            sound = reader->position();
            const std::vector<std::uint32_t> known = next_block(*reader, rows, marks, seen);
            if (known.empty()) { // cut short, or damaged: from here on nothing is certain
                break;
            }
            for (const std::uint32_t patch : known) {
                each(patch, rows.row(patch),
                     !marks.empty() && marks[patch % FormFactorMatrix::block_rows] != 0);
            }
            rows_ += known.size();
            forget(rows, known[0]);
        }
    }
    if (sound == 0) {
        remove();
        usable_ = true;
        return;
    }
    if (::ftruncate(descriptor_, static_cast<off_t>(sound)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0) {
        give_up(errno);
    }
}

void CheckpointFile::append(const RowBlock& block, std::span<const std::uint8_t> marks) {
    if (!usable_) {
        return;
    }
    const ByteSink sink = [this](const void* data, std::size_t bytes) { write(data, bytes); };
    if (descriptor_ < 0) {
        descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor_ < 0) {
            usable_ = errno == EEXIST ? false : usable_; // another run of the same command was faster
            if (!usable_) {
                return;
            }
            give_up(errno);
        }
        ::flock(descriptor_, LOCK_EX);
        write_start(sink, checkpoint_format);
        const std::string head = json_text(Json(key_));
        write_chunk(sink, "HEAD", {bytes_of(head)});
    }
    if (!marks.empty()) {
        write_chunk(sink, "MARK", {std::as_bytes(marks)});
    }
    write_row_block(sink, "ROWS", block);
    // The disk begins now, while rows are computed, and not when the output is made safe, which would wait
    // for all of this too. What is on the disk need not stay in memory.
    ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_DONTNEED);
    rows_ += static_cast<std::uint64_t>(std::count(block.known.begin(), block.known.end(), 1));
}

void CheckpointFile::remove() noexcept {
    if (descriptor_ >= 0) {
        ::unlink(path_.c_str());
        ::close(std::exchange(descriptor_, -1));
    }
    rows_ = 0;
    usable_ = false;
}

void CheckpointFile::start_over() noexcept {
    const bool usable = usable_;
    remove();
    usable_ = usable;
}

void CheckpointFile::write(const void* data, std::size_t bytes) {
    const auto* from = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t written = ::write(descriptor_, from, bytes);
        if (written < 0 && errno != EINTR) {
            give_up(errno);
        }
        if (written > 0) {
            from += written;
            bytes -= static_cast<std::size_t>(written);
        }
    }
}

void CheckpointFile::give_up(int error) {
    remove();
    throw IoError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(error)));
}

} // namespace hemi::io
