"""The load factor against the position of a vehicle, above the blocks that it drives over."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from voussoir.plot.case_picture import draw_blocks, draw_supports
from voussoir.plot.case_scene import scene_of
from voussoir.plot.figure_style import INK, Picture
from voussoir.results import Results, Table

#: Factors are drawn up to so many times the least one
HEADROOM = 6.0
#: Width of what is drawn, height of the diagram, least and greatest height of the blocks [inch]
WIDTH, HEIGHT, LOWEST, HIGHEST = 4.6, 2.6, 0.5, 3.0


def draw_positions(run: Results, cases: Table, worst: float | None = None) -> Figure:
    """Draw the load factor against the position of the leftmost axle, and the blocks of case 1 below it.

    Cases without a factor leave a gap; the worst position is by default that of the least factor of the sweep [m].
    """
    cases = cases.take(np.argsort(cases["position"], kind="stable"))
    factor = np.where(cases["verdict"] == "found", cases["critical"], np.nan)
    least = int(np.nanargmin(factor))
    place = float(cases["position"][least]) if worst is None else worst
    scene = scene_of(run, 1)
    shapes = scene.shapes(0.0)
    corners = np.vstack(shapes)
    low, high = corners.min(axis=0), corners.max(axis=0)
    left, right = min(low[0], cases["position"].min()), max(high[0], cases["position"].max())
    # as wide as the diagram, and as high as that makes them
    tall = float(np.clip(WIDTH * (high[1] - low[1]) / (right - left), LOWEST, HIGHEST))
    figure = Picture(figsize=(WIDTH + 0.8, HEIGHT + tall + 0.6), layout="constrained")
    axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(HEIGHT, tall))
    axes.plot(cases["position"], factor, color=INK[1], marker=".", linewidth=1.4)
    for each in (axes, below):
        each.axvline(place, color=INK[2], linewidth=1.0, linestyle="--")
    text = f"worst: {place:.3f} m" if worst is not None else f"least: {factor[least]:.4g} at {place:.3f} m"
    axes.annotate(text, (place, 0.97), xycoords=("data", "axes fraction"), xytext=(4, -8), textcoords="offset points",
                  color=INK[2], fontsize=9)
    axes.set_ylim(0.0, HEADROOM * float(factor[least]))
    axes.set_ylabel("load factor")
    draw_supports(below, [block.corners for block in scene.supports])
    draw_blocks(below, scene, shapes)
    below.set_ylim(low[1], high[1] + 0.05 * (high[1] - low[1]))
    below.set_xlim(left, right)
    below.set_yticks([])
    below.set_xlabel("position of the leftmost axle [m]")
    return figure
