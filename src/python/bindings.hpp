#pragma once

#include "hemi/core/error.hpp"
#include "hemi/core/names.hpp"
#include "hemi/core/nearest_word.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/imprint.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h> // here, so that no source goes without it: casts would differ

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hemi::python {

namespace py = pybind11;

/// hemi.Scene: a scene and its patches. Never changes.
struct PatchedScene {
    Scene scene;
    Subdivision subdivision;
    PatchMesh mesh;
    std::vector<std::uint32_t> face_of;    ///< of its surfaces, the faces as they were read; none: the same
    std::vector<Surface> surfaces_as_read; ///< as io::ResultFile has them
    PatchParts parts;                      ///< as well

    /// @throws as PatchMesh's constructor
    PatchedScene(Scene the_scene, Subdivision the_subdivision);
    /// What is left of a scene's faces.
    PatchedScene(const Scene& as_read, const Subdivision& the_subdivision, Imprint cut);
};
using ScenePointer = std::shared_ptr<PatchedScene>;

/// hemi.FormFactors. Rows never change.
struct FactorsOfScene {
    ScenePointer scene;                   ///< may be null: from a file
    FormFactors factors;                  ///< prepared
    FactorSettings settings;              ///< they were computed by; of a file: the usual ones
    std::optional<FormFactors> raw;       ///< as computed, for `.hff`; none where the file had no more than F
    std::optional<py::object> csr;        ///< `matrix`, once it was asked for
    std::optional<py::object> visibility; ///< likewise
};

/// hemi.Solution. Never changes.
struct SolutionOfScene {
    ScenePointer scene; ///< may be null: of form factors from a file
    Solution solution;
    bool scene_values = true; ///< reflectance, exitance and environment are the scene's
};

/// The enumerator of a word that was given as an argument.
/// @throws InvalidArgument
template <class Enum>
Enum argument_word(const char* argument, const std::string& word) {
    if (const auto value = from_word<Enum>(word)) {
        return *value;
    }
    throw InvalidArgument(
        fmt::format("there is no {} \"{}\"{}", argument, word, did_you_mean_or_list(word, words<Enum>())));
}

/// Radiosity of a scene, or of patches with these values.
SolutionOfScene solve(const FactorsOfScene& factors, const py::object& reflectance,
                      const py::object& exitance, const py::object& environment, const std::string& method,
                      double tolerance, bool irradiance, bool estimate, const std::string& gather,
                      const py::object& progress);

/// What hemi.load() makes of a `.hres`.
SolutionOfScene read_solution(const std::string& path);

// Each adds its part to the module.
void bind_errors(py::module_& module);
void bind_scene(py::module_& module);
void bind_factors(py::module_& module);
void bind_solution(py::module_& module);

} // namespace hemi::python
