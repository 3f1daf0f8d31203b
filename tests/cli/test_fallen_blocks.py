"""Soft blocks that fall come to rest somewhere; that is no rest of the structure in question."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, box, run_blocks
from dda_command import rows_of

BASE = "block fixed\n-50 -1\n50 -1\n50 0\n-50 0\n"


def verdict(folder: Path, blocks: str, groups: str) -> tuple[str, float]:
    """Verdict of a scene of moving blocks, and the largest displacement of a corner [m]."""
    row = run_blocks(folder, blocks, groups)
    way = [math.hypot(float(corner["u"]), float(corner["v"])) for corner in rows_of(folder / "out" / "blocks.csv")]
    return row["verdict"], max(way)


#: Blocks whose centre lies beyond their foot, in units of its width, and the size of the scene [m]
LEANING = {
    "parallelogram": [(0, 0), (1, 0), (4, 6), (3, 6)],
    "steeper": [(0, 0), (1, 0), (2.3, 6), (1.3, 6)],
    "triangle": [(0, 0), (1, 0), (4, 5)],
    "pentagon": [(0, 0), (1, 0), (3.5, 3), (3, 5), (1.5, 4)],
    "to the left": [(0, 0), (1, 0), (-2, 6), (-3, 6)],
}


@pytest.mark.parametrize("young", [1e4, 1e5, 3e5, 1e6, 3e6, 1e7, 1e9])
def test_a_leaning_block_never_stands_however_soft_it_is(tmp_path: Path, young: float) -> None:
    blocks = BASE + block(LEANING["parallelogram"])
    groups = f"&analysis geometry = 'current' /\n&material young = {young!r} /"
    assert verdict(tmp_path, blocks, groups)[0] == "collapsed"


@pytest.mark.parametrize("shape", list(LEANING))
@pytest.mark.parametrize("size", [0.1, 10.0])
def test_no_leaning_block_stands_that_comes_to_lie_on_its_side(tmp_path: Path, shape: str, size: float) -> None:
    """A block of another size is as soft if young goes with it."""
    blocks = BASE + block([(size * x, size * y) for x, y in LEANING[shape]])
    for young in (2e5, 1e6):
        groups = f"&analysis geometry = 'current' /\n&material young = {young * size!r} /"
        assert verdict(tmp_path, blocks, groups)[0] != "stable"


@pytest.mark.parametrize("young", [1e5, 1e6])
def test_a_block_that_slides_to_a_stop_has_left_its_place(tmp_path: Path, young: float) -> None:
    """Down 45 degrees by more than its own size, against a wall."""
    slope = block([(0, 0), (10, -10), (10, -30), (0, -30)], "fixed")
    wall = box(10, -12, 2, 6, "fixed")
    groups = (f"&analysis geometry = 'current' /\n&material young = {young!r} /\n&joint friction_deg = 10 /")
    blocks = slope + wall + block([(4, -4), (6, -6), (6, -3), (4, -3)])
    assert verdict(tmp_path, blocks, groups)[0] == "collapsed"


def test_a_displacement_that_means_collapse_is_waited_for(tmp_path: Path) -> None:
    """The deck's own limit counts while a block moves; what rests on its side does not stand."""
    blocks = BASE + block(LEANING["parallelogram"])
    for limit, farthest in ((3.0, 4.0), (50.0, 50.0)):
        groups = (f"&analysis geometry = 'current', collapse_displacement = {limit!r} /\n" "&material young = 1e6 /")
        answer, way = verdict(tmp_path, blocks, groups)
        assert answer == "collapsed"
        assert way < farthest
        assert way > 3.0


def test_the_top_of_a_soft_tower_sinks_by_more_than_a_block_and_stands(tmp_path: Path) -> None:
    """By w H^2/(2 E) of its 40 plates, twice the size of one: what carries them sinks with them."""
    height, young, weight = 2.0, 1e5, 22000.0
    plates = "".join(box(0.0, i * 0.05, 1.0, 0.05) for i in range(40))
    groups = (
        "&analysis geometry = 'current' /\n" f"&material young = {young!r}, unit_weight = {weight!r}, poisson = 0 /")
    answer, way = verdict(tmp_path, BASE + plates, groups)
    assert answer == "stable"
    assert way > 1.9 * math.sqrt(0.05)
    assert way == pytest.approx(weight * height**2 / (2.0 * young), rel=0.05)


def test_a_pebble_goes_down_with_the_block_that_carries_it(tmp_path: Path) -> None:
    blocks = BASE + box(0.0, 0.0, 10.0, 10.0) + box(5.0, 10.0, 0.1, 0.1)
    groups = "&analysis geometry = 'current' /\n&material young = 1e6 /"
    answer, way = verdict(tmp_path, blocks, groups)
    assert answer == "stable"
    assert way > 10.0 * 0.1


def test_a_block_goes_with_the_one_that_is_led(tmp_path: Path) -> None:
    """Over 3 m, three times its size."""
    led = "".join(f"displacement {x} 0.2\n0 0 0\n1 0 0\n20 3 0\n" for x in (0.2, 1.8))
    blocks = BASE + box(0.0, 0.0, 2.0, 1.0) + box(0.5, 1.0, 1.0, 1.0) + led
    groups = ("&analysis geometry = 'current', steps = 4000, time_step = 0.05 /\n&material young = 5e6 /")
    answer, way = verdict(tmp_path, blocks, groups)
    assert answer == "stable"
    assert way == pytest.approx(3.0, abs=0.05)
