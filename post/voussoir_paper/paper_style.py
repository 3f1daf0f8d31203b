"""Line styles and enlarged pieces of the figures of the paper."""

from __future__ import annotations

from matplotlib.axes import Axes

from voussoir.plot.figure_style import INK, SMALL, type_of

#: Line styles that distinguish the curves without colour
DASHES = ("-", (0, (6, 2)), (0, (5, 1.5, 1, 1.5)), (0, (1.2, 1.2)))


def closer(
    axes: Axes, place: tuple[float, float, float, float], x: tuple[float, float], y: tuple[float, float]
) -> Axes:
    """Axes within others for a piece of them, framed there, at left, lower end, width and height as shares of them."""
    limits = axes.axis()  # the frame of the piece must not change them
    inner = axes.inset_axes(place, xlim=x, ylim=y, zorder=8)
    inner.set_autoscale_on(False)
    inner.tick_params(labelsize=type_of(SMALL))
    inner.spines[["top", "right"]].set_visible(True)
    axes.indicate_inset_zoom(inner, edgecolor=INK[0], linewidth=0.7)
    axes.axis(limits)
    return inner
