#include "viewer/meanings.hpp"

namespace hemi::viewer {

namespace {

const char* meaning_of(Quantity quantity) {
    switch (quantity) {
    case Quantity::radiosity:
        return "B: flux that leaves a patch, emitted and reflected, by its area; W/m², or lm/m².";
    case Quantity::irradiance:
        return "E: flux that arrives at a patch by its area; W/m², or lx (illuminance).";
    case Quantity::direct:
        return "What of the irradiance comes straight from sun and sky; W/m², or lx.";
    case Quantity::exitance:
        return "M: flux that a patch emits by itself by its area; W/m², or lm/m².";
    case Quantity::reflectance:
        return "rho: share of what arrives that is reflected, evenly to all sides; no unit.";
    case Quantity::emissivity:
        return "epsilon = 1 - rho: what is emitted by what a black body of that temperature emits; no unit.";
    case Quantity::environment:
        return "e: share of what leaves a patch that reaches no other one; under a sky the sky view factor. "
               "No unit.";
    case Quantity::blocked:
        return "b: share of what leaves a patch that meets backs of one-sided surfaces; no unit. Above 1/2 "
               "the "
               "patch is buried.";
    case Quantity::row_error:
        return "Sum of F(i, j) over j, and e and b, less 1; no unit. By how much a row does not balance.";
    case Quantity::error:
        return "Estimated error of B, by form factors and patch size together; W/m², or lm/m².";
    case Quantity::error_factors:
        return "What of the estimated error of B comes from the form factors; W/m², or lm/m².";
    case Quantity::error_patch_size:
        return "What of the estimated error of B comes from the size of the patches; W/m², or lm/m².";
    case Quantity::area:
        return "A: area of a patch; m².";
    case Quantity::temperature:
        return "T, in K or °C.";
    case Quantity::net_flux:
        return "q = J - G: radiation that leaves a patch less what arrives; W/m², leaving positive.";
    }
    return "";
}

} // namespace

const char* meaning_of(const Shown& shown) {
    switch (shown.view) {
    case View::picture:
        return "The light as `hemi render` draws it: radiosity by pi is radiance, exposed and tone mapped.";
    case View::outlines:
        return "The patches' edges, on grey.";
    case View::items:
        return "Every patch in a colour of its own.";
    case View::groups:
        return "Every group, surfaces of one name, in a colour of its own.";
    case View::findings:
        return "What `hemi check` finds: patches that are buried, reversed, near others, or leak.";
    case View::row:
        return "F(i, j), i the picked patch: share of what leaves i that arrives at j; no unit.";
    case View::column:
        return "F(j, i), i the picked patch: share of what leaves j that arrives at i; no unit.";
    case View::quantity:
        break;
    }
    return meaning_of(shown.quantity);
}

} // namespace hemi::viewer
