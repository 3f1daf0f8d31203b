"""Joints of a case as its picture shows them: thrust line, forces, hinges, openings, slips."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from voussoir.plot.case_marks import entry
from voussoir.plot.case_scene import CaseScene
from voussoir.plot.collapse_picture import MARKS, MEANINGS
from voussoir.plot.figure_style import INK, SMALL, type_of
from voussoir.plot.motion import Motion
from voussoir.plot.sheet import POINTS
from voussoir.plot.thrust_path import thrust_pairs
from voussoir.plot.units import quantity
from voussoir.results import Table

#: Longest force and length of slip marks in the picture, over its size
FORCE_LENGTH, SLIP_LENGTH = 0.10, 0.03
#: Number of marked joints above which colours of lines replace symbols
MOST_MARKS = 40
#: Median distance of marks below which they run into one another, least and greatest size of marks [points]
APART, SMALLEST, LARGEST = 5.0, 2.5, 6.5
#: Least widths of a thrust line and of coloured joints [points]
THINNEST_THRUST, THINNEST_STATE = 0.9, 0.35
#: Least gap of a joint that is seen as open in a fall: the width of a line [points]
SEEN_GAP = 1.0
#: More joints than these have no forces unless they are asked for
MOST_FORCES = 150
#: What the marks mean where nothing collapses
TOUCHES = {
    "intrados": "touches at the intrados only",
    "extrados": "touches at the extrados only",
    "hinge": "touches at this corner only",
    "open": "open joint",
}
#: Discs of joints that touch at one corner where nothing turns: not those of hinges
TOUCH_MARKS: dict[str, dict[str, Any]] = {
    **MARKS, **{kind: {**MARKS[kind], "markerfacecolor": "white"} for kind in ("intrados", "hinge")}}


def roles_of(joints: Table, moved: bool = False) -> np.ndarray:
    """Motion of each joint: in the collapse if there is one, else at the end of the run.

    A collapse from a moved shape has the hinges of that shape, too: it has begun with them.
    """
    mechanism, state = joints["mechanism"], joints["state"]
    if not np.any(mechanism != "none"):
        return state
    kept = moved & (mechanism == "none") & np.isin(state, ("hinge_intrados", "hinge_extrados"))
    return np.asarray(np.where(kept, state, mechanism))


def falling_roles(joints: Table, points_per_metre: float) -> np.ndarray:
    """State of each joint of falling blocks: a hinge where it touches at one corner, open where a gap is seen."""
    gaps = np.fmax(joints["opening_intrados"], joints["opening_extrados"]) * points_per_metre
    roles = np.array(np.where(gaps > SEEN_GAP, joints["state"], "none"), dtype=object)
    length = np.hypot(joints["x_extrados"] - joints["x_intrados"], joints["y_extrados"] - joints["y_intrados"])
    roles[(length == 0.0) & (joints["state"] != "open")] = "hinge"
    return roles


def thrust_points(joints: Table) -> np.ndarray:
    """Where the forces act, as the table has it: (n, 2) [m]; NaN where a joint carries nothing."""
    points = np.column_stack((joints["x"], joints["y"]))
    points[~(joints["normal_force"] > 0.0)] = np.nan
    return points


class JointMarks:
    """The joints of one case, where its picture shows them.

    `size` is that of the piece of plane [m], `pen` the width of lines over that of a large picture, and
    `points_per_metre` the scale of the drawing.
    """

    def __init__(
        self, scene: CaseScene, joints: Table, motion: Motion, size: float, pen: float = 1.0,
        points_per_metre: float = POINTS
    ) -> None:
        self.scene, self.joints, self.size, self.pen = scene, joints, size, pen
        first, second = joints["block_1"], joints["block_2"]
        self.sides = {}
        for name, x, y in (("in", "x_intrados", "y_intrados"), ("out", "x_extrados", "y_extrados"), ("at", "x", "y")):
            there = np.column_stack((joints[x], joints[y]))
            self.sides[name] = (motion.carried(there, first), motion.carried(there, second))
        self.collapses = scene.is_falling or bool(np.any(joints["mechanism"] != "none"))
        self.roles = roles_of(joints, scene.moves)
        if scene.is_falling:
            self.roles = falling_roles(joints, motion.shown * points_per_metre)
        long = np.hypot(joints["x_extrados"] - joints["x_intrados"], joints["y_extrados"] - joints["y_intrados"]) > 0.0
        self.pairs = thrust_pairs(scene, joints)
        self.turns = self.collapses or scene.moves and bool(self.pairs)
        # a joint of one corner turns about it always: it is marked in a collapse and in arches that have moved
        self.marked = long | (joints["mechanism"] != "none") | (self.turns and scene.moves)
        self.slides = np.isfinite(joints["slides_x"])
        self.opens = np.isin(self.roles, ("hinge_intrados", "hinge_extrados", "hinge", "open")) & self.marked
        lengths = np.hypot(*(self._middle("out") - self._middle("in")).T)
        self.thickness = float(np.median(lengths[lengths > 0.0])) * points_per_metre if np.any(lengths > 0.0) else 0.0
        places = self._middle("at")[self.opens | self.slides]
        self.gap = median_gap(places) * points_per_metre
        self.crowded = len(places) > MOST_MARKS or len(places) > 3 and self.gap < APART

    def _middle(self, name: str) -> np.ndarray:
        """Points of the joints, halfway between their two blocks: (n, 2) [m]."""
        one, other = self.sides[name]
        return np.asarray(0.5 * (one + other))

    @property
    def mark_size(self) -> float:
        """Size of the marks [points]."""
        return float(np.clip(0.45 * self.gap, SMALLEST, LARGEST * min(1.0, self.pen)))

    def draw(self, axes: Axes, with_forces: bool | None) -> list[Artist]:
        """Draw all; gives the entries of the legend."""
        entries = self.draw_thrust(axes) if self.pairs and not self.scene.is_falling else []
        if with_forces or with_forces is None and not self.pairs and len(self.joints) <= MOST_FORCES:
            entries += self.draw_forces(axes)
        if self.crowded:
            return entries + self.draw_states(axes)
        return entries + self.draw_hinges(axes) + self.draw_slips(axes)

    def thrust_points(self) -> np.ndarray:
        """Where the forces act in the picture: (n, 2) [m]; NaN where a joint carries nothing."""
        return np.where(np.isnan(thrust_points(self.joints)), np.nan, self._middle("at"))

    def draw_thrust(self, axes: Axes) -> list[Artist]:
        """Draw the thrust line; gives the entries of the legend."""
        points = self.thrust_points()
        width = float(np.clip(0.22 * self.thickness, THINNEST_THRUST, 2.4 * self.pen))
        lines = [points[list(pair)] for pair in self.pairs if np.isfinite(points[list(pair)]).all()]
        axes.add_collection(
            LineCollection(lines, colors=INK[1], linewidths=width, capstyle="round", joinstyle="round", zorder=4))
        return [entry("thrust line", linestyle="-", color=INK[1], linewidth=width)]

    def draw_forces(self, axes: Axes) -> list[Artist]:
        """Draw the force of each joint on the upper of its two blocks."""
        vectors = np.column_stack((self.joints["force_x"], self.joints["force_y"]))
        height = {block.number: block.corners[:, 1].mean() for block in self.scene.blocks + self.scene.supports}
        first, second = ([height[number] for number in self.joints[f"block_{side}"].tolist()] for side in (1, 2))
        vectors[np.array(first) > np.array(second)] *= -1.0
        largest = float(np.hypot(*vectors.T).max(initial=0.0))
        if not largest > 0.0:
            return []
        arrows = vectors * (FORCE_LENGTH * self.size / largest)
        axes.quiver(
            *self.thrust_points().T, *arrows.T, angles="xy", scale_units="xy", scale=1.0, color=INK[2],
            width=0.8 * self.pen / POINTS, units="inches", headwidth=4.5, zorder=4.5)
        words = f"contact forces on the upper block, longest {quantity(largest, self.scene.unit)}"
        return [entry(words, marker=r"$\uparrow$", markersize=type_of(SMALL), color=INK[2])]

    def draw_states(self, axes: Axes) -> list[Artist]:
        """Draw the lines of joints in the colours of what they do; gives the entries of the legend."""
        entries: list[Artist] = []
        width = float(np.clip(0.25 * self.thickness, THINNEST_STATE, max(0.8, 1.6 * self.pen)))
        kinds = (
            (self.opens & ~self.slides, INK[0], "joint that opens"),
            (self.slides, INK[2], "joint that slides" if self.collapses or self.scene.moves
             else "joint at its friction limit"),
        )
        for mask, color, words in kinds:
            lines = [
                line for one, other in zip(self.sides["in"], self.sides["out"])
                for line in np.stack((one[mask], other[mask]), axis=1)]
            if lines:
                axes.add_collection(LineCollection(lines, colors=color, linewidths=width, capstyle="round", zorder=3))
                entries.append(entry(words, linestyle="-", color=color, linewidth=width))
        return entries

    def draw_hinges(self, axes: Axes) -> list[Artist]:
        """Draw hinges and open joints; gives the entries of the legend."""
        entries: list[Artist] = []
        kinds = (("intrados", "hinge_intrados", "in"), ("extrados", "hinge_extrados", "out"), ("hinge", "hinge", "at"),
                 ("open", "open", "at"))
        marks, words = (MARKS, MEANINGS) if self.turns else (TOUCH_MARKS, TOUCHES)
        has_names = self.scene.is_arch or self.scene.moves and self.scene.voussoirs > 0
        seen = set()
        for kind, role, at in kinds:
            mask = (self.roles == role) & self.marked
            mark = "hinge" if kind != "open" and not has_names else kind
            if not mask.any():
                continue
            style: dict[str, Any] = {"markersize": self.mark_size, "markeredgewidth": 0.9 * self.pen, **marks[mark]}
            axes.plot(*self._middle(at)[mask].T, linestyle="none", zorder=6, **style)
            if mark not in seen:
                entries.append(entry(words[mark], **style))
            seen.add(mark)
        return entries

    def draw_slips(self, axes: Axes) -> list[Artist]:
        """Draw which way the sides of sliding joints move; gives the entries of the legend."""
        joints, slides = self.joints, np.flatnonzero(self.slides)
        if not len(slides):
            return []
        centre = {block.number: block.corners.mean(axis=0) for block in self.scene.blocks + self.scene.supports}
        ends = [self._middle(name) for name in ("in", "out")]
        long = np.hypot(*(ends[1] - ends[0]).T)
        usual = np.median(long[long > 0.0]) if np.any(long > 0.0) else self.size
        length = min(SLIP_LENGTH * self.size, 0.5 * float(usual))
        for joint in slides:
            way = np.array([joints["slides_x"][joint], joints["slides_y"][joint]])
            normal = np.array([-way[1], way[0]])
            first, second = (centre[int(joints[f"block_{side}"][joint])] for side in (1, 2))
            if (second - first) @ normal < 0.0:
                normal = -normal
            for side in (1.0, -1.0):
                start = 0.5 * (ends[0] + ends[1])[joint] + side * (0.3 * length * normal - 0.5 * length * way)
                axes.annotate(
                    "", start + side * length * way, start, zorder=7,
                    arrowprops={"arrowstyle": "->", "color": INK[0], "linewidth": 1.2 * self.pen, "shrinkA": 0,
                                "shrinkB": 0, "mutation_scale": 9 * self.pen})
        falls = self.scene.falls or self.scene.moves
        words = "sliding joint: directions of its sides" if falls else "joint at its friction limit"
        return [entry(words, marker=r"$\rightleftarrows$", markerfacecolor=INK[0], markeredgecolor=INK[0],
                      markersize=9, markeredgewidth=0.3)]


def median_gap(points: np.ndarray) -> float:
    """Median distance of points to their nearest neighbours; infinite for fewer than two."""
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) < 2 or len(points) > 20 * MOST_MARKS:
        return np.inf if len(points) < 2 else 0.0
    apart = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    return float(np.median(apart.min(axis=1)))
