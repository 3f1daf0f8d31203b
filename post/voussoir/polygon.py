"""Distance of a point from a polygon."""

from __future__ import annotations

import numpy as np


def distance(corners: np.ndarray, point: np.ndarray) -> float:
    """Distance of a point from a polygon, below 0 within it [m]."""
    start, along = corners, np.roll(corners, -1, axis=0) - corners
    square = np.einsum("ij,ij->i", along, along)
    share = np.clip(np.einsum("ij,ij->i", point - start, along) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    gap = float(np.hypot(*(start + share[:, None] * along - point).T).min())
    ends = start + along
    crosses = (start[:, 1] > point[1]) != (ends[:, 1] > point[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = start[:, 0] + (point[1] - start[:, 1]) * along[:, 0] / along[:, 1]
    inside = np.count_nonzero(crosses & (point[0] < at)) % 2 == 1
    return -gap if inside else gap
