#include "viewer/findings.hpp"

#include "display/painted.hpp"
#include "viewer/panels.hpp"
#include "viewer/widgets.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace hemi::viewer {

namespace {

/// Lines of a kind's list.
constexpr std::size_t most_lines = 100;

std::vector<PatchFinding> without_share(const std::vector<std::uint32_t>& patches) {
    std::vector<PatchFinding> findings;
    for (const std::uint32_t patch : patches) {
        findings.push_back({patch, 0.0});
    }
    return findings;
}

Findings find(const FormFactors& factors, const PatchMesh& mesh, double max_row_error) {
    Diagnosis diagnosis = diagnose(factors, &mesh, max_row_error);
    Findings found;
    const auto put = [&found](Finding kind, std::vector<PatchFinding> patches) {
        found.patches[static_cast<std::size_t>(kind)] = std::move(patches);
    };
    put(Finding::buried, std::move(diagnosis.buried));
    put(Finding::reversed, without_share(diagnosis.turned));
    put(Finding::leak, std::move(diagnosis.leaks));
    put(Finding::partly_buried, std::move(diagnosis.partly_buried));
    put(Finding::back_faces, std::move(diagnosis.back_faces));
    put(Finding::near, std::move(diagnosis.close));
    put(Finding::unseen, std::move(diagnosis.never_visible));
    found.of_patch.resize(mesh.size());
    for (const NamedValue<Finding>& kind : Names<Finding>::table) {
        for (const PatchFinding& finding : found.of(kind.value)) {
            std::optional<Finding>& shown = found.of_patch[finding.patch];
            shown = shown ? shown : kind.value;
        }
    }
    return found;
}

/// What the share of a finding is; null where there is none.
const char* share_of(Finding kind) {
    switch (kind) {
    case Finding::buried:
    case Finding::back_faces:
        return "b, share of backs";
    case Finding::leak:
        return "e, share of the environment";
    case Finding::partly_buried:
        return "share that is buried";
    case Finding::near:
        return "gap in patch sizes";
    case Finding::reversed:
    case Finding::unseen:
        break;
    }
    return nullptr;
}

ImU32 screen_colour(Finding kind) {
    const std::array<float, 3> linear = colour_of(kind);
    return IM_COL32(srgb_of(linear[0]), srgb_of(linear[1]), srgb_of(linear[2]), 255);
}

/// A filled square of a line's height; the cursor goes on to its right.
void swatch(Finding kind) {
    const float edge = ImGui::GetTextLineHeight() - 4.0F;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddRectFilled({corner.x, corner.y + 2.0F},
                                              {corner.x + edge, corner.y + 2.0F + edge}, screen_colour(kind));
    ImGui::Dummy({edge, edge});
    ImGui::SameLine();
}

void patch_list(const Findings& findings, Finding kind, const PatchMesh& mesh, Choices& choices) {
    const std::vector<PatchFinding>& patches = findings.of(kind);
    const char* share = share_of(kind);
    const std::size_t count = std::min(patches.size(), most_lines);
    constexpr std::size_t seen_lines = 8; // before the list scrolls
    const auto lines = static_cast<float>(std::min(count + (count < patches.size() ? 1U : 0U), seen_lines));
    ImGui::Indent();
    ImGui::BeginChild(title_of(kind), {0.0F, lines * ImGui::GetTextLineHeightWithSpacing() + 4.0F});
    for (std::size_t k = 0; k < count; ++k) {
        const PatchFinding& finding = patches[k];
        std::string words = fmt::format("{}  {}", finding.patch, mesh.groups()[mesh.group(finding.patch)]);
        if (share != nullptr) {
            words += fmt::format("  {:.3g}", finding.share);
        }
        if (list_line(words + "##found", choices.picked == finding.patch,
                      fmt::format("Patch, its group{}{}. A click goes there.", share != nullptr ? ", " : "",
                                  share != nullptr ? share : ""))) {
            choices.wishes.go_to_patch = finding.patch;
        }
    }
    if (count < patches.size()) {
        faint(fmt::format("and {} more", patches.size() - count));
    }
    ImGui::EndChild();
    ImGui::Unindent();
}

} // namespace

