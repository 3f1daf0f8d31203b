"""Sliders on floors of many blocks: an internal edge is no obstacle, at no friction, speed, shape or step."""

from __future__ import annotations

import math
import random
from pathlib import Path

import pytest
from block_scene import Point, block, rows_of, run_blocks, turned

G = 9.81
FLOORS = ("two", "many", "collinear", "incline", "rounded", "rounded incline", "rounded collinear", "steps")


def shape(pick: random.Random) -> list[Point]:
    """A slider with a flat foot, from the origin to the right."""
    w, h = pick.uniform(0.4, 1.2), pick.uniform(0.2, 0.5)
    return pick.choice([
        [(0, 0), (w, 0), (w, h), (0, h)], [(0, 0), (w, 0), (0.8 * w, h), (0.1 * w, h)],
        [(0, 0), (w, 0), (0.4 * w, h)], [(0, 0), (w, 0), (w, 0.1 * w), (0, 0.1 * w)],
        [(0, 0), (w, 0), (1.2 * w, 0.5 * h), (w, h), (0, h), (-0.2 * w, 0.5 * h)],
        [(0, 0), (0.3 * w, 0), (0.3 * w, 0.4 * h), (0.7 * w, 0.4 * h), (0.7 * w, 0), (w, 0), (w, h), (0, h)]])


def area(points: list[Point]) -> float:
    """Area of a polygon."""
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1])) / 2.0


def floor(pick: random.Random, kind: str, way: float, step: float) -> list[list[Point]]:
    """Blocks of a level floor from -2 to beyond the way."""
    end = way + 3.0
    if "collinear" in kind:
        on_top = sorted((pick.uniform(-1.0, way + 1.0) for _ in range(pick.randint(1, 5))), reverse=True)
        return [[(-2.0, -3.0), (end, -3.0), (end, 0.0), *((x, 0.0) for x in on_top), (-2.0, 0.0)]]
    n = 20 if "incline" in kind else 2 if kind == "two" else pick.randint(3, 8)
    parts = [0.3 + pick.random() for _ in range(n)]
    cuts = [-0.5 + (end + 0.5) * sum(parts[:k]) / sum(parts) for k in range(n + 1)]
    cuts[0] = -2.0
    tops = [pick.uniform(-step, step) / 2.0 if kind == "steps" and k > 0 else 0.0 for k in range(n)]
    return [[(a, -3.0), (b, -3.0), (b, y), (a, y)] for a, b, y in zip(cuts, cuts[1:], tops)]


@pytest.mark.parametrize("friction", [0.0, 0.001, 20.0])
@pytest.mark.parametrize("kind", FLOORS)
@pytest.mark.parametrize("seed", range(2))
def test_a_slider_crosses_the_joints_of_its_floor(tmp_path: Path, seed: int, kind: str, friction: float) -> None:
    """Its speed along the floor changes by (sin a - tan phi cos a) g t and by nothing else."""
    pick = random.Random(f"{seed} {kind} {friction}")
    unknowns, dt = pick.choice([3, 6]), pick.choice([0.01, 0.005, 0.002])
    angle = pick.uniform(2.0, 35.0) if kind in ("incline", "rounded incline", "rounded collinear") else 0.0
    grip = math.sin(math.radians(angle)) - math.tan(math.radians(friction)) * math.cos(math.radians(angle))
    speed, time = pick.uniform(2.5, 6.0), pick.uniform(0.4, 0.6)
    way = speed * time + grip * G * time**2 / 2.0
    slider = [(x - 1.3, float(y)) for x, y in shape(pick)]
    text = ""
    for corners in floor(pick, kind, way, 0.9e-4 * math.sqrt(area(slider))):
        places = turned(corners, -angle)
        text += block([(round(x, 5), round(y, 5)) for x, y in places] if "rounded" in kind else places, "fixed")
    (u, v), = turned([(speed, 0.0)], -angle)
    (x, y), = turned([(-1.22, 0.02)], -angle)
    text += block(turned(slider, -angle), f"velocity {u!r} {v!r} 0") + f"measure {x!r} {y!r}\n"
    run_blocks(tmp_path, text, f"&joint friction_deg = {friction!r} /\n&analysis mode = 'dynamic', "
               f"geometry = 'current', time_step = {dt}, duration = {time!r}, unknowns = {unknowns}, steps = 20000 /\n")
    last = rows_of(tmp_path / "out" / "points.csv")[-1]
    assert float(last["time"]) == pytest.approx(time, abs=1e-9)
    (along, _), = turned([(float(last["vx"]), float(last["vy"]))], angle)
    exact = 1e-9 if unknowns == 3 else 1e-4  # the blocks vibrate as they are laid down at once
    off = 1e-3 if "rounded" in kind or kind == "steps" else exact
    assert along == pytest.approx(speed + grip * G * time, abs=max(off, exact))


@pytest.mark.parametrize("unknowns", [3, 6])
@pytest.mark.parametrize("gap", [0.0, 0.05, 0.1, 0.1173, 1.0, 3.0])
def test_two_level_blocks_are_a_smooth_floor_wherever_steps_end(tmp_path: Path, gap: float, unknowns: int) -> None:
    """Without friction steps end where the slider's corner is, whole numbers of steps among them."""
    text = "".join(block([(a, -12.0), (b, -12.0), (b, 0.0), (a, 0.0)], "fixed") for a, b in [(-20.0, 0.0), (0.0, 20.0)])
    text += block([(-1.0 - gap, 0.0), (-gap, 0.0), (-gap, 0.5), (-1.0 - gap, 0.5)], "velocity 3 0 0")
    run_blocks(tmp_path, text + f"measure {-0.5 - gap!r} 0.25\n", "&joint friction_deg = 0 /\n"
               "&analysis mode = 'dynamic', geometry = 'current', time_step = 0.005, duration = 1.2, "
               f"unknowns = {unknowns}, steps = 20000 /\n")
    for row in rows_of(tmp_path / "out" / "points.csv"):
        assert float(row["vx"]) == pytest.approx(3.0, abs=1e-9)


@pytest.mark.parametrize("height, passes", [(0.9e-4, True), (-0.9e-4, True), (2e-3, False)])
def test_a_step_is_an_obstacle_beyond_the_contact_tolerance(tmp_path: Path, height: float, passes: bool) -> None:
    """Of blocks of 1 m; a wall of 2 mm stops the slider's foot."""
    text = "".join(block([(a, -3.0), (b, -3.0), (b, y), (a, y)], "fixed")
                   for a, b, y in [(-3.0, 0.0, 0.0), (0.0, 3.0, height)])
    text += block([(-1.6, 0.0), (-0.6, 0.0), (-0.6, 1.0), (-1.6, 1.0)], "velocity 2 0 0") + "measure -1.1 0.5\n"
    run_blocks(tmp_path, text, "&joint friction_deg = 0 /\n&analysis mode = 'dynamic', geometry = 'current', "
               "time_step = 0.005, duration = 0.5, unknowns = 3, steps = 20000 /\n")
    speed = float(rows_of(tmp_path / "out" / "points.csv")[-1]["vx"])
    assert (abs(speed - 2.0) < 1e-3) if passes else speed < 1.5
