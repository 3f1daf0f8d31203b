"""Exact answers of scenes whose formulas are longer than a line of a table."""

from __future__ import annotations

import math

import numpy as np

from voussoir_benches.checks import DENSITY, GRAVITY, YOUNG

DEGREE = math.pi / 180.0
#: Axial frequency of the block of 2 m of `bar_swings` [1/s]
BAR_FREQUENCY = math.sqrt(3.0 * YOUNG / 2500.0) / (2.0 * math.pi * 2.0)
#: Decks of blocks that begin to topple: width, height [m], slope and the literature's angle [deg]
ONSETS = (
    ("toppling_onset", 0.25, 1.0, 30.0, 18.1268), ("toppling_onset_40", 0.4, 1.0, 30.0, 23.8643),
    ("toppling_onset_50", 0.5, 1.0, 30.0, 27.4248), ("toppling_onset_stocky", 1.0, 1.2, 45.0, 41.1075))
#: Blocks of the deck `momentum`: width and height [m], velocity [m/s], spin [rad/s]
THROWN = (
    ((1.0, 0.8), (2.0, 0.3), 0.5), ((1.2, 1.0), (-1.0, 0.0), -0.3), ((0.7, 0.9), (0.2, -1.5), 0.0),
    ((0.8, 0.8), (0.0, 1.4), 1.0))


def slide(slope_deg: float, friction_deg: float, up: bool = False) -> float:
    """Acceleration down a slope of a block that slides down, or up [m/s2]."""
    slope, friction = math.radians(slope_deg), math.radians(friction_deg)
    rub = math.cos(slope) * math.tan(friction)
    return GRAVITY * (math.sin(slope) + (rub if up else -rub))


def momentum() -> float:
    """Sum of the sizes of the momentums of the thrown blocks [kg m/s per metre depth]."""
    return sum(DENSITY * w * h * math.hypot(*v) for (w, h), v, _ in THROWN)


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


def in_notch(friction_deg: float) -> float:
    """Force on either side of the wedge in a notch of 60 degrees that is about to slip down."""
    mu = math.tan(friction_deg * DEGREE)
    weight = 25000.0 * math.tan(30 * DEGREE)
    return weight / (2.0 * (math.sin(30 * DEGREE) + mu * math.cos(30 * DEGREE)))


def roof_wedge(half_angle_deg: float, friction_deg: float, stiffness: float, swell: float) -> float:
    """Weight that pulls a wedge 1 m high out of a roof that presses it from the sides [N/m].

    Each side has a normal stiffness of two springs and a shear stiffness of one. The wedge swells
    evenly and moves to where the forces on it balance; then its weight grows until it slips:
    2 H0 (ks cos^2 a + kn sin^2 a) sin(phi - a)/(ks cos a cos phi + kn sin a sin phi) with the
    horizontal force H0 of a side before (Brady and Brown).

    Parameters
    ----------
    half_angle_deg, friction_deg : float
        Half the angle at the top, friction angle [deg].
    stiffness : float
        Stiffness of a spring [N/m per metre depth].
    swell : float
        Strain along x and y that the wedge would have if it were free.
    """
    a, phi = half_angle_deg * DEGREE, friction_deg * DEGREE
    cosine, sine = math.cos(a), math.sin(a)
    kn, ks = 2.0 * stiffness, stiffness
    normal = kn * swell * 2.0 / 3.0 * sine
    shear = -ks * swell * (cosine / 6.0 - math.tan(a) / 2.0 * sine)
    sinks = (normal * sine - shear * cosine) / (ks * cosine**2 + kn * sine**2)
    pressed = (normal - kn * sinks * sine) / cosine
    least = ks * cosine * math.cos(phi) + kn * sine * math.sin(phi)
    return 2.0 * pressed * (ks * cosine**2 + kn * sine**2) * math.sin(phi - a) / least


def snap_load(half_span: float, rise: float, stiffness: float) -> float:
    """Weight of a bar, half of a shallow truss of EA [N/m per metre depth], that snaps through [N/m].

    Half of the weight bears on the top: the most of 2 EA (z/l) (l0 - l)/l0 over all rises z.
    """
    free = math.hypot(half_span, rise)

    def carried(z: float) -> float:
        length = math.hypot(half_span, z)
        return 2.0 * stiffness * z / length * (free - length) / free

    low, high = 0.0, rise
    while high - low > 1e-9 * rise:
        third = (high - low) / 3.0
        if carried(low + third) < carried(high - third):
            low += third
        else:
            high -= third
    return carried((low + high) / 2.0)


def chain_frequency(n: int, length: float) -> float:
    """Lowest axial frequency of n blocks on glue, of a length in all, held at one end [1/s].

    Displacements are linear in each block, so it is that of n bar elements with consistent mass.
    """
    angle = math.pi / (2.0 * n)
    square = 6.0 * YOUNG / 2500.0 / (length / n) ** 2
    square *= (1.0 - math.cos(angle)) / (2.0 + math.cos(angle))
    return math.sqrt(square) / (2.0 * math.pi)
