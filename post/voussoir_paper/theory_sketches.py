"""Figures 1 to 3 of the paper: the arch, its forces, its lines of thrust."""

from __future__ import annotations

import math

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from voussoir import theory
from voussoir.plot.figure_style import INK, STONE
from voussoir_paper.arch_sketch import chunk, draw_arch, draw_hinges, draw_mechanism, draw_thrust, on_circle, pair
from voussoir_paper.paper_style import DASHES

_ARROW = {"arrowstyle": "-|>", "color": INK[0], "linewidth": 1.3, "shrinkA": 0, "shrinkB": 0}
_SPAN = {"arrowstyle": "<|-|>", "color": INK[0], "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0}
_NAMES = {"ccr": "CCR", "milankovitch": "Milankovitch", "heyman": "Heyman"}


def collapse_mode(alpha_deg: float = 120.0) -> Figure:
    """Figure 1: the critical arch, its line of thrust, and how it falls."""
    alpha = math.radians(alpha_deg)
    beta, eta, h = map(float, theory.critical(alpha, "ccr"))
    figure, axes = plt.subplots(figsize=(6.4, 5.2))
    draw_arch(axes, alpha, eta)
    draw_thrust(axes, alpha, eta, "ccr")
    draw_mechanism(axes, alpha, beta, eta, turn=0.05)
    hinges = on_circle(1 + eta / 2 * np.array([1, -1, 1]), np.array([0.0, beta, alpha]))
    draw_hinges(axes, hinges, markersize=7)
    for letter, point, shift in zip("ABC", hinges.T, ((0.03, 0.1), (-0.14, -0.06), (0.06, -0.1))):
        axes.text(*pair(point + shift), letter, fontsize=12)
    for angle, label in ((beta, r"$\beta$"), (alpha, r"$\alpha$")):
        draw_angle(axes, angle, 0.28 if angle == beta else 0.42, label)
    rows = [f"$\\alpha$ = {alpha_deg:g}°"]
    for name in ("ccr", "milankovitch", "heyman"):
        b, e, thrust = theory.critical(alpha, name)
        rows.append(f"{_NAMES[name]}: $\\beta$ = {math.degrees(b):.4f}°, $\\eta$ = {e:.6f}, $h$ = {thrust:.6f}")
    axes.set_title("\n".join(rows), fontsize=10, loc="left", pad=18)
    return figure


def notation(alpha_deg: float = 120.0, beta_deg: float = 58.0, eta: float = 0.4) -> Figure:
    """Figure 2: the forces on the upper portion of the half arch, thick for the eye, which meet in one point D."""
    alpha, beta = math.radians(alpha_deg), math.radians(beta_deg)
    h = float(theory.springing_thrust(alpha, eta, "ccr"))
    ratio = float(theory.eccentricity(beta, alpha, eta, h, "ccr"))
    crown, point = on_circle(1 + eta / 2, 0.0), on_circle(1 - ratio * eta / 2, beta)
    # The resultant at P is (h, beta): followed backwards it meets H at the height of the crown.
    meeting = np.array([point[0] - h / beta * (crown[1] - point[1]), crown[1]])
    figure, axes = plt.subplots(figsize=(6.0, 5.2))
    draw_arch(axes, alpha, eta, facecolor="white", edgecolor=INK[3])
    axes.fill(*chunk(0.0, beta, eta), facecolor=STONE, edgecolor=INK[0], linewidth=1.2, zorder=2)
    draw_thrust(axes, alpha, eta, "ccr", linestyle=DASHES[1])
    axes.set_xlim(-0.85, 1.35)
    axes.set_ylim(-0.2, 1.38)
    arrow(axes, crown - (0.34, 0.0), crown, "$H$", (-0.02, 0.05))
    axes.plot([crown[0], meeting[0]], [crown[1]] * 2, color=INK[0], linewidth=0.8, linestyle=DASHES[3])
    arrow(axes, meeting, meeting - (0.0, 0.42), "$W_1$", (-0.13, -0.4))
    axes.plot(*np.stack([meeting, point], axis=1), color=INK[2], linewidth=0.9, linestyle=DASHES[3], zorder=4)
    direction = (point - meeting) / np.linalg.norm(point - meeting)
    arrow(axes, point + 0.36 * direction, point, "$R$", (0.02, 0.02))
    radius = on_circle(1.0, beta)
    for label, spot, shift in (
        ("$A$", crown, (-0.05, 0.04)),
        ("$D$", meeting, (0.0, 0.05)),
        ("$P$", point, (0.06, -0.015)),
        ("$O$", np.zeros(2), (-0.08, -0.06)),
    ):
        axes.plot(*spot, marker="o", color=INK[0], markersize=4, zorder=6)
        axes.text(*pair(spot + shift), label, fontsize=12, zorder=7)
    axes.plot([0, radius[0]], [0, radius[1]], color=INK[0], linewidth=0.7)
    axes.plot([0, 0], [0, crown[1]], color=INK[0], linewidth=0.7)
    draw_angle(axes, beta, 0.25, r"$\beta$")
    outer, inner = on_circle(1 + eta / 2, -0.5), on_circle(1 - eta / 2, -0.5)
    axes.annotate("", pair(outer), pair(inner), arrowprops=_SPAN)
    return label_lengths(axes, figure, eta, ratio, beta)


def label_lengths(axes: Axes, figure: Figure, eta: float, ratio: float, beta: float) -> Figure:
    """Finish figure 2: thickness, radius and eccentricity, at a joint and its ratio 2e/t."""
    axes.text(*pair(on_circle(1.0, -0.5) + (0.03, -0.02)), "$t$", fontsize=12)
    axes.text(*pair(on_circle(0.55, beta) + (0.03, -0.07)), "$r$", fontsize=12)
    aside = beta + 0.16
    axes.annotate("", pair(on_circle(1.0, aside)), pair(on_circle(1 - ratio * eta / 2, aside)), arrowprops=_SPAN)
    axes.text(*pair(on_circle(1 - ratio * eta / 4, aside + 0.09)), "$e$", fontsize=12)
    for radius in (1.0, 1 - ratio * eta / 2):
        ends = on_circle(radius, np.array([beta, aside + 0.03]))
        axes.plot(*ends, color=INK[0], linewidth=0.5, zorder=4)
    angle = np.linspace(0.0, beta, 200)
    axes.plot(*on_circle(1.0, angle), color=INK[3], linewidth=0.8, linestyle=DASHES[2], zorder=3)
    axes.set_title(f"$\\hat e$ = 2e/t = {ratio:.3f} at $\\beta$ = {math.degrees(beta):g}°", fontsize=10, loc="left")
    return figure


def lines_of_thrust(alpha_deg: float = 90.0, shares: tuple[float, ...] = (1.6, 1.0, 0.6)) -> Figure:
    """Figure 3: lines of thrust of a super-critical, the critical and a sub-critical semicircle."""
    alpha = math.radians(alpha_deg)
    beta, critical, _ = map(float, theory.critical(alpha, "ccr"))
    figure, panels = plt.subplots(1, len(shares), figsize=(5.4, 1.8))
    for axes, share in zip(panels, shares):
        eta = share * critical
        draw_arch(axes, alpha, eta)
        draw_thrust(axes, alpha, eta, "ccr")
        kind = "critical" if share == 1 else "super-critical" if share > 1 else "sub-critical"
        axes.set_title(f"{kind}:\n$\\eta$ = {eta:.6f}", fontsize=9.5)
        if share == 1:
            draw_hinges(axes, on_circle(1 + eta / 2 * np.array([1, -1, 1]), np.array([0.0, beta, alpha])))
    return figure


def draw_angle(axes: Axes, angle: float, radius: float, label: str) -> Axes:
    """Draw an angle from the crown about the centre of the arch."""
    axes.plot(*on_circle(radius, np.linspace(0.0, angle, 100)), color=INK[0], linewidth=0.7)
    for end in (0.0, angle):
        axes.plot(*np.stack([np.zeros(2), on_circle(1.15 * radius, end)], axis=1), color=INK[0], linewidth=0.7)
    axes.text(*pair(on_circle(1.2 * radius, 0.55 * angle)), label, fontsize=12, ha="center", va="center")
    return axes


def arrow(axes: Axes, start: np.ndarray, end: np.ndarray, label: str, shift: tuple[float, float]) -> Axes:
    """Draw a force from tail to tip, its name shifted from the tail."""
    axes.annotate("", pair(end), pair(start), arrowprops=_ARROW, zorder=6)
    axes.text(*pair(np.asarray(start) + shift), label, fontsize=12, zorder=7)
    return axes
