"""Fragility curves: the share of records that make blocks collapse, against how strong they are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from voussoir.plot.design_chart import ChartError, swept_columns, write_note
from voussoir.plot.figure_style import INK, Picture
from voussoir.plot.units import axis_label
from voussoir.results import Results, Table

#: Swept columns that say how strong a motion is, the first that is there counts
_STRENGTHS = ("amplitude", "scale", "ground%amplitude", "ground%scale")
#: Steps of Fisher's scoring, and the step below which it has converged
_MOST_STEPS, _CONVERGED = 100, 1e-12
_normal = np.vectorize(lambda z: 0.5 * math.erfc(-z / math.sqrt(2.0)), otypes=[float])


@dataclass(frozen=True)
class Lognormal:
    """A lognormal fragility: P(x) = Phi(ln(x/median)/dispersion)."""

    median: float  #: Strength at which half of the records make the blocks collapse
    dispersion: float  #: Standard deviation of its logarithm

    def __call__(self, strength: np.ndarray) -> np.ndarray:
        """Probability of collapse at some strengths."""
        return np.asarray(_normal(np.log(np.asarray(strength) / self.median) / self.dispersion))


def fit_shares(strength: np.ndarray, collapsed: np.ndarray, total: np.ndarray) -> Lognormal | None:
    """The most likely lognormal of collapsed of all records at each strength (Baker 2015, Earthquake Spectra 31:579).

    None where the likelihood has no maximum: what collapses and what does not is parted by one strength.
    """
    tried, falls = strength[total > 0], collapsed[total > 0] > 0
    stands = collapsed[total > 0] < total[total > 0]
    if not falls.any() or not stands.any() or tried[stands].max() <= tried[falls].min():
        return None
    design = np.column_stack((np.ones(len(strength)), np.log(strength)))
    beta = np.array([-np.log(strength).mean(), 1.0])
    for _ in range(_MOST_STEPS):
        z = np.clip(design @ beta, -6.0, 6.0)
        share, density = _normal(z), np.exp(-(z**2) / 2.0) / math.sqrt(2.0 * math.pi)
        weight = total * density**2 / (share * (1.0 - share))
        score = design.T @ (weight * (collapsed - total * share) / np.maximum(total * density, 1e-300))
        step = np.linalg.solve(design.T @ (weight[:, None] * design), score)
        beta = beta + step
        if np.abs(step).max() < _CONVERGED:
            break
    if not beta[1] > 0.0:
        return None
    return Lognormal(math.exp(-beta[0] / beta[1]), 1.0 / beta[1])


def fit_values(critical: np.ndarray) -> Lognormal | None:
    """The lognormal of critical strengths, one a record, by the moments of their logarithms; None of fewer than two."""
    logs = np.log(critical)
    if len(logs) < 2 or not logs.std() > 0.0:
        return None
    return Lognormal(math.exp(logs.mean()), float(logs.std(ddof=1)))


def draw_fragility(run: Results, column: str | None = None) -> tuple[Figure, Lognormal | None]:
    """Draw the fragility of a sweep over records and strengths, or of searches for the strength of each record.

    The column is by default amplitude or scale. Shares are points, the lognormal (None where there is none) a line.
    ChartError if the results have no fragility.
    """
    found = run.cases.take(run.cases["verdict"] == "found")
    if len(found) > 1 and column is None:
        strength, share, fit = _of_searches(found)
        left, name = len(run.cases) - len(found), run.searched or "strength"
    else:
        decided = np.isin(run.cases["verdict"], ("collapsed", "completed", "stable"))
        column = column or _strength_column(run.cases)
        if column not in swept_columns(run.cases):
            raise ChartError(f"expected a swept column of numbers, got '{column}'; name another")
        strength, share, fit = _of_verdicts(run.cases.take(decided), column)
        left, name = len(run.cases) - int(decided.sum()), column
    figure = Picture(figsize=(5.2, 3.9), layout="constrained")
    axes = figure.subplots()
    axes.plot(strength, share, "o", color=INK[0], label="computed", zorder=3, clip_on=False)
    if fit:
        fine = np.geomspace(strength.min() / 1.5, strength.max() * 1.3, 200)
        words = f"lognormal: median {fit.median:.4g}, dispersion {fit.dispersion:.3g}"
        axes.plot(fine, fit(fine), color=INK[1], label=words)
    axes.set(xlabel=axis_label(name), ylabel="share of records with collapse", ylim=(-0.02, 1.02), xlim=(0.0, None))
    axes.legend(loc="best")
    notes = [f"{left} of {len(run.cases)} cases without a verdict"] if left else []
    notes += [] if fit else ["no lognormal fit: all records collapse above one value and none below"]
    write_note(axes, "; ".join(notes))
    return figure, fit


def _strength_column(cases: Table) -> str:
    """The swept column that says how strong a motion is."""
    swept = swept_columns(cases)
    for name in _STRENGTHS:
        if name in swept:
            return name
    raise ChartError(f"expected a sweep of amplitude or scale, got {', '.join(swept) or 'no sweep'}; name the column")


def _of_verdicts(cases: Table, column: str) -> tuple[np.ndarray, np.ndarray, Lognormal | None]:
    """Strengths, shares of collapse, and their lognormal."""
    values = np.asarray(cases[column], dtype=float)
    if len(values) == 0 or not (values > 0.0).all():
        raise ChartError(f"expected strengths above 0 in column {column}, got others; sweep others")
    strength, place = np.unique(values, return_inverse=True)
    total = np.bincount(place).astype(float)
    collapsed = np.bincount(place, weights=(cases["verdict"] == "collapsed").astype(float))
    return strength, collapsed / total, fit_shares(strength, collapsed, total)


def _of_searches(found: Table) -> tuple[np.ndarray, np.ndarray, Lognormal | None]:
    """Critical strengths in order, their shares, and their lognormal."""
    critical = np.sort(np.asarray(found["critical"], dtype=float))
    if not (critical > 0.0).all():
        raise ChartError("expected critical strengths above 0, got others; search from 0 on")
    return critical, (np.arange(len(critical)) + 1.0) / len(critical), fit_values(critical)
