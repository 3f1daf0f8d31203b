"""Curves of the entities of a DXF drawing, in space."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import Any

import numpy as np

from voussoir.imports.curves import Arc, Curve, Line, Spline
from voussoir.imports.dxf_groups import Entry, Placement
from voussoir.imports.plane import Plane


#: Control points of space (n, 3), and what makes the curve from these points in a plane
Part = tuple[np.ndarray, Callable[..., Curve]]


@dataclass(frozen=True)
class Shape:
    """An entity as parts in a row."""

    parts: list[Part]
    is_closed: bool = False
    may_close: bool = False  #: The file does not say whether it is closed

    def placed(self, placement: Placement, plane: Plane) -> list[Curve]:
        """The curves in a placement, in a plane; affine maps of control points are those of curves."""
        if not self.parts:
            return []
        flat = plane.flat(placement.points(np.vstack([points for points, _ in self.parts])))
        row = iter((flat[:, 0] + 1j * flat[:, 1]).tolist())
        return [make(*islice(row, len(points))) for points, make in self.parts]


def _arc(start: complex, end: complex, centre: complex, *tips: complex, angles: tuple[float, float]) -> Curve:
    """An arc of an ellipse by its ends, its centre, the ends of two half axes, and the angles at its ends."""
    return Arc(start, end, centre, tips[0] - centre, tips[1] - centre, angles)


def _b_spline(*points: complex, degree: int, knots: np.ndarray, weights: np.ndarray) -> Curve:
    """A rational B-spline, which may have kinks at its repeated knots."""
    low, high = knots[degree], knots[len(points)]
    inner, count = np.unique(knots[(knots > low) & (knots < high)], return_counts=True)
    kinks = tuple(float(knot - low) / float(high - low) for knot in inner[count >= degree])
    spline = Spline(0j, 0j, degree, knots, np.array(points), weights, kinks)
    start, end = spline.at(np.array([0.0, 1.0])).tolist()
    return replace(spline, start=start, end=end)


def curves_of(entry: Entry, vertices: list[Entry]) -> Shape | None:
    """The curves of an entity; None if it is no line. ValueError if its values make none."""
    reader = _READERS.get(entry.kind)
    if entry.kind == "POLYLINE":
        return _polyline(entry, vertices)
    return reader(entry) if reader else None


def _line(entry: Entry) -> Shape:
    """A LINE."""
    return Shape([(np.array([entry.point(10), entry.point(11)]), Line)])


def _circle(entry: Entry) -> Shape:
    """A CIRCLE or an ARC."""
    radius = entry.number(40)
    if not radius > 0.0:
        raise ValueError(f"{entry.place}: expected a radius of {entry.kind} above 0, got {radius:g}")
    axes = entry.axes()
    if entry.kind == "CIRCLE":
        return _ellipse_of(axes @ np.array(entry.point(10)), radius * axes.T[:2], 0.0, 2.0 * math.pi)
    start = math.radians(entry.number(50))
    turn = math.radians((entry.number(51) - entry.number(50)) % 360.0) or 2.0 * math.pi
    return _ellipse_of(axes @ np.array(entry.point(10)), radius * axes.T[:2], start, turn)


def _ellipse(entry: Entry) -> Shape:
    """An ELLIPSE: its major half axis, the ratio of the minor one, the angles at its ends."""
    major, ratio = np.array(entry.point(11)), entry.number(40)
    minor = ratio * np.cross(entry.axes()[:, 2], major)
    if not (np.linalg.norm(major) > 0.0 and np.linalg.norm(minor) > 0.0):
        raise ValueError(f"{entry.place}: expected half axes of ELLIPSE that have a length, got none")
    start = entry.number(41, 0.0)
    turn = (entry.number(42, 2.0 * math.pi) - start) % (2.0 * math.pi)
    full = turn < 1e-9 or 2.0 * math.pi - turn < 1e-9
    return _ellipse_of(np.array(entry.point(10)), np.array([major, minor]), start, 2.0 * math.pi if full else turn)


def _ellipse_of(centre: np.ndarray, half_axes: np.ndarray, start: float, turn: float) -> Shape:
    """An arc of an ellipse; a whole one is two halves, as a curve has two ends."""
    whole = turn >= 2.0 * math.pi
    stops = [start, start + turn / 2.0, start + turn] if whole else [start, start + turn]
    ends = [centre + half_axes[0] * math.cos(angle) + half_axes[1] * math.sin(angle) for angle in stops]
    ends[-1] = ends[0] if whole else ends[-1]
    frame = [centre, *(centre + half_axes)]
    return Shape(
        [(np.array([*ends[i : i + 2], *frame]), partial(_arc, angles=(stops[i], stops[i + 1])))
         for i in range(len(ends) - 1)], is_closed=whole)


def _light_polyline(entry: Entry) -> Shape:
    """A LWPOLYLINE; one without group 70 does not say whether it is closed."""
    rows = entry.rows(10, 20, 42)
    height = entry.number(38, 0.0)
    return _chain(
        [(x, y, height) for x, y, _ in rows], [bulge for _, _, bulge in rows], entry.axes(),
        bool(entry.whole(70) & 1), not any(code == 70 for code, _ in entry.groups))


def _polyline(entry: Entry, vertices: list[Entry]) -> Shape | None:
    """A POLYLINE with its vertices; None if it is a mesh."""
    flags = entry.whole(70)
    if flags & (16 | 64):
        return None
    shown = [vertex for vertex in vertices if not vertex.whole(70) & 16]  # without the frame of a spline
    points = [vertex.point(10) for vertex in shown]
    is_open_form = not any(code == 70 for code, _ in entry.groups)
    if flags & 8:
        return _chain(points, [0.0] * len(points), np.eye(3), bool(flags & 1), is_open_form)
    height = entry.point(10, (0.0, 0.0, 0.0))[2]
    return _chain(
        [(x, y, height) for x, y, _ in points], [vertex.number(42, 0.0) for vertex in shown], entry.axes(),
        bool(flags & 1), is_open_form)


def _chain(points: list[Any], bulges: list[float], axes: np.ndarray, is_closed: bool, may_close: bool) -> Shape:
    """Lines and arcs from point to point; a bulge is the tangent of a quarter of the turn."""
    pairs = list(zip(points, points[1:] + points[:1], bulges))[: None if is_closed else -1]
    parts: list[Part] = []
    for start, end, bulge in pairs:
        if start == end:
            continue
        ends = np.array([start, end]) @ axes.T
        if bulge == 0.0:
            parts.append((ends, Line))
            continue
        way = complex(end[0] - start[0], end[1] - start[1])
        spoke = -way * complex(0.5, (1.0 - bulge**2) / (4.0 * bulge))  # from the centre to the start
        centre = np.array(start) - np.array([spoke.real, spoke.imag, 0.0])
        half_axes = np.array([[spoke.real, spoke.imag, 0.0], [-spoke.imag, spoke.real, 0.0]])
        frame = np.vstack((centre, centre + half_axes)) @ axes.T
        parts.append((np.vstack((ends, frame)), partial(_arc, angles=(0.0, 4.0 * math.atan(bulge)))))
    return Shape(parts, is_closed, may_close)


def _corners(entry: Entry) -> Shape:
    """A SOLID, TRACE or 3DFACE: three or four corners, of the former two in the order of a Z."""
    points = [entry.point(10), entry.point(11), entry.point(12)]
    points.append(entry.point(13, points[2]))
    flat = entry.kind != "3DFACE"
    order = (0, 1, 3, 2) if flat else (0, 1, 2, 3)
    row = [points[number] for number in order]
    return _chain(row, [0.0] * 4, entry.axes() if flat else np.eye(3), True, False)


def _spline(entry: Entry) -> Shape:
    """A SPLINE by its control points, else a cubic one through its fit points."""
    degree, flags = entry.whole(71, 3), entry.whole(70)
    points = np.array(entry.rows(10, 20, 30)).reshape(-1, 3)
    knots = np.array([row[0] for row in entry.rows(40)])
    if not len(points):
        return _fitted(entry, bool(flags & 1))
    weights = np.array([row[0] for row in entry.rows(41)] or [1.0] * len(points))
    fits = len(knots) == len(points) + degree + 1 and len(weights) == len(points) > degree >= 1
    if not fits or degree > 20 or np.any(np.diff(knots) < 0.0) or not np.all(weights > 0.0) or not (
            knots[degree] < knots[len(points)]):
        raise ValueError(
            f"{entry.place}: expected increasing knots and positive weights that fit the degree of SPLINE, got others")
    return Shape([(points, partial(_b_spline, degree=degree, knots=knots, weights=weights))])


def _fitted(entry: Entry, is_closed: bool) -> Shape:
    """A cubic spline through points, its parameter the length of the chords, with end tangents where given."""
    fit = np.array(entry.rows(11, 21, 31)).reshape(-1, 3)
    fit = fit[np.concatenate(([True], np.any(np.diff(fit, axis=0) != 0.0, axis=1)))] if len(fit) else fit
    if len(fit) < 2:
        raise ValueError(f"{entry.place}: expected at least two points of SPLINE, got {len(fit)}")
    step = np.linalg.norm(np.diff(fit, axis=0), axis=1)
    count = len(fit)
    matrix, right = np.zeros((count, count)), np.zeros((count, 3))
    for i in range(1, count - 1):
        matrix[i, i - 1 : i + 2] = step[i], 2.0 * (step[i - 1] + step[i]), step[i - 1]
        right[i] = 3.0 * (step[i] * (fit[i] - fit[i - 1]) / step[i - 1] + step[i - 1] * (fit[i + 1] - fit[i]) / step[i])
    for i, code, inner, way in ((0, 12, 1, (fit[1] - fit[0]) / step[0]), (-1, 13, -2, (fit[-1] - fit[-2]) / step[-1])):
        tangent = np.array(entry.point(code, (0.0, 0.0, 0.0)))
        matrix[i, i], given = 1.0, np.linalg.norm(tangent) > 0.0
        matrix[i, inner] = 0.0 if given else 0.5
        right[i] = tangent / np.linalg.norm(tangent) if given else 1.5 * way
    slope = np.linalg.solve(matrix, right)
    control = [fit[0]]
    for i in range(count - 1):
        control += [fit[i] + slope[i] * step[i] / 3.0, fit[i + 1] - slope[i + 1] * step[i] / 3.0, fit[i + 1]]
    knots = np.concatenate(([0.0], np.repeat(np.concatenate(([0.0], np.cumsum(step))), 3), [step.sum()]))
    make = partial(_b_spline, degree=3, knots=knots, weights=np.ones(len(control)))
    return Shape([(np.array(control), make)], is_closed)


_READERS = {
    "LINE": _line, "CIRCLE": _circle, "ARC": _circle, "ELLIPSE": _ellipse, "LWPOLYLINE": _light_polyline,
    "SPLINE": _spline, "SOLID": _corners, "TRACE": _corners, "3DFACE": _corners}
