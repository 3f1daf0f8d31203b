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


def weight_of(corners: list[tuple[float, float]], unit_weight: float) -> list[float]:
    """Weight of a polygon and its moment about the origin."""
    ring = [*corners, corners[0]]
    crosses = [x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(ring, ring[1:], strict=False)]
    area = sum(crosses) / 2
    x = sum((x0 + x1) * c for ((x0, _), (x1, _)), c in zip(zip(ring, ring[1:], strict=False), crosses)) / (6 * area)
    return [0.0, -abs(area) * unit_weight, -abs(area) * x * unit_weight]


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_reactions_of_fixed_blocks_are_minus_the_loads(tmp_path: Path, geometry: str) -> None:
    """Two blocks lean on a wall, one is pushed: force and moment balance to 1e-12."""
    blocks = (
        GROUND + "block fixed\n1.5 0\n2 0\n2 3\n1.5 3\n" + BLOCK + "block\n1 0\n1.5 0\n1.5 1\n1 1\n"
        "load 0 1.5 3000 -500\nlive 0.5 2 0 -700\n")
    tables = run(tmp_path, blocks, f"&analysis geometry = '{geometry}' /\n&load load_factor = 2 /")
    rows = tables["reactions"]
    assert [(row["block"], row["point"]) for row in rows] == [("1", "0"), ("2", "0")]
    loads = [math.fsum(parts) for parts in zip(
        weight_of([(0, 0), (1, 0), (1, 2), (0, 2)], 2240 * 9.81),
        weight_of([(1, 0), (1.5, 0), (1.5, 1), (1, 1)], 2240 * 9.81),
        (3000, -500 - 1400, -1.5 * 3000 - 0.5 * 1400), strict=True)]
    (total,) = wrenches(rows).values()
    size = max(map(abs, loads))
    off = [abs(a + b) / size for a, b in zip(total, loads, strict=True)]
    print(off)
    # a point that is loaded moves with its block by some 1e-6 m
    near = 1e-12 if geometry == "reference" else 1e-5
    assert max(off[:2]) <= 1e-12 and off[2] <= near


@pytest.mark.parametrize("voussoirs", [9, 24])
def test_springings_of_an_arch_carry_its_weight(tmp_path: Path, voussoirs: int) -> None:
    """Two springings, each with half the weight and the thrust that joints.csv has there."""
    tables = run(tmp_path, "", f"&arch voussoirs = {voussoirs} /\n&load horizontal_coefficient = 0.05 /")
    (total,) = wrenches(tables["reactions"]).values()
    area = sum(
        0.5 * abs(sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1], strict=True)))
        for ring in [[(float(r["x"]), float(r["y"])) for r in tables["blocks"] if r["block"] == str(b)]
                     for b in {r["block"] for r in tables["blocks"] if r["state"] == "free"}])
    weight = area * 2240 * 9.81
    assert len(tables["reactions"]) == 2
    assert total[:2] == pytest.approx([-0.05 * weight, weight], rel=1e-12)


def test_held_points_share_what_a_block_needs(tmp_path: Path) -> None:
    """A block hung on a pin and a roller: the lever says how much each bears."""
    tables = run(tmp_path, BLOCK + "fix 0 2\nfix 1 2 y\nload 1 0.5 100 0\n", "")
    rows = {row["point"]: row for row in tables["reactions"]}
    assert set(rows) == {"1", "2"} and {row["block"] for row in rows.values()} == {"1"}
    lever = 100 * 1.5
    assert float(rows["1"]["fx"]) == pytest.approx(-100, rel=1e-12)
    assert float(rows["2"]["fx"]) == 0.0
    assert float(rows["2"]["fy"]) == pytest.approx(WEIGHT / 2 - lever, rel=1e-12)
    assert float(rows["1"]["fy"]) == pytest.approx(WEIGHT / 2 + lever, rel=1e-12)
    assert float(rows["2"]["moment"]) == pytest.approx(WEIGHT / 2 - lever, rel=1e-12)


def test_nothing_is_said_of_what_does_not_stand(tmp_path: Path) -> None:
    tables = run(tmp_path, GROUND + BLOCK, "&load horizontal_coefficient = 0.7 /")
    assert tables["reactions"] == [] and tables["results"][0]["verdict"] == "collapsed"


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
