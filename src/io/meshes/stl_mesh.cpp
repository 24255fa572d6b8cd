#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/binary_scan.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <optional>

namespace hemi::io {

namespace {

constexpr std::size_t head_bytes = 84; ///< 80 of anything and the number of triangles
constexpr std::size_t triangle_bytes = 50;
constexpr std::size_t shortest_facet = 70; ///< "facet normal 0 0 0 outer loop vertex 0 0 0 ..."

bool same_word(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// Bytes of a binary file of as many triangles as it says.
std::uint64_t binary_bytes(std::string_view bytes) {
    return head_bytes +
           triangle_bytes * std::uint64_t{load<std::uint32_t>(bytes.data() + 80, std::endian::little)};
}

/// Text, if it begins like text; but many binary files begin with the word, too.
bool is_text(std::string_view bytes) {
    std::string_view start = bytes.substr(0, 100);
    start.remove_prefix(std::min(start.find_first_not_of(" \t\r\n"), start.size()));
    return same_word(start.substr(0, 5), "solid") &&
           bytes.substr(0, 1000).find('\0') == std::string_view::npos &&
           (bytes.size() < head_bytes || bytes.size() != binary_bytes(bytes));
}

class StlReader {
public:
    StlReader(const std::filesystem::path& path, const SceneReaderOptions& options, Diagnostics& diagnostics)
        : file_(path.string()), bytes_(read_file(path)), lines_(bytes_), diagnostics_(diagnostics),
          faces_(path, options) {}

    FaceMesh read() {
        material_ = faces_.material("", 0);
        if (bytes_.starts_with("\xEF\xBB\xBF") && is_text(std::string_view(bytes_).substr(3))) {
            bytes_.erase(0, 3);
            lines_ = Lines(bytes_);
        }
        if (is_text(bytes_)) {
            read_text();
        } else {
            read_binary();
        }
        if (opposed_ > 0) {
            diagnostics_.warn(fmt::format("{}: {} normals point to the back; the front is where the vertices "
                                          "are counter-clockwise",
                                          file_, opposed_));
        }
        return faces_.finish("triangles", diagnostics_);
    }

private:
    void read_binary() {
        if (bytes_.size() < head_bytes) {
            throw InputError(
                fmt::format("{}: {} bytes; an STL file begins with \"solid\", or, binary, has at "
                            "least {} bytes",
                            file_, bytes_.size(), head_bytes));
        }
        const std::uint64_t needed = binary_bytes(bytes_);
        const std::uint64_t triangles = (needed - head_bytes) / triangle_bytes;
        if (needed > bytes_.size()) {
            throw InputError(fmt::format("{}: cut short, or not STL: {} bytes; its {} triangles need {}",
                                         file_, bytes_.size(), triangles, needed));
        }
        if (needed < bytes_.size()) {
            diagnostics_.warn(fmt::format("{}: {} bytes after the last triangle are not used", file_,
                                          bytes_.size() - needed));
        }
        group_ = faces_.group("default");
        faces_.reserve(triangles, triangles);
        for (std::uint64_t t = 0; t < triangles; ++t) {
            const char* at = bytes_.data() + head_bytes + t * triangle_bytes;
            std::array<Vec3, 4> points{}; // the normal, then the corners
            for (Vec3& point : points) {
                for (int axis = 0; axis < 3; ++axis, at += sizeof(float)) {
                    point[axis] = static_cast<double>(load<float>(at, std::endian::little));
                }
            }
            add(points[0], {points.data() + 1, 3}, {0, t});
        }
    }

    void read_text() {
        faces_.reserve(bytes_.size() / 250, bytes_.size() / shortest_facet);
        while (next_token()) {
            if (!same_word(token_, "solid")) {
                fail(fmt::format("{}; must be solid", in_quotes(token_)));
            }
            read_solid();
        }
    }

    void read_solid() {
        const std::string_view name = trim(rest_);
        group_ = faces_.group(name.empty() ? "default" : to_utf8(name));
        rest_ = {};
        for (;;) {
            need_token("endsolid");
            if (same_word(token_, "endsolid")) {
                rest_ = {}; // its name again
                return;
            }
            if (!same_word(token_, "facet")) {
                fail(fmt::format("{}; must be facet or endsolid", in_quotes(token_)));
            }
            read_facet();
        }
    }

    void read_facet() {
        const std::size_t line = lines_.number();
        expect("normal");
        Vec3 normal(0.0);
        for (int axis = 0; axis < 3; ++axis) {
            need_token("the normal");
            normal[axis] = parse_number(token_).value_or(0.0); // it is not needed
        }
        expect("outer");
        expect("loop");
        std::array<Vec3, 3> corners{};
        for (Vec3& corner : corners) {
            expect("vertex");
            for (int axis = 0; axis < 3; ++axis) {
                need_token("the vertex");
                const auto value = parse_number(token_);
                if (!value) {
                    fail(fmt::format("{} in a vertex; must be a finite number", in_quotes(token_)));
                }
                corner[axis] = *value;
            }
        }
        need_token("endloop");
        if (same_word(token_, "vertex")) {
            fail("a fourth vertex; a facet has 3");
        }
        require("endloop");
        expect("endfacet");
        add(normal, corners, {line, 0});
    }

    void add(const Vec3& normal, std::span<const Vec3> corners, FacePlace place) {
        faces_.add(corners, group_, material_, place);
        opposed_ += glm::dot(normal, area_vector(corners)) < 0.0 ? 1 : 0;
    }

    bool next_token() {
        for (;;) {
            token_ = next_word(rest_);
            if (!token_.empty()) {
                return true;
            }
            if (!lines_.next(rest_)) {
                return false;
            }
        }
    }

    void need_token(std::string_view what) {
        if (!next_token()) {
            fail(fmt::format("cut short: {} is missing", what));
        }
    }

    void expect(std::string_view word) {
        need_token(word);
        require(word);
    }

    void require(std::string_view word) const {
        if (!same_word(token_, word)) {
            fail(fmt::format("{}; must be {}", in_quotes(token_), word));
        }
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, lines_.number(), 0, message);
    }

    std::string file_;
    std::string bytes_;
    Lines lines_;
    std::string_view rest_; ///< of the line
    std::string_view token_;
    Diagnostics& diagnostics_;
    FaceBuilder faces_;
    std::uint32_t group_ = 0;
    std::uint32_t material_ = 0;
    std::uint64_t opposed_ = 0; ///< normals
};

} // namespace

FaceMesh read_stl_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                       Diagnostics& diagnostics) {
    return StlReader(path, options, diagnostics).read();
}

} // namespace hemi::io
