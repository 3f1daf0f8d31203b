"""Design charts: the critical value of a sweep against what was swept."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from voussoir.plot.figure_style import INK, MARKERS, SMALL, Picture, legend_below, type_of
from voussoir.plot.position_chart import draw_positions
from voussoir.plot.units import axis_label, name_of, value_label
from voussoir.results import Results, Table

#: Words and units of columns of results that are no parameters
COLUMNS = {
    "thrust_min": ("least thrust", "N/m"), "thrust_max": ("greatest thrust", "N/m"),
    "safety_thickness": ("geometric safety factor", ""), "worst_position": ("worst position", "m"),
    "relative_error": ("relative error", ""), "sliding_share": ("share of sliding", ""),
    "seconds": ("run time", "s"), "contact_residual": ("contact residual", "m/s"),
    "path_time": ("pseudo-time of the path", ""), "steps": ("number of steps", ""),
}
#: Columns that a sweep may run over although they are not its own
_SHARED = ("half_angle_deg", "blocks", "friction_deg", "thickness_ratio", "geometry")
#: First and last column that every table has; swept parameters stand between
_BEFORE, _BEHIND = "case", "blocks"
#: Most curves that can be distinguished
MOST_CURVES = 8
#: Most curves whose colours differ; more are a map
MOST_COLOURS = 40
#: Most panels, and how many of them stand side by side
MOST_PANELS = 6
_ABREAST = 3
#: Fill where a case has no critical value
_NOTHING = "#c9c9c9"


class ChartError(ValueError):
    """No chart can be drawn: why, and what to do."""


def chart_columns(names: list[str]) -> set[str]:
    """Columns that a chart needs, of the names of all."""
    own = names[names.index(_BEFORE) : names.index(_BEHIND) + 1]
    return {*own, *_SHARED, "verdict", "critical", "exact"} & set(names)


def swept_columns(cases: Table) -> list[str]:
    """Columns that were swept and vary; `blocks` only where no other column explains it."""
    names = list(cases.columns)
    own = names[names.index(_BEFORE) + 1 : names.index(_BEHIND)]
    shared = [name for name in _SHARED if not (name == "blocks" and "voussoirs" in own)]
    return [name for name in own + shared if len(_values(cases, name)) > 1]


def draw_chart(run: Results, column: str | None = None) -> Figure:
    """Draw the critical value against one swept column, a curve for each value of the others, or maps.

    By default the column is the number with the most values. Points are the middles of brackets, crosses exact values
    of the same polygons; nothing is joined by lines that are not computed. ChartError if nothing was found or swept, or
    the curves are too many.
    """
    is_found = run.cases["verdict"] == "found"
    found = run.cases if np.all(is_found) else run.cases.take(is_found)
    swept = swept_columns(run.cases)
    numeric = [name for name in swept if found[name].dtype.kind in "if"]
    if column is None:
        if not numeric:
            raise ChartError("expected a swept number, got none; name a case instead: --case 1")
        column = max(numeric, key=lambda name: len(_values(found, name)))
    if column not in numeric:
        raise ChartError(
            f"expected one of {', '.join(numeric) or 'no columns'} to chart, got '{column}'; "
            "choose a number that was swept"
        )
    if len(found) < 2:
        raise ChartError("expected two critical values or more, got fewer; give the deck &search")
    others = [name for name in swept if name != column and not follows(found, name, column)]
    lost = len(run.cases) - len(found)
    missing = note_of(lost, len(run.cases), "critical")
    numbers = set(others) <= set(numeric)
    curves = _different(*(found[name] for name in others))
    if numbers and (len(others) == 2 and curves > MOST_CURVES or len(others) == 1 and curves > MOST_COLOURS):
        across, *panels = sorted(others, key=lambda name: -len(_values(found, name)))
        return draw_field(found, column, across, panels[0] if panels else None, column_label(run, "critical"), missing)
    groups = groups_of(found, others)
    if column == "position" and len(groups) == 1 and run.searched == "load_factor" and run.blocks is not None:
        return draw_positions(run, run.cases)
    if len(groups) <= MOST_CURVES:
        figure = _draw(run, groups, column)
    elif len(others) == 1 and numbers:
        figure = _draw_by_colour(run, groups, column, others[0])
    else:
        raise ChartError(
            f"expected at most {MOST_CURVES} curves or one number beside {column}, got "
            f"{len(groups)} curves of {', '.join(others)}; sweep fewer values, or fewer keys"
        )
    write_note(figure.axes[0], missing)
    return figure


def _draw(run: Results, groups: list[tuple[str, Table]], column: str) -> Figure:
    figure = Picture(figsize=(5.2, 3.9), layout="constrained")
    axes = figure.subplots()
    exact = False
    for number, (label, rows) in enumerate(in_order(groups, column)):
        color = INK[number % 3]
        known = ~np.isnan(rows["exact"])
        exact |= bool(known.any())
        axes.plot(
            rows[column], rows["critical"], linestyle="none", color=color, markersize=6, marker=MARKERS[number],
            markerfacecolor="white", label=label or "DDA")
        axes.plot(
            rows[column][known], rows["exact"][known], linestyle="none", color=color, marker="+", markersize=9,
            markeredgewidth=0.9)
    axes.set_xlabel(axis_label(column))
    axes.set_ylabel(column_label(run, "critical"))
    if exact:
        axes.plot(
            [], [], color=INK[0], linestyle="none", marker="+", markersize=9, markeredgewidth=0.9,
            label="limit analysis, same polygons")
    legend_below(axes, 1 if len(groups) == 1 else 2)
    return figure


def _draw_by_colour(run: Results, groups: list[tuple[str, Table]], column: str, other: str) -> Figure:
    """Curves too many for marks: their colour shows the second parameter."""
    figure = Picture(figsize=(5.4, 3.9), layout="constrained")
    axes = figure.subplots()
    values = [float(rows[other][0]) for _, rows in groups]
    scale = ScalarMappable(Normalize(min(values), max(values)), "viridis")
    for value, (_, rows) in zip(values, in_order(groups, column)):
        axes.plot(
            rows[column], rows["critical"], color=scale.to_rgba(np.array(value)), linestyle="none", marker=".",
            markersize=5)
    axes.set_xlabel(axis_label(column))
    axes.set_ylabel(column_label(run, "critical"))
    figure.colorbar(scale, ax=axes, label=axis_label(other))
    return figure


def draw_field(found: Table, column: str, across: str, panels: str | None, searched: str, note: str) -> Figure:
    """Draw critical values as coloured cells, one a case: nothing is computed between them.

    The swept numbers lie along and up; of a third one with more values than there is room for, evenly spaced maps are
    drawn, and it is said. The colours have a label, the maps a note above them.
    """
    kept = np.array([np.nan]) if panels is None else np.unique(found[panels])
    chosen = kept[np.unique(np.linspace(0, len(kept) - 1, min(len(kept), MOST_PANELS)).round().astype(int))]
    abreast = min(len(chosen), _ABREAST)
    rows = -(-len(chosen) // abreast)
    width = 5.2 if abreast == 1 else 2.6 * abreast + 0.8
    figure = Picture(figsize=(width, 3.8 if abreast == 1 else 2.5 * rows + 0.9), layout="constrained")
    grid = figure.subplots(rows, abreast, sharex=True, sharey=True, squeeze=False)
    x, y = np.unique(found[column]), np.unique(found[across])
    critical = found["critical"]
    scale = ScalarMappable(Normalize(float(critical.min()), float(critical.max())), "viridis")
    for number, axes in enumerate(grid.flat):
        if number >= len(chosen):
            axes.remove()
            continue
        mine = found if panels is None else found.take(found[panels] == chosen[number])
        field = np.full((len(y), len(x)), np.nan)
        field[np.searchsorted(y, mine[across]), np.searchsorted(x, mine[column])] = mine["critical"]
        axes.set_facecolor(_NOTHING)
        axes.grid(False)
        axes.pcolormesh(x, y, field, shading="nearest", cmap=scale.cmap, norm=scale.norm, rasterized=True)
        if panels is not None:
            axes.set_title(value_label(panels, float(chosen[number])), fontsize=type_of(1.0))
    figure.supxlabel(axis_label(column), fontsize=type_of(1.1))
    figure.supylabel(axis_label(across), fontsize=type_of(1.1))
    figure.colorbar(scale, ax=grid, label=searched)
    notes = [note] if note else []
    if len(chosen) < len(kept):
        words = axis_label(panels or "").partition(" [")[0]
        notes.insert(0, f"{len(chosen)} of {len(kept)} values of the {words}")
    if notes:
        figure.suptitle("; ".join(notes), fontsize=type_of(SMALL), color="#555555")
    return figure


def column_label(run: Results, column: str) -> str:
    """Words and unit of a column."""
    if column == "critical":
        return "critical " + axis_label(run.searched or "thickness_ratio")
    words, unit = COLUMNS.get(column) or name_of(column)
    return f"{words} [{unit}]" if unit else words


def note_of(lost: int, count: int, column: str, kinds: str = "") -> str:
    """How many cases have no value of a column, and in parentheses which; empty where all have one."""
    words = "critical value" if column == "critical" else f"value of {column}"
    return f"{lost} of {count} cases have no {words}" + (f" ({kinds})" if kinds else "") if lost else ""


def write_note(axes: Axes, words: str) -> None:
    """Write words above the axes, if there are any."""
    if words:
        axes.set_title(words, fontsize=type_of(SMALL), color="#555555")


def _values(cases: Table, name: str) -> set[Any]:
    column = np.unique(cases[name])
    return set(column[~np.isnan(column)].tolist() if column.dtype.kind == "f" else column.tolist())


def follows(cases: Table, name: str, column: str) -> bool:
    """Whether a column is a function of the abscissa, as in a linked sweep."""
    return _different(cases[column], cases[name]) == _different(cases[column])


def _different(*columns: np.ndarray) -> int:
    """How many rows differ in some columns; one of none."""
    code = np.zeros(1, dtype=np.int64)
    for column in columns:
        values, place = np.unique(column, return_inverse=True)
        code = np.unique(code * len(values) + place.ravel(), return_inverse=True)[1].ravel()
    return int(code.max(initial=0)) + 1


def groups_of(cases: Table, others: list[str]) -> list[tuple[str, Table]]:
    """Cases with the same values in some columns, each group with these in words."""
    keys = sorted(set(zip(*(cases[name].tolist() for name in others)))) if others else [()]
    groups = []
    for key in keys:
        rows = cases.where(**dict(zip(others, key)))
        label = ", ".join(value_label(name, value) for name, value in zip(others, key))
        groups.append((label, rows))
    return groups


def in_order(groups: list[tuple[str, Table]], column: str) -> list[tuple[str, Table]]:
    """Groups with their rows in ascending order of a column."""
    return [(label, rows.take(np.argsort(rows[column], kind="stable"))) for label, rows in groups]
