"""Joints that carry tension hold what hangs or spins, whichever way it is turned, up to their strength."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, rows_of, run_blocks, turned

DENSITY, G = 2240.0, 9.81


def square(at: float, angle_deg: float, words: str = "") -> str:
    """A square of 1 m on a line that is turned."""
    return block(turned([(at, 0.0), (at + 1.0, 0.0), (at + 1.0, 1.0), (at, 1.0)], angle_deg), words)


@pytest.mark.parametrize("unknowns", [3, 6])
@pytest.mark.parametrize("angle_deg", [0.0, 10.0, 37.0, 90.0])
@pytest.mark.parametrize(("share", "verdict"), [(0.98, "collapsed"), (1.02, "stable")])
def test_squares_hang_on_a_bond_that_carries_their_weight(
    tmp_path: Path, unknowns: int, angle_deg: float, share: float, verdict: str
) -> None:
    """The uppermost of three joints carries the weight of three squares."""
    blocks = square(0.0, angle_deg, "fixed") + "".join(square(k, angle_deg) for k in (1.0, 2.0, 3.0))
    row = run_blocks(
        tmp_path, blocks, f"&load gravity_direction_deg = {angle_deg!r} /\n"
        f"&joint friction_deg = 35, cohesion = 1e9, tension = {share * 3.0 * DENSITY * G!r} /\n"
        f"&analysis mode = 'static', geometry = 'current', unknowns = {unknowns} /\n")
    assert row["verdict"] == verdict


def way_apart(folder: Path, tension: float, unknowns: int, angle_deg: float, spin: float, time: float) -> float:
    """How far the centres of two squares that spin about their joint go from one another."""
    blocks, centres = "", turned([(0.5, 0.5), (1.5, 0.5)], angle_deg)
    middle = turned([(1.0, 0.5)], angle_deg)[0]
    for k, (x, y) in enumerate(centres):
        blocks += square(k, angle_deg, f"velocity {-spin * (y - middle[1])!r} {spin * (x - middle[0])!r} {spin!r}")
    run_blocks(
        folder, blocks + "".join(f"measure {x!r} {y!r}\n" for x, y in centres), "&load gravity = 0 /\n"
        f"&joint friction_deg = 35, cohesion = 1e9, tension = {tension!r} /\n"
        f"&analysis mode = 'dynamic', geometry = 'current', unknowns = {unknowns}, time_step = 2e-3, "
        f"duration = {time!r}, steps = 9999 /\n")
    ends = rows_of(folder / "out" / "points.csv")[-2:]
    (ax, ay), (bx, by) = ((x + float(end["u"]), y + float(end["v"])) for (x, y), end in zip(centres, ends))
    return math.hypot(bx - ax, by - ay) - 1.0


@pytest.mark.parametrize("unknowns", [3, 6])
@pytest.mark.parametrize("angle_deg", [0.0, 30.0])
def test_squares_that_spin_part_where_their_bond_is_too_weak(
    tmp_path: Path, unknowns: int, angle_deg: float
) -> None:
    """The joint holds density spin**2 / 2; without it the squares go on along tangents."""
    spin, time = 3.0, 1.0
    needed = DENSITY * spin**2 / 2.0
    assert way_apart(tmp_path, 1.01 * needed, unknowns, angle_deg, spin, time) == pytest.approx(0.0, abs=1e-5)
    assert way_apart(tmp_path, 0.98 * needed, unknowns, angle_deg, spin, time) == pytest.approx(
        math.hypot(1.0, spin * time) - 1.0, rel=1e-2)
