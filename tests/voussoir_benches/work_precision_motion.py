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
from voussoir_benches import exact, measures
from voussoir_benches.checks import GRAVITY, Outcome
from voussoir_benches.deck_runs import Finished, run_deck, timed
from voussoir_benches.scene import BLOCKS, Corners, rectangle, written_block
from voussoir_benches.tables import rows
from voussoir_benches.work_precision_scenes import ELASTIC, ORIGINAL, RIGID

SHARES = (1.0, 1.0 / 2.0, 1.0 / 4.0, 1.0 / 8.0, 1.0 / 16.0, 1.0 / 32.0)  #: Length of a step over that of the longest
#: Methods that are compared, and what their decks say
MOTION_METHODS: dict[str, Groups] = {
    ELASTIC: {},
    RIGID: {"analysis": {"unknowns": 3}},
    ORIGINAL: {
        "analysis": {"mode": "limerick", "restitution": None, "duration": None, "max_displacement_ratio": 0.01},
        "limerick": {"dynamic": True},
    },
}
ROUNDING = 1e-9  #: Errors below this are rounding: they have no order


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
    checks: list[tuple[str, float, Callable[[Outcome], float]]]
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
    for motion in motions():
        for step in motion.steps():
            finished, seconds = timed(functools.partial(motion.run, step, folder, {}), repeats)
            if not finished.rows or finished.rows[0]["verdict"] != "completed":
                continue
            outcome = motion.outcome(finished)
            for name, answer, measure in motion.checks:
                error = abs(measure(outcome) / answer - 1.0)
                yield MotionPoint(name, step, error, seconds, int(finished.rows[0]["steps"]))


def order(points: list[MotionPoint]) -> float | None:
    """Order of convergence: slope of the logarithm of the error by that of the step; None where errors are rounding."""
    known = [point for point in points if point.error > ROUNDING]
    if len(known) < 2:
        return None
    steps, errors = np.log([(point.step, point.error) for point in known]).T
    return float(np.polyfit(steps, errors, 1)[0])


def motions() -> list[Motion]:
    """The rows of work_precision_motion.json: a slide, a rocking block, a pendulum, a cube that bounces."""
    names = {
        **vars(exact), **vars(measures), "GRAVITY": GRAVITY, "block": written_block, "rectangle": rectangle,
        "turned": _turned, "measured": _measured, "crossing": crossing, "largest": largest,
        "pendulum_quarter": pendulum_quarter}
    return [
        Motion("".join(row["blocks"]), row["deck"], row["duration"], row["longest"], row["checks"],
               row.get("restitution", 0.0))
        for row in rows("work_precision_motion.json", names)]


def rocking() -> Motion:
    """Housner's block of 0.5 x 1.0 m, let go at half of its angle."""
    return motions()[1]


def pendulum_quarter(amplitude: float, frequency: float) -> float:
    """A quarter of a pendulum's period by the arithmetic-geometric mean of Gauss [s].

    Its largest angle in rad, the frequency of small swings in rad/s.
    """
    a, b = 1.0, math.cos(amplitude / 2.0)
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2.0, math.sqrt(a * b)
    return math.pi / (2.0 * a * frequency)


def largest(start: float, sign: float, scale: float) -> Callable[[Outcome], float]:
    """Measure of the largest angle from points 1 to 2 less its start [rad], to one side, over a scale."""
    return lambda outcome: float((sign * (outcome.direction(1, 2) - start)).max() / scale)


def crossing(start: float) -> Callable[[Outcome], float]:
    """Measure of the time at which the angle from points 1 to 2 first is its start [s]."""

    def measure(outcome: Outcome) -> float:
        values, time = outcome.direction(1, 2) - start, outcome.track(2)[0]
        k = int(np.flatnonzero(values * values[0] < 0.0)[0])
        # a straight line between steps errs by the square of the step; Hermite's cubic by its fourth
        slope = np.gradient(values, time)
        return _root(time[k - 1 : k + 1], values[k - 1 : k + 1], slope[k - 1 : k + 1])

    return measure


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
