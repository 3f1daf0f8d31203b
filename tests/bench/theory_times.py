"""Speed of the theory: solutions a second, against NumPy and scipy.optimize.brentq.

Run as ``PYTHONPATH=build/python python3 tests/bench/theory_times.py``. The three do the same: hinge, thickness and
thrust at given half angles. NumPy runs the Newton iteration of the Fortran module on whole arrays, with the same stable
kernels; brentq solves the printed eqs. (1), (24), (23) angle by angle. One process, one core.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable

import numpy as np

from voussoir import theory

_SERIES_P = 1.0 / np.array([20, 42, 72, 110, 156, 210, 272, 342, 420, 506, 600])
_SERIES_K = 1.0 / np.array([10, 28, 54, 88, 130, 180, 238, 304, 378, 460, 550])


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--elements", type=int, default=1_000_000, help="half angles for Fortran and NumPy")
    parser.add_argument("--scalar", type=int, default=2000, help="half angles for brentq")
    options = parser.parse_args()
    angles = np.linspace(0.01, 2.2, options.elements)
    few = np.linspace(0.01, 2.2, options.scalar)
    print(f"{'theory':<14}{'Fortran':>12}{'NumPy':>12}{'brentq':>12}   solutions/s, ratios, largest difference in eta")
    for name in theory.THEORIES:
        print(compare(name, angles, few))
    voussoirs = 36
    discrete = rate(lambda: theory.discrete_critical(voussoirs, alpha=few), options.scalar)
    print(f"arches of {voussoirs} voussoirs, exact: {discrete:.3g} a second")


def compare(name: str, angles: np.ndarray, few: np.ndarray) -> str:
    """Measure one theory: many half angles for Fortran and NumPy, few for brentq [rad]."""
    fortran = rate(lambda: theory.critical(angles, name), angles.size)
    vectorised = rate(lambda: numpy_critical(angles, name), angles.size)
    scalar = rate(lambda: [brentq_critical(angle, name) for angle in few], few.size, repeats=1)
    ratio = numpy_critical(angles, name)[1] / theory.critical(angles, name)[1]
    return (
        f"{name:<14}{fortran:>12.3g}{vectorised:>12.3g}{scalar:>12.3g}   {fortran / vectorised:.1f} x NumPy, "
        f"{fortran / scalar:.0f} x brentq, {np.max(np.abs(ratio - 1.0)):.1e}"
    )


def rate(work: Callable[[], object], count: int, repeats: int = 3) -> float:
    """Elements a second, the best of some runs."""
    best = math.inf
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return count / best


def numpy_critical(alpha: np.ndarray, name: str, steps: int = 6) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Hinge [rad], thickness ratio and thrust by couplet_heyman_critical on whole arrays, for half angles up to 2.2."""
    flag = 1.0 if name == "milankovitch" else 0.0
    deficit = 2.0 * _arm_excess(alpha / 2) / np.sin(alpha / 2)
    beta = alpha / math.sqrt(2.0) / (1.0 + 0.07 * alpha**2)
    for _ in range(steps):
        sine, q = np.sin(beta), 2.0 * np.sin(beta / 2) ** 2
        ratio = _arm_excess(beta) / sine
        rate_of_ratio = beta - ratio * (1.0 - q) / sine
        if name == "heyman":
            eta = 2.0 * _arc_excess(beta) / beta * np.tan(beta / 2) ** 2
            growth = eta * (q / _arc_excess(beta) - 1.0 / beta + 2.0 / sine)
            change = (deficit - ratio - eta / (2.0 + eta)) / (rate_of_ratio + 2.0 * growth / (2.0 + eta) ** 2)
        else:
            eta = _curve(alpha, beta, deficit, flag)
            change = (deficit - ratio - 4.0 * eta * (1.0 + flag * eta**2 / 12) / (4.0 - eta**2)) / rate_of_ratio
        beta = beta + change
    h = 1.0 - deficit + eta * (1.0 - flag * eta / 6) / (2.0 + eta)
    return beta, eta, h


def brentq_critical(alpha: float, name: str) -> tuple[float, float, float]:
    """The same by the printed equations and a scalar root finder."""
    from scipy.optimize import brentq

    a = alpha / math.tan(alpha / 2)

    def mismatch(b: float) -> float:
        s, c = math.sin(b), math.cos(b)
        g = b + s * c
        if name == "heyman":
            common = 2 * b * c + s * c * c
            return b * c / s * (common + s) / (common - s * c) - a
        if name == "ccr":
            return s * (2 * g - s) * a**2 - 2 * (s + b * c) * g * a + g**2
        cubic = s**2 * (3 * g - 2 * s) * a**3 + 3 * (1 - c) * (b - s) * g * s * a**2
        return cubic - 3 * (s + b * c) * g**2 * a + 2 * g**3

    beta = brentq(mismatch, 0.55 * alpha if name == "heyman" else 0.4 * alpha, min(alpha, 1.57), xtol=1e-15)
    s, c = math.sin(beta), math.cos(beta)
    if name == "heyman":
        return beta, 2 * (beta - s) * (1 - c) / (beta * (1 + c)), beta * c / s
    q, d, p = beta * s - (1 - c) * a, c - a, beta * s + (1 + c) * a
    eta = 2 * (d + math.sqrt(d * d + p * q)) / p
    flag = 1 if name == "milankovitch" else 0
    for _ in range(4 * flag):
        eta -= (q + eta * (d - eta * (p / 4 - c * eta / 12))) / (d - eta * (p / 2 - c * eta / 4))
    return beta, eta, a - 2 / (2 + eta) * (1 + flag * eta**2 / 12)


def _nested(y: np.ndarray, ratios: np.ndarray) -> np.ndarray:
    """Alternating series from its last term."""
    total = np.ones_like(y)
    for ratio in ratios[::-1]:
        total = 1.0 - y * ratio * total
    return total


def _arc_excess(x: np.ndarray) -> np.ndarray:
    """x - sin x."""
    return np.where(np.abs(x) < 1.5, x**3 / 6 * _nested(x * x, _SERIES_P), x - np.sin(x))


def _arm_excess(x: np.ndarray) -> np.ndarray:
    """sin x - x cos x."""
    return np.where(np.abs(x) < 1.5, x**3 / 3 * _nested(x * x, _SERIES_K), np.sin(x) - x * np.cos(x))


def _curve(alpha: np.ndarray, beta: np.ndarray, deficit: np.ndarray, flag: float) -> np.ndarray:
    """eta(beta) of eqs. (14) and (16)."""
    s, d = (alpha + beta) / 2, (alpha - beta) / 2
    q = 2.0 * np.sin(beta / 2) ** 2
    excess = q * (d * _arc_excess(s) - s * _arc_excess(d)) / (np.sin(alpha / 2) * np.sin(beta / 2))
    linear = deficit - 1.0 - q
    p = beta * np.sin(beta) + (2.0 - q) * (2.0 - deficit)
    eta = 2.0 * excess / (np.sqrt(linear**2 + p * excess) - linear)
    for _ in range(4 if flag else 0):
        value = excess + eta * (linear - eta * (p / 4 - (1.0 - q) * eta / 12))
        eta = eta - value / (linear - eta * (p / 2 - (1.0 - q) * eta / 4))
    return eta


if __name__ == "__main__":
    main()
