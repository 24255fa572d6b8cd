"""What the tests of the module share. Run by ctest, which names the build by the environment."""

import os
import pathlib
import subprocess

import numpy
import pytest

import hemi

SCENES = pathlib.Path(__file__).parents[2] / "scenes"
PROGRAM = os.environ["HEMI_PROGRAM"]


@pytest.fixture(scope="session")
def scenes():
    return SCENES


@pytest.fixture(scope="session")
def program():
    """Runs the program hemi, which must succeed."""

    def run(*arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def box(size=(1, 1, 1), **settings):
    """A closed box seen from inside, as arrays: six faces, in groups x0, x1, y0, y1, z0, z1."""
    x, y, z = size
    vertices = numpy.array([[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0], [0, 0, z], [x, 0, z], [x, y, z], [0, y, z]],
                           dtype=float)
    faces = numpy.array([[0, 3, 7, 4], [2, 1, 5, 6], [1, 0, 4, 5], [3, 2, 6, 7], [0, 1, 2, 3], [7, 6, 5, 4]])
    names = ["x0", "x1", "y0", "y1", "z0", "z1"]
    return hemi.Scene(vertices, faces, groups=names, **{"enclosure": "closed", **settings})


@pytest.fixture(scope="session")
def make_box():
    return box


@pytest.fixture(scope="session")
def small_box():
    return box(patches_per_face=9, reflectance=0.5, exitance=1.0)


@pytest.fixture(scope="session")
def small_factors(small_box):
    return hemi.form_factors(small_box, "fast", device="osmesa")
