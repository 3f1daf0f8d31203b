"""The fields of a moving arch, read back with VTK itself, the reader of ParaView."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

pytest.importorskip("vtkmodules", reason="VTK is not installed: skipped")

from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader  # noqa: E402

import voussoir  # noqa: E402
from voussoir import results  # noqa: E402

DECK = """&arch voussoirs = 8, thickness_ratio = 0.09 /
&analysis geometry = 'current' /
&output frames = 4 /
"""


@pytest.fixture(scope="module")
def fall(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """An arch of eight blocks that falls."""
    return voussoir.run(DECK, out=tmp_path_factory.mktemp("fall"))


def grid_of(file: Path):
    """A file as VTK reads it."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def files_of(fall: results.Results) -> list[list[Path]]:
    """Files of each picture, blocks first, as the index names them."""
    index = fall.pvd(1)
    assert index
    sets = ElementTree.parse(index).getroot().findall("Collection/DataSet")
    times = sorted({float(item.attrib["timestep"]) for item in sets})
    return [
        [
            index.parent / item.attrib["file"]
            for item in sorted(sets, key=lambda item: item.attrib["part"])
            if float(item.attrib["timestep"]) == time
        ]
        for time in times
    ]


def test_blocks_and_displacements_are_those_of_the_table(fall: results.Results) -> None:
    pictures = fall.frames_of(1)
    files = files_of(fall)
    assert len(files) == len(pictures) > 2
    start = np.vstack(pictures[0].blocks)
    for (blocks, _), frame in zip(files, pictures):
        grid = grid_of(blocks)
        assert grid.GetNumberOfCells() == len(frame.blocks)
        corners = np.vstack(frame.blocks)
        assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData())[:, :2], corners)
        moved = vtk_to_numpy(grid.GetPointData().GetArray("displacement"))[:, :2]
        assert moved == pytest.approx(corners - start, abs=1e-12)
        for number, block in enumerate(frame.blocks):
            cell = grid.GetCell(number)
            assert cell.GetCellType() == 7 and cell.GetNumberOfPoints() == len(block)


def test_stress_and_rotation_are_those_of_a_falling_arch(fall: results.Results) -> None:
    (first, _), *_, (last, _) = files_of(fall)
    for file in (first, last):
        data = grid_of(file).GetCellData()
        assert {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())} == {"block", "rotation", "stress"}
    stress = vtk_to_numpy(grid_of(last).GetCellData().GetArray("stress"))
    assert np.all(np.isfinite(stress)) and stress[:8, :2].min() < -1e4  # compression is negative
    turn = vtk_to_numpy(grid_of(last).GetCellData().GetArray("rotation"))
    pictures = fall.frames_of(1)
    for number in range(8):
        before, after = (pictures[place].blocks[number] for place in (0, -1))
        angle = [np.arctan2(*(corner[1] - corner[0])[::-1]) for corner in (before, after)]
        assert turn[number] == pytest.approx(angle[1] - angle[0], abs=1e-3)
    assert np.abs(turn).max() > 0.05


def test_joint_forces_and_states_are_those_of_the_table(fall: results.Results) -> None:
    for (_, joints), frame in zip(files_of(fall), fall.frames_of(1)):
        grid = grid_of(joints)
        data = grid.GetPointData()
        assert grid.GetNumberOfPoints() == len(frame.joints) == 9
        force = vtk_to_numpy(data.GetArray("force"))[:, :2]
        names = [name for name in frame.joints.columns if name.startswith("force")]
        assert force == pytest.approx(np.column_stack([frame.joints[name] for name in names]))
        for ending in ("first", "second"):
            assert vtk_to_numpy(data.GetArray(f"state_{ending}")).dtype.kind == "i"


def test_blocks_in_time_carry_their_times_and_states(tmp_path: Path) -> None:
    """A block that slides down a slope: times of the index, displacement, contact states."""
    deck = Path(__file__).resolve().parents[2] / "input/benchmarks/incline_30.nml"
    run = voussoir.run(deck, out=tmp_path, **{"output%frames": 4, "output%vtu": True})
    pictures, files = run.frames_of(1), files_of(run)
    index = ElementTree.parse(run.pvd(1)).getroot().findall("Collection/DataSet")
    times = sorted({float(item.attrib["timestep"]) for item in index})
    assert times == [frame.time for frame in pictures]
    end = float(run.setting("analysis%duration"))
    assert times == pytest.approx([0.0, end / 4, end / 2, 3 * end / 4, end], abs=0.01)
    states = {"open": 0, "sliding": 1, "locked": 2}
    for (blocks, joints), frame in zip(files, pictures):
        moved = vtk_to_numpy(grid_of(blocks).GetPointData().GetArray("displacement"))[:, :2]
        corners = np.vstack(frame.blocks)
        assert moved == pytest.approx(corners - np.vstack(pictures[0].blocks), abs=1e-12)
        data = grid_of(joints).GetPointData()
        found = vtk_to_numpy(data.GetArray("state_first"))
        assert list(found) == [states[word] for word in frame.joints["state_1"]]
    assert 1 in found  # it slides
