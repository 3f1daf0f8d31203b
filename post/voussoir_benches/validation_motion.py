"""Scenes of blocks that fly, slide and are shaken: sections 1.1 and 1.2."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from voussoir_benches.checks import DENSITY, GRAVITY, Check, Outcome, end, verdict
from voussoir_benches.scene import Scene, benchmark

FLIGHT = "Free flight"
SLIDING = "Sliding"

#: Blocks of the deck `momentum`: width and height [m], velocity [m/s], spin [rad/s]
_THROWN = (
    ((1.0, 0.8), (2.0, 0.3), 0.5),
    ((1.2, 1.0), (-1.0, 0.0), -0.3),
    ((0.7, 0.9), (0.2, -1.5), 0.0),
    ((0.8, 0.8), (0.0, 1.4), 1.0),
)


def slide(slope_deg: float, friction_deg: float, up: bool = False) -> float:
    """Acceleration down a slope of a block that slides down, or up [m/s2]."""
    slope, friction = math.radians(slope_deg), math.radians(friction_deg)
    rub = math.cos(slope) * math.tan(friction)
    return GRAVITY * (math.sin(slope) + (rub if up else -rub))


def _along(slope_deg: float) -> Callable[[Outcome], float]:
    """Measure of the way of point 1 down a slope to the right."""
    slope = math.radians(slope_deg)
    return lambda outcome: float(outcome.end(1) @ (math.cos(slope), -math.sin(slope)))


def _area_change(outcome: Outcome) -> float:
    """Largest change of the area between points 2 to 5, over the area at the beginning."""
    x, y = (np.array([outcome.track(point)[i] for point in range(2, 6)]) for i in (1, 2))
    twice = (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)
    return float(np.abs(twice / 4.0 - 1.0).max())


def _radius_change(outcome: Outcome) -> float:
    """Largest change of the distance of points 2 to 5 from point 1, over that at the beginning."""
    centre = outcome.track(1)[1:3]
    change = 0.0
    for point in range(2, 6):
        far = np.hypot(*(outcome.track(point)[1:3] - centre))
        change = max(change, float(np.abs(far / far[0] - 1.0).max()))
    return change


def _rotation(outcome: Outcome) -> float:
    """Largest angle that the line from point 2 to point 3 has turned [rad]."""
    angle = outcome.direction(2, 3)
    return float(np.abs(angle - angle[0]).max())


def _way_at(time: float) -> Callable[[Outcome], float]:
    """Measure of the way of point 1 along x at a time at which a step ends."""

    def measure(outcome: Outcome) -> float:
        track = outcome.track(1)
        return float(np.interp(time, track[0], track[3]))

    return measure


def _turned(outcome: Outcome) -> float:
    """Angle that the line from point 1 to point 2 has turned since it was that of the deck."""
    tracks = outcome.track(1), outcome.track(2)
    start = [track[1:3, 0] - track[3:, 0] for track in tracks]
    apart = start[1] - start[0]
    angles = outcome.direction(1, 2)
    turns = round((angles[0] - math.atan2(apart[1], apart[0])) / (2.0 * math.pi))
    return float(angles[-1] - math.atan2(apart[1], apart[0]) - 2.0 * math.pi * turns)


def _momentum_gained(outcome: Outcome) -> np.ndarray:
    """Momentum and its moment about the origin, last step less beginning: (3)."""
    gained = np.zeros(3)
    for i, (size, thrown, turning) in enumerate(_THROWN):
        track = outcome.track(2 * i + 1)
        time, place = track[0, -2:], track[1:3, -2:].mean(axis=1)
        angle = outcome.direction(2 * i + 1, 2 * i + 2)[-2:]
        spin = (angle[1] - angle[0]) / (time[1] - time[0])
        gained += _share(size, outcome.velocity(2 * i + 1), spin, place)
        gained -= _share(size, thrown, turning, track[1:3, 0] - track[3:, 0])
    return gained


def _gained(i: int) -> Callable[[Outcome], float]:
    """Measure of one component of the momentum gained."""
    return lambda outcome: float(_momentum_gained(outcome)[i])


def _share(
    size: Sequence[float], velocity: Sequence[float] | np.ndarray, spin: float, place: np.ndarray
) -> np.ndarray:
    """Momentum of a rectangle and its moment about the origin: (3)."""
    mass = DENSITY * size[0] * size[1]
    inertia = mass * (size[0] ** 2 + size[1] ** 2) / 12.0
    moment = inertia * spin + mass * (place[0] * velocity[1] - place[1] * velocity[0])
    return np.array([mass * velocity[0], mass * velocity[1], moment])


def _momentum_checks() -> tuple[Check, ...]:
    """Checks that momentum and its moment stay, over the sum of their sizes at the beginning."""
    scale = sum(DENSITY * w * h * math.hypot(*v) for (w, h), v, _ in _THROWN)
    names = ("momentum along x", "momentum along y", "angular momentum")
    return tuple(Check(f"{name} gained", 0.0, _gained(i), 1e-9, scale=scale) for i, name in enumerate(names))


def _flights() -> list[Scene]:
    """Scenes without contact, and one in which blocks meet freely."""
    terminal = -GRAVITY / 4.0 * (10.0 - (1.0 - math.exp(-40.0)) / 4.0)
    fast = lambda outcome: float(outcome.energy("kinetic")[-1])  # noqa: E731
    away = "relative change of a corner distance"
    strain = Check(away, 0.0, _radius_change, 1e-12, scale=1.0)
    area = Check("relative change of area", 0.0, _area_change, 1e-12, scale=1.0)
    scene = partial(benchmark, FLIGHT)
    return [
        scene(
            "free_fall", "-g t^2/2; m (g t)^2/2",
            Check("v after 1 s [m]", -GRAVITY / 2.0, end(1), 1e-10),
            Check("kinetic energy [J/m]", DENSITY * 2.0 * GRAVITY**2 / 2.0, fast, 1e-10), rate=True),
        scene(
            "projectile", "vx t, vy t - g t^2/2",
            Check("u after 1 s [m]", 3.0, end(0), 1e-10),
            Check("v after 1 s [m]", 5.0 - GRAVITY / 2.0, end(1), 1e-10),
            Check("largest rotation [rad]", 0.0, _rotation, 1e-10, scale=1.0), strain, area, rate=True),
        scene(
            "spin", "angle w t",
            Check("angle after 10000 steps [rad]", 300.0, _turned, 1e-10),
            Check("displacement of the centre [m]", 0.0, end(0), 1e-10, scale=1.0), strain, area, slow=True),
        scene(
            "spin_and_fall", "free fall and angle w t",
            Check("v after 2 s [m]", 10.0 - 2.0 * GRAVITY, end(1), 1e-9),
            Check("angle after 2 s [rad]", 0.5, _turned, 1e-9), rate=True),
        scene("damped_fall", "-(g/c) (t - (1 - exp(-c t))/c)", Check("v after 10 s [m]", terminal, end(1), 1e-9),
              rate=True),
        scene("momentum", "conservation of momentum", *_momentum_checks(), rate=True),
    ]


def _creep(outcome: Outcome) -> float:
    """Distance of point 1 from where it was after 1000 steps [m]."""
    track = outcome.track(1)
    return float(np.hypot(*(track[3:, -1] - track[3:, 1000])))


def _slides() -> list[Scene]:
    """Scenes of one block on a slope."""
    cases = ((30.0, 0.0), (30.0, 20.0), (20.0, 10.0), (28.0, 22.0))
    what = "s({:g} s), {:.0f} deg, friction {:.0f} deg [m]"
    ways = [
        Check(what.format(time, *row), slide(*row) * time**2 / 2.0, _way_at(time), 1e-3, case)
        for time in (1.0, 2.0) for case, row in enumerate(cases, 1)
    ]
    top = 2.0 / slide(30.0, 15.0, up=True)
    back = slide(30.0, 15.0) * (1.0 - top) ** 2 / 2.0 - top
    law = "g (sin a - cos a tan phi) t^2/2"
    states = [
        verdict("collapsed" if case < 3 else "stable", f"{phi} deg, {geometry} geometry", case)
        for case, (phi, geometry) in enumerate(itertools.product((29.9, 30.1), ("reference", "current")), 1)
    ]
    scene = partial(benchmark, SLIDING)
    return [
        scene("slope", "stable for phi > a", *states),
        scene(
            "slope_creep", "no motion",
            Check("displacement in 100000 steps, with strain [m]", 0.0, _along(30.0), 1e-6, scale=1.0),
            Check("creep after the first 1000 steps [m]", 0.0, _creep, 1e-6, scale=1.0), slow=True),
        scene("incline", law, *ways, rate=True),
        scene("incline_30", law, Check("s(2 s) [m]", 2.0 * slide(30.0, 20.0), _along(30.0), 1e-3), rate=True),
        scene("upslope_stays", "v^2/(2g (sin a + cos a tan phi))",
              Check("displacement [m]", -4.0 / (2.0 * slide(20.0, 30.0, up=True)), _along(20.0), 1e-2), rate=True),
        scene("upslope_returns", "two motions of constant acceleration",
              Check("s(1 s) [m]", back, _along(30.0), 1e-2), rate=True),
    ]


#: Newmark's blocks: deck, dip [deg], way and speed at the end [m, m/s]
_NEWMARK = (
    ("newmark_flat", 0.0, -0.007708, 0.235090),
    ("newmark_periodic", 0.0, -0.007708, 0.235090),
    ("newmark_slope", 20.0, 0.018257, 0.0),
    ("newmark_velocity", 20.0, 0.018257, 0.0),
    ("newmark_displacement", 20.0, 0.018257, 0.0),
    ("newmark_fast", 20.0, 0.496482, 0.246839),
    ("newmark_rough", 20.0, 0.023078, 0.0),
)


def _shaken() -> list[Scene]:
    """Scenes of Newmark's block; the ways were integrated by two methods at steps of 2e-6 s.

    One ground is given by its acceleration, its velocity and its displacement.
    """
    return [
        benchmark(
            SLIDING,
            deck, "Newmark 1965, integrated numerically",
            Check("final displacement down the slope [m]", exact, _along(dip), 1e-2),
            Check("final speed [m/s]", speed, _speed_along(dip), 1e-2, scale=0.24), rate=True)
        for deck, dip, exact, speed in _NEWMARK
    ]


def _speed_along(slope_deg: float) -> Callable[[Outcome], float]:
    """Measure of the speed of point 1 down a slope to the right."""
    slope = math.radians(slope_deg)
    return lambda outcome: float(outcome.speed(1) @ (math.cos(slope), -math.sin(slope)))


def stick_slip(rub: float, push: float, end: float, steps: int = 400000) -> float:
    """Way of a block on a table after a time, by small steps of a motion that sticks and slips [m].

    Its acceleration is push cos t less that of friction [m/s2] (Potra et al. 2006 compare such a block).
    """
    step = end / steps
    way = speed = 0.0
    for i in range(steps):
        force = push * math.cos((i + 0.5) * step)
        direction = speed if speed != 0.0 else force
        if speed == 0.0 and abs(force) <= rub:
            continue
        after = speed + step * (force - math.copysign(rub, direction))
        if after * speed < 0.0:
            after = 0.0
        way += step * (speed + after) / 2.0
        speed = after
    return way


def _sticking() -> Scene:
    """A block that a periodic force moves to and fro."""
    exact = stick_slip(5.0, 8.0, 10.0)
    check = Check("displacement after 10 s [m]", exact, end(0), 1e-2)
    return benchmark(SLIDING, "stick_slip", "F cos t against friction, integrated numerically", check, rate=True)


#: Every scene of this module
SCENES = (*_flights(), *_slides(), *_shaken(), _sticking())
