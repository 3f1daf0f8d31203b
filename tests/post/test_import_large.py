"""Large drawings: what is near is found as by looking at every pair; roles and materials of models are kept."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from drawn_files import box, drawing, feature, geojson, line

pytest.importorskip("shapely")

import voussoir  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.imports.curves import Arc, Line, Points, nearest, on_curve  # noqa: E402
from voussoir.imports.snapping import Cells, points_on_edges  # noqa: E402


@pytest.mark.parametrize(("seed", "reach"), [(1, 0.02), (2, 0.3), (3, 1e-6)])
def test_points_on_edges_are_those_of_every_pair(seed: int, reach: float) -> None:
    """Edges of all lengths, points on them, beside them, and on their ends."""
    random = np.random.default_rng(seed)
    starts = random.uniform(0, 10, 60) + 1j * random.uniform(0, 4, 60)
    ends = starts + random.choice([0.1, 1.0, 8.0], 60) * np.exp(1j * random.uniform(0, 7, 60))
    shares = random.uniform(0, 1, 60)
    points = np.concatenate((
        starts, ends, starts + shares * (ends - starts), starts + shares * (ends - starts) + 0.7j * reach,
        random.uniform(-1, 11, 300) + 1j * random.uniform(-1, 5, 300)))
    points = np.unique(points)
    known = Points(points)
    expected = set()
    for number, (start, end) in enumerate(zip(starts.tolist(), ends.tolist())):
        share, off = nearest(Line(start, end), points, reach)
        far = (abs(points - start) > reach) & (abs(points - end) > reach) & (off <= reach)
        expected |= {(number, point) for point in points[far].tolist()}
        for _, point in on_curve(Line(start, end), known, reach, reach):
            assert (number, point) in expected
    found = points_on_edges(starts, ends, points, reach)
    assert {(edge, complex(points[point])) for edge, _, point in found} == expected
    assert found == sorted(found) and len(found) >= 60


def test_points_in_one_column_are_found() -> None:
    points = 1j * np.arange(200.0)
    found = points_on_edges(np.array([-1 + 5j, 0j]), np.array([1 + 5j, 0 + 10j]), points, 0.1)
    assert [(edge, point) for edge, _, point in found] == [(0, 5), *((1, point) for point in range(1, 10))]


def test_cells_have_every_curve_near_a_point() -> None:
    random = np.random.default_rng(5)
    curves = [Line(complex(*random.uniform(0, 10, 2)), complex(*random.uniform(0, 10, 2))) for _ in range(80)]
    curves += [
        Arc(c + r, c - r, c, complex(r), complex(0, r), (0.0, math.pi))
        for c, r in ((complex(*random.uniform(0, 10, 2)), random.uniform(0.1, 4)) for _ in range(40))]
    cells = Cells(curves, 0.2, 0.01)
    for point in random.uniform(0, 10, (200, 2)) @ np.array([1, 1j]):
        near = {n for n, curve in enumerate(curves) if nearest(curve, np.array([point]), 0.01)[1][0] <= 0.2}
        assert near <= set(cells.near(complex(point)))
        assert cells.near(complex(point)) == sorted(cells.near(complex(point)))


def test_a_far_part_of_a_drawing_leaves_cells_small() -> None:
    near = [Line(complex(i, 0.0), complex(i + 0.5, 0.0)) for i in range(200)]
    cells = Cells([*near, Line(1e6 + 1e6j, 1e6 + 1.0 + 1e6j)], 0.01, 0.01)
    assert max(len(cells.near(line.start)) for line in near) <= 2


def wall(columns: int, rows: int, gap: float) -> str:
    """A wall of single lines; joints end short of their beds."""
    places = [(0.5 * i, 0.5 * j) for j in range(rows + 1) for i in range(2 * columns)]
    lines = [line("w", (x, y), (x + 0.5, y)) for x, y in places]
    for j in range(rows):
        inner = [i + 0.5 * (j % 2) for i in range(columns)]
        for x in sorted({0.0, float(columns), *inner}):
            lines.append(line("w", (x, 0.5 * j + gap), (x, 0.5 * j + 0.5 - gap)))
    return drawing(*lines, unit="m")


def test_thousands_of_lines_are_imported_within_the_limit_of_time(tmp_path: Path, capsys) -> None:
    """6100 lines whose joints stop short: looking at every pair took longer than an import may."""
    (tmp_path / "wall.dxf").write_text(wall(45, 44, 0.01))
    assert main(["import", str(tmp_path / "wall.dxf"), "--snap", "0.02", "--out", str(tmp_path / "wall.nml")]) == 0
    printed = capsys.readouterr().out
    assert f"{45 * 22 + 46 * 22} blocks" in printed
    assert "snapped: " in printed and "by at most 0.01 m" in printed
    areas = []
    blocks = (tmp_path / "wall.blocks").read_text().split("block")[1:]
    for text in blocks:
        x, y = np.array([[float(word) for word in row.split()] for row in text.strip().splitlines()]).T
        areas.append(0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    assert sum(areas) == pytest.approx(45 * 22.0, rel=1e-9)


GROUND = feature(box(-1, -1, 4, 1))


def test_fixed_is_a_property(tmp_path: Path, capsys) -> None:
    ground = feature(box(-1, -1, 4, 1), "rock")
    ground["properties"]["fixed"] = True
    stone = feature(box(0, 0, 1, 2), "stone")
    stone["properties"]["fixed"] = False
    deck = tmp_path / "a.nml"
    assert main(["import", str(geojson(tmp_path / "a.json", [ground, stone])), "--out", str(deck)]) == 0
    printed = capsys.readouterr().out
    assert "2 blocks, 1 of them fixed" in printed and "fixed: 1 of property fixed" in printed
    run = voussoir.run(deck, search="horizontal_coefficient", friction_deg=80)
    assert run.cases["critical"][0] == pytest.approx(0.5, rel=1e-7)


def test_equal_materials_are_merged_and_weigh_what_they_say(tmp_path: Path, capsys) -> None:
    """Two stones of one density and one of another: the reaction of the ground is their weight."""
    features = [feature(box(-1, -1, 4, 1), "ground")]
    for number, (role, density) in enumerate((("left", 2000), ("middle", 2500), ("right", 2000))):
        one = feature(box(number, 0, 0.9, 1), role)
        one["properties"]["density"] = density
        features.append(one)
    deck = tmp_path / "a.nml"
    assert main(["import", str(geojson(tmp_path / "a.json", features)), "--out", str(deck)]) == 0
    printed = capsys.readouterr().out
    assert "materials: 1 left (density 2000), 2 middle (density 2500)" in printed
    assert "merged: 2 layers of equal material into material 1" in printed
    joints = voussoir.run(deck).joints_of(1)
    below = (joints["block_1"] == 1) | (joints["block_2"] == 1)
    assert sorted(joints["normal_force"][below]) == pytest.approx(
        [0.9 * 9.81 * 2000, 0.9 * 9.81 * 2000, 0.9 * 9.81 * 2500], rel=1e-6)


def test_names_alone_make_no_materials(tmp_path: Path) -> None:
    features = [feature(box(-1, -1, 4, 1), "ground")]
    for number, name in enumerate(("France", "Spain", "Italy")):
        one = feature(box(number, 0, 1, 1))
        one["properties"] = {"name": name}
        features.append(one)
    assert main(["import", str(geojson(tmp_path / "a.json", features)), "--out", str(tmp_path / "a.nml")]) == 0
    assert "material" not in (tmp_path / "a.blocks").read_text()


def test_properties_that_are_no_numbers_are_refused(tmp_path: Path, capsys) -> None:
    one = feature(box(0, 0, 1, 1), "stone")
    one["properties"]["density"] = "heavy"
    assert main(["import", str(geojson(tmp_path / "a.json", [GROUND, one])), "--out", str(tmp_path / "a.nml")]) == 2
    assert "feature 2: expected density as a number above 0, got 'heavy'" in capsys.readouterr().err


MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 7 "rim"
2 1 "ground"
2 2 "stone"
$EndPhysicalNames
$Nodes
8
1 -1 -1 0
2 2 -1 0
3 2 0 0
4 -1 0 0
5 0 0 0
6 1 0 0
7 1 2 0
8 0 2 0
$EndNodes
$Elements
3
1 1 2 7 1 1 2
2 3 2 1 1 1 2 3 4
3 3 2 2 2 5 6 7 8
$EndElements
"""


def test_physical_groups_of_gmsh_are_roles(tmp_path: Path, capsys) -> None:
    pytest.importorskip("meshio")
    (tmp_path / "stone.msh").write_text(MSH)
    deck = tmp_path / "stone.nml"
    assert main(["import", str(tmp_path / "stone.msh"), "--out", str(deck)]) == 0
    printed = capsys.readouterr().out
    assert "2 blocks, 1 of them fixed" in printed and "fixed: 1 of layer ground" in printed
    assert "warning: each of the 2 elements is one block" in printed
    run = voussoir.run(deck, search="horizontal_coefficient", friction_deg=80)
    assert run.cases["critical"][0] == pytest.approx(0.5, rel=1e-7)


def test_thousands_of_lines_of_a_map_are_written_at_once(tmp_path: Path, capsys) -> None:
    random = np.random.default_rng(7)
    features = [feature([[float(x), float(y)] for x, y in random.uniform(0, 100, (2, 2))], f"set {n % 3}", "LineString")
                for n in range(4000)]
    words = ["import", str(geojson(tmp_path / "a.json", features)), "--out", str(tmp_path / "a.nml"), "--unit", "m"]
    assert main(words) == 0
    assert "4000 lines, 0 of the boundary" in capsys.readouterr().out
