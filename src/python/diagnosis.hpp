#pragma once

#include "hemi/matrix/form_factors.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <pybind11/pybind11.h>

namespace hemi::python {

/// What FormFactors.check() returns.
/// @param factors        prepared
/// @param mesh           the patches, or null where they are not known
/// @param max_row_error  tolerance, see diagnose()
pybind11::dict check(const FormFactors& factors, const PatchMesh* mesh, double max_row_error);

} // namespace hemi::python
