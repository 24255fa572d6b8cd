#pragma once

#include "display/legend.hpp"
#include "hemi/core/names.hpp"
#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/diagnosis.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace hemi::viewer {

struct Choices;
struct PanelContent;

/// What may be wrong with a patch, as diagnose() tells it; of several the first is shown.
enum class Finding { buried, reversed, leak, partly_buried, back_faces, near, unseen };

} // namespace hemi::viewer

namespace hemi {

/// Words of viewer::Finding, in scripts.
template <>
struct Names<viewer::Finding> {
    /// Every value with its word.
    static constexpr NamedValue<viewer::Finding> table[] = {{viewer::Finding::buried, "buried"},
                                                            {viewer::Finding::reversed, "reversed"},
                                                            {viewer::Finding::leak, "leak"},
                                                            {viewer::Finding::partly_buried, "partly-buried"},
                                                            {viewer::Finding::back_faces, "back-faces"},
                                                            {viewer::Finding::near, "near"},
                                                            {viewer::Finding::unseen, "unseen"}};
};

} // namespace hemi

namespace hemi::viewer {

/// What is found of a scene.
struct Findings {
    static constexpr std::size_t kinds = std::size(Names<Finding>::table);

    std::array<std::vector<PatchFinding>, kinds> patches; ///< of every kind, worst first
    std::vector<std::optional<Finding>> of_patch;         ///< what is shown of a patch, N
    std::string problem;                                  ///< why nothing was looked for; empty: it was

    [[nodiscard]] const std::vector<PatchFinding>& of(Finding kind) const {
        return patches[static_cast<std::size_t>(kind)];
    }
};

/// Looks for what is wrong on a thread of its own.
class FindingSearch {
public:
    /// @param factors        prepared, of all patches of the mesh
    /// @param max_row_error  see diagnose()
    /// @param done           called on the other thread when it has finished
    FindingSearch(std::shared_ptr<const FormFactors> factors, std::shared_ptr<const PatchMesh> mesh,
                  double max_row_error, std::function<void()> done);

    [[nodiscard]] bool finished() const;
    /// Once it has finished.
    [[nodiscard]] Findings take();

private:
    mutable std::mutex mutex_;
    std::optional<Findings> found_;
    std::jthread thread_; ///< last: it uses all of the above
};

/// What a kind is called, means, and looks like; display linear.
[[nodiscard]] const char* title_of(Finding kind);
[[nodiscard]] const char* meaning_of(Finding kind);
[[nodiscard]] std::array<float, 3> colour_of(Finding kind);
/// Patches in the colours of what is found of them, others grey.
/// @param findings  null: nothing yet
[[nodiscard]] std::vector<std::array<float, 3>> finding_colours(const Findings* findings,
                                                                const PatchMesh& mesh);

/// What the colours mean, of kinds of which there are some, with their numbers.
[[nodiscard]] std::vector<KeyLine> finding_key(const Findings* findings);

/// From where one sees a patch: from its front and near, from the side where one looks from now if that does.
[[nodiscard]] Camera camera_at(const PatchMesh& mesh, std::uint32_t patch, const Camera& now);

/// The list of findings: a click on a patch picks it and goes there.
void findings_section(const PanelContent& content, Choices& choices);
/// Colours with their kinds and how many patches there are of each. @param view  the part with the scene
void findings_legend(const Findings* findings, std::array<std::uint32_t, 2> view);

} // namespace hemi::viewer
