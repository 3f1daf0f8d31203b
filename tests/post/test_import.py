"""`voussoir import` and `examples`: drawings and geometry become decks that reach a verdict."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

pytest.importorskip("shapely")

import voussoir  # noqa: E402
from voussoir.command.main import main  # noqa: E402

GROUND = "POLYGON ((-1 -1, 4 -1, 4 0, -1 0, -1 -1))"


def horizontal(deck: Path, **keys) -> float:
    """The horizontal coefficient at which the blocks of a deck fall."""
    run = voussoir.run(deck, search="horizontal_coefficient", friction_deg=80, **keys)
    return float(run.cases["critical"][0])


def test_wkt_with_a_hole_turns_about_its_foot(tmp_path: Path, capsys) -> None:
    (tmp_path / "stone.wkt").write_text(
        f"fixed; {GROUND}\nPOLYGON ((0 0, 1 0, 1 2, 0 2, 0 0), (0.25 1, 0.75 1, 0.75 1.5, 0.25 1.5, "
        "0.25 1))\nLINESTRING (0 0, 1 1)\n"
    )
    deck = tmp_path / "stone.nml"
    words = ["import", str(tmp_path / "stone.wkt"), "--out", str(deck), "--fixed", "fixed", "rock"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "dropped: line 3: geometry 1, a LineString without area" in printed
    assert "2 blocks, 1 of them fixed" in printed
    height = (2.0 * 1.0 - 0.25 * 1.25) / 1.75
    assert horizontal(deck) == pytest.approx(0.5 / height, rel=1e-7)


def test_geojson_has_roles_and_a_scale(tmp_path: Path) -> None:
    def feature(role: str, x: float, y: float, width: float, height: float) -> dict:
        ring = [[x, y], [x + width, y], [x + width, y + height], [x, y + height], [x, y]]
        shape = {"type": "Polygon", "coordinates": [ring]}
        return {"type": "Feature", "properties": {"role": role}, "geometry": shape}

    features = [feature("Support", -1000, -500, 4000, 500), feature("stone", 0, 0, 1000, 3000)]
    file = tmp_path / "pier.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    deck = tmp_path / "pier.nml"
    assert main(["import", str(file), "--scale", "1e-3", "--out", str(deck)]) == 0
    assert horizontal(deck) == pytest.approx(1.0 / 3.0, rel=1e-7)
    assert voussoir.run(deck).blocks_of(1)[1].corners.max() == 3.0


def test_dxf_with_arcs_inserts_and_three_layers(tmp_path: Path, capsys) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    space = drawing.modelspace()
    base = [(-1, -0.5), (4, -0.5), (4, 0), (-1, 0)]
    space.add_lwpolyline(base, close=True, dxfattribs={"layer": "fixed"})
    brick = drawing.blocks.new("brick")
    brick.add_lwpolyline([(0, 0), (1, 0), (1, 0.5), (0, 0.5)], close=True)
    for x in (0, 2):
        space.add_blockref("brick", (x, 0), dxfattribs={"layer": "bricks"})
    # a half disc on the left brick: bulge 1 is a half circle
    space.add_lwpolyline([(0, 0.5, 0), (1, 0.5, 1)], format="xyb", close=True, dxfattribs={"layer": "dome"})
    space.add_line((0, 0), (1, 1), dxfattribs={"layer": "axes"})
    drawing.saveas(tmp_path / "yard.dxf")
    deck = tmp_path / "yard.nml"
    words = ["import", str(tmp_path / "yard.dxf"), "--out", str(deck), "--tolerance", "1e-4"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "dropped: LINE on layer axes: 1 piece encloses nothing" in printed
    assert "4 blocks, 1 of them fixed" in printed
    text = deck.with_suffix(".blocks").read_text()
    assert text.count("block") == 4 and text.count("material 2") == 2  # the dome, and its entry
    run = voussoir.run(deck, friction_deg=80)
    assert run.cases["verdict"].tolist() == ["stable"]
    dome = run.blocks_of(1)[3].corners
    x, y = dome.T
    area = abs((x * y.take(range(1, len(y) + 1), mode="wrap")
                - y * x.take(range(1, len(x) + 1), mode="wrap")).sum()) / 2.0
    assert area == pytest.approx(math.pi / 8.0, rel=1e-3)


def ring_of(space, layer: str, radii: tuple, count: int, as_lines: bool, scale: float = 1.0) -> None:
    """Draw a half ring of voussoirs: as polylines with arcs, or as single lines and arcs that they share."""
    inner, outer = (radius * scale for radius in radii)
    kind = {"layer": layer}

    def at(radius: float, turn: int) -> tuple[float, float]:
        angle = math.pi * turn / count
        return radius * math.cos(angle), radius * math.sin(angle)

    bulge = math.tan(math.pi / count / 4)
    if as_lines:
        for turn in range(count + 1):
            space.add_line(at(inner, turn), at(outer, turn), dxfattribs=kind)
        for radius in (inner, outer):  # one arc over all joints: it is cut where they end
            space.add_arc((0, 0), radius, 0, 180, dxfattribs=kind)
        return
    for turn in range(count):
        corners = [(at(inner, turn), 0), (at(outer, turn), bulge)]
        corners += [(at(outer, turn + 1), 0), (at(inner, turn + 1), -bulge)]
        space.add_lwpolyline([(*point, curve) for point, curve in corners], format="xyb", close=True, dxfattribs=kind)


def test_single_lines_and_arcs_enclose_the_voussoirs_of_polylines(tmp_path: Path, capsys) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    pushes = []
    for as_lines in (False, True):
        drawing = ezdxf.new()
        drawing.units = ezdxf.units.MM
        space = drawing.modelspace()
        ring_of(space, "ring", (4.5, 5.2), 15, as_lines, 1e3)
        ground = [(-7000, -1000), (7000, -1000), (7000, 0), (-7000, 0)]
        space.add_lwpolyline(ground, close=True, dxfattribs={"layer": "Ground"})
        drawing.saveas(tmp_path / f"ring_{as_lines}.dxf")
        deck = tmp_path / f"ring_{as_lines}.nml"
        assert main(["import", str(tmp_path / f"ring_{as_lines}.dxf"), "--out", str(deck)]) == 0
        printed = capsys.readouterr().out
        assert "16 blocks, 1 of them fixed; a unit is 0.001 m (the drawing)" in printed
        assert "dropped" not in printed
        pushes.append(horizontal(deck))
    assert 0.0 < pushes[0] < 1.0
    assert pushes[0] == pytest.approx(pushes[1], rel=1e-9)


@pytest.mark.parametrize("mirrored", [False, True])
def test_both_sides_of_a_curved_joint_have_the_same_chords(tmp_path: Path, mirrored: bool) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    space = drawing.modelspace()
    ring_of(space, "ring", (4.5, 5.2), 15, False)
    x, y = 5.2 * math.cos(math.radians(50)), 5.2 * math.sin(math.radians(50))  # between two joints of the ring
    corners = [(5.2, 0, math.tan(math.radians(50) / 4)), (x, y, 0), (x, 5.5, 0), (7, 5.5, 0), (7, 0, 0)]
    spandrel = drawing.blocks.new("spandrel")
    spandrel.add_lwpolyline(corners, format="xyb", close=True)
    space.add_blockref("spandrel", (0, 0), dxfattribs={"layer": "fill", "xscale": -1.0 if mirrored else 1.0})
    base = [(-7, -1), (7, -1), (7, 0), (-7, 0)]
    space.add_lwpolyline(base, close=True, dxfattribs={"layer": "ground"})
    drawing.saveas(tmp_path / "half.dxf")
    assert main(["import", str(tmp_path / "half.dxf"), "--out", str(tmp_path / "half.nml"), "--tolerance", "0.02"]) == 0
    run = voussoir.run(tmp_path / "half.nml", friction_deg=50)  # blocks that overlap would be refused
    assert run.cases["verdict"].tolist() == ["stable"]
    fill = next(block for block in run.blocks_of(1) if block.corners[:, 1].max() > 5.4)
    on_arc = [point for point in fill.corners if abs(math.hypot(*point) - 5.2) < 1e-9]
    angles = sorted(math.degrees(math.atan2(py, abs(px))) for px, py in on_arc)
    for joint in (12, 24, 36, 48):
        assert min(abs(angle - joint) for angle in angles) < 1e-9


def test_whole_circle_of_two_arcs_is_a_disc(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    from voussoir.deck.shapes import read_shapes

    for sign in (1, -1):
        drawing = ezdxf.new()
        drawing.modelspace().add_lwpolyline([(0, 0, sign), (2, 0, sign)], format="xyb", close=True)
        drawing.modelspace().add_circle((5, 0), 1.0)
        drawing.modelspace().add_arc((9, 0), 1.0, 30, 330)
        drawing.modelspace().add_line((9, 0), (9 + math.cos(math.pi / 6), 0.5))
        drawing.modelspace().add_line((9, 0), (9 + math.cos(math.pi / 6), -0.5))
        drawing.saveas(tmp_path / "disc.dxf")
        shapes, dropped, _ = read_shapes(tmp_path / "disc.dxf", None, 1e-5)
        assert not dropped
        areas = [shape.polygon.area for shape in shapes]
        assert areas == pytest.approx([math.pi, math.pi, math.pi * 300 / 360], rel=2e-5)


def test_import_runs_draws_and_says_what_is_missing(tmp_path: Path, capfd) -> None:
    file = tmp_path / "pier.wkt"
    file.write_text(f"{GROUND}\nPOLYGON ((0 0, 1 0, 1 3, 0 3, 0 0))\n")
    deck = tmp_path / "pier.nml"
    words = ["import", str(file), "--out", str(deck), "--run", "--search", "horizontal_coefficient"]
    assert main(words) == 2  # nothing holds it
    assert "no block is fixed" in capfd.readouterr().out
    assert main(["import", str(file), "--out", str(deck), "--hold", "3"]) == 2
    assert "expected numbers of blocks from 1 to 2 for --hold, got 3" in capfd.readouterr().err
    pytest.importorskip("matplotlib")
    assert main([*words, "--hold", "1"]) == 0
    printed = capfd.readouterr().out
    assert "a unit is 1 m (no unit is named" in printed
    assert "0.333333" in printed and "found" in printed
    assert (tmp_path / "pier" / "plots" / "case_1.png").is_file()


def test_assembly_of_compas_falls_where_it_must(tmp_path: Path) -> None:
    compas = pytest.importorskip("compas")
    assembly_of = pytest.importorskip("compas_assembly.datastructures")
    geometry = pytest.importorskip("compas.geometry")
    assembly = assembly_of.Assembly()
    for x, z, width, height, support in ((0.0, -0.5, 6.0, 1.0, True), (0.0, 1.5, 1.0, 3.0, False)):
        frame = geometry.Frame([x, 0.0, z], [1, 0, 0], [0, 1, 0])
        block = assembly_of.Block.from_shape(geometry.Box(width, 0.7, height, frame=frame))
        node = assembly.add_block(block)
        assembly.graph.node_attribute(node, "is_support", support)
    compas.json_dump(assembly, tmp_path / "pier.json")
    deck = tmp_path / "pier.nml"
    assert main(["import", str(tmp_path / "pier.json"), "--out", str(deck)]) == 0
    assert horizontal(deck) == pytest.approx(1.0 / 3.0, rel=1e-7)  # a pier of 1 x 3 m on its support
    polygon = geometry.Polygon([[0, 0, 0], [1, 0, 0], [1, 0, 2], [0, 0, 2]])  # z is up
    compas.json_dump([polygon], tmp_path / "stone.json")
    assert main(["import", str(tmp_path / "stone.json"), "--out", str(tmp_path / "stone.nml")]) == 0
    assert "0.0 2.0" in (tmp_path / "stone.blocks").read_text()


def test_meshes_are_blocks(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    meshio.write_points_cells(tmp_path / "mesh.vtk", points, [("quad", [[0, 1, 2, 3]])])
    deck = tmp_path / "mesh.nml"
    assert main(["import", str(tmp_path / "mesh.vtk"), "--out", str(deck)]) == 0
    assert deck.with_suffix(".blocks").read_text().count("block") == 1


@pytest.mark.parametrize(("ending", "package"), [
    ("geojson", "json"), ("wkt", "json"), ("dxf", "ezdxf"), ("vtu", "meshio"), ("vtk", "meshio"),
])
def test_what_is_exported_is_read_back_and_falls_as_before(tmp_path: Path, capsys, ending: str, package: str) -> None:
    pytest.importorskip(package)
    deck = {"arch": {"voussoirs": 9, "thickness": 0.6, "shape": "segmental", "span": 6, "rise": 2}}
    first = voussoir.run(deck, out=tmp_path / "arch", search="horizontal_coefficient", friction_deg=80)
    file = tmp_path / f"arch.{ending}"
    assert main(["export", str(tmp_path / "arch"), str(file), "--case", "1"]) == 0
    printed = capsys.readouterr().out
    assert "11 blocks, 2 of them fixed" in printed
    assert ("cannot hold layers" in printed) == (package == "meshio")
    again = tmp_path / "again.nml"
    assert main(["import", str(file), "--out", str(again)]) == 0
    blocks = [block.corners for block in first.blocks_of(1)]
    if package == "meshio":  # what is fixed is lost, and said
        assert "no block is fixed" in capsys.readouterr().out
        assert again.with_suffix(".blocks").read_text().count("block") == len(blocks)
        return
    assert horizontal(again) == pytest.approx(float(first.cases["critical"][0]), rel=1e-7)


def test_displaced_blocks_and_materials_are_exported(tmp_path: Path) -> None:
    (tmp_path / "two.blocks").write_text(
        "block fixed\n-1 -1\n2 -1\n2 0\n-1 0\nblock material 2\n0 0\n1 0\n1 2\n0 2\nmaterial 2 density 2500\n"
    )
    (tmp_path / "two.nml").write_text("&scene kind = 'blocks', geometry = 'two.blocks' /\n&search parameter = "
                                      "'horizontal_coefficient' /\n")
    run = voussoir.run(tmp_path / "two.nml", out=tmp_path / "two")
    file = tmp_path / "two.geojson"
    assert main(["export", str(tmp_path / "two"), str(file), "--magnify", "0.5"]) == 0
    ground, stone = json.loads(file.read_text())["features"]
    assert [part["properties"]["role"] for part in (ground, stone)] == ["fixed", "material 2"]
    block = run.blocks_of(1)[1]
    moved = block.corners + 0.5 * block.displacement
    ring = [number for corner in stone["geometry"]["coordinates"][0][:-1] for number in corner]
    assert ring == pytest.approx(moved.ravel().tolist(), abs=1e-12)


@pytest.mark.parametrize(("words", "message", "status"), [
    (["nowhere", "a.wkt"], "no results.csv", 2),
    (["two", "a.svg"], "expected a file of .dxf", 2),
    (["two", "a.wkt", "--case", "7"], "no blocks of case 7", 2),
    (["two", "two/results.csv/a.wkt"], "expected a file that can be written", 4),
])
def test_what_cannot_be_exported_is_reported(tmp_path: Path, capsys, monkeypatch, words, message, status) -> None:
    monkeypatch.chdir(tmp_path)
    voussoir.run("&arch voussoirs = 4 /", out=tmp_path / "two")
    assert main(["export", *words]) == status
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.svg", "", "expected a file of .dxf, .geojson"),
        ("a.wkt", "POLYGON ((0 0", "expected WKT in line 1"),
        ("a.geojson", "{", "expected JSON"),
        ("a.wkt", "POINT (0 0)\n", "expected closed outlines"),
    ],
)
def test_what_is_no_geometry_is_refused(tmp_path: Path, capsys, name, text, words) -> None:
    (tmp_path / name).write_text(text)
    assert main(["import", str(tmp_path / name), "--out", str(tmp_path / "a.nml")]) == 2
    assert words in capsys.readouterr().err


def test_examples_are_listed_and_copied(tmp_path: Path, capsys) -> None:
    assert main(["examples"]) == 0
    assert "input/paper/table1.nml" in capsys.readouterr().out.splitlines()
    assert main(["examples", "--copy", str(tmp_path)]) == 0
    assert (tmp_path / "input/paper/table1.nml").is_file()
