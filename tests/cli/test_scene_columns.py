"""Columns of the tables that a scene does not have are empty, and those that it has are filled."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

ARCH_COLUMNS = (
    "half_angle_deg thickness_ratio exact relative_error intrados_hinge_deg extrados_hinge_deg "
    "springing_hinge"
).split()
RING = "&arch voussoirs = 12, thickness_ratio = 0.12 /\n"
#: A search whose answer is no thickness, and a load under which the ring falls
ENDS = ("&search parameter = 'horizontal_coefficient', low = 0, high = 1 /\n", "&load horizontal_coefficient = 0.9 /\n")
BASE = "block fixed\n-9 -1\n9 -1\n9 0\n-9 0\n"
BLOCK = "block\n0 0\n1 0\n1 2\n0 2\n"
#: A corner on the middle of the block's upper edge, kept upright
TIP = "block\n0.5 2\n1 3\n0 3\nfix block 3 0 3 x\nfix block 3 1 3 x\n"

Row = dict[str, str]


def run(folder: Path, text: str, status: int = 0) -> tuple[list[Row], list[Row]]:
    """Rows of results.csv and joints.csv of a deck."""
    (folder / "deck.nml").write_text(text)
    done = run_dda("run", "deck.nml", "--quiet", cwd=folder)
    assert done.returncode == status, done.stderr
    return rows_of(folder / "deck/results.csv"), rows_of(folder / "deck/joints.csv")


@pytest.mark.parametrize("how", ["", "&analysis geometry = 'current' /\n", "&analysis mode = 'limerick' /\n"])
@pytest.mark.parametrize("end", ENDS)
def test_an_arch_read_from_lines_fills_no_column_of_arches(tmp_path: Path, how: str, end: str) -> None:
    """The very same ring, generated, fills them."""
    (tmp_path / "ring.nml").write_text(RING)
    assert run_dda("export", "ring.nml", cwd=tmp_path).returncode == 0
    lines = "&scene kind = 'lines', geometry = 'ring.geo', analysis = 'ring_plain.ana' /\n"
    for scene, is_arch in ((RING, True), (lines, False)):
        ((row,), joints) = run(tmp_path, scene + how + end)
        assert row["verdict"] == ("found" if "search" in end else "collapsed")
        assert row["blocks"] == "12" and row["collapse_mode"] == "rotational"
        for name in ("half_angle_deg", "thickness_ratio", "intrados_hinge_deg", "springing_hinge"):
            assert (row[name] != "") == is_arch, name
        assert is_arch or all(row[name] == "" for name in ARCH_COLUMNS)
        assert len(joints) == 13
        assert all((joint["angle_deg"] != "") == is_arch for joint in joints)


@pytest.mark.parametrize("end", ENDS)
def test_blocks_fill_no_column_of_arches(tmp_path: Path, end: str) -> None:
    (tmp_path / "x.blocks").write_text(BASE + BLOCK)
    ((row,), joints) = run(tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n" + end)
    assert row["verdict"] in ("found", "collapsed") and row["collapse_mode"] == "rotational"
    assert all(row[name] == "" for name in ARCH_COLUMNS)
    assert [joint["angle_deg"] for joint in joints] == [""]


def test_an_arch_that_stands_has_no_hinge_at_its_springings(tmp_path: Path) -> None:
    ((row,), _) = run(tmp_path, RING)
    assert (row["verdict"], row["springing_hinge"], row["intrados_hinge_deg"]) == ("stable", "none", "")


def test_a_joint_of_one_corner_has_neither_two_openings_nor_an_eccentricity(tmp_path: Path) -> None:
    """It carries the weight of the block on it, a triangle of 0.5 m2."""
    (tmp_path / "x.blocks").write_text(BASE + BLOCK + TIP)
    (_, (foot, tip)) = run(
        tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&material unit_weight = 20000.0 /\n")
    assert float(foot["eccentricity_ratio"]) == pytest.approx(0.0, abs=1e-9)
    assert foot["opening_extrados"] != "" and float(foot["normal_force"]) == pytest.approx(5e4)
    assert float(tip["normal_force"]) == pytest.approx(1e4)
    assert (tip["x_intrados"], tip["y_intrados"]) == (tip["x_extrados"], tip["y_extrados"])
    assert tip["eccentricity_ratio"] == tip["opening_extrados"] == ""


@pytest.mark.parametrize(
    ("scene", "blocks"),
    [
        ("&arch voussoirs = 7 /", "7"),
        ("&arch joints_deg = 0, 20, 50, 90 /", "6"),
        ("&scene kind = 'blocks', geometry = 'x.blocks' /", "2"),
    ],
)
def test_an_undecided_search_says_how_many_blocks_it_had(tmp_path: Path, scene: str, blocks: str) -> None:
    (tmp_path / "x.blocks").write_text(BASE + BLOCK + BLOCK.replace("0\n", "2\n", 2).replace("1 2\n0 2", "1 3\n0 3"))
    search = "&search parameter = 'friction_deg' /\n&analysis geometry = 'current', steps = 1 /\n"
    ((row,), joints) = run(tmp_path, f"{scene}\n{search}", status=3)
    assert (row["verdict"], row["blocks"], joints) == ("undecided", blocks, [])
