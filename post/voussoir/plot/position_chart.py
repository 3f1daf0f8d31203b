"""The load factor against the position of a vehicle, above the blocks that it drives over."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from voussoir.plot.case_picture import draw_blocks, draw_supports
from voussoir.plot.case_scene import scene_of
from voussoir.plot.figure_style import INK, SMALL, Picture, type_of
from voussoir.plot.sheet import WIDTH, Sheet
from voussoir.results import Results, Table

#: Factors are drawn up to so many times the least one
HEADROOM = 6.0
#: Height of the diagram, least and greatest height of the blocks, over the width
HEIGHT, LOWEST, HIGHEST = 0.5, 0.1, 0.55
#: Cases without a factor in the diagram, by their verdicts
_OTHERS = {
    "stable": ("^", "white", 0.97, "no multiple collapses it"),
    "collapsed": ("x", INK[2], 0.0, "dead load collapses"),
}


def draw_positions(run: Results, cases: Table, worst: float | None = None, sheet: Sheet = Sheet()) -> Figure:
    """Draw the load factor against the position of the leftmost axle, and the blocks of case 1 below it.

    A case without a factor has a mark that says why; the worst position is by default that of the least factor [m].
    """
    cases = cases.take(np.argsort(cases["position"], kind="stable"))
    place_of = cases["position"]
    factor = np.where(cases["verdict"] == "found", cases["critical"], np.nan)
    least = int(np.nanargmin(factor))
    place = float(place_of[least]) if worst is None else worst
    scene = scene_of(run, 1)
    shapes = scene.shapes(0.0)
    corners = np.vstack([*shapes, *(block.corners for block in scene.supports)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    left, right = min(low[0], place_of.min()), max(high[0], place_of.max())
    # as wide as the diagram, and as high as that makes them
    tall = float(np.clip(0.85 * (high[1] - low[1]) / (right - left), LOWEST, HIGHEST))
    width, pen = sheet.width, (sheet.width / WIDTH) ** 0.5
    figure = Picture(figsize=(width, width * (HEIGHT + tall + 0.12)), layout="constrained")
    figure.exact_size = True
    axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(HEIGHT, tall))
    top = HEADROOM * float(factor[least])
    axes.plot(place_of, factor, color=INK[1], marker=".", markersize=5 * pen, linewidth=1.3 * pen)
    over = factor > top
    marks = [(over, "^", INK[1], 0.97, f"above {top:.3g}")]
    marks += [(cases["verdict"] == verdict, *style) for verdict, style in _OTHERS.items()]
    known = np.isin(cases["verdict"], ("found", *_OTHERS))
    marks.append((~known, "d", "#efe3b5", 0.5, "undecided"))
    for mask, marker, face, level, words in marks:
        if mask.any():
            axes.plot(
                place_of[mask], np.full(int(mask.sum()), level * top), linestyle="none", marker=marker, color=INK[0],
                markerfacecolor=face, markersize=4.5 * pen, markeredgewidth=0.7 * pen, label=words, clip_on=False,
                zorder=5)
    for each in (axes, below):
        each.axvline(place, color=INK[2], linewidth=pen, linestyle="--")
    text = f"worst: leftmost axle at {place:.3g} m"
    text = text if worst is not None else f"least: {factor[least]:.3g} at {place:.3g} m"
    beyond = place > 0.5 * (left + right)
    axes.annotate(
        text, (place, 0.8), xycoords=("data", "axes fraction"), xytext=(-3 if beyond else 3, 0),
        ha="right" if beyond else "left", textcoords="offset points", color=INK[2], fontsize=type_of(SMALL),
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.8})
    axes.set_ylim(0.0, top)
    axes.set_ylabel("load factor [-]")
    if sheet.legend and axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=type_of(SMALL), loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, borderpad=0.1,
                    handletextpad=0.2, columnspacing=1.0)
    draw_supports(below, [block.corners for block in scene.supports], pen)
    draw_blocks(below, scene, shapes, (), pen)
    below.set_ylim(low[1], high[1] + 0.05 * (high[1] - low[1]))
    below.set_xlim(left, right)
    below.set_yticks([])
    below.grid(False)
    below.spines["left"].set_visible(False)
    below.set_xlabel("position of the leftmost axle [m]")
    return figure
