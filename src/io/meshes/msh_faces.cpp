#include "io/meshes/msh_faces.hpp"

#include "hemi/core/error.hpp"
#include "hemi/core/text.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <utility>

namespace hemi::io {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
using Kind = MshElementType::Kind;

constexpr std::array element_types{
    MshElementType{1, Kind::line, 2, ""},
    MshElementType{2, Kind::triangle, 3, ""},
    MshElementType{3, Kind::quadrilateral, 4, ""},
    MshElementType{4, Kind::volume, 4, ""},
    MshElementType{5, Kind::volume, 8, ""},
    MshElementType{6, Kind::volume, 6, ""},
    MshElementType{7, Kind::volume, 5, ""},
    MshElementType{8, Kind::line, 3, ""},
    MshElementType{9, Kind::triangle, 6, "6-node triangle"},
    MshElementType{10, Kind::quadrilateral, 9, "9-node quadrilateral"},
    MshElementType{11, Kind::volume, 10, ""},
    MshElementType{12, Kind::volume, 27, ""},
    MshElementType{13, Kind::volume, 18, ""},
    MshElementType{14, Kind::volume, 14, ""},
    MshElementType{15, Kind::point, 1, ""},
    MshElementType{16, Kind::quadrilateral, 8, "8-node quadrilateral"},
    MshElementType{17, Kind::volume, 20, ""},
    MshElementType{18, Kind::volume, 15, ""},
    MshElementType{19, Kind::volume, 13, ""},
    MshElementType{20, Kind::triangle, 9, "9-node triangle"},
    MshElementType{21, Kind::triangle, 10, "10-node triangle"},
    MshElementType{22, Kind::triangle, 12, "12-node triangle"},
    MshElementType{23, Kind::triangle, 15, "15-node triangle"},
    MshElementType{24, Kind::triangle, 15, "incomplete 15-node triangle"},
    MshElementType{25, Kind::triangle, 21, "21-node triangle"},
    MshElementType{26, Kind::line, 4, ""},
    MshElementType{27, Kind::line, 5, ""},
    MshElementType{28, Kind::line, 6, ""},
    MshElementType{29, Kind::volume, 20, ""},
    MshElementType{30, Kind::volume, 35, ""},
    MshElementType{31, Kind::volume, 56, ""},
    MshElementType{36, Kind::quadrilateral, 16, "16-node quadrilateral"},
    MshElementType{37, Kind::quadrilateral, 25, "25-node quadrilateral"},
    MshElementType{92, Kind::volume, 64, ""},
    MshElementType{93, Kind::volume, 125, ""},
};

} // namespace

const MshElementType* find_msh_element_type(std::uint32_t number) {
    const auto* const found = std::find_if(element_types.begin(), element_types.end(),
                                           [&](const MshElementType& type) { return type.number == number; });
    return found == element_types.end() ? nullptr : found;
}

void MshFaces::Met::add(FacePlace place) {
    first = count == 0 ? place : first;
    ++count;
}

MshFaces::MshFaces(const std::filesystem::path& path, const SceneReaderOptions& options)
    : file_(path.string()), faces_(path, options) {}

std::optional<std::string> MshFaces::add_name(std::string_view line) {
    std::string_view rest = line;
    const auto dimension = parse_integer<std::uint32_t>(next_word(rest));
    const auto number = parse_integer<std::int64_t>(next_word(rest));
    const std::string_view name = trim(rest);
    if (!dimension || *dimension > 3 || !number || name.size() < 2 || !name.starts_with('"') ||
        !name.ends_with('"')) {
        return fmt::format("{}; must be dimension, number and the name in quotes", in_quotes(trim(line)));
    }
    if (*dimension != 2) {
        return std::nullopt;
    }
    const std::string text = to_utf8(name.substr(1, name.size() - 2));
    if (text.empty()) {
        return fmt::format("physical surface {} has an empty name", *number);
    }
    if (!names_.emplace(*number, text).second) {
        return fmt::format("physical surface {} is named twice", *number);
    }
    return std::nullopt;
}