FindingSearch::FindingSearch(std::shared_ptr<const FormFactors> factors,
                             std::shared_ptr<const PatchMesh> mesh, double max_row_error,
                             std::function<void()> done)
    : thread_([this, factors = std::move(factors), mesh = std::move(mesh), max_row_error,
               done = std::move(done)] {
          Findings found;
          try {
              found = find(*factors, *mesh, max_row_error);
          } catch (const std::exception& error) {
              found.problem = error.what();
              found.of_patch.resize(mesh->size());
          }
          {
              const std::lock_guard lock(mutex_);
              found_ = std::move(found);
          }
          done();
      }) {}

bool FindingSearch::finished() const {
    const std::lock_guard lock(mutex_);
    return found_.has_value();
}

Findings FindingSearch::take() {
    const std::lock_guard lock(mutex_);
    return *std::exchange(found_, std::nullopt);
}

const char* title_of(Finding kind) {
    switch (kind) {
    case Finding::buried:
        return "buried";
    case Finding::reversed:
        return "reversed";
    case Finding::leak:
        return "leaks";
    case Finding::partly_buried:
        return "partly buried";
    case Finding::back_faces:
        return "meet back faces";
    case Finding::near:
        return "near a surface";
    case Finding::unseen:
        return "never visible";
    }
    return "";
}

const char* meaning_of(Finding kind) {
    switch (kind) {
    case Finding::buried:
        return "Their centre lies under or inside other geometry (b above 1/2): nothing reaches them.";
    case Finding::reversed:
        return "No patch sees the front of these surfaces, but others meet their backs: their normals point "
               "the wrong way. --flip-group turns them, --orient in or out all of them.";
    case Finding::leak:
        return "They see the environment (e) of a scene that is closed, or nearly: there is a gap near them, "
               "or they face the outside.";
    case Finding::partly_buried:
        return "Other geometry stands on a part of them. Smaller patches help, or its outline as edges of "
               "the "
               "mesh.";
    case Finding::back_faces:
        return "They meet backs (b): a surface cuts through them, an open body is near, or normals there are "
               "reversed.";
    case Finding::near:
        return "A surface is close above them. More sample points are taken there; smaller patches help.";
    case Finding::unseen:
        return "No patch sees them, though they are not buried. Where they face the outside that is as it "
               "should be.";
    }
    return "";
}

/// Okabe and Ito, "Color universal design", 2008: told apart by the colour-blind, too.
std::array<float, 3> colour_of(Finding kind) {
    switch (kind) {
    case Finding::buried:
        return {0.665F, 0.112F, 0.0F};
    case Finding::reversed:
        return {0.604F, 0.191F, 0.386F};
    case Finding::leak:
        return {0.0F, 0.342F, 0.171F};
    case Finding::partly_buried:
        return {0.791F, 0.347F, 0.0F};
    case Finding::back_faces:
        return {0.871F, 0.776F, 0.054F};
    case Finding::near:
        return {0.093F, 0.456F, 0.815F};
    case Finding::unseen:
        return {0.0F, 0.168F, 0.445F};
    }
    return {};
}

std::vector<std::array<float, 3>> finding_colours(const Findings* findings, const PatchMesh& mesh) {
    std::vector<std::array<float, 3>> colours = plain_colours(mesh);
    for (std::uint32_t i = 0; i < mesh.size() && findings != nullptr; ++i) {
        if (findings->of_patch[i]) {
            colours[i] = colour_of(*findings->of_patch[i]);
        }
    }
    return colours;
}

std::vector<KeyLine> finding_key(const Findings* findings) {
    std::vector<KeyLine> key;
    for (const NamedValue<Finding>& kind : Names<Finding>::table) {
        const std::size_t count = findings == nullptr ? 0 : findings->of(kind.value).size();
        if (count > 0) {
            key.push_back({colour_of(kind.value), fmt::format("{}: {}", title_of(kind.value), count)});
        }
    }
    return key;
}

