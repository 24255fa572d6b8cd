#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

enum class Kind { triangle, quadrilateral, point, line, volume, curved };

struct ElementType {
    std::uint32_t number;
    Kind kind;
    const char* name;
};

/// Gmsh's numbers of the element types that it writes.
constexpr std::array element_types{
    ElementType{1, Kind::line, ""},
    ElementType{2, Kind::triangle, ""},
    ElementType{3, Kind::quadrilateral, ""},
    ElementType{4, Kind::volume, ""},
    ElementType{5, Kind::volume, ""},
    ElementType{6, Kind::volume, ""},
    ElementType{7, Kind::volume, ""},
    ElementType{8, Kind::line, ""},
    ElementType{9, Kind::curved, "6-node triangle"},
    ElementType{10, Kind::curved, "9-node quadrilateral"},
    ElementType{11, Kind::volume, ""},
    ElementType{12, Kind::volume, ""},
    ElementType{13, Kind::volume, ""},
    ElementType{14, Kind::volume, ""},
    ElementType{15, Kind::point, ""},
    ElementType{16, Kind::curved, "8-node quadrilateral"},
    ElementType{17, Kind::volume, ""},
    ElementType{18, Kind::volume, ""},
    ElementType{19, Kind::volume, ""},
    ElementType{20, Kind::curved, "9-node triangle"},
    ElementType{21, Kind::curved, "10-node triangle"},
    ElementType{22, Kind::curved, "12-node triangle"},
    ElementType{23, Kind::curved, "15-node triangle"},
    ElementType{24, Kind::curved, "15-node triangle of incomplete order"},
    ElementType{25, Kind::curved, "21-node triangle"},
    ElementType{26, Kind::line, ""},
    ElementType{27, Kind::line, ""},
    ElementType{28, Kind::line, ""},
    ElementType{29, Kind::volume, ""},
    ElementType{30, Kind::volume, ""},
    ElementType{31, Kind::volume, ""},
    ElementType{36, Kind::curved, "16-node quadrilateral"},
    ElementType{37, Kind::curved, "25-node quadrilateral"},
    ElementType{92, Kind::volume, ""},
    ElementType{93, Kind::volume, ""},
};

/// What of a kind was left out, for one warning.
struct LeftOut {
    std::uint64_t count = 0;
    std::size_t first_line = 0;

    void add(std::size_t line) {
        first_line = count == 0 ? line : first_line;
        ++count;
    }
};

class MshReader {
public:
    MshReader(const std::filesystem::path& path, bool skip_degenerate, Diagnostics& diagnostics)
        : file_(path.string()), text_(read_file(path)), lines_(text_), diagnostics_(diagnostics),
          faces_(path, skip_degenerate) {}

    FaceMesh read() {
        read_format();
        while (next_line()) {
            const std::string_view name = trim(line_);
            if (name == "$PhysicalNames") {
                read_names();
            } else if (name == "$Nodes") {
                read_nodes();
            } else if (name == "$Elements") {
                read_elements();
            } else if (name.starts_with('$') && !name.starts_with("$End")) {
                skip_section(name);
            } else {
                fail(fmt::format("{} between sections; a section begins with its name, such as $Elements",
                                 in_quotes(name)));
            }
        }
        if (!has_elements_) {
            throw InputError(fmt::format("{}: no $Elements section; a scene needs faces", file_));
        }
        refuse_twins();
        warn_of(points_, "points");
        warn_of(edges_, "lines");
        warn_of(volumes_, "volume elements");
        return faces_.finish("triangles or quadrilaterals in $Elements", diagnostics_);
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

    void read_format() {
        const bool any = next_line();
        const std::string_view name = any ? trim(line_) : std::string_view();
        if (name == "$NOD" || name == "$NOE") {
            fail("MSH version 1; must be 2.2, ASCII (gmsh -format msh22)");
        }
        if (name != "$MeshFormat") {
            fail(fmt::format("{}; a Gmsh file begins with $MeshFormat", in_quotes(name)));
        }
        need_line("$MeshFormat");
        std::string_view rest = line_;
        const std::string_view version = next_word(rest);
        const std::string_view type = next_word(rest);
        if (version != "2.2" && version != "2" && version != "2.1") {
            fail(fmt::format("MSH version {}; must be 2.2, ASCII (gmsh -format msh22)", in_quotes(version)));
        }
        if (type != "0") {
            fail(fmt::format("file type {}; must be 0, ASCII (gmsh -format msh22, without -bin)",
                             in_quotes(type)));
        }
        end_section("$MeshFormat");
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
            std::string_view rest = line_;
            const auto dimension = parse_integer<std::uint32_t>(next_word(rest));
            const auto number = parse_integer<std::int64_t>(next_word(rest));
            const std::string_view name = trim(rest);
            if (!dimension || *dimension > 3 || !number || name.size() < 2 || !name.starts_with('"') ||
                !name.ends_with('"')) {
                fail(fmt::format("{}; must be dimension, number and the name in quotes",
                                 in_quotes(trim(line_))));
            }
            if (*dimension != 2) {
                continue;
            }
            const std::string text = to_utf8(name.substr(1, name.size() - 2));
            if (text.empty()) {
                fail(fmt::format("physical surface {} has an empty name", *number));
            }
            if (!names_.emplace(*number, text).second) {
                fail(fmt::format("physical surface {} is named twice", *number));
            }
        }
        end_section("$PhysicalNames");
    }

