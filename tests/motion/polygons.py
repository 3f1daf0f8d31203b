"""Convex polygons in free flight and on floors: answers of the event-driven integrator (oracle.py)."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence

from oracle import Ambiguous, World
from scene import Point, Scene, block
from states import EXACT, end_checks, in_time, measured, moving, properties, rectangle, turned

G = 9.81
#: Impacts are no slower [m/s], and no nearer to one another and to the end of the run [s]
SLOWEST, APART = 0.15, 2e-3
#: A change of the velocities by SHIFT changes the end by at most this factor of it
SHIFT, GROWTH = 1e-8, 30.0
REASON = "the oracle's answer: free flight and impacts are exact, errors grow at most thirty-fold"


def polygon(pick: random.Random, size: float) -> list[Point]:
    """A convex polygon of three to seven corners about the origin, no angle of which is nearly flat."""
    while True:
        count = pick.randint(3, 7)
        angles = sorted(pick.uniform(0.0, 2.0 * math.pi) for _ in range(count))
        gaps = [b - a for a, b in zip(angles, angles[1:] + [angles[0] + 2.0 * math.pi])]
        if 0.5 < min(gaps) and max(gaps) < 2.6:
            break
    flat = pick.uniform(0.6, 1.0)
    points = [(size * math.cos(a), flat * size * math.sin(a)) for a in angles]
    _, (x, y), _ = properties(points)
    return [(px - x, py - y) for px, py in points]


def above(points: Sequence[Point], x: float, gap: float) -> list[Point]:
    """The polygon with its centre of coordinates at x and its lowest corner at a height."""
    low = min(y for _, y in points)
    return [(px + x, py - low + gap) for px, py in points]


class Layout:
    """Fixed and moving polygons, their velocities and densities."""

    def __init__(self, restitution: float, friction_deg: float = 0.0, gravity: float = G,
                 adds_errors: bool = False) -> None:
        self.restitution, self.friction_deg, self.gravity = restitution, friction_deg, gravity
        #: Whether blocks roll between their impacts, each of which adds its error
        self.adds_errors = adds_errors
        self.shapes: list[tuple[Sequence[Point], tuple[float, float, float], float]] = []

    def add(self, points: Sequence[Point], velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
            density: float = 2240.0) -> None:
        """Add a block; one of density 0 is fixed."""
        self.shapes.append((points, velocity, density))

    def world(self, shift: float = 0.0) -> World:
        """The oracle of it, with velocities changed a little."""
        world = World((0.0, -self.gravity), self.restitution, math.tan(math.radians(self.friction_deg)), SLOWEST)
        for points, (vx, vy, spin), density in self.shapes:
            by = shift if density > 0.0 and (vx, vy, spin) != (0.0, 0.0, 0.0) else 0.0
            world.add(points, (vx + by, vy - 1.3 * by, spin + 0.7 * by), density)
        return world

    def end(self, duration: float, least: int = 1, most: int = 12) -> World | None:
        """The oracle at the end, or nothing where the answer is not sharp."""
        world, other = self.world(), self.world(SHIFT)
        try:
            for each in (world, other):
                each.run(duration)
        except Ambiguous:
            return None
        times = [time for time, _ in world.impacts] + [duration]
        if not least <= len(world.impacts) <= most or any(b - a < APART for a, b in zip(times, times[1:])):
            return None
        change = max(abs(world.place - other.place).max(), abs(world.speed - other.speed).max())
        return world if change < GROWTH * SHIFT else None

    def scene(self, pick: random.Random, duration: float, world: World) -> Scene:
        """The scene with the oracle's answer."""
        text, points, checks, moved = "", "", [], 0
        keys, tolerance, reason = in_time(pick, duration, self.restitution), EXACT, REASON
        if world.rolled > 0.0:
            rate = max(world.rolled, math.sqrt(self.gravity / world.size), 2.0)
            rolls = max(1, len(world.impacts) - 1) if self.adds_errors else 1
            tolerance = 0.3 * rolls * (rate * float(str(keys["time_step"]))) ** 2
            reason = "second order in the step while a corner stays on an edge: square of turning rate times step"
        if world.lost > 0.0:
            tolerance = max(tolerance, world.lost * float(str(keys["time_step"])))
            reason = "first order in the step in which a corner slides off its edge: acceleration times step"
        fastest = max(math.hypot(vx, vy) for _, (vx, vy, _), _ in self.shapes)
        speed = max(fastest, math.sqrt(self.gravity), max(speed for _, speed in world.impacts))
        for number, (corners, velocity, density) in enumerate(self.shapes, start=1):
            if density == 0.0:
                text += block(list(corners), "fixed")
                continue
            words = "" if density == 2240.0 else f"material {number + 1}"
            text += f"material {number + 1} density {density!r}\n" * bool(words) + moving(corners, velocity, words)
            points += measured(number, corners)
            checks += end_checks(moved, corners, world.state(number - 1), (1.0, speed), tolerance, reason)
            moved += 1
        return Scene(text + points, keys, checks,
                     f"&joint friction_deg = {self.friction_deg!r} /\n&load gravity = {self.gravity!r} /\n",
                     {"young": 1e12}, is_step_free=not world.rolled,
                     is_second_order=world.rolled > 0.0 and not world.lost)


