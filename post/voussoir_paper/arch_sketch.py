"""Sketches of a circular arch of mean radius 1: outline, line of thrust, hinges, mechanism."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from voussoir import theory
from voussoir.plot.figure_style import INK, STONE
from voussoir_paper.paper_style import DASHES

#: Stations along a half arch
STATIONS = 400


def on_circle(radius: float | np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Points (2, ...) at a distance from the centre and angles from the crown, clockwise [rad]."""
    return np.array([radius * np.sin(angle), radius * np.cos(angle)])


def pair(point: np.ndarray) -> tuple[float, float]:
    """Return the coordinates of a point (2)."""
    return float(point[0]), float(point[1])


def chunk(start: float, end: float, eta: float) -> np.ndarray:
    """Outline (2, n) of the part of the arch between two angles from the crown [rad]."""
    angle = np.linspace(start, end, STATIONS)
    outer, inner = on_circle(1 + eta / 2, angle), on_circle(1 - eta / 2, angle[::-1])
    return np.hstack([outer, inner, outer[:, :1]])


def draw_arch(axes: Axes, alpha: float, eta: float, **style: Any) -> Axes:
    """Draw the outline of an arch."""
    options: dict[str, Any] = {"facecolor": STONE, "edgecolor": INK[0], "linewidth": 0.9, "zorder": 1} | style
    axes.fill(*chunk(-alpha, alpha, eta), **options)
    axes.set_aspect("equal")
    axes.axis("off")
    return axes


def draw_thrust(axes: Axes, alpha: float, eta: float, name: str, **style: Any) -> Axes:
    """Draw the line of thrust through the extrados of crown and springings, eq. (11)."""
    angle = np.linspace(0.0, alpha, STATIONS)
    ratio = theory.thrust_line(angle, alpha, eta, name)
    x, y = on_circle(1 - ratio * eta / 2, angle)
    options: dict[str, Any] = {"color": INK[1], "zorder": 3} | style
    axes.plot(np.hstack([-x[::-1], x]), np.hstack([y[::-1], y]), **options)
    return axes


def draw_hinges(axes: Axes, points: np.ndarray, **style: Any) -> Axes:
    """Draw hinges (2, n) with x >= 0, and their mirror images."""
    look: dict[str, Any] = {"marker": "o", "linestyle": "", "color": INK[0], "markerfacecolor": "white", "zorder": 5}
    for side in (1, -1):
        axes.plot(side * points[0], points[1], **(look | style))
    return axes


def rotated(points: np.ndarray, about: np.ndarray, onto: np.ndarray, angle: float) -> np.ndarray:
    """Points (2, n) turned clockwise about one point, which is carried to another [rad]."""
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return np.asarray(onto[:, None] + turn @ (points - about[:, None]))


def collapsed_half(alpha: float, beta: float, eta: float, turn: float) -> tuple[list[np.ndarray], np.ndarray]:
    """The five-hinge mechanism after a turn of the lower chunk about the springing's extrados, outwards [rad].

    Outlines (2, n) of the upper and the lower chunk of the right half, and crown, haunch and springing hinge (2, 3).
    """
    crown, haunch = on_circle(1 + eta / 2, 0.0), on_circle(1 - eta / 2, beta)
    springing = on_circle(1 + eta / 2, alpha)
    lower = rotated(chunk(beta, alpha, eta), springing, springing, turn)
    moved_haunch = rotated(haunch[:, None], springing, springing, turn)[:, 0]
    # The crown stays on the axis of symmetry, at its distance from the haunch.
    arm = np.linalg.norm(crown - haunch)
    moved_crown = np.array([0.0, moved_haunch[1] + np.sqrt(arm**2 - moved_haunch[0] ** 2)])
    before, after = crown - haunch, moved_crown - moved_haunch
    upper_turn = np.arctan2(after[0], after[1]) - np.arctan2(before[0], before[1])
    upper = rotated(chunk(0.0, beta, eta), haunch, moved_haunch, upper_turn)
    return [upper, lower], np.stack([moved_crown, moved_haunch, springing], axis=1)


def draw_mechanism(axes: Axes, alpha: float, beta: float, eta: float, turn: float) -> Axes:
    """Draw the five-hinge mechanism after a turn of the lower chunk [rad]."""
    chunks, hinges = collapsed_half(alpha, beta, eta, turn)
    for outline in chunks:
        for side in (1, -1):
            axes.plot(side * outline[0], outline[1], color=INK[2], linewidth=1.1, linestyle=DASHES[1], zorder=2)
    return draw_hinges(axes, hinges, color=INK[2], markersize=5)
