#pragma once

#include "hemi/core/names.hpp"
#include "hemi/display/picture_cut.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/scene/scene.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// How radiosity times exposure becomes a brightness.
enum class ToneMapping {
    filmic, ///< an S-curve that rolls off towards white
    linear, ///< as it is, cut off at white
};

/// Words of ToneMapping.
template <>
struct Names<ToneMapping> {
    /// Every value with its word.
    static constexpr NamedValue<ToneMapping> table[] = {{ToneMapping::filmic, "filmic"},
                                                        {ToneMapping::linear, "linear"}};
};

/// What a patch's pixels show.
enum class Shading {
    gouraud, ///< interpolated between its corners, see corner_values()
    flat,    ///< its own value
};

/// How a solution is drawn, apart from the camera.
struct PictureSettings {
    std::uint32_t width = 800;                      ///< pixels, 1 to 16384
    std::uint32_t height = 800;                     ///< pixels, 1 to 16384
    std::uint32_t samples = 4;                      ///< supersamples along each edge of a pixel, 1 to 8
    Shading shading = Shading::gouraud;             ///< interpolated or flat
    ToneMapping tone_mapping = ToneMapping::filmic; ///< of `srgb`; `linear` has none
    double exposure = 1.0;                          ///< factor on radiosity before tone mapping
    bool outlines = false;                          ///< patch outlines on top
    /// Show the backs of one-sided surfaces, striped; else one looks through them. Nothing radiates from
    /// them.
    bool backs = false;
    /// Shown where no surface is, sRGB; none: the environment, or a dark neutral grey where there is none.
    std::optional<std::array<std::uint8_t, 3>> background;
    PictureCut cut; ///< what is left out
    /// Gouraud values of the first channel along which a line is drawn, ascending, at most 32. For colours
    /// that are no light: lines are black, or light on dark colours.
    std::vector<float> iso_lines;
};

/// Radiosity prepared for drawing: three linear sRGB channels a patch corner and a patch.
struct PictureMesh {
    /// 3 per corner, 4 corners a patch (triangle: third repeated), relative to `origin`
    std::vector<float> positions;
    std::vector<float> corners;         ///< 3 per corner, Gouraud values
    std::vector<float> patches;         ///< 3 per patch, flat values
    std::vector<std::uint32_t> groups;  ///< of every patch, for PictureCut; empty: all patches are shown
    Vec3 origin{0.0};                   ///< scene units; keeps digits of scenes far from 0
    Bounds bounds;                      ///< scene units, absolute
    std::array<float, 3> environment{}; ///< radiosity behind all surfaces; zero: there is none
    std::uint32_t without_outline = 0;  ///< so many patches, the last ones, never have outlines
};

/// A solution as a mesh to draw. The environment is left at zero, for the caller to fill in.
/// @param mesh       its patches
/// @param channels   of the solution
/// @param radiosity  channel c of patch i at [i·channels + c]
/// @param blocked    b_i of every patch, or empty: covered patches lend nothing to their neighbours
/// @param show       channels shown as red, green, blue (one channel: {0, 0, 0})
/// @param vertices   Solution::vertex_radiosity, or empty: means over the patches, see corner_values()
[[nodiscard]] PictureMesh make_picture_mesh(const PatchMesh& mesh, std::uint32_t channels,
                                            std::span<const double> radiosity,
                                            std::span<const double> blocked,
                                            std::array<std::uint32_t, 3> show,
                                            std::span<const float> vertices = {});

/// The same with all images of the scene, coloured as what they are images of; behind the scene's own
/// patches.
/// @param picture  of the patches of `mesh`, nothing else
/// @param mesh     without symmetry nothing is added
[[nodiscard]] PictureMesh with_images(PictureMesh picture, const PatchMesh& mesh);

/// A radiosity for pictures of scenes that nothing lights: as if light came from everywhere, a little more of
/// it from one side, so that shapes can be told; black surfaces are dark grey. It is no result, and of the
/// order of 1.
/// @param mesh         its patches
/// @param reflectance  channel c of patch i at [i·channels + c]
/// @param channels     of the reflectance and of the radiosity
/// @param up           Scene::up; more comes from above
/// @throws InvalidArgument for another number of values
[[nodiscard]] std::vector<double> even_light(const PatchMesh& mesh, std::span<const double> reflectance,
                                             std::uint32_t channels, UpAxis up = UpAxis::z);

/// Exposure that suits a scene: from the area-weighted distribution of luminance over patches that are not
/// lamps and not covered. Deterministic. 1 if all is dark.
[[nodiscard]] double automatic_exposure(const PatchMesh& mesh, const PictureMesh& picture,
                                        std::span<const double> blocked, std::span<const double> exitance,
                                        std::uint32_t channels);

/// A camera that sees the whole scene, for scenes that have none: inside looking across for closed rooms is
/// the scene's business; this one frames the bounds from a corner.
/// @param bounds  of all surfaces, scene units
/// @param up      Scene::up
[[nodiscard]] Camera default_camera(const Bounds& bounds, UpAxis up = UpAxis::z);

/// Pixels, rows from the top, 3 values a pixel.
struct Picture {
    std::uint32_t width = 0;        ///< pixels
    std::uint32_t height = 0;       ///< pixels
    std::vector<std::uint8_t> srgb; ///< tone-mapped, sRGB-encoded
    std::vector<float> linear;      ///< radiosity, no exposure, no tone mapping
};

/// Draws offscreen with a context of its own on `device` (auto, egl, egl:N, osmesa). Where no surface
/// is seen, the environment is; where there is none, `srgb` is a dark neutral grey and `linear` zero.
/// Afterwards no context is current on the thread.
/// @throws NoDevice, GlError; InvalidArgument for a size outside 1 to 16384, samples outside 1 to 8, an
///   exposure that is negative or not finite, a camera without a direction or field of view, more than 32
///   lines, and a cut by groups of a mesh that says of none.
[[nodiscard]] Picture draw_picture(const PictureMesh& mesh, const Camera& camera,
                                   const PictureSettings& settings, const std::string& device);

} // namespace hemi
