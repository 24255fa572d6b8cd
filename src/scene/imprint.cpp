#include "hemi/scene/imprint.hpp"

#include "core/box_tree.hpp"
#include "core/parallel_for.hpp"
#include "core/splitmix.hpp"
#include "hemi/core/error.hpp"
#include "scene/cavities.hpp"
#include "scene/convex_polygon.hpp"
#include "scene/cut_face.hpp"
#include "scene/joined_faces.hpp"
#include "scene/rectangles.hpp"
#include "scene/surroundings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace hemi {

namespace {

/// What is buried is found from the outside inwards; nothing that people build is deeper.
constexpr int max_rounds = 8;

class Imprinter {
public:
    Imprinter(const Scene& scene, const Subdivision& subdivision)
        : scene_(scene), mesh_(scene, subdivision),
          tolerance_(std::max(contact_share * mesh_.bounds().diagonal(), mesh_.rounding())),
          tree_(boxes(scene)), areas_(scene.surfaces.size()) {
        for (std::uint32_t f = 0; f < areas_.size(); ++f) {
            areas_[f] = glm::length(area_vector(face(f)));
        }
    }

    std::optional<Imprint> run() {
        cut_.resize(scene_.surfaces.size());
        for_each_face([&](std::uint32_t f) {
            Contacts contacts = find_contacts(f);
            if (!contacts.cuts.empty() || !contacts.coplanar.empty()) {
                cut_[f] = cut(f, std::move(contacts));
            }
        });
        if (std::all_of(cut_.begin(), cut_.end(), [](const CutFace& face) { return face.pieces.empty(); })) {
            return std::nullopt;
        }
        for_each_face([&](std::uint32_t f) { cover_by_coplanar(f); });
        // What is covered hides what else is: where bodies pass through one another, each hides parts of the
        // other from the inside of both.
        const WeldedFaces welded = weld(scene_, tolerance_);
        for (int round = 0; round < max_rounds && bury(); ++round) {
            look_at_neighbours(welded);
        }
        return assemble();
    }

private:
    static std::vector<Bounds> boxes(const Scene& scene) {
        std::vector<Bounds> result;
        for (const Surface& surface : scene.surfaces) {
            result.push_back(bounds_of(surface.polygon()));
        }
        return result;
    }

    [[nodiscard]] std::span<const Vec3> face(std::uint32_t f) const { return scene_.surfaces[f].polygon(); }
    [[nodiscard]] const Vec3& normal(std::uint32_t f) const { return mesh_.surface_normal(f); }

