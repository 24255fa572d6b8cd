#include "hemi/pipeline/diagnosis.hpp"

#include "hemi/core/buried.hpp"
#include "hemi/core/text.hpp"
#include "hemi/engine/leaks.hpp"
#include "hemi/matrix/source_clusters.hpp"
#include "hemi/scene/near_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace hemi {

namespace {

// Not declared and leaking: nearly closed if so few rows leak, or if so little is lost altogether and most do
// not: a long duct loses little as well, but through all of its walls.
constexpr double max_leaking_rows = 0.05;
constexpr double max_lost_share = 0.001;
// A reversed surface sends back about its own area in back-face shares; a roof that nothing can see sends
// none.
constexpr double reversed_above = 0.1;
// Of all area: bodies that stick out of a room, not a room with a window beside one without.
constexpr double max_outside = 0.1;
// float32 values may round up by a few units in the last place.
constexpr double rounding = 1e-6;
// Those of clusters are packed: up to 2e-6 of themselves, see PackedEntries.
constexpr double rounding_of_clusters = 2e-6;

void sort_worst_first(std::vector<PatchFinding>& findings) {
    std::stable_sort(findings.begin(), findings.end(),
                     [](const PatchFinding& a, const PatchFinding& b) { return a.share > b.share; });
}

/// Area mean of what the known rows lose to the environment.
double lost_share(const FormFactors& file) {
    double lost = 0.0;
    double area = 0.0;
    for (std::uint32_t i = 0; i < file.matrix.size(); ++i) {
        if (file.matrix.known(i)) {
            lost += file.areas[i] * file.matrix.environment(i);
            area += file.areas[i];
        }
    }
    return area > 0.0 ? lost / area : 0.0;
}

EnclosureVerdict judge_enclosure(const FormFactors& file, const RowSums& sums) {
    if (file.enclosure == Enclosure::closed ||
        (file.enclosure == Enclosure::automatic && sums.leaking == 0)) {
        return EnclosureVerdict::closed;
    }
    const bool few = sums.leaking < max_leaking_rows * sums.known;
    const bool nearly = few || (2 * sums.leaking <= sums.known && lost_share(file) < max_lost_share);
    return file.enclosure == Enclosure::automatic && nearly ? EnclosureVerdict::nearly_closed
                                                            : EnclosureVerdict::open;
}

void examine_rows(Diagnosis& diagnosis, const FormFactorMatrix& factors, double max_row_error) {
    const double leak_above = diagnosis.enclosure == EnclosureVerdict::closed ? max_row_error : 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (!factors.known(i)) {
            continue;
        }
        const RowView row = factors.row(i);
        if (diagnosis.enclosure != EnclosureVerdict::open && row.environment > leak_above) {
            diagnosis.leaks.push_back({i, row.environment});
        }
        if (row.blocked > buried_above) {
            diagnosis.buried.push_back({i, row.blocked});
        } else if (row.blocked > max_row_error) {
            diagnosis.back_faces.push_back({i, row.blocked});
        }
        for (const float value : row.values) {
            diagnosis.largest_factor = std::max<double>(diagnosis.largest_factor, value);
            diagnosis.outside_bounds += value > 1.0 + rounding ? 1 : 0;
        }
        const double of_sum = factors.clusters() == nullptr ? rounding : rounding_of_clusters;
        diagnosis.outside_bounds += row.sum() > 1.0 + of_sum ? 1 : 0;
    }
    sort_worst_first(diagnosis.leaks);
    sort_worst_first(diagnosis.back_faces);
}

/// What rows see of patches, and of clusters as a whole.
std::vector<bool> seen_patches(const FormFactorMatrix& factors) {
    std::vector<bool> seen(factors.columns(), false);
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const RowView row = factors.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            seen[row.columns[k]] = seen[row.columns[k]] || row.values[k] > 0.0F;
        }
    }
    if (factors.clusters() == nullptr) {
        return seen;
    }
    const SourceClusters& clusters = *factors.clusters();
    for (std::uint32_t node = 0; node < clusters.nodes().size(); ++node) { // parents before their children
        if (const std::uint32_t child = clusters.nodes()[node].child; !seen[factors.size() + node]) {
            continue;
        } else if (child == 0) {
            seen[clusters.patches(node).front()] = true;
        } else {
            seen[factors.size() + child] = seen[factors.size() + child + 1] = true;
        }
    }
    return seen;
}

