"""Pictures of blocks that have moved: outlines, hinges and slips."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from voussoir.figure_style import INK, STONE
from voussoir.results import Frame, Results

#: Marks: hinge at the intrados, hinge at the extrados, slip
MARKS = {
    "intrados": {"marker": "o", "markerfacecolor": INK[1], "markeredgecolor": INK[0]},
    "extrados": {"marker": "s", "markerfacecolor": "white", "markeredgecolor": INK[2]},
    "slip": {"marker": "x", "markerfacecolor": INK[0], "markeredgecolor": INK[0]},
}
#: What the marks mean
MEANINGS = {
    "intrados": "hinge at the intrados",
    "extrados": "hinge at the extrados",
    "slip": "sliding joint",
}


def draw_frame(axes: Axes, run: Results, number: int, frame: Frame, size: float = 5.0) -> Axes:
    """Draw one picture of a case, its first one faint behind it.

    Parameters
    ----------
    axes : Axes
        Where; loses its ticks.
    run : Results
        The results of the deck.
    number : int
        Number of the case.
    frame : Frame
        The picture.
    size : float, optional
        Size of the marks [points].

    Returns
    -------
    Axes
        The same.
    """
    first = run.frames_of(number)[0]
    supports, blocks = parted(first, frame)
    if frame.number > 0:
        axes.add_collection(
            PolyCollection(
                first.blocks[:-2], facecolors="none", edgecolors="#c4c4c4", linewidths=0.5
            )
        )
    axes.add_collection(
        PolyCollection(
            supports, facecolors="white", edgecolors=INK[3], linewidths=0.6, hatch="////"
        )
    )
    axes.add_collection(PolyCollection(blocks, facecolors=STONE, edgecolors=INK[0], linewidths=0.6))
    if frame.number > 0:
        for kind, points in marks_of(run, number, frame).items():
            axes.plot(*points, linestyle="none", markersize=size, zorder=5, **MARKS[kind])
    axes.set_aspect("equal")
    axes.set_axis_off()
    return axes


def parted(first: Frame, frame: Frame) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Supports and blocks of a picture of an arch: its last two blocks are the supports.

    Parameters
    ----------
    first : Frame
        The first picture, before any motion.
    frame : Frame
        The picture.

    Returns
    -------
    tuple
        The supports, cut off a little below their joints so that no two overlap; the blocks.
    """
    left, right = first.blocks[-2:]
    return [shortened(left, first, 0), shortened(right, first, -1)], frame.blocks[:-2]


def shortened(support: np.ndarray, frame: Frame, joint: int, share: float = 0.3) -> np.ndarray:
    """A support of which only the part next to its joint is left.

    Parameters
    ----------
    support : ndarray
        Its corners: (n, 2).
    frame : Frame
        A picture before any motion.
    joint : int
        Place of its joint among those of the picture.
    share : float, optional
        How much of its depth is left.

    Returns
    -------
    ndarray
        Corners: (n, 2).
    """
    ends = [
        np.array([frame.joints["x" + end][joint], frame.joints["y" + end][joint]])
        for end in ("_1", "_2")
    ]
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    normal = np.array([-along[1], along[0]])
    depth = (support - ends[0]) @ normal
    far = np.abs(depth) > 0.5 * np.abs(depth).max()
    return support - np.outer((1.0 - share) * depth * far, normal)


def marks_of(run: Results, number: int, frame: Frame) -> dict[str, np.ndarray]:
    """Where a picture has hinges and slips.

    Hinges are those of the row of the case; a joint slips that does so in some picture up to this.

    Returns
    -------
    dict
        Points of each kind: (2, n).
    """
    row = run.case(number)
    angle = np.abs(run.joints_of(number)["angle_deg"])
    joints = frame.joints
    slips = np.zeros(len(joints), dtype=bool)
    for picture in run.frames_of(number)[1 : frame.number + 1]:
        for state in ("state_1", "state_2"):
            slips |= picture.joints[state] == "sliding"
    places = {
        "intrados": (np.isin(np.round(angle, 6), np.round(row["intrados_hinge_deg"], 6)), "_1"),
        "extrados": (np.isin(np.round(angle, 6), np.round(row["extrados_hinge_deg"], 6)), "_2"),
        "slip": (slips, ""),
    }
    return {
        kind: np.array([joints["x" + at][mask], joints["y" + at][mask]])
        for kind, (mask, at) in places.items()
    }


def mark_legend(figure: Figure, kinds: tuple[str, ...] = ("intrados", "extrados")) -> Figure:
    """Explain the marks below a figure."""
    entries = [
        Line2D([], [], linestyle="none", markersize=6, label=MEANINGS[kind], **MARKS[kind])
        for kind in kinds
    ]
    figure.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=len(kinds))
    return figure


def limits(run: Results, numbers: list[int], margin: float = 0.06) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest coordinates of the last pictures of some cases, and a margin [m]."""
    points = []
    for number in numbers:
        first, *_, last = run.frames_of(number)
        for frame in (first, last):
            points += [corner for blocks in parted(first, frame) for corner in blocks]
    corners = np.vstack(points)
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = margin * (high - low).max()
    return low - room, high + room


def set_limits(axes: Axes, box: tuple[np.ndarray, np.ndarray]) -> None:
    """Give axes the room of `limits`."""
    axes.set_xlim(box[0][0], box[1][0])
    axes.set_ylim(box[0][1], box[1][1])
