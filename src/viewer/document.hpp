#pragma once

#include "display/smooth_surfaces.hpp"
#include "viewer/findings.hpp"
#include "viewer/look.hpp"
#include "viewer/material_history.hpp"
#include "viewer/relighter.hpp"
#include "viewer/row_finder.hpp"
#include "viewer/viewer.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hemi::viewer {

/// How far work beside the window is.
struct Work {
    std::string doing;             ///< what is under way; empty: no rows are looked for
    double share = 0.0;            ///< of that
    std::string light;             ///< on the light that is shown
    std::vector<double> residuals; ///< after every sweep of the last solution
    bool waits = false;            ///< for the next step
};

/// A scene and its light as they stand: what was opened, found, solved and changed since.
class Document {
public:
    /// @param cache  form factors that may serve for this input too
    /// @param wake   called on other threads when update() has something to do
    Document(ViewerInput input, std::shared_ptr<FactorCache> cache, std::function<void()> wake);

    [[nodiscard]] const ViewerInput& input() const { return input_; }
    [[nodiscard]] const Light& light() const { return light_; }
    /// Of scenes with temperatures, as soon as it is found; else null.
    [[nodiscard]] const Heat* heat() const { return heat_.get(); }
    [[nodiscard]] const PictureMesh& light_mesh() const { return light_mesh_; }
    [[nodiscard]] const SmoothSurfaces& surfaces() const { return surfaces_; }
    /// The same, across materials; made when it is first needed.
    [[nodiscard]] const SmoothSurfaces& surfaces_across() const;
    /// What is wrong with the geometry; null until it is found.
    [[nodiscard]] const Findings* findings() const { return findings_ ? &*findings_ : nullptr; }
    /// Looks for that beside the window, once, where there are form factors.
    void look_for_findings();
    /// @return whether it was found since
    bool take_findings();
    /// Where stops count from.
    [[nodiscard]] double exposure() const { return exposure_; }
    /// The scene with its materials and its light as they stand.
    /// @param irradiance  with that, which takes a product with all form factors
    [[nodiscard]] Lit lit(bool irradiance) const;
    /// Median of the rows' largest factors, see usual_largest_factor().
    [[nodiscard]] double usual_factor() const { return usual_factor_; }
    /// Whether the picture shows even_light(), since there is no other.
    [[nodiscard]] bool evenly_lit() const { return evenly_lit_; }
    /// On light of which the picture shows little; see hemi::light_note().
    [[nodiscard]] const std::string& light_note() const { return light_note_; }
    /// Whether there is no light yet but that of the lamps by themselves.
    [[nodiscard]] bool lamps_only() const { return state_ == State::lamps; }
    [[nodiscard]] const Work& work() const { return work_; }

    /// Share of the patches that have light by their own rows, which came one by one.
    [[nodiscard]] double gathered_share() const;
    /// Whether more such rows may come.
    [[nodiscard]] bool gathering() const { return finder_ && gathered_ < input_.mesh->size(); }

    /// Takes in what was found and solved beside the window.
    /// @param gathered  also what single rows tell, which is much to draw for a little new
    /// @return whether there is something new to see
    /// @throws what the search for rows threw, and Cancelled if the user has interrupted the program
    bool update(bool gathered = true);
    /// Whether something is under way that goes on by itself.
    [[nodiscard]] bool busy() const;
    /// Stops the search for rows, and the cutting of patches.
    void cancel();
    /// The same scene on patches that were cut further, once, to be shown instead.
    /// @throws what ended the cutting
    [[nodiscard]] std::optional<ViewerInput> take_refined();

    /// Asks for the light of other materials, temperatures and another environment.
    void set_materials(const MaterialHistory::State& wanted);
    /// Back to the light of the lamps, and a sweep at a time from there. Needs rows.
    void start_over();
    /// The next sweep; starts over where nothing waits for one.
    void step();
    void run_on();

    /// Why the light cannot be stored; null if it can.
    [[nodiscard]] const char* unsavable_reason() const;
    /// @throws InvalidArgument where unsavable_reason() has one; IoError
    void save_result(const std::filesystem::path& path);
    /// Whether the light is that of the file as it was opened.
    [[nodiscard]] bool as_opened() const {
        return wanted_.materials == input_.scene->materials && wanted_.environment == input_.environment() &&
               !has_other_temperatures();
    }
    [[nodiscard]] bool has_other_temperatures() const {
        return input_.heat != nullptr && wanted_.conditions != input_.heat->conditions;
    }

private:
    enum class State { lamps, preview, converging, solved };

    void begin_with_factors(bool solved);
    void look_at_refiner();
    void take_rows(bool gathered);
    void show_factors(std::shared_ptr<const FormFactors> factors);
    void show_gathered(const GatheredLight& gathered);
    void take_light();
    void show_light(std::vector<double> radiosity, State state, std::vector<float> vertices = {});
    void make_light_mesh();
    /// Whether there is no light, and none is to come.
    [[nodiscard]] bool stays_dark() const;
    [[nodiscard]] std::string gathered_text() const;
    [[nodiscard]] Light of_materials() const;

    ViewerInput input_;
    std::function<void()> wake_;
    SmoothSurfaces surfaces_;
    mutable std::optional<SmoothSurfaces> surfaces_across_;
    std::optional<Findings> findings_;
    MaterialHistory::State wanted_;
    Light light_;
    std::shared_ptr<const Heat> heat_;
    std::vector<double> blocked_; ///< b_i as far as they are known, N; empty: none
    std::size_t gathered_ = 0;    ///< patches that have light by their own row
    PictureMesh light_mesh_;
    bool evenly_lit_ = false;
    std::string light_note_;
    double exposure_ = 1.0;
    bool exposure_settled_ = false;
    double usual_factor_ = 0.0;
    State state_ = State::lamps;
    Work work_;
    bool changed_ = false;
    std::optional<SolveUpdate> solved_;             ///< the last solution
    std::optional<Relighter> relighter_;            ///< where there are form factors
    std::optional<RowFinder> finder_;               ///< while it is at work
    std::unique_ptr<FindingSearch> finding_search_; ///< likewise
};

} // namespace hemi::viewer
