"""Reads an .h5 with h5py and SciPy and compares it with what the test wanted in it.

usage: compare_h5.py FILE.h5 EXPECTED.json
(JSON: "attributes": name -> value; "entries": [[i, j, F] ...]; "size"; "patches": name -> values; "groups")
"""
import json
import sys

import h5py
import numpy
import scipy.sparse

with open(sys.argv[2]) as file:
    expected = json.load(file)

units = {"area": "scene unit^2", "row_sum": "1", "environment": "1", "blocked": "1", "row_error": "1"}
with h5py.File(sys.argv[1], "r") as h5:
    attributes = dict(h5.attrs)
    assert "environment(i)" in attributes.pop("meaning")
    assert attributes.pop("program").startswith("hemi ")
    assert {name: value if isinstance(value, str) else int(value) for name, value in attributes.items()} == expected[
        "attributes"
    ], attributes
    rows = h5["factors"]
    assert rows.attrs["format"] == "csr"
    assert rows.attrs["shape"].tolist() == [expected["size"]] * 2
    types = {"data": "<f4", "indices": "<u4", "indptr": "<i8"}
    for name, dataset in rows.items():
        assert dataset.dtype == types[name], (name, dataset.dtype)
        assert dataset.compression == "gzip" and dataset.shuffle, name
        assert dataset.chunks == (min(len(dataset), 65536),), (name, dataset.chunks)
    matrix = scipy.sparse.csr_matrix((rows["data"][:], rows["indices"][:], rows["indptr"][:]), rows.attrs["shape"])
    matrix.check_format(full_check=True)
    entries = matrix.tocoo()
    found = [[int(i), int(j), float(f)] for i, j, f in zip(entries.row, entries.col, entries.data)]
    assert found == expected["entries"]
    if "patches" not in expected:
        assert sorted(h5) == ["factors"], sorted(h5)
        sys.exit()
    assert sorted(h5) == ["factors", "groups", "patches"], sorted(h5)
    assert [name.decode() for name in h5["groups/name"][:]] == expected["groups"]
    assert sorted(h5["patches"]) == sorted(expected["patches"])
    for name, values in expected["patches"].items():
        assert h5["patches"][name][:].tolist() == values, name
        assert h5["patches"][name].attrs.get("units") == units.get(name), name
