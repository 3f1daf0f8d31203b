"""Scenes that stand or fall, and single blocks under load: sections 1.3 and 1.6 to 1.8."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from voussoir.validation_scene import (
    GRAVITY,
    YOUNG,
    Check,
    Outcome,
    Scene,
    critical,
    verdict,
)

TOPPLING = "Blocks that topple"
STRAIN = "Strain of single blocks"
ASSEMBLIES = "Assemblies"
ARCHES = "Arches"

DEGREE = math.pi / 180.0
#: Weight of the decks that set it [N/m3]
_WEIGHT = 25000.0
MOVED = ("analysis%geometry=current",)


def foot_acceleration(b: float, h: float, slope: float, friction: float) -> float:
    """Acceleration of the foot down the slope of a block that begins to topple [m/s2].

    Width b along the slope and height h; the foot slides where the ratio of the forces on a foot
    that does not would be more than the friction, as in tan(phi_c) of Yagoda-Biran and Hatzor.

    Parameters
    ----------
    b, h : float
        Width and height [m].
    slope, friction : float
        Angle of the slope [rad] and coefficient of friction.
    """
    # unknowns: acceleration of the foot, acceleration of turn down the slope, normal force; mass 1
    inertia = (b**2 + h**2) / 12.0
    sine, cosine = GRAVITY * math.sin(slope), GRAVITY * math.cos(slope)
    rolling = [
        [1.0, h / 2.0, friction],
        [0.0, b / 2.0, -1.0],
        [0.0, inertia, b / 2.0 - friction * h / 2.0],
    ]
    found = np.linalg.solve(rolling, [sine, -cosine, 0.0])
    return max(0.0, float(found[0]))


def _foot(outcome: Outcome) -> float:
    """Mean acceleration down 30 degrees of point 1 from rest [m/s2]."""
    time = outcome.track(1)[0, -1]
    return float(outcome.end(1) @ (math.cos(30 * DEGREE), -math.sin(30 * DEGREE))) * 2.0 / time**2


def _both(section: str, deck: str, source: str, checks, moved: float) -> list[Scene]:
    """A critical deck in reference geometry, and with blocks that move and strain."""
    rigid = tuple(critical(what, exact, 2e-8, case) for case, (what, exact) in enumerate(checks, 1))
    elastic = tuple(dataclasses.replace(check, accept=moved) for check in rigid)
    return [Scene(section, deck, source, rigid), Scene(section, deck, source, elastic, MOVED)]


def _toppling() -> list[Scene]:
    """Scenes of section 1.3."""
    tilt = math.tan(math.atan(0.25) - 10 * DEGREE)
    feet = tuple(
        Check(
            f"acceleration of the foot, friction {phi} deg [m/s2]",
            foot_acceleration(0.25, 1.0, 30 * DEGREE, math.tan(phi * DEGREE)),
            _foot,
            1e-2,
            case,
            scale=foot_acceleration(0.25, 1.0, 30 * DEGREE, math.tan(17.1268 * DEGREE)),
        )
        for case, phi in enumerate((17.1268, 19.1268), 1)
    )
    across = [("force across gravity over weight", tilt)]
    column = [("horizontal force over weight", 0.2)]
    push = [("horizontal force over weight, tan phi 0.7", 0.5), ("the same, tan phi 0.3", 0.3)]
    scenes = [
        *_both(TOPPLING, "toppling", "tan(atan(b/h) - a)", across, 1e-4),
        *_both(TOPPLING, "push", "min(mu, b/h)", push, 1e-4),
        *_both(TOPPLING, "column", "b/h", column, 1e-4),
        Scene(TOPPLING, "toppling_onset", "phi_c 18.1268 deg; onset by Newton", feet, rate=True),
    ]
    for deck, state in (("overhang_stands", "stable"), ("overhang_falls", "collapsed")):
        what = f"five blocks at {'0.99' if state == 'stable' else '1.01'} of L/2 sum 1/k"
        state_check = (verdict(state, what),)
        scenes += [Scene(TOPPLING, deck, "harmonic", state_check, more) for more in ((), MOVED)]
    slope = (
        verdict("stable", "40 deg", 1),
        verdict("collapsed", "32.9 deg", 5),
        verdict("collapsed", "30 deg", 6),
    )
    source = "Goodman and Bray 1976: 38.15; limit analysis: 33.4"
    return scenes + [Scene(TOPPLING, "goodman_bray", source, slope, more) for more in ((), MOVED)]


def _strains() -> list[Scene]:
    """Scenes of section 1.6."""
    nu, pressed = 0.2, 1e6 / YOUNG
    across = lambda outcome: 2.0 * float(outcome.end(2)[0] - outcome.end(1)[0])  # noqa: E731
    along = lambda outcome: float(outcome.end(2)[1] - outcome.end(1)[1])  # noqa: E731
    pressed_checks = (
        Check("ey, plane stress", -pressed, along, 1e-9, 1),
        Check("ex, plane stress", nu * pressed, across, 1e-9, 1),
        Check("ey, plane strain", -(1.0 - nu**2) * pressed, along, 1e-9, 2),
        Check("ex, plane strain", nu * (1.0 + nu) * pressed, across, 1e-9, 2),
    )
    # points at 1 and 9 m of the 10 m
    shorter = lambda outcome: along(outcome) * 10.0 / 8.0  # noqa: E731
    load = 2500.0 * GRAVITY * 100.0 / 2.0
    bar = tuple(
        Check(f"shortening, E = {young:g} Pa [m]", -load / young, shorter, 1e-6, case)
        for case, young in enumerate((5e9, 5e11), 1)
    )
    frequency = math.sqrt(3.0 * YOUNG / 2500.0) / (2.0 * math.pi * 2.0)
    swing = (Check("frequency, 1.10266 of the bar's [1/s]", frequency, _frequency, 1e-3),)
    return [
        *(Scene(STRAIN, "uniaxial", "Hooke", pressed_checks, more) for more in ((), MOVED)),
        *(Scene(STRAIN, "bar_own_weight", "rho g HH/(2E)", bar, more) for more in ((), MOVED)),
        Scene(STRAIN, "bar_swings", "sqrt(3E/rho)/(2 pi H)", swing, rate=True),
    ]


def _frequency(outcome: Outcome) -> float:
    """Frequency of point 1 about its mean displacement, from its ways down through it [1/s]."""
    time, _, _, _, v = outcome.track(1)
    swing = v + 2500.0 * GRAVITY * 4.0 / (2.0 * YOUNG)
    k = np.flatnonzero((swing[:-1] > 0.0) & (swing[1:] <= 0.0))
    crossing = time[k] + (time[k + 1] - time[k]) * swing[k] / (swing[k] - swing[k + 1])
    return float((len(crossing) - 1) / (crossing[-1] - crossing[0]))


def _assemblies() -> list[Scene]:
    """Scenes of section 1.7."""
    cohesion = 12500.0 * (math.sin(40 * DEGREE) - math.cos(40 * DEGREE) * math.tan(25 * DEGREE))
    wedges = 250.0 * math.tan(15 * DEGREE) / math.tan(20 * DEGREE)
    lintel = [("horizontal force over weight", 1.0 / 3.0)]
    force = "normal force of joint {} [N/m]"
    stack = tuple(
        Check(force.format(k + 1), _WEIGHT * (10 - k), _normal(k), 1e-8) for k in (0, 4, 9)
    )
    smooth = _WEIGHT * math.tan(30 * DEGREE) / (2.0 * math.sin(30 * DEGREE))
    notch = tuple(Check(force.format(k + 1), smooth, _normal(k), 1e-8) for k in (0, 1))
    scenes = []
    for more in ((), MOVED):
        scenes.append(Scene(ASSEMBLIES, "stack", "weight above", stack, more))
        scenes.append(Scene(ASSEMBLIES, "wedge_in_notch", "W/(2 sin b)", notch, more))
    source = "W1 tan(a1 - phi) = W2 tan(phi - a2)"
    passive = [("unit weight of the passive wedge [N/m3]", wedges)]
    scenes += _both(ASSEMBLIES, "two_wedges", source, passive, 1e-4)
    source = "W (sin a - cos a tan phi)/A"
    held = [("cohesion [Pa]", cohesion)]
    scenes += _both(ASSEMBLIES, "slide_with_cohesion", source, held, 1e-4)
    scenes += _both(ASSEMBLIES, "post_and_lintel", "limit analysis", lintel, 1e-4)
    four = (verdict("stable", "reference geometry"), verdict("stable", "current geometry", 2))
    scenes.append(Scene(ASSEMBLIES, "four_corners", "stands", four))
    for deck, limit in (("dry_wall_2x4", 34.6551), ("dry_wall_4x8", 31.2911)):
        what = "tilt, Coulomb friction 0 to 2 deg below the dilatant limit [deg]"
        above = Check("tilt beyond that limit [deg]", 0.0, _beyond(limit), 1e-3, scale=1.0)
        wall = (Check(what, limit, _tilt, 2.0, scale=1.0), above)
        scenes.append(Scene(ASSEMBLIES, deck, "limit analysis", wall, slow=deck.endswith("4x8")))
    return scenes


def _tilt(outcome: Outcome) -> float:
    """Critical push as the tilt of a table [deg]."""
    return math.degrees(math.atan(outcome.critical))


def _beyond(limit: float):
    """Measure of by how much the critical tilt is more than a limit [deg]."""
    return lambda outcome: max(0.0, _tilt(outcome) - limit)


def _normal(joint: int):
    """Measure of a joint's normal force [N/m]."""
    return lambda outcome: float(outcome.rows("joints")[joint]["normal_force"])


