"""Plots of results in the verification manual: a displacement against time, or computed against exact values."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from voussoir_benches.deck_runs import read_rows

#: Size of a plot, its left, bottom and other margins [px]
_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _MARGIN = 260.0, 200.0, 52.0, 34.0, 14.0
_POINTS = 400  #: Most points of a drawn curve
_LEAST = 3  #: Values that a plot of computed against exact values needs
_LINES = ('fill="none" stroke="#20508c" stroke-width="1.2"',
          'fill="none" stroke="#c4502a" stroke-width="1.2" stroke-dasharray="5 3"')
_TEXT = 'font-family="sans-serif" font-size="10" fill="#333"'


def track_of(file: Path, case: int) -> np.ndarray:
    """Return time and displacements of the monitoring point of a case that moves most: (3, steps), or (3, 0)."""
    points: dict[str, list[list[float]]] = {}
    for row in read_rows(file, case):
        points.setdefault(row["point"], []).append([float(row[name]) for name in ("time", "u", "v")])
    tracks = [np.array(rows).T for rows in points.values()]
    return max(tracks, key=lambda track: float(np.ptp(track[1:], axis=1).max()), default=np.empty((3, 0)))


def history(track: np.ndarray) -> str:
    """Return the plot of u (solid) and v (dashed) against time as SVG."""
    low, high = float(track[1:].min()), float(track[1:].max())
    thin = track[:, np.unique(np.linspace(0, track.shape[1] - 1, _POINTS).astype(int))]
    curves = [_curve(thin[0], row, (float(track[0, 0]), float(track[0, -1])), (low, high), style)
              for row, style in zip(thin[1:], _LINES)]
    return _frame(curves, "time [s]", "u, v [m]", (float(track[0, 0]), float(track[0, -1])), (low, high))


def diagonal(exact: Sequence[float], computed: Sequence[float], unit: str) -> str:
    """Return the plot of computed against exact values as SVG; the diagonal is the exact answer."""
    values = np.array([*exact, *computed])
    ends = float(values.min()), float(values.max())
    marks = [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" {_LINES[0]}/>' for x, y in _places(exact, computed, ends, ends)]
    return _frame([_curve(ends, ends, ends, ends, _LINES[1]), *marks], f"exact {unit}", f"computed {unit}", ends, ends)


def has_history(track: np.ndarray) -> bool:
    """Return true if a point moves by more than round-off of its place."""
    return track.shape[1] > 1 and float(np.ptp(track[1:], axis=1).max()) > 1e-12


def has_diagonal(exact: Sequence[float]) -> bool:
    """Return true for enough different values of one magnitude."""
    sizes = np.abs(np.array(exact))
    return len(set(exact)) >= _LEAST and float(sizes.max()) < 100.0 * max(float(sizes.min()), 1e-300)


def _places(
    x: Sequence[float], y: Sequence[float], x_ends: tuple[float, float], y_ends: tuple[float, float]
) -> np.ndarray:
    """Places of values in the plot: (n, 2) [px]."""
    shares = [
        (np.asarray(values) - low) / (high - low) if high > low else np.full(len(values), 0.5)
        for values, (low, high) in ((x, x_ends), (y, y_ends))]
    return np.column_stack([
        _LEFT + shares[0] * (_WIDTH - _LEFT - _MARGIN), _MARGIN + (1.0 - shares[1]) * (_HEIGHT - _BOTTOM - _MARGIN)])


def _curve(
    x: Sequence[float], y: Sequence[float], x_ends: tuple[float, float], y_ends: tuple[float, float], style: str
) -> str:
    """A curve in SVG."""
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in _places(x, y, x_ends, y_ends))
    return f'<polyline points="{points}" {style}/>'


def _frame(
    parts: Sequence[str], x_name: str, y_name: str, x_ends: tuple[float, float], y_ends: tuple[float, float]
) -> str:
    """Curves with their axes, whose ends have three digits."""
    right, foot = _WIDTH - _MARGIN, _HEIGHT - _BOTTOM
    middle = f"{_MARGIN / 2 + 4:.0f},{(_MARGIN + foot) / 2:.0f}"
    labels = [
        (_LEFT, foot + 13, "start", f"{x_ends[0]:.3g}"), (right, foot + 13, "end", f"{x_ends[1]:.3g}"),
        ((_LEFT + right) / 2, foot + 26, "middle", x_name), (_LEFT - 4, foot, "end", f"{y_ends[0]:.3g}"),
        (_LEFT - 4, _MARGIN + 8, "end", f"{y_ends[1]:.3g}")]
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH:.0f}" height="{_HEIGHT:.0f}" '
        f'viewBox="0 0 {_WIDTH:.0f} {_HEIGHT:.0f}">',
        '<rect width="100%" height="100%" fill="#fff"/>',
        f'<polyline points="{_LEFT},{_MARGIN} {_LEFT},{foot} {right},{foot}" fill="none" stroke="#333"/>',
        *parts,
        *(f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{side}" {_TEXT}>{words}</text>' for x, y, side, words in labels),
        f'<text transform="translate({middle}) rotate(-90)" text-anchor="middle" {_TEXT}>{y_name}</text>',
        "</svg>", ""])
