"""Reactions of supports balance the loads at rest, and change the momentum of what moves."""

from __future__ import annotations

import math
from collections import defaultdict
from pathlib import Path

import pytest
from dda_command import rows_of, run_deck

GROUND = "block fixed\n-9 -1\n9 -1\n9 0\n-9 0\n"
BLOCK = "block\n0 0\n1 0\n1 2\n0 2\n"
WEIGHT = 2 * 2240 * 9.81


def run(folder: Path, blocks: str, groups: str) -> dict[str, list[dict[str, str]]]:
    """Tables of a scene of blocks by their names."""
    (folder / "x.blocks").write_text(blocks)
    kind = "&scene kind = 'blocks', geometry = 'x.blocks' /\n" if blocks else ""
    run_deck(folder, f"{kind}{groups}\n", "--out", "out", "--quiet")
    tables = {}
    for file in (folder / "out").glob("*.csv"):
        tables[file.stem] = rows_of(file)
    return tables


def wrenches(rows: list[dict[str, str]]) -> dict[float, list[float]]:
    """Sum of the reactions at each time."""
    of_time = defaultdict(list)
    for row in rows:
        of_time[float(row["time"])].append(row)
    return {time: [math.fsum(float(row[name]) for row in those) for name in ("fx", "fy", "moment")]
            for time, those in of_time.items()}


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_reactions_change_the_momentum_of_what_moves(tmp_path: Path, geometry: str, restitution: float) -> None:
    """A block slides, meets a wall and stops or goes back: its momentum is the sum of the impulses, in every step."""
    if geometry == "reference" and restitution > 0:
        return
    blocks = (
        GROUND + "block fixed\n1.2 0\n2 0\n2 3\n1.2 3\n" + BLOCK.replace("block", "block velocity 2 0 0")
        + "measure 0.5 1\n")
    tables = run(
        tmp_path, blocks,
        f"&joint friction_deg = 10 /\n&analysis mode = 'dynamic', geometry = '{geometry}', duration = 0.3,"
        f" time_step = 0.002, steps = 9999, restitution = {restitution}, unknowns = 3 /\n&output reactions = .true. /")
    points, mass = tables["points"], 2 * 2240
    times = [float(row["time"]) for row in points]
    speed = [[float(row["vx"]), float(row["vy"])] for row in points]
    total = wrenches(tables["reactions"])
    assert sorted(total) == times[1:]
    off = 0.0
    for k, (t0, t1) in enumerate(zip(times, times[1:], strict=False)):
        for axis, weight in ((0, 0.0), (1, WEIGHT)):
            brought = (total[t1][axis] - weight) * (t1 - t0) / mass
            off = max(off, abs(speed[k + 1][axis] - speed[k][axis] - brought) / 2.0)
    print(f"{geometry} {restitution}: {off:.1e} of the momentum")
    # a block that turns moves its measured centre by v = w x 0
    assert off < 1e-10
    if geometry == "current":
        assert speed[-1][0] <= 1e-9
        assert min(v for v, _ in speed) < (-0.5 if restitution > 0 else 1e-9)


def test_points_that_are_led_push_what_they_move(tmp_path: Path) -> None:
    """Two points lead a block with a growing speed: the force is mass times acceleration."""
    path = "".join(f"{k / 100} {0.5 * (k / 100)**2} 0\n" for k in range(51))
    tables = run(
        tmp_path, BLOCK + "".join(f"displacement 0.5 {y}\n{path}" for y in (0.5, 1.5)) + "measure 0.5 1\n",
        "&load gravity = 0 /\n&analysis mode = 'dynamic', geometry = 'current', duration = 0.5, time_step = 0.01,"
        " steps = 999, unknowns = 3 /\n&output reactions = .true. /")
    total = wrenches(tables["reactions"])
    times = [float(row["time"]) for row in tables["points"]]
    brought = math.fsum(total[t1][0] * (t1 - t0) for t0, t1 in zip(times, times[1:], strict=False))
    speed = float(tables["points"][-1]["vx"])
    assert brought == pytest.approx(2 * 2240 * speed, rel=1e-9)
    assert speed == pytest.approx(0.5, rel=0.02)


def test_velocities_of_measured_points(tmp_path: Path) -> None:
    """A block that spins and flies: v + w x r at every step."""
    tables = run(
        tmp_path, "block velocity 1 2 3\n-1 -1\n1 -1\n1 1\n-1 1\nmeasure 1 0\n",
        "&load gravity = 0 /\n&analysis mode = 'dynamic', geometry = 'current', duration = 0.2, time_step = 0.01,"
        " steps = 999, unknowns = 3 /")
    for row in tables["points"]:
        turn = 3 * float(row["time"])
        assert float(row["vx"]) == pytest.approx(1 - 3 * math.sin(turn), abs=1e-3)
        assert float(row["vy"]) == pytest.approx(2 + 3 * math.cos(turn), abs=1e-3)
