"""The drawing of an assessment: blocks, supports, fill, axles, and dimensions of what the deck says."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from voussoir.deck.assessment import Assessment
from voussoir.plot.case_picture import draw_blocks, draw_supports
from voussoir.plot.case_scene import CaseScene, scene_of, view
from voussoir.plot.figure_style import INK, SMALL, type_of
from voussoir.plot.sheet import Sheet
from voussoir.plot.units import quantity
from voussoir.results import Results

#: Room between a dimension and what it measures, over the size
ROOM = 0.07
#: Distance below which labels of axles overlap, over the size
CLOSE = 0.25


@dataclass(frozen=True)
class Dimension:
    """A length in the drawing: what it is called, its ends [m], and which way its line is moved off them."""

    name: str
    start: tuple[float, float]
    end: tuple[float, float]
    away: tuple[float, float]

    @property
    def length(self) -> float:
        """Its length [m]."""
        return math.dist(self.start, self.end)


def dimensions(run: Results, scene: CaseScene) -> list[Dimension]:
    """Clear span, rise and thicknesses of an arch of one span; of others the whole width and height."""
    corners = np.vstack([block.corners for block in scene.blocks])
    low, high = corners.min(axis=0), corners.max(axis=0)
    inner = springings(run, corners)
    whole = [
        Dimension("overall width", (low[0], low[1]), (high[0], low[1]), (0.0, -1.0)),
        Dimension("overall height", (high[0], low[1]), (high[0], high[1]), (1.0, 0.0)),
    ]
    if inner is None:
        return whole
    left, right = inner
    middle = 0.5 * (left[0] + right[0])
    crown = scene.crossings(middle)
    if len(crown) < 2:
        return whole
    base = min(left[1], right[1])
    found = [Dimension("clear span", (left[0], base), (right[0], base), (0.0, -1.0))]
    rise = Dimension("rise", (middle, left[1]), (middle, crown[0]), (0.0, 0.0))
    if rise.length > 1e-9:
        found.append(rise)
    found.append(Dimension("crown thickness", (middle, crown[0]), (middle, crown[-1]), (0.0, 0.0)))
    return found


def springings(run: Results, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Corners of the intrados at the two springings, as the deck says where they are; None of several spans."""
    if int(run.setting("arch%spans") or 1) > 1:
        return None
    span = run.setting("arch%span")
    if span is None:
        half = math.radians(float(run.setting("arch%half_angle_deg") or 90.0))
        radius, ratio = float(run.setting("arch%radius") or 10.0), float(run.setting("arch%thickness_ratio") or 0.15)
        thickness = run.setting("arch%thickness")
        inner = radius - 0.5 * (float(thickness) if thickness else ratio * radius)
        reach, level = inner * math.sin(half), inner * math.cos(half)
    else:
        reach, level = 0.5 * float(span), 0.0
    ends = []
    for side in (-1.0, 1.0):
        off = np.abs(corners[:, 0] - side * reach)
        if span is None:
            off = off + np.abs(corners[:, 1] - level)
        best = int(np.argmin(off + 1e-9 * np.abs(corners[:, 1])))
        if off[best] > 1e-6 * max(reach, 1.0):
            return None
        ends.append(corners[best])
    return ends[0], ends[1]


def draw_scheme(found: Assessment, sheet: Sheet = Sheet()) -> tuple[Figure, str]:
    """Draw the blocks with dimensions, supports, fill and axles; and the dimensions in words."""
    scene = scene_of(found.own, 1)
    shapes, fixed = scene.shapes(0.0), [block.corners for block in scene.supports]
    corners = np.vstack(shapes)
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = float((high - low).max())
    surface = found.surface
    road = surface if surface is not None else float(high[1])
    box_low, box_high = view(shapes, fixed)
    top = road + (0.2 * size if found.axles else 0.02 * size)
    measured = dimensions(found.own, scene)
    room = max([0.0, *(dimension.away[0] for dimension in measured)]) * (ROOM + 0.1) * size
    box_low = np.minimum(box_low, [low[0], low[1] - (ROOM + 0.07) * size])
    box_high = np.maximum(box_high, [high[0] + room, top])
    for place, _ in found.axles:
        box_low[0], box_high[0] = min(box_low[0], place), max(box_high[0], place)
    figure, axes = sheet.start(box_low, box_high)
    pen = sheet.pen(len(shapes))
    draw_supports(axes, fixed, pen)
    draw_blocks(axes, scene, shapes, (), pen)
    if surface is not None:
        axes.plot([box_low[0], box_high[0]], [surface, surface], color=INK[3], linewidth=pen)
        axes.annotate(
            "surface of the fill", (box_high[0], surface), xytext=(0, 2), textcoords="offset points", ha="right",
            fontsize=type_of(SMALL), color="#555555")
    for dimension in measured:
        draw_dimension(axes, dimension, size, pen)
    for place, _ in found.axles:
        tip = {"arrowstyle": "-|>", "color": INK[2], "linewidth": 1.4 * pen, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (place, road), (place, road + 0.13 * size), arrowprops=tip)
    for places, weight in axle_groups(found.axles, CLOSE * size):
        words = (f"{len(places)} x " if len(places) > 1 else "") + quantity(weight, "N/m")
        axes.text(float(np.mean(places)), road + 0.14 * size, words, ha="center", fontsize=type_of(SMALL), color=INK[2])
    words = ", ".join(f"{dimension.name} {quantity(dimension.length, 'm')}" for dimension in measured)
    return sheet.finish(figure, axes), words[0].upper() + words[1:] + "."


def axle_groups(axles: Sequence[tuple[float, float]], close: float) -> list[tuple[list[float], float]]:
    """Return places and weight of neighbouring axles that are equal and so close that their labels would overlap."""
    groups: list[tuple[list[float], float]] = []
    for place, weight in sorted(axles):
        if groups and weight == groups[-1][1] and place - groups[-1][0][-1] < close:
            groups[-1][0].append(place)
        else:
            groups.append(([place], weight))
    return groups


def draw_dimension(axes: Axes, dimension: Dimension, size: float, pen: float) -> None:
    """Draw a line with its length."""
    away = ROOM * size * np.array(dimension.away)
    start, end = np.array(dimension.start) + away, np.array(dimension.end) + away
    style: dict[str, Any] = {"arrowstyle": "<->", "color": INK[0], "linewidth": 0.8 * pen, "shrinkA": 0, "shrinkB": 0,
             "mutation_scale": 6}
    short = dimension.length < 0.12 * size
    if short:
        style["arrowstyle"] = "|-|,widthA=0.2,widthB=0.2"
    axes.annotate("", (start[0], start[1]), (end[0], end[1]), arrowprops=style, zorder=8)
    flat = abs(end[1] - start[1]) < abs(end[0] - start[0])
    middle = 0.5 * (start + end)
    text = quantity(dimension.length, "m")
    offset, ha, va = ((0, -2), "center", "top") if flat else ((3, 0), "left", "center")
    axes.annotate(
        text, (middle[0], middle[1]), xytext=offset, textcoords="offset points", ha=ha, va=va, fontsize=type_of(SMALL),
        zorder=9, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85} if short else None)
