"""Joints of polygons, found from their corners alone."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

#: Blocks touch within this share of the smaller one's size, the root of its area, if a deck gives no other
TOUCH = 1e-4

#: Near misses are joined up to this multiple of that share, at most up to this share; their edges are as parallel
JOINED, WIDEST = 10.0, 1e-3

#: Edges that overlap by less than this share of the shorter one meet at corners only
OVERLAP = 1e-6

#: A corner that bends inwards by a larger sine is a notch
FLAT = 1e-9

#: Sides of a corner may dip by this sine below an edge that it points to
DIP = 0.05


@dataclass
class Block:
    """A polygon, counter-clockwise, with what follows from it."""

    number: int
    corners: np.ndarray
    fixed: bool
    area: float
    centre: np.ndarray
    size: float


@dataclass
class Joint:
    """Where two blocks touch: its ends, the normal from the first to the second, one corner or two."""

    first: int
    second: int
    ends: np.ndarray
    normal: np.ndarray
    single: bool
    #: The edge that the normal stands on, that of the first block
    edge: np.ndarray
    #: Gaps at its ends, at the corner for a single one [m]
    gaps: np.ndarray

    @property
    def tangent(self) -> np.ndarray:
        """Unit vector to the left of the normal."""
        return np.array([-self.normal[1], self.normal[0]])


def make_block(number: int, corners: np.ndarray, fixed: bool) -> Block:
    """A block from its corners (n, 2) in either sense: with area and centre of gravity."""
    shift = corners.mean(axis=0)
    x, y = (corners - shift).T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2
    centre = np.array([((x + np.roll(x, -1)) * cross).sum(), ((y + np.roll(y, -1)) * cross).sum()]) / (6 * area)
    ordered = corners if area > 0 else corners[::-1]
    return Block(number, ordered, fixed, abs(area), centre + shift, math.sqrt(abs(area)))


def find_joints(blocks: list[Block], tolerance: float = TOUCH) -> list[Joint]:
    """All joints of blocks of which one can move: edges that lie together, and corners before edges.

    Near misses are joined, too: edges that have no joint, and the nearest corner of blocks that have none at all.
    """
    blocks = [_without_straight_corners(block) for block in blocks]
    wide = max(tolerance, min(JOINED * tolerance, WIDEST))
    low = np.array([block.corners.min(axis=0) for block in blocks])
    high = np.array([block.corners.max(axis=0) for block in blocks])
    size = np.array([block.size for block in blocks])
    joints = []
    for i, first in enumerate(blocks):
        reach = wide * np.minimum(size[i], size[i + 1:])[:, None]
        near = np.all((low[i + 1:] <= high[i] + reach) & (high[i + 1:] >= low[i] - reach), axis=1)
        for k in np.flatnonzero(near):
            second = blocks[i + 1 + int(k)]
            if not (first.fixed and second.fixed):
                joints += _joined(first, second, tolerance, wide)
    return joints


def _without_straight_corners(block: Block) -> Block:
    """A block without the vertices on its straight sides, unless it turns everywhere by less than is seen."""
    turns = np.abs(_bend(block)) > FLAT
    return replace(block, corners=block.corners[turns]) if turns.sum() >= 3 else block


def _joined(first: Block, second: Block, tolerance: float, wide: float) -> list[Joint]:
    """Joints between two blocks, with those of their near misses."""
    size = min(first.size, second.size)
    joints = _joints_of(first, second, tolerance * size, tolerance * size)
    if wide <= tolerance:
        return joints
    found = _joints_of(first, second, wide * size, tolerance * size)
    edges = [joint for joint in found if not joint.single and _is_near_miss(joint, size)
             and not any(not other.single and (other.ends == joint.ends).all() for other in joints)]
    joints = [joint for joint in joints if not joint.single or not any(
        np.linalg.norm(edge.ends - joint.ends[0], axis=1).min() == 0.0 for edge in edges)] + edges
    corners = [joint for joint in found if joint.single]
    return joints or sorted(corners, key=lambda joint: abs(float(joint.gaps[0])))[:1]


def _is_near_miss(joint: Joint, size: float) -> bool:
    """Whether edges are meant to lie together: they overlap by more than a corner, and are nearly parallel."""
    length = float(np.linalg.norm(joint.ends[1] - joint.ends[0]))
    return length > WIDEST * size and abs(float(joint.gaps[1] - joint.gaps[0])) <= WIDEST * length


def _joints_of(first: Block, second: Block, reach: float, at_end: float) -> list[Joint]:
    """Joints between two blocks with gaps within reach; corners so near to the end of an edge have met it."""
    joints = []
    taken: list[tuple[int, int, np.ndarray]] = []
    for a, b in _near_edges(first, second, reach):
        joint = _edges_together(first, a, second, b, reach)
        if joint is not None:
            joints.append(joint)
            taken += [(side, edge, end) for side, edge in ((0, int(a)), (1, int(b))) for end in joint.ends]
    for side, (owner, other) in enumerate(((first, second), (second, first))):
        for a, k, in_notch in _near_corners(owner, other, reach, at_end):
            corner = other.corners[k]
            if any(
                np.linalg.norm(corner - end) <= at_end and (not in_notch or (side, a) == (of, edge))
                for of, edge, end in taken
            ):
                continue
            start, direction, _ = _edge(owner, a)
            normal = np.array([direction[1], -direction[0]])
            ends = np.array([corner, corner])
            gaps = np.array([(corner - start) @ normal] * 2)
            joints.append(Joint(owner.number, other.number, ends, normal, True, _corners_of(owner, a), gaps))
    return joints


def _near_edges(first: Block, second: Block, reach: float) -> np.ndarray:
    """Pairs of edges whose boxes meet."""
    boxes = []
    for block in (first, second):
        ends = np.array([block.corners, np.roll(block.corners, -1, axis=0)])
        boxes.append((ends.min(axis=0) - reach, ends.max(axis=0) + reach))
    (low, high), (other_low, other_high) = boxes
    meets = (low[:, None] <= other_high[None]) & (high[:, None] >= other_low[None])
    return np.argwhere(meets.all(axis=2))


def _near_corners(owner: Block, other: Block, reach: float, at_end: float) -> list[tuple[int, int, bool]]:
    """Edges of one block with corners of another that lie on them, off their ends, or in notches that both meet."""
    start = owner.corners
    along = np.roll(start, -1, axis=0) - start
    length = np.linalg.norm(along, axis=1)[:, None]
    unit = along / length
    away = other.corners[None] - start[:, None]
    place = (away * unit[:, None]).sum(axis=2)
    off = away[:, :, 0] * unit[:, None, 1] - away[:, :, 1] * unit[:, None, 0]
    near = np.abs(off) <= reach
    inside = near & (place > at_end) & (place < length - at_end)
    notch = (_bend(owner) < -FLAT)[:, None]
    in_notch = near & (notch & (np.abs(place) <= at_end) | np.roll(notch, -1) & (np.abs(place - length) <= at_end))
    in_notch &= (_bend(other) > -FLAT)[None] & _faces(other, unit)
    return [(int(a), int(k), bool(in_notch[a, k])) for a, k in np.argwhere(inside | in_notch)]


def _bend(block: Block) -> np.ndarray:
    """Sine of the angle by which the outline turns at each corner, negative in notches."""
    after = np.roll(block.corners, -1, axis=0) - block.corners
    after = after / np.linalg.norm(after, axis=1)[:, None]
    before = np.roll(after, 1, axis=0)
    return before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]


def _faces(block: Block, unit: np.ndarray) -> np.ndarray:
    """Whether both sides of each corner of a block lead away from edges along unit vectors."""
    after = np.roll(block.corners, -1, axis=0) - block.corners
    after = after / np.linalg.norm(after, axis=1)[:, None]
    normal = np.array([unit[:, 1], -unit[:, 0]])
    return (after @ normal > -DIP).T & (-np.roll(after, 1, axis=0) @ normal > -DIP).T


def _edge(block: Block, number: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Start, direction and length of an edge."""
    start, end = block.corners[number], block.corners[(number + 1) % len(block.corners)]
    length = float(np.linalg.norm(end - start))
    return start, (end - start) / length, length


