#include "cli/findings.hpp"

#include "cli/report.hpp"
#include "hemi/engine/leaks.hpp"
#include "hemi/scene/near_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace hemi::cli {

namespace {

// Not declared and leaking: nearly closed if so few rows leak, or if so little is lost altogether.
constexpr double few_rows = 0.05;
constexpr double little_lost = 0.001;
// A turned surface sends back about its own area in blocked shares; a roof that nothing can see sends none.
constexpr double turned_above = 0.1;
// float32 values may round up by a few units in the last place.
constexpr double rounding = 1e-6;

void sort_worst_first(std::vector<PatchFinding>& findings) {
    std::stable_sort(findings.begin(), findings.end(),
                     [](const PatchFinding& a, const PatchFinding& b) { return a.share > b.share; });
}

/// Area mean of what the known rows lose to the environment.
double lost_share(const io::FactorFile& file) {
    double lost = 0.0;
    double area = 0.0;
    for (std::uint32_t i = 0; i < file.factors.size(); ++i) {
        if (file.factors.known(i)) {
            lost += file.areas[i] * file.factors.row(i).environment;
            area += file.areas[i];
        }
    }
    return area > 0.0 ? lost / area : 0.0;
}

EnclosureVerdict judge_enclosure(const io::FactorFile& file, const RowSums& sums) {
    if (file.enclosure == "closed" || (file.enclosure == "auto" && sums.leaking == 0)) {
        return EnclosureVerdict::closed;
    }
    const bool nearly = sums.leaking < few_rows * sums.known || lost_share(file) < little_lost;
    return file.enclosure == "auto" && nearly ? EnclosureVerdict::nearly_closed : EnclosureVerdict::open;
}

void look_at_rows(Findings& findings, const FormFactorMatrix& factors, double max_row_error) {
    const double leak_above = findings.enclosure == EnclosureVerdict::closed ? max_row_error : 0.0;
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        if (!factors.known(i)) {
            continue;
        }
        const RowView row = factors.row(i);
        if (findings.enclosure != EnclosureVerdict::open && row.environment > leak_above) {
            findings.leaks.push_back({i, row.environment});
        }
        if (row.blocked > buried_above) {
            findings.covered.push_back({i, row.blocked});
        } else if (row.blocked > max_row_error) {
            findings.blocked.push_back({i, row.blocked});
        }
        for (const float value : row.values) {
            findings.largest_factor = std::max<double>(findings.largest_factor, value);
            findings.outside_bounds += value > 1.0 + rounding ? 1 : 0;
        }
        findings.outside_bounds += row.sum() > 1.0 + rounding ? 1 : 0;
    }
    sort_worst_first(findings.leaks);
    sort_worst_first(findings.blocked);
}

std::vector<bool> seen_patches(const FormFactorMatrix& factors) {
    std::vector<bool> seen(factors.size(), false);
    for (const RowBlock& block : factors.blocks()) {
        for (std::size_t k = 0; k < block.columns.size(); ++k) {
            if (block.values[k] > 0.0f) {
                seen[block.columns[k]] = true;
            }
        }
    }
    return seen;
}

/// Patches that belong together when asking whether a front is seen: a surface, else a group.
struct Unit {
    std::uint32_t group = 0;
    std::uint32_t patches = 0;
    double area = 0.0;
    bool suspect = true; ///< until one of its patches is seen, covered, or has a back that radiates
};

