#include "hemi/core/error.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mesh.hpp"
#include "io/meshes/msh_blocks.hpp"
#include "io/meshes/msh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace hemi::io {

namespace {

constexpr std::uint32_t no_element = std::numeric_limits<std::uint32_t>::max();

/// Version 2.2, ASCII: line by line.
class MshTextReader {
public:
    /// @param text  must outlive this
    MshTextReader(const std::filesystem::path& path, std::string_view text, const SceneReaderOptions& options,
                  Diagnostics& diagnostics)
        : file_(path.string()), text_(text), lines_(text_), diagnostics_(diagnostics), faces_(path, options) {
    }

    FaceMesh read() {
        skip_section("$MeshFormat", false);
        while (next_line()) {
            const std::string_view name = trim(line_);
            if (name == "$PhysicalNames") {
                read_names();
            } else if (name == "$Nodes") {
                read_nodes(false);
            } else if (name == "$ParametricNodes") {
                read_nodes(true);
            } else if (name == "$Elements") {
                read_elements();
            } else if (name.starts_with('$') && !name.starts_with("$End")) {
                skip_section(name, name != "$Comments");
            } else {
                fail(fmt::format("{} between sections; a section begins with its name, such as $Elements",
                                 in_quotes(name)));
            }
        }
        if (!has_elements_) {
            throw InputError(fmt::format("{}: no $Elements section; a scene needs faces", file_));
        }
        return faces_.finish(diagnostics_);
    }

private:
    /// The next line that is not empty.
    bool next_line() {
        while (lines_.next(line_)) {
            if (!trim(line_).empty()) {
                return true;
            }
        }
        return false;
    }

    void need_line(std::string_view section) {
        if (!next_line()) {
            fail(fmt::format("cut short: the end of {} is missing", section));
        }
    }

    void end_section(std::string_view section) {
        need_line(section);
        const std::string end = "$End" + std::string(section.substr(1));
        if (trim(line_) != end) {
            fail(fmt::format("{}; must be {}, the count says", in_quotes(trim(line_)), end));
        }
    }

    /// The count that a section begins with. `bytes`: of the shortest line there can be for one item.
    std::uint64_t read_count(std::string_view section, std::uint64_t bytes) {
        need_line(section);
        const auto count = parse_integer<std::uint64_t>(trim(line_));
        if (!count) {
            fail(fmt::format("{} in {}; must be the number of its lines", in_quotes(trim(line_)), section));
        }
        if (*count > text_.size() / bytes) {
            fail(fmt::format("{} lines in {} of a file of {} bytes; that cannot be", *count, section,
                             text_.size()));
        }
        return *count;
    }

    void read_names() {
        if (has_elements_) {
            fail("$PhysicalNames after $Elements; names must come first");
        }
        const std::uint64_t count = read_count("$PhysicalNames", 7); // 2 1 ""
        for (std::uint64_t k = 0; k < count; ++k) {
            need_line("$PhysicalNames");
            if (const auto wrong = faces_.add_name(line_)) {
                fail(*wrong);
            }
        }
        end_section("$PhysicalNames");
    }

    void read_nodes(bool parametric) {
        const char* const section = parametric ? "$ParametricNodes" : "$Nodes";
        if (faces_.nodes() > 0) {
            fail("a second section of nodes");
        }
        const std::uint64_t count = read_count(section, 8); // 1 0 0 0
        if (count >= no_element) {
            fail(fmt::format("{} nodes; there can be {}", count, no_element - 1));
        }
        faces_.reserve_nodes(count);
        for (std::uint64_t k = 0; k < count; ++k) {
            need_line(section);
            std::string_view rest = line_;
            const std::string_view word = next_word(rest);
            const auto number = parse_integer<std::uint64_t>(word);
            if (!number) {
                fail(fmt::format("node number {}; must be a whole number", in_quotes(word)));
            }
            Vec3 point(0.0);
            for (int axis = 0; axis < 3; ++axis) {
                const std::string_view coordinate = next_word(rest);
                const auto value = parse_number(coordinate);
                if (!value) {
                    fail(fmt::format("node {}: {} {}; must be a finite number", *number, "xyz"[axis],
                                     in_quotes(coordinate)));
                }
                point[axis] = *value;
            }
            if (!parametric) { // else these are of a surface or line
                refuse_more(rest, "the coordinates");
            }
            if (!faces_.add_node(*number, point)) {
                fail(fmt::format("node {} is there twice", *number));
            }
        }
        end_section(section);
    }

    /// Index of the node with that number.
    [[nodiscard]] std::uint32_t node(std::string_view word) const {
        const auto number = parse_integer<std::uint64_t>(word);
        const auto index = number ? faces_.find_node(*number) : std::nullopt;
        if (!index) {
            fail(fmt::format("node {}; must be the number of one of the {} nodes", in_quotes(word),
                             faces_.nodes()));
        }
        return *index;
    }

    void read_elements() {
        if (has_elements_) {
            fail("a second $Elements section");
        }
        has_elements_ = true;
        const std::uint64_t count = read_count("$Elements", 9); // 1 15 0 1
        faces_.reserve_faces(count, text_.size() / 11);         // 1 2 0 1 2 3
        for (std::uint64_t k = 0; k < count; ++k) {
            need_line("$Elements");
            read_element();
        }
        end_section("$Elements");
    }