def drawn(pick: random.Random, make: Callable[[random.Random], tuple[Layout, float]], least: int = 1,
          most: int = 12) -> Scene:
    """The first scene that has a sharp answer."""
    while True:
        layout, duration = make(pick)
        world = layout.end(duration, least, most)
        if world:
            return layout.scene(pick, duration, world)


FLOOR = rectangle(-20.0, -1.0, 40.0, 1.0)


def spinning(friction: Sequence[float], gravity: bool) -> Callable[[random.Random], Scene]:
    """Family of spinning polygons that hit a floor."""

    def make(pick: random.Random) -> tuple[Layout, float]:
        layout = Layout(pick.choice([0.0, 0.3, 0.6, 0.9, 1.0]), pick.choice(friction), G * gravity)
        layout.add(FLOOR, density=0.0)
        shape = turned(polygon(pick, pick.uniform(0.3, 1.0)), pick.uniform(-math.pi, math.pi))
        velocity = pick.uniform(-3.0, 3.0), pick.uniform(-4.0, -1.0), pick.uniform(-5.0, 5.0)
        layout.add(above(shape, 0.0, pick.uniform(0.05, 0.8)), velocity, pick.choice([2240.0, 5000.0]))
        return layout, pick.uniform(0.2, 0.7)

    return lambda pick: drawn(pick, make)


def tilted_block(pick: random.Random) -> Scene:
    """A tilted block falls on one corner, then on a second one."""

    def make(pick: random.Random) -> tuple[Layout, float]:
        layout = Layout(pick.choice([0.2, 0.5, 0.8, 1.0]))
        layout.add(FLOOR, density=0.0)
        shape = rectangle(-0.5, -0.5, pick.uniform(0.4, 1.5), pick.uniform(0.3, 1.0))
        angle = pick.choice([-1.0, 1.0]) * 10.0 ** pick.uniform(-2.0, -0.2)
        layout.add(above(turned(shape, angle), 0.0, pick.uniform(0.05, 0.5)), (pick.uniform(-1.0, 1.0), 0.0, 0.0))
        return layout, pick.uniform(0.25, 0.6)

    return drawn(pick, make, least=2)


