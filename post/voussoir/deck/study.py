"""Convergence studies: a deck run with one key halved again and again, and the order that its results show."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from voussoir.dda_program import ask, find_dda, keys_of
from voussoir.deck.run import run, settings_of
from voussoir.deck.text import groups_of
from voussoir.record import record_of
from voussoir.results import Results

#: Keys whose larger values are the finer ones
FINER_UP = ("voussoirs", "penalty_ratio", "young", "spans", "rings", "pier_courses")
#: Names that users say for keys
ALIASES = {"penalty": "penalty_ratio"}
#: Differences below this share of the largest value, of points of their way, are rounding
ROUNDING = 1e-9
#: Last errors that must shrink steadily, and largest difference of the two orders that they have
LAST, SPREAD = 3, 0.5
#: What is said of a result that does not depend on the key
SAME = "no order: the value is the same in all runs, to rounding"
#: Columns of results.csv that are followed where they have values
FOLLOWED = ("critical", "safety_thickness", "thrust_min", "thrust_max")


class StudyError(ValueError):
    """No study can be made: why, and what to do."""


@dataclass(frozen=True)
class Series:
    """A result over the values of the key."""

    name: str  #: What it is, such as "critical" or "u of point 1, case 2"
    unit: str  #: Its unit
    values: np.ndarray  #: From the coarsest run to the finest; NaN where a run has none
    scale: float = 0.0  #: Size of what the result is part of, such as the way of a point
    exact: float = math.nan  #: The exact value, NaN where none is given
    factor: float = 2.0  #: Ratio of the resolutions of two runs, above 1

    @property
    def rounding(self) -> float:
        """Differences up to this are rounding."""
        return ROUNDING * max(self.scale, float(np.nanmax(np.abs(self.values), initial=0.0)))

    @property
    def errors(self) -> np.ndarray:
        """Errors against the exact value; without one, differences from the next finer run: (n) or (n - 1)."""
        if math.isnan(self.exact):
            return np.abs(np.diff(self.values))
        return np.abs(self.values - self.exact)

    @property
    def orders(self) -> np.ndarray:
        """Order of each error after the first; NaN where an error is rounding, or does not shrink."""
        errors = self.errors
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.log(errors[:-1] / errors[1:]) / math.log(self.factor)
        return np.where((errors[1:] > self.rounding) & np.isfinite(found), found, np.nan)

    def verdict(self) -> tuple[float, str]:
        """The observed order, NaN if there is none, and a sentence that says it or says why."""
        errors = self.errors
        if np.isnan(self.values).any():
            return math.nan, "no order: a run has no value"
        if len(errors) < 2:
            return math.nan, "no order: three runs or more are needed"
        if np.all(errors <= self.rounding):
            return math.nan, SAME
        orders = self.orders
        if np.isnan(orders[-1]):
            return math.nan, "no order: the last runs agree to rounding"
        if not np.all(np.diff(errors[-LAST:]) < 0.0):
            return math.nan, "no order: the differences do not shrink steadily"
        if math.isnan(self.exact) and len(set(np.sign(np.diff(self.values)[-LAST:]))) > 1:
            return math.nan, "no order: the values go up and down"
        last = orders[-2:]
        if len(last) > 1 and not np.ptp(last) <= SPREAD:
            return math.nan, f"no order: the last two estimates, {last[0]:.2f} and {last[1]:.2f}, disagree"
        return float(last[-1]), f"observed order {last[-1]:.2f}"

    def limit(self) -> tuple[float, float]:
        """Extrapolated value and distance of the finest run from it; NaN where no order was observed."""
        order = self.verdict()[0]
        if math.isnan(order) or not order > 0.0 or not math.isnan(self.exact):
            return math.nan, math.nan
        rest = float(self.values[-1] - self.values[-2]) / (self.factor**order - 1.0)
        return float(self.values[-1]) + rest, abs(rest)


@dataclass(frozen=True)
class Study:
    """A convergence study."""

    key: str  #: The key with its group, such as "analysis%time_step"
    values: list[float]  #: Its values, from the coarsest to the finest
    steps: np.ndarray  #: Steps of each run, the sum of its cases
    series: list[Series]  #: What was followed

    @property
    def resolution(self) -> np.ndarray:
        """Values that shrink with finer runs: those of the key, or their reciprocals."""
        values = np.array(self.values)
        return 1.0 / values if self.key.rpartition("%")[2] in FINER_UP else values

    def notes(self) -> list[str]:
        """Limits of the study."""
        grows = self.steps[1:] / np.maximum(self.steps[:-1], 1)
        if self.key == "analysis%time_step" and len(grows) and grows.min() < 1.5:
            return ["the number of steps does not double: max_displacement_ratio limits the steps, too; raise it"]
        return []


def study(
    deck: str | Path, key: str, times: int, double: bool = False, at: float | None = None, exact: float | None = None,
    columns: Sequence[str] = (), jobs: int = 1, **set: Any
) -> Study:
    """Run a deck with the value of a key, and with that value halved (or doubled) `times` times.

    The key has a number, such as "time_step" or "arch%voussoirs"; "penalty" is penalty_ratio. There is one run more
    than halvings. Monitoring points are read at the time `at` [s], by default at the end. `exact` is the exact value of
    the only thing that is followed. Followed are the named columns of results.csv, and "u", "v" for displacements of
    the monitoring points; by default these and the columns of `FOLLOWED`, where they have values. `set` are other keys,
    as for `voussoir.run`. StudyError if the key has no number, a sweep has it, or nothing has a value.
    """
    dda = find_dda()
    bare = key.rpartition("%")[2]
    ((group, keys),) = groups_of(dda, {key[: len(key) - len(bare)] + ALIASES.get(bare, bare): 0}).items()
    (name,) = keys
    start = _start(dda, Path(deck), group, name, set)
    factor = 2.0 if double else 0.5
    values: list[Any] = [start["value"] * factor**turn for turn in range(times + 1)]
    if start["whole"]:
        if any(value != int(value) for value in values):
            raise StudyError(
                f"expected a number that can be halved {times} times, got {name} = {start['value']:g}; "
                f"set it to a multiple of {2**times}")
        values = [int(value) for value in values]
    if (name in FINER_UP) != double:
        values.reverse()
    key = f"{group}%{name}"
    runs = [run(deck, jobs=jobs, **{**set, key: value}) for value in values]
    series = [Series(*found, exact=math.nan if exact is None else exact) for found in _followed(runs, columns, at)]
    if not series:
        raise StudyError(
            "expected a result to follow, got none: search a parameter, put `measure x y` into the file of blocks, or "
            "name a column of results.csv with --y")
    if exact is not None and len(series) > 1:
        raise StudyError(
            f"expected one result beside its exact value, got {len(series)}; name one with --y, and its --case")
    steps = np.array([int(found.cases["steps"].sum()) for found in runs])
    return Study(key, [float(value) for value in values], steps, series)


def _start(dda: Path, deck: Path, group: str, name: str, set: dict[str, Any]) -> dict[str, Any]:
    """The value that a deck has for a key, and whether it is a whole number."""
    known = keys_of(dda).get(group, {}).get(name)
    if known is None or known["kind"] not in ("number", "whole"):
        raise StudyError(f"expected a key with one number, got {group}%{name}")
    record = record_of(ask(dda, deck, settings_of(groups_of(dda, set))).record.split("\n"), deck)
    if name in (sweep.name.rpartition("%")[2] for sweep in record.sweeps):
        raise StudyError(f"expected {name} in one group, got a &sweep of it; remove the sweep")
    value = record.setting(f"{group}%{name}") or known.get("default")
    if value is None:
        raise StudyError(f"{name} has no default; put {group}%{name} into the deck, or --set {group}%{name}=VALUE")
    return {"value": float(value), "whole": known["kind"] == "whole"}


def _followed(
    runs: list[Results], columns: Sequence[str], at: float | None
) -> list[tuple[str, str, np.ndarray, float]]:
    """Names, units, values and sizes of what is followed, from all runs."""
    first = runs[0]
    found = []
    for case in first.cases["case"].tolist():
        where = f", case {case}" if len(first.cases) > 1 else ""
        for name in columns or FOLLOWED:
            if name in ("u", "v"):
                continue
            if name not in first.cases or first.cases[name].dtype.kind not in "if":
                if columns:
                    raise StudyError(f"expected a column of numbers of results.csv, u or v, got '{name}'")
                continue
            values = np.array([float(each.case(case)[name]) for each in runs])
            if np.isfinite(values).any() and (columns or not np.isnan(values).all()):
                found.append((name + where, "", np.where(np.isfinite(values), values, np.nan), 0.0))
        for point, way in enumerate(first.points_of(case)):
            size = float(np.hypot(way["u"], way["v"]).max())
            for axis in (name for name in "uv" if not columns or name in columns):
                values = np.array([_reading(each, case, point, axis, at) for each in runs])
                found.append((f"{axis} of point {point + 1}{where}", "m", values, size))
    return found


def _reading(run_of: Results, case: int, point: int, axis: str, at: float | None) -> float:
    """Displacement of a monitoring point at a time: cubic between the steps, by velocities [m]."""
    ways = run_of.points_of(case)
    if point >= len(ways):
        return math.nan
    way = ways[point]
    if at is None:
        return float(way[axis][-1])
    time = way["time"]
    if not time[0] <= at <= time[-1]:
        return math.nan
    right = int(np.clip(np.searchsorted(time, at), 1, len(time) - 1))
    left, length = right - 1, float(time[right] - time[right - 1])
    s = (at - float(time[left])) / length if length > 0.0 else 0.0
    speed = way["v" + ("x" if axis == "u" else "y")]
    value, slope = way[axis], speed * length
    return float(
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * value[left] + s * (1.0 - s) ** 2 * slope[left]
        + s * s * (3.0 - 2.0 * s) * value[right] + s * s * (s - 1.0) * slope[right])
