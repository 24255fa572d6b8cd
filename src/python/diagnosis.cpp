#include "python/diagnosis.hpp"

#include "hemi/core/error.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "python/bindings.hpp"
#include "python/work.hpp"

#include <array>
#include <string>
#include <vector>

namespace hemi::python {

namespace {

py::list patch_list(const std::vector<PatchFinding>& findings) {
    py::list list;
    for (const PatchFinding& finding : findings) {
        py::dict entry;
        entry["patch"] = finding.patch;
        entry["share"] = finding.share;
        if (finding.towards) {
            entry["towards"] = std::array{finding.towards->x, finding.towards->y, finding.towards->z};
        }
        list.append(entry);
    }
    return list;
}

py::list group_list(const std::vector<ReversedGroup>& groups, const std::vector<std::string>& names) {
    py::list list;
    for (const ReversedGroup& group : groups) {
        py::dict entry;
        entry["group"] = names.at(group.group);
        entry["faces"] = group.surfaces > 0 ? py::object(py::int_(group.surfaces)) : py::none();
        entry["patches"] = group.patches;
        list.append(entry);
    }
    return list;
}

py::dict row_sum_dict(const RowSums& sums) {
    py::dict result;
    result["min"] = sums.min;
    result["max"] = sums.max;
    result["mean"] = sums.mean;
    return result;
}

py::dict reciprocity_dict(const Reciprocity& reciprocity) {
    py::dict result;
    result["rms"] = reciprocity.rms;
    result["max"] = reciprocity.max;
    result["relative_rms"] = reciprocity.relative_rms;
    result["relative_max"] = reciprocity.relative_max;
    result["worst"] = std::array{reciprocity.worst_i, reciprocity.worst_j};
    result["pairs"] = reciprocity.pairs;
    return result;
}

} // namespace

py::dict check(const FormFactors& factors, const PatchMesh* mesh, double max_row_error) {
    if (factors.areas.size() != factors.matrix.size()) {
        throw InvalidArgument("the areas of these form factors are not known; load them with their scene");
    }
    const Diagnosis diagnosis = run([&] { return diagnose(factors, mesh, max_row_error); });
    py::dict result;
    result["ok"] = diagnosis.failures.empty();
    result["failures"] = diagnosis.failures;
    result["enclosure"] = std::string(to_word(diagnosis.enclosure));
    result["declared"] = diagnosis.declared;
    result["patches"] = factors.matrix.size();
    result["rows"] = diagnosis.sums.known;
    result["row_sum"] = row_sum_dict(diagnosis.sums);
    result["environment_max"] = diagnosis.sums.environment_max;
    result["back_faces_max"] = diagnosis.sums.blocked_max;
    result["balance_error"] = diagnosis.sums.balance_error_max;
    result["largest_factor"] = diagnosis.largest_factor;
    result["above_one"] = diagnosis.outside_bounds;
    result["reciprocity"] =
        diagnosis.reciprocity.pairs > 0 ? py::object(reciprocity_dict(diagnosis.reciprocity)) : py::none();
    result["leaks"] = patch_list(diagnosis.leaks);
    result["buried"] = patch_list(diagnosis.buried);
    result["back_faces"] = patch_list(diagnosis.back_faces);
    result["partly_buried"] = patch_list(diagnosis.partly_buried);
    result["outside"] = patch_list(diagnosis.outside);
    result["close"] = patch_list(diagnosis.close);
    result["never_visible"] =
        diagnosis.all_known ? py::object(patch_list(diagnosis.never_visible)) : py::none();
    result["reversed"] = group_list(diagnosis.reversed, factors.groups);
    result["max_row_error"] = max_row_error;
    return result;
}

} // namespace hemi::python
