"""Forces and velocities of a case, checked on joints found from the corners of its blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from voussoir.verify.blocks import Source
from voussoir.verify.contacts import TOUCH, Block, Joint, depth, numbers_of
from voussoir.verify.deck import Deck
from voussoir.verify.fill import Pull
from voussoir.verify.loads import friction_of, loads_on, may_hold, pulls_of, sizes_on, strength_of
from voussoir.verify.read import Row

#: Largest figure of a proof that holds
TOLERANCE = 1e-8
#: What rounding leaves of forces, as a share of the largest
DIGITS = 2e-15

#: Rounding of a corner as a share of its coordinates: written once, computed with a few operations
CORNERS = 16 * np.finfo(float).eps
#: Imbalance that rounding of forces far larger than the loads excuses at most
JAMMED = 1e-6

#: Points nearer than this share of a block's size are one
SAME_POINT = 1e-8
#: What closes more slowly than this share of the fastest velocity does so by rounding
STILL = 1e-12


@dataclass
class Finding:
    """What was found of a case: figures that must be small, sentences about what is wrong, and a proven interval."""

    figures: dict[str, float] = field(default_factory=dict)
    allowed: dict[str, float] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    interval: str = ""

    def keep(self, name: str, value: float, most: float = TOLERANCE) -> None:
        """Keep the largest value of a figure, and say where it is too large."""
        self.figures[name] = max(self.figures.get(name, 0.0), value)
        self.allowed[name] = most
        if not value <= most:
            self.faults.append(f"{name} expected at most {most:.0e}, got {value:.3e}")

    def worst(self) -> tuple[float, str, float, float]:
        """Share of what is allowed, name, value and what is allowed of the worst figure."""
        name = max(self.figures, key=lambda name: self.figures[name] / self.allowed[name])
        return self.figures[name] / self.allowed[name], name, self.figures[name], self.allowed[name]


@dataclass
class Scene:
    """Blocks, joints and source of a case."""

    blocks: list[Block]
    joints: list[Joint]
    source: Source
    deck: Deck

    @property
    def length(self) -> float:
        """Half the mean length of a joint."""
        lengths = [np.linalg.norm(joint.ends[1] - joint.ends[0]) for joint in self.joints if not joint.single]
        return float(np.mean(lengths)) / 2.0 if lengths else 1.0

    @cached_property
    def pulls(self) -> list[Pull]:
        """Bars, and what fill presses with."""
        return pulls_of(self.deck, self.source, self.blocks)

    def friction(self, joint: Joint) -> float:
        """Coefficient of friction of a joint."""
        if self.deck.is_shape():
            # voussoirs come before what they stand on: piers, buttresses, what is fixed
            supports = [number > self.deck.voussoirs for number in (joint.first, joint.second)]
        else:
            supports = [self.blocks[number - 1].fixed for number in (joint.first, joint.second)]
        return friction_of(self.deck, self.source, joint, supports[0] != supports[1])

    def crush(self, joint: Joint) -> float:
        """Strength of a joint over its whole length; infinite where it is not crushed."""
        strength = strength_of(self.deck, self.source, joint)
        if strength is None:
            return math.inf
        return float(strength) * float(np.linalg.norm((joint.ends[1] - joint.ends[0]).astype(float)))


def check_forces(scene: Scene, rows: list[Row], finding: Finding) -> None:
    """Check that forces at joints and held points (rows of proof_forces.csv) carry the load at their value."""
    left = loads_on(scene.deck, scene.source, scene.blocks)
    free = np.array([not block.fixed for block in scene.blocks])
    largest = largest_of(sizes_on(scene.deck, scene.source, scene.blocks)[free], scene.length)
    pairs, allowed = numbers_of(scene.joints), np.zeros((len(scene.blocks), 3))
    used: set[int] = set()
    spent: set[int] = set()
    for row in rows:
        force = np.array([float(row[name] or 0) for name in ("normal_1", "normal_2", "shear")])
        points = np.array([[float(row["x_1"]), float(row["y_1"])], [float(row["x_2"]), float(row["y_2"])]])
        if row["kind"] == "held":
            block = scene.blocks[int(row["block_2"]) - 1]
            if not may_hold(scene.source, block, points[0], force[:2]):
                finding.faults.append(f"nothing holds block {block.number} at {tuple(points[0])}")
            push(left, block, points[0], force[:2])
            continue
        if row["kind"] in ("bar", "bounded"):
            _check_pull(scene, row, points, spent, left, largest, finding)
            continue
        pair = int(row["block_1"]), int(row["block_2"])
        unused = [joint for joint in pairs.get((min(pair), max(pair)), []) if id(joint) not in used]
        joint, order = match_joint(unused, points, scene.blocks[pair[0] - 1].size)
        if joint is None:
            if np.abs(force).max() > 0.0:
                finding.faults.append(f"blocks {pair[0]} and {pair[1]} have no joint at {tuple(points[0])}")
            continue
        used.add(id(joint))
        way = 1.0 if joint.first == pair[0] else -1.0
        _law(force, joint, scene, largest, finding)
        for vector, at in joint.forces(force[order], way):
            push(left, scene.blocks[pair[1] - 1], at, vector)
            push(left, scene.blocks[pair[0] - 1], at, -vector)
            for number in pair:
                allowed[number - 1] += float(np.linalg.norm(vector)) * rounding_at(scene.blocks[number - 1], points)
    most = max((abs(float(row[name] or 0)) for row in rows for name in ("normal_1", "normal_2", "shear")), default=0.0)
    finding.keep("imbalance", largest_of(left[free], scene.length) / largest,
                 TOLERANCE + digits_of(most / largest) + largest_of(allowed[free], scene.length) / largest)


def rounding_of(block: Block) -> float:
    """How far rounding of its corners may move a corner of a block, or where a force acts on it [m]."""
    return CORNERS * float(np.abs(block.corners.astype(float)).max())


def rounding_at(block: Block, points: np.ndarray) -> np.ndarray:
    """Force [1, 1] and moment [m] that rounding of corners adds to a unit force at the ends of a joint.

    Rounding moves the ends: it displaces the force, and rotates it by the rounding over the length of the joint.
    """
    off, length = rounding_of(block), float(np.linalg.norm(points[1] - points[0]))
    turn = off / length if length > 0.0 else 0.0
    return np.array([turn, turn, off + turn * reach_of(block)])


def reach_of(block: Block) -> float:
    """Length of the diagonal of a block's box [m]."""
    return float(np.linalg.norm(np.ptp(block.corners.astype(float), axis=0)))


