"""Drawings in all forms in which people write them: curves are cut at what ends on them, nothing is lost unsaid."""

from __future__ import annotations

import math
import os
from pathlib import Path

import pytest
from drawn_files import arc, bezier, block, box, drawing, ellipse, groups, insert, line, polyline

pytest.importorskip("shapely")

import voussoir  # noqa: E402
from voussoir.command.main import main  # noqa: E402

STONES = 13


def read(folder: Path, text: str, *words: str) -> tuple[int, Path]:
    """Import a drawing: the exit status, and the deck."""
    file = folder / "a.dxf"
    file.write_text(text)
    deck = folder / "a.nml"
    return main(["import", str(file), "--out", str(deck), *words]), deck


def rib(kind: str, x: float, inner: float, outer: float) -> tuple[list[list[str]], list[tuple]]:
    """Both curves of a rib and its joints: ends of each on the inner and on the outer curve."""
    angles = [math.pi * turn / STONES for turn in range(STONES + 1)]
    if kind == "ellipse":  # half axes r and 0.6 r
        curves = [ellipse("rib", radius, 0.6, 0.0, math.pi) for radius in (inner, outer)]
        return curves, [tuple((r * math.cos(a), 0.6 * r * math.sin(a)) for r in (inner, outer)) for a in angles]
    if kind == "spline":
        def at(radius: float, t: float) -> tuple[float, float]:
            weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3)
            rows = ((radius, 0.0), (radius, 1.2 * radius), (-radius, 1.2 * radius), (-radius, 0.0))
            return tuple(sum(w * row[axis] for w, row in zip(weights, rows)) for axis in (0, 1))

        curves = [bezier("rib", [(r, 0.0), (r, 1.2 * r), (-r, 1.2 * r), (-r, 0.0)]) for r in (inner, outer)]
        return curves, [tuple(at(r, a / math.pi) for r in (inner, outer)) for a in angles]
    ends = [tuple((r * math.cos(a), r * math.sin(a)) for r in (inner, outer)) for a in angles]
    if kind == "arc":
        return [arc("rib", (0, 0), radius, 0, 180) for radius in (inner, outer)], ends
    if kind == "bulge":  # an open polyline of one arc
        return [polyline("rib", [(r, 0.0), (-r, 0.0)], 0, [1.0, 0.0]) for r in (inner, outer)], ends
    chords = [polyline("rib", [pair[side] for pair in ends], 0) for side in (0, 1)]
    return chords, ends


def supports(inner: float, outer: float) -> list[list[str]]:
    """What the feet stand on."""
    width = outer - inner + 1.0
    return [polyline("fixed", box(x, -1.0, width, 1.0)) for x in (inner - 0.5, -outer - 0.5)]


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("kind", ["ellipse", "spline", "arc", "bulge", "chords"])
@pytest.mark.parametrize(("outer", "verdict"), [(5.1, "collapsed"), (7.0, "stable")])
def test_curves_are_cut_where_joints_end(tmp_path: Path, capsys, kind: str, outer: float, verdict: str) -> None:
    curves, joints = rib(kind, 0.0, 5.0, outer)
    status, deck = read(
        tmp_path, drawing(*supports(5.0, outer), *curves, *(line("rib", *ends) for ends in joints)))
    assert status == 0
    printed = capsys.readouterr().out
    assert f"{STONES + 2} blocks, 2 of them fixed" in printed and "dropped" not in printed
    assert voussoir.run(deck, friction_deg=50).cases["verdict"].tolist() == [verdict]


def test_closed_curves_are_cut_at_corners_of_others(tmp_path: Path) -> None:
    stone = box(-1.0, 3.0, 2.0, 1.0)
    corner = (2.0 * math.cos(1.0), 1.2 * math.sin(1.0))  # on the ellipse
    status, deck = read(tmp_path, drawing(
        ellipse("disc", 2.0, 0.6, 0.0, 2.0 * math.pi), polyline("fixed", [corner, (3.0, 1.0), (3.0, 2.5)]),
        polyline("fixed", stone)), "--tolerance", "0.05")
    assert status == 0
    rows = [tuple(map(float, row.split())) for row in deck.with_suffix(".blocks").read_text().splitlines()
            if row.startswith("  ")]
    assert sum(math.dist(row, corner) < 1e-12 for row in rows) == 2


def short_ring(gap: float) -> str:
    """A ring of arcs whose joints stop short of them."""
    joints = []
    for turn in range(STONES + 1):
        angle = math.pi * turn / STONES
        joints.append(line("ring", *[(r * math.cos(angle), r * math.sin(angle)) for r in (5.0 + gap, 5.8 - gap)]))
    return drawing(*supports(5.0, 5.8), arc("ring", (0, 0), 5.0, 0, 180), arc("ring", (0, 0), 5.8, 0, 180), *joints)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("gap", [0.0005, 0.004, 0.02])
