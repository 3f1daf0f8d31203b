"""Scenes of blocks that topple: section 1.3."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from voussoir_benches.checks import GRAVITY, Check, Outcome, critical, verdict
from voussoir_benches.scene import Scene, benchmark, benchmark_in_both

TOPPLING = "Toppling"

DEGREE = math.pi / 180.0
#: Decks of blocks that begin to topple: width, height [m], slope and the literature's angle [deg]
ONSETS = (
    ("toppling_onset", 0.25, 1.0, 30.0, 18.1268),
    ("toppling_onset_40", 0.4, 1.0, 30.0, 23.8643),
    ("toppling_onset_50", 0.5, 1.0, 30.0, 27.4248),
    ("toppling_onset_stocky", 1.0, 1.2, 45.0, 41.1075),
)


def foot_acceleration(b: float, h: float, slope: float, friction: float) -> float:
    """Acceleration of the foot down the slope of a block that begins to topple [m/s2].

    Of width b along the slope [rad] and height h [m]. The foot slides where the ratio of the forces on a foot that
    does not would be more than the coefficient of friction, as in tan(phi_c) of Yagoda-Biran and Hatzor.
    """
    # unknowns: acceleration of the foot, acceleration of turn down the slope, normal force; mass 1
    inertia = (b**2 + h**2) / 12.0
    sine, cosine = GRAVITY * math.sin(slope), GRAVITY * math.cos(slope)
    rolling = [[1.0, h / 2.0, friction], [0.0, b / 2.0, -1.0], [0.0, inertia, b / 2.0 - friction * h / 2.0]]
    found = np.linalg.solve(rolling, [sine, -cosine, 0.0])
    if found[1] < 0.0:
        # it does not topple
        return max(0.0, sine - friction * cosine)
    return max(0.0, float(found[0]))


def _foot(slope_deg: float) -> Callable[[Outcome], float]:
    """Measure of the mean acceleration of point 1 from rest along its ground [m/s2]."""

    def measure(outcome: Outcome) -> float:
        way = outcome.end(1) @ (math.cos(slope_deg * DEGREE), -math.sin(slope_deg * DEGREE))
        return float(way * 2.0 / outcome.track(1)[0, -1] ** 2)

    return measure


def _onset(deck: str, b: float, h: float, slope: float, limit: float) -> Scene:
    """A block that begins to topple, friction a degree below and above what lets its foot slide."""
    # the first deck has a slope, the others turn gravity
    foot = _foot(slope if deck == "toppling_onset" else 0.0)
    friction = [limit - 1.0, limit + 1.0]
    exact = [foot_acceleration(b, h, slope * DEGREE, math.tan(phi * DEGREE)) for phi in friction]
    what = "acceleration of the foot, friction {:.4f} deg [m/s2]"
    checks = tuple(Check(what.format(friction[k]), exact[k], foot, 5e-3, k + 1, scale=exact[0]) for k in range(2))
    return benchmark(TOPPLING, deck, f"phi_c {limit} deg; onset by Newton", *checks, rate=True)


#: Stacks that lean out a little less and a little more than they can
_OVERHANGS = (
    ("overhang_stands", "stable", "five blocks, 0.99 of the limit"),
    ("overhangs_stand", "stable", "one to four blocks, 0.99 of the limit"),
    ("overhang_of_one_falls", "collapsed", "one block, 1.01 of the limit"),
    ("overhang_of_two_falls", "collapsed", "two blocks, 1.01 of the limit"),
    ("overhang_of_three_falls", "collapsed", "three blocks, 1.01 of the limit"),
    ("overhang_of_four_falls", "collapsed", "four blocks, 1.01 of the limit"),
    ("overhang_falls", "collapsed", "five blocks, 1.01 of the limit"),
)


def _toppling() -> Iterator[Scene]:
    """Scenes of section 1.3."""
    tilt = math.tan(math.atan(0.25) - 10 * DEGREE)
    force = "horizontal force over weight"
    for deck, source, *checks in (
        ("toppling", "tan(atan(b/h) - a)", critical("transverse force over weight", tilt, 2e-8)),
        ("push", "min(mu, b/h)", critical(f"{force}, tan phi 0.7", 0.5, 2e-8),
         critical(f"{force}, tan phi 0.3", 0.3, 2e-8, 2)),
        ("column", "b/h", critical(force, 0.2, 2e-8)),
    ):
        yield from benchmark_in_both(TOPPLING, deck, source, *checks, moved=1e-4)
    for onset in ONSETS:
        yield _onset(*onset)
    for deck, state, what in _OVERHANGS:
        yield from benchmark_in_both(TOPPLING, deck, "overhang L/2 sum 1/k", verdict(state, what))
    yield from benchmark_in_both(
        TOPPLING, "goodman_bray", "Goodman and Bray 1976: 38.15; limit analysis: 33.4",
        verdict("stable", "40 deg", 1), verdict("collapsed", "32.9 deg", 5), verdict("collapsed", "30 deg", 6))


#: Every scene of this module
SCENES = tuple(_toppling())
