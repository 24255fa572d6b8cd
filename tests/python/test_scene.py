"""Scenes from arrays and from files."""

import json

import numpy
import pytest

import hemi

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def test_arrays_of_patches_are_what_the_geometry_says(make_box):
    scene = make_box((2, 1, 1), patches_per_face=4)
    assert len(scene) == 24
    assert scene.areas.sum() == pytest.approx(10)
    assert scene.centres.shape == (24, 3) and scene.corners.shape == (24, 4, 3)
    assert numpy.allclose(scene.corners.mean(axis=1), scene.centres)
    middle = numpy.array([1, 0.5, 0.5])
    assert ((middle - scene.centres) * scene.normals).sum(axis=1).min() > 0
    assert [scene.groups[g] for g in scene.group_of[::4]] == ["x0", "x1", "y0", "y1", "z0", "z1"]
    assert list(scene.face_of[::4]) == [0, 1, 2, 3, 4, 5]


def test_arrays_and_a_file_make_the_same_scene(tmp_path, make_box):
    scene = make_box((2, 1, 1), patches_per_face=4, reflectance=0.25, exitance=3)
    lines = [f"v {x} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (2, 0), (2, 1), (0, 1))]
    lines += ["g x0", "f 1 4 8 5", "g x1", "f 3 2 6 7", "g y0", "f 2 1 5 6", "g y1", "f 4 3 7 8", "g z0", "f 1 2 3 4",
              "g z1", "f 8 7 6 5"]
    (tmp_path / "box.obj").write_text("\n".join(lines) + "\n")
    read = hemi.read_scene(tmp_path / "box.obj", patches_per_face=4, enclosure="closed")
    assert read.groups == scene.groups and read.enclosure == scene.enclosure
    for name in ("areas", "centres", "normals", "corners", "group_of", "face_of"):
        assert numpy.array_equal(getattr(read, name), getattr(scene, name)), name
    one = hemi.form_factors(scene, "plain", device="osmesa")
    other = hemi.form_factors(read, "plain", device="osmesa")
    assert (one.matrix != other.matrix).nnz == 0


def test_triangles_and_quadrilaterals_mix_in_both_forms():
    vertices = [*SQUARE, [2, 0, 0]]
    padded = hemi.Scene(vertices, numpy.array([[0, 1, 2, 3], [1, 4, 2, -1]]))
    listed = hemi.Scene(vertices, [[0, 1, 2, 3], [1, 4, 2]])
    triangles = hemi.Scene(vertices, numpy.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]], dtype=numpy.uint8))
    assert numpy.array_equal(padded.areas, [1, 0.5]) and numpy.array_equal(listed.areas, [1, 0.5])
    assert numpy.array_equal(triangles.areas, [0.5, 0.5, 0.5])
    assert numpy.array_equal(padded.corners[1], [[1, 0, 0], [2, 0, 0], [1, 1, 0], [1, 1, 0]])


@pytest.mark.parametrize("value, expected", [
    (0.5, [[0.5], [0.5]]),
    ([0.1, 0.2], [[0.1], [0.2]]),
    ([[0.1, 0.2, 0.3]], [[0.1, 0.2, 0.3], [0.1, 0.2, 0.3]]),
    ([[0.1], [0.2]], [[0.1], [0.2]]),
    ([[0.1, 0.2], [0.3, 0.4]], [[0.1, 0.2], [0.3, 0.4]]),
])
def test_values_have_axes_of_faces_and_of_channels(value, expected):
    faces = [[0, 1, 2], [0, 2, 3]]
    scene = hemi.Scene(SQUARE, faces, reflectance=value, exitance=2)
    assert numpy.array_equal(scene.reflectance, expected)
    assert numpy.array_equal(scene.exitance, numpy.full(numpy.shape(expected), 2.0))
    assert len(scene.channels) == numpy.shape(expected)[1]


def test_two_sided_faces_have_patches_on_their_backs():
    scene = hemi.Scene(SQUARE, [[0, 1, 2], [0, 2, 3]], two_sided=[True, False])
    assert list(scene.face_of) == [0, 0, 1]
    assert numpy.array_equal(scene.normals[0], -scene.normals[1])


