#pragma once

#include "hemi/core/names.hpp"
#include "hemi/scene/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hemi {

/// Which way the one-sided faces of a scene are turned.
enum class Orientation {
    as_read, ///< as the file has them
    in,      ///< the outermost bodies to their inside, what is within them the other way round, and so on
    out,     ///< the outermost bodies to the outside, what is within them the other way round, and so on
};

/// The words of Orientation.
template <>
struct Names<Orientation> {
    /// In the order in which they are listed.
    static constexpr NamedValue<Orientation> table[] = {
        {Orientation::as_read, "as-read"}, {Orientation::in, "in"}, {Orientation::out, "out"}};
};

/// What orient() did.
struct OrientedFaces {
    std::size_t turned = 0;    ///< faces turned round
    std::size_t undecided = 0; ///< faces of flat sheets and of bodies with one side only: as they were
};

/// Turns one-sided faces: those that are connected by edges (corners at the same places, two faces at an
/// edge) all to the same side, which is found by the volume that they enclose; where there are gaps, by that
/// towards the middle of the gaps. Two-sided faces stay as they are.
OrientedFaces orient(Scene& scene, Orientation orientation);

/// What make_bodies_one_sided() did.
struct OneSidedBodies {
    std::size_t inwards = 0;  ///< bodies of which the inside is left
    std::size_t outwards = 0; ///< bodies of which the outside is left
    std::size_t faces = 0;    ///< of both
};

/// Makes two-sided faces one-sided where they are a watertight body (connected by edges, two faces at each)
/// of which one side meets nothing: a body that has all other faces inside it, or is convex and all there is,
/// keeps its inside; one within another such body, with nothing in it, keeps its outside. All others stay as
/// they are. Of very many faces in and around a body some are looked at; where bodies are so many and so
/// large that it would take minutes, nothing is done.
/// @param scene   its faces may be turned
/// @param groups  for every group whether its faces are meant; bodies with others stay as they are
OneSidedBodies make_bodies_one_sided(Scene& scene, const std::vector<bool>& groups);

/// The one-sided faces, in ascending order, that are turned against most of their watertight body's others
/// (two faces at every edge). Where a face is turned the wrong way, each of its edges runs the same way in
/// both faces.
[[nodiscard]] std::vector<std::uint32_t> turned_against_others(const Scene& scene);

/// Turns a face round: vertex 0 stays where it is, and the patches of a grid do.
void turn_round(Surface& surface);

} // namespace hemi
