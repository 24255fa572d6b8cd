"""Form factors: the program's bytes, closed forms, rows, files, settings."""

import sys

import h5py
import numpy
import pytest
import scipy.sparse

import hemi

# From a face of the unit cube to the opposite one, and to each of its neighbours.
OPPOSITE = 0.19982489569838
ADJACENT = 0.20004377607540


def same_bits(one, other):
    return (numpy.array_equal(one.indptr, other.indptr) and numpy.array_equal(one.indices, other.indices) and
            one.data.tobytes() == other.data.tobytes())


@pytest.mark.parametrize("preset", ["plain", "fast", "default"])
@pytest.mark.parametrize("name", ["furnace", "l-room"])
def test_factors_have_the_bits_that_the_program_writes(preset, name, scenes, program, tmp_path):
    path = scenes / f"{name}.json"
    size = 0.5
    arguments = ("factors", path, "--preset", preset, "--patch-size", size, "--device", "osmesa", "-q")
    program(*arguments, "-o", tmp_path / "program.npz")
    program(*arguments, "-o", tmp_path / "program.hff")
    scene = hemi.read_scene(path, patch_size=size)
    factors = hemi.form_factors(scene, preset, device="osmesa")
    factors.save(tmp_path / "module.npz")
    factors.save(tmp_path / "module.hff")
    assert factors.nnz > 1000 and factors.known.all()
    assert same_bits(factors.matrix, scipy.sparse.load_npz(tmp_path / "program.npz"))
    for extension in ("npz", "hff"):
        assert (tmp_path / f"module.{extension}").read_bytes() == (tmp_path / f"program.{extension}").read_bytes()


def test_a_cube_has_its_closed_form(make_box):
    factors = hemi.form_factors(make_box(patches_per_face=16), device="osmesa")
    groups = factors.by_group()
    exact = numpy.full((6, 6), ADJACENT)
    for axis in range(3):
        exact[2 * axis:2 * axis + 2, 2 * axis:2 * axis + 2] = [[0, OPPOSITE], [OPPOSITE, 0]]
    assert groups["groups"] == ["x0", "x1", "y0", "y1", "z0", "z1"]
    assert numpy.allclose(groups["areas"], 1)
    assert numpy.abs(groups["factors"] - exact).max() < 1e-5
    assert 0 < factors.estimate.row_rms < 1e-5 and factors.estimate.rows.shape == (96,)


def test_rows_balance_and_pairs_are_reciprocal(small_factors):
    sums = small_factors.row_sums + small_factors.environment + small_factors.back_faces
    assert numpy.allclose(sums, 1, atol=1e-6)
    exchange = scipy.sparse.diags(small_factors.areas) @ small_factors.matrix.astype(float)
    assert abs(exchange - exchange.T).max() < 1e-9


@pytest.mark.parametrize("shape", [(54,), (54, 1), (54, 7)])
def test_a_product_is_that_of_the_matrix(small_factors, shape):
    x = numpy.random.default_rng(1).random(shape)
    assert (small_factors @ x).shape == shape
    assert numpy.allclose(small_factors @ x, small_factors.matrix @ x, rtol=1e-14)
    assert numpy.allclose(small_factors @ numpy.asfortranarray(x), small_factors.matrix @ x, rtol=1e-14)


def test_what_is_no_product_is_refused(small_factors):
    for wrong in (numpy.ones(53), numpy.ones((2, 54)), numpy.ones((54, 1, 1)), numpy.float64(1)):
        with pytest.raises(hemi.InvalidArgument, match=r"shape \[54\]"):
            small_factors @ wrong
    with pytest.raises(TypeError):
        numpy.ones(54) @ small_factors


def test_the_matrix_is_one_copy(small_factors):
    assert small_factors.matrix is small_factors.matrix
    assert small_factors.matrix.dtype == numpy.float32 and small_factors.shape == (54, 54)
    assert small_factors.matrix.has_sorted_indices and small_factors.matrix.nnz == small_factors.nnz


def test_rows_are_those_of_the_matrix(small_factors):
    for i in (0, 17, 53):
        row = small_factors.row(i)
        stored = small_factors.matrix[i]
        assert numpy.array_equal(row.columns, stored.indices) and row.values.tobytes() == stored.data.tobytes()
        assert numpy.array_equal(row.dense(), stored.toarray()[0])
        assert row.sum == pytest.approx(small_factors.row_sums[i], abs=0)
        assert row.sum + row.environment + row.back_faces == pytest.approx(1, abs=1e-6)
        assert (row.visibility == 255).all()
    assert (small_factors.visibility == 255).all()
    for wrong in (-1, 54):
        with pytest.raises(IndexError):
            small_factors.row(wrong)


def test_a_row_outlives_its_factors(make_box):
    values = hemi.form_factors(make_box(), "plain", device="osmesa").row(0).values
    assert values.sum() == pytest.approx(1, abs=1e-6)


