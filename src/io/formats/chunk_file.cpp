#include "io/formats/chunk_file.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cerrno>

namespace hemi::io {

static_assert(std::endian::native == std::endian::little, "chunk files are little endian; swap bytes here");

namespace {

constexpr std::string_view end_tag = "END ";
constexpr std::uint64_t alignment = 8;

struct ChunkHeader {
    std::array<char, 4> tag{};
    std::uint32_t crc = 0;
    std::uint64_t length = 0;

    [[nodiscard]] std::string_view name() const { return {tag.data(), tag.size()}; }
};
static_assert(sizeof(ChunkHeader) == 16);

std::uint64_t padding(std::uint64_t length) {
    return (alignment - length % alignment) % alignment;
}

std::uint32_t add_crc(std::uint32_t crc, std::span<const std::byte> bytes) {
    return static_cast<std::uint32_t>(
        crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::uint32_t header_crc(const ChunkHeader& header) {
    return add_crc(add_crc(0, std::as_bytes(std::span(header.tag))), bytes_of(header.length));
}

} // namespace

void write_start(const ByteSink& sink, const ChunkFormat& format) {
    sink(format.magic.data(), format.magic.size());
    const std::array<std::uint32_t, 2> version{format.version, 0};
    sink(version.data(), sizeof version);
}

void write_chunk(const ByteSink& sink, std::string_view tag,
                 std::initializer_list<std::span<const std::byte>> parts) {
    ChunkHeader header;
    tag.copy(header.tag.data(), header.tag.size());
    for (const auto& part : parts) {
        header.length += part.size();
    }
    header.crc = header_crc(header);
    for (const auto& part : parts) {
        if (!part.empty()) {
            header.crc = add_crc(header.crc, part);
        }
    }
    sink(&header, sizeof header);
    for (const auto& part : parts) {
        sink(part.data(), part.size());
    }
    constexpr std::array<char, alignment> zeros{};
    sink(zeros.data(), padding(header.length));
}

ChunkWriter::ChunkWriter(const std::filesystem::path& path, const ChunkFormat& format)
    : file_(path), sink_([this](const void* data, std::size_t bytes) { file_.write(data, bytes); }) {
    write_start(sink_, format);
}

void ChunkWriter::chunk(std::string_view tag, std::initializer_list<std::span<const std::byte>> parts) {
    write_chunk(sink_, tag, parts);
}

void ChunkWriter::finish() {
    chunk(end_tag, {});
    file_.commit();
}

void Payload::expect_end() const {
    if (left() != 0) {
        fail(fmt::format("{} bytes too many", left()));
    }
}

void Payload::fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}", place_, message));
}

void Payload::fail_short() const {
    fail("shorter than its own counts say");
}

ChunkReader::ChunkReader(const std::filesystem::path& path, const ChunkFormat& format)
    : file_(path.string()), stream_(nullptr, &std::fclose) {
    std::error_code error;
    size_ = std::filesystem::file_size(path, error);
    if (error) {
        fail(fmt::format("cannot be read: {}", error.message()));
    }
    stream_.reset(std::fopen(path.c_str(), "rbe"));
    if (!stream_) {
        fail(fmt::format("cannot be read: {}", std::strerror(errno)));
    }
    std::string magic(format.magic.size(), '\0');
    if (size_ < magic.size() + 8) {
        fail(fmt::format("{} bytes; too short for {}", size_, format.meaning));
    }
    read(magic.data(), magic.size());
    if (magic != format.magic) {
        fail(fmt::format("does not hold {}: it starts with {}, not {}", format.meaning, in_quotes(magic),
                         in_quotes(format.magic)));
    }
    std::array<std::uint32_t, 2> version{};
    read(version.data(), sizeof version);
    if (version[0] != format.version || version[1] != 0) {
        fail(fmt::format("version {} of {}; this program reads version {}", version[0], format.meaning,
                         format.version));
    }
}

Payload ChunkReader::chunk(std::string_view tag) {
    stop_if_interrupted();
    ChunkHeader header;
    if (size_ - position_ < sizeof header) {
        fail(fmt::format("cut short: chunk {} is missing at byte {}", trim(tag), position_));
    }
    const std::uint64_t start = position_;
    read(&header, sizeof header);
    if (header.name() != tag) {
        fail(
            fmt::format("chunk {} at byte {}, where {} must be", in_quotes(header.name()), start, trim(tag)));
    }
    const std::uint64_t left = size_ - position_;
    if (header.length > left || padding(header.length) > left - header.length) {
        fail(fmt::format("cut short: chunk {} at byte {} says it has {} bytes, the file has {} more",
                         trim(tag), start, header.length, left));
    }
    std::string bytes(header.length, '\0');
    read(bytes.data(), bytes.size());
    if (add_crc(header_crc(header), bytes_of(bytes)) != header.crc) {
        fail(fmt::format("damaged: the checksum of chunk {} at byte {} does not match", trim(tag), start));
    }
    std::array<char, alignment> zeros{};
    read(zeros.data(), padding(header.length));
    if (zeros != std::array<char, alignment>{}) {
        fail(fmt::format("damaged: bytes other than 0 after chunk {} at byte {}", trim(tag), start));
    }
    return {std::move(bytes), fmt::format("{}: chunk {}", file_, trim(tag))};
}

void ChunkReader::finish() {
    chunk(end_tag).expect_end();
    if (position_ != size_) {
        fail(fmt::format("{} bytes after the end", size_ - position_));
    }
}

void ChunkReader::fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}", file_, message));
}

void ChunkReader::read(void* to, std::size_t bytes) {
    if (bytes != 0 && std::fread(to, 1, bytes, stream_.get()) != bytes) {
        fail(fmt::format("cannot be read at byte {}", position_));
    }
    position_ += bytes;
}

} // namespace hemi::io
