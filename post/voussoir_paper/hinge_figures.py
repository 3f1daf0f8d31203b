"""Figures 10 and 19 of the paper: where the haunches turn."""

from __future__ import annotations

import math

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from voussoir import theory
from voussoir.plot.figure_style import INK
from voussoir.results import Table
from voussoir_paper.campaign import Campaign
from voussoir_paper.curve_figures import CURVES, POINTS
from voussoir_paper.tables import THEORIES
from voussoir_paper.paper_style import DASHES

_WINDOW = (44.0, 63.0)


def block_numbers(campaign: Campaign) -> Figure:
    """Figure 10: hinge angle against the number of blocks, for two thicknesses."""
    tables = {"ours, elastic": campaign.results("figure9").cases, "ours, rigid": campaign.results("figure10").cases}
    thicknesses = np.unique(tables["ours, rigid"]["thickness_ratio"])
    figure, grid = plt.subplots(len(thicknesses), 1, figsize=(5.2, 7.0), sharex=True, layout="constrained")
    for axes, eta, word in zip(grid, thicknesses, ("Heyman's", "that of CCR")):
        cases = {name: table.where(thickness_ratio=eta) for name, table in tables.items()}
        blocks = cases["ours, rigid"]["blocks"]
        _draw_grid(axes, blocks)
        for name, heading in THEORIES.items():
            beta = math.degrees(theory.critical(math.pi / 2, name)[0])
            color, dashes = CURVES[name]
            axes.axhline(beta, color=color, linestyle=dashes, linewidth=1.2, label=f"{heading} {beta:.2f}°")
        for name, table in cases.items():
            _draw_hinges(axes, table, name)
        axes.set_ylim(*_WINDOW)
        axes.set_xticks(range(len(blocks)), [f"{n}" for n in blocks])
        axes.set_ylabel(r"intrados hinge $\beta$ [deg]")
        axes.set_title(f"$\\eta$ = {eta:g}, {word}", fontsize=10, loc="left")
    grid[-1].set_xlabel("number of blocks [-]")
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3, fontsize=9)
    return figure


def _draw_grid(axes: Axes, blocks: np.ndarray) -> None:
    """The joints among which an arch can choose."""
    for place, number in enumerate(blocks):
        joints = np.arange(number // 2 + 1) * 180.0 / number
        axes.plot(
            np.full(joints.size, place), joints, marker="_", markersize=16, color="#a8a8a8", linestyle="none",
            label="joints of the arch" if place == 0 else None, zorder=1
        )
    axes.grid(False)


def _draw_hinges(axes: Axes, table: Table, name: str) -> None:
    """The hinges of the arches that fall, and a word for those that stand."""
    places = [(p, beta) for p, row in enumerate(table["intrados_hinge_deg"]) for beta in row]
    axes.plot(*zip(*places), linestyle="none", label=name, zorder=4, **POINTS[name])
    height = 45.4 if name == "ours, rigid" else 47.4
    for place in np.flatnonzero(table["verdict"] == "stable"):
        word = name.removeprefix("ours, ")
        axes.text(
            float(place), height, f"{word}:\nstands", ha="center", va="center", fontsize=8.5,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0}, zorder=5)


def half_angles(campaign: Campaign) -> Figure:
    """Figure 19: hinge angle against the half angle of embrace."""
    table = campaign.tables["table4"]
    figure, axes = plt.subplots(figsize=(5.2, 4.6))
    for name, heading in THEORIES.items():
        alpha = np.linspace(1e-3, theory.limits(name)["alpha_limit"] * (1.0 - 1e-12), 800)
        color, dashes = CURVES[name]
        beta = theory.critical(alpha, name)[0]
        axes.plot(np.degrees(alpha), np.degrees(beta), color=color, linestyle=dashes, label=heading)
    slope = 1.0 / math.sqrt(2.0)
    axes.plot(
        [0.0, 80.0], [0.0, 80.0 * slope], color=INK[3], linewidth=1.0, linestyle=DASHES[3],
        label=r"small arches, $\beta = \alpha/\sqrt{2}$")
    for column, aside in zip(POINTS, (-1.7, 0.0, 1.7)):
        points = [
            (float(row.half_angle) + aside, float(beta))
            for row in table.rows
            for beta in row.values[column].hinge.split(";")
        ]
        axes.plot(*zip(*points), linestyle="none", label=column, **{**POINTS[column], "markersize": 6})
    for row in table.rows:  # the half angle to which three marks side by side belong
        axes.axvspan(float(row.half_angle) - 3.0, float(row.half_angle) + 3.0, color="#f4f4f1", zorder=0, linewidth=0)
    axes.set_yticks(range(0, 95, 5), minor=True)
    axes.grid(True, which="minor", axis="y", linewidth=0.3)
    axes.set_xlim(0.0, 155.0)
    axes.set_ylim(0.0, 92.0)
    axes.set_xlabel(r"half angle of embrace $\alpha$ [deg]")
    axes.set_ylabel(r"intrados hinge $\beta$ [deg]")
    axes.legend(loc="upper left", fontsize=9)
    return figure
