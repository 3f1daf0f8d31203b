"""Scenes of blocks that rock, bounce and collide: sections 1.4 and 1.5."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from voussoir_benches.checks import DENSITY, GRAVITY, YOUNG, Check, Outcome
from voussoir_benches.scene import Scene, benchmark

ROCKING = "Rocking"
IMPACT = "Impact and energy"

#: Columns of energy.csv that are stored, and the ones that are gone
_STORED = ("kinetic", "elastic", "contact", "gravity")


def quarter_period(b: float, h: float, share: float) -> float:
    """Time from rest at a share of the block's angle to upright, by quadrature [s]; half width and half height in m.

    The speed is that of Housner's block, w^2 = 2 p^2 (cos(a - t0) - cos(a - t)); with t = t0 - s^2 the integrand of ds
    is smooth.
    """
    angle = math.atan2(b, h)
    start = share * angle
    node, weight = np.polynomial.legendre.leggauss(60)
    end = math.sqrt(start)
    s = end * (node + 1.0) / 2.0
    # cos(a - t0) - cos(a - t) as a product, which keeps its digits near the start
    half = s**2 / 2.0
    square = 4.0 * _p2(b, h) * np.sin(half) * np.sin(angle - start + half)
    return float((weight * 2.0 * s / np.sqrt(square)).sum() * end / 2.0)


def next_amplitude(b: float, h: float, share: float) -> float:
    """Tilt after the first impact over the block's angle: the moment about the new foot is kept."""
    angle = math.atan2(b, h)
    kept = (1.0 - 1.5 * math.sin(angle) ** 2) ** 2
    fall = math.cos(angle * (1.0 - share)) - math.cos(angle)
    return 1.0 - math.acos(math.cos(angle) + kept * fall) / angle


def _p2(b: float, h: float) -> float:
    """Housner's p^2 = 3g/(4R)."""
    return 3.0 * GRAVITY / (4.0 * math.hypot(b, h))


def _upright(block: int) -> Callable[[Outcome], float]:
    """Measure of the time at which a tilted block is first upright."""

    def measure(outcome: Outcome) -> float:
        tilt = outcome.direction(2 * block - 1, 2 * block) - math.pi / 2.0
        time = outcome.track(2 * block)[0]
        beyond = np.flatnonzero(tilt <= 0.0)
        if len(beyond) == 0 or beyond[0] == 0:
            return math.nan
        k = beyond[0]
        return float(time[k - 1] + (time[k] - time[k - 1]) * tilt[k - 1] / (tilt[k - 1] - tilt[k]))

    return measure


def _swing(block: int, angle: float) -> Callable[[Outcome], float]:
    """Measure of the largest tilt to the other side over the block's angle."""
    return lambda outcome: float(-(outcome.direction(2 * block - 1, 2 * block) - math.pi / 2.0).min() / angle)


def largest_rise(outcome: Outcome) -> float:
    """Largest rise of stored energy in a step [J/m]."""
    return float(max(0.0, np.diff(outcome.energy(*_STORED)).max()))


def _rocking() -> list[Scene]:
    """Three blocks, each let go at three tilts."""
    scenes = []
    for deck, b, h in (("rocking_stocky", 0.25, 0.5), ("rocking_slender", 0.2, 1.0), ("rocking_tall", 0.25, 1.0)):
        checks = []
        for block, share in enumerate((0.25, 0.5, 0.75), 1):
            start = f"from {share} of the angle"
            exact = quarter_period(b, h, share)
            checks.append(Check(f"quarter period {start} [s]", exact, _upright(block), 1e-5))
            exact = next_amplitude(b, h, share)
            swing = _swing(block, math.atan2(b, h))
            checks.append(Check(f"next amplitude {start}", exact, swing, 1e-3))
        source = "Housner 1963, nonlinear"
        scenes.append(benchmark(ROCKING, deck, source, *checks, rate=True))
    pulses = (("pulse_rocks", 0.98, "rocks"), ("pulse_overturns", 1.02, "overturns"))
    for deck, share, falls in pulses:
        what = f"0.3 g for {share} of 0.40905 s"
        check = Check(what, falls, _fate(1, 0.2, 1.0))
        scenes.append(benchmark(ROCKING, deck, "equation of rocking, integrated numerically", check))
    checks = []
    for k, (b, h, push, time) in enumerate(PULSES):
        for i, (share, falls) in enumerate(((0.98, "rocks"), (1.02, "overturns")), 1):
            what = f"{2 * b:g} x {2 * h:g} m: {push:g} g for {share} of {time} s"
            checks.append(Check(what, falls, _fate(2 * k + i, b, h)))
    return [*scenes, benchmark(ROCKING, "pulses", "equation of rocking, integrated numerically", *checks, slow=True)]


