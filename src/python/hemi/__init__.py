"""Form factors by OpenGL hemicubes, and radiosity.

>>> import hemi
>>> scene = hemi.read_scene("scenes/cornell-box.json")
>>> F = hemi.form_factors(scene)          # F(i, j): share of what leaves patch i that arrives at patch j
>>> solution = F.solve()
>>> solution.radiosity                    # W/m², [patches, channels]
>>> solution.draw("cornell-box.png")

`Scene` takes vertices and faces from NumPy arrays instead. All that is raised is an `Error`.
"""

from hemi import _hemi
from hemi._hemi import *  # the names below
from hemi._hemi import __version__

__all__ = [
    "Cancelled", "Error", "FactorError", "FormFactors", "GlError", "HemiWarning", "InputError",
    "InvalidArgument", "IoError", "NoDevice", "NotConverged", "OutOfMemory", "ParseError", "Row", "Scene",
    "Solution", "devices", "form_factors", "load", "point_factors", "read_scene", "worker_program",
]

for _name in __all__:
    getattr(_hemi, _name).__module__ = "hemi"
del _name