    void read_element() {
        std::string_view rest = line_;
        const std::string_view number = next_word(rest);
        const std::string_view type_word = next_word(rest);
        const auto type = parse_integer<std::uint32_t>(type_word);
        const std::string_view tags_word = next_word(rest);
        const auto tags = parse_integer<std::uint32_t>(tags_word);
        if (!parse_integer<std::uint64_t>(number) || !type || !tags) {
            fail(fmt::format("{}; an element is its number, type, number of tags, tags and nodes",
                             in_quotes(trim(line_))));
        }
        const MshElementType* const known = find_msh_element_type(*type);
        if (known == nullptr) {
            fail(fmt::format(
                "element {}: type {} is not supported; surfaces are triangles and quadrilaterals, "
                "such as 2 and 3",
                number, *type));
        }
        if (!known->is_face()) {
            faces_.leave_out(*known, {lines_.number(), 0});
            return;
        }
        const MshFaces::Tags of = read_tags(number, *tags, rest);
        const std::size_t size = known->kind == MshElementType::Kind::triangle ? 3 : 4;
        std::array<std::uint32_t, 4> corners{};
        for (std::size_t c = 0; c < size; ++c) {
            corners[c] = node(next_word(rest));
        }
        for (std::size_t c = size; c < known->nodes; ++c) {
            (void)node(next_word(rest));
        }
        refuse_more(rest, "the nodes");
        faces_.add_face(*known, of, {corners.data(), size}, {lines_.number(), 0});
    }

    MshFaces::Tags read_tags(std::string_view number, std::uint32_t count, std::string_view& rest) const {
        MshFaces::Tags tags;
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::string_view word = next_word(rest);
            const auto tag = parse_integer<std::int32_t>(word);
            if (!tag) {
                fail(fmt::format("element {}: tag {} of {} is {}; must be a whole number of 32 bits", number,
                                 k + 1, count, in_quotes(word)));
            }
            if (k < 2) {
                (k == 0 ? tags.physical : tags.elementary) = *tag;
            }
        }
        return tags;
    }

    void skip_section(std::string_view name, bool tell) {
        const std::string section(name);
        if (tell) {
            diagnostics_.warn(
                fmt::format("{}:{}: the section {} is not used", file_, lines_.number(), in_quotes(section)));
        }
        const std::string end = "$End" + section.substr(1);
        do {
            need_line(section);
        } while (trim(line_) != end);
    }

    void refuse_more(std::string_view rest, const char* after) const {
        if (!trim(rest).empty()) {
            fail(fmt::format("{} after {}", in_quotes(trim(rest)), after));
        }
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, std::max<std::size_t>(lines_.number(), 1), 0, message);
    }

    std::string file_;
    std::string_view text_;
    Lines lines_;
    std::string_view line_;
    Diagnostics& diagnostics_;
    MshFaces faces_;
    bool has_elements_ = false;
};

/// What $MeshFormat says, which every file begins with.
MshFormat read_format(const std::string& text, const std::string& file) {
    Lines lines(text);
    std::string_view line;
    const auto next = [&] {
        while (lines.next(line)) {
            line = trim(line);
            if (!line.empty()) {
                return true;
            }
        }
        line = {};
        return false;
    };
    const auto fail = [&](const std::string& message) {
        throw ParseError(file, std::max<std::size_t>(lines.number(), 1), 0, message);
    };
    next();
    if (line == "$NOD" || line == "$NOE") {
        fail("MSH version 1; must be 4.1 or 2.2 (gmsh -format msh41)");
    }
    if (line != "$MeshFormat") {
        fail(fmt::format("{}; a Gmsh file begins with $MeshFormat", in_quotes(line)));
    }
    if (!next()) {
        fail("cut short: the end of $MeshFormat is missing");
    }
    const std::string_view version = next_word(line);
    const std::string_view type = next_word(line);
    const std::string_view size = next_word(line);
    if (version != "4.1" && version != "2.2" && version != "2" && version != "2.1") {
        fail(fmt::format("MSH version {}; must be 4.1 or 2.2 (gmsh -format msh41)", in_quotes(version)));
    }
    if (type != "0" && type != "1") {
        fail(fmt::format("file type {}; must be 0 (ASCII) or 1 (binary)", in_quotes(type)));
    }
    if (type == "1" && size != "8") {
        fail(fmt::format("data size {}; must be 8", in_quotes(size)));
    }
    MshFormat format{version == "4.1", type == "1", lines.number(), text.size() - lines.rest().size()};
    if (!format.binary && (!next() || line != "$EndMeshFormat")) {
        fail(line.empty() ? "cut short: the end of $MeshFormat is missing"
                          : fmt::format("{}; must be $EndMeshFormat", in_quotes(line)));
    }
    return format;
}

} // namespace

FaceMesh read_msh_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                       Diagnostics& diagnostics) {
    const std::string text = read_text(path);
    const MshFormat format = read_format(text, path.string());
    return format.version_4 || format.binary ? read_msh_blocks(path, text, format, options, diagnostics)
                                             : MshTextReader(path, text, options, diagnostics).read();
}

} // namespace hemi::io
