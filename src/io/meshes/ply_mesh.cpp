#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/binary_scan.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_builder.hpp"
#include "io/meshes/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace hemi::io {

namespace {

/// The data of a text file: an element a line.
class TextSource {
public:
    TextSource(std::string_view bytes, const PlyHeader& header, const std::string& file)
        : file_(file), lines_(bytes.substr(header.data)), lines_before_(header.lines), bytes_(bytes.size()) {}

    /// Elements that there can be at most.
    [[nodiscard]] std::uint64_t most(const PlyElement& element) const {
        return bytes_ / (2 * element.properties.size());
    }

    void begin(const PlyElement& element, std::uint64_t number) {
        element_ = &element;
        number_ = number;
        do {
            if (!lines_.next(rest_)) {
                fail(fmt::format("cut short: {} of the {} elements {} are there", number, element.count,
                                 element.name));
            }
        } while (trim(rest_).empty());
    }

    void end() const {
        if (!trim(rest_).empty()) {
            fail(fmt::format("{} after the properties", in_quotes(trim(rest_))));
        }
    }

    double value(const PlyProperty& property) {
        const std::string_view word = next_word(rest_);
        const auto number = parse_number(word);
        if (!number) {
            fail(fmt::format("{} {}; must be a finite number", property.name, in_quotes(word)));
        }
        return *number;
    }

    /// A whole number from 0.
    std::uint64_t count(const PlyProperty& property, PlyType) {
        const std::string_view word = next_word(rest_);
        const auto number = parse_integer<std::uint64_t>(word);
        if (!number) {
            fail(fmt::format("{} {}; must be a whole number", property.name, in_quotes(word)));
        }
        return *number;
    }

    void skip(const PlyProperty& property, std::uint64_t values) {
        for (std::uint64_t k = 0; k < values; ++k) {
            if (next_word(rest_).empty()) {
                fail(fmt::format("{} is missing", property.name));
            }
        }
    }

    [[nodiscard]] FacePlace place() const { return {line(), number_}; }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, line(), 0, fmt::format("{}: {}", element_->name, message));
    }

private:
    [[nodiscard]] std::size_t line() const { return lines_before_ + lines_.number(); }

    const std::string& file_;
    Lines lines_;
    std::size_t lines_before_;
    std::size_t bytes_;
    std::string_view rest_;
    const PlyElement* element_ = nullptr;
    std::uint64_t number_ = 0;
};

/// The data of a binary file.
class BinarySource {
public:
    BinarySource(std::string_view bytes, const PlyHeader& header, const std::string& file)
        : file_(file), at_(bytes.data() + header.data), end_(bytes.data() + bytes.size()),
          order_(header.order) {}

    [[nodiscard]] std::uint64_t most(const PlyElement& element) const {
        return left() / element.least_bytes();
    }

    void begin(const PlyElement& element, std::uint64_t number) {
        element_ = &element;
        number_ = number;
        if (left() < element.least_bytes()) {
            fail("cut short");
        }
    }

    void end() const {}

    double value(const PlyProperty& property) {
        need(size_of(property.type));
        switch (property.type) {
        case PlyType::i8:
            return take<std::int8_t>();
        case PlyType::u8:
            return take<std::uint8_t>();
        case PlyType::i16:
            return take<std::int16_t>();
        case PlyType::u16:
            return take<std::uint16_t>();
        case PlyType::i32:
            return take<std::int32_t>();
        case PlyType::u32:
            return take<std::uint32_t>();
        case PlyType::f32:
            return finite(property, static_cast<double>(take<float>()));
        case PlyType::f64:
            break;
        }
        return finite(property, take<double>());
    }

    std::uint64_t count(const PlyProperty& property, PlyType type) {
        need(size_of(type));
        switch (type) {
        case PlyType::i8:
            return not_negative(property, take<std::int8_t>());
        case PlyType::u8:
            return take<std::uint8_t>();
        case PlyType::i16:
            return not_negative(property, take<std::int16_t>());
        case PlyType::u16:
            return take<std::uint16_t>();
        case PlyType::i32:
            return not_negative(property, take<std::int32_t>());
        default:
            return take<std::uint32_t>();
        }
    }

    void skip(const PlyProperty& property, std::uint64_t values) {
        const std::size_t size = size_of(property.type);
        if (values > left() / size) {
            fail(fmt::format("{}: {} values; {} bytes are left", property.name, values, left()));
        }
        at_ += values * size;
    }

    [[nodiscard]] FacePlace place() const { return {0, number_}; }

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(fmt::format("{}: {} {}: {}", file_, element_->name, number_, message));
    }

private:
    [[nodiscard]] std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }

    void need(std::size_t bytes) const {
        if (left() < bytes) {
            fail("cut short");
        }
    }

    template <class Number>
    Number take() {
        const auto number = load<Number>(at_, order_);
        at_ += sizeof(Number);
        return number;
    }

    [[nodiscard]] double finite(const PlyProperty& property, double number) const {
        if (!std::isfinite(number)) {
            fail(fmt::format("{} {}; must be a finite number", property.name, number));
        }
        return number;
    }

    [[nodiscard]] std::uint64_t not_negative(const PlyProperty& property, std::int64_t number) const {
        if (number < 0) {
            fail(fmt::format("{} {}; must not be negative", property.name, number));
        }
        return static_cast<std::uint64_t>(number);
    }

    const std::string& file_;
    const char* at_;
    const char* end_;
    std::endian order_;
    const PlyElement* element_ = nullptr;
    std::uint64_t number_ = 0;
};