def test_joints_that_end_short_are_refused_or_snapped(tmp_path: Path, capsys, gap: float) -> None:
    assert read(tmp_path, short_ring(gap))[0] == 2
    error = capsys.readouterr().err
    assert "short of another line" in error and "--snap" in error and error.count("\n") == 1
    assert read(tmp_path, short_ring(gap), "--snap", repr(0.9 * gap))[0] == 2
    capsys.readouterr()
    pushes = []
    for text, words in ((short_ring(0.0), []), (short_ring(gap), ["--snap", repr(gap)])):
        status, deck = read(tmp_path, text, *words)
        assert status == 0
        printed = capsys.readouterr().out
        assert f"{STONES + 2} blocks" in printed
        assert ("snapped: " in printed) == bool(words)
        run = voussoir.run(deck, search="horizontal_coefficient", friction_deg=60)
        pushes.append(float(run.cases["critical"][0]))
    assert pushes[1] == pytest.approx(pushes[0], rel=1e-3)


def test_outline_with_a_gap_is_refused_or_snapped(tmp_path: Path, capsys) -> None:
    open_box = polyline("stones", [(0.003, 0.0), *box(0.0, 0.0, 1.0, 2.0)[1:], (0.0, 0.0)], 0)
    text = drawing(polyline("fixed", box(-1.0, -1.0, 3.0, 1.0)), open_box)
    assert read(tmp_path, text)[0] == 2
    assert "short of another line" in capsys.readouterr().err
    assert read(tmp_path, text, "--snap", "0.0035")[0] == 0
    assert "2 blocks" in capsys.readouterr().out


def test_corners_that_nearly_meet_are_snapped(tmp_path: Path, capsys) -> None:
    stones = [box(0.0, 0.0, 1.0, 0.9998), box(1.0002, 0.0, 1.0, 1.0), box(0.0, 1.0, 2.0, 0.5)]
    text = drawing(polyline("fixed", box(-1.0, -1.0, 4.0, 1.0)), *(polyline("stones", stone) for stone in stones))
    status, deck = read(tmp_path, text, "--snap", "0.0003")
    assert status == 0
    assert "snapped: " in capsys.readouterr().out
    run = voussoir.run(deck, friction_deg=40)
    assert run.cases["verdict"].tolist() == ["stable"]
    corners = [tuple(point) for one in run.blocks_of(1) for point in one.corners.tolist()]
    assert len(set(corners)) == 12  # 4 of the base, 8 of the stones: each joint has one line


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(("entity", "words"), [
    (groups(0, "CIRCLE", 8, "a", 10, 5, 20, 5, 40, 0), "expected a radius of CIRCLE above 0, got 0"),
    (groups(0, "ARC", 8, "a", 10, 5, 20, 5, 40, -1, 50, 0, 51, 90), "expected a radius of ARC above 0"),
    (groups(0, "CIRCLE", 8, "a", 10, 5, 20, 5), "expected a group 40 of CIRCLE, got none"),
    (groups(0, "ELLIPSE", 8, "a", 10, 5, 20, 5, 11, 0, 21, 0, 40, 0.5), "half axes"),
    (groups(0, "LINE", 8, "a", 10, "x", 20, 5, 11, 0, 21, 0), "expected a number within 1e+12"),
    (groups(0, "SPLINE", 8, "a", 71, 3, 40, 0, 40, 1, 10, 0, 20, 0, 10, 1, 20, 1), "knots"),
    (groups(0, "SPLINE", 8, "a", 71, 3, 11, 0, 21, 0), "two points of SPLINE"),
    (groups(0, "CIRCLE", 8, "a", 10, 0, 20, 0, 40, "1e12"), "--tolerance"),
    (groups(0, "INSERT", 2, "b", 10, 0, 20, 0, 41, 0), "scales of an insert"),
    (groups("x", "LINE"), "expected a group code"),
])
def test_broken_entities_are_one_line(tmp_path: Path, capsys, entity: list[str], words: str) -> None:
    assert read(tmp_path, drawing(polyline("fixed", box(0, 0, 1, 1)), entity, blocks=block("b")))[0] == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1 and f"{tmp_path / 'a.dxf'}:1: error: " in error