    void read_nodes() {
        if (!nodes_.empty()) {
            fail("a second $Nodes section");
        }
        const std::uint64_t count = read_count("$Nodes", 8); // 1 0 0 0
        if (count >= none) {
            fail(fmt::format("{} nodes; there can be {}", count, none - 1));
        }
        nodes_.reserve(count);
        for (std::uint64_t k = 0; k < count; ++k) {
            need_line("$Nodes");
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
            refuse_more(rest, "the coordinates");
            // Gmsh mostly counts on from 1; only other numbers need a table.
            if (*number != k + 1 || !numbers_.empty()) {
                number_nodes_up_to(k);
                if (!numbers_.emplace(*number, k).second) {
                    fail(fmt::format("node {} is there twice", *number));
                }
            }
            nodes_.push_back(point);
        }
        end_section("$Nodes");
    }

    void number_nodes_up_to(std::uint64_t count) {
        if (numbers_.empty()) {
            for (std::uint64_t k = 0; k < count; ++k) {
                numbers_.emplace(k + 1, k);
            }
        }
    }

    /// Index of the node with that number.
    [[nodiscard]] std::uint32_t node(std::string_view word) const {
        const auto number = parse_integer<std::uint64_t>(word);
        std::uint64_t index = nodes_.size();
        if (number && numbers_.empty()) {
            index = *number - 1; // 0 becomes too large
        } else if (number) {
            const auto found = numbers_.find(*number);
            index = found == numbers_.end() ? index : found->second;
        }
        if (index >= nodes_.size()) {
            fail(fmt::format("node {}; must be the number of one of the {} nodes", in_quotes(word),
                             nodes_.size()));
        }
        return static_cast<std::uint32_t>(index);
    }

    void read_elements() {
        if (has_elements_) {
            fail("a second $Elements section");
        }
        has_elements_ = true;
        const std::uint64_t count = read_count("$Elements", 9); // 1 15 0 1
        faces_.reserve(count, text_.size() / 11);               // 1 2 0 1 2 3
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
        const auto* const known = std::find_if(element_types.begin(), element_types.end(),
                                               [&](const ElementType& t) { return t.number == *type; });
        if (known == element_types.end()) {
            fail(fmt::format("element {}: type {} is not supported; surfaces are 3-node triangles (2) and "
                             "4-node quadrilaterals (3)",
                             number, *type));
        }
        switch (known->kind) {
        case Kind::point:
            points_.add(lines_.number());
            return;
        case Kind::line:
            edges_.add(lines_.number());
            return;
        case Kind::volume:
            volumes_.add(lines_.number());
            return;
        case Kind::curved:
            fail(fmt::format("element {}: a {} (type {}) is curved; mesh with elements of first order "
                             "(gmsh -order 1)",
                             number, known->name, *type));
        case Kind::triangle:
        case Kind::quadrilateral:
            break;
        }
        const Tags of = read_tags(number, *tags, rest);
        const std::size_t size = known->kind == Kind::triangle ? 3 : 4;
        std::array<Vec3, 4> corners{};
        Twin twin{{none, none, none, none}, lines_.number()};
        for (std::size_t c = 0; c < size; ++c) {
            twin.nodes[c] = node(next_word(rest));
            corners[c] = nodes_[twin.nodes[c]];
        }
        refuse_more(rest, "the nodes");
        std::rotate(twin.nodes.begin(), std::min_element(twin.nodes.begin(), twin.nodes.end()),
                    twin.nodes.begin() + static_cast<std::ptrdiff_t>(size));
        twins_.push_back(twin);
        const Group& group = group_of(of);
        faces_.add({corners.data(), size}, group.group, group.material, {lines_.number(), 0});
    }