def _critical(outcome: Outcome) -> float:
    """Critical value of the outcome."""
    return outcome.critical


def _arches() -> list[Scene]:
    """Scenes of section 1.8."""
    thickness = {
        4: 0.097361,
        5: 0.094980,
        6: 0.104134,
        8: 0.099972,
        9: 0.101525,
        11: 0.104589,
        12: 0.104857,
        13: 0.102526,
        17: 0.105462,
        20: 0.107348,
        27: 0.106721,
        30: 0.107410,
        40: 0.107432,
    }
    rows = tuple(
        Check(f"least t/R of {n} voussoirs", exact, _critical, 1e-6, case, scale=1.0)
        for case, (n, exact) in enumerate(thickness.items(), 1)
    )
    states = tuple(
        verdict(state, what, case)
        for case, (state, what) in enumerate(
            (
                ("collapsed", "t/R 0.25, friction 0.28"),
                ("stable", "t/R 0.25, friction 0.34"),
                ("collapsed", "t/R 0.12, friction 0.34"),
                ("stable", "t/R 0.12, friction 0.42"),
            ),
            1,
        )
    )
    scenes = [
        Scene(ARCHES, "arch_polygons", "limit analysis, six digits", rows),
        Scene(ARCHES, "arch_friction", "limit analysis", states),
    ]
    for deck in ("lateral_arch", "lateral_arch_blocks"):
        for more, accept in (((), 2e-6), (MOVED, 1e-3)):
            push = (critical("horizontal force over weight", 0.373612, accept),)
            scenes.append(Scene(ARCHES, deck, "limit analysis, six digits", push, more))
    return scenes


#: Every scene of this module
SCENES = (*_toppling(), *_strains(), *_assemblies(), *_arches())
