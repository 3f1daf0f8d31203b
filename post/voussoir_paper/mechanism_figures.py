"""Figures 8, 9, 12, 13, 15, 16 and 18 of the paper: collapsed arches."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D

from voussoir.plot.collapse_picture import MARKS, MEANINGS, draw_frame, limits, set_limits
from voussoir.results import Results
from voussoir_paper.campaign import Campaign

Row = dict[str, Any]


def friction_modes(campaign: Campaign) -> Figure:
    """Figure 8: collapse of 36 blocks at four friction angles."""
    run = campaign.results("figure8")
    figure = gallery(run, list(run.cases["case"]), 2, _friction_title, size=5.0, together=True)
    return mark_legend(figure, ("intrados", "extrados", "slip"))


def _friction_title(row: Row) -> str:
    mu = math.tan(math.radians(row["friction_deg"]))
    return (
        f"$\\varphi$ = {row['friction_deg']:g}° ($\\mu$ = {mu:.3f}):\n"
        f"{row['collapse_mode']}, sliding share {row['sliding_share']:.3f}"
    )


def short_friction_title(row: Row) -> str:
    """Friction angle and mode of a case."""
    return f"$\\varphi$ = {row['friction_deg']:g}°: {row['collapse_mode']}"


def block_numbers(campaign: Campaign) -> Figure:
    """Figure 9: collapse against the number of blocks, a grid for each of two thicknesses."""
    run = campaign.results("figure9")
    ratios = list(dict.fromkeys(run.cases["thickness_ratio"].tolist()))
    groups = [run.cases.where(thickness_ratio=ratio)["case"].tolist() for ratio in ratios]
    figure = plt.figure(figsize=(5.6, 4.2 * len(groups)), layout="constrained")
    parts: Any = figure.subfigures(len(groups), 1, hspace=0.03)
    for part, ratio, numbers, word in zip(parts, ratios, groups, ("Heyman's", "that of CCR")):
        gallery(run, numbers, 3, _blocks_title, size=3.5, into=part)
        part.suptitle(f"$\\eta$ = {ratio:g}, {word}", fontsize=12, x=0.01, ha="left")
    return mark_legend(figure)


def _blocks_title(row: Row) -> str:
    if row["verdict"] != "collapsed":
        return f"{row['blocks']} blocks: {row['verdict']}"
    return f"{row['blocks']} blocks: $\\beta$ = {_angles(row['intrados_hinge_deg'])}"


def imposed_at_90(campaign: Campaign) -> Figure:
    """Figure 12: four blocks, half angle 90 degrees."""
    return _imposed(campaign.results("figure12"), 3)


def imposed_at_140(campaign: Campaign) -> Figure:
    """Figure 15: four blocks, half angle 140 degrees."""
    return _imposed(campaign.results("figure15"), 3)


def _imposed(run: Results, columns: int) -> Figure:
    figure = gallery(run, list(run.cases["case"]), columns, imposed_title, size=3.5)
    return mark_legend(figure)


def imposed_title(row: Row) -> str:
    """Imposed joint and critical thickness of a case."""
    return f"$\\beta$ = {row['joints_deg(2)']:g}°, $\\eta$ = {row['critical']:.5f}"


def sample_at_90(campaign: Campaign) -> Figure:
    """Figure 13: four blocks, half angle 90 degrees, joint at 54.5 degrees."""
    return _sample(campaign.results("figure12"), 54.5)


def sample_at_140(campaign: Campaign) -> Figure:
    """Figure 16: four blocks, half angle 140 degrees, joint at 59 degrees."""
    return _sample(campaign.results("figure15"), 59.0)


def case_of_joint(run: Results, beta: float) -> int:
    """Case whose imposed joint lies at an angle [deg]."""
    return int(run.cases.where(**{"joints_deg(2)": beta})["case"][0])


def _sample(run: Results, beta: float) -> Figure:
    figure = gallery(run, [case_of_joint(run, beta)], 1, imposed_title, size=7.0, width=4.8)
    return mark_legend(figure)


def half_angles(campaign: Campaign) -> Figure:
    """Figure 18: blocks of 5 degrees, half angles from 45 to 145 degrees."""
    run = campaign.results("figure18")
    figure = gallery(run, list(run.cases["case"]), 3, _half_angle_title, size=2.5)
    return mark_legend(figure)


def _half_angle_title(row: Row) -> str:
    return (
        f"$\\alpha$ = {row['half_angle_deg']:g}°: $\\beta$ = {_angles(row['intrados_hinge_deg'])},\n"
        f"$\\eta$ = {row['critical']:.5f}"
    )


def short_half_angle_title(row: Row) -> str:
    """Half angle and hinges of a case."""
    return f"$\\alpha$ = {row['half_angle_deg']:g}°, $\\beta$ = {_angles(row['intrados_hinge_deg'])}"


def _angles(hinges: tuple[float, ...]) -> str:
    return ", ".join(f"{angle:g}°" for angle in hinges)


def gallery(
    run: Results, numbers: list[int], columns: int, title: Callable[[Row], str], size: float, width: float = 5.6,
    together: bool = False, into: SubFigure | None = None
) -> Figure:
    """Last pictures of some cases side by side; those of one row are of one shape, so that they stand in line.

    `title` gives the words above a picture from the row of its case; marks have a size in points; with `together` all
    show the same piece of the plane; without `into` they make a figure of their own, so many inches wide.
    """
    boxes = [limits(run, numbers if together else [number]) for number in numbers]
    shapes = [(high[1] - low[1]) / (high[0] - low[0]) for low, high in boxes]
    rows = [slice(first, first + columns) for first in range(0, len(numbers), columns)]
    tallest = [max(shapes[row]) for row in rows]
    heights = [width / columns * shape + 0.4 for shape in tallest]
    figure = into or plt.figure(figsize=(width, sum(heights)), layout="constrained")
    grid = figure.subplots(len(rows), columns, height_ratios=heights, squeeze=False)
    for axes in grid.flat[len(numbers) :]:
        axes.set_axis_off()
    for place, (axes, number, (low, high)) in enumerate(zip(grid.flat, numbers, boxes)):
        draw_frame(axes, run, number, run.frames_of(number)[-1], size)
        top = low[1] + tallest[place // columns] * (high[0] - low[0])
        set_limits(axes, (low, np.array([high[0], top])))
        axes.set_title(title(run.case(number)), fontsize=9.5)
    return figure.figure


def mark_legend(figure: Figure, kinds: tuple[str, ...] = ("intrados", "extrados")) -> Figure:
    """Explain the marks below a figure."""
    entries = [Line2D([], [], linestyle="none", markersize=6, label=MEANINGS[kind], **MARKS[kind]) for kind in kinds]
    figure.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=len(kinds))
    return figure
