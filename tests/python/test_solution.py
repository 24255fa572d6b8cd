"""Radiosity, result files and pictures."""

import json

import numpy
import pytest

import hemi


def test_a_white_furnace_is_the_same_everywhere(scenes):
    scene = hemi.read_scene(scenes / "furnace.json")
    solution = hemi.form_factors(scene, device="osmesa").solve(tolerance=1e-9)
    assert solution.radiosity.shape == (629, 3)
    assert numpy.allclose(solution.radiosity, 5, rtol=1e-6)
    assert numpy.allclose(solution.irradiance, 5, rtol=1e-6)
    assert numpy.array_equal(solution.exitance, numpy.ones((629, 3)))
    assert solution.residual <= 1e-9 and solution.channels == ["red", "green", "blue"] and solution.error < 1e-5


def test_a_solution_is_the_programs(scenes, program, tmp_path):
    path = scenes / "cube.json"
    program("solve", path, "--patches-per-face", 16, "--device", "osmesa", "-q", "--result", tmp_path / "program.hres",
            "--radiosity", tmp_path / "program.csv")
    solution = hemi.form_factors(hemi.read_scene(path, patches_per_face=16), device="osmesa").solve(gather="auto")
    solution.save(tmp_path / "module.hres")
    solution.save(tmp_path / "module.csv")
    assert (tmp_path / "module.csv").read_bytes() == (tmp_path / "program.csv").read_bytes()
    stored = hemi.load(tmp_path / "program.hres")
    for name in ("radiosity", "irradiance", "exitance", "row_sums", "environment", "back_faces", "patch_errors",
                 "vertex_radiosity"):
        assert numpy.array_equal(getattr(stored, name), getattr(solution, name)), name
    assert solution.vertex_radiosity.shape == (96, 4, 3)
    assert stored.residual == solution.residual and stored.error == solution.error
    assert solution.errors["vertices"]["rms"] > solution.errors["parts"]["factors"] == solution.error
    assert len(solution.errors["groups"]) == len(solution.scene.groups)
    assert (solution.patch_errors > 0).all()
    numpy.testing.assert_equal(stored.errors, solution.errors)
    assert (tmp_path / "module.hres").read_bytes() == (tmp_path / "program.hres").read_bytes()


def test_sun_and_sky_are_known_apart(scenes, program, tmp_path):
    document = json.loads((scenes / "cube.json").read_text())
    document["surfaces"] = [surface for surface in document["surfaces"] if surface["name"] != "z1"]
    document["enclosure"] = "open"
    document["sun"] = {"azimuth": 150, "elevation": 55, "normal_irradiance": 800}
    document["environment"] = {"sky": "overcast", "horizontal_irradiance": 100}
    path = tmp_path / "court.json"
    path.write_text(json.dumps(document))
    scene = hemi.read_scene(path, patches_per_face=16)
    solution = hemi.form_factors(scene, device="osmesa").solve()
    assert solution.direct.shape == solution.radiosity.shape
    assert (solution.irradiance > solution.direct).all() and solution.direct.max() > 600
    solution.save(tmp_path / "module.hres")
    program("solve", path, "--patches-per-face", 16, "--device", "osmesa", "-q", "--gather", "off",
            "--result", tmp_path / "program.hres")
    stored = hemi.load(tmp_path / "program.hres")
    assert numpy.array_equal(stored.direct, solution.direct)
    assert numpy.array_equal(stored.radiosity, solution.radiosity)
    numpy.testing.assert_equal(stored.errors, solution.errors) # shadows count as the program counts them
    assert solution.errors["parts"]["patch_size"] > 0
    assert hemi.form_factors(hemi.read_scene(scenes / "cube.json"), device="osmesa").solve().direct is None


def test_radiosity_solves_its_equation(small_box, small_factors):
    random = numpy.random.default_rng(5)
    reflectance = random.uniform(0, 0.9, (54, 4))
    exitance = random.uniform(0, 10, (54, 4))
    solution = small_factors.solve(reflectance=reflectance, exitance=exitance, tolerance=1e-10)
    assert solution.radiosity.shape == (54, 4) and solution.channels == ["0", "1", "2", "3"]
    assert numpy.allclose(solution.radiosity, exitance + reflectance * solution.irradiance, rtol=1e-9)
    assert numpy.allclose(solution.irradiance, small_factors @ solution.radiosity, rtol=1e-5)


def test_given_values_stand_for_the_scenes(small_box, small_factors):
    own = small_factors.solve(tolerance=1e-10)
    same = small_factors.solve(reflectance=0.5, exitance=numpy.ones(54), environment=0, tolerance=1e-10)
    assert numpy.array_equal(own.radiosity, same.radiosity) and numpy.allclose(own.radiosity, 2, rtol=1e-6)
    doubled = small_factors.solve(exitance=2, tolerance=1e-10)
    assert numpy.allclose(doubled.radiosity, 2 * own.radiosity, rtol=1e-8)
    coloured = small_factors.solve(exitance=[[1, 2, 3]], tolerance=1e-10)
    assert numpy.allclose(coloured.radiosity, own.radiosity * [1, 2, 3], rtol=1e-8)


