"""Plane curves of drawings: lines, arcs of ellipses, splines; chords of them, with corners where points lie on them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Union

import numpy as np

#: Most chords of the curves of a drawing: beyond it is no model of blocks
MOST_CHORDS = 100_000


@dataclass(frozen=True)
class Line:
    """A straight line between two points."""

    start: complex
    end: complex
    kinks: tuple[float, ...] = ()

    def at(self, share: np.ndarray) -> np.ndarray:
        """Points at shares of its parameter from 0 to 1."""
        return self.start + (self.end - self.start) * share

    def chords(self, low: float, high: float, tolerance: float) -> float:
        """Number of chords between two shares that stay within the tolerance."""
        return 1.0


@dataclass(frozen=True)
class Arc:
    """An arc of an ellipse: centre + first cos(angle) + second sin(angle), from one angle to the other [rad]."""

    start: complex
    end: complex
    centre: complex
    first: complex
    second: complex
    angles: tuple[float, float]
    kinks: tuple[float, ...] = ()

    def at(self, share: np.ndarray) -> np.ndarray:
        """Points at shares of its parameter from 0 to 1."""
        angle = self.angles[0] + (self.angles[1] - self.angles[0]) * share
        return self.centre + self.first * np.cos(angle) + self.second * np.sin(angle)

    def chords(self, low: float, high: float, tolerance: float) -> float:
        """Number of chords between two shares that stay within the tolerance: sag 2 R sin^2(step/4)."""
        squares = abs(self.first) ** 2 + abs(self.second) ** 2
        cross = 2.0 * abs((self.first.conjugate() * self.second).imag)
        radius = (math.sqrt(squares + cross) + math.sqrt(max(squares - cross, 0.0))) / 2.0
        step = 4.0 * math.asin(math.sqrt(min(tolerance / (2.0 * radius), 0.25)))
        return (high - low) * abs(self.angles[1] - self.angles[0]) / step


@dataclass(frozen=True)
class Spline:
    """A rational B-spline."""

    start: complex
    end: complex
    degree: int
    knots: np.ndarray
    points: np.ndarray
    weights: np.ndarray
    kinks: tuple[float, ...] = field(default=())

    def at(self, share: np.ndarray) -> np.ndarray:
        """Points at shares of its parameter from 0 to 1, by de Boor's recursion."""
        p, knots, last = self.degree, self.knots, len(self.points)
        u = knots[p] + (knots[last] - knots[p]) * np.atleast_1d(share)
        span = np.clip(np.searchsorted(knots, u, "right") - 1, p, last - 1)
        weights = [self.weights[span - p + j] for j in range(p + 1)]
        points = [self.points[span - p + j] * weights[j] for j in range(p + 1)]
        for level in range(1, p + 1):
            for j in range(p, level - 1, -1):
                low, high = knots[span - p + j], knots[span + 1 + j - level]
                width = np.where(high > low, high - low, 1.0)
                ratio = np.where(high > low, (u - low) / width, 0.0)
                points[j] = (1.0 - ratio) * points[j - 1] + ratio * points[j]
                weights[j] = (1.0 - ratio) * weights[j - 1] + ratio * weights[j]
        return np.asarray(points[p] / weights[p])

    def chords(self, low: float, high: float, tolerance: float) -> float:
        """Number of chords between two shares that stay within the tolerance, by second differences."""
        count = 16 * len(self.points)
        points = self.at(np.linspace(low, high, count + 1))
        sag = abs(points[:-2] - 2.0 * points[1:-1] + points[2:]).max() / 2.0
        return count / 2.0 * math.sqrt(sag / tolerance)


Curve = Union[Line, Arc, Spline]


