"""Joints of polygons, found from their corners alone."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from voussoir.polygon import distance

#: Blocks touch within this share of the smaller one's size, the root of its area, if a deck gives no other
TOUCH = 1e-4

#: Near misses are joined up to this multiple of that share, at most up to this share; their edges are as parallel
JOINED, WIDEST = 10.0, 1e-3

#: Edges that overlap by less than this share of the shorter one meet at corners only
OVERLAP = 1e-6

#: Edges lie together if their directions differ by no more than this sine
PARALLEL = 0.1

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
    """Contact of two blocks: a corner of the one on an edge of the other at each end, the same twice for a corner."""

    first: int
    second: int
    ends: np.ndarray  #: The corners: (2, 2)
    #: Both corners of the edge at each end, in the order in which it runs along the first block: (2, 2, 2)
    edges: np.ndarray
    single: bool
    #: The two contacts: block 0 or 1 that has the edge, number of the edge and of the other block's corner
    contacts: tuple[tuple[int, int, int], ...]
    across: np.ndarray = field(init=False)  #: Unit normals of the edges, from the first block to the second: (2, 2)
    gaps: np.ndarray = field(init=False)  #: Gaps at both ends [m]
    normal: np.ndarray = field(init=False)  #: Unit normal of the joint: that of its edges, or halfway between theirs
    #: Middle of the feet of the corners on their edges, where the shear force acts
    middle: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        along = self.edges[:, 1] - self.edges[:, 0]
        along = along / np.linalg.norm(along, axis=1)[:, None]
        self.across = np.array([[way[1], -way[0]] for way in along])
        # an edge of the second block has the first block's corner on its other side
        sides = np.array([1.0 if contact[0] == 0 else -1.0 for contact in self.contacts])
        off = ((self.ends - self.edges[:, 0]) * self.across).sum(axis=1)
        self.gaps = off * sides
        self.middle = (self.ends - off[:, None] * self.across).mean(axis=0)
        normal = self.across.mean(axis=0)
        self.normal = normal / np.linalg.norm(normal)

    @property
    def tangent(self) -> np.ndarray:
        """Unit vector to the left of the normal."""
        return np.array([-self.normal[1], self.normal[0]])

    def forces(self, force: np.ndarray, way: float = 1.0) -> list[tuple[np.ndarray, np.ndarray]]:
        """Vectors and places of two normal forces and a shear force on the second block; of the first by way -1."""
        normals = [(way * value * across, end) for value, across, end in zip(force, self.across, self.ends)]
        return [*normals, (way * force[2] * self.tangent, self.middle)]


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
    low = np.array([block.corners.min(axis=0) for block in blocks])
    high = np.array([block.corners.max(axis=0) for block in blocks])
    shares = [tolerance] if tolerance >= WIDEST else [tolerance, WIDEST]
    reaches = [_reaches(blocks, low, high, share) for share in shares]
    joints = []
    for i, first in enumerate(blocks):
        reach, beside = (row[:, None] for row in reaches[-1])
        far = np.minimum(reach[i], reach[i + 1:])
        near = np.all((low[i + 1:] <= high[i] + far) & (high[i + 1:] >= low[i] - far), axis=1)
        for k in i + 1 + np.flatnonzero(near):
            if first.fixed and blocks[k].fixed:
                continue
            # blocks beside both bound the reach: a sheet between two blocks is thicker than its own reach
            bounds = [float(min(own[i], own[k], max(least[i], least[k]))) for own, least in reaches]
            joints += _joined(first, blocks[k], bounds, shares)
    return joints


def _reaches(blocks: list[Block], low: np.ndarray, high: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """A share of the size of each block, at most half its thickness; and the least of the blocks that it meets [m]."""
    around = [float(np.linalg.norm(np.roll(block.corners, -1, axis=0) - block.corners, axis=1).sum())
              for block in blocks]
    reach = np.array([min(share * block.size, block.area / length) for block, length in zip(blocks, around)])
    low, high = low - reach[:, None], high + reach[:, None]
    beside = [float(reach[((low <= top) & (high >= foot)).all(axis=1)].min()) for foot, top in zip(low, high)]
    return reach, np.array(beside)


def _without_straight_corners(block: Block) -> Block:
    """A block without the vertices on its straight sides, unless it turns everywhere by less than is seen."""
    turns = np.abs(_bend(block)) > FLAT
    return replace(block, corners=block.corners[turns]) if turns.sum() >= 3 else block


def _joined(first: Block, second: Block, reaches: list[float], shares: list[float]) -> list[Joint]:
    """Joints between two blocks, with those of their near misses, by the reach at the tolerance and at the widest."""
    joints = _joints_of(first, second, reaches[0], reaches[0])
    if len(shares) == 1:
        return joints
    size = reaches[1] / shares[1]
    known = {joint.contacts for joint in joints}
    misses = [joint for joint in _joints_of(first, second, reaches[1], shares[0] * size) if joint.contacts not in known]
    edges = [joint for joint in misses if not joint.single and _is_misfit(joint, size)]
    corners = [joint for joint in misses if joint.single and not joints and not edges]
    nearest = sorted(corners, key=lambda joint: abs(float(joint.gaps[0])))[:1]
    most = max(shares[0], min(JOINED * shares[0], WIDEST)) * size
    edges, nearest = ([miss for miss in rows if float(np.abs(miss.gaps).max()) <= most] for rows in (edges, nearest))
    # a corner that touches is part of the joint of its edge
    parts = {contact for edge in edges for contact in edge.contacts}
    return [joint for joint in joints if not (joint.single and joint.contacts[0] in parts)] + edges + nearest


def _is_misfit(joint: Joint, size: float) -> bool:
    """Whether edges are meant to lie together: they overlap by more than a corner, and are nearly parallel."""
    length = float(abs((joint.ends[1] - joint.ends[0]) @ joint.tangent))
    return length > WIDEST * size and abs(float(joint.gaps[1] - joint.gaps[0])) <= WIDEST * length


def _joints_of(first: Block, second: Block, reach: float, at_end: float) -> list[Joint]:
    """Joints between two blocks with gaps within reach; corners so near to the end of an edge have met it."""
    both, joints = (first, second), []
    for a, b in _near_edges(first, second, reach):
        joint = _edges_together(first, int(a), second, int(b), reach)
        if joint is not None:
            joints.append(joint)
    taken = {contact for joint in joints for contact in joint.contacts}
    for side in (0, 1):
        for edge, corner in _near_corners(both[side], both[1 - side], reach, at_end):
            if (side, edge, corner) not in taken:
                joints.append(_joint(first, second, [(side, edge, corner)]))
    return joints


def _joint(first: Block, second: Block, contacts: list[tuple[int, int, int]]) -> Joint:
    """The joint of one contact or two."""
    both = (first, second)
    twice = (contacts * 2)[:2]
    ends = np.array([both[1 - side].corners[corner] for side, _, corner in twice])
    pairs = [both[side].corners[[edge, (edge + 1) % len(both[side].corners)]] for side, edge, _ in twice]
    edges = np.array([pair[::1 - 2 * side] for pair, (side, _, _) in zip(pairs, twice)])
    return Joint(first.number, second.number, ends, edges, len(contacts) == 1, tuple(contacts * 2)[:2])


def _near_edges(first: Block, second: Block, reach: float) -> np.ndarray:
    """Pairs of edges whose boxes meet."""
    boxes = []
    for block in (first, second):
        ends = np.array([block.corners, np.roll(block.corners, -1, axis=0)])
        boxes.append((ends.min(axis=0) - reach, ends.max(axis=0) + reach))
    (low, high), (other_low, other_high) = boxes
    meets = (low[:, None] <= other_high[None]) & (high[:, None] >= other_low[None])
    return np.argwhere(meets.all(axis=2))


def _near_corners(owner: Block, other: Block, reach: float, at_end: float) -> list[tuple[int, int]]:
    """Edges of one block, and corners of another that point to them: off their ends, or in notches that both meet."""
    start = owner.corners
    along = np.roll(start, -1, axis=0) - start
    length = np.linalg.norm(along, axis=1)[:, None]
    unit = along / length
    away = other.corners[None] - start[:, None]
    place = (away * unit[:, None]).sum(axis=2)
    off = away[:, :, 0] * unit[:, None, 1] - away[:, :, 1] * unit[:, None, 0]
    # in a notch the edge ends at its wall, at a corner that sticks out another edge may be meant
    zone = np.where(_bend(owner) <= -FLAT, -at_end, at_end)[:, None]
    near = (np.abs(off) <= reach) & (place >= zone) & (place <= length - np.roll(zone, -1))
    near &= (_bend(other) > -FLAT)[None] & _faces(other, unit)
    return [(int(edge), int(corner)) for edge, corner in np.argwhere(near)]


def _bend(block: Block) -> np.ndarray:
    """Sine of the angle by which the outline turns at each corner, negative in notches."""
    after = np.roll(block.corners, -1, axis=0) - block.corners
    after = after / np.linalg.norm(after, axis=1)[:, None]
    before = np.roll(after, 1, axis=0)
    return np.asarray(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])


def _faces(block: Block, unit: np.ndarray) -> np.ndarray:
    """Whether both sides of each corner of a block lead away from edges along unit vectors."""
    after = np.roll(block.corners, -1, axis=0) - block.corners
    after = after / np.linalg.norm(after, axis=1)[:, None]
    normal = np.array([unit[:, 1], -unit[:, 0]])
    return np.asarray((after @ normal > -DIP).T & (-np.roll(after, 1, axis=0) @ normal > -DIP).T)


def _edge(block: Block, number: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Start, direction and length of an edge."""
    start, end = block.corners[number], block.corners[(number + 1) % len(block.corners)]
    length = float(np.linalg.norm(end - start))
    return start, (end - start) / length, length


