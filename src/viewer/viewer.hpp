#pragma once

#include "hemi/display/dots.hpp"
#include "hemi/display/picture.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/difference.hpp"
#include "hemi/pipeline/heat.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/refinement.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/pipeline/vertex_gather.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solver.hpp"
#include "viewer/controls.hpp"

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

class MeshRefiner;

/// A stored solution that the light is compared with.
struct Compared {
    std::filesystem::path file;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const PatchMesh> mesh;
    Solution solution; ///< with its exitance
    PatchPairs pairs;  ///< of the mesh that is shown with this one
};

/// A scene to look at, solved or to be solved, and how to begin.
struct ViewerInput {
    std::filesystem::path file;            ///< what was opened
    std::filesystem::path factor_file;     ///< stored rows that are used; empty: none
    std::shared_ptr<const Scene> scene;    ///< names, materials, channels
    std::shared_ptr<const PatchMesh> mesh; ///< its patches
    Subdivision subdivision;               ///< how the mesh was made, for stored results
    std::vector<Surface> surfaces_as_read; ///< as io::ResultFile has them
    PatchParts parts;                      ///< as well
    /// How form factors are computed, beside the window. Empty: a stored solution, which has none.
    std::optional<FactorSettings> factor_settings;
    /// When patches are fine enough, if they are to be cut; `mesh` is the coarse one.
    std::optional<RefinementGoal> refinement;
    /// Makes this the input of a mesh that was cut from the coarse one: scene, mesh, and what results hold
    /// of them. Called on another thread.
    std::function<void(ViewerInput&, PatchMesh)> adopt;
    std::shared_ptr<MeshRefiner> refiner; ///< the window's, while patches are cut
    SolverSettings solver;                ///< for the radiosity
    Gather gather = Gather::automatic;    ///< whether vertices get rows of their own
    std::shared_ptr<Observer> observer;   ///< gets warnings and notes, on another thread; may be null
    /// The stored solution, or, until there is one, the lamps alone: their exitance as radiosity, nothing
    /// known of rows.
    Solution solution;
    std::shared_ptr<const FormFactors> factors; ///< prepared; null until they are found
    std::string of_solution;                    ///< what the window says of a solution that is there
    std::shared_ptr<const Compared> compared;   ///< null: nothing is compared
    double max_row_error = 1e-4;                ///< what diagnose() takes for sound
    /// What the scene says of heat, of these patches, without sun and sky; null: nothing.
    std::shared_ptr<const HeatProblem> heat;
    std::string heat_command; ///< as `command`, of pictures of heat
    /// Command line that draws this file without a window, up to the picture's own options:
    /// "hemi render room.hres".
    std::string command;
    std::string show_option;                    ///< " --show 1,2,3", where channels of the light were chosen
    std::array<std::uint32_t, 3> show{0, 0, 0}; ///< channels shown as red, green, blue
    std::shared_ptr<const PointTable> points;   ///< shown as dots; null: none
    std::filesystem::path points_file;          ///< that they are from
    std::optional<std::size_t> dots_column;     ///< of the points, to begin with
    Camera camera;                              ///< where R goes back to
    PictureSettings picture;                    ///< width, height and cut are those of the first picture
    bool automatic_exposure = true;             ///< picture.exposure is chosen by automatic_exposure()

    /// Name of the scene, else of the file.
    [[nodiscard]] std::string title() const {
        return scene->name.empty() ? file.filename().string() : scene->name;
    }
    [[nodiscard]] std::uint32_t channels() const { return solution.channels; }
    /// Exitance of the scene's environment, of every channel.
    [[nodiscard]] std::vector<double> environment() const {
        return scene->environment.empty() ? std::vector<double>(channels(), 0.0) : scene->environment;
    }
};

/// What makes up what is shown.
struct FilesToOpen {
    std::filesystem::path file;     ///< a scene or a stored solution
    std::filesystem::path factors;  ///< of its rows; empty: none
    std::filesystem::path compared; ///< a stored solution; empty: none
};

struct ViewerSettings {
    Controls controls = Controls::standard;
    std::string script; ///< path of a script (see parse_script); empty: a person drives the window
    /// Reads other files, or the same ones again; called on a thread of its own. @throws InputError, …
    std::function<ViewerInput(const FilesToOpen&)> open;
};

/// Opens a window and runs it until it is closed, or until the script ends. Call from the main thread.
///
/// Mouse and keys: see guide(). Beside the scene stands a panel where the window is large enough for it.
/// Screenshots have the pixels that draw_picture() gives for the same camera and size. The file is read again
/// when it changes, and files that are dropped on the window are opened; a .hff holds rows of the open scene,
/// and a stored solution that is dropped on another one is compared with it.
/// An OpenGL error ends it.
/// @throws NoDevice without a display or without OpenGL 4.5 on it; InputError if the script cannot be read or
///   understood, naming file and line; GlError; IoError where a script's file cannot be written.
void run_viewer(ViewerInput input, const ViewerSettings& settings);

} // namespace hemi::viewer