class PlyReader {
public:
    PlyReader(const std::filesystem::path& path, const SceneReaderOptions& options, Diagnostics& diagnostics)
        : file_(path.string()), bytes_(read_unmarked(path)), header_(read_ply_header(bytes_, file_)),
          diagnostics_(diagnostics), faces_(path, options) {}

    FaceMesh read() {
        find_faces();
        if (header_.text) {
            read_elements(TextSource(bytes_, header_, file_));
        } else {
            read_elements(BinarySource(bytes_, header_, file_));
        }
        return faces_.finish("element face", diagnostics_);
    }

private:
    /// Looks where positions and faces are. What else there is, is passed over.
    void find_faces() {
        const PlyElement* vertices = nullptr;
        const PlyElement* faces = nullptr;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") {
                vertices = &element;
            } else if (element.name == "face") {
                faces = &element;
                if (vertices == nullptr) {
                    refuse("element face before element vertex; vertices must come first");
                }
            } else if (element.count > 0) {
                diagnostics_.warn(fmt::format("{}: the {} {} {} not used", file_,
                                              plural(element.count, "element", "elements"),
                                              in_quotes(element.name), element.count == 1 ? "is" : "are"));
            }
        }
        if (faces == nullptr) {
            refuse("no element face; save the mesh with faces, not as points or strips");
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const char* const name = axis == 0 ? "x" : axis == 1 ? "y" : "z";
            position_[axis] = vertices->find(name);
            if (position_[axis] == vertices->properties.size() ||
                vertices->properties[position_[axis]].is_list) {
                refuse(fmt::format("element vertex has no property {}", name));
            }
        }
        indices_ = std::min(faces->find("vertex_indices"), faces->find("vertex_index"));
        if (indices_ == faces->properties.size() || !faces->properties[indices_].is_list ||
            !is_integer(faces->properties[indices_].type)) {
            refuse("element face has no list of integers vertex_indices");
        }
    }

    template <class Source>
    void read_elements(Source source) {
        for (const PlyElement& element : header_.elements) {
            if (element.count == 0) {
                continue;
            }
            if (element.count > source.most(element)) {
                refuse(fmt::format("{} elements {} in a file of {} bytes; that cannot be", element.count,
                                   element.name, bytes_.size()));
            }
            if (element.name == "vertex") {
                vertices_.reserve(element.count);
            } else if (element.name == "face") {
                faces_.reserve(element.count, bytes_.size() / 8); // 3 0 1 2
                group_ = faces_.group("default");
                material_ = faces_.material("", 0);
            }
            for (std::uint64_t number = 0; number < element.count; ++number) {
                source.begin(element, number);
                if (element.name == "vertex") {
                    read_vertex(source, element);
                } else if (element.name == "face") {
                    read_face(source, element);
                } else {
                    skip_properties(source, element, 0, element.properties.size());
                }
                source.end();
            }
        }
    }

    template <class Source>
    void read_vertex(Source& source, const PlyElement& element) {
        Vec3 point(0.0);
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            const auto* const axis = std::find(position_.begin(), position_.end(), p);
            if (axis == position_.end()) {
                skip_property(source, property);
            } else {
                point[static_cast<int>(axis - position_.begin())] = source.value(property);
            }
        }
        vertices_.push_back(point);
    }

    template <class Source>
    void read_face(Source& source, const PlyElement& element) {
        const PlyProperty& indices = element.properties[indices_];
        skip_properties(source, element, 0, indices_);
        const std::uint64_t count = source.count(indices, indices.count_type);
        if (count < 3) {
            source.fail(fmt::format("{} vertices; must have 3 or more", count));
        }
        corners_.clear();
        for (std::uint64_t k = 0; k < count; ++k) {
            const std::uint64_t index = source.count(indices, indices.type);
            if (index >= vertices_.size()) {
                source.fail(fmt::format("vertex {}; there are {}, counted from 0", index, vertices_.size()));
            }
            corners_.push_back(vertices_[index]);
        }
        skip_properties(source, element, indices_ + 1, element.properties.size());
        faces_.add(corners_, group_, material_, source.place());
    }

    template <class Source>
    static void skip_properties(Source& source, const PlyElement& element, std::size_t first,
                                std::size_t end) {
        for (std::size_t p = first; p < end; ++p) {
            skip_property(source, element.properties[p]);
        }
    }

    template <class Source>
    static void skip_property(Source& source, const PlyProperty& property) {
        source.skip(property, property.is_list ? source.count(property, property.count_type) : 1);
    }

    [[noreturn]] void refuse(const std::string& message) const {
        throw InputError(fmt::format("{}: {}", file_, message));
    }

    std::string file_;
    std::string bytes_;
    PlyHeader header_;
    Diagnostics& diagnostics_;
    FaceBuilder faces_;
    std::array<std::size_t, 3> position_{}; ///< properties x, y, z of a vertex
    std::size_t indices_ = 0;               ///< property of a face
    std::uint32_t group_ = 0;
    std::uint32_t material_ = 0;
    std::vector<Vec3> vertices_;
    std::vector<Vec3> corners_;
};

} // namespace

FaceMesh read_ply_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                       Diagnostics& diagnostics) {
    return PlyReader(path, options, diagnostics).read();
}

} // namespace hemi::io
