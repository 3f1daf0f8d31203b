"""Dynamic runs that begin in balance."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import block, on_slope, rows_of, run_blocks

TIME = "&analysis mode = 'dynamic', geometry = '{}', time_step = 1e-3, duration = 0.2, steps = 100000, start = '{}' /\n"
TABLES = "&output energy = .true., reactions = .true. /\n"


def column() -> str:
    """Five cubes on a base."""
    blocks = "".join(block([(0.0, k), (1.0, k), (1.0, k + 1.0), (0.0, k + 1.0)]) for k in range(5))
    return block([(-5.0, -1.0), (5.0, -1.0), (5.0, 0.0), (-5.0, 0.0)], "fixed") + blocks


def test_the_blocks_begin_with_their_velocities(tmp_path: Path) -> None:
    """The topmost cube of five glides without friction, and the others stand still."""
    scene = column().replace("block \n0.0 4", "block velocity 0.3 0 0\n0.0 4")
    assert "velocity" in scene
    smooth = "&material young = 1e8 /\n&joint friction_deg = 0 /\n"
    run_blocks(tmp_path, scene, smooth + TIME.format("current", "static") + TABLES)
    kinetic = [float(row["kinetic"]) for row in rows_of(tmp_path / "out" / "energy.csv")]
    assert kinetic == pytest.approx([0.5 * 2240 * 0.3**2] * len(kinetic), rel=1e-7)


def test_loads_are_those_of_time_0_and_the_ground_is_at_rest(tmp_path: Path) -> None:
    """A pull on the upmost cube that is there from the beginning; a ground that is jerked at time 0."""
    scene = column() + "load 1 4.5\n0 2000 0\n0.1 2000 0\n0.11 0 0\n"
    keys = "&material young = 1e7 /\n" + TIME.format("current", "static") + TABLES
    run_blocks(tmp_path, scene, keys)
    rows = [line for line in rows_of(tmp_path / "out" / "reactions.csv") if float(line["time"]) < 0.0995]
    assert [float(line["fx"]) for line in rows] == pytest.approx([-2000.0] * len(rows), rel=1e-5)
    late = rows_of(tmp_path / "out" / "reactions.csv")[-1]
    assert abs(float(late["fx"]) + 2000.0) > 100.0
    run_blocks(tmp_path, scene + "base_acceleration\n0 0.5 0\n0.1 0 0\n", keys)
    # the first step moves what is at rest relative to the ground by its jerk alone
    first = rows_of(tmp_path / "out" / "energy.csv")[0]
    assert float(first["kinetic"]) < 0.5 * 5 * 2240 * (0.5 * 1e-3) ** 2


def test_stages_begin_in_balance_too(tmp_path: Path) -> None:
    scene = column() + block([(3.0, 0.0), (4.0, 0.0), (4.0, 1.0), (3.0, 1.0)])
    scene += "remove block 7 at 0.1\nmeasure 0.5 5\n"
    row = run_blocks(tmp_path, scene, "&material young = 1e7 /\n" + TIME.format("current", "static"))
    assert row["verdict"] == "completed"
    heights = [float(line["y"]) for line in rows_of(tmp_path / "out" / "points.csv")]
    assert heights[0] < 4.98
    assert heights == pytest.approx([heights[0]] * len(heights), abs=1e-8)


def test_what_does_not_stand_is_reported(tmp_path: Path) -> None:
    row = run_blocks(tmp_path, on_slope(40.0), "&joint friction_deg = 30 /\n" + TIME.format("current", "static"))
    assert row["verdict"] == "undecided"
    log = (tmp_path / "out" / "log.txt").read_text()
    assert "start = 'static' found no equilibrium: the blocks collapse under their loads at time 0" in log


def test_a_search_in_time_begins_in_balance(tmp_path: Path) -> None:
    """A rigid block 0.25 wide on a base that is jerked: it rocks over for pulses beyond b/h."""
    scene = block([(-5.0, -1.0), (5.0, -1.0), (5.0, 0.0), (-5.0, 0.0)], "fixed") + block(
        [(0.0, 0.0), (0.25, 0.0), (0.25, 1.0), (0.0, 1.0)]
    )
    keys = (
        "&joint friction_deg = 80 /\n&ground pulse = 'rectangular', duration = 5.0 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', time_step = 5e-3, duration = 4.0, steps = 100000, "
        "unknowns = 3, start = 'static' /\n&search parameter = 'amplitude', low = 1.0, high = 5.0, tolerance = 1e-5 /\n"
    )
    row = run_blocks(tmp_path, scene, keys)
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(9.81 * 0.25, rel=1e-5)