void look_at_columns(Findings& findings, const io::FactorFile& file, const PatchMesh* mesh) {
    const FormFactorMatrix& factors = file.factors;
    const std::vector<bool> seen = seen_patches(factors);
    std::vector<Unit> units(mesh != nullptr ? mesh->surfaces().size() : file.groups.size());
    for (std::uint32_t i = 0; i < factors.size(); ++i) {
        const bool covered = factors.row(i).blocked > buried_above;
        const std::uint32_t index = mesh != nullptr ? mesh->surface_of()[i] : file.group_of[i];
        Unit& unit = units[index];
        unit.group = file.group_of[i];
        ++unit.patches;
        unit.area += file.areas[i];
        unit.suspect =
            unit.suspect && !seen[i] && !covered && (mesh == nullptr || !mesh->surfaces()[index].two_sided);
        if (!seen[i] && !covered) {
            findings.unseen.push_back({i, 0.0});
        }
    }
    double blocked_area = 0.0;
    for (const PatchFinding& finding : findings.blocked) {
        blocked_area += file.areas[finding.patch] * finding.share;
    }
    std::map<std::uint32_t, TurnedGroup> turned;
    for (const Unit& unit : units) {
        if (unit.suspect && unit.patches > 0 && blocked_area > turned_above * unit.area) {
            TurnedGroup& group = turned[unit.group];
            group.group = unit.group;
            group.surfaces += mesh != nullptr ? 1 : 0;
            group.patches += unit.patches;
        }
    }
    for (const auto& [index, group] : turned) {
        findings.turned.push_back(group);
    }
}

/// Tells patches that something stands on from those that meet back faces for no such reason.
void look_at_near_surfaces(Findings& findings, const PatchMesh& mesh) {
    for (const NearSurface& near : find_near_surfaces(mesh)) {
        const auto blocked =
            std::find_if(findings.blocked.begin(), findings.blocked.end(),
                         [&near](const PatchFinding& finding) { return finding.patch == near.patch; });
        if (blocked != findings.blocked.end()) {
            findings.straddled.push_back(*blocked);
            findings.blocked.erase(blocked);
        } else if (!std::any_of(
                       findings.covered.begin(), findings.covered.end(),
                       [&near](const PatchFinding& finding) { return finding.patch == near.patch; })) {
            findings.near.push_back({near.patch, near.gap});
        }
    }
    sort_worst_first(findings.straddled);
    std::stable_sort(findings.near.begin(), findings.near.end(),
                     [](const PatchFinding& a, const PatchFinding& b) { return a.share < b.share; });
}

void look_where_leaks_go(Findings& findings, const PatchMesh& mesh) {
    std::vector<std::uint32_t> shown;
    for (std::size_t k = 0; k < std::min(findings_shown, findings.leaks.size()); ++k) {
        shown.push_back(findings.leaks[k].patch);
    }
    const auto directions = leak_directions(mesh, shown);
    for (std::size_t k = 0; k < shown.size(); ++k) {
        findings.leaks[k].towards = directions[k];
    }
}

void judge(Findings& findings, double max_row_error) {
    const auto fail = [&findings](std::size_t count, std::string_view one, std::string_view many) {
        if (count > 0) {
            findings.failures.push_back(plural(count, one, many));
        }
    };
    if (findings.enclosure == EnclosureVerdict::closed) {
        fail(findings.leaks.size(), "patch leaks", "patches leak");
    }
    fail(findings.blocked.size(), "uncovered patch meets back faces", "uncovered patches meet back faces");
    fail(findings.outside_bounds, "factor or row sum is above 1", "factors or row sums are above 1");
    if (findings.sums.balance_error_max > max_row_error) {
        findings.failures.push_back(
            fmt::format("rows do not balance, by up to {:.3g}", findings.sums.balance_error_max));
    }
}

} // namespace

Findings find_defects(const io::FactorFile& file, const PatchMesh* mesh, double max_row_error) {
    Findings findings;
    findings.sums = row_sums(file.factors);
    findings.reciprocity = reciprocity(file.factors, file.areas);
    findings.all_known = file.factors.all_known();
    findings.declared = file.enclosure != "auto";
    findings.enclosure = judge_enclosure(file, findings.sums);
    look_at_rows(findings, file.factors, max_row_error);
    if (findings.all_known) {
        look_at_columns(findings, file, mesh);
    }
    if (mesh != nullptr) {
        look_at_near_surfaces(findings, *mesh);
        look_where_leaks_go(findings, *mesh);
    }
    judge(findings, max_row_error);
    return findings;
}

} // namespace hemi::cli
