"""Reads form factors as SciPy does, compares them with a plain text table, writes them again in SciPy's ways.

usage: compare_with_scipy.py FOLDER   (expects a.mtx, a.npz, a.npy, a.csv, expected.txt: "size", then "i j hex-float")
"""
import sys
import numpy
import scipy.io
import scipy.sparse

folder = sys.argv[1]
with open(f"{folder}/expected.txt") as table:
    size = int(next(table))
    entries = [line.split() for line in table]
expected = {(int(i), int(j)): float.fromhex(f) for i, j, f in entries}


def check(name, matrix):
    matrix = matrix.tocoo()
    found = {(int(i), int(j)): float(numpy.float32(f)) for i, j, f in zip(matrix.row, matrix.col, matrix.data)}
    assert matrix.shape == (size, size), (name, matrix.shape)
    assert found == expected, name


npz = scipy.sparse.load_npz(f"{folder}/a.npz")
assert npz.format == "csr" and npz.dtype == numpy.float32 and npz.has_canonical_format
check("npz", npz)
dense = numpy.load(f"{folder}/a.npy")
assert dense.dtype == numpy.float32 and dense.flags.c_contiguous
check("npy", scipy.sparse.coo_matrix(dense))
check("mtx", scipy.io.mmread(f"{folder}/a.mtx"))
i, j, f = numpy.loadtxt(f"{folder}/a.csv", delimiter=",", skiprows=1, unpack=True, ndmin=2)
check("csv", scipy.sparse.coo_matrix((f, (i.astype(int), j.astype(int))), shape=(size, size)))

scipy.sparse.save_npz(f"{folder}/compressed.npz", npz)
scipy.sparse.save_npz(f"{folder}/stored.npz", npz.astype(numpy.float64), compressed=False)
shuffled = npz.copy()
for row in range(size):
    part = slice(shuffled.indptr[row], shuffled.indptr[row + 1])
    shuffled.indices[part] = shuffled.indices[part][::-1].copy()
    shuffled.data[part] = shuffled.data[part][::-1].copy()
shuffled.has_sorted_indices = False
scipy.sparse.save_npz(f"{folder}/shuffled.npz", shuffled)
scipy.sparse.save_npz(f"{folder}/csc.npz", npz.tocsc())
scipy.io.mmwrite(f"{folder}/scipy.mtx", npz.tocsc(), precision=9)

triple = scipy.sparse.csr_matrix(numpy.array([[0.0, 0.5, 0.25], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]], dtype=numpy.float32))


def save_bad(name, **changes):
    parts = dict(indices=triple.indices, indptr=triple.indptr, format=b"csr", shape=numpy.array([3, 3]), data=triple.data)
    parts.update(changes)
    numpy.savez(f"{folder}/{name}.npz", **{key: value for key, value in parts.items() if value is not None})


save_bad("good")
save_bad("no_data", data=None)
save_bad("negative", data=numpy.array([0.5, -0.25, 0.5], dtype=numpy.float32))
save_bad("not_a_number", data=numpy.array([0.5, numpy.nan, 0.5]))
save_bad("integers", data=numpy.array([1, 2, 3]))
save_bad("big_endian", data=triple.data.astype(">f4"))
save_bad("column", indices=numpy.array([1, 3, 0], dtype=numpy.int32))
save_bad("negative_column", indices=numpy.array([1, -1, 0], dtype=numpy.int32))
save_bad("twice", indices=numpy.array([1, 1, 0], dtype=numpy.int32))
save_bad("short_rows", indptr=numpy.array([0, 2, 3], dtype=numpy.int32))
save_bad("falling_rows", indptr=numpy.array([0, 2, 1, 3], dtype=numpy.int32))
save_bad("too_many_rows", indptr=numpy.array([0, 2, 3, 9], dtype=numpy.int32))
save_bad("oblong", shape=numpy.array([3, 4]))
save_bad("huge", shape=numpy.array([2**40, 2**40]))
save_bad("two_dimensions", data=triple.data.reshape(1, 3))
save_bad("text_shape", shape=numpy.array(["a", "b"]))
