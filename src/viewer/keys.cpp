#include "viewer/keys.hpp"

#include <algorithm>
#include <iterator>

namespace hemi::viewer {

namespace {

/// One press of E, stops.
constexpr double exposure_step = 1.0 / 3.0;

void next_shown(bool back, const ViewerInput& input, Choices& choices) {
    const auto names = shown_names();
    const auto now = std::find_if(names.begin(), names.end(), [&choices](const ShownName& name) {
        return name.shown == choices.look.shown;
    });
    const std::size_t step = back ? names.size() - 1 : 1;
    std::size_t next = static_cast<std::size_t>(now - names.begin());
    do {
        next = (next + step) % names.size();
    } while (why_not(names[next].shown, input, choices.picked) != nullptr);
    choices.look.shown = names[next].shown;
}

void next_heat_map(const ViewerInput& input, Choices& choices) {
    const View now = choices.look.shown.view;
    const Shown next{now == View::row ? View::column : (now == View::column ? View::picture : View::row)};
    choices.look.shown = why_not(next, input, choices.picked) == nullptr ? next : Shown{};
}

/// The scale of what is shown, whether it is of quantities or of factors.
bool& logarithmic_of(Look& look) {
    const bool of_factors = look.shown.view == View::row || look.shown.view == View::column;
    return of_factors ? look.logarithmic_factors : look.logarithmic;
}

void next_map(bool back, ColourMap& map) {
    const auto& table = Names<ColourMap>::table;
    const auto now = std::find_if(std::begin(table), std::end(table),
                                  [map](const auto& known) { return known.value == map; });
    const std::size_t step = back ? std::size(table) - 1 : 1;
    map = table[(static_cast<std::size_t>(now - std::begin(table)) + step) % std::size(table)].value;
}

} // namespace

std::vector<GuideLine> guide(Controls controls) {
    std::vector<GuideLine> lines{{"left drag", "orbit about the point under the cursor"},
                                 {"middle drag, shift + left drag", "pan"},
                                 {"wheel, right drag", "zoom at the cursor"}};
    if (controls == Controls::blender) {
        lines = {{"middle drag", "orbit about the point under the cursor"},
                 {"shift + middle drag", "pan"},
                 {"wheel, ctrl + middle drag, right drag", "zoom at the cursor"}};
    }
    lines.insert(
        lines.end(),
        {{"left click", "pick a patch; beside the scene: none"},
         {"F, Home", "frame everything"},
         {"R", "back to the scene's own camera"},
         {"1  3  7", "from the front, the right, above; shift: opposite"},
         {"5", "orthographic or perspective"},
         {"V, shift + V", "next quantity, previous one"},
         {"H", "heat map of the picked patch: row of F, column, none"},
         {"C", "hemicube of the picked patch"},
         {"L", "linear or logarithmic scale"},
         {"M, shift + M", "next colour map, previous one"},
         {"S", "Gouraud or flat"},
         {"W", "patch outlines"},
         {"B", "back faces: striped, or seen through"},
         {"I, O, N", "of the selected group: alone; only its outlines; not shown"},
         {"A", "all groups"},
         {"K, shift + K", "clipping plane through the picked patch or none; its other side"},
         {"D", "measure: two clicks give a distance, and what is shown along the line"},
         {"U", "axes and scale bar"},
         {"ctrl + 1 ... 9, alt + 1 ... 9", "keep a camera beside the scene, go to it"},
         {"J", "walk: W, A, S, D (shift: faster), drags look around; Esc or J ends it"},
         {"T", "filmic or linear tone mapping"},
         {"E, shift + E", "brighter, darker by a third of a stop"},
         {"G, shift + G", "the next sweep from the lamps' light, all sweeps"},
         {"P, shift + P", "screenshot of the picture, of the whole window"},
         {"X", "copy a command line that draws this picture"},
         {"F5", "read the file again"},
         {"Tab", "side panel"},
         {"F1", "this list"},
         {"ctrl + Z, ctrl + shift + Z", "takes back a change of materials or temperatures; redoes it"},
         {"Esc", "closes a list, lets go of the patch"},
         {"Q", "quits; asks where something is not saved"}});
    return lines;
}

bool apply_camera_key(const KeyEvent& event, double aspect, OrbitCamera& orbit) {
    const char key = event.key;
    if (key == 'F' || key == home_key) {
        orbit.frame_all(aspect);
    } else if (key == 'R') {
        orbit.reset();
    } else if (key == '1') {
        orbit.look_along(OrbitCamera::Axis::front, event.shift, aspect);
    } else if (key == '3') {
        orbit.look_along(OrbitCamera::Axis::right, event.shift, aspect);
    } else if (key == '7') {
        orbit.look_along(OrbitCamera::Axis::top, event.shift, aspect);
    } else if (key == '5') {
        orbit.set_orthographic(!orbit.camera().orthographic);
    } else {
        return false;
    }
    return true;
}

bool apply_walk_key(const KeyEvent& event, double step, OrbitCamera& orbit) {
    constexpr double run = 4.0;
    const double way = event.shift ? run * step : step;
    if (event.key == 'W' || event.key == 'S') {
        orbit.walk(event.key == 'W' ? way : -way, 0.0);
    } else if (event.key == 'A' || event.key == 'D') {
        orbit.walk(0.0, event.key == 'D' ? way : -way);
    } else {
        return false;
    }
    return true;
}

bool apply_look_key(const KeyEvent& event, const ViewerInput& input, Choices& choices) {
    Look& look = choices.look;
    if (event.key == 'S') {
        look.shading = look.shading == Shading::flat ? Shading::gouraud : Shading::flat;
    } else if (event.key == 'T') {
        look.tone_mapping =
            look.tone_mapping == ToneMapping::filmic ? ToneMapping::linear : ToneMapping::filmic;
    } else if (event.key == 'E') {
        look.stops += event.shift ? -exposure_step : exposure_step;
    } else if (event.key == 'W') {
        look.outlines = !look.outlines;
    } else if (event.key == 'B') {
        look.backs = !look.backs;
    } else if (event.key == 'L') {
        bool& logarithmic = logarithmic_of(look);
        logarithmic = !logarithmic;
    } else if (event.key == 'M') {
        next_map(event.shift, map_of(look));
    } else if (event.key == 'V') {
        next_shown(event.shift, input, choices);
    } else if (event.key == 'H') {
        next_heat_map(input, choices);
    } else {
        return false;
    }
    return true;
}

} // namespace hemi::viewer