    struct Tags {
        std::int64_t physical = 0;
        std::int64_t elementary = 0;
        auto operator<=>(const Tags&) const = default;
    };
    /// Nodes of a face, the lowest first, to find faces that are there twice.
    struct Twin {
        std::array<std::uint32_t, 4> nodes;
        std::size_t line;
        auto operator<=>(const Twin&) const = default;
    };
    struct Group {
        std::uint32_t group;
        std::uint32_t material;
    };

    Tags read_tags(std::string_view number, std::uint32_t count, std::string_view& rest) const {
        Tags tags;
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::string_view word = next_word(rest);
            const auto tag = parse_integer<std::int64_t>(word);
            if (!tag) {
                fail(fmt::format("element {}: tag {} of {} is {}; must be a whole number", number, k + 1,
                                 count, in_quotes(word)));
            }
            if (k < 2) {
                (k == 0 ? tags.physical : tags.elementary) = *tag;
            }
        }
        return tags;
    }

    const Group& group_of(Tags tags) {
        if (tags.physical != 0) {
            tags.elementary = 0;
        }
        const auto found = groups_.find(tags);
        if (found != groups_.end()) {
            return found->second;
        }
        const auto named = names_.find(tags.physical);
        const std::string name =
            tags.physical != 0
                ? (named != names_.end() ? named->second : fmt::format("physical_{}", tags.physical))
            : tags.elementary != 0 ? fmt::format("surface_{}", tags.elementary)
                                   : "default";
        return groups_.emplace(tags, Group{faces_.group(name), faces_.material(name, 0)}).first->second;
    }

    void skip_section(std::string_view name) {
        const std::string section(name);
        if (section == "$ParametricNodes") {
            fail("$ParametricNodes are not supported; save without parametric coordinates");
        }
        if (section != "$Comments") {
            diagnostics_.warn(
                fmt::format("{}:{}: the section {} is not used", file_, lines_.number(), in_quotes(section)));
        }
        const std::string end = "$End" + section.substr(1);
        do {
            need_line(section);
        } while (trim(line_) != end);
    }

    /// Gmsh writes a surface once for each physical surface that it belongs to.
    void refuse_twins() {
        std::sort(twins_.begin(), twins_.end());
        const auto same = std::adjacent_find(twins_.begin(), twins_.end(),
                                             [](const Twin& a, const Twin& b) { return a.nodes == b.nodes; });
        if (same != twins_.end()) {
            throw ParseError(
                file_, std::next(same)->line, 0,
                fmt::format("the face of line {} again; a face must be in one physical surface", same->line));
        }
    }

    void warn_of(const LeftOut& left, const char* what) {
        if (left.count > 0) {
            diagnostics_.warn(fmt::format("{}:{}: {} {} left out, the first one here; surfaces are triangles "
                                          "and quadrilaterals",
                                          file_, left.first_line, left.count, what));
        }
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
    std::string text_;
    Lines lines_;
    std::string_view line_;
    Diagnostics& diagnostics_;
    FaceBuilder faces_;
    std::map<std::int64_t, std::string> names_;
    std::vector<Vec3> nodes_;
    std::unordered_map<std::uint64_t, std::uint64_t> numbers_; ///< empty while nodes count on from 1
    std::map<Tags, Group> groups_;
    std::vector<Twin> twins_;
    bool has_elements_ = false;
    LeftOut points_;
    LeftOut edges_;
    LeftOut volumes_;
};

} // namespace

FaceMesh read_msh_mesh(const std::filesystem::path& path, bool skip_degenerate, Diagnostics& diagnostics) {
    return MshReader(path, skip_degenerate, diagnostics).read();
}

} // namespace hemi::io