@pytest.mark.parametrize("arguments, words", [
    ({"faces": [[0, 1]]}, r"faces\[0\]: 2 vertices; must be 3 or 4"),
    ({"faces": [[0, 1, 9]]}, r"faces\[0\]: vertex 9; there are 4"),
    ({"faces": numpy.array([[0, 1, -1]])}, r"faces\[0\]: vertex -1"),
    ({"faces": numpy.array([[0.0, 1, 2]])}, "must be integers"),
    ({"vertices": [[0, 0]]}, r"vertices: must have the shape \[n, 3\]"),
    ({"reflectance": [0.1, 0.2, 0.3]}, r"reflectance of shape \[3\]"),
    ({"reflectance": 1.5}, "reflectance 1.5"),
    ({"groups": ["a", "b", "c"]}, "groups: 3 names"),
    ({"enclosure": "close"}, 'did you mean "closed"'),
    ({"environment": -1}, "environment -1"),
    ({"vertices": [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]]}, "area"),
])
def test_what_cannot_be_used_is_refused_by_name(arguments, words):
    with pytest.raises(hemi.Error, match=words):
        hemi.Scene(**{"vertices": SQUARE, "faces": [[0, 1, 2, 3]], **arguments})


def test_errors_of_files_name_file_and_place(tmp_path):
    path = tmp_path / "bad.json"
    path.write_text('{"hemi": 1,\n "surfaces": oops}')
    with pytest.raises(hemi.ParseError) as caught:
        hemi.read_scene(path)
    assert caught.value.line == 2 and caught.value.file == str(path) and str(path) in str(caught.value)
    assert isinstance(caught.value, hemi.InputError)
    with pytest.raises(hemi.InputError, match="missing.obj"):
        hemi.read_scene(tmp_path / "missing.obj")
    with pytest.raises(hemi.InvalidArgument, match="JSON scenes"):
        hemi.read_scene(path, two_sided=["floor"])
    with pytest.raises(hemi.InvalidArgument, match='did you mean "floor"'):
        obj = tmp_path / "square.obj"
        obj.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\ng floor\nf 1 2 3\n")
        hemi.read_scene(obj, two_sided=["flor"])


def test_warnings_of_readers_are_pythons(tmp_path):
    path = tmp_path / "square.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 1 2\n")
    with pytest.warns(hemi.HemiWarning):
        assert len(hemi.read_scene(path, planarity=1e-4)) == 1


def test_settings_of_reading_replace_the_scenes_own(scenes):
    scene = hemi.read_scene(scenes / "cube.json", environment=[1, 2, 3], enclosure="open")
    assert scene.enclosure == "open" and list(scene.environment) == [1, 2, 3]
    described = json.loads((scenes / "cube.json").read_text())
    assert scene.name == described["name"] and scene.channels == described["channels"]


def test_views_keep_their_scene_alive_and_cannot_be_written(make_box):
    areas = make_box().areas
    with pytest.raises(ValueError):
        areas[0] = 2
    assert list(areas) == [1] * 6


def test_factors_from_a_point_above_a_square():
    scene = hemi.Scene([[-1, -1, 1], [-1, 1, 1], [1, 1, 1], [1, -1, 1]], [[0, 1, 2, 3]])
    exact = 4 * numpy.arctan(1 / numpy.sqrt(2)) / (numpy.sqrt(2) * numpy.pi)
    assert hemi.point_factors(scene, [0, 0, 0], [0, 0, 5])[0] == pytest.approx(exact, rel=1e-12)
    with pytest.raises(ValueError, match="normal"):
        hemi.point_factors(scene, [0, 0, 0], [0, 0, 0])


