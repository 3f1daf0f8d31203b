"""Files for ParaView, written by tests/unit/test_dda_write_*.pf, read by programs of other hands."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import pytest

from vtu_reader import read_vtu

FOLDER = Path(os.environ.get("VOUSSOIR_BUILD", ".."), "tests", "scratch")  #: Where the unit tests of output write
POLYGONS = FOLDER / "test_dda_write_vtu_polygons.vtu"
POINTS = FOLDER / "test_dda_write_vtu_points.vtu"
INDEX = FOLDER / "test_dda_write_pvd.pvd"
pytestmark = pytest.mark.skipif(
    not (POLYGONS.exists() and POINTS.exists() and INDEX.exists()),
    reason="unit_output, which writes the files, has not run in this build",
)
#: The triangle, square and pentagon of test_dda_write_vtu.pf.
CORNERS = [(0, 0), (1, 0), (0, 1), (2, 0), (3, 0), (3, 1), (2, 1), (4, 0), (6, 0), (6, 1), (5, 1.5), (4, 1)]
CELLS = [[0, 1, 2], [3, 4, 5, 6], [7, 8, 9, 10, 11]]
STRESS = [(-1.0e6, 2.0e5, 3.0), (-0.1, 0.2, 0.3), (0.0, -7.5, 1.0e-30)]
STATES = [-1, 0, 2147483647]


def spatial(corners: list[tuple[float, float]], factor: float = 1.0) -> list[tuple[float, ...]]:
    """Put plane points into space."""
    return [(x * factor, y * factor, 0.0) for x, y in corners]


def test_polygons_and_their_fields() -> None:
    grid = read_vtu(POLYGONS)
    assert grid.points == spatial(CORNERS)
    assert grid.cells == CELLS
    assert grid.types == [7, 7, 7]
    moved = grid.point_fields["displacement"].rows
    assert moved == [(x / 3.0, y / 3.0, 0.0) for x, y in CORNERS]
    assert grid.cell_fields["stress"].rows == STRESS
    assert grid.cell_fields["stress"].components == ["xx", "yy", "xy"]
    assert grid.cell_fields["state"].numbers == STATES
    assert grid.cell_fields["state"].type == "Int32"
    assert grid.cell_fields['p < "q" & r'].numbers == [row[0] for row in STRESS]


def test_points_and_their_forces() -> None:
    grid = read_vtu(POINTS)
    assert grid.points == spatial(CORNERS[:4])
    assert grid.cells == [[0], [1], [2], [3]]
    assert grid.types == [1, 1, 1, 1]
    assert grid.point_fields["force"].rows == spatial(CORNERS[4:8], 1.0e5)
    assert grid.cell_fields == {}


def test_index_names_its_files_and_times() -> None:
    root = ElementTree.parse(INDEX).getroot()
    assert (root.tag, root.get("type")) == ("VTKFile", "Collection")
    entries = [element.attrib for element in root.findall("Collection/DataSet")]
    assert entries == [{"timestep": "0", "part": "0", "file": "frame_0.vtu"},
                       {"timestep": "0.1", "part": "1", "file": "a&b.vtu"}]


def test_vtk_reads_the_same() -> None:
    """The library behind ParaView, where it is installed."""
    vtk = pytest.importorskip("vtk")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(POLYGONS))
    reader.Update()
    grid = reader.GetOutput()
    assert reader.GetErrorCode() == 0
    assert [grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())] == spatial(CORNERS)
    # VTK fills the same object at each call
    names, points = [], []
    for i in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(i)
        names.append(cell.GetClassName())
        points.append([cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())])
    assert names == ["vtkPolygon"] * 3
    assert points == CELLS
    stress = grid.GetCellData().GetArray("stress")
    assert [stress.GetTuple(i) for i in range(3)] == STRESS
    assert [stress.GetComponentName(i) for i in range(3)] == ["xx", "yy", "xy"]
    states = grid.GetCellData().GetArray("state")
    assert [states.GetValue(i) for i in range(3)] == STATES
    assert grid.GetPointData().GetArray("displacement").GetTuple(10) == (5 / 3, 0.5, 0.0)


def test_meshio_reads_the_same() -> None:
    """A reader that knows nothing of VTK's library, where it is installed.

    meshio 5.3.5 mixes up raw arrays if the offset of one happens to be that of another in base64:
    swap two fields of the file, and it may fail.
    """
    meshio = pytest.importorskip("meshio")
    mesh = meshio.read(POLYGONS)
    assert mesh.points.tolist() == [list(point) for point in spatial(CORNERS)]
    assert [block.data.tolist() for block in mesh.cells] == [[cell] for cell in CELLS]
    stress = [block.tolist() for block in mesh.cell_data["stress"]]
    assert stress == [[list(row)] for row in STRESS]
    forces = meshio.read(POINTS)
    assert forces.point_data["force"].tolist() == [list(v) for v in spatial(CORNERS[4:8], 1.0e5)]