def _corners_of(block: Block, number: int) -> np.ndarray:
    """Both corners of an edge."""
    return block.corners[[number, (number + 1) % len(block.corners)]]


def _edges_together(first: Block, a: int, second: Block, b: int, reach: float) -> Joint | None:
    """The joint of two edges that lie together, if they do."""
    start, direction, length = _edge(first, a)
    other, opposite, other_length = _edge(second, b)
    if direction @ opposite > -0.9:
        return None
    normal = np.array([direction[1], -direction[0]])
    tail = other + other_length * opposite
    low = max(0.0, min((other - start) @ direction, (tail - start) @ direction))
    high = min(length, max((other - start) @ direction, (tail - start) @ direction))
    if high - low <= OVERLAP * min(length, other_length):
        return None
    ends, gaps = [], []
    for place in (low, high):
        on_first = start + place * direction
        share = (on_first - other) @ opposite
        on_second = other + min(max(share, 0.0), other_length) * opposite
        gaps.append((on_second - on_first) @ normal)
        if abs(gaps[-1]) > reach:
            return None
        # the corner that makes the end, of whichever block
        corners = [*first.corners, *second.corners]
        ends.append(min(corners, key=lambda corner: float(np.linalg.norm(corner - on_first))))
    return Joint(first.number, second.number, np.array(ends), normal, False, _corners_of(first, a), np.array(gaps))


def depth(block: Block, point: np.ndarray) -> float:
    """How deep a point lies in a block, negative outside: its distance from the outline, with a sign."""
    start, point = block.corners.astype(float), np.asarray(point, dtype=float)
    end = np.roll(start, -1, axis=0)
    along = end - start
    share = np.clip(((point - start) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
    distance = float(np.linalg.norm(start + share[:, None] * along - point, axis=1).min())
    y, x = point[1], point[0]
    crosses = (start[:, 1] > y) != (end[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = start[:, 0] + (y - start[:, 1]) / along[:, 1] * along[:, 0]
    inside = int((crosses & (x < at)).sum()) % 2 == 1
    return distance if inside else -distance


def numbers_of(joints: list[Joint]) -> dict[tuple[int, int], list[Joint]]:
    """Joints by their two blocks, the smaller number first: the joints of each pair."""
    pairs: dict[tuple[int, int], list[Joint]] = {}
    for joint in joints:
        pairs.setdefault((min(joint.first, joint.second), max(joint.first, joint.second)), []).append(joint)
    return pairs