Camera camera_at(const PatchMesh& mesh, std::uint32_t patch, const Camera& now) {
    constexpr double heights = 4.0; // of the patch in the picture
    constexpr double oblique = 0.4; // cosine from where on its front is seen well
    const Vec3 normal = glm::normalize(mesh.normal(patch));
    const Vec3 centre = mesh.centres()[patch];
    double radius = 0.0;
    const PatchCorners corners = mesh.corners(patch);
    for (std::size_t k = 0; k < corners.count; ++k) {
        radius = std::max(radius, glm::length(corners.points[k] - centre));
    }
    const double distance = heights * radius / std::tan(0.5 * now.fov * std::numbers::pi / 180.0);
    Vec3 away = glm::normalize(now.eye - now.target);
    if (glm::dot(away, normal) < oblique) {
        // From the front, off the normal towards where one looks from, so that what lies above shows.
        const Vec3 aside = away - glm::dot(away, normal) * normal;
        away = normal + (glm::length(aside) > 1e-6 ? 0.6 * glm::normalize(aside) : Vec3(0.0));
    }
    Camera camera = now;
    camera.target = centre;
    camera.eye = centre + distance * glm::normalize(away);
    const Vec3 view = glm::normalize(camera.target - camera.eye);
    if (glm::length(glm::cross(view, camera.up)) < 1e-3) { // straight along what is up
        camera.up = std::abs(view.x) < 0.9 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
    }
    return camera;
}

void findings_section(const PanelContent& content, Choices& choices) {
    if (!heading("Check", "What `hemi check` finds in the geometry, by the form factors.", false)) {
        return;
    }
    const Document& document = content.document;
    if (document.input().factors == nullptr) {
        faint(fmt::format("Needs form factors: {}.",
                          why_not({View::findings}, document.input(), choices.picked)));
        return;
    }
    choices.wishes.check = true;
    const Findings* findings = document.findings();
    if (findings == nullptr || !findings->problem.empty()) {
        faint(findings == nullptr ? "looking ..." : findings->problem);
        return;
    }
    bool shown = choices.look.shown.view == View::findings;
    if (checkbox("in colours", shown, "Shows the scene in the colours of what is found.")) {
        choices.look.shown = {shown ? View::findings : View::picture};
    }
    bool any = false;
    for (const NamedValue<Finding>& kind : Names<Finding>::table) {
        const std::size_t count = findings->of(kind.value).size();
        if (count == 0) {
            continue;
        }
        any = true;
        swatch(kind.value);
        const bool open =
            ImGui::TreeNodeEx(fmt::format("{}: {}###{}", title_of(kind.value), count, kind.word).c_str(),
                              ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_NoTreePushOnOpen);
        tip(meaning_of(kind.value));
        if (open) {
            patch_list(*findings, kind.value, *document.input().mesh, choices);
        }
    }
    if (!any) {
        faint("Nothing is wrong.");
    }
}

void findings_legend(const Findings* findings, std::array<std::uint32_t, 2> view) {
    constexpr float margin = 10.0F;
    ImGui::SetNextWindowPos({margin, static_cast<float>(view[1]) - margin}, ImGuiCond_Always, {0.0F, 1.0F});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, IM_COL32(22, 24, 26, 225));
    ImGui::Begin("findings", nullptr,
                 fixed_window | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
    text("What check finds");
    bool any = false;
    for (const NamedValue<Finding>& kind : Names<Finding>::table) {
        const std::size_t count = findings == nullptr ? 0 : findings->of(kind.value).size();
        if (count > 0) {
            any = true;
            swatch(kind.value);
            text(fmt::format("{}: {}", title_of(kind.value), count));
            tip(meaning_of(kind.value));
        }
    }
    if (!any) {
        faint(findings == nullptr ? "looking ..." : "nothing");
    }
    ImGui::End();
    ImGui::PopStyleColor();
}

} // namespace hemi::viewer