class Points:
    """Points that are found by a box around them."""

    def __init__(self, points: Sequence[complex]) -> None:
        given = np.unique(np.asarray(points, dtype=complex))
        self._all = given[np.argsort(given.real, kind="stable")]
        self._x = self._all.real

    def near(self, line: np.ndarray, reach: float) -> np.ndarray:
        """Those in the box around the points of a line, and within reach of it."""
        first = np.searchsorted(self._x, line.real.min() - reach, "left")
        last = np.searchsorted(self._x, line.real.max() + reach, "right")
        found = self._all[first:last]
        inside = (found.imag >= line.imag.min() - reach) & (found.imag <= line.imag.max() + reach)
        return np.asarray(found[inside])


def count_chords(curve: Curve, low: float, high: float, tolerance: float) -> int:
    """Number of chords between two shares; ValueError if there are too many."""
    count = curve.chords(low, high, tolerance)
    if not count <= MOST_CHORDS:
        raise ValueError(
            f"expected curves of at most {MOST_CHORDS} chords, got one of {count:.3g}; use a larger --tolerance")
    return max(1, math.ceil(count - 1e-9))


def sampled(curve: Curve, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Shares and points of a curve, close enough to find what lies on it."""
    count = 1 if isinstance(curve, Line) else max(16, count_chords(curve, 0.0, 1.0, tolerance))
    shares = np.unique(np.concatenate((np.linspace(0.0, 1.0, count + 1), curve.kinks)))
    points = curve.at(shares)
    points[0], points[-1] = curve.start, curve.end
    return shares, points


def nearest(curve: Curve, points: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Shares at which a curve is nearest to points, and the distances."""
    shares, line = sampled(curve, tolerance)
    best, low, high = np.full(len(points), np.inf), np.zeros(len(points)), np.ones(len(points))
    for number, (start, way) in enumerate(zip(line, np.diff(line))):
        along = np.clip(((points - start) * np.conj(way)).real / max(abs(way) ** 2, 1e-300), 0.0, 1.0)
        off = abs(points - start - along * way)
        better = off < best
        best[better] = off[better]
        low[better], high[better] = shares[max(number - 1, 0)], shares[min(number + 2, len(shares) - 1)]
        if isinstance(curve, Line):
            return along, off
    for _ in range(60):  # the distance has one minimum between neighbours of the nearest chord
        third = (high - low) / 3.0
        left = abs(curve.at(low + third) - points) < abs(curve.at(high - third) - points)
        low, high = np.where(left, low, low + third), np.where(left, high - third, high)
    middle = (low + high) / 2.0
    return middle, abs(curve.at(middle) - points)


def on_curve(curve: Curve, corners: Points, reach: float, tolerance: float) -> list[tuple[float, complex]]:
    """Shares and points of the corners that lie on a curve between its ends, in their order."""
    _, line = sampled(curve, tolerance)
    points = corners.near(line, tolerance + reach if not isinstance(curve, Line) else reach)
    points = points[(abs(points - curve.start) > reach) & (abs(points - curve.end) > reach)]
    if not len(points):
        return []
    share, off = nearest(curve, points, tolerance)
    found = sorted(zip(share[off <= reach].tolist(), points[off <= reach].tolist()), key=lambda pair: pair[0])
    return [pair for number, pair in enumerate(found) if number == 0 or abs(pair[1] - found[number - 1][1]) > reach]


def polyline(curve: Curve, corners: Points, reach: float, tolerance: float) -> list[complex]:
    """Points of a curve from its start to its end: corners that lie on it, and the ends of its chords between them."""
    stops = [(0.0, curve.start), *on_curve(curve, corners, reach, tolerance)]
    stops += [(share, complex(curve.at(np.array([share]))[0])) for share in curve.kinks]
    stops = [*sorted(stops, key=lambda pair: pair[0]), (1.0, curve.end)]
    points = [curve.start]
    for (low, _), (high, end) in zip(stops, stops[1:]):
        count = count_chords(curve, low, high, tolerance)
        if count > 1:
            points += curve.at(low + (high - low) * np.arange(1, count) / count).tolist()
        points.append(end)
    return points
