#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::uint64_t most_faces = 10'000'000; // instances share parts: a small file can ask for any number

struct InpElementType {
    std::string_view name;
    std::uint32_t nodes;
    std::uint32_t corners;
};

/// Shells, membranes, rigid and other surfaces in space; the first nodes of each are its corners.
constexpr std::array inp_element_types{
    InpElementType{"S3", 3, 3},      InpElementType{"S3R", 3, 3},    InpElementType{"S3RS", 3, 3},
    InpElementType{"S3T", 3, 3},     InpElementType{"S3RT", 3, 3},   InpElementType{"STRI3", 3, 3},
    InpElementType{"STRI65", 6, 3},  InpElementType{"S4", 4, 4},     InpElementType{"S4R", 4, 4},
    InpElementType{"S4RS", 4, 4},    InpElementType{"S4RSW", 4, 4},  InpElementType{"S4R5", 4, 4},
    InpElementType{"S4T", 4, 4},     InpElementType{"S4RT", 4, 4},   InpElementType{"S6", 6, 3},
    InpElementType{"S8", 8, 4},      InpElementType{"S8R", 8, 4},    InpElementType{"S8R5", 8, 4},
    InpElementType{"S8RT", 8, 4},    InpElementType{"S9R5", 9, 4},   InpElementType{"DS3", 3, 3},
    InpElementType{"DS4", 4, 4},     InpElementType{"DS6", 6, 3},    InpElementType{"DS8", 8, 4},
    InpElementType{"R3D3", 3, 3},    InpElementType{"R3D4", 4, 4},   InpElementType{"M3D3", 3, 3},
    InpElementType{"M3D4", 4, 4},    InpElementType{"M3D4R", 4, 4},  InpElementType{"M3D6", 6, 3},
    InpElementType{"M3D8", 8, 4},    InpElementType{"M3D8R", 8, 4},  InpElementType{"M3D9", 9, 4},
    InpElementType{"M3D9R", 9, 4},   InpElementType{"SFM3D3", 3, 3}, InpElementType{"SFM3D4", 4, 4},
    InpElementType{"SFM3D4R", 4, 4}, InpElementType{"SFM3D6", 6, 3}, InpElementType{"SFM3D8", 8, 4},
    InpElementType{"SFM3D8R", 8, 4}, InpElementType{"F3D3", 3, 3},   InpElementType{"F3D4", 4, 4},
};

struct InpElement {
    std::array<Vec3, 4> corners;
    std::uint32_t count;
    std::uint64_t number;
    std::size_t line;
    std::string set; ///< of its *ELEMENT; may be empty
};

/// Which side of which elements a surface is.
struct Side {
    std::string name; ///< of the surface, as the file writes it
    bool negative = false;
};

/// What a *PART has, or the file itself.
struct Part {
    std::unordered_map<std::uint64_t, Vec3> nodes;
    std::vector<InpElement> elements;
    std::unordered_map<std::uint64_t, std::size_t> numbers; ///< of elements -> index
    std::map<std::string, std::vector<std::uint64_t>> sets; ///< of elements, by upper-case names
    std::unordered_map<std::uint64_t, Side> sides;          ///< of elements that are in a surface
    std::unordered_map<std::uint64_t, std::string> set_of;  ///< first *ELSET that an element is in
};

/// A part where the assembly places it.
struct Instance {
    std::string name;
    const Part* part;
    Vec3 shift{0.0};
    Vec3 from{0.0};                                  ///< rotation: the axis begins here,
    Vec3 axis{0.0};                                  ///< runs this way,
    double angle = 0;                                ///< and turns by that, radians
    std::unordered_map<std::uint64_t, Side> sides{}; ///< by surfaces of the assembly

    [[nodiscard]] Vec3 place(const Vec3& point) const {
        const Vec3 moved = point + shift;
        if (angle == 0.0) {
            return moved;
        }
        const Vec3 along = glm::normalize(axis);
        const Vec3 arm = moved - from;
        return from + arm * std::cos(angle) + glm::cross(along, arm) * std::sin(angle) +
               along * glm::dot(along, arm) * (1.0 - std::cos(angle));
    }
};

