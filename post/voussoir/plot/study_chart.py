"""The picture of a convergence study: errors against the key, beside a line of the observed order."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from voussoir.deck.study import Study
from voussoir.plot.design_chart import write_note
from voussoir.plot.figure_style import INK, MARKERS, Picture, legend_below
from voussoir.plot.units import axis_label

#: Most curves, and most labels of the axis
MOST, MOST_LABELS = 8, 5


def draw_study(study: Study, legend: bool = True) -> Figure:
    """Draw errors, or differences of successive runs, on logarithmic axes; values where nothing differs."""
    figure = Picture(figsize=(5.2, 3.8), layout="constrained")
    figure.exact_size = True
    axes = figure.subplots()
    drawn = [series for series in study.series[:MOST] if np.any(series.errors > 0.0)]
    values = np.array(study.values)
    for number, series in enumerate(drawn):
        errors = series.errors
        at = values[len(values) - len(errors):]
        order = series.verdict()[0]
        name = f"{series.name} [{series.unit}]" if series.unit else series.name
        words = name + (f": order {order:.2f}" if not math.isnan(order) else ": no order")
        color = INK[number % 3]
        axes.plot(
            at, np.where(errors > 0.0, errors, np.nan), color=color, marker=MARKERS[number], markersize=4.5,
            linewidth=0.9, markerfacecolor="white", label=words)
        if not math.isnan(order):
            reach = study.resolution[len(values) - len(errors):]
            axes.plot(at, errors[-1] * (reach / reach[-1]) ** order, color=color, linewidth=0.6, linestyle=(0, (3, 2)))
    axes.set_xlabel(axis_label(study.key))
    exact = bool(drawn) and not math.isnan(drawn[0].exact)
    axes.set_ylabel("error" if exact else "difference from the run before")
    if drawn:
        axes.set_xscale("log")
        axes.set_yscale("log")
        drawn_values = values if exact else values[1:]
        shown = drawn_values[:: -1 - (len(drawn_values) - 1) // MOST_LABELS]
        axes.set_xticks(shown, [f"{value:.3g}" for value in shown])
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_formatter(NullFormatter())
        if len(drawn) < len(study.series):
            write_note(axes, f"{len(drawn)} of {len(study.series)} results")
        if legend:
            legend_below(axes, 1 if len(drawn) < 4 else 2)
    else:
        write_note(axes, "no result differs between the runs")
    return figure
