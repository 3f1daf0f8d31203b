"""Sketches of a circular arch of mean radius 1: outline, line of thrust, hinges, mechanism."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from voussoir import theory
from voussoir.plot.figure_style import DASHES, INK, STONE

#: Stations along a half arch
STATIONS = 400


def on_circle(radius: float | np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Points at angles from the crown, clockwise.

    Parameters
    ----------
    radius : float or ndarray
        Distance from the centre.
    angle : float or ndarray
        Angle from the crown [rad].

    Returns
    -------
    ndarray
        x and y: (2, ...).
    """
    return np.array([radius * np.sin(angle), radius * np.cos(angle)])


def chunk(start: float, end: float, eta: float) -> np.ndarray:
    """Outline of the part of the arch between two angles.

    Parameters
    ----------
    start, end : float
        Angles from the crown [rad].
    eta : float
        Thickness ratio.

    Returns
    -------
    ndarray
        Corners of a closed polygon: (2, n).
    """
    angle = np.linspace(start, end, STATIONS)
    outer, inner = on_circle(1 + eta / 2, angle), on_circle(1 - eta / 2, angle[::-1])
    return np.hstack([outer, inner, outer[:, :1]])


def draw_arch(axes: Axes, alpha: float, eta: float, **style) -> Axes:
    """Draw the outline of an arch.

    Parameters
    ----------
    alpha : float
        Half angle of embrace [rad].
    eta : float
        Thickness ratio.
    """
    options = {"facecolor": STONE, "edgecolor": INK[0], "linewidth": 0.9, "zorder": 1} | style
    axes.fill(*chunk(-alpha, alpha, eta), **options)
    axes.set_aspect("equal")
    axes.axis("off")
    return axes


def draw_thrust(axes: Axes, alpha: float, eta: float, name: str, **style) -> Axes:
    """Draw the line of thrust through the extrados of crown and springings, eq. (11).

    Parameters
    ----------
    alpha : float
        Half angle of embrace [rad].
    eta : float
        Thickness ratio.
    """
    angle = np.linspace(0.0, alpha, STATIONS)
    ratio = theory.thrust_line(angle, alpha, eta, name)
    x, y = on_circle(1 - ratio * eta / 2, angle)
    axes.plot(np.hstack([-x[::-1], x]), np.hstack([y[::-1], y]), **({"color": INK[1], "zorder": 3} | style))
    return axes


def draw_hinges(axes: Axes, points: np.ndarray, **style) -> Axes:
    """Draw hinges and their mirror images.

    Parameters
    ----------
    points : ndarray
        x >= 0 and y: (2, n).
    """
    options = {"marker": "o", "linestyle": "", "color": INK[0], "markerfacecolor": "white", "zorder": 5} | style
    for side in (1, -1):
        axes.plot(side * points[0], points[1], **options)
    return axes


def rotated(points: np.ndarray, about: np.ndarray, onto: np.ndarray, angle: float) -> np.ndarray:
    """Turn points clockwise about one point and carry that point to another.

    Parameters
    ----------
    points : ndarray
        (2, n).
    about, onto : ndarray
        The point before and after: (2).
    angle : float
        Turn, clockwise [rad].

    Returns
    -------
    ndarray
        (2, n).
    """
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return onto[:, None] + turn @ (points - about[:, None])


def collapsed_half(alpha: float, beta: float, eta: float, turn: float) -> tuple[list[np.ndarray], np.ndarray]:
    """The five-hinge mechanism, displaced by a finite turn of the lower chunk.

    Parameters
    ----------
    alpha, beta : float
        Half angle of embrace and inner hinge [rad].
    eta : float
        Thickness ratio.
    turn : float
        Turn of the lower chunk about the springing's extrados, outwards [rad].

    Returns
    -------
    chunks : list of ndarray
        Outlines of the upper and the lower chunk of the right half, displaced: (2, n) each.
    hinges : ndarray
        Crown, haunch and springing, displaced: (2, 3).
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
    """Draw the displaced five-hinge mechanism.

    Parameters
    ----------
    alpha, beta : float
        Half angle of embrace and inner hinge [rad].
    eta : float
        Thickness ratio.
    turn : float
        Turn of the lower chunk [rad].
    """
    chunks, hinges = collapsed_half(alpha, beta, eta, turn)
    for outline in chunks:
        for side in (1, -1):
            axes.plot(side * outline[0], outline[1], color=INK[2], linewidth=1.1, linestyle=DASHES[1], zorder=2)
    return draw_hinges(axes, hinges, color=INK[2], markersize=5)
