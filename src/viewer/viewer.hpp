#pragma once

#include "hemi/display/picture.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include "hemi/solver/solver.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::viewer {

/// What is being done, what is counted (plural, or nothing), how much of how much; false stops the work.
using SolveProgress =
    std::function<bool(std::string_view title, std::string_view unit, std::size_t done, std::size_t total)>;

/// Form factors and light of a scene; arrays as in ViewerInput.
struct Solved {
    std::shared_ptr<const FormFactorMatrix> factors;
    std::vector<double> radiosity;
    std::vector<double> row_sum;
    std::vector<double> environment_share;
    std::vector<double> blocked;
};

/// A scene to look at, solved or to be solved, and how to begin.
struct ViewerInput {
    std::string file_stem = "hemi";  ///< how the names of screenshots begin
    std::string title;               ///< name of the scene, in the window's title
    const Scene* scene = nullptr;    ///< names, materials, channels; must outlive run_viewer()
    const PatchMesh* mesh = nullptr; ///< must outlive run_viewer()
    std::shared_ptr<const FormFactorMatrix> factors; ///< null: there are none
    /// Finds what is not here yet, called once on a thread of its own. Until it has, the radiosity is what
    /// the lamps have by themselves. May throw Cancelled when it was stopped. Empty: all is here.
    std::function<Solved(const SolveProgress&)> solve;
    std::uint32_t channels = 1;
    std::array<std::uint32_t, 3> show{0, 0, 0}; ///< channels shown as red, green, blue
    std::vector<double> radiosity;              ///< N·channels
    std::vector<double> exitance;               ///< N·channels
    std::vector<double> reflectance;            ///< N·channels
    std::vector<double> row_sum;                ///< sum_j F(i, j), N, or empty with the next two
    std::vector<double> environment_share;      ///< e_i
    std::vector<double> blocked;                ///< b_i; may be known alone
    SolverSettings solver;                      ///< for the light after a change of materials
    HemicubeSettings hemicube;                  ///< as the rows were, or would be, computed
    std::vector<double> radiosity_error;        ///< estimated, N·channels, or empty
    std::array<float, 3> environment{};         ///< as PictureMesh::environment
    Camera camera;                              ///< where R goes back to
    PictureSettings picture;                    ///< width and height are the window's first size
    bool automatic_exposure = true;             ///< picture.exposure is chosen by automatic_exposure()
    std::string script; ///< path of a script (see parse_script); empty: a person drives the window
};

/// Opens a window and runs it until it is closed, or until the script ends. Call from the main thread.
///
/// Mouse: left drag orbits about the point under the cursor, middle or shift and left drag pans, wheel and
/// right drag zoom to the cursor, a click picks a patch. Keys: see help_window(). Beside the scene stands a
/// panel where the window is large enough for it. Screenshots have the size of the window and the pixels that
/// draw_picture() gives for the same camera.
/// @return 0
/// @throws NoDevice without a display or without OpenGL 4.5 on it; InputError if the script cannot be read or
///   understood, naming file and line; GlError; IoError where a script's screenshot cannot be written.
int run_viewer(const ViewerInput& input);

} // namespace hemi::viewer