def polygon_on_resting(pick: random.Random) -> Scene:
    """A polygon falls on a block that rests on a smooth floor."""

    def make(pick: random.Random) -> tuple[Layout, float]:
        layout = Layout(pick.choice([0.3, 0.6, 1.0]))
        layout.add(FLOOR, density=0.0)
        width, tall = pick.uniform(0.8, 2.0), pick.uniform(0.3, 1.0)
        layout.add(rectangle(-width / 2.0, 0.0, width, tall))
        shape = turned(polygon(pick, pick.uniform(0.3, 0.6)), pick.uniform(-math.pi, math.pi))
        velocity = pick.uniform(-0.5, 0.5), pick.uniform(-2.0, 0.0), pick.uniform(-2.0, 2.0)
        layout.add(above(shape, pick.uniform(-0.2, 0.2) * width, tall + pick.uniform(0.05, 0.4)), velocity)
        return layout, pick.uniform(0.2, 0.5)

    return drawn(pick, make, most=5)


def polygons_meet(pick: random.Random) -> Scene:
    """Two polygons meet in free flight."""

    def make(pick: random.Random) -> tuple[Layout, float]:
        layout = Layout(pick.choice([0.0, 0.3, 0.6, 1.0]), pick.choice([0.0, 0.0, 20.0, 35.0]), 0.0)
        for x in (-1.0, 1.0):
            shape = turned(polygon(pick, pick.uniform(0.3, 0.7)), pick.uniform(-math.pi, math.pi))
            velocity = -x * pick.uniform(0.5, 3.0), pick.uniform(-0.3, 0.3), pick.uniform(-2.0, 2.0)
            layout.add([(px + x, py) for px, py in shape], velocity, pick.uniform(1000.0, 8000.0))
        return layout, pick.uniform(0.4, 1.0)

    return drawn(pick, make, most=3)


def shared_heights(pick: random.Random) -> Scene:
    """Blocks of unlike heights slide on a smooth floor and tip as they meet."""

    def make(pick: random.Random) -> tuple[Layout, float]:
        layout = Layout(pick.choice([0.2, 0.5, 0.8, 1.0]), adds_errors=True)
        layout.add(FLOOR, density=0.0)
        width = pick.uniform(0.3, 1.0)
        gap, speed = pick.uniform(0.1, 0.5), pick.uniform(1.0, 3.0)
        layout.add(rectangle(0.0, 0.0, width, pick.uniform(0.4, 1.5)), (speed, 0.0, 0.0))
        layout.add(rectangle(width + gap, 0.0, pick.uniform(0.3, 1.0), pick.uniform(0.4, 1.5)))
        return layout, gap / speed + pick.uniform(0.02, 0.3)

    return drawn(pick, make, most=8)


def touching_row(pick: random.Random) -> Scene:
    """Blocks that touch are hit from one side or from both at once: Moreau's law of impact on all contacts (M5)."""

    def make(pick: random.Random) -> tuple[Layout, float]:
        layout = Layout(pick.choice([0.3, 0.6, 1.0]), 0.0, pick.choice([0.0, G]))
        layout.add(FLOOR, density=0.0)
        tall, width, gap = pick.uniform(0.4, 1.0), pick.uniform(0.3, 1.0), pick.uniform(0.1, 0.3)
        count, speed = pick.randint(2, 3), pick.uniform(1.0, 2.0)
        layout.add(rectangle(-gap - width, 0.0, width, tall), (speed, 0.0, 0.0), pick.uniform(1000.0, 8000.0))
        for k in range(count):
            layout.add(rectangle(k * width, 0.0, width, tall), density=pick.uniform(1000.0, 8000.0))
        if pick.random() < 0.5:
            layout.add(rectangle(count * width + gap, 0.0, width, tall), (-speed, 0.0, 0.0))
        return layout, gap / speed + pick.uniform(0.01, 0.03)

    return drawn(pick, make, most=1)


FAMILIES = {
    "spin_smooth": spinning([0.0], False), "spin_smooth_gravity": spinning([0.0], True),
    "spin_rough": spinning([5.0, 20.0, 35.0, 50.0], False), "spin_rough_gravity": spinning([5.0, 20.0, 35.0], True),
    "tilted_block": tilted_block, "polygon_on_resting": polygon_on_resting, "polygons_meet": polygons_meet,
    "shared_heights": shared_heights, "touching_row": touching_row,
}
