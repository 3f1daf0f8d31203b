"""dda cut: lines to blocks, what was dropped, and the files of blocks."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_dda
from limerick_files import HAS_XML, HELD, INPUT, SQUARE


def blocks_of(path: Path, folder: Path) -> list[dict[str, str]]:
    """Rows of the table of blocks that a file is cut into."""
    done = run_dda("cut", path, "--out", folder / "blocks.csv", "--quiet")
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
    return rows_of(folder / "blocks.csv")


def test_both_forms_of_a_model_make_the_same_blocks(tmp_path: Path) -> None:
    plain = blocks_of(INPUT / "terrace.geo", tmp_path)
    # two steps of 12 by 3 and a parapet of 4 by 2 with an opening of 2 by 1
    assert sum(float(row["area"]) for row in plain) == pytest.approx(42.0, abs=1e-12)
    assert len(plain) == 10
    assert [row["material"] for row in plain].count("2") == 3
    assert sum(int(row["fixed_points"]) for row in plain) == 9
    assert sum(int(row["load_points"]) for row in plain) == 1
    assert sum(int(row["measured_points"]) for row in plain) == 2
    if not HAS_XML:
        pytest.skip("this build reads no XML: the DDAML form was left out")
    assert blocks_of(INPUT / "terrace_ddaml.geo", tmp_path) == plain


def test_a_build_without_xml_says_what_is_missing() -> None:
    done = run_dda("cut", INPUT / "terrace_ddaml.geo")
    if HAS_XML:
        assert done.returncode == 0
    else:
        assert done.returncode == 2
        assert "libxml2-dev" in done.stderr


@pytest.mark.parametrize(
    ("name", "areas", "fixed"),
    [("pushblock", [400.0, 25.0], 4), ("circleslope", None, 3)]
    + [(f"fixedlines_case{i}", [1.0], n) for i, n in ((1, 2), (2, 1), (3, 1), (4, 1), (7, 2), (8, 1))]
    + [("fixedlines_case5", [1.0, 1.0], 2), ("fixedlines_case6", [1.0, 1.0], 4)],
)
def test_examples_of_the_original_are_cut(tmp_path: Path, name: str, areas: list[float] | None, fixed: int) -> None:
    path = HELD / "original" / f"{name}.geo"
    if not path.exists():
        pytest.skip(f"{path} is not here")
    if not HAS_XML and path.read_text().startswith("<?"):
        pytest.skip("this build reads no XML")
    rows = blocks_of(path, tmp_path)
    if areas is None:
        # the ground and six slices of a circle, which together fill the outline
        assert len(rows) == 7
        assert sum(float(row["area"]) for row in rows) == pytest.approx(2.2, abs=1e-6)
    else:
        assert [float(row["area"]) for row in rows] == pytest.approx(areas, abs=1e-9)
    assert sum(int(row["fixed_points"]) for row in rows) == fixed


@pytest.mark.parametrize("path", sorted((INPUT).glob("*.geo")) + sorted(HELD.glob("arches/*.geo")))
def test_all_examples_are_cut_and_drop_no_line(path: Path) -> None:
    if not HAS_XML and path.read_text().startswith("<?"):
        pytest.skip("this build reads no XML")
    done = run_dda("cut", path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert "are unused" not in done.stdout or " 0 lines meet fewer" in done.stdout


def test_what_was_dropped_is_reported_with_its_line(tmp_path: Path) -> None:
    text = SQUARE.replace("4 0\n", "6 0\n", 1) + "0 0.5 0.7 0.5 1\n3 3 4 4 1\n"
    (tmp_path / "a.geo").write_text(text)
    done = run_dda("cut", "a.geo", cwd=tmp_path)
    assert done.returncode == 0
    assert "a.geo: 6 lines, 1 block" in done.stdout
    assert "a.geo:13: line 5 from (0, 0.5) to (0.7, 0.5): it meets fewer than two" in done.stdout
    assert "a.geo:14: line 6" in done.stdout


@pytest.mark.parametrize(("end", "hinged"), [(2.1, ""), (0.6, "1 block with a single fixed point can turn")])
def test_block_with_a_single_fixed_point_is_reported(tmp_path: Path, end: float, hinged: str) -> None:
    """A fixed line across a square of 1 m crosses two of its edges, and one that ends inside crosses one."""
    (tmp_path / "a.geo").write_text(
        "0.002\n4 4\n0\n0\n1 0 0 0\n0 0 1 0 1\n1 0 1 1 1\n1 1 0 1 1\n0 1 0 0 1\n-0.1 0.5 " + f"{end} 0.5\n")
    printed = run_dda("cut", "a.geo", cwd=tmp_path).stdout
    assert ("hinged" in printed) == bool(hinged) and hinged in printed, printed


def test_line_ends_marks_and_tabs_do_not_matter(tmp_path: Path) -> None:
    (tmp_path / "a.geo").write_bytes(b"\xef\xbb\xbf" + SQUARE.replace("\n", "\r\n").encode())
    (tmp_path / "b.geo").write_text(" \n\n" + SQUARE.replace(" ", "\t"))
    for name in ("a.geo", "b.geo"):
        assert run_dda("cut", name, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("", "1: error: the file is empty"),
        ("\n \n", "1: error: the file is blank"),
        ("#!0xDDA-v1.5\n1\n", "1: error: expected the plain form or DDAML, got the extended"),
        (SQUARE[:-4], "12: error: expected a coordinate of line 4 of 4, got"),
        (SQUARE.replace("1 1 0 1", "1 1 0 1;"), "11: error: expected a coordinate of line 3 of 4"),
        ("0.01 0 0 0 0 0 0 0 0", "1: error: expected at least one line"),
        (SQUARE.replace("4 0\n", "3 0\n", 1), "1: error: expected lines that enclose a block"),
        (SQUARE.replace("0\n0\n0\n0 0 1", "1\n0\n0\n0 0 1", 1) + "5 5\n", "13: error: expected a load point"),
    ],
)
def test_bad_files_are_refused_with_their_line(tmp_path: Path, text: str, wanted: str) -> None:
    (tmp_path / "a.geo").write_text(text)
    done = run_dda("cut", "a.geo", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert [line for line in done.stderr.splitlines() if "error" in line][0].startswith(f"a.geo:{wanted}")


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("a.geo", "--out", "a.txt"),
        ("a.geo", "--out"),
        ("a.geo", "--set", "arch%radius=1"),
        ("a.geo", "a.geo", "--out", "a.vtu"),
    ],
)
def test_commands_that_cannot_be_done(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    (tmp_path / "a.geo").write_text(SQUARE)
    done = run_dda("cut", *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("dda:")


def test_blocks_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "a.geo").write_text(SQUARE)
    done = run_dda("cut", "a.geo", "--out", "missing/a.vtu", cwd=tmp_path)
    assert done.returncode == 4


def test_vtu_holds_the_polygons(tmp_path: Path) -> None:
    done = run_dda("cut", INPUT / "terrace.geo", "--out", tmp_path / "a.vtu")
    assert done.returncode == 0
    head = (tmp_path / "a.vtu").read_bytes().split(b"<AppendedData")[0].decode()
    assert 'NumberOfCells="10"' in head
    assert 'NumberOfPoints="40"' in head
    assert all(f'Name="{name}"' in head for name in ("block", "material", "area", "edge_joint"))


@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_ten_thousand_lines_of_a_wall(tmp_path: Path, offset: float) -> None:
    n, m = 70, 140
    lines = [(0, 0, 10, 0), (10, 0, 10, 10), (10, 10, 0, 10), (0, 10, 0, 0)]
    lines += [(0, 10 * i / n, 10, 10 * i / n) for i in range(1, n)]
    for i in range(n):
        xs = [10 * (j + 0.5 * (i % 2)) / m for j in range(1 - i % 2, m)]
        lines += [(x, 10 * i / n, x, 10 * (i + 1) / n) for x in xs]
    head = f"1e-5\n{len(lines)} 4\n0\n0\n0\n0\n0\n0\n"
    rows = [" ".join(repr(float(v) + offset) for v in line) + " 1\n" for line in lines]
    (tmp_path / "wall.geo").write_text(head + "".join(rows))
    done = run_dda("cut", "wall.geo", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert f"{len(lines)} lines, {n * m + n // 2} blocks" in done.stdout
    assert "dropped     nothing" in done.stdout


def test_a_geometry_of_gmsh_is_named(tmp_path: Path) -> None:
    (tmp_path / "arch.geo").write_text("Point(1) = {0, 0, 0, 1.0};\n")
    done = run_dda("cut", "arch.geo", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.endswith("; of a geometry of gmsh import the mesh: voussoir import FILE.msh\n")