/// Patches that belong together when asking whether a front is seen: a surface, else a group.
struct Unit {
    std::uint32_t group = 0;
    std::uint32_t patches = 0;
    double area = 0.0;
    bool suspect = true; ///< until one of its patches is seen, buried, or has a back that radiates
};

void examine_columns(Diagnosis& diagnosis, const FormFactors& file, const PatchMesh* mesh) {
    const FormFactorMatrix& factors = file.matrix;
    const std::vector<bool> seen = seen_patches(factors);
    std::vector<Unit> units(mesh != nullptr ? mesh->surfaces().size() : file.groups.size());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const bool buried = factors.blocked(i) > buried_above;
        const std::uint32_t index = mesh != nullptr ? mesh->surface_of()[i] : file.group_of[i];
        Unit& unit = units[index];
        unit.group = file.group_of[i];
        ++unit.patches;
        unit.area += file.areas[i];
        unit.suspect =
            unit.suspect && !seen[i] && !buried && (mesh == nullptr || !mesh->surfaces()[index].two_sided);
        if (!seen[i] && !buried) {
            diagnosis.never_visible.push_back({i, 0.0});
        }
    }
    double back_face_area = 0.0;
    for (const PatchFinding& finding : diagnosis.back_faces) {
        back_face_area += file.areas[finding.patch] * finding.share;
    }
    std::map<std::uint32_t, ReversedGroup> reversed;
    const auto is_reversed = [back_face_area](const Unit& unit) {
        return unit.suspect && unit.patches > 0 && back_face_area > reversed_above * unit.area;
    };
    for (const Unit& unit : units) {
        if (is_reversed(unit)) {
            ReversedGroup& group = reversed[unit.group];
            group.group = unit.group;
            group.surfaces += mesh != nullptr ? 1 : 0;
            group.patches += unit.patches;
        }
    }
    for (const auto& [index, group] : reversed) {
        diagnosis.reversed.push_back(group);
    }
    for (std::uint32_t i = 0; i < factors.size() && !reversed.empty(); ++i) {
        if (is_reversed(units[mesh != nullptr ? mesh->surface_of()[i] : file.group_of[i]])) {
            diagnosis.turned.push_back(i);
        }
    }
}

/// Parts patches that something stands on from those that meet back faces for no such reason.
void examine_close_surfaces(Diagnosis& diagnosis, const PatchMesh& mesh) {
    for (const NearSurface& near : find_near_surfaces(mesh)) {
        const auto found =
            std::find_if(diagnosis.back_faces.begin(), diagnosis.back_faces.end(),
                         [&near](const PatchFinding& finding) { return finding.patch == near.patch; });
        if (found != diagnosis.back_faces.end()) {
            diagnosis.partly_buried.push_back(*found);
            diagnosis.back_faces.erase(found);
        } else if (!std::any_of(
                       diagnosis.buried.begin(), diagnosis.buried.end(),
                       [&near](const PatchFinding& finding) { return finding.patch == near.patch; })) {
            diagnosis.close.push_back({near.patch, near.gap});
        }
    }
    sort_worst_first(diagnosis.partly_buried);
    std::stable_sort(diagnosis.close.begin(), diagnosis.close.end(),
                     [](const PatchFinding& a, const PatchFinding& b) { return a.share < b.share; });
}

