"""The picture of one case: blocks and supports, thrust, forces, hinges, slips, displaced shape."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from voussoir.plot.case_marks import draw_held, draw_loads, draw_numbers, entry, load_arrows, show_coordinates
from voussoir.plot.case_scene import CaseScene, scene_of, view
from voussoir.plot.case_title import title_of
from voussoir.plot.collapse_picture import MARKS, MEANINGS
from voussoir.plot.figure_style import INK, TINTS, Picture
from voussoir.plot.shape_rings import ring_joints
from voussoir.plot.source_file import source_of
from voussoir.plot.units import force_text, length_text, rounded
from voussoir.results import Results, Table

#: Longest force, largest displacement and length of slip marks in the picture, over its size
FORCE_LENGTH, DISPLACED_LENGTH, SLIP_LENGTH = 0.10, 0.04, 0.03
#: More joints than these have smaller marks
MANY = 100
#: Displacements above this share of the picture's size are seen without magnification
SEEN = 0.02
#: Width of a figure, and its least and greatest height [inch]
WIDTH, LEAST_HEIGHT, MOST_HEIGHT = 5.2, 1.8, 5.2

#: What the marks mean where nothing collapses
TOUCHES = {
    "intrados": "touches at the intrados only",
    "extrados": "touches at the extrados only",
    "hinge": "touches at this corner only",
    "open": "open joint",
}


def draw_case(
    run: Results, number: int, magnify: float | str | None = None, with_forces: bool = True, numbers: bool = False,
    coordinates: bool = False
) -> Figure:
    """Draw one case of any scene.

    Parameters
    ----------
    magnify : float or "auto", optional
        Magnification of the displaced shape, chosen and stated with "auto". Without it what stands
        is drawn as it stands, and a collapse mechanism, which has no size, as large as can be seen.
    with_forces : bool, optional
        Whether the forces of the joints are drawn.
    numbers : bool, optional
        Whether blocks have their numbers on them.
    coordinates : bool, optional
        Whether the axes are drawn [m].

    Raises
    ------
    KeyError
        If there is no such case, or its blocks were not written.
    """
    title = title_of(row_with_safety(run, number), run)
    scene, source = scene_of(run, number), source_of(run)
    joints = run.joints_of(number) if run.joints is not None else None
    ways = run.points_of(number)
    shapes, beginning = (scene.shapes(1.0 if now and scene.moves else 0.0) for now in (True, False))
    supports = [block.corners for block in scene.supports]
    seen = beginning + shapes + ([way_of(way) for way in ways] if scene.moves else [])
    size = float(np.subtract(*view(seen, supports)[::-1]).max())
    low, high = view([*seen, *load_arrows(source, size)], supports)
    figure, axes = new_figure(low, high)
    entries = draw_supports(axes, supports)
    if scene.moves and scene.largest > SEEN * size:
        entries += draw_beginning(axes, beginning, scene.largest)
    entries += draw_blocks(axes, scene, shapes, source.materials)
    factor = factor_of(scene, magnify, size)
    if factor > 0.0:
        entries += draw_displaced(axes, scene, factor)
    entries += draw_ways(axes, scene, ways, factor)
    if joints is not None:
        entries += draw_joints(axes, scene, joints, size, with_forces)
    entries += draw_loads(axes, source, size) + draw_held(axes, source, scene)
    if numbers:
        draw_numbers(axes, scene, shapes)
    if coordinates:
        show_coordinates(axes)
    else:
        draw_scale(axes, low, high)
    axes.set_title(title, fontsize=10.5)
    figure.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, -0.02), fontsize=9)
    return figure


def row_with_safety(run: Results, number: int) -> dict[str, Any]:
    """Row of a case; of an arch that stands at rest, with the geometrical safety, where dda is there to find it."""
    from voussoir.dda_program import DdaError
    from voussoir.deck.thickness import thickness_safety

    row = run.case(number)
    stands = row["verdict"] == "stable" and (row["mode"], row["geometry"]) == ("static", "reference")
    if not stands or run.kind not in ("arch", "shape") or run.searched:
        return row
    try:
        row["safety_thickness"] = thickness_safety(run, number)[0]
    except (FileNotFoundError, DdaError):
        pass
    return row


def new_figure(low: np.ndarray, high: np.ndarray) -> tuple[Figure, Axes]:
    """A figure whose shape is that of a piece of plane, and its bare axes."""
    wide, tall = high - low
    height = min(max(WIDTH * tall / wide, LEAST_HEIGHT), MOST_HEIGHT) + 0.5
    figure = Picture(figsize=(WIDTH, height), layout="constrained")
    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    return figure, axes


def draw_supports(axes: Axes, supports: list[np.ndarray]) -> list[Artist]:
    """Draw what cannot move; gives the entries of the legend."""
    if not supports:
        return []
    style = {"facecolor": "white", "edgecolor": INK[3], "linewidth": 0.6, "hatch": "////"}
    axes.add_collection(PolyCollection(supports, **style, zorder=0))
    return [Patch(**style, label="fixed")]


def draw_beginning(axes: Axes, shapes: list[np.ndarray], largest: float) -> list[Artist]:
    """Draw where blocks that have moved were; gives the entries of the legend."""
    axes.add_collection(
        PolyCollection(shapes, facecolors="none", edgecolors=INK[3], linewidths=0.7, linestyles="--", zorder=1))
    words = f"at the beginning; true scale, largest displacement {length_text(largest)}"
    return [entry(words, linestyle="--", color=INK[3], linewidth=0.9)]


def draw_blocks(axes: Axes, scene: CaseScene, shapes: list[np.ndarray], materials: Sequence[int] = ()) -> list[Artist]:
    """Draw the blocks that can move, where their joints are told, by materials; gives the entries."""
    known = len(materials) >= max((block.number for block in scene.blocks), default=0)
    groups: dict[tuple[int, bool], list[np.ndarray]] = {}
    for block, shape in zip(scene.blocks, shapes):
        material = materials[block.number - 1] if known else 1
        groups.setdefault((material, block.state == "held"), []).append(shape)
    several = len({material for material, _ in groups}) > 1
    entries: list[Artist] = []
    for (material, held), chosen in sorted(groups.items()):
        style = {
            "facecolor": TINTS[(material - 1) % len(TINTS)],
            "edgecolor": "#777777",
            "linewidth": 0.7,
            "hatch": "..." if held else None,
        }
        axes.add_collection(PolyCollection(chosen, **style, zorder=1.5))
        words = f"blocks of material {material}" if several else "blocks"
        entries.append(Patch(**style, label=words + (" held by points" if held else "")))
    return entries


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


def draw_displaced(axes: Axes, scene: CaseScene, factor: float) -> list[Artist]:
    """Draw the displaced shape or the mechanism; gives the entries of the legend."""
    axes.add_collection(
        PolyCollection(scene.shapes(factor), facecolors="none", edgecolors=INK[0], linewidths=0.8, zorder=2))
    words = f"displaced shape, displacements × {factor:g} (largest {length_text(scene.largest)})"
    if scene.falls:
        words = f"collapse mechanism, drawn with a largest displacement of {length_text(factor)}"
    return [entry(words, linestyle="-", color=INK[0], linewidth=0.8)]


def way_of(way: Table) -> np.ndarray:
    """Where a measured point was after each step: (n, 2) [m]."""
    return np.column_stack((way["x"], way["y"]))


def draw_ways(axes: Axes, scene: CaseScene, ways: list[Table], factor: float) -> list[Artist]:
    """Draw the ways of the measured points as the blocks are drawn; gives the entries."""
    for way in ways:
        motion = np.column_stack((way["u"], way["v"]))
        start = way_of(way)[0] - motion[0]
        points = start + motion * (1.0 if scene.moves and factor == 0.0 else factor)
        axes.plot(*points.T, color=INK[1], linewidth=1.1, linestyle=(0, (4, 1.5)), zorder=5)
        axes.plot(*points[-1], marker="D", color=INK[1], markersize=4, zorder=6)
        axes.annotate(
            str(way["point"][0]), points[-1], xytext=(5, 3), textcoords="offset points", fontsize=8, color=INK[1],
            zorder=8)
    if not ways:
        return []
    words = "measured points and their ways" if scene.moves or factor > 0.0 else "measured points"
    return [entry(words, linestyle=(0, (4, 1.5)), color=INK[1], marker="D", markersize=4, linewidth=1.1)]


def draw_joints(axes: Axes, scene: CaseScene, joints: Table, size: float, with_forces: bool) -> list[Artist]:
    """Draw thrust, forces, hinges and slips; gives the entries of the legend."""
    entries = draw_thrust(axes, joints) if scene.is_arch else []
    if scene.voussoirs:
        entries = draw_ring_thrust(axes, scene, joints)
    if with_forces:
        entries += draw_forces(axes, scene, joints, size)
    return entries + draw_hinges(axes, scene, joints) + draw_slips(axes, scene, joints, size)


def thrust_points(joints: Table) -> np.ndarray:
    """Where the forces act: (n, 2) [m]; NaN where a joint carries nothing."""
    points = np.column_stack((joints["x"], joints["y"]))
    points[~(joints["normal_force"] > 0.0)] = np.nan
    return points


def draw_thrust(axes: Axes, joints: Table) -> list[Artist]:
    """Draw the line of thrust of an arch; gives the entries of the legend."""
    axes.plot(*thrust_points(joints).T, color=INK[1], linewidth=2.6, zorder=4)
    return [entry("line of thrust", linestyle="-", color=INK[1])]


def draw_ring_thrust(axes: Axes, scene: CaseScene, joints: Table) -> list[Artist]:
    """Draw the line of thrust through the voussoirs of each ring; gives the entries of the legend."""
    points = thrust_points(joints)
    for pair in ring_joints(joints["block_1"], joints["block_2"], scene.count, scene.voussoirs):
        axes.plot(*points[list(pair)].T, color=INK[1], linewidth=2.6, solid_capstyle="round", zorder=4)
    return [entry("line of thrust", linestyle="-", color=INK[1])]


def draw_forces(axes: Axes, scene: CaseScene, joints: Table, size: float) -> list[Artist]:
    """Draw the force of each joint on its second block, or on the one of its two that can move.

    Gives the entries of the legend.
    """
    vectors = np.column_stack((joints["force_x"], joints["force_y"]))
    vectors[np.isin(joints["block_2"], [block.number for block in scene.supports])] *= -1.0
    largest = float(np.hypot(*vectors.T).max(initial=0.0))
    if not largest > 0.0:
        return []
    arrows = vectors * (FORCE_LENGTH * size / largest)
    axes.quiver(
        *thrust_points(joints).T, *arrows.T, angles="xy", scale_units="xy", scale=1.0, color=INK[2], width=0.002,
        headwidth=4.5, zorder=4.5)
    words = f"contact forces, longest {force_text(largest, scene.unit)}"
    return [entry(words, linestyle="-", color=INK[2], linewidth=1.2)]


def roles_of(joints: Table) -> np.ndarray:
    """What each joint does: in the collapse if there is one, else at the end of the run."""
    mechanism = joints["mechanism"]
    return mechanism if np.any(mechanism != "none") else joints["state"]


def draw_hinges(axes: Axes, scene: CaseScene, joints: Table) -> list[Artist]:
    """Draw hinges and open joints; gives the entries of the legend.

    A joint of one corner turns about it always: it is marked in a collapse only.
    """
    entries: list[Artist] = []
    role = roles_of(joints)
    collapses = role is joints["mechanism"]
    two = np.hypot(joints["x_extrados"] - joints["x_intrados"], joints["y_extrados"] - joints["y_intrados"]) > 0.0
    two |= joints["mechanism"] != "none"
    places = {
        "intrados": (role == "hinge_intrados", "x_intrados", "y_intrados"),
        "extrados": (role == "hinge_extrados", "x_extrados", "y_extrados"),
        "open": (role == "open", "x", "y"),
    }
    seen = set()
    for kind, (mask, x, y) in places.items():
        mask = mask & two
        mark = "hinge" if kind != "open" and not scene.is_arch else kind
        if not mask.any():
            continue
        axes.plot(
            joints[x][mask], joints[y][mask], linestyle="none", zorder=6,
            markersize=6.5 if len(joints) <= MANY else 4.0, **MARKS[mark])
        if mark not in seen:
            words = MEANINGS[mark] if collapses else TOUCHES[mark]
            entries.append(entry(words, **MARKS[mark]))
        seen.add(mark)
    return entries


def draw_slips(axes: Axes, scene: CaseScene, joints: Table, size: float) -> list[Artist]:
    """Draw which way the sides of sliding joints move; gives the entries of the legend."""
    slides = np.flatnonzero(np.isfinite(joints["slides_x"]))
    falls = scene.falls or scene.moves
    centre = {block.number: block.corners.mean(axis=0) for block in scene.blocks + scene.supports}
    long = np.hypot(*(joints[f"{axis}_extrados"] - joints[f"{axis}_intrados"] for axis in "xy"))
    usual = np.median(long[long > 0.0]) if np.any(long > 0.0) else size
    length, few = min(SLIP_LENGTH * size, 0.5 * float(usual)), len(joints) <= MANY
    for joint in slides:
        way = np.array([joints["slides_x"][joint], joints["slides_y"][joint]])
        normal = np.array([-way[1], way[0]])
        first, second = (centre[int(joints[f"block_{side}"][joint])] for side in (1, 2))
        if (second - first) @ normal < 0.0:
            normal = -normal
        middle = 0.5 * np.array(
            [joints[f"{axis}_intrados"][joint] + joints[f"{axis}_extrados"][joint] for axis in "xy"]
        )
        for side in (1.0, -1.0):
            start = middle + side * (0.3 * length * normal - 0.5 * length * way)
            axes.annotate(
                "", start + side * length * way, start, zorder=7,
                arrowprops={"arrowstyle": "->", "color": INK[0], "linewidth": 1.3 if few else 0.9, "shrinkA": 0,
                            "shrinkB": 0, "mutation_scale": 10 if few else 6})
    if not len(slides):
        return []
    words = "sliding joint: which way its sides move" if falls else "joint at its friction limit"
    return [entry(words, marker=r"$\rightleftarrows$", markerfacecolor=INK[0], markeredgecolor=INK[0], markersize=11)]


def draw_scale(axes: Axes, low: np.ndarray, high: np.ndarray) -> None:
    """Draw a bar of a round length below the picture."""
    length = rounded(0.2 * float(high[0] - low[0]))
    room = 0.035 * float((high - low).max())
    start, level = low[0] + room, low[1] - room
    axes.plot(
        [start, start + length], [level, level], color=INK[0], linewidth=2.0, solid_capstyle="butt", clip_on=False,
        zorder=9)
    axes.annotate(
        length_text(length), (start + length, level), xytext=(5, 0), textcoords="offset points", va="center",
        fontsize=9, annotation_clip=False)
