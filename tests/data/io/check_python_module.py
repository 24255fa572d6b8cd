"""Checks tools/python/hemi_files.py on files that hemi wrote: FOLDER with a.hff a.npz a.csv patches.csv groups.json."""

import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
sys.path.insert(0, sys.argv[2])

import numpy

import hemi_files

file = hemi_files.read_hff(folder / "a.hff")
size = file.by_patch().shape[0]
parts = numpy.arange(size) if file.patch_of is None else file.patch_of
assert file.factors.shape == (len(parts), len(parts)) and (file.patch_of is None or len(parts) > size)
assert file.factors.dtype == numpy.float32 and file.known.all() and file.groups[0] == "floor"
sums = numpy.asarray(file.factors.astype(float).sum(axis=1)).ravel()
assert numpy.allclose(sums + file.environment + file.blocked, 1, atol=1e-6), "rows do not balance"
for name in ("a.npz", "a.csv", "a.mtx"):
    other = hemi_files.read_factors(folder / name)
    assert other.shape == (size, size) and abs(other - file.by_patch()).max() < 1e-7, name

patches = hemi_files.read_table(folder / "patches.csv")
assert list(patches["index"]) == list(range(size)) and numpy.allclose(patches["area"], numpy.bincount(parts, file.areas, size), rtol=1e-12)
assert [file.groups[g] for g in file.group_of] == [patches["group"][p] for p in parts]

groups = hemi_files.read_json(folder / "groups.json")
assert groups["schema"] == "hemi/factors-by-group/1" and groups["groups"] == file.groups
assert numpy.allclose(groups["factors"], file.by_group(), atol=1e-6)

damaged = bytearray((folder / "a.hff").read_bytes())
damaged[len(damaged) // 2] ^= 1
(folder / "bad.hff").write_bytes(damaged)
for name, text in (("bad.hff", "damaged"), ("patches.csv", "does not start")):
    try:
        hemi_files.read_hff(folder / name)
    except hemi_files.FileError as error:
        assert text in str(error), error
    else:
        raise AssertionError(f"{name} was read")
print("all equal")
