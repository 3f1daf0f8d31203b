"""Position and velocity of rigid blocks: polygons, measured points, and checks of a run's end."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

from scene import Check, Point, Run, block

EXACT = 1e-6  #: Relative error of positions and velocities where the integration is exact
ROUNDING = "free flight, uniform slides and impacts are exact: gaps of 1e-10 of a block and rounding remain"


@dataclass(frozen=True)
class State:
    """Centre [m], turn [rad], velocity [m/s] and spin [rad/s] of a block."""

    x: float
    y: float
    turn: float = 0.0
    vx: float = 0.0
    vy: float = 0.0
    spin: float = 0.0


def turned(points: Sequence[Point], angle: float) -> list[Point]:
    """Turn points about the origin by an angle [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return [(c * x - s * y, s * x + c * y) for x, y in points]


def rectangle(left: float, low: float, width: float, height: float) -> list[Point]:
    """Corners of an upright rectangle."""
    return [(left, low), (left + width, low), (left + width, low + height), (left, low + height)]


def properties(points: Sequence[Point]) -> tuple[float, Point, float]:
    """Area, centre, and polar second moment about the centre over the area."""
    area = sx = sy = polar = 0.0
    x0, y0 = points[0]
    near = [(x - x0, y - y0) for x, y in points]
    for (x1, y1), (x2, y2) in zip(near, near[1:] + near[:1]):
        cross = x1 * y2 - x2 * y1
        area += cross / 2.0
        sx += cross * (x1 + x2) / 6.0
        sy += cross * (y1 + y2) / 6.0
        polar += cross * (x1 * x1 + x1 * x2 + x2 * x2 + y1 * y1 + y1 * y2 + y2 * y2) / 12.0
    x, y = sx / area, sy / area
    return area, (x0 + x, y0 + y), polar / area - x * x - y * y


def in_time(pick: random.Random, duration: float, restitution: float) -> dict[str, object]:
    """Keys of &analysis of a motion, with any step and unknowns."""
    return {"mode": "dynamic", "geometry": "current", "steps": 1000000, "time_step": pick.choice([4e-3, 2e-3, 1e-3]),
            "duration": duration, "restitution": restitution, "unknowns": pick.choice([3, 6])}


def moving(points: Sequence[Point], velocity: tuple[float, float, float] = (0.0, 0.0, 0.0), words: str = "") -> str:
    """A block with a velocity at the beginning."""
    return block(list(points), f"{words} velocity {velocity[0]!r} {velocity[1]!r} {velocity[2]!r}")


def measured(number: int, points: Sequence[Point]) -> str:
    """Measured points of a block: its centre and its first corner."""
    _, (x, y), _ = properties(points)
    return f"measure block {number} {x!r} {y!r}\nmeasure block {number} {points[0][0]!r} {points[0][1]!r}\n"


def state_of(run: Run, index: int, row: int = -1) -> State:
    """State of the block of the index-th pair of measured points; its turn is the direction of its first corner."""
    centre, corner = run.points[2 * index][row], run.points[2 * index + 1][row]
    x, y = corner["x"] - centre["x"], corner["y"] - centre["y"]
    spin = (x * (corner["vy"] - centre["vy"]) - y * (corner["vx"] - centre["vx"])) / (x * x + y * y)
    return State(centre["x"], centre["y"], math.atan2(y, x), centre["vx"], centre["vy"], spin)


def end_checks(index: int, points: Sequence[Point], expected: State, scale: tuple[float, float],
               tolerance: float = EXACT, reason: str = ROUNDING, columns: str = "x y turn vx vy spin") -> list[Check]:
    """Checks of a block at the end of a run.

    `expected.turn` counts from the beginning. `scale` has the length and the speed that the tolerance is a share of.
    """
    _, (x, y), _ = properties(points)
    arm = math.hypot(points[0][0] - x, points[0][1] - y)
    begun = math.atan2(points[0][1] - y, points[0][0] - x)

    def value(name: str) -> Check:
        if name == "turn":
            return Check(f"turn of block {index}", lambda run: math.remainder(
                state_of(run, index).turn - begun - expected.turn, 2.0 * math.pi), 0.0, tolerance * scale[0] / arm,
                reason)
        unit = scale[1] / arm if name == "spin" else scale["v" in name]
        return Check(f"{name} of block {index}", lambda run: getattr(state_of(run, index), name),
                     getattr(expected, name), tolerance * unit, reason)

    return [value(name) for name in columns.split()]
