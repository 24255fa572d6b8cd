"""Opens a .vtp with VTK's own reader, as ParaView does, and compares it with what the test wanted in it.

usage: compare_vtp.py FILE.vtp EXPECTED.json   (JSON: "groups", "arrays": name -> {"components", "values"})
"""
import json
import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

with open(sys.argv[2]) as file:
    expected = json.load(file)

complaints = []
reader = vtkXMLPolyDataReader()
for kind in (vtkCommand.ErrorEvent, vtkCommand.WarningEvent):
    reader.AddObserver(kind, lambda *arguments: complaints.append(arguments[1]))
reader.SetFileName(sys.argv[1])
reader.Update()
assert reader.GetErrorCode() == 0 and not complaints, complaints
mesh = reader.GetOutput()

groups = mesh.GetFieldData().GetAbstractArray("groups")
assert [groups.GetValue(k) for k in range(groups.GetNumberOfValues())] == expected["groups"]

cells = mesh.GetCellData()
for name, wanted in expected["arrays"].items():
    array = cells.GetArray(name)
    components = [array.GetComponentName(c) for c in range(array.GetNumberOfComponents())]
    assert components == (wanted["components"] or [None]), name
    values = [None if value != value else value for value in vtk_to_numpy(array).ravel().tolist()]
    assert values == wanted["values"], name
count = mesh.GetNumberOfCells()
assert count == mesh.GetNumberOfPolys()
assert vtk_to_numpy(cells.GetArray("patch")).tolist() == list(range(count))
assert all(3 <= mesh.GetCell(cell).GetNumberOfPoints() <= 4 for cell in range(count))

sizes = vtkCellSizeFilter()
sizes.SetInputData(mesh)
sizes.Update()
measured = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Area"))
assert abs(measured - vtk_to_numpy(cells.GetArray("area"))).max() < 1e-12
