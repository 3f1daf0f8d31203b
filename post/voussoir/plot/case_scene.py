"""Read the picture of one case from the tables of a run: shapes, supports, and the drawn part of the plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from voussoir.plot.units import force_unit
from voussoir.results import Block, Results

#: Room around what moves, and how far beyond it supports are shown, over its size
MARGIN, SUPPORT_REACH = 0.06, 0.25
#: How much of the depth of an arch's supports is shown
SUPPORT_SHARE = 0.3


@dataclass(frozen=True)
class CaseScene:
    """Shapes of one case."""

    blocks: list[Block]  #: Blocks that can move, at the beginning
    supports: list[Block]  #: Blocks that cannot; of an arch only the parts next to the springings
    is_arch: bool  #: Whether the blocks are an arch's
    moves: bool  #: Whether the blocks are computed where they go, so that pictures show them there
    falls: bool  #: Whether the displacements are a collapse mechanism, which has no size
    voussoirs: int = 0  #: Of an arch of any shape, the voussoirs of a ring, which are numbered first
    count: int = 0  #: The number of all of them
    unit: str = "N/m"  #: Unit of its forces
    is_falling: bool = False  #: Whether the blocks are drawn in a fall, without equilibrium

    @property
    def largest(self) -> float:
        """Largest displacement of a corner [m], NaN where none is known."""
        return max((float(np.hypot(*block.displacement.T).max()) for block in self.blocks), default=float("nan"))

    def shapes(self, factor: float) -> list[np.ndarray]:
        """Corners of the blocks that can move, with so many times their displacements."""
        if factor == 0.0:  # where displacements are not known, too
            return [block.corners for block in self.blocks]
        return [block.corners + factor * block.displacement for block in self.blocks]

    def crossings(self, x: float) -> list[float]:
        """Heights at which the outlines of the blocks cross a vertical line, in ascending order."""
        heights = []
        for shape in self.shapes(0.0):
            for start, end in zip(shape, np.roll(shape, -1, axis=0)):
                if min(start[0], end[0]) <= x <= max(start[0], end[0]) and start[0] != end[0]:
                    heights.append(float(start[1] + (x - start[0]) / (end[0] - start[0]) * (end[1] - start[1])))
        return sorted(heights)


def scene_of(run: Results, number: int) -> CaseScene:
    """The shapes of one case; KeyError if the folder has no blocks of it."""
    blocks = run.blocks_of(number)
    is_arch = run.kind == "arch"
    free = [block for block in blocks if block.state != "fixed"]
    supports = [block for block in blocks if block.state == "fixed"]
    if is_arch:
        supports = [shortened(block, free) for block in supports]
    row = run.case(number)
    # a search along a path has the blocks where they come to rest nearest to critical
    moves = row["geometry"] == "current" and (not run.searched or not math.isnan(row["path_time"]))
    falls = row["collapse_mode"] != "none" and not moves
    is_falling = moves and row["verdict"] == "collapsed"
    if run.kind != "shape":
        return CaseScene(free, supports, is_arch, moves, falls, is_falling=is_falling)
    one, rings, spans = (
        int(row.get(name, run.setting(f"arch%{name}") or usual))
        for name, usual in (("voussoirs", 36), ("rings", 1), ("spans", 1))
    )
    return CaseScene(free, supports, is_arch, moves, falls, one, one * rings * spans, force_unit(run), is_falling)


def shortened(support: Block, free: list[Block]) -> Block:
    """A support of an arch of which only the part next to its joint, two corners of a free block, is left.

    Two supports overlap behind the springings where an arch spans much more than a semicircle.
    """
    corners = np.vstack([block.corners for block in free])
    apart = np.linalg.norm(support.corners[:, None] - corners[None], axis=2).min(axis=1)
    near = np.argsort(apart, kind="stable")[:2]
    start, end = support.corners[near]
    along = (end - start) / np.linalg.norm(end - start)
    normal = np.array([-along[1], along[0]])
    depth = (support.corners - start) @ normal
    shape = support.corners - np.outer((1.0 - SUPPORT_SHARE) * depth, normal)
    return Block(support.number, support.state, shape, support.displacement)


def view(shapes: list[np.ndarray], supports: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corner of what shows all that moves, and what of the supports is near to it [m]."""
    points = np.vstack(shapes or supports)
    low, high = points.min(axis=0), points.max(axis=0)
    size = float((high - low).max())
    if supports:
        held = np.vstack(supports)
        low = np.minimum(low, np.maximum(held.min(axis=0), low - SUPPORT_REACH * size))
        high = np.maximum(high, np.minimum(held.max(axis=0), high + SUPPORT_REACH * size))
    return low - MARGIN * size, high + MARGIN * size