/// A keyword line: *NAME, KEY=VALUE, KEY.
struct Keyword {
    std::string name;
    std::map<std::string, std::string> values; ///< by upper-case keys
};

class InpReader {
public:
    InpReader(const std::filesystem::path& path, const SceneReaderOptions& options, Diagnostics& diagnostics)
        : file_(path.string()), text_(read_text(path)), lines_(text_), diagnostics_(diagnostics),
          faces_(path, options) {}

    FaceMesh read() {
        faces_.reserve(text_.size() / 40, text_.size() / 8);
        material_ = faces_.material("", 0);
        bool more = next_line();
        if (more && !trim(line_).starts_with('*')) {
            fail(fmt::format("{}; an Abaqus file begins with a keyword, such as *NODE",
                             in_quotes(trim(line_))));
        }
        while (more) {
            more = read_keyword();
        }
        for (const auto& [type, left] : left_out_) {
            diagnostics_.warn(fmt::format("{}:{}: {} of type {} left out, the first one here; surfaces are "
                                          "shells, membranes and rigid elements of 3 or 4 corners",
                                          file_, left.second, plural(left.first, "element", "elements"),
                                          in_quotes(type)));
        }
        if (both_sides_ > 0) {
            diagnostics_.warn(fmt::format("{}: {} in several surfaces; the first one of each counts", file_,
                                          plural(both_sides_, "element is", "elements are")));
        }
        if (curved_ > 0) {
            diagnostics_.warn(fmt::format("{}: {} of second order taken as plane between the corners", file_,
                                          plural(curved_, "element", "elements")));
        }
        if (instances_.empty()) {
            for (const auto& [name, part] : parts_) {
                add_faces({name, &part});
            }
            add_faces({"", &root_});
        }
        for (const Instance& instance : instances_) {
            add_faces(instance);
        }
        return faces_.finish("shell elements", diagnostics_);
    }

private:
    /// The next line that is neither empty nor a comment.
    bool next_line() {
        while (lines_.next(line_)) {
            if (!trim(line_).empty() && !trim(line_).starts_with("**")) {
                return true;
            }
        }
        line_ = {};
        return false;
    }

    /// The next line of data; false at a keyword and at the end.
    bool next_data() { return has_line_ = next_line(), has_line_ && !trim(line_).starts_with('*'); }

    /// Reads a keyword and its data. @return whether another one follows
    bool read_keyword() {
        const Keyword keyword = parse_keyword();
        if (keyword.name == "NODE") {
            read_nodes(keyword);
        } else if (keyword.name == "ELEMENT") {
            read_elements(keyword);
        } else if (keyword.name == "ELSET") {
            read_set(keyword);
        } else if (keyword.name == "SURFACE") {
            read_surface(keyword);
        } else if (keyword.name == "PART") {
            part_ = &parts_[upper_case(value_of(keyword, "NAME"))];
            skip_data();
        } else if (keyword.name == "END PART") {
            part_ = &root_;
            skip_data();
        } else if (keyword.name == "INSTANCE") {
            read_instance(keyword);
        } else if (keyword.name == "INCLUDE") {
            fail("*INCLUDE is not supported; put the file's contents here");
        } else if (keyword.name == "SYSTEM") {
            fail("*SYSTEM is not supported; write nodes in the coordinates of the model");
        } else {
            skip_data(); // of the analysis
        }
        return has_line_;
    }

    void skip_data() {
        while (next_data()) {
        }
    }

    Keyword parse_keyword() {
        std::string text(trim(line_).substr(1));
        while (trim(text).ends_with(',') && next_line()) { // goes on
            text += line_;
        }
        Keyword keyword;
        std::string_view rest = text;
        keyword.name = upper_case(next_field(rest));
        while (!rest.empty()) {
            const std::string_view field = next_field(rest);
            const std::size_t equals = std::min(field.find('='), field.size());
            std::string_view value = trim(field.substr(std::min(equals + 1, field.size())));
            if (value.size() > 1 && value.starts_with('"') && value.ends_with('"')) {
                value = value.substr(1, value.size() - 2);
            }
            keyword.values[upper_case(trim(field.substr(0, equals)))] = to_utf8(value);
        }
        return keyword;
    }

