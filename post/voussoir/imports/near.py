"""Near pairs in large drawings: points near edges, and curves near points, by cells of a grid."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from voussoir.imports.curves import Curve, Line, sampled

#: Pairs of edges and points that are looked at together
AT_ONCE = 1_000_000
#: Most cells along a side of the grid
MOST_CELLS = 4096


def points_on_edges(
    starts: np.ndarray, ends: np.ndarray, points: np.ndarray, reach: float
) -> list[tuple[int, float, int]]:
    """Points within reach of edges and farther than that from their ends.

    Edges lead from `starts` to `ends`, (m) complex; points are (n) complex. Gives edge, share along it and point,
    sorted by edge and share.
    """
    found: list[tuple[int, float, int]] = []
    for edge, point in _pairs(starts, ends, points, reach):
        place, start, end = points[point], starts[edge], ends[edge]
        low_x, high_x = np.minimum(start.real, end.real) - reach, np.maximum(start.real, end.real) + reach
        low_y, high_y = np.minimum(start.imag, end.imag) - reach, np.maximum(start.imag, end.imag) + reach
        inside = (place.real >= low_x) & (place.real <= high_x) & (place.imag >= low_y) & (place.imag <= high_y)
        edge, point = edge[inside], point[inside]
        place, start, end = points[point], starts[edge], ends[edge]
        way = end - start
        along = np.clip(((place - start) * np.conj(way)).real / np.maximum(abs(way) ** 2, 1e-300), 0.0, 1.0)
        lies = abs(place - start - along * way) <= reach
        lies &= (abs(place - start) > reach) & (abs(place - end) > reach)
        found += zip(edge[lies].tolist(), along[lies].tolist(), point[lies].tolist())
    return sorted(found)


def _pairs(
    starts: np.ndarray, ends: np.ndarray, points: np.ndarray, reach: float
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Edges and points that share a cell, or a row of cells, in pieces of at most some `AT_ONCE` pairs."""
    if not len(points) or not len(starts):
        return
    origin = complex(points.real.min(), points.imag.min())
    size = max(np.ptp(points.real), np.ptp(points.imag), reach)
    cell = max(size / min(MOST_CELLS, math.isqrt(len(points)) + 1), 2.0 * reach)
    count = int(size / cell) + 3
    spots = points - origin
    keys = (spots.real // cell).astype(np.int64) * count + (spots.imag // cell).astype(np.int64)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    boxes = []
    for part in ("real", "imag"):
        one, other = (getattr(side - origin, part) for side in (starts, ends))
        boxes.append(np.clip((np.minimum(one, other) - reach) // cell, 0, count - 1).astype(np.int64))
        boxes.append(np.clip((np.maximum(one, other) + reach) // cell, 0, count - 1).astype(np.int64))
    left, right, below, above = boxes
    columns = right - left + 1
    first_row = np.concatenate(([0], np.cumsum(columns)))
    edge = np.repeat(np.arange(len(starts)), columns)
    column = np.arange(first_row[-1]) - first_row[edge] + left[edge]
    begin = np.searchsorted(keys, column * count + below[edge], "left")
    length = np.searchsorted(keys, column * count + above[edge], "right") - begin
    total = np.cumsum(length)
    row = 0
    while row < len(edge):
        last = max(row + 1, int(np.searchsorted(total, (total[row - 1] if row else 0) + AT_ONCE, "right")))
        lengths = length[row:last]
        inner = np.arange(int(lengths.sum())) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        yield np.repeat(edge[row:last], lengths), order[np.repeat(begin[row:last], lengths) + inner]
        row = last


class Cells:
    """Curves by the cells of a grid that they go through, widened by the distance `reach`.

    Chords may be `tolerance` from a curve.
    """

    def __init__(self, curves: Sequence[Curve], reach: float, tolerance: float) -> None:
        ends = np.array([point for curve in curves for point in (curve.start, curve.end)] or [0.0 + 0.0j])
        size = max(float(np.ptp(ends.real)), float(np.ptp(ends.imag)), reach, tolerance)
        self._cell = max(size / (math.isqrt(len(curves)) + 1), 2.0 * reach)
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
