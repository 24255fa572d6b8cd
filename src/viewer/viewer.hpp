#pragma once

#include "hemi/display/picture.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/matrix/error_estimate.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solver.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::viewer {

/// What is being done, what is counted (plural, or nothing), how much of how much; false stops the work.
using SolveProgress =
    std::function<bool(std::string_view title, std::string_view unit, std::size_t done, std::size_t total)>;

/// Form factors of a scene, and what is known of their rows.
struct FoundRows {
    std::shared_ptr<const FormFactorMatrix> factors;
    std::shared_ptr<const FormFactorMatrix> reference; ///< better rows of a few patches; null: none
    std::vector<double> row_sum;                       ///< sum_j F(i, j), N
    std::vector<double> environment_share;             ///< e_i, N
    std::vector<double> blocked;                       ///< b_i, N
};

/// Where those who find rows tell how far they are; called from their thread.
struct RowListener {
    SolveProgress progress;
    /// What the light will be about: radiosity, N·channels.
    std::function<void(std::vector<double> radiosity)> preview;
    /// What a patch has by its own row, which has just come, of the light that was shown before: radiosity,
    /// one value a channel; and b_i. Provisional: the solution is found when all rows are there.
    std::function<void(std::uint32_t patch, std::span<const double> radiosity, double blocked)> gathered;
};

/// Light as it was solved, to be stored.
struct SolvedLight {
    std::vector<Material> materials; ///< as they are by now
    std::vector<double> radiosity;   ///< N·channels
    std::optional<RadiosityErrorEstimate> error;
    std::string solver;
    std::uint32_t sweeps = 0;
    double residual = 0.0;
};

/// A scene to look at, solved or to be solved, and how to begin.
struct ViewerInput {
    std::filesystem::path file;            ///< what was opened
    std::string title;                     ///< name of the scene, in the window's title
    std::shared_ptr<const Scene> scene;    ///< names, materials, channels
    std::shared_ptr<const PatchMesh> mesh; ///< its patches
    /// Finds the form factors, called once on a thread of its own. Until there is light, the radiosity is
    /// what the lamps have by themselves. May throw Cancelled when it was stopped. Empty: a stored solution,
    /// of which there are none.
    std::function<FoundRows(const RowListener&)> find_rows;
    /// Writes a solution of these rows as `.hres`. Empty where find_rows is. @throws IoError
    std::function<void(const std::filesystem::path&, const SolvedLight&)> save_result;
    /// Command line that draws this file without a window, up to the picture's own options:
    /// "hemi render room.hres".
    std::string command;
    std::uint32_t channels = 1;
    std::array<std::uint32_t, 3> show{0, 0, 0}; ///< channels shown as red, green, blue
    std::vector<double> radiosity;              ///< N·channels
    std::vector<double> exitance;               ///< N·channels
    std::vector<double> reflectance;            ///< N·channels
    FoundRows rows;                             ///< of a stored solution: without factors
    SolverSettings solver;                      ///< for the light
    HemicubeSettings hemicube;                  ///< as the rows were, or would be, computed
    std::vector<double> radiosity_error;        ///< estimated, N·channels, or empty
    std::array<float, 3> environment{};         ///< as PictureMesh::environment
    Camera camera;                              ///< where R goes back to
    PictureSettings picture;                    ///< width and height are the window's first size
    bool automatic_exposure = true;             ///< picture.exposure is chosen by automatic_exposure()
};

/// What the mouse does: as in ParaView and MeshLab, or as in Blender.
enum class Controls { standard, blender };

struct ViewerSettings {
    Controls controls = Controls::standard;
    std::string script; ///< path of a script (see parse_script); empty: a person drives the window
    /// Reads another file, or the same one again; called on a thread of its own. @throws InputError, …
    std::function<ViewerInput(const std::filesystem::path&)> open;
};

/// Opens a window and runs it until it is closed, or until the script ends. Call from the main thread.
///
/// Mouse and keys: see guide(). Beside the scene stands a panel where the window is large enough for it.
/// Screenshots have the pixels that draw_picture() gives for the same camera and size. The file is read again
/// when it changes, and files that are dropped on the window are opened. An OpenGL error
/// ends it.
/// @throws NoDevice without a display or without OpenGL 4.5 on it; InputError if the script cannot be read or
///   understood, naming file and line; GlError; IoError where a script's file cannot be written.
void run_viewer(ViewerInput input, const ViewerSettings& settings);

} // namespace hemi::viewer