def test_single_rows_are_those_of_all(small_box):
    everything = hemi.form_factors(small_box, "default", device="osmesa", repair="none")
    some = hemi.form_factors(small_box, "default", device="osmesa", patches=numpy.array([40, 3, 3]))
    assert list(numpy.flatnonzero(some.known)) == [3, 40] and some.estimate is None
    for i in (3, 40):
        # The other direction of a pair adds samples of its visibility, of which there is nothing hidden here.
        assert numpy.array_equal(some.row(i).values, everything.row(i).values)
    with pytest.raises(hemi.InvalidArgument, match="row 4 was not computed"):
        some.row(4)
    with pytest.raises(hemi.InvalidArgument, match="patches: 54"):
        hemi.form_factors(small_box, patches=[54])


def test_single_plain_rows_are_the_programs(scenes, program, tmp_path):
    program("factors", scenes / "furnace.json", "--preset", "plain", "--device", "osmesa", "-q", "-o", tmp_path / "a.npz")
    row = hemi.form_factors(hemi.read_scene(scenes / "furnace.json"), "plain", device="osmesa", patches=[77]).row(77)
    stored = scipy.sparse.load_npz(tmp_path / "a.npz")[77]
    assert numpy.array_equal(row.columns, stored.indices) and row.values.tobytes() == stored.data.tobytes()


@pytest.mark.parametrize("method, tolerance, settings", [
    ("direct", 1e-6, {}), ("contour", 1e-4, {}), ("montecarlo", 5e-3, {"rays": 65536, "seed": 3}),
])
def test_baseline_methods_find_the_cube(make_box, method, tolerance, settings):
    factors = hemi.form_factors(make_box(), method=method, estimate=False, **settings)
    assert factors.matrix[0, 1] == pytest.approx(OPPOSITE, rel=tolerance)
    assert factors.matrix[0, 2] == pytest.approx(ADJACENT, rel=tolerance)
    assert factors.settings["method"] == method and factors.settings["preset"] is None


def test_the_hemisphere_finds_what_the_centre_of_a_face_sees(make_box):
    factors = hemi.form_factors(make_box(), method="hemisphere", resolution=512, estimate=False)
    slope = 0.5 / numpy.sqrt(1.25)
    opposite = 4 / numpy.pi * slope * numpy.arctan(slope)
    assert factors.matrix[0, 1] == pytest.approx(opposite, rel=2e-3)
    assert factors.matrix[0, 2] == pytest.approx((1 - opposite) / 4, rel=2e-3)


@pytest.mark.parametrize("arguments, words", [
    ({"preset": "defalt"}, 'there is no preset "defalt"; did you mean "default"'),
    ({"method": "ray"}, 'there is no method "ray"'),
    ({"repair": "all"}, 'there is no repair "all"'),
    ({"resolution": 7}, "7"),
    ({"eye_points": 5}, "5"),
    ({"shadow_rays": 4, "preset": "plain"}, "shadow_rays does not apply"),
    ({"rays": 4}, "rays does not apply to method \"hemicube\"; it belongs to montecarlo"),
    ({"method": "direct", "seed": 1}, "seed does not apply"),
    ({"method": "direct", "preset": "exact"}, "preset does not apply"),
    ({"device": "gpu"}, "gpu"),
])
def test_settings_that_do_not_fit_are_refused(small_box, arguments, words):
    with pytest.raises(hemi.InvalidArgument, match=words) as caught:
        hemi.form_factors(small_box, **arguments)
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, hemi.Error)


def test_a_device_that_is_not_there_is_named(small_box):
    with pytest.raises(hemi.NoDevice, match="egl:99"):
        hemi.form_factors(small_box, device="egl:99")
    assert "osmesa" in [device["name"] for device in hemi.devices() if device["problem"] is None]


def test_memory_has_a_limit(make_box):
    scene = make_box(patches_per_face=64)
    with pytest.raises(MemoryError) as caught:
        hemi.form_factors(scene, "plain", device="osmesa", max_memory=1000)
    assert isinstance(caught.value, hemi.OutOfMemory) and "max-memory" in caught.value.settings


def test_check_finds_a_leak_and_a_reversed_wall(make_box):
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    walls = [[0, 3, 7, 4], [2, 1, 5, 6], [1, 0, 4, 5], [3, 2, 6, 7], [0, 1, 2, 3]]
    names = ["x0", "x1", "y0", "y1", "z0"]
    settings = {"enclosure": "closed", "patches_per_face": 9}
    whole = hemi.form_factors(make_box(patches_per_face=9), device="osmesa").check()
    assert whole["ok"] and whole["failures"] == [] and whole["leaks"] == [] and whole["enclosure"] == "closed"
    leaking = hemi.form_factors(hemi.Scene(vertices, walls, groups=names, **settings), device="osmesa").check()
    assert not leaking["ok"] and len(leaking["leaks"]) == 45 and leaking["failures"]
    assert leaking["leaks"][0]["towards"][2] > 0.5
    turned = hemi.Scene(vertices, [*walls, [4, 5, 6, 7]], groups=[*names, "lid"], **settings)
    assert [group["group"] for group in hemi.form_factors(turned, device="osmesa").check()["reversed"]] == ["lid"]


