"""Blocks that walls or notches confine stand, however stiff the springs that carry them at the walls."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import Point, block, run_blocks


def box(left: float, low: float, right: float, high: float, words: str = "") -> str:
    """A rectangle."""
    return block([(left, low), (right, low), (right, high), (left, high)], words)


def between_walls(width: float, height: float) -> str:
    """A floor and two walls."""
    return (box(-5.0, -1.0, width + 5.0, 0.0, "fixed") + box(-2.0, 0.0, 0.0, height, "fixed")
            + box(width, 0.0, width + 2.0, height, "fixed"))


def notch(rise: float, half_width: float) -> str:
    """Two fixed blocks with a notch between them, its tip in the origin."""
    end = half_width + 1.0
    right: list[Point] = [(0.0, 0.0), (0.0, -0.5), (end, -0.5), (end, rise), (half_width, rise)]
    left = [(-x, y) for x, y in reversed(right)]
    return block(right, "fixed") + block(left, "fixed")


BASIN = between_walls(1.0, 3.0) + "".join(
    box(0.0, y, 1.0, y + 0.5) + (box(0.0, y + 0.5, 0.5, y + 1.0) + box(0.5, y + 0.5, 1.0, y + 1.0)) * (y < 2.0)
    for y in (0.0, 1.0, 2.0))
PYRAMID = between_walls(2.0, 1.0) + box(0.0, 0.0, 1.0, 0.5) + box(1.0, 0.0, 2.0, 0.5) + box(0.5, 0.5, 1.5, 1.0)
WEDGE = notch(4.35, 4.35 * 0.109807) + block([(0.0, 0.0), (2.9 * 0.109807, 2.9), (-2.9 * 0.109807, 2.9)])
#: Blocks, keys of &material, friction [deg], horizontal coefficient, penalty ratio
SCENES = {
    "oedometer": (between_walls(1.9, 6.0) + box(0.0, 0.0, 1.9, 4.7), "young = 5.3e9, poisson = 0.29", 0, 0.0, 1e4),
    "block": (between_walls(0.4, 2.8) + box(0.0, 0.0, 0.4, 1.8), "young = 5e10, poisson = 0.45", 50, 0.0, 100.0),
    "wedge": (WEDGE, "young = 5e9, poisson = 0", 10, 0.0, 100.0),
    "bricks in a basin": (BASIN, "young = 1e9", 30, 0.1, 100.0),
    "three bricks": (PYRAMID, "young = 1e9, poisson = 0.1, plane = 'stress'", 30, 0.0, 1e5),
}


@pytest.mark.parametrize("name", list(SCENES))
def test_confined_blocks_stand(tmp_path: Path, name: str) -> None:
    blocks, material, friction, push, penalty = SCENES[name]
    row = run_blocks(tmp_path, blocks, (
        f"&material density = 2420, {material} /\n&joint friction_deg = {friction} /\n"
        f"&load horizontal_coefficient = {push} /\n&analysis geometry = 'current', penalty_ratio = {penalty} /\n"))
    assert row["verdict"] == "stable"


@pytest.mark.parametrize("unknowns", [3, 6])
def test_block_keeps_its_floor_however_deep_it_sinks_into_soft_springs(tmp_path: Path, unknowns: int) -> None:
    # deeper than the search for contacts reaches beyond a block that hardly moves
    row = run_blocks(tmp_path, between_walls(0.15, 3.5) + box(0.0, 0.0, 0.15, 3.0), (
        "&material density = 2420, young = 1e7 /\n&joint friction_deg = 14 /\n"
        f"&analysis geometry = 'current', penalty_ratio = 1, unknowns = {unknowns} /\n"))
    assert row["verdict"] == "stable"


@pytest.mark.parametrize("penalty", [1.0, 1e3, 1e6])
@pytest.mark.parametrize("unknowns", [3, 6])
def test_block_without_its_floor_falls_between_smooth_walls(tmp_path: Path, penalty: float, unknowns: int) -> None:
    walls = box(-2.0, 0.0, 0.0, 6.0, "fixed") + box(1.9, 0.0, 3.9, 6.0, "fixed")
    row = run_blocks(tmp_path, walls + box(0.0, 1.0, 1.9, 4.7), (
        "&joint friction_deg = 0 /\n"
        f"&analysis geometry = 'current', penalty_ratio = {penalty}, unknowns = {unknowns} /\n"))
    assert row["verdict"] == "collapsed"
