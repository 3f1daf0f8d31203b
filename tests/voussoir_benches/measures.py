"""Quantities of finished runs: functions of an outcome, and functions that return them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from voussoir_benches.checks import DENSITY, GRAVITY, YOUNG, Outcome
from voussoir_benches.exact import THROWN

Measure = Callable[[Outcome], float]  #: A quantity of an outcome
_STORED = ("kinetic", "elastic", "contact", "gravity")  #: Columns of energy.csv that are stored


def result(column: str) -> Callable[[Outcome], float | str]:
    """Measure of a column of results.csv, a number or a word."""

    def measure(outcome: Outcome) -> float | str:
        text = outcome.rows("results")[0][column]
        return text if text.isalpha() else float(text)

    return measure


def end(axis: int, point: int = 1) -> Measure:
    """Measure of a displacement at the end [m]."""
    return lambda outcome: float(outcome.end(point)[axis])


def along(slope_deg: float) -> Measure:
    """Measure of the way of point 1 down a slope to the right [m]."""
    slope = math.radians(slope_deg)
    return lambda outcome: float(outcome.end(1) @ (math.cos(slope), -math.sin(slope)))


def speed_along(slope_deg: float) -> Measure:
    """Measure of the speed of point 1 down a slope to the right [m/s]."""
    slope = math.radians(slope_deg)
    return lambda outcome: float(outcome.speed(1) @ (math.cos(slope), -math.sin(slope)))


def foot(slope_deg: float) -> Measure:
    """Measure of the mean acceleration of point 1 from rest along its ground [m/s2]."""
    way = along(slope_deg)
    return lambda outcome: float(way(outcome) * 2.0 / outcome.track(1)[0, -1] ** 2)


def way_at(time: float) -> Measure:
    """Measure of the way of point 1 along x at a time at which a step ends [m]."""
    return lambda outcome: float(np.interp(time, *outcome.track(1)[[0, 3]]))


def creep(outcome: Outcome) -> float:
    """Distance of point 1 from where it was after 1000 steps [m]."""
    track = outcome.track(1)
    return float(np.hypot(*(track[3:, -1] - track[3:, 1000])))


def aside(outcome: Outcome) -> float:
    """Way of point 1 to the side [m]."""
    rows = outcome.rows("points")
    return float(rows[-1]["u"]) if rows else 0.0


def farthest(outcome: Outcome) -> float:
    """Farthest that point 1 ever was from its place [m]."""
    return float(np.hypot(*outcome.track(1)[3:]).max())


def height(outcome: Outcome) -> float:
    """Height of point 1 at the end over 1 m below its start [m]."""
    return 1.0 + float(outcome.end(1)[1])


def late_speed(point: int) -> Measure:
    """Measure of the mean speed along x in the last tenth of a second [m/s]."""

    def measure(outcome: Outcome) -> float:
        time, _, _, u, _ = outcome.track(point)
        k = np.searchsorted(time, time[-1] - 0.1)
        return float((u[-1] - u[k]) / (time[-1] - time[k]))

    return measure


def area_change(first: int, area: float) -> Measure:
    """Measure of the largest change of the area between four points over that at the beginning."""

    def measure(outcome: Outcome) -> float:
        x, y = (np.array([outcome.track(point)[i] for point in range(first, first + 4)]) for i in (1, 2))
        twice = (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)
        return float(np.abs(twice / (2.0 * area) - 1.0).max())

    return measure


def radius_change(outcome: Outcome) -> float:
    """Largest change of the distance of points 2 to 5 from point 1, over that at the beginning."""
    centre = outcome.track(1)[1:3]
    change = 0.0
    for point in range(2, 6):
        far = np.hypot(*(outcome.track(point)[1:3] - centre))
        change = max(change, float(np.abs(far / far[0] - 1.0).max()))
    return change


def rotation(outcome: Outcome) -> float:
    """Largest angle that the line from point 2 to point 3 has turned [rad]."""
    angle = outcome.direction(2, 3)
    return float(np.abs(angle - angle[0]).max())


def turn(outcome: Outcome) -> float:
    """Angle that the line from point 1 to point 2 has turned since it was that of the deck [rad]."""
    tracks = outcome.track(1), outcome.track(2)
    start = [track[1:3, 0] - track[3:, 0] for track in tracks]
    apart = start[1] - start[0]
    angles = outcome.direction(1, 2)
    turns = round((angles[0] - math.atan2(apart[1], apart[0])) / (2.0 * math.pi))
    return float(angles[-1] - math.atan2(apart[1], apart[0]) - 2.0 * math.pi * turns)


def fallen(outcome: Outcome) -> str:
    """Return "fallen" if the line from point 1 to 2 has turned by more than 45 degrees, else "stands"."""
    angle = outcome.direction(1, 2)
    return "fallen" if abs(angle[-1] - angle[0]) > math.pi / 4.0 else "stands"


def gained(i: int) -> Measure:
    """Measure of a component of momentum and its moment about the origin, last step less beginning."""

    def share(size: tuple[float, float], velocity: np.ndarray, spin: float, place: np.ndarray) -> np.ndarray:
        mass = DENSITY * size[0] * size[1]
        inertia = mass * (size[0] ** 2 + size[1] ** 2) / 12.0
        moment = inertia * spin + mass * (place[0] * velocity[1] - place[1] * velocity[0])
        return np.array([mass * velocity[0], mass * velocity[1], moment])

    def measure(outcome: Outcome) -> float:
        found = np.zeros(3)
        for k, (size, thrown, turning) in enumerate(THROWN):
            track = outcome.track(2 * k + 1)
            time, place = track[0, -2:], track[1:3, -2:].mean(axis=1)
            angle = outcome.direction(2 * k + 1, 2 * k + 2)[-2:]
            spin = (angle[1] - angle[0]) / (time[1] - time[0])
            found += share(size, outcome.velocity(2 * k + 1), spin, place)
            found -= share(size, np.array(thrown), turning, track[1:3, 0] - track[3:, 0])
        return float(found[i])

    return measure


def _tilt(outcome: Outcome, block: int) -> np.ndarray:
    """Tilt of a block by its two points after each step: (steps) [rad]."""
    return outcome.direction(2 * block - 1, 2 * block) - math.pi / 2.0


def upright(block: int) -> Measure:
    """Measure of the time at which a tilted block is first upright [s]."""

    def measure(outcome: Outcome) -> float:
        tilt = _tilt(outcome, block)
        time = outcome.track(2 * block)[0]
        beyond = np.flatnonzero(tilt <= 0.0)
        if len(beyond) == 0 or beyond[0] == 0:
            return math.nan
        k = beyond[0]
        return float(time[k - 1] + (time[k] - time[k - 1]) * tilt[k - 1] / (tilt[k - 1] - tilt[k]))

    return measure


def swing(block: int, angle: float) -> Measure:
    """Measure of the largest tilt to the other side over the block's angle."""
    return lambda outcome: float(-_tilt(outcome, block).min() / angle)