def test_table_with_a_nameless_layer_is_refused(tmp_path: Path, capsys) -> None:
    table = "\n".join(groups(0, "SECTION", 2, "TABLES", 0, "TABLE", 2, "LAYER", 0, "LAYER", 70, 0, 0, "ENDTAB", 0,
                             "ENDSEC"))
    assert read(tmp_path, table + "\n" + drawing(polyline("fixed", box(0, 0, 1, 1))))[0] == 2
    assert "expected a layer with a name" in capsys.readouterr().err


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("text", ["", "0\nSECTION\n2\n", "0\nEOF\n", "hello\n", "AutoCAD Binary DXF\r\n\x1a\0\0"])
def test_what_is_no_drawing_is_one_line(tmp_path: Path, capsys, text: str) -> None:
    assert read(tmp_path, text)[0] == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "expected" in error


def test_old_forms_are_imported_and_repairs_are_said(tmp_path: Path, capsys) -> None:
    leaning = [(0.0, 0.0), (1.0, 0.0), (1.3, 2.0), (0.3, 2.0)]
    flagless = drawing(polyline("fixed", box(-1, -0.5, 3, 0.5), None), polyline("stones", leaning, None))
    heavy = []
    for layer, points in (("fixed", box(-1, -0.5, 3, 0.5)), ("stones", leaning)):
        heavy += groups(0, "POLYLINE", 8, layer, 66, 1, 70, 1)
        for x, y in points:
            heavy += groups(0, "VERTEX", 8, layer, 10, x, 20, y)
        heavy += groups(0, "SEQEND", 8, layer)
    texts = []
    for text in (flagless, drawing(heavy), drawing(polyline("fixed", box(-1, -0.5, 3, 0.5)),
                                                   polyline("stones", leaning))):
        status, deck = read(tmp_path, text)
        assert status == 0
        printed = capsys.readouterr().out
        assert "2 blocks, 1 of them fixed" in printed
        assert ("repaired: LWPOLYLINE on layer stones: closed by a line" in printed) == (text is flagless)
        texts.append(deck.with_suffix(".blocks").read_text())
    assert texts[0] == texts[1] == texts[2]


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(("unit", "words", "said"), [
    ("", [], "a unit is 1 m (no unit is named; --unit U names it)"), ("mm", [], "a unit is 0.001 m (the drawing)"),
    ("m", [], "a unit is 1 m (the drawing)"), ("", ["--unit", "cm"], "a unit is 0.01 m (given)"),
    ("mm", ["--scale", "2"], "a unit is 2 m (given)"),
])
def test_unit_is_said_by_whom_it_is_named(tmp_path: Path, capsys, unit: str, words: list[str], said: str) -> None:
    assert read(tmp_path, drawing(polyline("fixed", box(0, 0, 10, 10)), unit=unit), *words)[0] == 0
    assert said in capsys.readouterr().out


def test_dropped_pieces_are_not_judged_unless_allowed(tmp_path: Path, capfd) -> None:
    good = [polyline("fixed", box(-1, -1, 3, 1)), polyline("stones", box(0, 0, 1, 1))]
    remark = groups(0, "TEXT", 8, "notes", 10, 0, 20, 0, 40, 1, 1, "a pier")
    bow = polyline("stones", [(5, 0), (6, 1), (6, 0), (5, 2)])
    assert read(tmp_path, drawing(*good, bow, remark))[0] == 0
    printed = capfd.readouterr().out
    assert "dropped: LWPOLYLINE on layer stones: an outline that crosses itself" in printed
    assert "left out: TEXT on layer notes" in printed
    assert read(tmp_path, drawing(*good, bow), "--run")[0] == 2
    assert "got 1 dropped" in capfd.readouterr().err and not (tmp_path / "a").exists()
    pytest.importorskip("matplotlib")
    assert read(tmp_path, drawing(*good, bow), "--run", "--allow-dropped")[0] == 0
    assert "stable" in capfd.readouterr().out
    assert read(tmp_path, drawing(*good, remark), "--run")[0] == 0  # a remark is no piece
    capfd.readouterr()


def test_a_block_that_is_not_there_is_dropped_with_its_line(tmp_path: Path, capsys) -> None:
    text = drawing(polyline("fixed", box(0, 0, 1, 1)), insert("façade", "wall"), blocks=block("other"))
    line_of_insert = text.splitlines().index("INSERT")  # it begins with the code above
    assert read(tmp_path, text)[0] == 0
    assert f"dropped: INSERT on layer wall: no outline, at line {line_of_insert}\n" in capsys.readouterr().out