    template <class Visit>
    void for_each_face(const Visit& visit) const {
        parallel_for(scene_.surfaces.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f) {
                visit(static_cast<std::uint32_t>(f));
            }
        });
    }

    [[nodiscard]] Contacts find_contacts(std::uint32_t f) const {
        const Bounds around = bounds_of(face(f), tolerance_);
        std::vector<std::uint32_t> others;
        tree_.overlapping(around, [&](std::uint32_t other) {
            if (other != f) {
                others.push_back(other);
            }
        });
        std::sort(others.begin(), others.end());
        Contacts contacts;
        for (const std::uint32_t other : others) {
            add_contact(f, other, contacts);
        }
        return contacts;
    }

    /// Adds where face `other` touches face `f`.
    void add_contact(std::uint32_t f, std::uint32_t other, Contacts& contacts) const {
        const std::span<const Vec3> polygon = face(other);
        const Vec3& origin = face(f)[0];
        std::array<double, 4> height{};
        int above = 0;
        int below = 0;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            height[k] = glm::dot(polygon[k] - origin, normal(f));
            above += height[k] > tolerance_ ? 1 : 0;
            below += height[k] < -tolerance_ ? 1 : 0;
        }
        const std::size_t before = contacts.cuts.size();
        const auto add = [&](const Vec3& from, const Vec3& to) {
            if (const auto segment = within(face(f), normal(f), {from, to}, tolerance_)) {
                contacts.cuts.push_back(*segment);
                contacts.cut_by.push_back(other);
            }
        };
        if (above == 0 && below == 0) {
            if (!overlap(face(f), normal(f), polygon, tolerance_)) {
                return;
            }
            contacts.coplanar.push_back(other);
            for (std::size_t k = 0; k < polygon.size(); ++k) {
                add(polygon[k], polygon[(k + 1) % polygon.size()]);
            }
        } else if (above > 0 || scene_.surfaces[f].two_sided) { // else it is behind the face
            std::vector<Vec3> points;
            for (std::size_t k = 0; k < polygon.size(); ++k) {
                const std::size_t next = (k + 1) % polygon.size();
                if (std::abs(height[k]) <= tolerance_) {
                    points.push_back(polygon[k]);
                } else if (std::abs(height[next]) > tolerance_ && (height[k] > 0.0) != (height[next] > 0.0)) {
                    points.push_back(polygon[k] +
                                     height[k] / (height[k] - height[next]) * (polygon[next] - polygon[k]));
                }
            }
            // Of a quadrilateral with a straight corner three points may lie on one line.
            if (points.size() >= 2) {
                const auto [from, to] = farthest(points);
                add(from, to);
            }
        }
        if (contacts.cuts.size() > before) {
            contacts.other = other;
        }
    }

    static Segment farthest(const std::vector<Vec3>& points) {
        Segment result{points[0], points[1]};
        for (std::size_t a = 0; a < points.size(); ++a) {
            for (std::size_t b = a + 1; b < points.size(); ++b) {
                if (glm::distance(points[a], points[b]) > glm::distance(result.from, result.to)) {
                    result = {points[a], points[b]};
                }
            }
        }
        return result;
    }

    [[nodiscard]] CutFace cut(std::uint32_t f, Contacts contacts) const {
        CutFace face = in_cells(f);
        std::vector<Bounds> cut_boxes(contacts.cuts.size());
        for (std::size_t k = 0; k < cut_boxes.size(); ++k) {
            cut_boxes[k].add(contacts.cuts[k].from);
            cut_boxes[k].add(contacts.cuts[k].to);
        }
        const BoxTree cuts(cut_boxes);
        std::vector<Piece> pieces;
        for (Piece& cell : face.pieces) {
            const Bounds box = bounds_of(cell.corners, tolerance_);
            std::vector<std::uint32_t> here;
            cuts.overlapping(box, [&](std::uint32_t k) { here.push_back(k); });
            // Scattered: cut one behind the other, what is left of a row of bodies would be cut again for
            // each.
            std::sort(here.begin(), here.end(),
                      [](std::uint32_t a, std::uint32_t b) { return splitmix(a) < splitmix(b); });
            DividedPolygon divided(std::move(cell.corners), normal(f), tolerance_);
            for (const std::uint32_t k : here) {
                divided.cut(contacts.cuts[k]);
            }
            std::vector<Polygon> parts = divided.parts();
            cell.whole = parts.size() == 1;
            face.split = face.split || !cell.whole;
            for (Polygon& part : parts) {
                pieces.push_back({std::move(part), cell.cell, cell.whole, cell.front, cell.back});
            }
        }
        face.pieces = std::move(pieces);
        face.contacts = std::move(contacts);
        return face;
    }

    [[nodiscard]] CutFace in_cells(std::uint32_t f) const {
        CutFace face;
        const Grid grid = mesh_.grid(f);
        for (std::uint32_t cell = 0; cell < grid.u * grid.v; ++cell) {
            const PatchCorners corners = mesh_.part_corners(f, {0, 0, cell});
            face.pieces.push_back({{corners.polygon().begin(), corners.polygon().end()},
                                   cell,
                                   true,
                                   true,
                                   scene_.surfaces[f].two_sided});
        }
        return face;
    }

    /// Finds which sides of pieces are covered by faces in their plane.
    void cover_by_coplanar(std::uint32_t f) {
        const std::vector<std::uint32_t>& coplanar = cut_[f].contacts.coplanar;
        if (coplanar.empty()) {
            return;
        }
        std::vector<Bounds> coplanar_boxes;
        for (const std::uint32_t other : coplanar) {
            coplanar_boxes.push_back(bounds_of(face(other), 2.0 * tolerance_));
        }
        const BoxTree tree(coplanar_boxes);
        for (Piece& piece : cut_[f].pieces) {
            const Vec3 centre = area_centroid(piece.corners);
            std::vector<std::uint32_t> here;
            tree.overlapping(bounds_of({&centre, 1}), [&](std::uint32_t k) { here.push_back(coplanar[k]); });
            std::sort(here.begin(), here.end());
            for (const std::uint32_t other : here) {
                if (contains(face(other), normal(other), centre, tolerance_)) {
                    const bool before = piece.is_left();
                    cover(f, other, piece);
                    piece.faced = piece.faced || faces(f, other);
                    cut_[f].covered_by = before && !piece.is_left() ? other : cut_[f].covered_by;
                }
            }
            piece.covered = !piece.is_left();
        }
    }

    /// Whether both faces, which lie in one plane, are one-sided and look different ways.
    [[nodiscard]] bool faces(std::uint32_t f, std::uint32_t other) const {
        return !scene_.surfaces[f].two_sided && !scene_.surfaces[other].two_sided &&
               glm::dot(normal(other), normal(f)) < 0.0;
    }

    /// What face `other` covers of a piece of face `f` that it lies over, in its plane.
    void cover(std::uint32_t f, std::uint32_t other, Piece& piece) const {
        const bool beneath = areas_[other] < (1.0 - 1e-9) * areas_[f] ||
                             (areas_[other] <= (1.0 + 1e-9) * areas_[f] && other > f);
        const bool same = glm::dot(normal(other), normal(f)) > 0.0;
        bool& towards = same ? piece.front : piece.back; // where the front of the other one looks
        bool& away = same ? piece.back : piece.front;
        if (scene_.surfaces[other].two_sided) {
            towards = towards && !beneath;
            away = away && !beneath;
        } else if (scene_.surfaces[f].two_sided) { // a sheet on the back of a face
            away = false;
            towards = towards && !beneath;
        } else if (same) {
            piece.front = piece.front && !beneath;
        }
        // Of one-sided faces back to back, each is seen from its side: whether a body stands there is found
        // by looking.
    }

    [[nodiscard]] Surroundings surroundings() const {
        std::vector<Occluder> occluders;
        for (std::uint32_t f = 0; f < cut_.size(); ++f) {
            const bool sheet = scene_.surfaces[f].two_sided;
            if (cut_[f].pieces.empty()) {
                occluders.push_back({face(f), normal(f), f, Occluder::whole, true, sheet, sheet});
            }
            for (std::uint32_t k = 0; k < cut_[f].pieces.size(); ++k) {
                const Piece& piece = cut_[f].pieces[k];
                if (!piece.covered) { // what is buried hides the rest as before
                    occluders.push_back({piece.corners, normal(f), f, k, piece.front, piece.back, sheet});
                }
            }
        }
        return {std::move(occluders), tolerance_, scene_.symmetry};
    }

    /// What is found of a face by looking.
    struct Found {
        bool buried = false;                ///< sides that see backs alone
        std::vector<EnclosedSide> enclosed; ///< sides
        std::vector<std::uint32_t> wholes;  ///< faces that stand in bodies, with sides of this one
    };

    /// Takes away sides that see backs alone, or in a cavity of a body backs and such sides.
    /// @return whether there were any
    bool bury() {
        const Surroundings around = surroundings();
        std::vector<Found> found(cut_.size());
        for_each_face([&](std::uint32_t f) { found[f] = bury(f, around); });
        std::vector<EnclosedSide> enclosed;
        bool changed = false;
        for (Found& of_face : found) {
            changed = changed || of_face.buried;
            std::move(of_face.enclosed.begin(), of_face.enclosed.end(), std::back_inserter(enclosed));
        }
        for (const PieceSide& side : sides_in_bodies(enclosed, cut_)) {
            Piece& piece = cut_[side.face].pieces[side.piece];
            (side.back ? piece.back : piece.front) = false;
            cut_[side.face].buried = changed = true;
        }
        for (const Found& of_face : found) {
            for (const std::uint32_t whole : of_face.wholes) {
                if (cut_[whole].pieces.empty()) {
                    cut_[whole] = in_cells(whole);
                    changed = true;
                }
            }
        }
        return changed;
    }

    Found bury(std::uint32_t f, const Surroundings& around) {
        CutFace& face = cut_[f];
        Found found;
        if (face.pieces.empty()) {
            return found;
        }
        const std::vector<Vec3> before = hemisphere(normal(f));
        const std::vector<Vec3> behind = hemisphere(-normal(f));
        const auto look = [&](std::uint32_t k, bool back) {
            const Vec3 away = (back ? -4.0 : 4.0) * tolerance_ * normal(f);
            return around.look(f, area_centroid(face.pieces[k].corners) + away, back ? behind : before);
        };
        const auto stays = [&](std::uint32_t k, bool back) {
            Sight sight = look(k, back);
            if (sight.only_backs()) {
                return false;
            }
            if (!sight.open && sight.wholes.empty()) {
                found.enclosed.push_back(
                    {{f, k, back}, glm::length(area_vector(face.pieces[k].corners)), std::move(sight)});
            } else if (!sight.open && 2 * sight.inside >= sight.directions()) {
                found.wholes.insert(found.wholes.end(), sight.wholes.begin(), sight.wholes.end());
            }
            return true;
        };
        for (std::uint32_t k = 0; k < face.pieces.size(); ++k) {
            Piece& piece = face.pieces[k];
            bool front = piece.front && stays(k, false);
            const bool back = piece.back && stays(k, true);
            if (front && piece.faced && look(k, true).only_backs()) {
                front = false; // face to face with the body behind
            }
            found.buried = found.buried || front != piece.front || back != piece.back;
            piece.front = front;
            piece.back = back;
        }
        face.buried = face.buried || found.buried;
        return found;
    }

    /// Faces that share a corner with one that is buried in part may be buried whole.
    void look_at_neighbours(const WeldedFaces& welded) {
        std::vector<std::uint8_t> is_buried(welded.vertex_count, 0);
        for (std::uint32_t f = 0; f < cut_.size(); ++f) {
            for (std::size_t k = 0; cut_[f].buried && k < face(f).size(); ++k) {
                is_buried[welded.corners[f][k]] = 1;
            }
        }
        for (std::uint32_t f = 0; f < cut_.size(); ++f) {
            for (std::size_t k = 0; cut_[f].pieces.empty() && k < face(f).size(); ++k) {
                if (is_buried[welded.corners[f][k]] != 0) {
                    cut_[f] = in_cells(f);
                }
            }
        }
    }

    std::optional<Imprint> assemble() {
        Imprint result;
        result.scene = scene_;
        result.scene.surfaces.clear();
        bool changed = false;
        for (std::uint32_t f = 0; f < cut_.size(); ++f) {
            CutFace& face = cut_[f];
            const bool two_sided = scene_.surfaces[f].two_sided;
            const bool complete =
                !face.split && std::all_of(face.pieces.begin(), face.pieces.end(), [&](const Piece& piece) {
                    return piece.front && piece.back == two_sided;
                });
            if (complete) {
                Surface& whole = result.scene.surfaces.emplace_back(scene_.surfaces[f]);
                whole.patches = mesh_.grid(f);
                for (std::uint32_t patch = mesh_.first_patch(f); patch < mesh_.first_patch(f + 1); ++patch) {
                    result.parts.patch_of.push_back(patch);
                }
            } else {
                changed = true;
                add_rest(f, result);
            }
            result.face_of.resize(result.scene.surfaces.size(), f);
        }
        return changed ? std::optional(std::move(result)) : std::nullopt;
    }

    /// Adds what is left of a face, and what was found.
    void add_rest(std::uint32_t f, Imprint& result) const {
        const CutFace& face = cut_[f];
        const bool two_sided = scene_.surfaces[f].two_sided;
        Cells cells; // those that are whole, of a quadrilateral
        std::vector<const Piece*> pieces;
        for (const Piece& piece : face.pieces) {
            const double area = glm::length(area_vector(piece.corners));
            result.covered += (piece.front ? 0.0 : area) + (two_sided && !piece.back ? area : 0.0);
            const std::uint32_t width = mesh_.grid(f).u;
            if (piece.whole && piece.front && piece.back == two_sided &&
                scene_.surfaces[f].vertex_count == 4) {
                cells[{piece.cell / width, piece.cell % width}] = piece.cell;
            } else if (piece.is_left()) {
                pieces.push_back(&piece);
            }
        }
        const bool gone = cells.empty() && pieces.empty();
        const bool covered = std::all_of(face.pieces.begin(), face.pieces.end(),
                                         [](const Piece& piece) { return piece.covered; });
        if (gone && !covered) {
            result.findings.push_back({Imprint::What::buried, f, no_face}); // by a body, of many faces
        } else if (face.covered_by != no_face) {
            result.findings.push_back(
                {gone ? Imprint::What::duplicate : Imprint::What::overlapped, f, face.covered_by});
        } else {
            result.findings.push_back({Imprint::What::cut, f, face.contacts.other});
        }
        find_divided(f, result);
        while (!cells.empty()) {
            const Rectangle rest = take_rectangle(cells);
            result.scene.surfaces.push_back(rectangle(f, rest));
            add_parts(f, rest.cells, true, two_sided, result);
        }
        for (const Piece* const piece : pieces) {
            const std::size_t before = result.scene.surfaces.size();
            add_surfaces(scene_.surfaces[f], *piece, result.scene.surfaces);
            for (std::size_t k = before; k < result.scene.surfaces.size(); ++k) {
                add_parts(f, std::span(&piece->cell, 1), piece->front, piece->back, result);
            }
        }
    }

    /// Finds patches with parts on both sides of sheets.
    void find_divided(std::uint32_t f, Imprint& result) const {
        const CutFace& face = cut_[f];
        const Contacts& contacts = face.contacts;
        std::vector<std::size_t> sheets;
        for (std::size_t k = 0; k < contacts.cuts.size(); ++k) {
            const bool coplanar =
                std::binary_search(contacts.coplanar.begin(), contacts.coplanar.end(), contacts.cut_by[k]);
            if (scene_.surfaces[contacts.cut_by[k]].two_sided && !coplanar) {
                sheets.push_back(k);
            }
        }
        for (std::size_t first = 0; first < face.pieces.size() && !sheets.empty();) {
            std::size_t end = first; // pieces of one cell follow one another
            while (end < face.pieces.size() && face.pieces[end].cell == face.pieces[first].cell) {
                ++end;
            }
            const std::span<const Piece> parts(&face.pieces[first], end - first);
            for (const bool back : {false, true}) {
                const auto sheet = std::find_if(sheets.begin(), sheets.end(), [&](std::size_t k) {
                    return divides(f, contacts.cuts[k], parts, back);
                });
                if (sheet != sheets.end()) {
                    const std::uint32_t side = back ? mesh_.patches_per_side(f) : 0;
                    result.divided.push_back(
                        {mesh_.first_patch(f) + side + parts[0].cell, f, contacts.cut_by[*sheet]});
                }
            }
            first = end;
        }
    }

    /// Whether a segment passes through half of a cell at least, and parts of one side are left on both of
    /// its own.
    [[nodiscard]] bool divides(std::uint32_t f, const Segment& segment, std::span<const Piece> parts,
                               bool back) const {
        const Vec3 direction = glm::normalize(segment.to - segment.from);
        const Vec3 left = glm::cross(normal(f), direction);
        bool before = false;
        bool behind = false;
        for (const Piece& part : parts) {
            if (back ? part.back : part.front) {
                const double off = glm::dot(area_centroid(part.corners) - segment.from, left);
                before = before || off > tolerance_;
                behind = behind || off < -tolerance_;
            }
        }
        if (!before || !behind) {
            return false;
        }
        const PatchCorners cell = mesh_.part_corners(f, {0, 0, parts[0].cell});
        const auto length = [&](const Segment& line) {
            const auto inside = within(cell.polygon(), normal(f), line, tolerance_);
            return inside ? glm::distance(inside->from, inside->to) : 0.0;
        };
        const Vec3 far = mesh_.bounds().diagonal() * direction;
        return 2.0 * length(segment) >= length({segment.from - far, segment.to + far});
    }

    /// Says which patches those of a new surface are parts of: cells of face `f`, of its sides that are left.
    void add_parts(std::uint32_t f, std::span<const std::uint32_t> cells, bool front, bool back,
                   Imprint& result) const {
        for (const std::uint32_t side : {0u, 1u}) {
            const std::uint32_t first = mesh_.first_patch(f) + side * mesh_.patches_per_side(f);
            for (std::size_t k = 0; (side == 0 ? front : back) && k < cells.size(); ++k) {
                result.parts.patch_of.push_back(first + cells[k]);
            }
        }
    }

    /// A surface of whole cells.
    [[nodiscard]] Surface rectangle(std::uint32_t f, const Rectangle& cells) const {
        const std::uint32_t width = mesh_.grid(f).u;
        const auto corner = [&](std::uint32_t row, std::uint32_t column, std::size_t which) {
            return mesh_.part_corners(f, {0, 0, row * width + column}).points[which];
        };
        const std::uint32_t last_row = cells.row + cells.rows - 1;
        const std::uint32_t last_column = cells.column + cells.columns - 1;
        Surface surface = scene_.surfaces[f];
        surface.vertices = {corner(cells.row, cells.column, 0), corner(cells.row, last_column, 1),
                            corner(last_row, last_column, 2), corner(last_row, cells.column, 3)};
        surface.patches = Grid{cells.columns, cells.rows};
        return surface;
    }

    /// Surfaces of one patch that make up a piece.
    void add_surfaces(const Surface& whole, const Piece& piece, std::vector<Surface>& surfaces) const {
        Polygon corners = without_straight_corners(piece.corners, tolerance_);
        if (!piece.front) {
            std::reverse(corners.begin(), corners.end());
        }
        Surface surface = whole;
        surface.two_sided = piece.front && piece.back;
        surface.patches = Grid{1, 1};
        for (std::size_t k = 1; k + 1 < corners.size();) {
            const bool four = k + 2 < corners.size();
            surface.vertices = {corners[0], corners[k], corners[k + 1], four ? corners[k + 2] : Vec3(0.0)};
            surface.vertex_count = four ? 4 : 3;
            if (is_wide(surface.polygon(), tolerance_)) {
                surfaces.push_back(surface);
            }
            k += four ? 2 : 1;
        }
    }

    const Scene& scene_;
    PatchMesh mesh_;
    double tolerance_;
    BoxTree tree_;
    std::vector<double> areas_;
    std::vector<CutFace> cut_; ///< of every face; without pieces: it is not looked at
};