def fate(block: int, b: float, h: float) -> Callable[[Outcome], str]:
    """Measure of whether a block has ever been tilted far beyond its angle."""
    most = 1.5 * math.atan2(b, h)
    return lambda outcome: "overturns" if np.abs(_tilt(outcome, block)).max() > most else "rocks"


def period(outcome: Outcome) -> float:
    """Time between the first two blows on the ground 1 m below the start [s].

    Taken from the parabola through three steps of the flight between them.
    """
    time, _, _, _, v = outcome.track(1)
    blows = 1 + np.flatnonzero((v[1:-1] < v[:-2]) & (v[1:-1] < v[2:]))
    steps = [blows[0] + 1, (blows[0] + blows[1]) // 2, blows[1] - 1]
    roots = np.roots(np.polyfit(time[steps] - time[steps[1]], v[steps] + 1.0, 2))
    return float(abs(roots[0] - roots[1]))


def largest_rise(outcome: Outcome) -> float:
    """Largest rise of stored energy in a step [J/m]."""
    return float(max(0.0, np.diff(outcome.energy(*_STORED)).max()))


def relative_rise(outcome: Outcome) -> float:
    """Largest rise of energy in a step over the largest energy of speed, or over a joule."""
    return largest_rise(outcome) / max(1.0, float(outcome.energy("kinetic").max()))


def last_kinetic(outcome: Outcome) -> float:
    """Kinetic energy at the end [J/m]."""
    return float(outcome.energy("kinetic")[-1])


def closed_force(joint: int) -> Measure:
    """Measure of a joint's normal force [N/m]; joints that are closed, counted from 1."""

    def measure(outcome: Outcome) -> float:
        closed = [row for row in outcome.rows("joints") if row["state"] != "open"]
        return float(closed[joint - 1]["normal_force"])

    return measure


def normal(joint: int) -> Measure:
    """Measure of a joint's normal force [N/m]; joints counted from 0."""
    return lambda outcome: float(outcome.rows("joints")[joint]["normal_force"])


def support(outcome: Outcome) -> float:
    """Sum of the normal forces of all joints at height 0 [N/m]."""
    rows = outcome.rows("joints")
    heights = [max(abs(float(row["y_intrados"])), abs(float(row["y_extrados"]))) for row in rows]
    return sum(float(row["normal_force"]) for row, y in zip(rows, heights) if y < 1e-3)


def pull(outcome: Outcome) -> float:
    """By how much the most negative normal force is below zero [N/m]."""
    return max(0.0, -min(float(row["normal_force"]) for row in outcome.rows("joints")))


def sagging(outcome: Outcome) -> float:
    """Thrust of the two blocks of a voussoir beam over what the height that their sag has left asks for."""
    left = 0.5 + float(outcome.end(1)[1])
    return normal(0)(outcome) * 8.0 * left / (25000.0 * 0.5 * 4.0**2)


def load_share(area: float) -> Measure:
    """Measure of a load of 10 kN/m over the weight of an arch of an area [m2] at its critical unit weight."""
    return lambda outcome: 1e4 / (outcome.critical * area)


def associated_tilt(outcome: Outcome) -> float:
    """The limit of the push under the associated rule as the tilt of a table [deg]."""
    return math.degrees(math.atan(float(outcome.rows("results")[0]["exact_high"])))


def stretch(axis: int, factor: float) -> Measure:
    """Measure of the displacement of point 2 less that of point 1 at the end, times a factor [m]."""
    return lambda outcome: factor * float(outcome.end(2)[axis] - outcome.end(1)[axis])


def stress(component: int) -> Measure:
    """Measure of a component of the stress of block 1 [Pa]."""
    return lambda outcome: float(outcome.stress(1)[component])


def arrival(modulus: float) -> Measure:
    """Measure of the speed of a step of pressure, from the way of point 1 after it has passed [m/s].

    The point then moves at stress/(rho c); so its path shows when it began to.
    """
    speed = 1e5 / math.sqrt(modulus * 2500.0)

    def measure(outcome: Outcome) -> float:
        time, _, _, way, _ = outcome.track(1)[:, -1]
        return 1.95 / float(time - way / speed)

    return measure


def _about_mean(outcome: Outcome, point: int) -> np.ndarray:
    """Vertical way of a point about its mean under self-weight: (steps) [m]."""
    return np.asarray(outcome.track(point)[4] + 2500.0 * GRAVITY * 4.0 / (2.0 * YOUNG))


def lost_amplitude(outcome: Outcome) -> float:
    """Share of the amplitude of point 1 about its mean that a cycle takes."""
    swing = _about_mean(outcome, 1)
    inner = swing[1:-1]
    k = 1 + np.flatnonzero((inner >= swing[:-2]) & (inner > swing[2:]) & (inner > 0.0))
    tops = swing[k] + (swing[k + 1] - swing[k - 1]) ** 2 / (8.0 * (2.0 * swing[k] - swing[k - 1] - swing[k + 1]))
    return float(1.0 - (tops[-1] / tops[0]) ** (1.0 / (len(tops) - 1)))


def frequency(point: int) -> Measure:
    """Measure of a point's frequency about its mean, from its ways down through it [1/s]."""

    def measure(outcome: Outcome) -> float:
        time, swing = outcome.track(point)[0], _about_mean(outcome, point)
        k = np.flatnonzero((swing[:-1] > 0.0) & (swing[1:] <= 0.0))
        crossing = time[k] + (time[k + 1] - time[k]) * swing[k] / (swing[k] - swing[k + 1])
        return float((len(crossing) - 1) / (crossing[-1] - crossing[0]))

    return measure
