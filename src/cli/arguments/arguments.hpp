#pragma once

#include "cli/arguments/heat_arguments.hpp"
#include "cli/arguments/option_values.hpp"
#include "cli/terminal.hpp"
#include "hemi/display/picture.hpp"
#include "hemi/io/scene_reader.hpp"
#include "hemi/matrix/repair.hpp"
#include "hemi/pipeline/points.hpp"
#include "hemi/pipeline/quantities.hpp"
#include "hemi/pipeline/refinement.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"
#include "hemi/solver/solver.hpp"
#include "viewer/controls.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// What the command line says, as plain values: one struct for every group of options and every command.
/// An empty optional is an option that was not given.
namespace hemi::cli {

struct CommonOptions {
    bool quiet = false;
    bool verbose = false;
    ColourChoice colour = ColourChoice::automatic;
    bool json = false;
    std::vector<std::string> given; ///< names of all options on the command line, "--resolution"
    /// The same with their values, none for flags.
    std::vector<std::pair<std::string, std::vector<std::string>>> words;
};

struct SceneOptions {
    std::filesystem::path path;              ///< the scene, or the stored file where a command takes either
    std::vector<std::filesystem::path> also; ///< more files of the scene
    Subdivision subdivision;
    std::optional<Enclosure> enclosure;
    std::vector<double>
        environment; ///< `--environment`: one value for all channels or one for each; empty: the scene's
    std::optional<std::filesystem::path> exitance_from; ///< table of what faces radiate, see set_exitances()
    io::SceneReaderOptions reader;
    bool imprint = true;        ///< cut faces where they touch
    bool up_is_visible = false; ///< results depend on the axis upwards even without a sky
};

struct RowOptions {
    FactorSettings factors;
    double max_row_error = 1e-4;
    std::optional<double> error_target;           ///< the program chooses settings, or how patches are cut
    ErrorOf error_of = ErrorOf::factors;          ///< which error it is for
    bool resume = false;                          ///< use the rows that an interrupted run left
    std::optional<std::filesystem::path> scratch; ///< folder of the file that rows are in; none: memory
};

struct PictureOptions {
    std::optional<std::filesystem::path> output;
    std::array<std::uint32_t, 2> size{800, 800};
    std::optional<double> exposure; ///< none: automatic
    ToneMapping tone_mapping = ToneMapping::filmic;
    bool tone_mapping_given = false;
    bool flat = false;
    bool outlines = false;
    bool backs = false;
    bool orthographic = false;
    std::uint32_t samples = 4;
    std::optional<std::array<std::uint8_t, 3>> background; ///< sRGB; none: the environment
    std::vector<std::string> show;    ///< channel names; empty: all of one or three channels
    std::optional<Quantity> quantity; ///< is shown in false colours instead of light
    std::string channel = "mean";     ///< of the quantity
    std::optional<std::array<double, 2>> range;
    ColourMap map = ColourMap::viridis;
    bool logarithmic = false;
    bool celsius = false; ///< of temperatures
    bool legend = true;
    std::uint32_t bands = 0; ///< of colours; 0: they run smoothly
    bool iso_lines = false;
    std::vector<std::string> hidden_groups;
    std::vector<std::string> outlined_groups;
    std::optional<ClipPlane> clip;
    std::vector<std::string> of_quantities; ///< options given that only they have
    std::optional<CameraOption> camera;
    std::optional<UpAxis> up; ///< none: the scene's
};

/// When patches that are cut are fine enough, with RowOptions::error_target.
struct RefinementOptions {
    std::uint32_t patches = 0; ///< so many; 0: as many as the error takes
    double budget = 0.0;       ///< seconds, after which no patches are split any more; 0: no limit

    [[nodiscard]] bool asked(const RowOptions& rows) const {
        return patches > 0 || (rows.error_target && rows.error_of != ErrorOf::factors);
    }
    [[nodiscard]] RefinementGoal goal(const RowOptions& rows, Gather gather) const {
        return {rows.error_target, rows.error_of, patches, budget, gather};
    }
};

struct SolveArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    SolverSettings solver;
    PictureOptions picture;
    Gather gather = Gather::automatic;
    RefinementOptions refinement;
    bool parts = false; ///< results are about the patches that it ends with, even of whole faces
    std::optional<std::filesystem::path> factors;
    std::optional<std::filesystem::path> result;
    std::optional<std::filesystem::path> radiosity;
    std::optional<std::filesystem::path> patches;

    /// Whether patches become smaller until the result is good enough.
    [[nodiscard]] bool refines() const { return refinement.asked(rows); }
    /// Whether an output holds the irradiance, which takes the rows of all patches.
    [[nodiscard]] bool with_irradiance() const {
        return result || radiosity || (picture.quantity && needs_all_rows(*picture.quantity));
    }
};

