"""Blocks that slide, swing, rock, and blocks that come and go: closed forms and the oracle's answers."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

from oracle import World
from scene import Point, Scene, block
from states import State, end_checks, in_time, measured, moving, properties, rectangle, turned

G = 9.81
FLOOR = rectangle(-30.0, -1.0, 60.0, 1.0)
SECOND_ORDER = "second order in the step: accelerations times its square"


def joint(friction_deg: float, gravity: float = G, direction: float = -90.0) -> str:
    """Groups of friction and gravity."""
    return (f"&joint friction_deg = {friction_deg!r} /\n"
            f"&load gravity = {gravity!r}, gravity_direction_deg = {direction!r} /\n")


def reversing_slide(pick: random.Random) -> Scene:
    """A block is thrown up a slope, stops, and slides back or stays."""
    slope, friction = math.radians(pick.uniform(5.0, 40.0)), pick.uniform(0.0, 45.0)
    mu, speed = math.tan(math.radians(friction)), pick.uniform(0.3, 2.0)
    width, tall = pick.uniform(0.8, 2.0), pick.uniform(0.2, 0.3)
    up, down = (G * (math.sin(slope) + sign * mu * math.cos(slope)) for sign in (1.0, -1.0))
    rise, down = speed / up, max(0.0, down)
    duration = rise * pick.uniform(1.2, 4.0)
    way, final = down * (duration - rise) ** 2 / 2.0 - speed**2 / (2.0 * up), down * (duration - rise)
    shape, text = rectangle(0.0, 0.0, width, tall), block(turned(FLOOR, 0.0), "fixed")
    keys = in_time(pick, duration, 0.0)
    step = float(str(keys["time_step"]))
    # it reverses within a step: the change of acceleration acts up to one step too long
    scale = 2.0 * up * step**2, 2.0 * up * step**2 / rise
    checks = end_checks(0, shape, State(width / 2.0 + way, tall / 2.0, 0.0, final), scale, 1.0, SECOND_ORDER)
    direction = -90.0 + math.degrees(slope)
    return Scene(text + moving(shape, (-speed, 0.0, 0.0)) + measured(2, shape), keys, checks,
                 joint(friction, G, direction), {"young": 1e12}, is_second_order=True)


def steady_slide(pick: random.Random) -> Scene:
    """A block slides down a slope from rest or a speed, without an event."""
    friction = pick.choice([0.0, 0.001, pick.uniform(1.0, 25.0)])
    slope = math.radians(friction + pick.uniform(3.0, 40.0))
    mu, speed, duration = math.tan(math.radians(friction)), pick.choice([0.0, pick.uniform(0.1, 2.0)]), 0.6
    width, tall = pick.uniform(0.8, 2.0), pick.uniform(0.2, 0.5)
    down = G * (math.sin(slope) - mu * math.cos(slope))
    angle = pick.uniform(-math.pi, math.pi)
    floor, shape = turned(FLOOR, angle), turned(rectangle(0.0, 0.0, width, tall), angle)
    way, final = speed * duration + down * duration**2 / 2.0, speed + down * duration
    ((vx, vy), (x, y), (ex, ey)) = turned([(speed, 0.0), (width / 2.0 + way, tall / 2.0), (final, 0.0)], angle)
    direction = math.remainder(-90.0 + math.degrees(slope + angle), 360.0)
    return Scene(block(floor, "fixed") + moving(shape, (vx, vy, 0.0)) + measured(2, shape),
                 in_time(pick, duration, 0.0), end_checks(0, shape, State(x, y, 0.0, ex, ey), (1.0, final)),
                 joint(friction, G, direction), {"young": 1e12}, is_step_free=True)


def pendulum(pick: random.Random) -> Scene:
    """A block that is held at a point swings."""
    width, tall = pick.uniform(0.2, 1.0), pick.uniform(0.8, 2.0)
    arm, start = pick.uniform(0.2, 0.45) * tall, pick.uniform(0.2, 2.5)
    # the pivot is at the origin, the centre below it
    shape = turned(rectangle(-width / 2.0, -tall / 2.0 - arm, width, tall), start)
    _, _, polar = properties(shape)
    pull = G * arm / (polar + arm**2)
    rate, turn, spin, h = math.sqrt(pull), start, 0.0, 1e-4
    duration = 2.0 * math.pi / rate * pick.uniform(0.3, 1.2)
    count = math.ceil(duration / h)
    h = duration / count
    for _ in range(count):
        # Runge and Kutta's method for turn'' = -pull sin(turn)
        a = -pull * math.sin(turn)
        b = -pull * math.sin(turn + h / 2.0 * spin)
        c = -pull * math.sin(turn + h / 2.0 * spin + h * h / 4.0 * a)
        d = -pull * math.sin(turn + h * spin + h * h / 2.0 * b)
        turn, spin = turn + h * spin + h * h / 6.0 * (a + b + c), spin + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    keys = in_time(pick, duration, 0.0)
    ((x, y),) = turned([(0.0, -arm)], turn)
    expected = State(x, y, turn - start, -spin * y, spin * x, spin)
    # the phase of the midpoint rule is late by (rate step)2/24 of it at small turns, and by more at large ones
    late = (rate * float(str(keys["time_step"]))) ** 2 * rate * duration
    size = 2.0 * arm
    far = moving(rectangle(-30.0, -30.0, 60.0, 1.0), words="fixed")
    return Scene(far + block(shape) + "fix block 2 0 0\n" + measured(2, shape), keys,
                 end_checks(0, shape, expected, (size, size * rate), late, SECOND_ORDER), joint(0.0),
                 {"young": 1e12}, is_second_order=True)


def rocking(pick: random.Random) -> Scene:
    """A slender block rocks from one corner to the other, and loses what Housner says."""
    half, aspect = pick.uniform(0.1, 0.4), pick.uniform(4.0, 8.0)
    tall = 2.0 * half * aspect
    critical = math.atan(1.0 / aspect)
    lean = pick.uniform(0.2, 0.8) * critical
    shape = [(x + half, y) for x, y in turned(rectangle(-2.0 * half, 0.0, 2.0 * half, tall), -lean)]
    world = World((0.0, -G), 0.0, math.tan(math.radians(60.0)))
    world.add(FLOOR, density=0.0)
    world.add(shape)
    rate = math.sqrt(3.0 * G / (4.0 * half * math.hypot(1.0, aspect)))
    duration = pick.uniform(1.0, 4.0) / rate
    world.run(duration)
    keys = in_time(pick, duration, 0.0)
    late = 10.0 * (rate * float(str(keys["time_step"]))) ** 2 * rate * duration
    checks = end_checks(0, shape, world.state(1), (tall * lean, tall * lean * rate), late, SECOND_ORDER)
    return Scene(block(FLOOR, "fixed") + block(shape) + measured(2, shape), keys, checks, joint(60.0), {"young": 1e12},
                 is_second_order=True)


def added(pick: random.Random, is_alone: bool) -> Scene:
    """A block that is added falls from rest from then on; another one, if there is one, falls before."""
    duration, start = pick.uniform(0.4, 0.8), pick.uniform(0.1, 0.35)
    shape, other = rectangle(0.0, 0.0, pick.uniform(0.3, 1.0), 0.9), rectangle(3.0, 0.0, 1.0, 0.7)
    text = block(rectangle(-50.0, -10.0, 100.0, 1.0), "fixed") + block(shape)
    checks = end_checks(0, shape, _fallen(shape, duration - start), (1.0, 5.0))
    if not is_alone:
        text += block(other)
        checks += end_checks(1, other, _fallen(other, duration), (1.0, 5.0))
    text += f"add block 2 at {start!r}\n" + measured(2, shape) + (measured(3, other) if not is_alone else "")
    return Scene(text, in_time(pick, duration, pick.choice([0.0, 0.5])), checks, joint(30.0), {"young": 1e12},
                 is_step_free=True)


def _fallen(shape: list[Point], time: float) -> State:
    """A block that has fallen freely for a time."""
    _, (x, y), _ = properties(shape)
    return State(x, y - G * time**2 / 2.0, 0.0, 0.0, -G * time)


def removed(pick: random.Random) -> Scene:
    """A block falls from rest once the block below it is taken away, and bounces on the ground."""
    duration, start = pick.uniform(0.5, 0.7), pick.uniform(0.1, 0.3)
    width, tall = pick.uniform(0.5, 1.0), pick.uniform(0.5, 1.0)
    floor, low = rectangle(-9.0, -10.0, 18.0, 1.0), rectangle(-2.0, -1.0, 4.0, 1.0)
    shape = rectangle(0.0, 0.0, width, tall)
    text = block(floor, "fixed") + block(low, "fixed") + block(shape) + f"remove block 2 at {start!r}\n"
    return Scene(text + measured(3, shape), in_time(pick, duration, pick.choice([0.0, 0.5])),
                 end_checks(0, shape, _fallen(shape, duration - start), (1.0, 5.0)),
                 joint(pick.choice([0.0, 20.0])), {"young": 1e12}, is_step_free=True)


def slider(friction: float, kind: str) -> Callable[[random.Random], Scene]:
    """Family of blocks that slide over joints, collinear corners or small kinks of a floor."""
    return lambda pick: slide_over(pick, friction, kind)


def slide_over(pick: random.Random, friction: float, kind: str) -> Scene:
    """A block slides over a floor of several blocks or corners, level or inclined."""
    count, length = pick.randint(2, 20), pick.uniform(0.3, 3.0)
    mu, speed, duration = math.tan(math.radians(friction)), pick.uniform(1.0, 4.0), pick.uniform(0.3, 1.0)
    slope = 0.0 if kind == "joints" and pick.random() < 0.5 else pick.uniform(0.0, 0.6)
    drive = G * (math.sin(slope) - mu * math.cos(slope))
    if drive < 0.0:
        duration = min(duration, 0.8 * speed / -drive)
    width, tall = pick.uniform(0.5, 2.0), pick.uniform(0.1, 0.25)
    marks = [-1.0 - width + k * length for k in range(count)] + [count * length + 40.0]
    digits = {"rounded": 5}.get(kind, 17)
    kink = math.radians(0.9) * 10.0 ** pick.uniform(-3.0, 0.0) if kind == "kinks" else 0.0
    tops, bend = [(-30.0, 0.0)], 0.0
    for mark in marks:
        x, y = tops[-1]
        tops.append((mark, y + math.tan(bend) * (mark - x)))
        # floors bend down only, before the block: a bend upwards is an impact
        bend = -kink if mark > 0.0 else 0.0

    def placed(points: list[Point]) -> list[Point]:
        """Points on the slope, rounded."""
        return [(round(x, digits), round(y, digits)) for x, y in turned(points, -slope)]

    text = ""
    if kind == "collinear":
        text += block(placed([(-30.0, -5.0), (marks[-1], -5.0), *reversed(tops)]), "fixed")
    else:
        for (x1, y1), (x2, y2) in zip(tops, tops[1:]):
            text += block(placed([(x1, -5.0), (x2, -5.0), (x2, y2), (x1, y1)]), "fixed")
    shape = placed(rectangle(-width, 0.0, width, tall))
    way, final = speed * duration + drive * duration**2 / 2.0, speed + drive * duration
    ((vx, vy), (x, y), (ex, ey)) = turned(
        [(speed, 0.0), (-width / 2.0 + way, tall / 2.0), (final, 0.0)], -slope)
    # rounded corners tilt their edges by twice the rounding over their length; bends tilt what slides
    tilt = 4.0 * 10.0**-digits / min(length, width) * 2.0 + kink
    tolerance = max(1e-6, 3.0 * tilt * (1.0 + (speed + G * duration) * duration))
    reason = "tilts of edges over the way" if tilt > 1e-9 else "a uniform acceleration is exact"
    # beyond a bend a block tips about it as about an edge, until it lies on the next part
    tips = math.sqrt(3.0 * G * kink / width) / tolerance
    keys = in_time(pick, duration, pick.choice([0.0, 0.0, 0.5]))
    checks = end_checks(0, shape, State(x, y, 0.0, ex, ey), (1.0, max(speed, final, tips)), tolerance, reason)
    number = 2 if kind == "collinear" else len(marks) + 1
    return Scene(text + moving(shape, (vx, vy, 0.0)) + measured(number, shape), keys, checks, joint(friction),
                 {"young": 1e12}, is_step_free=kind in ("joints", "collinear"))


FAMILIES = {
    "reversing_slide": reversing_slide, "steady_slide": steady_slide, "pendulum": pendulum, "rocking": rocking,
    "added": lambda pick: added(pick, False), "added_alone": lambda pick: added(pick, True), "removed": removed,
    **{f"slider_{kind}_{name}": slider(friction, kind) for kind in ("joints", "collinear", "kinks", "rounded")
       for name, friction in (("smooth", 0.0), ("nearly_smooth", 0.001), ("rough", 20.0))},
}
