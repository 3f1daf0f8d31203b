"""Impacts leave the speeds that Newton's law of restitution asks for, whatever the step."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path

import pytest
from block_scene import Point, block, deepest_entry, rows_of, run_blocks, turned
from dda_command import run_deck


def box(left: float, bottom: float, width: float, height: float) -> list[Point]:
    """Corners of a rectangle."""
    right, top = left + width, bottom + height
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


@pytest.mark.parametrize("friction, reduced", [(44.0, True), (0.0, False)])
def test_restitution_that_would_add_energy_is_reduced_and_reported(
    tmp_path: Path, friction: float, reduced: bool
) -> None:
    """The second impact of a rod whose corner slips would bring in energy by e = 1 and Coulomb's law (Kane)."""
    rod = turned([(-1.0, -0.05), (1.0, -0.05), (1.0, 0.05), (-1.0, 0.05)], 0.886)
    low = min(y for _, y in rod)
    text = block([(-9.0, -1.0), (9.0, -1.0), (9.0, 0.0), (-9.0, 0.0)], "fixed")
    text += block([(x, y - low + 0.05) for x, y in rod], "velocity -0.9726 -0.9649 1.911")
    run_blocks(tmp_path, text, f"&joint friction_deg = {friction} /\n&load gravity = 0 /\n"
               "&analysis mode = 'dynamic', geometry = 'current', time_step = 1e-3, duration = 0.1, unknowns = 3, "
               "restitution = 1 /\n&output energy = .true. /\n")
    rows = [(float(row["time"]), float(row["kinetic"])) for row in rows_of(tmp_path / "out" / "energy.csv")]
    gains = {time: (now - before) / before for (_, before), (time, now) in zip(rows, rows[1:])}
    assert max(gains.values()) < 1e-9
    said = re.search(r"restitution was reduced by up to ([\d.]+) % so that impacts add no energy, "
                     r"the most between blocks 1 and 2 at ([\d.]+) s", (tmp_path / "out" / "log.txt").read_text())
    assert bool(said) == reduced
    if said:
        # what is left of it neither brings in energy nor takes any
        time, gain = min(gains.items(), key=lambda row: abs(row[0] - float(said[2])))
        assert time == pytest.approx(float(said[2]), rel=1e-5) and gain > -1e-3
        assert 0.1 < float(said[1]) < 5.0


@pytest.mark.parametrize("unknowns", [3, 6])
@pytest.mark.parametrize("tilt", [1e-9, 1e-8, 1.3e-8, 2e-8, 1e-7, 1e-6, 1e-4])
def test_corners_that_hit_one_after_another_keep_the_energy(tmp_path: Path, tilt: float, unknowns: int) -> None:
    """A block flies against a wall, tilted so little that its second corner hits when the first has hardly left."""
    across = [(0.0, -0.34), (0.5, -0.34), (0.5, 0.34), (0.0, 0.34)]
    corners = [(x * math.cos(tilt) - y * math.sin(tilt) + 0.01234, x * math.sin(tilt) + y * math.cos(tilt))
               for x, y in across]
    (tmp_path / "x.blocks").write_text(block(box(-1.0, -2.0, 1.0, 4.0), "fixed") + block(corners, "velocity -1.3 0 0"))
    run_deck(
        tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&material young = 1e12 /\n&load gravity = 0 /\n"
        "&joint friction_deg = 0 /\n&analysis mode = 'dynamic', geometry = 'current', time_step = 4e-3, "
        f"duration = 0.1, steps = 9999, restitution = 1, unknowns = {unknowns} /\n&output energy = .true. /\n",
        "--quiet")
    kinetic = [float(row["kinetic"]) for row in rows_of(tmp_path / "x" / "energy.csv")]
    assert kinetic[-1] == pytest.approx(kinetic[0], rel=1e-10)


@pytest.mark.parametrize("friction_deg", [60.0, 70.0, 80.0])
def test_a_wall_that_is_hit_does_not_enter_itself(tmp_path: Path, friction_deg: float) -> None:
    """Bricks in running bond, without weight, hit in the middle by a block of twenty times their mass."""
    text = block(box(-5.0, -0.5, 15.0, 0.5), "fixed")
    for course in range(12):
        heads = sorted({0.0, 3.0, *(0.25 * k + 0.125 * (course % 2) for k in range(1, 12))})
        text += "".join(block(box(left, 0.1 * course, right - left, 0.1)) for left, right in itertools.pairwise(heads))
    text += block(box(-1.1, 0.35, 1.0, 0.5), "velocity 10.4 0 0")
    run_blocks(tmp_path, text, f"&joint friction_deg = {friction_deg} /\n&load gravity = 0 /\n"
               "&analysis mode = 'dynamic', geometry = 'current', time_step = 1e-3, duration = 0.1, unknowns = 3 /\n"
               "&output frames = 10, joints = .false. /\n")
    assert deepest_entry(tmp_path / "out") <= 1e-4
