"""Random walls of many bricks that move in time: hit, dropped on, shaken, held, tied, with and without mortar."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

from block_scene import box

G = 9.81
DENSITY = 2240.0


@dataclass(frozen=True)
class MovingWall:
    """A file of blocks, the keys of its deck, and what energies are compared with."""

    blocks: str
    keys: str
    #: Energy of motion and of bars that it begins with, and what its bricks gain as they fall freely for one step [J/m]
    begun: float
    fall: float


def brickwork(pick: random.Random, courses: int, columns: int, width: float, height: float) -> str:
    """Running bond on a fixed floor, now and then with an opening."""
    length = columns * width
    opening = (pick.randint(1, courses), pick.randrange(columns)) if pick.random() < 0.4 else (-9, -9)
    text = box(-length, -height, 3.0 * length, height, "fixed")
    for course in range(courses):
        shift = width / 2.0 if course % 2 else 0.0
        heads = sorted({0.0, length, *(shift + k * width for k in range(columns))})
        for k, (left, right) in enumerate(zip(heads, heads[1:])):
            if abs(course - opening[0]) > 1 or k != opening[1]:
                text += box(left, course * height, right - left, height)
    return text


def shaking(pick: random.Random, time: float) -> str:
    """Two periods of a sine of the ground."""
    period, most = time * pick.uniform(2.0, 20.0), G * pick.uniform(0.1, 1.2)
    return "base_acceleration\n" + "".join(
        f"{k * period / 16.0!r} {most * math.sin(math.pi * k / 8.0)!r} 0\n" for k in range(33))


def moving_wall(seed: int) -> MovingWall:
    """The wall of a seed."""
    pick = random.Random(seed)
    courses, columns = pick.randint(4, 20), pick.randint(3, 12)
    width, height = pick.choice([(0.25, 0.1), (2.0, 1.0), (0.4, 0.4)])
    length, top, time = columns * width, courses * height, math.sqrt(height / G)
    text = brickwork(pick, courses, columns, width, height)
    speed, begun = height / time, 0.0
    if pick.random() < 0.4:
        for k in range(pick.randint(1, 3)):
            along, spin = speed * pick.uniform(-0.3, 0.3), pick.uniform(-0.6, 0.6) / time
            text += box(length * (0.1 + 0.3 * k), top + height * pick.uniform(0.1, 1.0), width / 2.0, height,
                        f"velocity {along!r} 0 {spin!r}")
            turning = (width**2 / 4.0 + height**2) / 12.0 * spin**2
            begun += DENSITY * width / 2.0 * height * (along**2 + turning) / 2.0
    if pick.random() < 0.35:
        left, along = -width * pick.uniform(1.1, 2.0), speed * pick.uniform(1.0, 6.0)
        text += box(left, (courses // 2 + 0.3) * height, width, height, f"velocity {along!r} 0 0")
        begun += DENSITY * width * height * along**2 / 2.0
    text += shaking(pick, time) if pick.random() < 0.5 else ""
    if pick.random() < 0.2:
        text += f"fix {width / 3.0!r} {top - height / 2.0!r} x\n"
    if pick.random() < 0.2:
        reach = math.hypot(length / 2.0 + width / 2.0, top - 0.3 * height)
        begun += (1e3 * height) ** 2 * reach / (2.0 * 1e7 * height)
        text += (f"bar {-length / 2.0!r} {-0.2 * height!r} {width / 2.0!r} {top - height / 2.0!r} ea {1e7 * height!r} "
                 f"strength {2e4 * height!r} prestress {1e3 * height!r}\n")
    step = time * pick.choice([0.005, 0.02, 0.05])
    mortar = f", cohesion = {2e4 * height!r}, tension = {1e4 * height!r}" if pick.random() < 0.3 else ""
    return MovingWall(
        text, f"&joint friction_deg = {pick.choice([10.0, 25.0, 35.0, 45.0, 60.0])!r}{mortar} /\n"
        f"&analysis mode = 'dynamic', geometry = 'current', unknowns = {pick.choice([3, 3, 6])}, "
        f"restitution = {pick.choice([0.0, 0.0, 0.0, 0.3])!r}, time_step = {step!r}, duration = {60.0 * step!r}, "
        "steps = 1000000 /\n&output energy = .true., joints = .false., frames = 10 /\n", begun,
        DENSITY * length * top * (G * step) ** 2 / 2.0)