def test_faces_are_cut_where_others_touch_them(tmp_path):
    path = tmp_path / "rug.obj"
    path.write_text(
        "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 3 1 0\nv 3 3 0\nv 1 3 0\n"
        "g floor\nf 1 2 3 4\ng rug\nf 5 6 7 8\n"
    )
    whole = hemi.read_scene(path, imprint=False)
    assert whole.areas.sum() == pytest.approx(20)
    assert whole.patch_of is None
    cut = hemi.read_scene(path)
    assert cut.areas.sum() == pytest.approx(16)
    assert cut.groups == ["floor", "rug"]
    assert set(cut.face_of[:-1]) == {0} and cut.face_of[-1] == 1
    assert list(cut.patch_of) == list(cut.face_of)

    lid = "v 0 0 2\nv 4 0 2\nv 4 4 2\nv 0 4 2\ng lid\nf 12 11 10 9\n"
    path.write_text(path.read_text() + lid)
    scene = hemi.read_scene(path)
    parts = hemi.form_factors(scene, device="cpu")
    patches = parts.by_patch()
    assert len(parts) == len(scene) > len(patches) == 3
    f = patches.matrix.toarray()
    # As two plates, and the lid sees both of their parts: closed form of parallel plates.
    assert f[2, 0] + f[2, 1] == pytest.approx(0.4152532, abs=1e-3)
    assert 12 * f[0, 2] == pytest.approx(16 * f[2, 0], rel=1e-3)
    solution = parts.solve(exitance=1.0)
    solution.save(tmp_path / "a.csv")
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 4
    parts.solve().save(tmp_path / "a.hres")
    assert list(hemi.load(tmp_path / "a.hres").scene.patch_of) == list(scene.patch_of)


def test_faces_can_be_turned(tmp_path):
    path = tmp_path / "plate.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng floor\nf 1 2 3 4\n")
    assert hemi.read_scene(path).normals[0, 2] == 1
    assert hemi.read_scene(path, flip=["floor"]).normals[0, 2] == -1
    assert len(hemi.read_scene(path, two_sided=["*"])) == 2
    with pytest.raises(ValueError, match="orient"):
        hemi.read_scene(path, orient="inside")


def test_a_zone_of_an_energyplus_model(tmp_path):
    corners = [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)]
    vertices = [{f"vertex_{axis}_coordinate": value for axis, value in zip("xyz", corner)} for corner in corners]
    path = tmp_path / "model.epJSON"
    path.write_text(json.dumps({
        "GlobalGeometryRules": {"Rules": {"vertex_entry_direction": "Clockwise", "coordinate_system": "World"}},
        "Zone": {"Attic": {}, "Cellar": {}},
        "Floor:Detailed": {"Ground": {"zone_name": "Cellar", "vertices": vertices}}}))
    assert hemi.read_scene(path, zone="cellar").groups == ["Ground"]
    with pytest.raises(hemi.InvalidArgument, match="2 zones; one must be chosen"):
        hemi.read_scene(path)


def test_a_face_out_of_plane_is_one_patch_of_two_parts(tmp_path):
    lines = ["v 0 0 0", "v 1 0 0", "v 1 1 -0.3", "v 0 1 0", "v 0 0 1", "v 1 0 1", "v 1 1 1", "v 0 1 1",
             "f 8 7 6 5", "f 1 2 3 4", "f 2 1 5 6", "f 3 2 6 7", "f 4 3 7 8", "f 1 4 8 5"]
    (tmp_path / "warped.obj").write_text("\n".join(lines) + "\n")
    with pytest.warns(hemi.HemiWarning, match="out of plane"):
        scene = hemi.read_scene(tmp_path / "warped.obj")
    assert len(scene) == 7
    assert list(scene.patch_of) == list(scene.face_of) == [0, 1, 1, 2, 3, 4, 5]
    parts = hemi.form_factors(scene, "default", device="cpu", jobs=1)
    faces = parts.by_patch()
    assert faces.matrix.shape == (6, 6)
    exchange = numpy.zeros((6, 6))
    dense = parts.matrix.toarray() * scene.areas[:, None]
    for i, k in enumerate(scene.patch_of):
        for j, m in enumerate(scene.patch_of):
            exchange[k, m] += dense[i, j]
    areas = numpy.bincount(scene.patch_of, scene.areas)
    assert numpy.allclose(faces.matrix.toarray() * areas[:, None], exchange, atol=1e-12)
    assert numpy.allclose(exchange, exchange.T, atol=1e-6)
    with pytest.warns(hemi.HemiWarning, match="out of plane"):
        finer = hemi.read_scene(tmp_path / "warped.obj", patches_per_face=4)
    assert finer.patch_of is None and list(finer.face_of[:4:3]) == [0, 0] and finer.face_of[-1] == 5
