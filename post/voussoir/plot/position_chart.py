"""The load factor against the position of a vehicle, above the blocks that it drives over."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
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
#: Height of the arrows of axles, over that of the blocks and the fill
AXLES = 0.35
#: Colour of the other direction of travel
DARK = "#555555"
#: Cases without a factor in the diagram, by their verdicts
_OTHERS = {
    "stable": ("^", "white", 0.97, "no multiple collapses it"),
    "collapsed": ("x", INK[2], 0.0, "dead load collapses"),
}


def draw_positions(
    run: Results, cases: Table, worst: float | None = None, sheet: Sheet = Sheet(),
    axles: Sequence[tuple[float, float]] = (), other: tuple[float, float] | None = None
) -> Figure:
    """Draw the load factor against the position of the leftmost axle, and the blocks of case 1 below it.

    A case without a factor has a mark that says why; the worst position is by default that of the least factor [m].
    Axles, by place [m] and weight [N/m], stand above the blocks. `other` has load factor and worst position of the
    other direction of travel.
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
    left = min([low[0], place_of.min(), *(at for at, _ in axles)])
    right = max([high[0], place_of.max(), *(at for at, _ in axles)])
    road = float(high[1]) + float(run.setting("fill%height") or 0.0)
    high[1] = road + (AXLES * (road - low[1]) if axles else 0.0)
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
    middle = 0.5 * (left + right)
    note_place(axes, (place, 0.8), text, INK[2], place > middle)
    if other is not None:
        axes.axvline(other[1], color=DARK, linewidth=pen, linestyle=":")
        words = f"other direction: {other[0]:.3g} at {other[1]:.3g} m"
        note_place(axes, (other[1], 0.67), words, DARK, other[1] > middle)
    axes.set_ylim(0.0, top)
    axes.set_ylabel("load factor [-]")
    if sheet.legend and axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=type_of(SMALL), loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, borderpad=0.1,
                    handletextpad=0.2, columnspacing=1.0)
    draw_supports(below, [block.corners for block in scene.supports], pen)
    draw_blocks(below, scene, shapes, (), pen)
    for at, _ in axles:
        tip = {"arrowstyle": "-|>", "color": INK[2], "linewidth": 1.2 * pen, "shrinkA": 0, "shrinkB": 0,
               "mutation_scale": 7.0 * pen}
        below.annotate("", (at, road), (at, high[1]), arrowprops=tip)
    below.set_ylim(low[1], high[1] + 0.05 * (high[1] - low[1]))
    below.set_xlim(left, right)
    below.set_yticks([])
    below.grid(False)
    below.spines["left"].set_visible(False)
    below.set_xlabel("position of the leftmost axle [m]")
    return figure


def note_place(axes: Axes, place: tuple[float, float], words: str, color: str, leftwards: bool) -> None:
    """Write words beside a vertical line, at its abscissa [m] and a share of the height, to its left or right."""
    axes.annotate(
        words, place, xycoords=("data", "axes fraction"), xytext=(-3 if leftwards else 3, 0),
        ha="right" if leftwards else "left", textcoords="offset points", color=color, fontsize=type_of(SMALL),
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.8})
