"""Figures 11, 14, 17 and 20 of the paper, and the friction behind figure 8: thickness as curves."""

from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from voussoir import theory
from voussoir.plot.figure_style import INK
from voussoir_paper.campaign import Campaign
from voussoir_paper.tables import THEORIES, PaperTable, Row
from voussoir_paper.paper_style import DASHES, closer

#: How the points of a column look; columns that join later take the last one
POINTS: dict[str, dict[str, Any]] = {
    "paper DDA": {"marker": "^", "color": INK[3], "markeredgecolor": INK[0], "markersize": 7},
    "ours, rigid": {"marker": "o", "color": INK[1], "markeredgecolor": INK[0], "markersize": 6},
    "ours, elastic": {
        "marker": "s", "markerfacecolor": "none", "markeredgecolor": INK[2], "markersize": 9, "markeredgewidth": 1.3
    },
}
_OTHER: dict[str, Any] = {"marker": "D", "color": "#f0c040", "markeredgecolor": INK[0], "markersize": 6}
#: Left, bottom, width and height of a picture within another
_Place = tuple[float, float, float, float]
#: Ends of an axis
_Range = tuple[float, float]
#: How the curve of a theory looks
CURVES = dict(zip(THEORIES, zip(INK[:3], DASHES)))


def draw_points(axes: Axes, table: PaperTable, x: str, error: bool = False) -> Axes:
    """Draw the computed columns of a table, ours and the paper's, or their errors [%], against a field of its rows."""
    columns = [column for column in table.columns if column not in THEORIES.values()]
    for column in reversed(columns):
        rows = [row for row in table.rows if column in row.values]
        if error and column == "ours, rigid":
            continue
        axes.plot(
            [float(getattr(row, x)) for row in rows], [_ordinate(row, column, error) for row in rows], linestyle="none",
            label=column, **POINTS.get(column, _OTHER))
    return axes


def _ordinate(row: Row, column: str, error: bool) -> float:
    value = row.values[column]
    chosen = value.error if error else value.eta
    if chosen is None:
        return math.nan
    return 100.0 * abs(chosen) if error else chosen


def legend_below(figure: Figure, axes: Axes, columns: int = 2) -> None:
    """A legend below a figure, where it covers no data: points first, then curves."""
    handles, labels = axes.get_legend_handles_labels()
    points = [*POINTS, *(label for label in labels if " mode" in label)]
    order = sorted(
        range(len(labels)), key=lambda i: (points.index(labels[i]) if labels[i] in points else len(points), i))
    figure.legend(
        [handles[i] for i in order], [labels[i] for i in order], loc="upper center", bbox_to_anchor=(0.5, 0.02),
        ncols=columns, fontsize=9.5)


def friction(campaign: Campaign) -> Figure:
    """Behind figure 8: critical thickness against friction, with both thresholds."""
    figure, axes = plt.subplots(figsize=(5.2, 3.9))
    cases = campaign.results("figure8_thickness").cases
    lower = campaign.results("figure8_lower").cases["critical"]
    upper = campaign.results("figure8_upper").cases["critical"]
    blocks = int(cases["blocks"][0])
    angle = np.linspace(lower[0] + 1e-6, cases["friction_deg"].max(), 400)
    exact = theory.discrete_critical(blocks, math.pi / 2, friction=np.radians(angle))
    axes.plot(angle, exact, color=INK[0], label=f"exact, {blocks} polygon blocks")
    limits = theory.friction("milankovitch")
    mu = np.linspace(float(limits["mu_mixed"]), float(limits["mu_rotational"]), 200)
    axes.plot(
        np.degrees(np.arctan(mu)), theory.friction_thickness(mu, "milankovitch"), color=INK[2], linestyle=DASHES[1],
        label="Milankovitch, continuous arch")
    for turning, style, label in (
        (False, POINTS["ours, rigid"], "ours, rigid: mixed"),
        (True, {**POINTS["ours, rigid"], "color": "white"}, "ours, rigid: rotational"),
    ):
        kept = (cases["collapse_mode"] == "rotational") == turning
        axes.plot(cases["friction_deg"][kept], cases["critical"][kept], linestyle="none", label=label, **style)
    for value, words in ((lower[0], "stands at\nno thickness"), (upper[0], "no joint slips")):
        axes.axvline(value, color=INK[3], linewidth=1.0, linestyle=DASHES[3])
        side = -1 if value == lower[0] else 1
        axes.text(
            value + 0.06 * side, 0.155,
            f"{words}\n{'below' if side < 0 else 'from'} {value:.4f}°\n($\\mu$ = {math.tan(math.radians(value)):.6f})",
            ha="right" if side < 0 else "left", va="center", fontsize=9)
    axes.set_xlim(14.4, cases["friction_deg"].max() + 0.2)
    axes.set_ylim(0.1, 0.205)
    axes.set_xlabel(r"friction angle $\varphi$ [deg]")
    axes.set_ylabel(r"critical thickness ratio $\eta$ [-]")
    legend_below(figure, axes)
    return figure


