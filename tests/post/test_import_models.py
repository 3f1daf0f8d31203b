"""GeoJSON, WKT, models of COMPAS and meshes: what they say is read, all else is refused in one line."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from drawn_files import assembly, box, drawing, feature, geojson, mesh, polyline

pytest.importorskip("shapely")

import voussoir  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.dda_program import find_dda  # noqa: E402

GROUND = feature(box(-1, -1, 5, 1), "fixed")


def read(file: Path, *words: str) -> tuple[int, Path]:
    """Import a file: the exit status, and the deck."""
    deck = file.parent / "out.nml"
    return main(["import", str(file), "--out", str(deck), *words]), deck


@pytest.mark.parametrize(("name", "text", "words"), [
    ("a.json", "null", "got a JSON null"),
    ("a.json", '"word"', "got a JSON string"),
    ("a.json", "[]", "got a JSON array"),
    ("a.json", '{"blocks": {}}', "got a JSON object"),
    ("a.json", '{"type": "Topology", "objects": {}, "arcs": []}', "convert TopoJSON to GeoJSON"),
    ("a.geojson", '{"type": "FeatureCollection", "features": 7}', "expected a list of features"),
    ("a.geojson", '{"type": "FeatureCollection", "features": [3]}', "feature 1: expected an object"),
    ("a.geojson", '{"type": "Polygon", "coordinates": [[[0, 0], [1, 0]]]}', "at least 4 positions, got 2"),
    ("a.geojson", '{"type": "Polygon", "coordinates": [[[0, 0], [1, "x"], [1, 1], [0, 0]]]}', "two or three numbers"),
    ("a.geojson", '{"type": "Polygon", "coordinates": [[[0, 0], [1, NaN], [1, 1], [0, 0]]]}', "two or three numbers"),
    ("a.geojson", '{"type": "Polygon", "coordinates": 4}', "lists of coordinates"),
    ("a.geojson", '{"type": "Feature", "geometry": {"type": "Circle"}}', "expected a geometry of GeoJSON"),
    ("a.geojson", "[" * 100000, "nested too deeply"),
    ("a.geojson", '{"type": "Point", "coordinates": [1' + "0" * 5000 + ", 0]}", "thousands of digits"),
    ("a.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 1e99, 0 0))", "line 1: Polygon: expected positions of two or three"),
    ("a.wkt", "POLYGON ((0 0, 1 0))", "expected WKT in line 1"),
    ("a.json", '{"dtype": "compas_assembly.datastructures/Assembly", "data": {}}', "meshes or polygons of COMPAS"),
    ("a.json", '[{"dtype": "x/Mesh", "data": {"vertex": {"0": {"x": 0}}, "face": {"0": [0, 1, 2]}}}]', "x, y and z"),
    ("gmsh.geo", "Point(1) = {0, 0, 0};\n", "a geometry of gmsh is imported as its mesh, FILE.msh"),
    ("missing.msh", None, "expected a file that can be read, got: No such file"),
])
def test_foreign_and_broken_files_are_one_line(tmp_path: Path, capsys, name: str, text: str | None, words: str) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    assert read(tmp_path / name)[0] == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1 and f"{name}:1: error: " in error


def test_text_in_another_code_is_named_with_its_line(tmp_path: Path, capsys) -> None:
    (tmp_path / "a.geojson").write_bytes('{"type": "Feature",\n"properties": {"name": "Stütze"}}'.encode("latin-1"))
    assert read(tmp_path / "a.geojson")[0] == 2
    assert ":2: error: expected text in UTF-8, got the byte 0xFC" in capsys.readouterr().err


@pytest.mark.parametrize("ending", ["msh", "vtk", "vtu"])
@pytest.mark.parametrize("text", [
    "", "hello\n", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n"
    "1\n1 2 2 0 1 1 2 9\n$EndElements\n", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS "
    "100000000000 double\n0 0 0\n", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n100000000000\n1 0 0 0\n$EndNodes\n"])
def test_broken_meshes_are_one_line(tmp_path: Path, capsys, ending: str, text: str) -> None:
    pytest.importorskip("meshio")
    (tmp_path / f"a.{ending}").write_text(text)
    assert read(tmp_path / f"a.{ending}")[0] == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_meshes_in_another_plane_are_refused_with_its_name(tmp_path: Path, capsys) -> None:
    meshio = pytest.importorskip("meshio")
    points = [(x, 5.0, z) for x, z in [*box(-1, -1, 3, 1), *box(0, 0, 1, 2)]]
    cells = [("quad", [[0, 1, 2, 3], [4, 5, 6, 7]]), ("line", [[0, 1]])]
    meshio.write_points_cells(tmp_path / "a.vtk", points, cells)
    assert read(tmp_path / "a.vtk")[0] == 2
    assert "choose --plane xz" in capsys.readouterr().err
    assert read(tmp_path / "a.vtk", "--plane", "xz", "--hold", "1")[0] == 0
    printed = capsys.readouterr().out
    assert "left out: y = 5 of all points" in printed and "left out: 1 cells 'line'" in printed
    assert "2 blocks" in printed and "dropped" not in printed


def test_spikes_and_closed_lines_are_repaired_and_said(tmp_path: Path, capsys) -> None:
    spike = [(1, 0), (2, 0), (2, 1), (1.4, 1), (1.4, 1.9), (1.4, 1), (1, 1)]
    ring = feature([*box(2.2, 0, 1, 1), (2.2, 0)], kind="LineString")
    status, deck = read(geojson(tmp_path / "a.geojson", [GROUND, feature(spike), ring]))
    assert status == 0
    printed = capsys.readouterr().out
    assert "repaired: feature 2: a part of the outline that encloses no area is cut off" in printed
    assert "repaired: feature 3: a closed line is taken as an outline" in printed
    assert "3 blocks" in printed and "dropped" not in printed
    assert "1.9" not in deck.with_suffix(".blocks").read_text()


def test_open_lines_among_outlines_are_not_judged(tmp_path: Path, capsys) -> None:
    line = feature([(0, 0), (1, 1)], kind="LineString")
    file = geojson(tmp_path / "a.geojson", [GROUND, feature(box(0, 0, 1, 1)), line])
    assert read(file, "--run")[0] == 2
    done = capsys.readouterr()
    assert "dropped: feature 3" in done.out and "--allow-dropped" in done.err and done.err.count("\n") == 1


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(("low", "size", "is_refused"), [
    ((11.25, 43.77), 1e-5, True), ((-3.5, 40.4), 0.02, True), ((150.0, -33.0), 1.0, True), ((0.0, 0.0), 0.08, True),
    ((0.0, 0.0), 0.2, False), ((11.25, 43.77), 5.0, False), ((150.0, -33.0), 4.0, False), ((4e5, 4.8e6), 0.09, False),
])
def test_longitude_and_latitude_are_refused(tmp_path: Path, capsys, low, size: float, is_refused: bool) -> None:
    ground, stone = box(low[0], low[1] - size / 4, size, size / 4), box(*low, size / 4, size / 4)
    texts = {"a.wkt": "".join("POLYGON ((" + ", ".join(f"{x!r} {y!r}" for x, y in [*ring, ring[0]]) + "))\n"
                              for ring in (ground, stone))}
    geojson(tmp_path / "a.geojson", [feature(ground, "fixed"), feature(stone)])
    (tmp_path / "a.wkt").write_text(texts["a.wkt"])
    for name in ("a.geojson", "a.wkt"):
        assert read(tmp_path / name)[0] == (2 if is_refused else 0)
        assert ("longitude and latitude" in capsys.readouterr().err) == is_refused
    if is_refused:
        assert read(tmp_path / "a.wkt", "--unit", "m")[0] == 0


def test_a_named_geographic_system_is_refused(tmp_path: Path, capsys) -> None:
    named = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
    file = geojson(tmp_path / "a.geojson", [GROUND, feature(box(0, 0, 1, 1))], crs=named)
    assert read(file, "--unit", "m")[0] == 2
    (tmp_path / "a.wkt").write_text("SRID=4326;POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))\n")
    assert read(tmp_path / "a.wkt")[0] == 2
    assert capsys.readouterr().err.count("longitude and latitude") == 2


@pytest.mark.parametrize("ending", ["geojson", "wkt"])
def test_lines_become_a_file_for_dda_cut(tmp_path: Path, capsys, ending: str) -> None:
    rim = [(0, 0), (4, 0), (4, 3), (0, 3), (0, 0)]
    lines = [(rim, "boundary"), ([(2, -0.5), (2, 3.5)], "J1"), ([(-1, 1), (2, 1.5), (5, 1)], "J2")]
    file = tmp_path / f"a.{ending}"
    if ending == "geojson":
        geojson(file, [feature(points, role, "LineString") for points, role in lines])
    else:
        file.write_text("".join(f"{role}; LINESTRING (" + ", ".join(f"{x} {y}" for x, y in points) + ")\n"
                                for points, role in lines))
    status, deck = read(file, "--scale", "0.5")
    assert status == 0
    printed = capsys.readouterr().out
    assert "7 lines, 4 of the boundary; a unit is 0.5 m (given); joint materials: 1 boundary, 2 J1, 3 J2" in printed
    assert not deck.exists()
    done = subprocess.run([str(find_dda()), "cut", str(deck.with_suffix(".geo"))], capture_output=True, text=True)
    assert done.returncode == 0 and "7 lines, 4 blocks" in done.stdout and "area        3 in all" in done.stdout
    assert read(file, "--run")[0] == 2
    assert "dda cut" in capsys.readouterr().err


def stack(path: Path, step: tuple[float, float], turn: float = 0.0, wider: float = 1.0) -> Path:
    """Five cubes, each so far beside the one below, on a support that is wider by so much on each side."""
    parts = [(mesh((-0.5 - wider, -0.5 - wider, -0.5), (0.5 + wider, 0.5 + wider, 0.0), turn), True)]
    for number in range(5):
        x, y = number * step[0], number * step[1]
        parts.append((mesh((x - 0.5, y - 0.5, number), (x + 0.5, y + 0.5, number + 1.0), turn), False))
    return assembly(path, parts)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("turn", [0.0, 30.0, -117.0])
@pytest.mark.parametrize(("step", "verdict"), [((0.15, 0.0), "stable"), ((0.0, 0.15), "stable"),
                                               ((0.27, 0.0), "collapsed"), ((0.0, 0.27), "collapsed")])
def test_leaning_stacks_collapse_in_every_direction(tmp_path: Path, step, turn: float, verdict: str) -> None:
    status, deck = read(stack(tmp_path / "a.json", step, turn))
    assert status == 0
    # the mean of the upper four centres over the edge of the lowest: 2.5 steps = 0.5 at a step of 0.2
    assert voussoir.run(deck, friction_deg=50).cases["verdict"].tolist() == [verdict]


def test_support_that_ends_below_a_block_gives_the_direction(tmp_path: Path) -> None:
    parts = [(mesh((-1.5, -0.5, -0.5), (1.5, 0.5, 0)), True), (mesh((-0.5, 0.3, 0), (0.5, 1.3, 0.5)), False)]
    status, deck = read(assembly(tmp_path / "a.json", parts))
    assert status == 0
    assert voussoir.run(deck).cases["verdict"].tolist() == ["collapsed"]


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(("parts", "words"), [
    ([(mesh((0, 0, 0), (1, 1, 1)), True), (mesh((0, 0.2, 1), (1, 1.3, 2)), False),
      (mesh((0.1, 0, 2), (1.2, 1, 3)), False)], "ends that differ by 0.2 along x"),
    ([(mesh((-2, -2, -1), (2, 2, 0)), True), (mesh((-0.5, -0.5, 0), (0.5, 0.5, 2)), False)], "choose --plane xz or"),
    ([(mesh((-2, -0.2, -1), (2, 0.2, 0)), True), (mesh((-0.5, -0.5, 0), (0.5, 0.5, 2)), False),
      (mesh((-0.3, -0.5, 2), (0.9, 0.5, 3)), False)], "supports that reach as far"),
])
def test_models_without_one_plane_are_refused(tmp_path: Path, capsys, parts: list, words: str) -> None:
    file = assembly(tmp_path / "a.json", parts)
    assert read(file)[0] == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1
    status = read(file, "--plane", "xz")[0]
    assert status == (0 if "choose" in words else 2)


def test_tapered_blocks_are_no_plane_model(tmp_path: Path, capsys) -> None:
    stone = mesh((0, 0, 0), (1, 1, 1))
    stone["data"]["vertex"]["7"]["x"] = 1.4  # a corner at the far end alone
    stone["data"]["vertex"]["6"]["x"] = 1.2
    assert read(assembly(tmp_path / "a.json", [(mesh((-1, 0, -1), (3, 1, 0)), True), (stone, False)]))[0] == 2
    assert "no plane model" in capsys.readouterr().err


def test_advice_names_the_package_of_a_module(monkeypatch: pytest.MonkeyPatch) -> None:
    from voussoir import extras

    for managed, words in ((True, "apt-get install python3-shapely"), (False, "-m pip install shapely")):
        monkeypatch.setattr(extras, "_is_managed", lambda managed=managed: managed)
        assert extras.advice("shapely.affinity").endswith(words)
    with pytest.raises(extras.MissingPackage, match="needs nowhere, got none"):
        extras.load("nowhere.affinity", "a test")


def test_a_thousand_holes_take_seconds(tmp_path: Path) -> None:
    rings = ["(-1 -1, 601 -1, 601 3, -1 3, -1 -1)"]
    rings += [f"({2 * i} 0, {2 * i + 1} 0, {2 * i + 1} 1, {2 * i} 1, {2 * i} 0)" for i in range(300)]
    (tmp_path / "a.wkt").write_text("POLYGON (" + ", ".join(rings) + ")\n")
    status, deck = read(tmp_path / "a.wkt", "--hold", "1")
    assert status == 0
    assert deck.with_suffix(".blocks").read_text().count("block fixed") == 301


def test_work_beyond_its_limits_is_one_line() -> None:
    from voussoir.imports import limits

    with pytest.raises(ValueError, match="got a larger one"):
        limits.limited(bytearray, 2 * limits.MOST_MEMORY)
    with pytest.raises(ValueError, match="expected a file of its kind, got a ZeroDivisionError"):
        limits.limited(divmod, 1, 0)
    assert limits.limited(divmod, 7, 2) == (3, 1)


def test_lines_alone_of_a_drawing_stay_refused(tmp_path: Path, capsys) -> None:
    (tmp_path / "a.dxf").write_text(drawing(polyline("a", [(0, 0), (1, 0)], 0)))
    assert read(tmp_path / "a.dxf")[0] == 2
    assert "expected closed outlines, got none: LWPOLYLINE on layer a: 1 piece encloses nothing" in (
        capsys.readouterr().err)


def test_layers_of_json_keep_their_names(tmp_path: Path, capsys) -> None:
    features = [GROUND, feature(box(0, 0, 1, 1), "granite"), feature(box(0, 1, 1, 1), "brick")]
    assert read(geojson(tmp_path / "a.json", features))[0] == 0
    assert "materials: 1 granite, 2 brick" in capsys.readouterr().out
    assert json.loads((tmp_path / "a.json").read_text())["type"] == "FeatureCollection"
