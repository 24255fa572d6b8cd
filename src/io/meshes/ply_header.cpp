#include "io/meshes/ply_header.hpp"

#include "hemi/core/error.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::array<std::pair<std::string_view, PlyType>, 16> type_names{{
    {"char", PlyType::i8},
    {"uchar", PlyType::u8},
    {"short", PlyType::i16},
    {"ushort", PlyType::u16},
    {"int", PlyType::i32},
    {"uint", PlyType::u32},
    {"float", PlyType::f32},
    {"double", PlyType::f64},
    {"int8", PlyType::i8},
    {"uint8", PlyType::u8},
    {"int16", PlyType::i16},
    {"uint16", PlyType::u16},
    {"int32", PlyType::i32},
    {"uint32", PlyType::u32},
    {"float32", PlyType::f32},
    {"float64", PlyType::f64},
}};

class HeaderReader {
public:
    HeaderReader(std::string_view bytes, const std::string& file)
        : bytes_(bytes), file_(file), lines_(bytes) {}

    PlyHeader read() {
        if (!lines_.next(line_) || trim(line_) != "ply") {
            throw ParseError(file_, 1, 0, fmt::format("{}; a PLY file begins with ply", in_quotes(line_)));
        }
        bool ended = false;
        bool has_format = false;
        while (!ended && lines_.next(line_)) {
            std::string_view rest = line_;
            const std::string_view word = next_word(rest);
            if (word == "format") {
                read_format(rest);
                has_format = true;
            } else if (word == "element") {
                read_element(rest);
            } else if (word == "property") {
                read_property(rest);
            } else if (word == "end_header") {
                ended = true;
            } else if (word != "comment" && word != "obj_info" && !word.empty()) {
                fail(fmt::format("{}; must be format, element, property, comment or end_header",
                                 in_quotes(word)));
            }
        }
        if (!ended || !has_format) {
            fail(ended ? "no format line before the end of the header" : "cut short: end_header is missing");
        }
        for (const PlyElement& element : header_.elements) {
            if (element.properties.empty() && element.count > 0) {
                fail(fmt::format("element {} has no properties", in_quotes(element.name)));
            }
        }
        header_.data = bytes_.size() - lines_.rest().size();
        header_.lines = lines_.number();
        if (!header_.text && bytes_[header_.data - 1] != '\n') {
            fail("line ends of CR alone; a binary file must have LF or CR LF");
        }
        return std::move(header_);
    }

private:
    void read_format(std::string_view rest) {
        const std::string_view format = next_word(rest);
        if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian") {
            fail(fmt::format("format {}; must be ascii, binary_little_endian or binary_big_endian",
                             in_quotes(format)));
        }
        if (trim(rest) != "1.0") {
            fail(fmt::format("version {}; must be 1.0", in_quotes(trim(rest))));
        }
        header_.text = format == "ascii";
        header_.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
    }

    void read_element(std::string_view rest) {
        PlyElement element;
        element.name = next_word(rest);
        const auto count = parse_integer<std::uint64_t>(trim(rest));
        if (element.name.empty() || !count) {
            fail(fmt::format("{}; must be element, its name and its count", in_quotes(line_)));
        }
        for (const PlyElement& other : header_.elements) {
            if (other.name == element.name) {
                fail(fmt::format("element {} is there twice", in_quotes(element.name)));
            }
        }
        element.count = *count;
        header_.elements.push_back(std::move(element));
    }

    void read_property(std::string_view rest) {
        if (header_.elements.empty()) {
            fail("a property before the first element");
        }
        PlyProperty property;
        std::string_view word = next_word(rest);
        if (word == "list") {
            property.is_list = true;
            property.count_type = type(next_word(rest));
            if (!is_integer(property.count_type)) {
                fail("a list's length must be of an integer type");
            }
            word = next_word(rest);
        }
        property.type = type(word);
        property.name = trim(rest);
        PlyElement& element = header_.elements.back();
        if (property.name.empty() || element.find(property.name) < element.properties.size()) {
            fail(property.name.empty() ? "a property without a name"
                                       : fmt::format("property {} is there twice", in_quotes(property.name)));
        }
        element.properties.push_back(std::move(property));
    }

    PlyType type(std::string_view word) const {
        const auto* const found = std::find_if(type_names.begin(), type_names.end(),
                                               [&](const auto& entry) { return entry.first == word; });
        if (found == type_names.end()) {
            fail(fmt::format("type {}; must be char, uchar, short, ushort, int, uint, float or double",
                             in_quotes(word)));
        }
        return found->second;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, lines_.number(), 0, message);
    }

    std::string_view bytes_;
    const std::string& file_;
    Lines lines_;
    std::string_view line_;
    PlyHeader header_;
};

} // namespace

std::size_t size_of(PlyType type) noexcept {
    switch (type) {
    case PlyType::i8:
    case PlyType::u8:
        return 1;
    case PlyType::i16:
    case PlyType::u16:
        return 2;
    case PlyType::i32:
    case PlyType::u32:
    case PlyType::f32:
        return 4;
    case PlyType::f64:
        break;
    }
    return 8;
}

bool is_integer(PlyType type) noexcept {
    return type != PlyType::f32 && type != PlyType::f64;
}

std::size_t PlyElement::find(std::string_view property) const {
    return static_cast<std::size_t>(std::find_if(properties.begin(), properties.end(),
                                                 [&](const PlyProperty& p) { return p.name == property; }) -
                                    properties.begin());
}

std::size_t PlyElement::least_bytes() const {
    std::size_t bytes = 0;
    for (const PlyProperty& property : properties) {
        bytes += size_of(property.is_list ? property.count_type : property.type);
    }
    return bytes;
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& file) {
    return HeaderReader(bytes, file).read();
}

} // namespace hemi::io
