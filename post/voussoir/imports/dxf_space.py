"""Places in the space of a DXF drawing: object coordinates and inserts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from voussoir.imports.dxf_groups import Entry


def object_axes(entry: Entry) -> np.ndarray:
    """Columns are the axes of an entity's own coordinates, by the arbitrary axis rule of DXF: (3, 3)."""
    if not any(code == 210 for code, _ in entry.groups):
        return np.eye(3)
    normal = np.array(entry.point(210, (0.0, 0.0, 1.0)))
    length = float(np.linalg.norm(normal))
    if not length > 0.0:
        raise ValueError(f"{entry.place}: expected a normal of {entry.kind} that has a length, got none")
    normal /= length
    near_z = abs(normal[0]) < 1.0 / 64.0 and abs(normal[1]) < 1.0 / 64.0
    first = np.cross((0.0, 1.0, 0.0) if near_z else (0.0, 0.0, 1.0), normal)
    first /= np.linalg.norm(first)
    return np.column_stack((first, np.cross(normal, first), normal))


@dataclass(frozen=True)
class Placement:
    """An affine map of space: matrix x + shift."""

    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def points(self, given: np.ndarray) -> np.ndarray:
        """Points (n, 3) of points."""
        return np.asarray(given @ self.matrix.T + self.shift)

    def inserts(self, insert: Entry, base: tuple[float, float, float], columns: int, rows: int) -> Iterator[Placement]:
        """Placements of a block that is inserted in this one, columns and rows of it."""
        axes = object_axes(insert)
        turn = math.radians(insert.number(50, 0.0))
        spin = np.array([[math.cos(turn), -math.sin(turn), 0.0], [math.sin(turn), math.cos(turn), 0.0], [0, 0, 1]])
        scale = np.diag([insert.number(code, 1.0) for code in (41, 42, 43)])
        if not all(np.diag(scale)):
            raise ValueError(f"{insert.place}: expected scales of an insert other than 0, got 0")
        matrix = axes @ spin @ scale
        for row in range(rows):
            for column in range(columns):
                step = np.array([column * insert.number(44, 0.0), row * insert.number(45, 0.0), 0.0])
                shift = axes @ (np.array(insert.point(10)) + spin @ step) - matrix @ np.array(base)
                yield Placement(self.matrix @ matrix, self.matrix @ shift + self.shift)