/// A scene of which nothing is cut, every surface with its own subdivision.
Imprint uncut(const Scene& scene, const PatchMesh& mesh) {
    Imprint result;
    result.scene = scene;
    for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        result.scene.surfaces[s].patches = mesh.grid(s);
        result.face_of.push_back(s);
    }
    result.parts.patch_of.resize(mesh.size());
    std::iota(result.parts.patch_of.begin(), result.parts.patch_of.end(), 0u);
    return result;
}

/// Cuts the faces, whatever pieces they were read in: parts are of patches of the pieces, and have no groups
/// yet.
std::optional<Imprint> imprint_contacts(const Scene& scene, const Subdivision& subdivision) {
    const Joined joined = join_back_to_back(scene, subdivision);
    std::optional<Imprint> result = Imprinter(joined.scene, subdivision).run();
    if (!result && joined.findings.empty()) {
        return std::nullopt;
    }
    const PatchMesh mesh(joined.scene, subdivision);
    if (!result) {
        result = uncut(joined.scene, mesh);
    }
    const std::vector<std::uint32_t> before = patches_before(joined, mesh, PatchMesh(scene, subdivision));
    for (std::uint32_t& patch : result->parts.patch_of) {
        patch = before[patch];
    }
    for (std::uint32_t& face : result->face_of) {
        face = joined.face_of[face];
    }
    for (Imprint::Divided& divided : result->divided) {
        divided.patch = before[divided.patch];
        divided.face = joined.face_of[divided.face];
        divided.sheet = joined.face_of[divided.sheet];
    }
    for (Imprint::Finding& finding : result->findings) {
        finding.face = joined.face_of[finding.face];
        finding.other = finding.other == no_face ? no_face : joined.face_of[finding.other];
    }
    result->covered += joined.left_out;
    result->findings.insert(result->findings.end(), joined.findings.begin(), joined.findings.end());
    std::stable_sort(result->findings.begin(), result->findings.end(),
                     [](const auto& one, const auto& other) { return one.face < other.face; });
    return result;
}