def test_an_open_square_sees_its_environment():
    scene = hemi.Scene([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]], reflectance=0.5, environment=2)
    factors = hemi.form_factors(scene, device="osmesa")
    assert factors.environment[0] == 1
    assert factors.solve().radiosity[0, 0] == pytest.approx(1)
    assert factors.solve(environment=[3]).radiosity[0, 0] == pytest.approx(1.5)


@pytest.mark.parametrize("method", ["gauss-seidel", "jacobi", "cg"])
def test_every_solver_comes_to_the_same(small_factors, method):
    solution = small_factors.solve(method=method, tolerance=1e-10)
    assert solution.method == method and numpy.allclose(solution.radiosity, 2, rtol=1e-6)


def test_factors_without_a_scene_need_values(small_factors, tmp_path):
    small_factors.save(tmp_path / "f.npz")
    alone = hemi.load(tmp_path / "f.npz")
    with pytest.raises(hemi.InvalidArgument, match="reflectance and exitance"):
        alone.solve(reflectance=0.5)
    solution = alone.solve(reflectance=0.5, exitance=1, irradiance=False)
    assert numpy.allclose(solution.radiosity, 2, rtol=1e-5) and solution.irradiance is None
    with pytest.raises(hemi.InvalidArgument, match="geometry"):
        solution.draw()


@pytest.mark.parametrize("arguments, error, words", [
    ({"reflectance": 1}, hemi.InvalidArgument, "1"),
    ({"reflectance": numpy.ones(3)}, hemi.InvalidArgument, r"reflectance of shape \[3\].*\[54\]"),
    ({"exitance": "much"}, TypeError, "exitance"),
    ({"exitance": -1}, hemi.InvalidArgument, "-1"),
    ({"method": "gauss"}, hemi.InvalidArgument, "gauss-seidel"),
    ({"tolerance": 0}, hemi.Error, "tolerance"),
])
def test_values_that_do_not_fit_are_refused(small_factors, arguments, error, words):
    with pytest.raises(error, match=words):
        small_factors.solve(**arguments)


def test_what_nothing_lights_is_warned_of(small_factors):
    with pytest.warns(hemi.HemiWarning, match="nothing radiates"):
        assert not small_factors.solve(exitance=0).radiosity.any()


def test_rows_that_reflect_must_be_there(small_box):
    factors = hemi.form_factors(small_box, "plain", device="osmesa", patches=[1])
    with pytest.raises(hemi.InputError, match="53 rows"):
        factors.solve()


def test_a_result_of_other_values_is_no_file_of_the_scene(small_factors, tmp_path):
    solution = small_factors.solve(exitance=2)
    for extension in ("hres", "vtp"):
        with pytest.raises(hemi.InvalidArgument, match="other values"):
            solution.save(tmp_path / f"s.{extension}")
    solution.save(tmp_path / "s.csv")
    assert len((tmp_path / "s.csv").read_text().splitlines()) == 55
    with pytest.raises(hemi.InvalidArgument, match="written as"):
        solution.save(tmp_path / "s.png")


def test_a_picture_is_the_programs(scenes, program, tmp_path):
    path = scenes / "cube.json"
    arguments = ("--patches-per-face", 16, "--preset", "plain", "--device", "osmesa")
    program("solve", path, *arguments, "-q", "--size", "80x60", "-o", tmp_path / "program.png")
    scene = hemi.read_scene(path, patches_per_face=16)
    solution = hemi.form_factors(scene, "plain", device="osmesa").solve()
    pixels = solution.draw(tmp_path / "module.png", size=(80, 60), device="osmesa")
    assert pixels.shape == (60, 80, 3) and pixels.dtype == numpy.uint8 and pixels.std() > 10
    assert (tmp_path / "module.png").read_bytes() == (tmp_path / "program.png").read_bytes()
    red = solution.draw(size=(80, 60), device="osmesa", show=["red"])
    assert numpy.array_equal(red[..., 0], red[..., 1])


def test_a_camera_can_be_given(small_factors):
    solution = small_factors.solve(reflectance=0.5, exitance=numpy.arange(54) / 10)
    one = solution.draw(size=(32, 32), eye=[0.5, 0.5, 0.5], target=[1, 0.5, 0.5], fov=90, device="osmesa")
    other = solution.draw(size=(32, 32), eye=[0.5, 0.5, 0.5], target=[0, 0.5, 0.5], fov=90, device="osmesa")
    assert not numpy.array_equal(one, other)
    with pytest.raises(hemi.InvalidArgument, match="together"):
        solution.draw(eye=[0, 0, 0])
    with pytest.raises(hemi.InvalidArgument, match='no channel "red"'):
        solution.draw(show=["red"])
    with pytest.raises(hemi.InvalidArgument, match="16384"):
        solution.draw(size=(0, 10))
