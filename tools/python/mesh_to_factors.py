#!/usr/bin/python3
"""Makes a mesh in NumPy, computes form factors, and plots a row. The worked example of the module hemi.

    PYTHONPATH=build/python /usr/bin/python3 tools/python/mesh_to_factors.py -o row.png

A lamp of 1 m x 1 m hangs 2 m above a floor, a ball between them. Row i of F, i being the lamp's patch, says where its light
goes; divided by the areas it is the irradiance per watt. Needs python3-matplotlib.
"""

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as pyplot
import numpy
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import hemi


def grid(corner, u, v, cells):
    """A rectangle cut into cells x cells faces; its front is the side that u x v points to."""
    s, t = numpy.meshgrid(numpy.linspace(0, 1, cells + 1), numpy.linspace(0, 1, cells + 1), indexing="ij")
    vertices = numpy.asarray(corner) + s[..., None] * numpy.asarray(u) + t[..., None] * numpy.asarray(v)
    index = numpy.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    faces = numpy.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return vertices.reshape(-1, 3), faces.reshape(-1, 4)


def ball(centre, radius, rings):
    """A sphere of rings of planar trapezoids, with triangles (last index -1) about its poles."""
    segments = 2 * rings
    polar = numpy.linspace(0, numpy.pi, rings + 1)[1:-1]
    turn = numpy.linspace(0, 2 * numpy.pi, segments, endpoint=False)
    theta, phi = numpy.meshgrid(polar, turn, indexing="ij")
    around = numpy.stack([numpy.sin(theta) * numpy.cos(phi), numpy.sin(theta) * numpy.sin(phi), numpy.cos(theta)], axis=-1)
    vertices = numpy.concatenate([around.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]]) * radius + centre
    index = numpy.arange(len(polar) * segments).reshape(len(polar), segments)
    after = numpy.roll(index, -1, axis=1)
    sides = numpy.stack([index[:-1], index[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
    none = numpy.full(segments, -1)
    top = numpy.stack([numpy.full(segments, len(vertices) - 2), index[0], after[0], none], axis=-1)
    bottom = numpy.stack([numpy.full(segments, len(vertices) - 1), after[-1], index[-1], none], axis=-1)
    return vertices, numpy.concatenate([sides, top, bottom])


def joined(parts):
    """Vertices and faces of all parts, and the name of every face's part."""
    vertices, faces, names = [], [], []
    for name, (points, indices) in parts.items():
        offset = sum(map(len, vertices))
        faces.append(numpy.where(indices >= 0, indices + offset, -1))
        vertices.append(points)
        names += [name] * len(indices)
    return numpy.concatenate(vertices), numpy.concatenate(faces), names


def main():
    parser = argparse.ArgumentParser(description="Makes a mesh in NumPy, computes form factors, and plots a row.")
    parser.add_argument("-o", dest="output", default="row.png", help="picture to write (row.png)")
    parser.add_argument("--cells", type=int, default=40, help="floor patches along an edge (40)")
    arguments = parser.parse_args()

    cells = arguments.cells
    vertices, faces, names = joined({
        "floor": grid([-2, -2, 0], [4, 0, 0], [0, 4, 0], cells),
        "ball": ball([0.4, 0, 0.8], 0.4, 12),
        "lamp": grid([-0.5, -0.5, 2], [0, 1, 0], [1, 0, 0], 1),
    })
    scene = hemi.Scene(vertices, faces, groups=names)
    lamp = int(numpy.flatnonzero(scene.group_of == scene.groups.index("lamp"))[0])
    factors = hemi.form_factors(scene, "exact", patches=[lamp])
    row = factors.row(lamp)
    irradiance = row.dense() / scene.areas
    print(f"{scene}: sum of row {lamp} {row.sum:.4f}, environment {row.environment:.4f}")

    figure = pyplot.figure(figsize=(11, 4.8))
    colours = pyplot.get_cmap("inferno")
    on_floor = scene.group_of == scene.groups.index("floor")
    scale = matplotlib.colors.Normalize(0, irradiance[on_floor].max()) # the top of the ball has more
    space = figure.add_subplot(1, 2, 1, projection="3d")
    space.add_collection3d(Poly3DCollection(scene.corners, facecolors=colours(scale(irradiance))))
    space.set(xlim=(-2, 2), ylim=(-2, 2), zlim=(0, 2.2), xlabel="x, m", ylabel="y, m", zlabel="z, m",
              title=f"Row {lamp} of F, the lamp's, over areas")
    space.set_box_aspect((4, 4, 2.2))
    space.view_init(elev=18, azim=-70)

    flat = figure.add_subplot(1, 2, 2)
    # The patches of the floor go with y fastest.
    seen = irradiance[on_floor].reshape(cells, cells).T
    image = flat.imshow(seen, origin="lower", extent=(-2, 2, -2, 2), cmap=colours, norm=scale)
    flat.set(xlabel="x, m", ylabel="y, m", title="The floor, from above")
    figure.colorbar(image, ax=flat, label="F(lamp, j) / A(j), W/m² per watt of the lamp", extend="max")
    figure.tight_layout()
    figure.savefig(arguments.output, dpi=120)


if __name__ == "__main__":
    main()
