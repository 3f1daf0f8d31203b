"""Error and run time of blocks that move in time, against the length of the step."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from voussoir.deck.text import Groups, deck_text, merged
from voussoir_benches.checks import GRAVITY, Outcome
from voussoir_benches.deck_runs import Finished, run_deck, timed
from voussoir_benches.exact import next_amplitude, quarter_period, slide
from voussoir_benches.scene import BLOCKS, Corners, rectangle, written_block
from voussoir_benches.work_precision_scenes import ELASTIC, ORIGINAL, RIGID

#: Length of a step over that of the longest
SHARES = (1.0, 1.0 / 2.0, 1.0 / 4.0, 1.0 / 8.0, 1.0 / 16.0, 1.0 / 32.0)
#: Methods that are compared, and what their decks say
MOTION_METHODS: dict[str, Groups] = {
    ELASTIC: {},
    RIGID: {"analysis": {"unknowns": 3}},
    ORIGINAL: {
        "analysis": {"mode": "limerick", "restitution": None, "duration": None, "max_displacement_ratio": 0.01},
        "limerick": {"dynamic": True},
    },
}
#: Errors below this are rounding: they have no order
ROUNDING = 1e-9


@dataclass(frozen=True)
class MotionPoint:
    """One point of a diagram."""

    scene: str  #: What moves, and what is measured
    step: float  #: Longest step that was asked for [s]
    error: float  #: Relative error
    seconds: float  #: Median time
    steps: int  #: Steps that were made


@dataclass(frozen=True)
class Motion:
    """Blocks that move, and what of their motion is known."""

    blocks: str
    groups: dict[str, Any]
    duration: float
    longest: float
    checks: tuple[tuple[str, float, Callable[[Outcome], float]], ...]
    restitution: float = 0.0

    def deck(self, step: float, repeats: int, more: Groups) -> str:
        """The deck for one length of the step; further groups go before its own."""
        analysis = {
            "mode": "dynamic",
            "geometry": "current",
            "max_displacement_ratio": 1.0,
            "steps": 100000000,
            "time_step": step,
            "duration": self.duration,
            "restitution": self.restitution,
        }
        groups: dict[str, Any] = {
            "scene": {"kind": "blocks", "geometry": BLOCKS}, "analysis": analysis,
            "output": {"vtu": False, "joints": False, "blocks": False}, **self.groups,
            "sweep": {"parameter": "penalty_ratio", "values": [100.0] * repeats}}
        groups = merged(groups, more)
        if groups["analysis"]["mode"] == "limerick":  # its runs end with their steps
            groups["analysis"]["steps"] = math.ceil(self.duration / step)
        unused = [key for key, value in groups["analysis"].items() if value is None]
        for key in unused:
            del groups["analysis"][key]
        return deck_text(groups)

    def run(self, step: float, folder: Path, more: Groups, repeats: int) -> Finished:
        """Run one length of the step so many times."""
        deck = self.deck(step, repeats, more)
        return run_deck(deck, folder / "motion", files={BLOCKS: self.blocks})

    def outcome(self, finished: Finished) -> Outcome:
        """Results of the first case of a run."""
        return Outcome(finished.folder, 1)

    def steps(self) -> list[float]:
        """Lengths of the step [s]."""
        return [self.longest * share for share in SHARES]


def motion_points(folder: Path, repeats: int) -> Iterator[MotionPoint]:
    """Run every scene with every length of the step, so many times each: a point a quantity and length."""
    for motion in (_slide(), rocking(), _pendulum(), _bounce()):
        for step in motion.steps():
            finished, seconds = timed(functools.partial(motion.run, step, folder, {}), repeats)
            if not finished.rows or finished.rows[0]["verdict"] != "completed":
                continue
            outcome = motion.outcome(finished)
            for name, exact, measure in motion.checks:
                error = abs(measure(outcome) / exact - 1.0)
                yield MotionPoint(name, step, error, seconds, int(finished.rows[0]["steps"]))


def order(points: list[MotionPoint]) -> float | None:
    """Order of convergence: slope of the logarithm of the error by that of the step; None where errors are rounding."""
    known = [point for point in points if point.error > ROUNDING]
    if len(known) < 2:
        return None
    steps, errors = np.log([(point.step, point.error) for point in known]).T
    return float(np.polyfit(steps, errors, 1)[0])


def _slide() -> Motion:
    """A block that slides down 30 degrees with friction 20 for a second."""
    text = written_block(rectangle(-2.0, -1.0, 16.0, 1.0), "fixed")
    text += written_block(rectangle(0.0, 0.0, 2.0, 0.5)) + "measure 1.0 0.25\n"
    way: Callable[[Outcome], float] = lambda outcome: float(outcome.end(1)[0])  # noqa: E731
    groups = {"joint": {"friction_deg": 20.0}, "load": {"gravity_direction_deg": -60.0}, "material": {"young": 5e12}}
    return Motion(text, groups, 1.0, 0.04, (("incline: way", slide(30.0, 20.0) / 2.0, way),))


def rocking() -> Motion:
    """Housner's block of 0.5 x 1.0 m, let go at half of its angle."""
    width, height = 0.5, 1.0
    angle = math.atan2(width, height)
    tilted = _turned(rectangle(0.0, 0.0, width, height), -angle / 2.0, (width, 0.0))
    text = written_block(rectangle(-3.0, -1.0, 7.0, 1.0), "fixed") + written_block(tilted)
    # in the middle of the foot and of the head
    for y in (0.05, 0.95):
        text += _measured(_turned([(width / 2.0, y)], -angle / 2.0, (width, 0.0))[0])

    def tilt(outcome: Outcome) -> np.ndarray:
        return outcome.direction(1, 2) - math.pi / 2.0

    def upright(outcome: Outcome) -> float:
        return _crossing(outcome, tilt(outcome))

    def swing(outcome: Outcome) -> float:
        return float(tilt(outcome).max() / angle)

    exact = quarter_period(width / 2.0, height / 2.0, 0.5)
    other = next_amplitude(width / 2.0, height / 2.0, 0.5)
    checks = (("rocking: quarter period", exact, upright), ("rocking: next tilt", other, swing))
    groups = {"joint": {"friction_deg": 78.0}, "material": {"young": 5e12}}
    return Motion(text, groups, 0.75, 0.008, checks)