/// Sets apart what sticks out of an enclosure: of what it sees there nothing tells anything of the enclosure.
void set_apart_outside(Diagnosis& diagnosis, const FormFactors& file, double max_row_error) {
    const FormFactorMatrix& factors = file.matrix;
    std::vector<bool> outside(factors.size());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        outside[i] = factors.environment(i) > max_row_error;
    }
    std::vector<double> inside(factors.columns(), 0.0); // of patches 1 or 0, of clusters the share of them
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        inside[i] = outside[i] ? 0.0 : 1.0;
    }
    const auto sees_inside = [&](std::uint32_t i) {
        const RowView row = factors.row(i);
        double seen = 0.0;
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            seen += inside[row.columns[k]] * static_cast<double>(row.values[k]);
        }
        return seen > max_row_error;
    };
    for (bool changed = true; changed;) {
        changed = false;
        if (factors.clusters() != nullptr) {
            factors.clusters()->fill(inside, 1);
        }
        for (std::uint32_t i = 0; i < factors.size(); ++i) {
            if (outside[i] && sees_inside(i)) {
                outside[i] = false;
                inside[i] = 1.0;
                changed = true;
            }
        }
    }
    double area = 0.0;
    double area_outside = 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        area += file.areas[i];
        area_outside += outside[i] ? file.areas[i] : 0.0;
    }
    if (area_outside > max_outside * area) {
        return;
    }
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (outside[i]) {
            diagnosis.outside.push_back({i, factors.environment(i)});
        }
    }
    for (std::vector<PatchFinding>* findings :
         {&diagnosis.back_faces, &diagnosis.partly_buried, &diagnosis.buried}) {
        std::erase_if(*findings, [&](const PatchFinding& finding) { return outside[finding.patch]; });
    }
    sort_worst_first(diagnosis.outside);
}

void find_leak_directions(Diagnosis& diagnosis, const PatchMesh& mesh) {
    std::vector<std::uint32_t> shown;
    for (std::size_t k = 0; k < std::min(Diagnosis::shown, diagnosis.leaks.size()); ++k) {
        shown.push_back(diagnosis.leaks[k].patch);
    }
    const auto directions = leak_directions(mesh, shown);
    for (std::size_t k = 0; k < shown.size(); ++k) {
        diagnosis.leaks[k].towards = directions[k];
    }
}

void list_failures(Diagnosis& diagnosis, double max_row_error) {
    const auto fail = [&diagnosis](std::size_t count, std::string_view one, std::string_view many) {
        if (count > 0) {
            diagnosis.failures.push_back(plural(count, one, many));
        }
    };
    if (diagnosis.enclosure == EnclosureVerdict::closed) {
        fail(diagnosis.leaks.size(), "patch leaks", "patches leak");
    }
    fail(diagnosis.back_faces.size(), "patch meets back faces", "patches meet back faces");
    fail(diagnosis.outside_bounds, "factor or row sum is above 1", "factors or row sums are above 1");
    if (diagnosis.sums.balance_error_max > max_row_error) {
        diagnosis.failures.push_back(
            fmt::format("rows do not balance, by up to {:.3g}", diagnosis.sums.balance_error_max));
    }
}

} // namespace

EnclosureFinding find_leaks(const FormFactors& factors, double max_row_error) {
    const FormFactorMatrix& matrix = factors.matrix;
    EnclosureFinding finding;
    finding.declared = factors.enclosure == Enclosure::closed;
    bool leaks = false;
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        const double share = matrix.known(i) ? matrix.environment(i) : 0.0;
        leaks = leaks || share > 0.0;
        if (finding.declared && share > max_row_error) {
            finding.leaks.push_back(i);
        }
    }
    finding.closed = finding.declared || (factors.enclosure == Enclosure::automatic && !leaks);
    std::stable_sort(finding.leaks.begin(), finding.leaks.end(), [&](std::uint32_t a, std::uint32_t b) {
        return matrix.environment(a) > matrix.environment(b);
    });
    return finding;
}

Diagnosis diagnose(const FormFactors& file, const PatchMesh* mesh, double max_row_error) {
    Diagnosis diagnosis;
    diagnosis.sums = row_sums(file.matrix);
    if (file.matrix.clusters() == nullptr) {
        diagnosis.reciprocity = reciprocity(file.matrix, file.areas);
    }
    diagnosis.all_known = file.matrix.all_known();
    diagnosis.declared = file.enclosure != Enclosure::automatic;
    diagnosis.enclosure = judge_enclosure(file, diagnosis.sums);
    examine_rows(diagnosis, file.matrix, max_row_error);
    if (diagnosis.all_known) {
        examine_columns(diagnosis, file, mesh);
    }
    if (mesh != nullptr) {
        examine_close_surfaces(diagnosis, *mesh);
    }
    if (diagnosis.all_known) {
        set_apart_outside(diagnosis, file, max_row_error);
    }
    if (mesh != nullptr) {
        find_leak_directions(diagnosis, *mesh);
    }
    list_failures(diagnosis, max_row_error);
    return diagnosis;
}

} // namespace hemi
