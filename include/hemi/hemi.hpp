#pragma once

#include "hemi/core/error.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/io/result_file.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/pipeline/accuracy.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "hemi/pipeline/form_factors.hpp"
#include "hemi/pipeline/heat.hpp"
#include "hemi/pipeline/patch_size_error.hpp"
#include "hemi/pipeline/picture.hpp"
#include "hemi/pipeline/radiosity.hpp"

/// @file
/// Everything that the main job needs: scene, form factors, radiosity, files, pictures.