def digits_of(force: float) -> float:
    """What rounding makes of a force, as a share of the largest load; blocks that jam press with forces far larger."""
    return min(DIGITS * force, JAMMED)


def _check_pull(
    scene: Scene, row: Row, points: np.ndarray, spent: set[int], left: np.ndarray, largest: float, finding: Finding
) -> None:
    """Check the force of a bar or of fill, and add it to what is left on the blocks."""
    blocks = int(row["block_1"]), int(row["block_2"])
    vector = np.array([float(row["normal_1"]), float(row["normal_2"] or 0)])
    for k, pull in enumerate(scene.pulls):
        size = max(scene.blocks[b - 1].size for b in pull.blocks if b > 0)
        if k in spent or pull.kind != row["kind"] or pull.blocks != blocks:
            continue
        if np.abs(pull.points - points).max() > SAME_POINT * size:
            continue
        spent.add(k)
        value = vector[0] if pull.kind == "bar" else float(vector @ pull.direction)
        if pull.kind == "bounded":
            finding.keep("law of forces", float(np.abs(vector - value * pull.direction).max()) / largest)
            shear = math.inf if row["shear"] == "" else float(row["shear"])
            bound = math.inf if pull.most is None else float(pull.most)
            if shear != bound:
                finding.keep("bounds of forces", abs(shear - bound) / largest)
        most = value if pull.most is None else pull.most
        finding.keep("law of forces", max(0.0, -value, value - most) / largest)
        for number, at, way in ((blocks[0], pull.points[0], -1.0), (blocks[1], pull.points[1], 1.0)):
            if number > 0:
                push(left, scene.blocks[number - 1], at, way * value * pull.direction)
        return
    finding.faults.append(f"no force of the kind {row['kind']} acts between blocks {blocks} at {tuple(points[0])}")


def _law(force: np.ndarray, joint: Joint, scene: Scene, largest: float, finding: Finding) -> None:
    """Check the law of a joint."""
    friction, crush = scene.friction(joint), scene.crush(joint)
    beyond = max(0.0, -force[0], -force[1])
    if math.isfinite(crush):
        # the strip that bears the force is as far from either end as its moment says
        beyond = max(beyond, (force[0] + force[1]) ** 2 / crush / 2.0 - min(force[0], force[1]))
    if joint.single:
        beyond = max(beyond, abs(force[1]))
    if math.isfinite(friction):
        beyond = max(beyond, (abs(force[2]) - friction * (force[0] + force[1])) / max(1.0, friction))
    finding.keep("law of forces", beyond / largest)


def match_joint(joints: list[Joint], ends: np.ndarray, size: float) -> tuple[Joint | None, list[int]]:
    """The joint with two ends, and where its two normal forces and its shear force stand in those of the ends.

    Of joints between the same corners it is the one with the same order of ends.
    """
    ways = [(float(np.abs(joint.ends[order[:2]] - ends).max()), order, k)
            for k, joint in enumerate(joints) for order in ([0, 1, 2], [1, 0, 2])]
    apart, order, k = min(ways, default=(math.inf, [0, 1, 2], 0))
    return joints[k] if apart <= TOUCH * size else None, order


def push(left: np.ndarray, block: Block, at: np.ndarray, vector: np.ndarray) -> None:
    """Add a force at a point to what is left on each block: force and moment, (n, 3)."""
    arm = at - block.centre
    left[block.number - 1] += [*vector, arm[0] * vector[1] - arm[1] * vector[0]]