def numbers_of_blocks(campaign: Campaign) -> Figure:
    """Figure 11: critical thickness of the semicircle against the number of blocks."""
    table = campaign.tables["table1"]
    figure, (wide, close) = plt.subplots(2, 1, figsize=(5.2, 6.6), sharex=True)
    even = np.arange(10, 100, 2)
    exact = theory.discrete_critical(even, math.pi / 2)
    for axes in (wide, close):
        for name, heading in THEORIES.items():
            value = float(theory.critical(math.pi / 2, name)[1])
            color, dashes = CURVES[name]
            axes.axhline(value, color=color, linestyle=dashes, linewidth=1.2, label=f"{heading} {value:.6f}")
        axes.plot(even, exact, color=INK[0], marker=".", markersize=3, linewidth=0.7, label="exact, every even number")
        draw_points(axes, table, "blocks")
        axes.set_ylabel(r"critical thickness ratio $\eta$ [-]")
    close.set_ylim(0.1045, 0.1079)
    close.set_title("the same, closer: the paper's points lie above", fontsize=10, loc="left")
    close.set_xlabel("number of blocks [-]")
    close.set_xticks([float(row.blocks) for row in table.rows])
    legend_below(figure, wide)
    return figure


def imposed_at_90(campaign: Campaign) -> Figure:
    """Figure 14: four blocks, half angle 90 degrees."""
    return _imposed(campaign.tables["table2"], 90.0, (0.44, 0.07, 0.33, 0.50), (52.0, 61.0), (0.1035, 0.1135))


def imposed_at_140(campaign: Campaign) -> Figure:
    """Figure 17: four blocks, half angle 140 degrees."""
    return _imposed(campaign.tables["table3"], 140.0, (0.26, 0.13, 0.42, 0.55), (56.0, 65.0), (0.618, 0.642))


def _imposed(table: PaperTable, alpha_deg: float, place: _Place, near: _Range, high: _Range) -> Figure:
    """A table of imposed joints; the piece near the top is drawn larger where there is room."""
    figure, (curve, error) = plt.subplots(2, 1, figsize=(5.2, 6.2), sharex=True, height_ratios=(3, 2))
    _draw_imposed(curve, table, math.radians(alpha_deg))
    curve.set_ylim(bottom=0.0)
    curve.set_xlim(0.0, alpha_deg)
    _draw_imposed(closer(curve, place, near, high), table, math.radians(alpha_deg))
    curve.set_ylabel(r"thickness ratio $\eta$ [-]")
    _draw_errors(error, table, "joint")
    error.set_xlabel(r"imposed joint $\beta$ [deg]")
    legend_below(figure, curve)
    return figure


def _draw_imposed(axes: Axes, table: PaperTable, alpha: float) -> None:
    """Curves of the theories, their tops, and what was computed."""
    beta = np.linspace(1e-6, alpha * (1.0 - 1e-9), 600)
    for name in ("milankovitch", "ccr"):
        color, dashes = CURVES[name]
        label = {"ccr": "CCR and Heyman"}.get(name, THEORIES[name])
        eta = theory.equilibrium_thickness(beta, alpha, name)
        axes.plot(np.degrees(beta), eta, color=color, linestyle=dashes, label=label)
    for name, marker in zip(THEORIES, ("+", "x", "*")):
        top, eta, _ = theory.critical(alpha, name)
        axes.plot(
            math.degrees(top), eta, marker=marker, color=INK[0], markersize=9, linestyle="none", zorder=6,
            label=f"critical, {THEORIES[name]}: {math.degrees(top):.2f}°, {float(eta):.6f}")
    draw_points(axes, table, "joint")


def half_angles(campaign: Campaign) -> Figure:
    """Figure 20: critical thickness against the half angle of embrace."""
    table = campaign.tables["table4"]
    figure, (curve, error) = plt.subplots(2, 1, figsize=(5.2, 6.2), sharex=True, height_ratios=(3, 2))
    for name, heading in THEORIES.items():
        alpha = np.linspace(1e-3, theory.limits(name)["alpha_limit"] * (1.0 - 1e-12), 600)
        color, dashes = CURVES[name]
        eta = theory.critical(alpha, name)[1]
        curve.plot(np.degrees(alpha), eta, color=color, linestyle=dashes, label=heading)
    draw_points(curve, table, "half_angle")
    curve.set_ylim(0.0, 1.02)
    curve.set_xlim(0.0, 155.0)
    curve.set_ylabel(r"critical thickness ratio $\eta$ [-]")
    _draw_errors(error, table, "half_angle")
    error.set_xlabel(r"half angle of embrace $\alpha$ [deg]")
    legend_below(figure, curve)
    return figure


def _draw_errors(axes: Axes, table: PaperTable, x: str) -> None:
    """Errors in percent; rigid blocks have none that could be drawn."""
    draw_points(axes, table, x, error=True)
    worst = max(abs(row.values["ours, rigid"].error or 0.0) for row in table.rows)
    axes.set_yscale("log")
    axes.set_ylabel("above the exact\npolygon value [%]")
    axes.set_title(f"rigid blocks: at most {100 * worst:.0e} %, far below", fontsize=10, loc="left")
