"""Scenes of single blocks under load and of chains of them: section 1.6."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from voussoir_benches.checks import GRAVITY, YOUNG, Check, Outcome
from voussoir_benches.scene import Scene, benchmark, benchmark_in_both

STRAIN = "Deformable blocks"


def _strains() -> list[Scene]:
    """Scenes of section 1.6."""
    nu, pressed = 0.2, 1e6 / YOUNG
    across = lambda outcome: 2.0 * float(outcome.end(2)[0] - outcome.end(1)[0])  # noqa: E731
    along: Callable[[Outcome], float] = lambda outcome: float(outcome.end(2)[1] - outcome.end(1)[1])  # noqa: E731
    pressed_checks = (
        Check("ey, plane stress", -pressed, along, 1e-9, 1), Check("ex, plane stress", nu * pressed, across, 1e-9, 1),
        Check("ey, plane strain", -(1.0 - nu**2) * pressed, along, 1e-9, 2),
        Check("ex, plane strain", nu * (1.0 + nu) * pressed, across, 1e-9, 2))
    # points at 1 and 9 m of the 10 m
    shorter = lambda outcome: along(outcome) * 10.0 / 8.0  # noqa: E731
    load = 2500.0 * GRAVITY * 100.0 / 2.0
    bar = tuple(
        Check(f"shortening, E = {young:g} Pa [m]", -load / young, shorter, 1e-6, case)
        for case, young in enumerate((5e9, 5e11), 1)
    )
    frequency = math.sqrt(3.0 * YOUNG / 2500.0) / (2.0 * math.pi * 2.0)
    # the determinant of a step of constant acceleration is 1/(1 + square/2), square = (w dt)^2
    angle = 2.0 * math.pi * frequency * 2e-6
    lost = 1.0 - (1.0 + angle**2 / 2.0) ** (-math.pi / angle)
    swing = (Check("frequency, 1.10266 times that of a bar [1/s]", frequency, _swings(1), 1e-3),)
    decay = (Check("loss of amplitude per cycle of 2565 steps", lost, _lost_amplitude, 1e-2),)
    return [
        *benchmark_in_both(STRAIN, "uniaxial", "Hooke", *pressed_checks),
        *benchmark_in_both(STRAIN, "bar_own_weight", "rho g H^2/(2E)", *bar),
        benchmark(STRAIN, "bar_swings", "sqrt(3E/rho)/(2 pi H)", *swing, rate=True),
        benchmark(STRAIN, "bar_swings", "amplitude per step 1/sqrt(1 + (w dt)^2/2)", *decay),
    ]


def chain_frequency(n: int, length: float) -> float:
    """Lowest axial frequency of n blocks on glue, of a length in all, held at one end [1/s].

    Displacements are linear in each block, so it is that of n bar elements with consistent mass.
    """
    angle = math.pi / (2.0 * n)
    square = 6.0 * YOUNG / 2500.0 / (length / n) ** 2
    square *= (1.0 - math.cos(angle)) / (2.0 + math.cos(angle))
    return math.sqrt(square) / (2.0 * math.pi)


def _sheared() -> list[Scene]:
    """Pure shear, and stress that is there from the beginning."""
    shear = tuple(
        Check(f"gxy, plane {plane}", 2.4e3 / YOUNG, lambda o: float(o.end(1)[0]) / 2.0, 1e-9, case)
        for case, plane in enumerate(("stress", "strain"), 1)
    )
    stays = [
        Check(f"{name} [Pa]", exact, _stress(i), 1e-9, scale=2e6)
        for i, (name, exact) in enumerate((("sx", -2e6), ("sy", -1e6), ("txy", 0.0)))
    ]
    far = lambda outcome: float(np.hypot(*outcome.end(1)))  # noqa: E731
    stays.append(Check("relative displacement of the far corner", 0.0, far, 1e-9, scale=2.2))
    turned = tuple(
        Check(f"{name} after a quarter turn [Pa]", exact, _stress(i), 1e-6)
        for i, (name, exact) in enumerate((("sx", -1e6), ("sy", -2e6), ("txy", -5e5)))
    )
    return [
        benchmark(STRAIN, "pure_shear", "2 (1 + nu) tau/E", *shear),
        benchmark(STRAIN, "stress_stays", "initial stress", *stays),
        benchmark(STRAIN, "stress_turns", "sx, sy = sy, sx; txy = -txy", *turned),
    ]


def _chains() -> list[Scene]:
    """Blocks on glue: frequencies of columns and the way of a wave."""
    columns = [
        Check(f"frequency of {n} blocks [1/s]", chain_frequency(n, 2.0), _swings(point), 1e-3)
        for point, n in enumerate((2, 4, 8), 1)
    ]
    bar = math.sqrt(YOUNG / 2500.0) / 8.0
    columns.append(Check("eight blocks against a bar [1/s]", bar, _swings(3), 2e-3))
    moduli = (
        ("a bar, E", YOUNG),
        ("a plate, E/(1 - nu^2)", YOUNG / (1.0 - 0.3**2)),
        ("plane strain, lambda + 2G", YOUNG * 0.7 / (1.3 * 0.4)),
    )
    waves = tuple(
        Check(f"speed in {what} [m/s]", math.sqrt(e / 2500.0), _arrival(e), 1e-2, case)
        for case, (what, e) in enumerate(moduli, 1)
    )
    return [
        benchmark(STRAIN, "glued_columns", "chain of n bar elements", *columns),
        benchmark(STRAIN, "wave", "sqrt(modulus/rho)", *waves, slow=True),
    ]


def _stress(component: int) -> Callable[[Outcome], float]:
    """Measure of a component of the stress of block 1 [Pa]."""
    return lambda outcome: float(outcome.stress(1)[component])


def _arrival(modulus: float) -> Callable[[Outcome], float]:
    """Measure of the speed of a step of pressure, from the way of point 1 after it has passed.

    The point then moves at stress/(rho c); so its path shows when it began to.
    """
    speed = 1e5 / math.sqrt(modulus * 2500.0)

    def measure(outcome: Outcome) -> float:
        time, _, _, way, _ = outcome.track(1)[:, -1]
        return 1.95 / float(time - way / speed)

    return measure


def _lost_amplitude(outcome: Outcome) -> float:
    """Share of the amplitude of point 1 about its mean that a cycle takes."""
    swing = outcome.track(1)[4] + 2500.0 * GRAVITY * 4.0 / (2.0 * YOUNG)
    inner = swing[1:-1]
    k = 1 + np.flatnonzero((inner >= swing[:-2]) & (inner > swing[2:]) & (inner > 0.0))
    tops = swing[k] + (swing[k + 1] - swing[k - 1]) ** 2 / (8.0 * (2.0 * swing[k] - swing[k - 1] - swing[k + 1]))
    return float(1.0 - (tops[-1] / tops[0]) ** (1.0 / (len(tops) - 1)))


def _swings(point: int) -> Callable[[Outcome], float]:
    """Measure of a point's frequency about its mean, from its ways down through it [1/s]."""

    def measure(outcome: Outcome) -> float:
        time, _, _, _, v = outcome.track(point)
        swing = v + 2500.0 * GRAVITY * 4.0 / (2.0 * YOUNG)
        k = np.flatnonzero((swing[:-1] > 0.0) & (swing[1:] <= 0.0))
        crossing = time[k] + (time[k + 1] - time[k]) * swing[k] / (swing[k] - swing[k + 1])
        return float((len(crossing) - 1) / (crossing[-1] - crossing[0]))

    return measure


#: Every scene of this module
SCENES = (*_strains(), *_sheared(), *_chains())