def _edges_together(first: Block, a: int, second: Block, b: int, reach: float) -> Joint | None:
    """The joint of two edges that lie together, if they do: each end is the inner one of two corners."""
    start, direction, length = _edge(first, a)
    other, opposite, other_length = _edge(second, b)
    sine = direction[0] * opposite[1] - direction[1] * opposite[0]
    if direction @ opposite > 0.0 or abs(sine) > PARALLEL:
        return None
    way = direction - opposite
    way = way / np.linalg.norm(way)
    stop, tail = start + length * direction, other + other_length * opposite
    own = [0.0, float(way @ (stop - start))]
    its = [float(way @ (tail - start)), float(way @ (other - start))]
    if not min(own[1], its[1]) - max(own[0], its[0]) > OVERLAP * min(own[1] - own[0], its[1] - its[0]):
        return None
    contacts = []
    for mine, theirs, ahead in ((a, b + 1, own[0] - its[0]), (a + 1, b, its[1] - own[1])):
        mine, theirs = mine % len(first.corners), theirs % len(second.corners)
        # a notch touches no edge: rounding decides which of two corners that meet is ahead
        is_mine = ahead >= 0.0 and _bend(first)[mine] > -FLAT or _bend(second)[theirs] <= -FLAT
        contacts.append((1, b, mine) if is_mine else (0, a, theirs))
    joint = _joint(first, second, contacts)
    return joint if float(np.abs(joint.gaps).max()) <= reach else None


def depth(block: Block, point: np.ndarray) -> float:
    """How deep a point lies in a block, negative outside: its distance from the outline, with a sign."""
    return -distance(block.corners.astype(float), np.asarray(point, dtype=float))


def numbers_of(joints: list[Joint]) -> dict[tuple[int, int], list[Joint]]:
    """Joints by their two blocks, the smaller number first: the joints of each pair."""
    pairs: dict[tuple[int, int], list[Joint]] = {}
    for joint in joints:
        pairs.setdefault((min(joint.first, joint.second), max(joint.first, joint.second)), []).append(joint)
    return pairs
