"""Impacts leave the speeds that Newton's law of restitution asks for, whatever the step."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from block_scene import Point, block, rows_of, run_blocks, turned
from dda_command import run_deck

FLOOR = block([(-9.0, -1.0), (12.0, -1.0), (12.0, 0.0), (-9.0, 0.0)], "fixed")
#: What E = 5 GPa lets blocks of half a metre swing, over their speeds
STRAIN = 2e-6


def box(left: float, bottom: float, width: float, height: float) -> list[Point]:
    """Corners of a rectangle."""
    right, top = left + width, bottom + height
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


def speeds(folder: Path, blocks: str, *, friction: float = 0.0, gravity: float = 9.81, step: float = 0.001,
           duration: float, restitution: float, unknowns: int = 3, direction: float = -90.0) -> list[dict[str, float]]:
    """Last row of each measured point."""
    deck = (f"&joint friction_deg = {friction!r} /\n"
            f"&load gravity = {gravity!r}, gravity_direction_deg = {direction!r} /\n"
            f"&analysis mode = 'dynamic', geometry = 'current', steps = 100000, time_step = {step!r}, "
            f"duration = {duration!r}, restitution = {restitution!r}, unknowns = {unknowns} /\n")
    row = run_blocks(folder, blocks, deck)
    assert row["verdict"] == "completed"
    last: dict[str, dict[str, float]] = {}
    for line in rows_of(folder / "out" / "points.csv"):
        last[line["point"]] = {name: float(line[name]) for name in ("x", "y", "vx", "vy")}
    return list(last.values())


def after(first: tuple[float, float], second: tuple[float, float], restitution: float) -> tuple[float, float]:
    """Speeds of two masses (mass, speed) after their impact."""
    (m, u), (n, v) = first, second
    common, closing = (m * u + n * v) / (m + n), u - v
    return common - restitution * closing * n / (m + n), common + restitution * closing * m / (m + n)


@pytest.mark.parametrize("unknowns", [3, 6])
@pytest.mark.parametrize("gap", [0.1, 0.1013])
@pytest.mark.parametrize("step", [0.0025, 0.001])
def test_blocks_on_a_smooth_floor_exchange_speed(tmp_path: Path, unknowns: int, gap: float, step: float) -> None:
    """A gap of 40 or 100 whole steps, and one of none."""
    blocks = (FLOOR + block(box(0.0, 0.0, 0.6, 0.6), "velocity 1 0 0") + block(box(0.6 + gap, 0.0, 0.9, 0.6))
              + "measure 0.3 0.3\nmeasure 1.2 0.3\n")
    one, two = speeds(tmp_path, blocks, step=step, duration=0.3, restitution=0.5, unknowns=unknowns)
    wanted = after((0.6, 1.0), (0.9, 0.0), 0.5)
    assert (one["vx"], two["vx"]) == pytest.approx(wanted, abs=STRAIN if unknowns == 6 else 1e-9)
    assert (one["vy"], two["vy"]) == pytest.approx((0.0, 0.0), abs=STRAIN if unknowns == 6 else 1e-9)


@pytest.mark.parametrize("unknowns", [3, 6])
def test_flat_impact_on_a_rough_floor_turns_no_block(tmp_path: Path, unknowns: int) -> None:
    """Friction shears the striking block, so that its corners are not above one another."""
    blocks = (FLOOR + block(box(0.0, 0.0, 0.6, 0.6), "velocity 2 0 0") + block(box(0.7, 0.0, 0.6, 0.6))
              + "measure 0.3 0.3\nmeasure 1.0 0.3\n")
    slowing, time = 9.81 * math.tan(math.radians(20.0)), 0.07
    met = 2.0 * 0.1 / (2.0 + math.sqrt(4.0 - 2.0 * slowing * 0.1))
    one, two = speeds(tmp_path, blocks, friction=20.0, duration=time, restitution=0.5, unknowns=unknowns)
    wanted = [speed - slowing * (time - met) for speed in after((1.0, 2.0 - slowing * met), (1.0, 0.0), 0.5)]
    assert (one["vx"], two["vx"]) == pytest.approx(wanted, abs=1e-5)
    assert (one["vy"], two["vy"]) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_block_that_drops_on_a_resting_one_rebounds(tmp_path: Path) -> None:
    """From 1 m with restitution 0.8 it is at 0.8**2 of its height when its speed is none."""
    blocks = FLOOR + block(box(0.0, 0.0, 1.0, 1.0)) + block(box(0.1, 2.0, 0.8, 1.0)) + "measure 0.5 2.5\n"
    fall = math.sqrt(2.0 / 9.81)
    top, = speeds(tmp_path, blocks, duration=1.8 * fall, restitution=0.8)
    assert top["y"] == pytest.approx(1.5 + 0.64, abs=1e-7)
    assert top["vy"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("step", [0.004, 0.0013, 0.0007])
def test_three_blocks_in_a_row_keep_energy_and_momentum(tmp_path: Path, step: float) -> None:
    """Impacts one after the other, until the blocks part."""
    width, place, speed = [0.8, 0.3, 0.9], [0.0, 1.02, 1.93], [1.9, 0.0, 0.0]
    mass = [4.1, 0.6, 5.3]
    blocks = FLOOR + "".join(
        f"material {i + 2} density {1000.0 * m / (0.6 * w)!r}\n" for i, (m, w) in enumerate(zip(mass, width)))
    for i, (x, w, v) in enumerate(zip(place, width, speed)):
        blocks += block(box(x, 0.0, w, 0.6), f"material {i + 2} velocity {v} 0 0")
        blocks += f"measure {x + w / 2.0!r} 0.3\n"
    # event by event
    now, left = place[:], 1.25
    while True:
        gaps = [now[i + 1] - now[i] - width[i] for i in range(2)]
        times = [gap / (speed[i] - speed[i + 1]) if speed[i] > speed[i + 1] + 1e-12 else math.inf
                 for i, gap in enumerate(gaps)]
        time = min(*times, left)
        now, left = [x + time * v for x, v in zip(now, speed)], left - time
        if left <= 0.0:
            break
        i = times.index(min(times))
        speed[i], speed[i + 1] = after((mass[i], speed[i]), (mass[i + 1], speed[i + 1]), 1.0)
    got = speeds(tmp_path, blocks, step=step, duration=1.25, restitution=1.0)
    assert [point["vx"] for point in got] == pytest.approx(speed, abs=1e-8)
    assert [point["x"] for point in got] == pytest.approx([x + w / 2 for x, w in zip(now, width)], abs=1e-6)


@pytest.mark.parametrize("step", [0.004, 0.001])
def test_corner_of_a_spinning_block_rebounds(tmp_path: Path, step: float) -> None:
    """Without gravity and friction: J (1/m + x**2/I) = (1 + e) times the speed at the corner."""
    side, spin, fall = 0.8, 2.5, -3.0
    blocks = FLOOR + block(box(-0.4, 1.2, side, side), f"velocity 1 {fall} {spin}") + "measure 0 1.6\n"

    def corner(time: float) -> Point:
        turn = spin * time + math.radians(225.0)
        points = [(0.4 * math.sqrt(2.0) * math.cos(turn + k * math.pi / 2.0),
                   0.4 * math.sqrt(2.0) * math.sin(turn + k * math.pi / 2.0)) for k in range(4)]
        return min(points, key=lambda point: point[1])

    early, late = 0.0, 1.0
    for _ in range(60):
        time = (early + late) / 2.0
        early, late = (time, late) if 1.6 + fall * time + corner(time)[1] > 0.0 else (early, time)
    x, _ = corner(early)
    inertia = side**2 / 6.0
    push = -1.6 * (fall + spin * x) / (1.0 + x**2 / inertia)
    point, = speeds(tmp_path, blocks, gravity=0.0, step=step, duration=early + 0.003, restitution=0.6)
    assert point["vy"] == pytest.approx(fall + push, abs=1e-6)
    assert point["vx"] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("step", [0.02, 0.01, 0.0037])
def test_slide_that_turns_is_exact(tmp_path: Path, step: float) -> None:
    """Thrown up a slope of 20 degrees (gravity turned) with friction of 5 degrees, it comes back."""
    blocks = FLOOR + block(box(0.0, 0.0, 1.5, 0.3), "velocity -0.4 0 0") + "measure 0.75 0.15\n"
    pull, rub = (9.81 * math.sin(math.radians(20.0)),
                 9.81 * math.cos(math.radians(20.0)) * math.tan(math.radians(5.0)))
    up = 0.4 / (pull + rub)
    back = 0.9 - up
    point, = speeds(tmp_path, blocks, friction=5.0, step=step, duration=0.9, restitution=0.0, direction=-70.0)
    assert point["vx"] == pytest.approx((pull - rub) * back, abs=1e-8)
    assert point["x"] - 0.75 == pytest.approx(-0.2 * up + (pull - rub) * back**2 / 2.0, abs=1e-8)


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
