"""Where points of a case are drawn: each goes with the block that it belongs to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from voussoir.polygon import distance
from voussoir.results import Block


@dataclass(frozen=True)
class Motion:
    """Displacements of a case as its picture shows them."""

    #: Multiples of the displacements at which the picture shows the blocks, and at which tables have their points
    shown: float
    written: float
    #: Of each block that can move, the rows a of u = (x, y, 1) a: (3, 2), of the places before it has moved
    fields: dict[int, np.ndarray]
    corners: dict[int, np.ndarray]  #: Its corners before it has moved [m]

    def carried(self, points: np.ndarray, blocks: np.ndarray) -> np.ndarray:
        """Places in the picture of points of tables, each of one block: (n, 2) [m]."""
        moved = np.array(points, dtype=float)
        if self.shown == self.written or not self.fields:
            return moved
        numbers = np.array(sorted(self.fields))
        laws = np.array([self.fields[number] for number in numbers.tolist()])
        row = np.minimum(np.searchsorted(numbers, blocks), len(numbers) - 1)
        goes = numbers[row] == blocks
        law, there = laws[row[goes]], moved[goes]
        # the table has p + written u(p), with u = p A + c: p is found from it
        a, b, c, d = (self.written * law[:, i, j] + (i == j) for i in (0, 1) for j in (0, 1))
        x, y = (there - self.written * law[:, 2]).T
        det = a * d - b * c
        first = np.column_stack(((x * d - y * c) / det, (y * a - x * b) / det))
        shift = first[:, :1] * law[:, 0] + first[:, 1:] * law[:, 1] + law[:, 2]
        moved[goes] = first + self.shown * shift
        return moved

    def placed(self, point: tuple[float, float]) -> tuple[float, float]:
        """Place in the picture of a point that a file gives before anything has moved [m]."""
        number = self.nearest(point)
        if number is None or self.shown == 0.0:
            return point
        x, y = np.array(point) + self.shown * (np.array([*point, 1.0]) @ self.fields[number])
        return float(x), float(y)

    def nearest(self, point: tuple[float, float]) -> int | None:
        """Number of the block that has a point, or is nearest to it; None where no block can move."""
        best, found = np.inf, None
        for number, corners in self.corners.items():
            gap = distance(corners, np.array(point))
            if gap < best:
                best, found = gap, number
        return found if found in self.fields else None


def motion_of(blocks: list[Block], supports: list[Block], shown: float, written: float) -> Motion:
    """The motion of a case; blocks whose displacements are not known stay."""
    fields, corners = {}, {}
    for block in blocks:
        corners[block.number] = block.corners
        if np.all(np.isfinite(block.displacement)):
            rows = np.column_stack((block.corners, np.ones(len(block.corners))))
            fields[block.number] = np.linalg.lstsq(rows, block.displacement, rcond=None)[0]
    corners |= {block.number: block.corners for block in supports}
    return Motion(shown, written, fields, corners)