/// The first surface of the face that a surface is of.
std::uint32_t first_piece(const Scene& scene, std::uint32_t surface) {
    while (surface > 0 && scene.surfaces[surface].continues) {
        --surface;
    }
    return surface;
}

/// What was done to whole faces, where it was done to surfaces, ascending: a face is left out where all its
/// pieces are. Else what is told of it is the first of: it is overlapped, cut, joined to another.
std::vector<Imprint::Finding> findings_of_faces(const Scene& scene, std::vector<Imprint::Finding> findings) {
    using What = Imprint::What;
    std::vector<std::uint32_t> first_of(scene.surfaces.size());
    std::vector<std::uint32_t> pieces(scene.surfaces.size(), 0); // of faces, at their first surface
    for (std::uint32_t s = 0; s < scene.surfaces.size(); ++s) {
        first_of[s] = s > 0 && scene.surfaces[s].continues ? first_of[s - 1] : s;
        ++pieces[first_of[s]];
    }
    const auto of_part = [](What what) {
        return what == What::duplicate ? What::overlapped : what == What::buried ? What::cut : what;
    };
    std::vector<Imprint::Finding> result;
    for (auto at = findings.begin(); at != findings.end();) {
        const std::uint32_t face = first_of[at->face];
        const auto end =
            std::find_if(at, findings.end(), [&](const auto& other) { return first_of[other.face] != face; });
        const bool gone =
            static_cast<std::uint32_t>(end - at) == pieces[face] &&
            std::all_of(at, end, [&](const auto& found) { return found.what != of_part(found.what); });
        if (!gone) {
            std::for_each(at, end, [&](auto& found) { found.what = of_part(found.what); });
        }
        Imprint::Finding told = *std::min_element( // as they are listed
            at, end, [](const auto& one, const auto& other) { return one.what < other.what; });
        told.face = face;
        told.other = told.other == no_face ? no_face : first_of[told.other];
        result.push_back(told);
        at = end;
    }
    return result;
}

} // namespace