/// `--rows`: rows that a part has.
struct RowSelection {
    bool shares = false; ///< `k/n`: the k-th of n equal shares, from 1; else `a:b`: rows a to b - 1, from 0
    std::uint32_t first = 0;  ///< a, or k
    std::uint32_t second = 0; ///< b, or n
};

struct FactorsArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    std::optional<std::filesystem::path> output;
    std::optional<std::filesystem::path> patches;
    std::optional<std::uint32_t> row;
    std::optional<RowSelection> selection;           ///< a part of the rows
    std::optional<std::array<double, 6>> from_point; ///< position and normal
    bool by_group = false;
};

struct CheckArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
};

struct TradeArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    std::optional<std::filesystem::path> output;
    double budget = 60.0; ///< seconds
};

/// In false colours; the picture's path is that of the command's output.
struct HeatPicture {
    PictureOptions picture;
    std::vector<std::string> options; ///< names of all that only pictures have
};

struct HeatArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    HeatOptions heat;
    FactorInput input;
    std::optional<std::filesystem::path> output; ///< .vtp or .png
    HeatPicture picture;
    std::optional<std::filesystem::path> fluxes; ///< .csv by patch
    std::optional<std::filesystem::path> series; ///< .csv that is read
    std::optional<std::filesystem::path> result; ///< .hres
};

struct ExchangeArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    HeatOptions heat;
    FactorInput input;
    std::optional<double> min;                   ///< m², of conductances that are kept
    std::optional<std::filesystem::path> output; ///< .csv, .npz or .txt
};

struct PointsArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    SolverSettings solver;
    HeatOptions heat;
    std::optional<std::filesystem::path> points; ///< .csv
    struct Grid {
        std::string group;
        double spacing = 0.0;
        double height = 0.0;
    };
    std::optional<Grid> grid;
    bool spheres = false;  ///< points have no normals
    bool daylight = false; ///< factors by the sky alone
    std::optional<Posture> posture;
    std::optional<double> facing; ///< degrees
    BodyAbsorption body;          ///< of the person
    std::optional<std::filesystem::path> output;
    bool by_group = false;
    std::string show;                           ///< column of the map; empty: the first irradiance
    std::optional<std::array<double, 2>> range; ///< of the map
    bool legend = true;                         ///< below the map
    std::optional<std::filesystem::path> factors;
};

/// Points that are drawn as dots.
struct DotOptions {
    std::optional<std::filesystem::path> points; ///< .csv
    std::string column;                          ///< that they show; empty: the first, where there is one
};

struct RenderArguments {
    CommonOptions common;
    std::filesystem::path input;
    DotOptions dots;
    PictureOptions picture;
    std::string device = "auto";
};

struct DiffArguments {
    CommonOptions common;
    std::filesystem::path first;  ///< .hres
    std::filesystem::path second; ///< .hres
    PictureOptions picture;       ///< of a quantity
    std::optional<std::filesystem::path> csv;
    std::string device = "auto";
};

struct ViewArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    SolverSettings solver;
    PictureOptions picture; ///< to start with; its output is not used
    Gather gather = Gather::automatic;
    RefinementOptions refinement;
    std::optional<std::filesystem::path> factors;
    DotOptions dots;
    std::string script; ///< file that drives the window; empty: a person does
    viewer::Controls controls = viewer::Controls::standard;
};

struct BakeArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
    SolverSettings solver;
    PictureOptions picture; ///< output, channels, exposure, flat
    Gather gather = Gather::automatic;
};

struct MergeArguments {
    CommonOptions common;
    std::vector<std::filesystem::path> parts;
    std::optional<std::filesystem::path> output;
    RowOptions rows; ///< memory, repair of what is reported
};

struct ConvertArguments {
    CommonOptions common;
    std::filesystem::path input;
    std::filesystem::path output;
    std::optional<Repair> repair;                 ///< empty: what suits the rows
    std::optional<std::filesystem::path> factors; ///< for .vtp: where the rows are
    std::vector<std::uint32_t> rows;              ///< for .vtp: rows of F as cell data
    std::string zone;                             ///< for .idf; empty: the file's name
};

struct InfoArguments {
    CommonOptions common;
    SceneOptions scene;
    RowOptions rows;
};

struct DevicesArguments {
    CommonOptions common;
};

using Arguments =
    std::variant<SolveArguments, FactorsArguments, CheckArguments, TradeArguments, HeatArguments,
                 ExchangeArguments, PointsArguments, RenderArguments, DiffArguments,
#ifdef HEMI_WITH_VIEWER
                 ViewArguments,
#endif
                 BakeArguments, MergeArguments, ConvertArguments, InfoArguments, DevicesArguments>;

/// Text that was asked for instead of work: help or the version.
struct Answer {
    std::string text;
};

/// Reads the command line.
/// @throws InvalidArgument for anything that is not understood, with the nearest right word where there is
/// one.
[[nodiscard]] std::variant<Arguments, Answer> parse_arguments(int argc, const char* const* argv);

} // namespace hemi::cli
