#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

[[nodiscard]] std::size_t size_of(PlyType type) noexcept;
[[nodiscard]] bool is_integer(PlyType type) noexcept;

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::f32; ///< of the value, or of every value of a list
    bool is_list = false;
    PlyType count_type = PlyType::u8; ///< of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// Index of the property of that name, or properties.size().
    [[nodiscard]] std::size_t find(std::string_view property) const;
    /// Fewest bytes that one of these takes in a binary file.
    [[nodiscard]] std::size_t least_bytes() const;
};

/// What a PLY file says of itself before its data.
struct PlyHeader {
    bool text = true;
    std::endian order = std::endian::little; ///< of a binary file
    std::vector<PlyElement> elements;        ///< in the order of their data
    std::size_t data = 0;                    ///< bytes before the data
    std::size_t lines = 0;                   ///< lines before the data
};

/// @param file  for messages
/// @throws ParseError with the line for what is not a PLY header
[[nodiscard]] PlyHeader read_ply_header(std::string_view bytes, const std::string& file);

} // namespace hemi::io
