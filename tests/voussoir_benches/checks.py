"""Quantities with exact answers: how they are taken from the results of a run, and compared."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from voussoir_benches.vtu_cells import cell_field

GRAVITY = 9.81  #: Acceleration of gravity of the decks [m/s2]
#: Default density and modulus of a deck [kg/m3, Pa]
DENSITY, YOUNG = 2240.0, 5e9


class Outcome:
    """Results of one case of a deck, in the folder of `dda run`."""

    def __init__(self, folder: Path, case: int) -> None:
        self.folder = folder
        self.case = case

    def rows(self, table: str) -> list[dict[str, str]]:
        """Rows of the case in a table such as "joints"."""
        with (self.folder / f"{table}.csv").open(encoding="utf-8") as lines:
            return [row for row in csv.DictReader(lines) if row["case"] == str(self.case)]

    @property
    def verdict(self) -> str:
        """Verdict of the program."""
        return self.rows("results")[0]["verdict"]

    @property
    def critical(self) -> float:
        """Critical value of a search, NaN where none was found."""
        return float(self.rows("results")[0]["critical"] or math.nan)

    @cached_property
    def _points(self) -> np.ndarray:
        columns = ("point", "time", "x", "y", "u", "v")
        rows = self.rows("points")
        return np.array([[float(row[name]) for name in columns] for row in rows])

    def track(self, point: int) -> np.ndarray:
        """Time, place and displacement of a measured point: (5, steps) [s, m]."""
        return self._points[self._points[:, 0] == point, 1:].T

    def end(self, point: int) -> np.ndarray:
        """Displacement of a measured point at the end: (2) [m]."""
        return self.track(point)[3:, -1]

    def stress(self, block: int) -> np.ndarray:
        """Stress xx, yy, xy of a block in the last picture: (3) [Pa]."""
        pictures = (self.folder / "frames").glob(f"case_{self.case}_*.vtu")
        blocks = [path for path in pictures if not path.stem.endswith("_joints")]
        last = max(blocks, key=lambda path: int(path.stem.rpartition("_")[2]))
        return np.asarray(cell_field(last, "stress")[block - 1])

    def speed(self, point: int) -> np.ndarray:
        """Velocity of a measured point at the end, by a parabola through three steps: (2) [m/s]."""
        time, _, _, u, v = self.track(point)[:, -3:]
        late, early = time[2] - time[1], time[1] - time[0]
        last = np.array([u[2] - u[1], v[2] - v[1]]) / late
        before = np.array([u[1] - u[0], v[1] - v[0]]) / early
        return np.asarray(last + (last - before) * late / (late + early))

    def velocity(self, point: int) -> np.ndarray:
        """Mean velocity of a measured point in the last step: (2) [m/s]."""
        time, _, _, u, v = self.track(point)
        return np.asarray(np.array([u[-1] - u[-2], v[-1] - v[-2]]) / (time[-1] - time[-2]))

    def direction(self, first: int, second: int) -> np.ndarray:
        """Angle from one measured point to another after each step: (steps) [rad]."""
        apart = self.track(second)[1:3] - self.track(first)[1:3]
        return np.unwrap(np.arctan2(apart[1], apart[0]))

    def energy(self, *names: str) -> np.ndarray:
        """Sum of the named columns of energy.csv after each step: (steps) [J/m]."""
        rows = self.rows("energy")
        return np.array([sum(float(row[name]) for name in names) for row in rows])


@dataclass(frozen=True)
class Check:
    """One quantity of a scene."""

    what: str  #: The quantity, with its unit
    exact: float | str  #: Its exact value; a verdict where the scene only stands or falls
    measure: Callable[[Outcome], float | str]  #: Takes the outcome and returns what was computed
    accept: float = 0.0  #: Largest error that is accepted
    case: int = 1  #: Case of the deck
    scale: float | None = None  #: What the error is divided by; by default the exact value. 1 leaves it absolute.

    def error(self, computed: float | str) -> float:
        """Error of a computed value: that over `scale`, or 0 and infinity for a verdict."""
        if isinstance(self.exact, str):
            return 0.0 if computed == self.exact else math.inf
        return abs(float(computed) - self.exact) / abs(self.exact if self.scale is None else self.scale)


def verdict(exact: str, what: str, case: int = 1) -> Check:
    """A check that a case stands or falls as it must."""
    return Check(what, exact, lambda outcome: outcome.verdict, case=case)


def critical(what: str, exact: float, accept: float, case: int = 1, scale: float | None = None) -> Check:
    """A check of a critical value."""
    return Check(what, exact, lambda outcome: outcome.critical, accept, case, scale)
