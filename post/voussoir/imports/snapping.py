"""Corners that nearly meet become one; corners near an edge of another outline are moved onto it.

Near pairs of large drawings are found by the cells of a grid.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from voussoir.extras import load
from voussoir.imports.curves import Curve, Line, sampled
from voussoir.imports.notes import Notes


def points_on_edges(
    starts: np.ndarray, ends: np.ndarray, points: np.ndarray, reach: float
) -> list[tuple[int, float, int]]:
    """Points within reach of edges and farther than that from their ends.

    Edges lead from `starts` to `ends`, (m) complex; points are (n) complex. Gives edge, share along it and point,
    sorted by edge and share.
    """
    edges = [Line(start, end) for start, end in zip(starts.tolist(), ends.tolist())]
    cells, found = Cells(edges, reach, reach), []
    for number, point in enumerate(points.tolist()):
        for edge in cells.near(point):
            start, end = edges[edge].start, edges[edge].end
            way = end - start
            along = min(max(((point - start) * way.conjugate()).real / max(abs(way) ** 2, 1e-300), 0.0), 1.0)
            if abs(point - start - along * way) <= reach < min(abs(point - start), abs(point - end)):
                found.append((edge, along, number))
    return sorted(found)


class Cells:
    """Curves by the cells of a grid that they go through, widened by the distance `reach`.

    Chords may be `tolerance` from a curve.
    """

    def __init__(self, curves: Sequence[Curve], reach: float, tolerance: float) -> None:
        # as large as a curve on average: each goes through few, however far apart the parts of a drawing are
        lengths = [abs(curve.end - curve.start) for curve in curves]
        self._cell = max(math.fsum(lengths) / max(len(lengths), 1), 2.0 * reach, tolerance)
        self._cells: dict[tuple[int, int], list[int]] = {}
        for number, curve in enumerate(curves):
            wide = reach if isinstance(curve, Line) else reach + tolerance
            cells: set[tuple[int, int]] = set()
            points = sampled(curve, tolerance)[1].tolist() if not isinstance(curve, Line) else [curve.start, curve.end]
            for start, end in zip(points, points[1:]):
                cells.update(self._along(start, end, wide))
            for cell in cells:
                self._cells.setdefault(cell, []).append(number)

    def _along(self, start: complex, end: complex, wide: float) -> Iterator[tuple[int, int]]:
        """Cells of a straight piece."""
        parts = max(1, math.ceil(max(abs(end.real - start.real), abs(end.imag - start.imag)) / self._cell))
        for part in range(parts):
            one, other = start + (end - start) * (part / parts), start + (end - start) * ((part + 1) / parts)
            low_x, high_x = sorted((one.real, other.real))
            low_y, high_y = sorted((one.imag, other.imag))
            for i in range(math.floor((low_x - wide) / self._cell), math.floor((high_x + wide) / self._cell) + 1):
                for j in range(math.floor((low_y - wide) / self._cell), math.floor((high_y + wide) / self._cell) + 1):
                    yield i, j

    def near(self, point: complex) -> list[int]:
        """Numbers of curves that may be within the distance of a point, in ascending order."""
        return self._cells.get((math.floor(point.real / self._cell), math.floor(point.imag / self._cell)), [])


class Ends:
    """Points, those within reach of an earlier one as that one."""

    def __init__(self, reach: float) -> None:
        self._reach = reach
        self._cells: dict[tuple[int, int], list[complex]] = {}

    def of(self, point: complex) -> complex:
        """The nearest known point within reach of this one, or itself."""
        i, j = round(point.real / self._reach), round(point.imag / self._reach)
        around = [
            known for di in (0, -1, 1) for dj in (0, -1, 1) for known in self._cells.get((i + di, j + dj), ())
            if abs(known - point) <= self._reach]
        if around:
            return min(around, key=lambda known: abs(known - point))
        self._cells.setdefault((i, j), []).append(point)
        return point


def snapped(polygons: list[Any], reach: float, notes: Notes) -> list[Any]:
    """Polygons of shapely whose corners lie together, and on each other's edges, where they are within reach."""
    shape = load("shapely.geometry", "polygons")
    reach *= 1.0 + 1e-6  # a gap as wide as asked may be read wider
    ends = Ends(reach)
    given = [[_ring(ring) for ring in (polygon.exterior, *polygon.interiors)] for polygon in polygons]
    joined = [[[ends.of(point) for point in ring] for ring in rings] for rings in given]
    onto = _onto_edges([ring for rings in joined for ring in rings], reach)
    found = []
    for rings, before in zip(joined, given):
        moved = [[onto.get(point, point) for point in ring] for ring in rings]
        notes.snapped += [
            abs(new - old) for ring, olds in zip(moved, before) for new, old in zip(ring, olds) if new != old]
        rows = [[(point.real, point.imag) for point in ring] for ring in map(_once, moved)]
        found.append(shape.Polygon(rows[0], [row for row in rows[1:] if len(row) > 2]) if len(rows[0]) > 2
                     else shape.Polygon())
    return found


def _onto_edges(rings: list[list[complex]], reach: float) -> dict[complex, complex]:
    """Corners that lie near edges, and the points of these that they are moved to."""
    corners = np.unique(np.array([point for ring in rings for point in ring] or [0.0], dtype=complex))
    edges = [(start, end) for ring in rings for start, end in zip(ring, [*ring[1:], ring[0]]) if start != end]
    starts, ends = np.array([edge[0] for edge in edges]), np.array([edge[1] for edge in edges])
    onto: dict[complex, complex] = {}
    last: tuple[int, complex] | None = None
    for edge, share, number in points_on_edges(starts, ends, corners, reach):
        point = complex(corners[number])
        follows = last is not None and last[0] == edge and abs(point - last[1]) <= reach
        last = (edge, point)
        if follows:
            continue
        start, end = edges[edge]
        target = start + share * (end - start)
        if abs(target - point) > 1e-14 * (abs(start) + abs(end)):  # else it lies there but for rounding
            onto.setdefault(point, target)
    return onto


def _ring(ring: Any) -> list[complex]:
    """Corners of a ring, each once."""
    points = np.asarray(ring.coords)[:-1]
    found: list[complex] = (points[:, 0] + 1j * points[:, 1]).tolist()
    return found


def _once(ring: list[complex]) -> list[complex]:
    """A ring without corners that follow themselves."""
    return [point for number, point in enumerate(ring) if point != ring[number - 1]]
