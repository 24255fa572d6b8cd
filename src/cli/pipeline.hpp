#pragma once

#include "cli/arguments.hpp"
#include "cli/kept_rows.hpp"
#include "cli/report.hpp"
#include "cli/terminal.hpp"
#include "hemi/engine/engine.hpp"
#include "hemi/engine/visibility_weighted.hpp"
#include "hemi/io/factor_file.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// What solve, factors, check, info and view share: a scene, its patches, its rows.
namespace hemi::cli {

class Stopwatch {
public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// auto, closed or open.
[[nodiscard]] std::string enclosure_name(Enclosure enclosure);

struct LoadedScene {
    Scene scene;
    PatchMesh mesh;
    std::vector<std::uint32_t> group_of; ///< group of every patch
    double seconds = 0.0;

    [[nodiscard]] PatchNames names() const { return {mesh.groups(), group_of, mesh.centres()}; }
};

/// Reads the scene and cuts it into patches; `--enclosure` has replaced the scene's own word.
/// @throws InputError for the file; InvalidArgument for options that do not fit it.
[[nodiscard]] LoadedScene load_scene(const SceneOptions& options, const Terminal& terminal);

/// Refuses options on the command line that say nothing about a stored file.
/// @param allowed  options that do ("--json"); @throws InvalidArgument
void refuse_all_but(const CommonOptions& common, std::span<const std::string> allowed,
                    const std::filesystem::path& file);

/// Bytes that the form factors may take: `--max-memory`, else 80 % of what the system says is available.
[[nodiscard]] std::uint64_t memory_limit(const RowOptions& options);

/// How rows will be computed: the preset, and what single options replaced in it.
struct RowPlan {
    HemicubeSettings hemicube;
    std::optional<VisibilityWeightedSettings>
        hybrid; ///< exact factors times visibility; else the texels alone
};
/// @param patches  of the whole scene: where many share the texels, one sharper eye sees more than several
[[nodiscard]] RowPlan plan_rows(const RowOptions& options, std::uint32_t patches);

/// An engine that stops with Cancelled, at the next row, once the user has interrupted.
[[nodiscard]] std::unique_ptr<RowProvider>
make_engine(const PatchMesh& mesh, const HemicubeSettings& settings, const RowOptions& options);
/// The same for visibility.
[[nodiscard]] std::unique_ptr<VisibilityProvider>
make_visibility(const PatchMesh& mesh, const HemicubeSettings& settings, const RowOptions& options);

/// Rows of F with all that belongs to them, and how they came about.
struct Rows {
    io::FactorFile file;
    std::size_t computed = 0;       ///< rows, now; those from a file or a journal do not count
    std::uint64_t hemicubes = 0;    ///< drawn for them; 0 by another method
    double drawing_seconds = 0.0;   ///< of those hemicubes
    double reference_seconds = 0.0; ///< of better rows for the estimate of errors
    bool reused = false;
};

/// Shown every row as it comes from the engine, before rows are combined.
using RowWatcher = std::function<void(std::uint32_t patch, const std::variant<RowView, VisibilityRow>& row)>;

/// Computes the rows of `patches` with a progress bar. Above 256 rows a sample of 64 tells first what the
/// matrix will need.
/// @param kept  where rows are kept until the file of form factors is written; only for all patches
/// @param watcher  may be empty
/// @throws OutOfMemory with figures and advice; Cancelled.
[[nodiscard]] Rows compute_rows(const LoadedScene& loaded, std::span<const std::uint32_t> patches,
                                const RowOptions& options, const Terminal& terminal, KeptRows* kept = nullptr,
                                const RowWatcher& watcher = {});

/// Rows from a `.hff` that was made for the same geometry.
/// @throws InputError if it belongs to another geometry; InvalidArgument if a setting that was given on the
///   command line is not the file's.
[[nodiscard]] Rows reuse_rows(const std::filesystem::path& path, const LoadedScene& loaded,
                              const RowOptions& options, const CommonOptions& common);

/// 0, 1 … size - 1.
[[nodiscard]] std::vector<std::uint32_t> all_patches(std::uint32_t size);

/// Counts patches that lie face to face against a surface as covered where the scene is closed; after the raw
/// rows were stored. @see mark_touching_faces_buried
void settle_contacts(io::FactorFile& file);

/// What the rows say about the enclosure.
struct EnclosureFinding {
    bool closed = false; ///< declared so, or (auto) no row leaks
    bool declared = false;
    std::vector<std::uint32_t>
        leaks; ///< rows of a declared closed scene with e_i above the limit, worst first
};
/// @param enclosure  auto, closed or open
[[nodiscard]] EnclosureFinding find_leaks(const FormFactorMatrix& factors, const std::string& enclosure,
                                          double max_row_error);
/// Errors on stderr about leaks: how many and the worst few, with the direction in which they go. Says
/// nothing if there are none.
/// @param mesh  the patches; null: not known
void report_leaks(const EnclosureFinding& finding, const FormFactorMatrix& factors, const PatchNames& names,
                  const PatchMesh* mesh, double max_row_error, const Terminal& terminal);
/// A warning if patches are covered.
void report_covered(const RowSums& sums, const Terminal& terminal);

/// Lines of a summary on the rows: renderer, hemicubes/s, entries and memory, row sums, enclosure.
[[nodiscard]] std::string rows_summary(const Rows& rows, const RowSums& sums,
                                       const EnclosureFinding& enclosure);

} // namespace hemi::cli