#: Half width, half height [m], push [g] and the time that overturns the block [s]
PULSES = (
    (0.2, 1.0, 0.3, 0.40905),
    (0.2, 1.0, 0.4, 0.25843),
    (0.2, 1.0, 0.6, 0.15135),
    (0.25, 1.0, 0.375, 0.41125),
    (0.25, 1.0, 0.5, 0.26001),
    (0.25, 1.0, 0.75, 0.15238),
    (0.25, 0.5, 0.75, 0.30266),
    (0.25, 0.5, 1.0, 0.19242),
)


def _fate(block: int, b: float, h: float) -> Callable[[Outcome], str]:
    """Measure of whether a block has ever been tilted far beyond its angle."""

    def measure(outcome: Outcome) -> str:
        tilt = outcome.direction(2 * block - 1, 2 * block) - math.pi / 2.0
        return "overturns" if np.abs(tilt).max() > 1.5 * math.atan2(b, h) else "rocks"

    return measure


def _period(outcome: Outcome) -> float:
    """Time between the first two blows on the ground 1 m below the start [s].

    Taken from the parabola through three steps of the flight between them.
    """
    time, _, _, _, v = outcome.track(1)
    blows = 1 + np.flatnonzero((v[1:-1] < v[:-2]) & (v[1:-1] < v[2:]))
    steps = [blows[0] + 1, (blows[0] + blows[1]) // 2, blows[1] - 1]
    roots = np.roots(np.polyfit(time[steps] - time[steps[1]], v[steps] + 1.0, 2))
    return float(abs(roots[0] - roots[1]))


def _bounces() -> list[Scene]:
    """A block dropped from 1 m, and two that meet head-on."""
    height = lambda outcome: 1.0 + float(outcome.end(1)[1])  # noqa: E731
    # without rebound the centre stays where the block's own weight presses it
    rest = -DENSITY * GRAVITY / (4.0 * YOUNG)
    tops = (
        Check("height at rest, e = 0 [m]", rest, height, 1e-6, 1, scale=1.0),
        *(
            Check(f"height at the second top, e = {e} [m]", e**4, height, 1e-6, case, scale=1.0)
            for case, e in enumerate((0.5, 0.8, 1.0), 2)
        ),
    )
    flight = 2.0 * math.sqrt(2.0 / GRAVITY)
    period = Check("time between impacts, e = 1.0 [s]", flight, _period, 1e-6, 4)
    fall = DENSITY * GRAVITY
    rise = "largest gain of energy per step over the fall, e = {}"
    rises = tuple(
        Check(rise.format(e), 0.0, largest_rise, 1e-9, case, fall) for case, e in enumerate((0.0, 0.5, 0.8, 1.0), 1)
    )
    met = []
    for case, e in enumerate((0.0, 0.5, 1.0), 1):
        for block, exact in ((1, 0.0 - 2.0 * e), (2, e)):
            speed = lambda outcome, block=block: float(outcome.velocity(block)[0])  # noqa: E731
            what = f"velocity of block {block}, e = {e} [m/s]"
            met.append(Check(what, exact, speed, 1e-6, case, scale=3.0))
    never = Check("largest gain of energy per step [J/m]", 0.0, largest_rise, 1e-6, scale=1.0)
    return [
        benchmark(IMPACT, "bounce", "e^(2n) H", *tops, period, *rises, rate=True),
        benchmark(IMPACT, "collision", "v1 - (1 + e) m2/(m1 + m2) (v1 - v2)", *met, rate=True),
        benchmark(IMPACT, "momentum", "no gain of energy", never),
    ]


#: Every scene of this module
SCENES = (*_rocking(), *_bounces())
