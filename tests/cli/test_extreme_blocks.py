"""Blocks in scenes that once fooled the program: notches, long steps; test_stability.py has thin ones and corners."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, box, run_scene
from dda_command import rows_of, run_dda

BASE = "block fixed\n-10 -1\n10 -1\n10 0\n-10 0\n"


def run(folder: Path, blocks: str, groups: str, name: str = "results") -> list[dict[str, str]]:
    """Rows of a table of a run."""
    return rows_of(run_scene(folder, blocks, groups) / f"{name}.csv")


@pytest.mark.parametrize("half_deg", [3.0, 5.0, 85.0])
def test_a_smooth_wedge_slips_far_into_its_notch_and_rests(tmp_path: Path, half_deg: float) -> None:
    """By 1/sin^2 of the half angle more than if it stuck, and 1/sin^2 again of its own height."""
    slope = math.tan(math.radians(half_deg))
    sides = [
        [(0.0, 0.0), (0.0, -1.0), (2.0 * slope + 1.0, -1.0), (2.0 * slope, 2.0)],
        [(0.0, 0.0), (-2.0 * slope, 2.0), (-2.0 * slope - 1.0, -1.0), (0.0, -1.0)],
    ]
    blocks = "".join(block(side, "fixed") for side in sides)
    blocks += block([(0.0, 0.0), (slope, 1.0), (-slope, 1.0)])
    groups = "&analysis geometry = 'current' /\n&joint friction_deg = 0 /\n"
    (row,) = run(tmp_path, blocks, groups + "&material young = 5e12 /")
    assert row["verdict"] == "stable"


@pytest.mark.parametrize("step", [0.1, 1.0, 10.0])
def test_long_steps_let_nothing_through_the_floor(tmp_path: Path, step: float) -> None:
    blocks = BASE + box(-5.0, 0.0, 2.0, 0.5) + "measure -4.0 0.25\n"
    motion = "mode = 'dynamic', geometry = 'current', max_displacement_ratio = 1.0"
    groups = f"&analysis {motion}, time_step = {step}, duration = 1.5 /\n"
    groups += "&joint friction_deg = 20 /\n&load gravity_direction_deg = -60 /"
    last = run(tmp_path, blocks, groups, "points")[-1]
    slide = 9.81 * (0.5 - math.cos(math.pi / 6.0) * math.tan(math.radians(20.0)))
    assert float(last["u"]) == pytest.approx(slide * 1.5**2 / 2.0, rel=1e-3)
    assert abs(float(last["v"])) < 1e-5


def test_a_search_steps_aside_of_the_value_that_is_critical_to_the_last_digit(tmp_path: Path) -> None:
    """The middle of the bracket about tan(phi) is tan(phi): nothing rests there, nothing moves."""
    blocks = BASE + box(-0.345, 0.0, 0.62, 0.941) + box(-0.516, 0.941, 0.778, 1.047)
    groups = "&joint friction_deg = 7.61 /\n&material young = 5e13 /\n"
    groups += "&analysis geometry = 'current' /\n&search parameter = 'horizontal_coefficient' /"
    (row,) = run(tmp_path, blocks, groups)
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(math.tan(math.radians(7.61)), rel=1e-7)


@pytest.mark.parametrize("far", ["1e11", "1e15", "-1e30"])
def test_a_block_led_farther_than_any_step_goes_is_undecided(tmp_path: Path, far: str) -> None:
    blocks = BASE + box(0.0, 0.0, 1.0, 1.0) + f"displacement 0.5 0.5 0 {far}\n"
    (tmp_path / "x.blocks").write_text(blocks)
    (tmp_path / "x.nml").write_text("&scene kind = 'blocks', geometry = 'x.blocks' /\n"
                                    "&analysis mode = 'dynamic', geometry = 'current', duration = 0.01 /\n")
    done = run_dda("run", "x.nml", "--quiet", cwd=tmp_path)
    assert done.returncode == 3, done.stderr
    table = (tmp_path / "x" / "results.csv").read_text()
    assert "undecided" in table and "inf" not in table.lower() and "nan" not in table.lower()


def test_a_falling_triangle_with_a_point_led_away_ends(tmp_path: Path) -> None:
    """Nothing but inertia acts on some of its strains."""
    blocks = BASE + "block velocity 0 -1 0.5\n2.5 0.5\n3.5 0.5\n3 1.5\ndisplacement 2.499999999 0.5 0 0.001\n"
    (row,) = run(tmp_path, blocks, "&analysis mode = 'dynamic', geometry = 'current', time_step = 0.001, steps = 6 /")
    assert row["verdict"] == "completed"