def largest_of(load: np.ndarray, length: float) -> float:
    """Largest force, or moment over a length, of loads (n, 3): above 0."""
    if len(load) == 0:
        return 1e-300
    return max(float(np.abs(load[:, :2]).max()), float(np.abs(load[:, 2]).max()) / length, 1e-300)


def check_motion(scene: Scene, rows: list[Row], finding: Finding, apart: float = 0.0) -> float:
    """Check that velocities (rows of proof_motion.csv) open or leave every joint and that the load drives them.

    Corners may be so far `apart` from those of the mechanism as the two ends of a bracket are [m].
    Gives the power of the loads, less what bars and fill take at most, over what the loads could do.
    """
    velocity = np.zeros((len(scene.blocks), 3))
    for row in rows:
        block = scene.blocks[int(row["block"]) - 1]
        if block.fixed:
            finding.faults.append(f"block {block.number} is fixed and moves")
        at = np.array([float(row["x"]), float(row["y"])])
        u, v, spin = (float(row[name]) for name in ("u", "v", "spin"))
        off = block.centre - at
        # a corner that is off by its rounding changes the width of a thin block, and so where its middle is
        digits = rounding_of(block) * reach_of(block) ** 2 / block.area
        finding.keep("place of centres", float(np.linalg.norm(off)) / block.size,
                     TOLERANCE + (apart + digits) / block.size)
        velocity[block.number - 1] = [u - spin * off[1], v + spin * off[0], spin]
    fastest = max(float(np.abs(velocity[:, :2]).max()), scene.length * float(np.abs(velocity[:, 2]).max()), 1e-300)
    power = 0.0
    for joint in scene.joints:
        ends = [velocity_at(scene, velocity, joint.second, end) - velocity_at(scene, velocity, joint.first, end)
                for end in joint.ends]
        slides = [velocity_at(scene, velocity, number, joint.middle) for number in (joint.first, joint.second)]
        friction, slip = scene.friction(joint), abs(float((slides[1] - slides[0]) @ joint.tangent))
        opens = [float(rate @ across) for rate, across in zip(ends, joint.across)]
        opening, crush = min(opens), scene.crush(joint)
        beyond = max(-opening, slip)
        if math.isfinite(crush):
            if not math.isfinite(friction):
                finding.keep("law of velocities", slip / fastest)
            closing = sorted((friction * slip if math.isfinite(friction) else 0.0) - rate for rate in opens)
            if closing[1] > STILL * fastest:
                # fibres that close take the strength, and their rates lie on a line
                rate = sum(closing) if closing[0] >= 0.0 else closing[1] ** 2 / (closing[1] - closing[0])
                power -= crush * rate / 2.0
            continue
        if math.isfinite(friction):
            beyond = (friction * slip - opening) / max(1.0, friction)
        finding.keep("law of velocities", max(0.0, beyond) / fastest)
    for block in scene.blocks:
        for point, along in [] if block.fixed else held_points(scene, block):
            speed = velocity_at(scene, velocity, block.number, point)
            moved = max((abs(float(speed[k])) for k in range(2) if along[k]), default=0.0)
            finding.keep("law of velocities", moved / fastest)
    for pull in scene.pulls:
        rates = [velocity_at(scene, velocity, number, at) if number > 0 else np.zeros(2)
                 for number, at in zip(pull.blocks, pull.points)]
        parting = float((rates[1] - rates[0]) @ pull.direction)
        if pull.most is None:
            finding.keep("law of velocities", max(0.0, -parting) / fastest)
        else:
            power += pull.most * min(0.0, parting)
    load = loads_on(scene.deck, scene.source, scene.blocks)
    # what the power of a decision is a share of is what the program takes, too
    size = load if scene.deck.searched is None else sizes_on(scene.deck, scene.source, scene.blocks)
    most = float((np.linalg.norm(size[:, :2], axis=1) * np.linalg.norm(velocity[:, :2], axis=1)
                  + np.abs(size[:, 2] * velocity[:, 2])).sum())
    return (float((load * velocity).sum()) + power) / max(most, 1e-300)


def held_points(scene: Scene, block: Block) -> list[tuple[np.ndarray, tuple[bool, bool]]]:
    """Held points of a block, and along what: each point, and whether it is held along x and along y."""
    return [(np.array(end), held.along) for held in scene.source.held for end in held.ends
            if held.block in (0, block.number) and depth(block, np.array(end)) >= -TOUCH * block.size]


def velocity_at(scene: Scene, velocity: np.ndarray, number: int, point: np.ndarray) -> np.ndarray:
    """Velocity of a point of a block, from velocities of the centres and spins, (n, 3)."""
    u, v, spin = velocity[number - 1]
    arm = point - scene.blocks[number - 1].centre
    return np.array([u - spin * arm[1], v + spin * arm[0]])
