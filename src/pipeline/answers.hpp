#pragma once

#include "hemi/core/stopwatch.hpp"
#include "hemi/pipeline/trade.hpp"

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hemi {

/// Whole solutions of a scene on patches of several sizes, timed, and then judged by a finer one.
class Answers {
public:
    /// The scene and how its patches are cut, see measure_trade(); all must outlive this.
    struct Subject {
        const Scene& scene;
        const PatchMesh& mesh;
        const Subdivision& subdivision;
        bool with_imprint;
        const FactorSettings& base;
    };
    /// Tries a preset on the scene's own patches, and calls add_own().
    using TryOwn = std::function<void(Preset)>;

    /// @param budget  seconds for all, the reference too
    Answers(const Subject& subject, double budget, Observer& observer);

    /// Why there can be none: a sentence; empty: there can.
    [[nodiscard]] std::string obstacle() const;

    /// Solves on uniform patches, coarse ones first, as fine as can be judged within the budget.
    void solve_uniform(const TryOwn& try_own);
    /// Solves on patches that are refined to error targets.
    void refine();
    /// Solves by form factors of the scene's own patches, if that size can be judged.
    /// @param seconds  that they took
    void add_own(const Candidate& candidate, const FormFactors& factors, double seconds, double row_error);
    /// Seconds that judge() will take, about; of the solutions so far.
    [[nodiscard]] double reference_seconds();
    /// Compares all with a reference that is finer; fills Trade::answers, or says why there are none.
    void judge(Trade& trade);

private:
    struct Solved {
        Trade::Answer answer;
        PatchMesh mesh;
        Solution solution;
    };
    struct Timed {
        std::uint32_t patches = 0;
        double seconds = 0.0;
    };
    /// What a size of patches is too much for.
    enum class Limit { none, solution_time, reference_time, reference_memory };

    [[nodiscard]] static std::string text(Limit limit);

    [[nodiscard]] double predicted(Preset preset, double patches) const;
    [[nodiscard]] double reference_seconds(double patches) const;
    [[nodiscard]] std::uint32_t reference_points() const;
    [[nodiscard]] bool fits_memory(double patches) const;
    [[nodiscard]] Limit limit_of_judging(double patches) const;
    [[nodiscard]] std::vector<std::pair<double, PatchMesh>> coarser_meshes() const;
    [[nodiscard]] std::vector<Preset> affordable(const PatchMesh& mesh, bool own);
    /// @return whether it came to a solution
    bool solve_size(double patch_size, const PatchMesh& mesh, const std::vector<Preset>& presets);
    void add(const Candidate& candidate, std::optional<double> patch_size, const PatchMesh& mesh,
             const FormFactors& factors, double seconds, double row_error);
    void omit(const std::string& label, const std::string& why) { omitted_.emplace_back(label, why); }
    [[nodiscard]] const PatchMesh& reference_mesh();
    void judge_by(RadiosityReference reference, Trade& trade);

    Subject subject_;
    double budget_;
    Observer& observer_;
    Stopwatch watch_;
    double own_patch_size_ = 0.0;
    bool judges_own_ = false;
    double finest_size_ = 0.0;                   ///< smallest uniform patch size that was solved on
    std::uint32_t finest_patches_ = 0;           ///< of that mesh
    double entries_a_pair_ = 1.0;                ///< of the last matrix
    std::map<Preset, std::vector<Timed>> timed_; ///< of every preset, coarse patches first
    double seconds_a_vertex_ = 0.0;              ///< of the last gather
    Limit limit_ = Limit::none;                  ///< that the last size failed by
    std::deque<Solved> solved_;
    std::optional<PatchMesh> reference_mesh_; ///< nowhere coarser than the first `not_finer_` of solved_
    std::size_t not_finer_ = 0;
    std::vector<std::pair<std::string, std::string>> omitted_; ///< label, why
};

} // namespace hemi
