"""Marks of a picture: loads, restraints, bars, numbers of blocks, coordinates."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from voussoir.plot.case_scene import CaseScene
from voussoir.plot.figure_style import INK, SMALL, TINY, type_of
from voussoir.plot.motion import Motion
from voussoir.plot.sheet import POINTS, text_size
from voussoir.plot.source_file import Source
from voussoir.plot.units import quantity

#: Longest load in the picture, over its size; most loads that have their value beside them
LOAD_LENGTH, MOST_VALUES = 0.12, 12
#: Colours of bars and of live loads
BAR, LIVE = "#7a3b8f", "#1b7a3d"
#: Marks of restraints along both directions, x or y
_HELD: dict[str, tuple[dict[str, Any], str]] = {
    "": ({"marker": "^", "markerfacecolor": INK[0]}, "restraint"),
    "x": ({"marker": ">", "markerfacecolor": "white"}, "restraint along x"),
    "y": ({"marker": "^", "markerfacecolor": "white"}, "restraint along y"),
}


def entry(label: str, **style: Any) -> Line2D:
    """An entry of a legend."""
    return Line2D([], [], **({"linestyle": "none", "label": label} | style))


def load_arrows(source: Source, size: float, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Tails and tips of the loads, the longest of a fixed share of the picture: (n, 2) each [m]."""
    points = [point if point in source.still else motion.placed(point) for point, _, _ in source.loads]
    tips = np.array(points).reshape(-1, 2)
    forces = np.array([force for _, force, _ in source.loads]).reshape(-1, 2)
    largest = float(np.hypot(*forces.T).max(initial=0.0))
    return tips - forces * (LOAD_LENGTH * size / (largest or 1.0)), tips


def draw_loads(axes: Axes, source: Source, size: float, motion: Motion, pen: float = 1.0) -> list[Artist]:
    """Draw the forces that the deck puts on points; gives the entries of the legend."""
    tails, tips = load_arrows(source, size, motion)
    entries: list[Artist] = []
    for live, color, words in ((False, INK[0], "load"), (True, LIVE, "live load, before its factor")):
        chosen = [number for number, load in enumerate(source.loads) if load[2] == live and any(load[1])]
        for number in chosen:
            arrow = {
                "arrowstyle": "-|>", "color": color, "linewidth": 1.5 * pen, "shrinkA": 0, "shrinkB": 0,
                "mutation_scale": 10 * pen}
            axes.annotate("", tips[number], tails[number], arrowprops=arrow, zorder=8)
        if len(source.loads) <= MOST_VALUES:
            values = [quantity(float(np.hypot(*source.loads[number][1])), "N/m") for number in chosen]
            draw_values(axes, chosen, values, color, (tails, tips))
        if chosen:
            entries.append(entry(words, marker=r"$\downarrow$", markersize=type_of(SMALL), color=color))
    return entries


def draw_values(
    axes: Axes, chosen: list[int], values: list[str], color: str, arrows: tuple[np.ndarray, np.ndarray]
) -> None:
    """Write values of arrows: behind flat ones, beside others, equal neighbours once, above what they would hide."""
    figure: Any = axes.figure
    size = type_of(SMALL)
    axes.apply_aspect()
    tails, tips = (axes.transData.transform(ends) * POINTS / figure.dpi for ends in arrows)
    points, way = tails[chosen], (tips - tails)[chosen]
    places = arrows[0][chosen]
    written: list[tuple[np.ndarray, np.ndarray, str]] = [
        (np.minimum(tail, tip) - 3.0, np.maximum(tail, tip) + 3.0, "") for tail, tip in zip(tails, tips)]
    wanted: list[tuple[np.ndarray, str]] = []
    for number in np.lexsort((points[:, 1], points[:, 0])):
        value, low = values[number], points[number] + (4.0, 3.0)
        box = np.array(text_size(figure, value, size))
        if abs(way[number, 0]) > abs(way[number, 1]):
            low = points[number] + (-4.0 - box[0] if way[number, 0] > 0.0 else 4.0, -0.5 * box[1])
        hidden = [other for other in written if np.all((low < other[1]) & (other[0] < low + box))]
        if any(text == value and np.all(np.abs(low - place) < box) for place, text in wanted):
            continue
        wanted.append((low, value))
        left = points[number] + (-4.0 - box[0], 3.0)
        if any(not other[2] for other in hidden) and not any(
                np.all((left < other[1]) & (other[0] < left + box)) for other in written):
            low, hidden = left, []
        while hidden:
            low = np.array([low[0], max(other[1][1] for other in hidden) + 0.5])
            hidden = [other for other in written if np.all((low < other[1]) & (other[0] < low + box))]
        written.append((low, low + box, value))
        axes.annotate(
            value, places[number], xytext=tuple(low - points[number]), textcoords="offset points", fontsize=size,
            color=color, zorder=9)


def draw_held(axes: Axes, source: Source, motion: Motion, pen: float = 1.0) -> list[Artist]:
    """Draw points and lines that are held, and bars; gives the entries of the legend."""
    entries: list[Artist] = []
    for along, (mark, words) in _HELD.items():
        ends = [(motion.placed(pair[0]), motion.placed(pair[1])) for pair in source.held if pair[2] == along]
        for start, end in ends:
            axes.plot(
                *zip(start, end), color=INK[0], linewidth=2.0 * pen, zorder=7, markersize=6 * pen,
                markeredgecolor=INK[0], **mark)
        if ends:
            entries.append(entry(words, markeredgecolor=INK[0], markersize=6 * pen, **mark))
    for bar in source.bars:
        placed = [motion.placed(end) for end in bar]
        axes.plot(*zip(*placed), color=BAR, linewidth=1.7 * pen, marker="o", markersize=3 * pen, zorder=7)
    if source.bars:
        entries.append(entry("bar", linestyle="-", color=BAR, linewidth=1.7 * pen, marker="o", markersize=3 * pen))
    entries += draw_water(axes, source)
    entries += [entry(f"not drawn: {what}") for what in source.missing]
    return entries


def draw_water(axes: Axes, source: Source) -> list[Artist]:
    """Draw lines of heads, the surface of fill, faces that let waves out; gives the entries of the legend."""
    limits = axes.axis()
    styles: tuple[tuple[Any, str, dict[str, Any]], ...] = (
        (source.water, "piezometric line", {"color": "#1f77b4", "linewidth": 1.6, "linestyle": "-."}),
        (source.surface, "surface of the fill", {"color": INK[3], "linewidth": 0.9, "linestyle": "-"}),
        (source.absorbing, "face that lets waves out", {"color": INK[0], "linewidth": 2.2, "linestyle": ":"}),
    )
    entries: list[Artist] = []
    for lines, words, style in styles:
        for points in lines:
            axes.plot(*zip(*points), zorder=6, **style)
        if lines:
            entries.append(entry(words, **style))
    # a piezometric line may run far beyond the blocks
    axes.axis(limits)
    return entries


def draw_numbers(axes: Axes, scene: CaseScene, shapes: list[np.ndarray]) -> None:
    """Write each block's number on it."""
    placed = [(block.number, shape) for block, shape in zip(scene.blocks, shapes)]
    placed += [(block.number, block.corners) for block in scene.supports]
    for number, shape in placed:
        middle = shape.mean(axis=0)
        axes.text(
            middle[0], middle[1], str(number), fontsize=type_of(TINY), ha="center", va="center", zorder=10,
            clip_on=True, path_effects=[withStroke(linewidth=2.0, foreground="white")])


def show_coordinates(axes: Axes) -> None:
    """Give bare axes their ticks [m]."""
    axes.set_axis_on()
    axes.grid(False)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
