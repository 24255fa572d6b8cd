"""Reads a .vtp as the format's definition says and compares it with what the test wanted in it.

usage: compare_vtp.py FILE.vtp EXPECTED.json   (JSON: "groups", "arrays": name -> {"components", "values"})
"""
import json
import sys
import xml.etree.ElementTree as xml

import numpy

with open(sys.argv[1], "rb") as file:
    data = file.read()
with open(sys.argv[2]) as file:
    expected = json.load(file)

mark = b'<AppendedData encoding="raw">\n_'
start = data.index(mark) + len(mark)
end = b"\n</AppendedData>\n</VTKFile>\n"
assert data.endswith(end)
root = xml.fromstring(data[:start] + end)
assert root.attrib == {"type": "PolyData", "version": "1.0", "byte_order": "LittleEndian", "header_type": "UInt64"}
appended = data[start:-len(end)]
types = {"Int64": "<i8", "Float64": "<f8"}
used = 0


def read(element):
    """The numbers of an appended array; arrays must follow each other without a gap."""
    global used
    offset = int(element.get("offset"))
    assert offset == used, (element.get("Name"), offset, used)
    size = int(numpy.frombuffer(appended, "<u8", 1, offset)[0])
    used = offset + 8 + size
    values = numpy.frombuffer(appended, types[element.get("type")], size // 8, offset + 8)
    components = int(element.get("NumberOfComponents"))
    return values.reshape(-1, components) if components > 1 else values


names = root.find("PolyData/FieldData/DataArray")
assert names.get("type") == "String"
strings = bytes(int(code) for code in names.text.split()).split(b"\0")[:-1]
assert [string.decode() for string in strings] == expected["groups"]
assert int(names.get("NumberOfTuples")) == len(strings)

piece = root.find("PolyData/Piece")
polygons = int(piece.get("NumberOfPolys"))
cells = {}
for element in piece.find("CellData"):
    name = element.get("Name")
    cells[name] = read(element)
    assert len(cells[name]) == polygons, name
    if name in expected["arrays"]:
        array = expected["arrays"][name]
        assert [element.get(f"ComponentName{c}") for c in range(len(array["components"]))] == array["components"]
        assert cells[name].ravel().tolist() == array["values"], name
points = read(piece.find("Points/DataArray"))
connectivity, offsets = (read(element) for element in piece.find("Polys"))
assert used == len(appended)
assert set(expected["arrays"]) <= set(cells)
assert cells["patch"].tolist() == list(range(polygons))
assert len(points) == int(piece.get("NumberOfPoints")) == len(connectivity) == offsets[-1]
for cell in range(polygons):
    corners = points[connectivity[offsets[cell - 1] if cell else 0 : offsets[cell]]]
    assert 3 <= len(corners) <= 4
    crosses = numpy.cross(corners[1:-1] - corners[0], corners[2:] - corners[0])
    area = numpy.linalg.norm(crosses.sum(axis=0)) / 2
    assert abs(area - cells["area"][cell]) < 1e-12, cell
