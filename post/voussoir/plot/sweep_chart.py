"""Charts of any column of results against what was swept: one key along the axis, or two keys as a map."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from voussoir.plot.design_chart import (
    MOST_CURVES, ChartError, column_label, follows, groups_of, in_order, note_of, swept_columns, write_note)
from voussoir.plot.figure_style import INK, MARKERS, TINY, Picture, legend_below, type_of
from voussoir.plot.units import axis_label
from voussoir.results import Results, Table

#: Verdicts in the order of a legend, and their colours
VERDICTS = {
    "stable": "#bcd0e0", "found": "#bcd0e0", "completed": "#dfe7ee", "undecided": "#efe3b5", "collapsed": "#d1632a"
}
#: Most contours of a map
MOST_CONTOURS = 7
#: Length of a contour over the sides of its map from which it has its value: labels of shorter ones overlap
LABELLED = 0.25
#: Colours of the values of a map: viridis without its yellow, on which white contours are lost
MAP_COLORS = ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.75, 256)))


def draw_sweep(run: Results, key: str, column: str | None = None, legend: bool = True) -> Figure:
    """Draw a column of results against a swept key, a curve for each combination of the other swept values.

    The key is that of a &sweep group, such as "radius" or "arch%radius"; the column, of numbers, is by default what was
    searched. Several curves are named with `legend`. ChartError if there is no such key or column, or too many curves.
    """
    x, y = swept(run, key), number_column(run, column)
    others = [name for name in swept_columns(run.cases) if name != x and not follows(run.cases, name, x)]
    groups = groups_of(run.cases, others)
    if len(groups) > MOST_CURVES:
        other = others[0] if len(others) == 1 else "KEY"
        raise ChartError(
            f"expected at most {MOST_CURVES} curves, got {len(groups)}; sweep fewer values, or draw "
            f"--map {key} {other}")
    figure = Picture(figsize=(5.2, 3.7), layout="constrained")
    figure.exact_size = True
    axes = figure.subplots()
    for number, (label, rows) in enumerate(in_order(groups, x)):
        axes.plot(
            rows[x], values_of(rows, y), color=INK[number % 3], linewidth=0.8, marker=MARKERS[number], markersize=4.5,
            markerfacecolor="white", label=label if len(others) != 1 else plain_value(rows[others[0]][0]))
    axes.set_xlabel(axis_label(x))
    axes.set_ylabel(column_label(run, y))
    if legend and len(groups) > 1:
        single = len(others) == 1
        legend_below(axes, min(len(groups), 4 if single else 1), title=axis_label(others[0]) if single else "")
    write_note(axes, note_of(int(np.count_nonzero(np.isnan(values_of(run.cases, y)))), len(run.cases), y))
    return figure


def plain_value(value: object) -> str:
    """A swept value without its name and unit."""
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)


def draw_map(run: Results, keys: tuple[str, str], column: str | None = None, legend: bool = True) -> Figure:
    """Draw a column of results over two swept keys: a coloured cell per case, with contours; or verdicts.

    Keys are those along and up. The column, of numbers, is by default what was searched, and without a search the
    verdicts, which are named with `legend`. ChartError if there are no such keys, or other keys were swept, too.
    """
    x, y = (swept(run, key) for key in keys)
    others = [name for name in swept_columns(run.cases) if name not in (x, y)]
    others = [name for name in others if not follows(run.cases, name, x) and not follows(run.cases, name, y)]
    if x == y or others:
        found = f"{x} twice" if x == y else f"also {', '.join(others)}"
        raise ChartError(f"expected two swept keys and no other, got {found}; sweep two keys")
    along, up = np.unique(run.cases[x]), np.unique(run.cases[y])
    place = (np.searchsorted(up, run.cases[y]), np.searchsorted(along, run.cases[x]))
    figure = Picture(figsize=(5.2, 4.0), layout="constrained")
    figure.exact_size = True
    axes = figure.subplots()
    axes.grid(False)
    axes.set_facecolor("#c9c9c9")
    axes.set_xlabel(axis_label(x))
    axes.set_ylabel(axis_label(y))
    field = np.full((len(up), len(along)), np.nan)
    if column is None and run.searched is None:
        names = list(VERDICTS)
        field[place] = [names.index(word) for word in run.cases["verdict"]]
        axes.pcolormesh(
            along, up, field, shading="nearest", cmap=ListedColormap(list(VERDICTS.values())), vmin=-0.5,
            vmax=len(names) - 0.5, rasterized=True)
        seen = [name for name in names if name in run.cases["verdict"]]
        if legend:
            legend_below(axes, len(seen), [Patch(facecolor=VERDICTS[name], label=name) for name in seen])
        return figure
    name = number_column(run, column)
    field[place] = values_of(run.cases, name)
    colors = axes.pcolormesh(along, up, field, shading="nearest", cmap=MAP_COLORS, rasterized=True)
    draw_contours(axes, along, up, field)
    figure.colorbar(colors, ax=axes, label=column_label(run, name))
    lost = np.isnan(values_of(run.cases, name))
    kinds = [f"{word} {np.count_nonzero(lost & (run.cases['verdict'] == word))}" for word in VERDICTS
             if name == "critical" and np.any(lost & (run.cases["verdict"] == word))]
    words = f"grey: {', '.join(kinds)}" if kinds else "grey"
    write_note(axes, note_of(int(np.count_nonzero(lost)), len(run.cases), name, words))
    return figure


def draw_contours(axes: Axes, along: np.ndarray, up: np.ndarray, field: np.ndarray) -> None:
    """Draw contours, linear between the computed cases; long ones have their value."""
    finite = field[np.isfinite(field)]
    if min(field.shape) < 2 or len(np.unique(finite)) < 3:
        return
    lines = axes.contour(along, up, np.ma.masked_invalid(field), levels=MOST_CONTOURS, colors="white", linewidths=0.8)
    sides = np.array([np.ptp(along), np.ptp(up)])
    # cells without a value break a contour: its longest piece has the label
    long, places = [], []
    for level, paths in zip(lines.levels, lines.allsegs):
        lengths = [np.hypot(*(np.diff(path, axis=0) / sides).T) for path in paths]
        longest = max(range(len(paths)), key=lambda piece: lengths[piece].sum(), default=None)
        if longest is None or not lengths[longest].sum() > LABELLED:
            continue
        reached = np.cumsum(lengths[longest])
        long.append(level)
        places.append(tuple(paths[longest][1 + int(np.searchsorted(reached, 0.5 * reached[-1]))]))
    if long:
        axes.clabel(lines, long, fmt="%.3g", fontsize=type_of(TINY), manual=places)


def swept(run: Results, key: str) -> str:
    """Column of a swept key; ChartError if it was not swept, or has words."""
    columns = swept_columns(run.cases)
    numbers = [name for name in columns if run.cases[name].dtype.kind in "if"]
    bare = key.rpartition("%")[2]
    chosen = next((name for name in (key, bare) if name in numbers), None)
    ends = [name for name in numbers if name.rpartition("%")[2] == bare]
    if chosen is None and len(ends) == 1:
        chosen = ends[0]
    if chosen is None:
        raise ChartError(f"expected a swept number, one of {', '.join(numbers) or 'none'}, got '{key}'")
    return chosen


def number_column(run: Results, column: str | None) -> str:
    """A column of numbers; by default the critical value of a search."""
    if column is None:
        if run.searched is None:
            raise ChartError("expected a column of numbers for the ordinate, got none; name it with --y COLUMN")
        return "critical"
    if column not in run.cases or run.cases[column].dtype.kind not in "if":
        names = [name for name in run.cases if run.cases[name].dtype.kind in "if" and name != "case"]
        filled = [name for name in names if not np.all(np.isnan(run.cases[name].astype(float)))]
        raise ChartError(f"expected a column of numbers, one of {', '.join(filled)}, got '{column}'")
    return column


def values_of(rows: Table, column: str) -> np.ndarray:
    """A column as floats, NaN where a case has no value."""
    values = np.asarray(rows[column], dtype=float).copy()
    if column == "critical":
        values[rows["verdict"] != "found"] = np.nan
    values[~np.isfinite(values)] = np.nan
    return values
