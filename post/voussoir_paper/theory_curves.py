"""Figures 4 to 7 of the paper: equilibrium curves eta(beta)."""

from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from voussoir import theory
from voussoir.plot.figure_style import INK
from voussoir_paper.paper_style import DASHES, closer

_NAMES = {"ccr": "CCR", "milankovitch": "Milankovitch", "heyman": "Heyman"}


def curve_of_the_semicircle(alpha_deg: float = 90.0) -> Figure:
    """Figure 4: eta(beta) of the semicircle, with the three conditions of figure 3."""
    alpha = math.radians(alpha_deg)
    beta, eta, _ = map(float, theory.critical(alpha, "ccr"))
    figure, axes = plt.subplots(figsize=(5.0, 3.6))
    draw_curve(axes, alpha, "ccr", color=INK[0])
    for share, word in (
        (1.2, "super-critical:\nno hinge"), (1.0, "critical:\none hinge"), (0.7, "sub-critical:\ntwo hinges"),
    ):
        axes.axhline(share * eta, color=INK[1], linewidth=0.9, linestyle=DASHES[1])
        axes.text(1.02, share * eta, word, va="center", fontsize=9, color=INK[1], transform=axes.get_yaxis_transform())
    axes.plot(math.degrees(beta), eta, marker="o", color=INK[2], markersize=7, zorder=5)
    axes.annotate(
        f"$\\beta$ = {math.degrees(beta):.4f}°\n$\\eta$ = {eta:.6f}", (math.degrees(beta), eta),
        (math.degrees(beta) - 8, 0.45 * eta), ha="right", arrowprops={"arrowstyle": "-", "linewidth": 0.7})
    axes.set_ylim(0, 1.35 * eta)
    axes.set_xlim(0, alpha_deg)
    axes.set_title(f"CCR, $\\alpha$ = {alpha_deg:g}°", fontsize=10, loc="left")
    return figure


def curves() -> Figure:
    """Figure 5: eta(beta) of CCR for arches from shallow to the limit, and the line of their tops."""
    limits = theory.limits("ccr")
    marked = {
        limits["alpha_unit_A"]: "$A = 1$",
        limits["alpha_beta_max"]: r"$A$ at $\beta_{max}$",
        limits["alpha_limit"]: "$A_l = 2/3$",
    }
    plain = np.radians([60, 75, 90, 100, 110, 120, 140, 145, 149])
    figure, axes = plt.subplots(figsize=(5.2, 4.8))
    for alpha in sorted([*plain, *marked]):
        special = alpha in marked
        draw_curve(
            axes, alpha, "ccr", color=INK[1] if special else INK[0], linewidth=1.9 if special else 0.9,
            linestyle=DASHES[1] if special else DASHES[0])
        beta, eta, _ = theory.critical(alpha, "ccr")
        if alpha < 1.8:
            beta = 0.85 * alpha
            eta = theory.equilibrium_thickness(beta, alpha, "ccr")
        label = marked.get(alpha, f"{math.degrees(alpha):.0f}°")
        axes.annotate(
            label, (math.degrees(beta), eta), (5, 3), textcoords="offset points", fontsize=9,
            color=INK[1] if special else INK[0])
    alpha = limits["alpha_limit"] - np.append(np.geomspace(2.6, 1e-6, 600), 0.0)
    beta, eta, _ = theory.critical(alpha, "ccr")
    axes.plot(np.degrees(beta), eta, color=INK[2], linestyle=DASHES[2], label="critical states")
    axes.set_xlim(0, 155)
    axes.set_ylim(0, 1.05)
    axes.legend(loc="upper right")
    axes.set_title(r"CCR, each curve with its half angle $\alpha$", fontsize=10, loc="left")
    return figure


def curves_at_90() -> Figure:
    """Figure 6: eta(beta) at a half angle of 90 degrees in both theories, with Heyman's point."""
    return compared_curves(90.0)


def curves_at_140() -> Figure:
    """Figure 7: the same at 140 degrees."""
    return compared_curves(140.0)


def compared_curves(alpha_deg: float) -> Figure:
    """eta(beta) with the weight on the centre line and where it is, their tops, and Heyman's point."""
    alpha = math.radians(alpha_deg)
    figure, axes = plt.subplots(figsize=(5.0, 3.9))
    _compare(axes, alpha)
    axes.set_xlim(0, alpha_deg)
    axes.set_ylim(bottom=0)
    tops = [theory.critical(alpha, name) for name in ("ccr", "milankovitch")]
    if math.degrees(abs(tops[0][0] - tops[1][0])) < 1.0:  # as one mark
        x, y = math.degrees(tops[0][0]), float(tops[0][1])
        inner = closer(axes, (0.42, 0.08, 0.30, 0.34), (x - 0.4, x + 0.4), (y - 1e-4, y + 1.2e-4))
        _compare(inner, alpha)
        inner.set(xlabel="", ylabel="")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2, fontsize=9)
    axes.set_title(f"$\\alpha$ = {alpha_deg:g}°", fontsize=10, loc="left")
    return figure


def _compare(axes: Axes, alpha: float) -> None:
    """Draw both curves and the three tops."""
    draw_curve(axes, alpha, "ccr", color=INK[0], label="CCR and Heyman")
    draw_curve(axes, alpha, "milankovitch", color=INK[1], linestyle=DASHES[1], label="Milankovitch")
    marks = {"ccr": ("o", INK[0]), "milankovitch": ("s", INK[1]), "heyman": ("^", INK[2])}
    for name, (marker, color) in marks.items():
        beta, eta, _ = theory.critical(alpha, name)
        label = f"{_NAMES[name]}: {math.degrees(beta):.4f}°, {eta:.6f}"
        axes.plot(
            math.degrees(beta), eta, marker=marker, color=color, markerfacecolor="white", linestyle="", markersize=7,
            markeredgewidth=1.5, label=label, zorder=5)


def draw_curve(axes: Axes, alpha: float, name: str, **style: Any) -> Axes:
    """Draw eta(beta) from the crown to the springing."""
    beta = np.linspace(0.0, alpha, 801)
    axes.plot(np.degrees(beta), theory.equilibrium_thickness(beta, alpha, name), **style)
    axes.set_xlabel(r"inner hinge $\beta$ [deg]")
    axes.set_ylabel(r"thickness ratio $\eta = t/r$")
    return axes