    /// Takes what stands before the next comma.
    static std::string_view next_field(std::string_view& rest) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        const std::string_view field = trim(rest.substr(0, comma));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        return field;
    }

    std::string value_of(const Keyword& keyword, const char* key) const {
        const auto found = keyword.values.find(key);
        if (found == keyword.values.end() || found->second.empty()) {
            fail(fmt::format("*{} without {}=", keyword.name, key));
        }
        return found->second;
    }

    std::uint64_t number_of(std::string_view word, const char* what) const {
        const auto number = parse_integer<std::uint64_t>(word);
        if (!number) {
            fail(fmt::format("{} {}; must be a whole number", what, in_quotes(word)));
        }
        return *number;
    }

    /// A finite number; 0 where nothing stands.
    double real(std::string_view word) const {
        std::string text(word);
        std::replace_if(
            text.begin(), text.end(), [](char c) { return c == 'd' || c == 'D'; },
            'e'); // as Fortran writes it
        const auto value = word.empty() ? std::optional(0.0) : parse_number(text);
        if (!value) {
            fail(fmt::format("{}; must be a finite number", in_quotes(word)));
        }
        return *value;
    }

    void read_nodes(const Keyword& keyword) {
        const auto system = keyword.values.find("SYSTEM");
        if (system != keyword.values.end() && upper_case(system->second) != "R") {
            fail(fmt::format("nodes in the system {}; must be R, rectangular", in_quotes(system->second)));
        }
        while (next_data()) {
            std::string_view rest = line_;
            const std::uint64_t number = number_of(next_field(rest), "node");
            Vec3 point(0.0);
            for (int axis = 0; axis < 3; ++axis) {
                point[axis] = real(next_field(rest));
            }
            if (!part_->nodes.emplace(number, point).second) {
                fail(fmt::format("node {} is there twice", number));
            }
        }
    }

    void read_elements(const Keyword& keyword) {
        const std::string type = upper_case(value_of(keyword, "TYPE"));
        const auto* const known =
            std::find_if(inp_element_types.begin(), inp_element_types.end(),
                         [&](const InpElementType& other) { return other.name == type; });
        const auto set = keyword.values.find("ELSET");
        const std::string set_name = set == keyword.values.end() ? "" : set->second;
        if (known == inp_element_types.end()) {
            const std::size_t line = lines_.number();
            std::uint64_t count = 0;
            bool goes_on = false;
            while (next_data()) {
                count += goes_on ? 0 : 1;
                goes_on = trim(line_).ends_with(',');
            }
            auto& left = left_out_[type];
            left = {left.first + count, left.second == 0 ? line : left.second};
            return;
        }
        while (next_data()) {
            read_element(*known, set_name);
        }
    }

    void read_element(const InpElementType& type, const std::string& set) {
        InpElement element{{}, type.corners, 0, lines_.number(), set};
        std::string_view rest = line_;
        element.number = number_of(next_field(rest), "element");
        for (std::uint32_t c = 0; c < type.nodes; ++c) {
            if (trim(rest).empty() && c > 0) { // the line before ended with a comma
                if (!next_data()) {
                    fail(fmt::format("element {} with {} nodes; a {} has {}", element.number, c, type.name,
                                     type.nodes));
                }
                rest = line_;
            }
            const std::string_view word = next_field(rest);
            const auto found = part_->nodes.find(number_of(word, "node"));
            if (found == part_->nodes.end()) {
                fail(fmt::format("element {}: node {}; must be the number of one of the {} nodes above",
                                 element.number, in_quotes(word), part_->nodes.size()));
            }
            if (c < type.corners) {
                element.corners[c] = found->second;
            }
        }
        if (!trim(rest).empty()) {
            fail(
                fmt::format("{} after the nodes; a {} has {}", in_quotes(trim(rest)), type.name, type.nodes));
        }
        if (!part_->numbers.emplace(element.number, part_->elements.size()).second) {
            fail(fmt::format("element {} is there twice", element.number));
        }
        curved_ += type.nodes > type.corners ? 1 : 0;
        if (!set.empty()) {
            part_->sets[upper_case(set)].push_back(element.number);
        }
        part_->elements.push_back(std::move(element));
    }

    /// The elements of a set; none where there is no such set.
    [[nodiscard]] static std::span<const std::uint64_t> elements_of(const Part& part, std::string_view set) {
        const auto found = part.sets.find(upper_case(set));
        return found == part.sets.end() ? std::span<const std::uint64_t>() : found->second;
    }

    void read_set(const Keyword& keyword) {
        const std::string name = value_of(keyword, "ELSET");
        const bool range = keyword.values.contains("GENERATE");
        const auto placed = keyword.values.find("INSTANCE");
        std::vector<std::uint64_t> members;
        const bool is_placed = placed != keyword.values.end();
        Part& part = is_placed ? placed_sets_[upper_case(placed->second)] : *part_;
        while (next_data()) {
            std::string_view rest = line_;
            if (range) {
                add_range(rest, part, !is_placed, members);
                continue;
            }
            while (!rest.empty()) {
                const std::string_view word = next_field(rest);
                if (const auto number = parse_integer<std::uint64_t>(word)) {
                    members.push_back(*number);
                } else if (!word.empty()) {
                    const auto found = elements_of(part, word);
                    count(found.size());
                    members.insert(members.end(), found.begin(), found.end());
                }
            }
        }
        for (const std::uint64_t element : members) {
            part.set_of.emplace(element, name);
        }
        auto& set = part.sets[upper_case(name)];
        if (is_placed && set.empty()) {
            placed_in_[upper_case(name)].push_back(upper_case(placed->second));
        }
        set.insert(set.end(), members.begin(), members.end());
    }

    /// Sets of sets, and surfaces of them, grow fast.
    void count(std::uint64_t members) {
        constexpr std::uint64_t most = 20'000'000;
        members_ += members;
        if (members_ > most) {
            fail(fmt::format("more than {} elements in sets and surfaces", most));
        }
    }

    /// first, last, step. @param known  only numbers of elements that are there
    void add_range(std::string_view rest, const Part& part, bool known, std::vector<std::uint64_t>& members) {
        const std::uint64_t first = number_of(next_field(rest), "first element");
        const std::uint64_t last = number_of(next_field(rest), "last element");
        const std::string_view word = next_field(rest);
        const std::uint64_t step = word.empty() ? 1 : number_of(word, "step");
        if (step == 0 || last < first || (last - first) / step > text_.size()) {
            fail(fmt::format(
                "elements {} to {} by {}; must ascend, and not be more than a file of {} bytes has", first,
                last, step, text_.size()));
        }
        count((last - first) / step);
        for (std::uint64_t number = first;; number += step) {
            if (!known || part.numbers.contains(number)) {
                members.push_back(number);
            }
            if (last - number < step) {
                return;
            }
        }
    }

    void read_surface(const Keyword& keyword) {
        const std::string name = value_of(keyword, "NAME");
        const auto type = keyword.values.find("TYPE");
        if (type != keyword.values.end() && upper_case(type->second) != "ELEMENT") {
            skip_data();
            return;
        }
        std::set<std::pair<std::string, bool>> done; // sets and their sides
        while (next_data()) {
            std::string_view rest = line_;
            const std::string_view word = next_field(rest);
            const Side side{name, upper_case(next_field(rest)) == "SNEG"};
            if (const auto number = parse_integer<std::uint64_t>(word)) {
                mark(part_->sides, *number, side); // of which instance it would be is not said
                continue;
            }
            if (!done.emplace(upper_case(word), side.negative).second) {
                continue;
            }
            mark(part_->sides, elements_of(*part_, word), side);
            const auto placed = placed_in_.find(upper_case(word));
            if (placed == placed_in_.end()) {
                continue;
            }
            for (const std::string& instance : placed->second) {
                if (const auto found = instance_of_.find(instance); found != instance_of_.end()) {
                    mark(instances_[found->second].sides, elements_of(placed_sets_[instance], word), side);
                }
            }
        }
    }

    void mark(std::unordered_map<std::uint64_t, Side>& sides, std::span<const std::uint64_t> elements,
              const Side& side) {
        count(elements.size());
        for (const std::uint64_t element : elements) {
            mark(sides, element, side);
        }
    }

    void mark(std::unordered_map<std::uint64_t, Side>& sides, std::uint64_t element, const Side& side) {
        const auto [entry, is_new] = sides.emplace(element, side);
        const bool again = entry->second.name == side.name && entry->second.negative == side.negative;
        both_sides_ += is_new || again ? 0 : 1;
    }

    void read_instance(const Keyword& keyword) {
        const std::string part = value_of(keyword, "PART");
        const auto found = parts_.find(upper_case(part));
        if (found == parts_.end()) {
            fail(fmt::format("part {}; there is no *PART of that name above", in_quotes(part)));
        }
        Instance instance{value_of(keyword, "NAME"), &found->second};
        if (!instance_of_.emplace(upper_case(instance.name), instances_.size()).second) {
            fail(fmt::format("instance {} is there twice", in_quotes(instance.name)));
        }
        placed_faces_ += found->second.elements.size() + 1;
        if (placed_faces_ > most_faces) {
            fail(fmt::format("more than {} elements and instances in all", most_faces));
        }
        if (next_data()) {
            std::string_view rest = line_;
            for (int axis = 0; axis < 3; ++axis) {
                instance.shift[axis] = real(next_field(rest));
            }
            if (next_data()) {
                rest = line_;
                for (int axis = 0; axis < 3; ++axis) {
                    instance.from[axis] = real(next_field(rest));
                }
                for (int axis = 0; axis < 3; ++axis) {
                    instance.axis[axis] = real(next_field(rest)) - instance.from[axis];
                }
                instance.angle = real(next_field(rest)) * std::numbers::pi / 180.0;
                if (!(glm::length(instance.axis) > 0.0)) {
                    fail("the two points of the axis of rotation are the same");
                }
                skip_data();
            }
        }
        instances_.push_back(std::move(instance));
    }

    void add_faces(const Instance& instance) {
        for (const InpElement& element : instance.part->elements) {
            const Side side = side_of(instance, element);
            std::array<Vec3, 4> corners{};
            for (std::uint32_t c = 0; c < element.count; ++c) {
                corners[side.negative ? element.count - 1 - c : c] = instance.place(element.corners[c]);
            }
            faces_.add({corners.data(), element.count}, faces_.group(side.name), material_,
                       {element.line, 0});
        }
    }

    /// The surface that an element is in, else the set of its *ELEMENT, else its first *ELSET.
    [[nodiscard]] Side side_of(const Instance& instance, const InpElement& element) const {
        if (const auto found = instance.sides.find(element.number); found != instance.sides.end()) {
            return found->second;
        }
        const Part& part = *instance.part;
        if (const auto found = part.sides.find(element.number); found != part.sides.end()) {
            return found->second;
        }
        if (!element.set.empty()) {
            return {element.set};
        }
        const auto found = part.set_of.find(element.number);
        return {found != part.set_of.end() ? found->second
                : instance.name.empty()    ? std::string("default")
                                           : instance.name};
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw ParseError(file_, std::max<std::size_t>(lines_.number(), 1), 0, message);
    }

    std::string file_;
    std::string text_;
    Lines lines_;
    std::string_view line_;
    bool has_line_ = false;
    Diagnostics& diagnostics_;
    FaceBuilder faces_;
    std::uint32_t material_ = 0;
    Part root_;
    std::map<std::string, Part> parts_;       ///< by upper-case names
    std::map<std::string, Part> placed_sets_; ///< sets of the assembly, by upper-case names of instances
    std::map<std::string, std::vector<std::string>> placed_in_; ///< names of those sets -> of instances
    Part* part_ = &root_;
    std::vector<Instance> instances_;
    std::map<std::string, std::size_t> instance_of_;                        ///< by upper-case names
    std::map<std::string, std::pair<std::uint64_t, std::size_t>> left_out_; ///< by type: count, first line
    std::uint64_t both_sides_ = 0;
    std::uint64_t curved_ = 0;
    std::uint64_t members_ = 0; ///< of all sets
    std::uint64_t placed_faces_ = 0;
};

} // namespace

FaceMesh read_inp_mesh(const std::filesystem::path& path, const SceneReaderOptions& options,
                       Diagnostics& diagnostics) {
    return InpReader(path, options, diagnostics).read();
}

} // namespace hemi::io
