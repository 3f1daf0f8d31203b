"""What stands still in time takes no new work, and what only seems to goes on."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, run_scene, wall
from dda_command import rows_of, run_deck

COURSES, LENGTH, HEIGHT, G = 10, 0.25, 0.125, 9.81


def run(folder: Path, blocks: str, friction_deg: float, duration: float,
        time_step: float = 1e-3, unknowns: int = 6) -> tuple[list[dict[str, str]], int]:
    """Rows of the measured point and passes of a run."""
    out = run_scene(
        folder, blocks, f"&joint friction_deg = {friction_deg!r} /\n"
        f"&analysis mode = 'dynamic', geometry = 'current', unknowns = {unknowns}, "
        f"time_step = {time_step!r}, duration = {duration!r}, steps = 9999 /")
    return rows_of(out / "points.csv"), int(rows_of(out / "results.csv")[0]["open_close_iterations"])


# fewer and more than 300 and 2000 joints; blocks that strain swing first
@pytest.mark.parametrize(("columns", "unknowns", "steps"), [(5, 3, 40), (13, 3, 40), (100, 3, 40), (5, 6, 130)])
def test_a_wall_that_has_settled_stands_still(tmp_path: Path, columns: int, unknowns: int, steps: int) -> None:
    """Then nothing is left to be found: no passes, and not a bit of any place changes."""
    measured = wall(COURSES, columns, LENGTH, HEIGHT) + f"measure {LENGTH!r} {0.9 * COURSES * HEIGHT!r}\n"
    settled, passes = run(tmp_path, measured, 35.0, 1e-3 * steps, unknowns=unknowns)
    rows, in_all = run(tmp_path, measured, 35.0, 0.2, unknowns=unknowns)
    assert in_all == passes
    assert {(row["u"], row["v"]) for row in rows[steps:]} == {(settled[-1]["u"], settled[-1]["v"])}
    assert float(rows[-1]["v"]) < 0.0


@pytest.mark.parametrize("apart", [1e-6, 3e-6, 1e-5])
def test_bricks_that_land_microseconds_apart_come_to_rest(tmp_path: Path, apart: float) -> None:
    """The steps between two landings are short; a speed matters in them as little as in a long one."""
    courses, fall = 25, 0.05
    top = courses * HEIGHT
    bricks = [(LENGTH * (2 * i + 0.25), top + fall + apart * i) for i in range(3)]
    blocks = "".join(block([(x, y), (x + LENGTH / 2, y), (x + LENGTH / 2, y + HEIGHT), (x, y + HEIGHT)])
                     for x, y in bricks) + f"measure {bricks[1][0] + 0.01!r} {bricks[1][1] + 0.01!r}\n"
    rows, _ = run(tmp_path, wall(courses, 5, LENGTH, HEIGHT) + blocks, 35.0, 0.7, 2e-3)
    assert float(rows[-1]["time"]) == pytest.approx(0.7)
    assert float(rows[-1]["v"]) == pytest.approx(float(rows[-20]["v"]), abs=1e-9)
    assert float(rows[-1]["v"]) == pytest.approx(-fall, rel=1e-3)


@pytest.mark.parametrize("friction_deg", [10.0, 80.0])
def test_a_brick_thrown_onto_a_wall_brings_in_its_own_energy_alone(tmp_path: Path, friction_deg: float) -> None:
    """No step adds noticeably to the energy, beside what moves and what falls in a step."""
    courses, columns, step = 20, 9, 1e-3
    low = courses * HEIGHT + 1e-3
    brick = block([(0.5, low), (0.5 + LENGTH, low), (0.5 + LENGTH, low + HEIGHT), (0.5, low + HEIGHT)],
                  "velocity 0.8 -1.0 4.0")
    (tmp_path / "x.blocks").write_text(wall(courses, columns, LENGTH, HEIGHT) + brick)
    run_deck(
        tmp_path, f"&scene kind = 'blocks', geometry = 'x.blocks' /\n&joint friction_deg = {friction_deg!r} /\n"
        f"&analysis mode = 'dynamic', geometry = 'current', unknowns = 3, time_step = {step!r}, duration = 0.1, "
        "steps = 9999 /\n&output energy = .true. /\n", "--quiet")
    rows = rows_of(tmp_path / "x" / "energy.csv")
    totals = [sum(float(row[name]) for name in ("kinetic", "elastic", "gravity")) for row in rows]
    fall = 2240.0 * courses * columns * LENGTH * HEIGHT * (G * step) ** 2 / 2.0
    motion = [fall + float(row["kinetic"]) for row in rows]
    assert max((b - a) / m for a, b, m in zip(totals, totals[1:], motion)) < 1e-4


@pytest.mark.parametrize("friction_deg", [25, 35])
def test_a_brick_that_flies_into_a_wall_without_gravity_adds_nothing(tmp_path: Path, friction_deg: int) -> None:
    """Nothing falls there: what no step notices is measured by the speed of the brick."""
    courses, speed = 16, 5.0
    low = 8.3 * HEIGHT
    brick = block([(-0.3, low), (-0.05, low), (-0.05, low + HEIGHT), (-0.3, low + HEIGHT)], f"velocity {speed!r} 0 0")
    (tmp_path / "x.blocks").write_text(wall(courses, 9, LENGTH, HEIGHT) + brick)
    run_deck(
        tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&load gravity = 0 /\n"
        f"&joint friction_deg = {friction_deg} /\n"
        "&analysis mode = 'dynamic', geometry = 'current', unknowns = 3, time_step = 5e-3, duration = 0.08, "
        "steps = 9999 /\n&output energy = .true. /\n", "--quiet")
    kinetic = [float(row["kinetic"]) for row in rows_of(tmp_path / "x" / "energy.csv")]
    first = 2240.0 * LENGTH * HEIGHT * speed**2 / 2.0
    assert kinetic[0] == pytest.approx(first, rel=1e-12)
    assert 0.0 < kinetic[-1] < 0.9 * first
    assert max(b - a for a, b in zip(kinetic, kinetic[1:])) < 1e-4 * first


def slope_with_block(rise: float) -> str:
    """A block on a plane that rises by so much in one."""
    across = (-rise, 1.0)
    foot, far = (1.0, rise), (2.0, 2.0 * rise)
    return (block([(0.0, 0.0), (0.0, -1.0), (9.0, -1.0), (9.0, 9.0 * rise)][::-1], "fixed")
            + block([foot, far, (far[0] + across[0], far[1] + across[1]), (foot[0] + across[0], foot[1] + across[1])])
            + f"measure 1.4 {1.5 * rise + 0.4!r}\n")


@pytest.mark.parametrize("share", [1e-6, 1e-5, 1e-3])
def test_what_slides_ever_so_slowly_slides_on(tmp_path: Path, share: float) -> None:
    """Friction that lacks a share of the weight lets a rigid block go at that share of gravity: s = a t**2/2."""
    rise, time = 0.5, 0.2
    friction = rise - share * math.hypot(1.0, rise)
    rows, _ = run(tmp_path, slope_with_block(rise), math.degrees(math.atan(friction)), time, unknowns=3)
    way = math.hypot(float(rows[-1]["u"]) - float(rows[20]["u"]), float(rows[-1]["v"]) - float(rows[20]["v"]))
    start = float(rows[20]["time"])
    assert way == pytest.approx(share * G * (time**2 - start**2) / 2.0, rel=0.05)


def test_what_stands_still_feels_a_push_that_begins(tmp_path: Path) -> None:
    """At rest for 0.1 s, then the ground goes off at 0.6 g below a block with friction 0.5: it lags by 0.1 g."""
    blocks = (block([(-3.0, -1.0), (4.0, -1.0), (4.0, 0.0), (-3.0, 0.0)], "fixed")
              + block([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
              + f"measure 0.5 0.5\nbase_acceleration\n0 0 0\n0.1 0 0\n0.1001 {0.6 * G!r} 0\n9 {0.6 * G!r} 0\n")
    rows, _ = run(tmp_path, blocks, math.degrees(math.atan(0.5)), 0.3)
    assert len({row["u"] for row in rows[40:99]}) == 1
    assert float(rows[-1]["u"]) == pytest.approx(-0.1 * G * 0.2**2 / 2.0, rel=0.01)


@pytest.mark.parametrize("speed", [1e-8, 1e-6, 1e-4])
def test_what_nothing_resists_keeps_its_speed(tmp_path: Path, speed: float) -> None:
    """A block goes on over a smooth floor however slow it is."""
    blocks = (block([(-3.0, -1.0), (4.0, -1.0), (4.0, 0.0), (-3.0, 0.0)], "fixed")
              + block([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], f"velocity {speed!r} 0 0")
              + "measure 0.5 0.5\n")
    rows, _ = run(tmp_path, blocks, 0.0, 0.2)
    assert float(rows[-1]["u"]) == pytest.approx(0.2 * speed, rel=1e-6)


def test_a_wall_pushed_beyond_its_limit_falls_without_creeping(tmp_path: Path) -> None:
    """Static steps settle as the wall falls; where their search creeps, they are cut: it takes 43 of them."""
    (tmp_path / "x.blocks").write_text(wall(6, 8, LENGTH, HEIGHT))
    rows = {}
    for name, keys in (
        ("limit", "&search parameter = 'horizontal_coefficient' /\n&analysis flow = 'associated' /\n"),
        ("fall", "&load horizontal_coefficient = 0.6 /\n"
                 "&analysis flow = 'associated', geometry = 'current', unknowns = 3 /\n")):
        run_deck(tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&joint friction_deg = 33 /\n" + keys,
                 "--quiet", "--out", name)
        (rows[name],) = rows_of(tmp_path / name / "results.csv")
    assert 0.55 < float(rows["limit"]["critical"]) < 0.6
    assert rows["fall"]["verdict"] == "collapsed" and int(rows["fall"]["steps"]) < 10
