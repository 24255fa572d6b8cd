#include "io/formats/zip_writer.hpp"

#include <zlib.h>

namespace hemi::io {

namespace {

// Values of PKWARE's APPNOTE.TXT 6.3; "all ones" sends a reader to the 64-bit field.
constexpr std::uint16_t version_zip64 = 45;
constexpr std::uint16_t ones16 = 0xFFFF;
constexpr std::uint32_t ones32 = 0xFFFFFFFF;
constexpr std::uint16_t first_of_1980 = 0x21; // no clock: equal content, equal bytes

/// Little-endian fields one after another.
class Record {
public:
    Record& u16(std::uint16_t value) { return add(value, 2); }
    Record& u32(std::uint32_t value) { return add(value, 4); }
    Record& u64(std::uint64_t value) { return add(value, 8); }
    Record& text(const std::string& value) {
        bytes_ += value;
        return *this;
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    Record& add(std::uint64_t value, int bytes) {
        for (int k = 0; k < bytes; ++k) {
            bytes_ += static_cast<char>(value >> (8 * k) & 0xFF);
        }
        return *this;
    }

    std::string bytes_;
};

} // namespace

void ZipWriter::add(const std::string& name, const Source& source) {
    Member member{name, 0, 0, position_};
    source([&member](std::span<const std::byte> bytes) {
        if (!bytes.empty()) {
            member.crc = static_cast<std::uint32_t>(
                crc32_z(member.crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
        }
        member.size += bytes.size();
    });
    Record record;
    record.u32(0x04034B50).u16(version_zip64).u16(0).u16(0).u16(0).u16(first_of_1980);
    record.u32(member.crc).u32(ones32).u32(ones32);
    record.u16(static_cast<std::uint16_t>(name.size())).u16(20).text(name);
    record.u16(1).u16(16).u64(member.size).u64(member.size);
    write(record.bytes());
    source([this](std::span<const std::byte> bytes) { file_.write(bytes.data(), bytes.size()); });
    position_ += member.size;
    members_.push_back(std::move(member));
}

void ZipWriter::finish() {
    const std::uint64_t start = position_;
    for (const Member& member : members_) {
        Record record;
        record.u32(0x02014B50).u16(version_zip64).u16(version_zip64).u16(0).u16(0).u16(0).u16(first_of_1980);
        record.u32(member.crc).u32(ones32).u32(ones32);
        record.u16(static_cast<std::uint16_t>(member.name.size()))
            .u16(28)
            .u16(0)
            .u16(0)
            .u16(0)
            .u32(0)
            .u32(ones32);
        record.text(member.name).u16(1).u16(24).u64(member.size).u64(member.size).u64(member.offset);
        write(record.bytes());
    }
    const std::uint64_t end = position_;
    Record record;
    record.u32(0x06064B50).u64(44).u16(version_zip64).u16(version_zip64).u32(0).u32(0);
    record.u64(members_.size()).u64(members_.size()).u64(end - start).u64(start);
    record.u32(0x07064B50).u32(0).u64(end).u32(1);
    record.u32(0x06054B50).u16(0).u16(0).u16(ones16).u16(ones16).u32(ones32).u32(ones32).u16(0);
    write(record.bytes());
}

void ZipWriter::write(const std::string& bytes) {
    file_.write(bytes);
    position_ += bytes.size();
}

} // namespace hemi::io
