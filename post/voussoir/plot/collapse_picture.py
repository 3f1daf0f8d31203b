"""Pictures of blocks that have moved: outlines, supports, hinges, slips and contacts."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from voussoir.plot.case_scene import CaseScene, scene_of, view
from voussoir.plot.figure_style import INK, STONE
from voussoir.results import Frame, Results, Table

#: Largest displacement of a mechanism that is animated, over its size, and pictures on the way
MECHANISM_SIZE, GROWTH = 0.08, 10

#: Marks of hinges, of joints that part, and of slip
MARKS: dict[str, dict[str, Any]] = {
    "intrados": {"marker": "o", "markerfacecolor": INK[1], "markeredgecolor": INK[0]},
    "extrados": {"marker": "s", "markerfacecolor": "white", "markeredgecolor": INK[2]},
    "hinge": {"marker": "o", "markerfacecolor": INK[1], "markeredgecolor": INK[0]},
    "open": {"marker": "D", "markerfacecolor": "white", "markeredgecolor": INK[0]},
    "slip": {"marker": "x", "markerfacecolor": INK[0], "markeredgecolor": INK[0]},
    "closed": {"marker": ".", "markerfacecolor": INK[1], "markeredgecolor": INK[1]},
}
#: What the marks mean
MEANINGS = {
    "intrados": "hinge at the intrados",
    "extrados": "hinge at the extrados",
    "hinge": "hinge",
    "open": "open joint",
    "slip": "sliding joint",
    "closed": "contact that sticks",
}


def pictures_of(run: Results, number: int) -> list[Frame]:
    """Pictures of the motion of a case: its frames, or its collapse mechanism (without joints) as it grows."""
    frames = run.frames_of(number)
    if len(frames) > 1 or run.blocks is None or not np.any(run.blocks["case"] == number):
        return frames
    scene = scene_of(run, number)
    if not scene.falls or not scene.largest > 0.0:
        return frames
    blocks = run.blocks_of(number)
    low, high = view(scene.shapes(0.0), [])
    most = MECHANISM_SIZE * float((high - low).max()) / scene.largest
    return [
        Frame(
            picture, 0, 0.0, [block.corners + picture / GROWTH * most * block.displacement for block in blocks],
            Table({}))
        for picture in range(GROWTH + 1)
    ]


def draw_frame(axes: Axes, run: Results, number: int, frame: Frame, size: float = 5.0, magnify: float = 1.0) -> Axes:
    """Draw one picture of a case, its first one faint behind it; marks [points] at true scale only."""
    first = pictures_of(run, number)[0]
    scene = scene_of(run, number)
    before = shapes_of(scene, first, first, 1.0)
    if frame.number > 0:
        axes.add_collection(PolyCollection(before, facecolors="none", edgecolors="#c4c4c4", linewidths=0.5))
    axes.add_collection(
        PolyCollection(
            [block.corners for block in scene.supports], facecolors="white", edgecolors=INK[3], linewidths=0.6,
            hatch="////")
    )
    blocks = shapes_of(scene, first, frame, magnify)
    axes.add_collection(PolyCollection(blocks, facecolors=STONE, edgecolors=INK[0], linewidths=0.6))
    if frame.number > 0 and magnify == 1.0 and len(frame.joints):
        marks = marks_of(run, number, frame) if scene.is_arch else contacts_of(frame)
        for kind, points in marks.items():
            axes.plot(*points, linestyle="none", markersize=size, zorder=5, **MARKS[kind])
    axes.set_aspect("equal")
    axes.set_axis_off()
    return axes


def shapes_of(scene: CaseScene, first: Frame, frame: Frame, magnify: float) -> list[np.ndarray]:
    """Corners of the blocks that can move in a picture, their displacements magnified."""
    return [
        before + magnify * (now - before)
        for before, now in ((first.blocks[block.number - 1], frame.blocks[block.number - 1]) for block in scene.blocks)
    ]


def marks_of(run: Results, number: int, frame: Frame) -> dict[str, np.ndarray]:
    """Where a picture of an arch has hinges (by the case's row) and slips (by its joints): (2, n) of each kind."""
    row = run.case(number)
    roles = run.joints_of(number)
    angle = np.abs(roles["angle_deg"])
    joints = frame.joints
    places = {
        "intrados": (np.isin(np.round(angle, 6), np.round(row["intrados_hinge_deg"], 6)), "_1"),
        "extrados": (np.isin(np.round(angle, 6), np.round(row["extrados_hinge_deg"], 6)), "_2"),
        "slip": (np.isfinite(roles["slides_x"]), ""),
    }
    return {kind: np.array([joints["x" + at][mask], joints["y" + at][mask]]) for kind, (mask, at) in places.items()}


def contacts_of(frame: Frame) -> dict[str, np.ndarray]:
    """Where blocks slide on one another in a picture, and where they stick: (2, n) of each kind."""
    joints = frame.joints
    points: dict[str, list[np.ndarray]] = {"slip": [], "closed": []}
    for kind, word in (("slip", "sliding"), ("closed", "locked")):
        for end in ("_1", "_2"):
            mask = joints["state" + end] == word
            points[kind].append(np.array([joints["x" + end][mask], joints["y" + end][mask]]))
    return {kind: np.hstack(parts) for kind, parts in points.items()}


def limits(run: Results, numbers: list[int], magnify: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corner of what shows all pictures of some cases [m]."""
    shapes, supports = [], []
    for number in numbers:
        scene, frames = scene_of(run, number), pictures_of(run, number)
        supports += [block.corners for block in scene.supports]
        for frame in frames:
            shapes += shapes_of(scene, frames[0], frame, magnify)
    return view(shapes, supports)


def set_limits(axes: Axes, box: tuple[np.ndarray, np.ndarray]) -> None:
    """Give axes the room of `limits`."""
    axes.set_xlim(box[0][0], box[1][0])
    axes.set_ylim(box[0][1], box[1][1])
