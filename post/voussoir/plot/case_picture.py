"""The picture of one case: blocks and supports, thrust, forces, hinges, slips, displaced shape."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from voussoir.dda_program import DdaError
from voussoir.deck.thickness import thickness_safety
from voussoir.plot.case_joints import JointMarks
from voussoir.plot.case_marks import draw_held, draw_loads, draw_numbers, entry, load_arrows, show_coordinates
from voussoir.plot.case_scene import CaseScene, scene_of, view
from voussoir.plot.case_title import title_of
from voussoir.plot.figure_style import INK, SMALL, TINTS, type_of
from voussoir.plot.motion import Motion, motion_of
from voussoir.plot.sheet import Sheet
from voussoir.plot.source_file import add_vehicle, source_of
from voussoir.plot.units import length_text, rounded
from voussoir.results import Results, Table

#: Largest displacement in the picture, over its size
DISPLACED_LENGTH = 0.04
#: Displacements above this share of the picture's size are seen without magnification
SEEN = 0.02
#: Blocks that do not move, and those that move furthest
SHADES = LinearSegmentedColormap.from_list("motion", ["#f4f4f2", "#d3dbe2", "#93a8ba"])


def draw_case(
    run: Results, number: int, magnify: float | str | None = None, with_forces: bool | None = None,
    numbers: bool = False, coordinates: bool = False, sheet: Sheet = Sheet()
) -> Figure:
    """Draw one case of any scene.

    `magnify` is the magnification of the displaced shape, chosen and stated with "auto". Without it what stands is
    drawn as it stands, and a collapse mechanism, which has no size, as large as can be seen. The forces of the joints
    are drawn with `with_forces`, by default where no thrust line is drawn and the joints are few; the numbers of blocks
    with `numbers`, the axes [m] with `coordinates`. The sheet has the width of the picture, and says if it has a title
    and a legend. KeyError if there is no such case, or its blocks were not written.
    """
    title = title_of(row_with_safety(run, number), run) if sheet.title else ""
    scene, source = scene_of(run, number), source_of(run)
    add_vehicle(run, number, scene, source)
    joints = run.joints_of(number) if run.joints is not None else None
    ways = run.points_of(number)
    written = 1.0 if scene.moves else 0.0
    supports = [block.corners for block in scene.supports]
    size = float(np.subtract(*view(scene.shapes(0.0) + scene.shapes(written), supports)[::-1]).max())
    factor = factor_of(scene, magnify, size)
    motion = motion_of(scene.blocks, scene.supports, factor or written, written)
    shapes, beginning = scene.shapes(motion.shown), scene.shapes(0.0)
    low, high = view([*beginning, *shapes, *(places_of(way, motion) for way in ways if scene.moves),
                      *load_arrows(source, size, motion)], supports)
    pen = sheet.pen(len(scene.blocks))
    figure, axes = sheet.start(low, high)
    marks = JointMarks(scene, joints, motion, size, pen, sheet.scale(low, high)) if joints is not None else None
    entries = draw_supports(axes, supports, pen)
    if motion.shown > 0.0 and (factor > 0.0 or scene.largest > SEEN * size):
        words = "before the collapse" if scene.falls else "at the beginning"
        if factor == 0.0:
            words = f"at the beginning; true scale, largest displacement {length_text(scene.largest)}"
        entries += draw_beginning(axes, beginning, words, pen)
    if marks is not None and marks.crowded and motion.shown > 0.0:
        entries += shade_blocks(axes, scene, shapes, pen, length_text(factor or scene.largest))
    else:
        entries += draw_blocks(axes, scene, shapes, source.materials, pen, shape_words(scene, factor))
    entries += draw_ways(axes, scene, ways, motion)
    if marks is not None:
        entries += marks.draw(axes, with_forces)
    entries += draw_loads(axes, source, size, motion, pen) + draw_held(axes, source, motion, pen)
    draw_guides(axes, scene, shapes, (low, high), pen, numbers, coordinates)
    return sheet.finish(figure, axes, title, entries)


def row_with_safety(run: Results, number: int) -> dict[str, Any]:
    """Row of a case; of an arch that stands at rest, with the geometrical safety, where dda is there to find it."""
    row = run.case(number)
    stands = row["verdict"] == "stable" and (row["mode"], row["geometry"]) == ("static", "reference")
    if not stands or run.kind not in ("arch", "shape") or run.searched:
        return row
    try:
        row["safety_thickness"] = thickness_safety(run, number)[0]
    except (FileNotFoundError, DdaError):
        pass
    return row


def draw_supports(axes: Axes, supports: list[np.ndarray], pen: float = 1.0) -> list[Artist]:
    """Draw what cannot move; gives the entries of the legend."""
    if not supports:
        return []
    style: dict[str, Any] = {"facecolor": "white", "edgecolor": INK[3], "linewidth": 0.6 * pen, "hatch": "/////"}
    axes.add_collection(PolyCollection(supports, **style, zorder=0))
    return [Patch(**style, label="fixed")]


def shape_words(scene: CaseScene, factor: float) -> str:
    """Legend of the blocks where they are drawn."""
    if factor == 0.0:
        return "blocks"
    if scene.falls:
        return f"collapse mechanism, largest displacement drawn {length_text(factor)}"
    return f"blocks, displacements × {factor:g} (largest {length_text(scene.largest)})"


def draw_beginning(axes: Axes, shapes: list[np.ndarray], words: str, pen: float = 1.0) -> list[Artist]:
    """Draw where blocks that have moved were; gives the entries of the legend."""
    style: dict[str, Any] = {"linestyle": (0, (3, 2)), "linewidth": 0.6 * pen}
    axes.add_collection(
        PolyCollection(
            shapes, facecolors="none", edgecolors=INK[3], linewidths=style["linewidth"],
            linestyles=[style["linestyle"]], zorder=1))
    return [entry(words, color=INK[3], **style)]


def draw_blocks(
    axes: Axes, scene: CaseScene, shapes: list[np.ndarray], materials: Sequence[int] = (), pen: float = 1.0,
    words: str = "blocks"
) -> list[Artist]:
    """Draw the blocks that can move, by materials where these are known; gives the entries of the legend."""
    known = len(materials) >= max((block.number for block in scene.blocks), default=0)
    groups: dict[tuple[int, bool], list[np.ndarray]] = {}
    for block, shape in zip(scene.blocks, shapes):
        material = materials[block.number - 1] if known else 1
        groups.setdefault((material, block.state == "held"), []).append(shape)
    several = len({material for material, _ in groups}) > 1
    entries: list[Artist] = []
    for (material, held), chosen in sorted(groups.items()):
        style: dict[str, Any] = {
            "facecolor": TINTS[(material - 1) % len(TINTS)],
            "edgecolor": "#777777",
            "linewidth": 0.7 * pen,
            "hatch": "/////" if held else None,
        }
        axes.add_collection(PolyCollection(chosen, **style, zorder=1.5))
        name = f"blocks of material {material}" if several else "blocks" if held else words
        if held:  # in an arch only &support holds blocks
            name = "support that moves" if scene.voussoirs else f"{name} with restraints"
        entries.append(Patch(**style, label=name))
    return [*entries, entry(words)] if several and words != "blocks" else entries


def shade_blocks(
    axes: Axes, scene: CaseScene, shapes: list[np.ndarray], pen: float = 1.0, furthest: str = ""
) -> list[Artist]:
    """Draw the blocks that can move in shades of how far they move; gives the entries of the legend."""
    moves = np.array([float(np.hypot(*block.displacement.T).max()) for block in scene.blocks])
    colors = SHADES(moves / (moves.max() or 1.0))
    style: dict[str, Any] = {"edgecolor": "#8a8a8a", "linewidth": 0.6 * pen}
    axes.add_collection(PolyCollection(
        shapes, facecolors=colors, edgecolors=style["edgecolor"], linewidths=style["linewidth"], zorder=1.5))
    named = ((0.0, "blocks that do not move"), (1.0, f"blocks that move furthest, drawn {furthest}"))
    return [Patch(facecolor=SHADES(share), label=label, **style) for share, label in named]


def factor_of(scene: CaseScene, magnify: float | str | None, size: float) -> float:
    """Magnification of the displaced shape; 0 where none is asked for, known or needed."""
    largest = scene.largest
    if not largest > 0.0:
        return 0.0
    if isinstance(magnify, (int, float)):
        return float(magnify)
    if not scene.falls and magnify is None or scene.moves and largest > SEEN * size:
        return 0.0
    return rounded(DISPLACED_LENGTH * size / largest)


def places_of(way: Table, motion: Motion) -> np.ndarray:
    """Place of a monitoring point in the picture after each step: (n, 2) [m]."""
    moves = np.column_stack((way["u"], way["v"]))
    start = np.array([way["x"][0], way["y"][0]]) - moves[0]
    return np.asarray(start + motion.shown * moves)


def draw_ways(axes: Axes, scene: CaseScene, ways: list[Table], motion: Motion) -> list[Artist]:
    """Draw the trajectories of the monitoring points as the blocks are drawn; gives the entries."""
    for way in ways:
        points = places_of(way, motion)
        axes.plot(*points.T, color=INK[1], linewidth=1.1, linestyle=(0, (4, 1.5)), zorder=5)
        axes.plot(*points[-1], marker="D", color=INK[1], markersize=4, zorder=6)
        axes.annotate(
            str(way["point"][0]), points[-1], xytext=(5, 3), textcoords="offset points", fontsize=type_of(SMALL),
            color=INK[1], zorder=8)
    if not ways:
        return []
    words = "monitoring points, trajectories" if motion.shown > 0.0 else "monitoring points"
    return [entry(words, linestyle=(0, (4, 1.5)), color=INK[1], marker="D", markersize=4, linewidth=1.1)]


def draw_guides(axes: Axes, scene: CaseScene, shapes: list[np.ndarray], view: tuple[np.ndarray, np.ndarray],
                pen: float, numbers: bool, coordinates: bool) -> None:
    """Draw numbers of blocks where asked, and axes with coordinates or a scale bar of the view (low, high)."""
    if numbers:
        draw_numbers(axes, scene, shapes)
    if coordinates:
        show_coordinates(axes)
    else:
        draw_scale(axes, *view, pen)


def draw_scale(axes: Axes, low: np.ndarray, high: np.ndarray, pen: float = 1.0) -> None:
    """Draw a bar of a round length below the picture."""
    length = rounded(0.2 * float(high[0] - low[0]))
    room = 0.02 * float((high - low).max())
    start, level = low[0] + room, low[1] - room
    axes.plot(
        [start, start + length], [level, level], color=INK[0], linewidth=1.8 * pen, solid_capstyle="butt",
        clip_on=False, zorder=9)
    axes.annotate(
        length_text(length), (start + length, level), xytext=(4, 0), textcoords="offset points", va="center",
        fontsize=type_of(SMALL), annotation_clip=False)