bool MshFaces::add_node(std::uint64_t number, const Vec3& point) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    // Gmsh mostly counts on from 1; only other numbers need a table.
    if (number != std::uint64_t{index} + 1 || !numbers_.empty()) {
        if (numbers_.empty()) {
            for (std::uint32_t k = 0; k < index; ++k) {
                numbers_.emplace(std::uint64_t{k} + 1, k);
            }
        }
        if (!numbers_.emplace(number, index).second) {
            return false;
        }
    }
    nodes_.push_back(point);
    return true;
}

std::optional<std::uint32_t> MshFaces::find_node(std::uint64_t number) const {
    if (numbers_.empty()) {
        return number - 1 < nodes_.size() // 0 becomes too large
                   ? std::optional(static_cast<std::uint32_t>(number - 1))
                   : std::nullopt;
    }
    const auto found = numbers_.find(number);
    return found == numbers_.end() ? std::nullopt : std::optional(found->second);
}

void MshFaces::add_face(const MshElementType& type, Tags tags, std::span<const std::uint32_t> corners,
                        FacePlace place) {
    if (*type.curved != '\0') {
        curved_[type.number].add(place);
    }
    std::array<Vec3, 4> points{};
    Twin twin{{none, none, none, none}, place.line, place.number};
    for (std::size_t c = 0; c < corners.size(); ++c) {
        twin.nodes[c] = corners[c];
        points[c] = nodes_[corners[c]];
    }
    const auto end = twin.nodes.begin() + static_cast<std::ptrdiff_t>(corners.size());
    std::rotate(twin.nodes.begin(), std::min_element(twin.nodes.begin(), end), end);
    twins_.push_back(twin);
    const Group& group = group_of(tags);
    faces_.add({points.data(), corners.size()}, group.group, group.material, place);
}

void MshFaces::leave_out(const MshElementType& type, FacePlace place) {
    (type.kind == Kind::point ? points_ : type.kind == Kind::line ? edges_ : volumes_).add(place);
}

FaceMesh MshFaces::finish(Diagnostics& diagnostics) {
    refuse_twins();
    const char* const faces = "left out, {}; surfaces are triangles and quadrilaterals";
    warn_of(points_, "point", faces, diagnostics);
    warn_of(edges_, "line", faces, diagnostics);
    warn_of(volumes_, "volume element", faces, diagnostics);
    for (const auto& [number, met] : curved_) {
        warn_of(met, find_msh_element_type(number)->curved, "taken as plane between the corners, {}",
                diagnostics);
    }
    return faces_.finish("triangles or quadrilaterals in $Elements", diagnostics);
}

const MshFaces::Group& MshFaces::group_of(Tags tags) {
    tags.physical = std::abs(tags.physical); // below 0: the surface is turned round, as its nodes are
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

/// Gmsh writes a surface once for each physical surface that it belongs to, in its version 2.
void MshFaces::refuse_twins() {
    std::sort(twins_.begin(), twins_.end());
    const auto same = std::adjacent_find(twins_.begin(), twins_.end(),
                                         [](const Twin& a, const Twin& b) { return a.nodes == b.nodes; });
    if (same == twins_.end()) {
        return;
    }
    const Twin& second = *std::next(same);
    constexpr const char* rule = "a face must be in one physical surface";
    if (second.line > 0) {
        throw ParseError(file_, second.line, 0,
                         fmt::format("the face of line {} again; {}", same->line, rule));
    }
    throw InputError(fmt::format("{}: element {}: the face of element {} again; {}", file_, second.number,
                                 same->number, rule));
}

void MshFaces::warn_of(const Met& met, const std::string& noun, const char* what,
                       Diagnostics& diagnostics) const {
    if (met.count > 0) {
        const bool by_line = met.first.line > 0;
        const std::string first =
            by_line ? "the first one here" : fmt::format("the first one is element {}", met.first.number);
        diagnostics.warn(fmt::format("{}{}: {} {}", file_, by_line ? fmt::format(":{}", met.first.line) : "",
                                     plural(met.count, noun, noun + "s"),
                                     fmt::format(fmt::runtime(what), first)));
    }
}

} // namespace hemi::io