def _pendulum() -> Motion:
    """A bar of 1 m held at the middle of its upper end, let go at 60 degrees."""
    width, height, amplitude = 0.1, 1.0, math.pi / 3.0
    hanging = rectangle(-width / 2.0, -height, width, height)
    text = written_block(_turned(hanging, amplitude, (0.0, 0.0))) + "fix 0 0\nmeasure 0 0\n"
    text += _measured(_turned([(0.0, -height)], amplitude, (0.0, 0.0))[0])
    gyration = (width**2 + height**2) / 12.0 + height**2 / 4.0
    frequency = math.sqrt(GRAVITY * height / 2.0 / gyration)

    def angle(outcome: Outcome) -> np.ndarray:
        return outcome.direction(1, 2) + math.pi / 2.0

    def quarter(outcome: Outcome) -> float:
        return _crossing(outcome, angle(outcome))

    def swing(outcome: Outcome) -> float:
        return float(-angle(outcome).min())

    exact = pendulum_quarter(amplitude, frequency)
    checks = (("pendulum: quarter period", exact, quarter), ("pendulum: next amplitude", amplitude, swing))
    return Motion(text, {"material": {"young": 1e12}}, 1.2, 0.016, checks)


def _bounce() -> Motion:
    """A cube dropped from 1 m with restitution 0.8, at its second top."""
    restitution = 0.8
    text = written_block(rectangle(-3.0, -1.0, 7.0, 1.0), "fixed")
    text += written_block(rectangle(0.0, 1.0, 1.0, 1.0)) + "measure 0.5 1.5\n"
    time = math.sqrt(2.0 / GRAVITY) * (1.0 + 2.0 * restitution + restitution**2)
    height: Callable[[Outcome], float] = lambda outcome: 1.0 + float(outcome.end(1)[1])  # noqa: E731
    checks = (("bounce: second top", restitution**4, height),)
    return Motion(text, {"material": {"young": 5e12}}, time, 0.064, checks, restitution)


def pendulum_quarter(amplitude: float, frequency: float) -> float:
    """A quarter of a pendulum's period by the arithmetic-geometric mean of Gauss [s].

    Its largest angle in rad, the frequency of small swings in rad/s.
    """
    a, b = 1.0, math.cos(amplitude / 2.0)
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2.0, math.sqrt(a * b)
    return math.pi / (2.0 * a * frequency)


def _crossing(outcome: Outcome, values: np.ndarray) -> float:
    """Time at which values first change their sign [s]."""
    time = outcome.track(2)[0]
    k = int(np.flatnonzero(values * values[0] < 0.0)[0])
    # a straight line between steps errs by the square of the step; Hermite's cubic by its fourth
    slope = np.gradient(values, time)
    return _root(time[k - 1 : k + 1], values[k - 1 : k + 1], slope[k - 1 : k + 1])


def _root(time: np.ndarray, value: np.ndarray, slope: np.ndarray) -> float:
    """Root of the cubic through two values with two slopes, by bisection."""
    width = time[1] - time[0]
    low, high = 0.0, 1.0
    for _ in range(60):
        s = (low + high) / 2.0
        found = (
            (1.0 + 2.0 * s) * (1.0 - s) ** 2 * value[0]
            + s * (1.0 - s) ** 2 * width * slope[0]
            + s**2 * (3.0 - 2.0 * s) * value[1]
            + s**2 * (s - 1.0) * width * slope[1]
        )
        low, high = (s, high) if found * value[0] > 0.0 else (low, s)
    return float(time[0] + low * width)


def _turned(corners: Corners, angle: float, centre: tuple[float, float]) -> Corners:
    """Points turned anticlockwise about a centre."""
    c, s = math.cos(angle), math.sin(angle)
    x0, y0 = centre
    return [(x0 + c * (x - x0) - s * (y - y0), y0 + s * (x - x0) + c * (y - y0)) for x, y in corners]


def _measured(point: tuple[float, float]) -> str:
    """A measured point as the file of blocks writes it."""
    return f"measure {point[0]!r} {point[1]!r}\n"