std::optional<Imprint> imprint(const Scene& scene, const Subdivision& subdivision, bool contacts) {
    if (!subdivision.parts.empty()) {
        throw InvalidArgument("imprint: patches of different sizes cannot be cut; cut the scene before");
    }
    std::optional<Imprint> result = contacts ? imprint_contacts(scene, subdivision) : std::nullopt;
    const bool in_pieces = std::any_of(scene.surfaces.begin(), scene.surfaces.end(),
                                       [](const Surface& surface) { return surface.continues; });
    if (!result && !in_pieces) {
        return std::nullopt;
    }
    const PatchMesh as_read(scene, subdivision);
    const WholeFaces whole = as_read.whole_faces();
    if (!result && whole.mesh.size() == as_read.size()) {
        return std::nullopt;
    }
    if (!result) {
        result = uncut(scene, as_read);
    }
    for (std::uint32_t& patch : result->parts.patch_of) {
        patch = whole.patch_of[patch];
    }
    for (Imprint::Divided& divided : result->divided) {
        divided.patch = whole.patch_of[divided.patch];
        divided.face = first_piece(scene, divided.face);
        divided.sheet = first_piece(scene, divided.sheet);
    }
    std::sort(result->divided.begin(), result->divided.end(),
              [](const auto& one, const auto& other) { return one.patch < other.patch; });
    const auto same = [](const auto& one, const auto& other) { return one.patch == other.patch; };
    result->divided.erase(std::unique(result->divided.begin(), result->divided.end(), same),
                          result->divided.end());
    for (std::uint32_t i = 0; i < whole.mesh.size(); ++i) {
        result->parts.group_of.push_back(whole.mesh.group(i));
    }
    for (Surface& surface : result->scene.surfaces) {
        surface.continues = false;
        surface.joins = false;
    }
    result->findings = findings_of_faces(scene, std::move(result->findings));
    return result;
}

} // namespace hemi