@pytest.mark.parametrize("extension", ["hff", "npz", "mtx", "csv", "txt", "vf", "dat", "bin"])
def test_what_is_saved_is_loaded(small_box, small_factors, tmp_path, extension):
    path = tmp_path / f"f.{extension}"
    small_factors.save(path)
    loaded = hemi.load(path, small_box)
    # Text has 9 digits, which tell floats apart.
    assert (loaded.matrix != small_factors.matrix).nnz == 0
    assert numpy.array_equal(loaded.areas, small_factors.areas) and loaded.scene is small_box
    if extension == "hff":
        alone = hemi.load(str(path))
        assert alone.scene is None and alone.groups == small_box.groups and alone.check()["ok"]
        assert alone.settings == small_factors.settings
        assert alone.estimate.row_rms == small_factors.estimate.row_rms
        assert (hemi.load(path, repair="none").matrix != small_factors.matrix).nnz > 0


def test_a_zone_of_energyplus_has_the_name_that_is_given(small_factors, tmp_path):
    small_factors.save(tmp_path / "f.idf", zone="ZONE ONE")
    assert "BySurfaceName,\n  ZONE ONE,  !- Zone Name\n" in (tmp_path / "f.idf").read_text()
    with pytest.raises(hemi.InvalidArgument, match="zone: is for EnergyPlus"):
        small_factors.save(tmp_path / "f.npz", zone="ZONE ONE")


@pytest.mark.parametrize("extension", ["npy", "h5", "idf", "vtp"])
def test_files_for_others_are_the_programs(scenes, program, tmp_path, extension):
    arguments = ("factors", scenes / "furnace.json", "--preset", "plain", "--patch-size", 0.5, "--device", "osmesa", "-q")
    for folder in ("program", "module"):
        (tmp_path / folder).mkdir() # a zone of EnergyPlus has the file's name
    program(*arguments, "-o", tmp_path / "program" / f"f.{extension}")
    scene = hemi.read_scene(scenes / "furnace.json", patch_size=0.5)
    hemi.form_factors(scene, "plain", device="osmesa").save(tmp_path / "module" / f"f.{extension}")
    paths = [tmp_path / folder / f"f.{extension}" for folder in ("program", "module")]
    if extension == "h5": # has the time in it
        one, other = map(hdf5_content, paths)
        assert len(one) > 5 and one == other
    else:
        assert paths[0].read_bytes() == paths[1].read_bytes()


def hdf5_content(path):
    """Bytes of every array by its name."""
    arrays = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: arrays.update({name: numpy.asarray(item).tobytes()})
                        if isinstance(item, h5py.Dataset) and item.dtype.kind != "O" else None)
    return arrays


def test_files_that_do_not_fit_are_refused(small_box, small_factors, make_box, tmp_path):
    small_factors.save(tmp_path / "f.hff")
    small_factors.save(tmp_path / "f.npz")
    with pytest.raises(hemi.InputError, match="another geometry"):
        hemi.load(tmp_path / "f.hff", make_box((1, 1, 2), patches_per_face=9))
    with pytest.raises(hemi.InputError, match="54 patches; the scene has 6"):
        hemi.load(tmp_path / "f.npz", make_box())
    with pytest.raises(hemi.InvalidArgument, match="as they were computed"):
        hemi.load(tmp_path / "f.npz").save(tmp_path / "g.hff")
    with pytest.raises(hemi.InvalidArgument, match="areas"):
        hemi.load(tmp_path / "f.npz").check()
    with pytest.raises(hemi.InvalidArgument, match="groups"):
        hemi.load(tmp_path / "f.npz").by_group()
    with pytest.raises(hemi.InvalidArgument, match="geometry"):
        hemi.load(tmp_path / "f.hff").save(tmp_path / "f.vtp")
    with pytest.raises(hemi.InvalidArgument, match="written as"):
        small_factors.save(tmp_path / "f.xyz")
    with pytest.raises(OSError) as caught:
        small_factors.save(tmp_path / "nowhere" / "f.npz")
    assert isinstance(caught.value, hemi.IoError)
    with pytest.raises(hemi.InputError, match="f.hff"):
        (tmp_path / "f.hff").write_bytes((tmp_path / "f.hff").read_bytes()[:-100])
        hemi.load(tmp_path / "f.hff")


def test_objects_do_not_leak(small_factors):
    row = small_factors.row(0)
    before = sys.getrefcount(small_factors)
    for _ in range(100):
        small_factors.row(1).values
        small_factors.areas
    assert sys.getrefcount(small_factors) == before
    assert len(row) == len(row.values)