@pytest.mark.parametrize("state", [(62, -7), (70, 1)])
def test_hidden_layers_are_left_out_and_said(tmp_path: Path, capsys, state: tuple[int, int]) -> None:
    table = "\n".join(groups(0, "SECTION", 2, "TABLES", 0, "LAYER", 2, "Old", *state, 0, "ENDSEC"))
    text = table + "\n" + drawing(polyline("fixed", box(0, 0, 1, 1)), polyline("OLD", box(0, 1, 1, 1)))
    assert read(tmp_path, text)[0] == 0
    printed = capsys.readouterr().out
    assert "left out: hidden layer OLD" in printed and "1 blocks, 1 of them fixed" in printed


def test_depth_is_said_or_refused(tmp_path: Path, capsys) -> None:
    def stones(depths: tuple[float, float], axis: int) -> str:
        rows = []
        for depth, corners in zip(depths, (box(0, 0, 1, 1), box(2, 0, 1, 1))):
            points = [(*point[:axis], depth, *point[axis:]) for point in corners]
            rows += [line("fixed", *pair) for pair in zip(points, points[1:] + points[:1])]
        return drawing(*rows)

    assert read(tmp_path, stones((3.0, 3.0), 2))[0] == 0
    assert "left out: z = 3 of all points" in capsys.readouterr().out
    assert read(tmp_path, stones((3.0, 3.002), 2))[0] == 2
    assert "got z from 3 to 3.002" in capsys.readouterr().err
    assert read(tmp_path, stones((0.0, 0.0), 1))[0] == 2  # drawn in x and z
    assert "choose --plane xz" in capsys.readouterr().err
    assert read(tmp_path, stones((0.0, 0.0), 1), "--plane", "xz")[0] == 0
    assert "2 blocks" in capsys.readouterr().out


@pytest.mark.parametrize("text", [
    drawing(insert("b", columns=32000, rows=32000), blocks=block("b", polyline("0", box(0, 0, 1, 1)))),
    drawing(insert("b0"), blocks=[row for level in range(9) for row in block(
        f"b{level}", *[insert(f"b{level + 1}", x=float(step)) for step in range(9)])]
        + block("b9", polyline("0", box(0, 0, 1, 1)))),
    drawing(insert("b"), blocks=block("b", insert("b", x=1.0))),
    drawing(*(arc("a", (0, 0), 1e5 + i, 0, 180) for i in range(40))),
], ids=["array", "nested", "itself", "chords"])
def test_drawings_without_end_are_refused_at_once(tmp_path: Path, capsys, text: str) -> None:
    assert read(tmp_path, text)[0] == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "expected" in error and "within" not in error


def test_a_pipe_is_refused(tmp_path: Path, capsys) -> None:
    os.mkfifo(tmp_path / "pipe.dxf")
    assert main(["import", str(tmp_path / "pipe.dxf"), "--out", str(tmp_path / "a.nml")]) == 2
    assert "expected a file" in capsys.readouterr().err


def test_binary_drawings_are_read(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    from voussoir.deck.shapes import read_shapes

    made = ezdxf.new(units=4)
    space = made.modelspace()
    space.add_lwpolyline([(0, 0, 0), (2, 0, 0.5), (2, 2, 0)], format="xyb", close=True)
    space.add_ellipse((9, 0), (2, 1), 0.4)
    space.add_spline([(20, 0), (22, 1), (24, 0)])
    space.add_line((24, 0), (20, 0))
    made.saveas(tmp_path / "text.dxf")
    made.saveas(tmp_path / "binary.dxf", fmt="bin")
    first, second = (read_shapes(tmp_path / name, None, 1e-4) for name in ("text.dxf", "binary.dxf"))
    assert first[2] == second[2] == (1e-3, "the drawing") and len(first[0]) == 3
    for one, two in zip(first[0], second[0]):
        assert one.polygon.equals_exact(two.polygon, 1e-12)


@pytest.mark.usefixtures("in_this_process")
def test_options_go_together(tmp_path: Path, capsys) -> None:
    stones = [polyline("fixed", box(-1000, -500, 3000, 500)), polyline("stones", box(0, 0, 999.8, 1000)),
              polyline("stones", box(1000, 0, 1000, 1000)), line("axes", (0, 0), (1, 0))]
    (tmp_path / "a.dxf").write_text(drawing(*stones))
    words = ["import", str(tmp_path / "a.dxf"), "--out", str(tmp_path / "a.nml"), "--unit", "mm", "--snap", "0.0005",
             "--plane", "xy", "--allow-dropped"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "dropped: LINE on layer axes" in printed and "snapped: 2 points, by at most 0.0002 m" in printed
    assert "3 blocks, 1 of them fixed; a unit is 0.001 m (given)" in printed
