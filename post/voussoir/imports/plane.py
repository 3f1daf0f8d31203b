"""The plane in which points of space are looked at."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

#: Axes to the right, up and along the view, by the name of the plane
AXES = {"xy": (0, 1, 2), "xz": (0, 2, 1), "yz": (1, 2, 0)}


class Plane:
    """A coordinate plane, and how far the points that it was given extend along each axis."""

    def __init__(self, name: str = "") -> None:
        self.name = name or "xy"
        self._low = np.full(3, np.inf)
        self._high = np.full(3, -np.inf)

    def flat(self, points: npt.ArrayLike) -> np.ndarray:
        """Points (n, 2) of points (n, 2) or (n, 3)."""
        given = np.asarray(points, dtype=float)
        space = np.zeros((len(given), 3))
        space[:, : given.shape[1]] = given
        if len(space):
            self._low = np.minimum(self._low, space.min(axis=0))
            self._high = np.maximum(self._high, space.max(axis=0))
        return space[:, AXES[self.name][:2]]

    def depth(self, tolerance: float) -> str:
        """The coordinate that is left out in words, none where it is 0.

        ValueError where it differs by more than the tolerance.
        """
        along = AXES[self.name][2]
        spread = self._high - self._low
        if not np.all(np.isfinite(spread)):
            return ""
        low, high, letter = self._low[along], self._high[along], "xyz"[along]
        if spread[along] > tolerance:
            others = [name for name, axes in AXES.items() if spread[axes[2]] <= tolerance]
            advice = f"choose --plane {others[0]}" if others else "draw the outlines in one plane"
            raise ValueError(f"expected points of one {letter}, got {letter} from {low:.6g} to {high:.6g}; {advice}")
        return f"{letter} = {high:.6g} of all points" if high != 0.0 or low != 0.0 else ""
