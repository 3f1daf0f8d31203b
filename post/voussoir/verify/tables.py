"""Joint forces and displacements of joints.csv and blocks.csv, checked like the proofs."""

from __future__ import annotations

import math

import numpy as np

from voussoir.verify.contacts import Block, Joint, numbers_of
from voussoir.verify.fill import Pull
from voussoir.verify.loads import loads_on, sizes_on
from voussoir.verify.proofs import (
    TOLERANCE, Finding, Scene, digits_of, largest_of, match_joint, push, reach_of, rounding_of)
from voussoir.verify.read import Row

#: Permitted imbalance of joints.csv over the load: a search writes the stable end of its bracket
WRITTEN = 1e-7
#: Share of the largest load to which forces of joints.csv have converged
SETTLED = 1e-8
#: Permitted violation of a law by the forces of a collapse, which are those of the last step
FALLING = 1e-5
#: What rounding leaves between columns that say the same
SAME = 1e-9
#: Less than this is no force along a direction
NONE = 1e-12


def check_joints(
    scene: Scene, rows: list[Row], bars: list[float] | None, finding: Finding, change: np.ndarray, off: float
) -> None:
    """Check that forces of joints.csv obey the law of every joint, and balance the loads of stable cases.

    `bars` are forces of bars.csv, None where forces need not balance; `change` (n, 3) is that of the loads from the
    stable end of the bracket of a search to its value, between which forces balance them, and `off` the distance of
    corners between its ends [m].
    """
    rounding = [off + rounding_of(block) for block in scene.blocks]
    left = loads_on(scene.deck, scene.source, scene.blocks)
    held = {place.block for place in scene.source.held}  # 0 for any block
    free = np.array([not block.fixed and not held & {0, block.number} for block in scene.blocks])
    size = sizes_on(scene.deck, scene.source, scene.blocks)
    largest = largest_of(size[free], scene.length) if free.any() else 1.0
    # a force that is off by a share of the largest load turns a thin block by its arm, many times the joint's length
    allowed = np.zeros_like(left)
    allowed[:, 2] = [SETTLED * largest * reach_of(block) for block in scene.blocks]
    pairs, digits = numbers_of(scene.joints), 0.0
    for pull, force in zip([pull for pull in scene.pulls if pull.kind == "bar"], bars or []):
        beyond = max(-force, 0.0 if pull.most is None else force - float(pull.most), 0.0)
        finding.keep("friction law (joints.csv)", beyond / largest, WRITTEN)
        for number, at, way in zip(pull.blocks, pull.points, (-1.0, 1.0)):
            if number > 0:
                push(left, scene.blocks[number - 1], at, way * force * pull.direction)
    for row in rows:
        number, first, second = (int(row[name]) for name in ("joint", "block_1", "block_2"))
        ends = np.array([[float(row[f"{axis}_{side}"]) for axis in "xy"] for side in ("intrados", "extrados")])
        between = pairs.get((min(first, second), max(first, second)), [])
        joint, order = match_joint(between, ends, scene.blocks[first - 1].size)
        vector = np.array([float(row["force_x"]), float(row["force_y"])])
        at = np.array([float(row["x"]), float(row["y"])])
        if joint is None:
            finding.faults.append(f"blocks {first} and {second} have no joint {number}")
            continue
        way = 1.0 if joint.first == first else -1.0
        normal, shear = float(row["normal_force"]), float(row["shear_force"])
        apart = max(abs(way * float(vector @ joint.normal) - normal), abs(way * float(vector @ joint.tangent) - shear))
        digits = max(digits, digits_of(float(np.abs(vector).max()) / largest))
        finding.keep("columns of a joint", apart / largest, SAME + digits)
        _check_place(row, joint, at, normal, rounding_of(scene.blocks[first - 1]), finding)
        _check_strip(joint, at, normal, scene.crush(joint) if bars is not None else math.inf, largest, finding)
        friction = scene.friction(joint)
        beyond = max(0.0, -normal)
        if math.isfinite(friction):
            beyond = max(beyond, (abs(shear) - friction * normal) / max(1.0, friction))
        finding.keep("friction law (joints.csv)", beyond / largest, WRITTEN if bars is not None else FALLING)
        for share, place in _forces(row, joint, order, way, at, vector):
            push(left, scene.blocks[second - 1], place, share)
            push(left, scene.blocks[first - 1], place, -share)
        for number in (first, second):
            allowed[number - 1, 2] += float(np.linalg.norm(vector)) * rounding[number - 1]
    if bars is None:
        return
    if free.any():
        finding.keep("balance (joints.csv)", _imbalance(scene, left, change, free) / largest,
                     WRITTEN + digits + largest_of(allowed[free], scene.length) / largest)


def _imbalance(scene: Scene, left: np.ndarray, change: np.ndarray, free: np.ndarray) -> float:
    """Least imbalance of `free` blocks on which `left` (n, 3) is left at one end of a bracket, or up to its value.

    The force of what blocks lean against is not written: where there is none, the place between is known.
    """
    size = float((change[free] ** 2).sum())
    between = min(max(-float((left[free] * change[free]).sum()) / size, 0.0), 1.0) if size > 0.0 else 0.0
    least = math.inf
    for share in {0.0, between, 1.0}:
        there = left + share * change
        for block in scene.blocks:
            if free[block.number - 1]:
                _lean(there, block, [pull for pull in scene.pulls if pull.kind == "bounded"], scene.length)
        least = min(least, largest_of(there[free], scene.length))
    return least


def _lean(left: np.ndarray, block: Block, pulls: list[Pull], length: float) -> None:
    """Take from what is left on a block what the fill that it leans against can carry."""
    own = [pull for pull in pulls if pull.blocks[1] == block.number]
    if not own:
        return
    # level forces of given places, each from nothing to its bound, add up to a force and a moment: all of a polygon
    rays = np.array([[pull.direction[0], -(pull.points[1][1] - block.centre[1]) * pull.direction[0] / length]
                     for pull in own], dtype=float)
    most = np.array([np.inf if pull.most is None else float(pull.most) for pull in own])
    wanted = -np.array([left[block.number - 1, 0], left[block.number - 1, 2] / length])
    beyond = 0.0
    for way in [np.array([ray[1], -ray[0]]) for ray in rays] + list(rays):
        for normal in (way, -way):
            share = rays @ normal
            reach = (most[share > NONE] * share[share > NONE]).sum()
            beyond = max(beyond, (normal @ wanted - reach) / np.linalg.norm(normal))
    left[block.number - 1] = [beyond, left[block.number - 1, 1], 0.0]


def _forces(
    row: Row, joint: Joint, order: list[int], way: float, at: np.ndarray, vector: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Forces of joints.csv on the second block, and where they act: each contact's along the normal of its own edge."""
    normal, shear = float(row["normal_force"]), float(row["shear_force"])
    if joint.single or not row["eccentricity_ratio"]:
        return joint.forces(np.array([normal, 0.0, shear]), way) if joint.single else [(vector, at)]
    uneven = float(row["eccentricity_ratio"]) * normal
    return joint.forces(np.array([(normal + uneven) / 2.0, (normal - uneven) / 2.0, shear])[order], way)


def _check_place(row: Row, joint: Joint, at: np.ndarray, normal: float, rounding: float, finding: Finding) -> None:
    """Check that a force acts between the ends of its joint, whose corners are off by `rounding` [m]."""
    middle, along = joint.ends.mean(axis=0), joint.ends[1] - joint.ends[0]
    length = float(np.linalg.norm(along))
    if joint.single or not normal > 0.0:
        return
    beyond, digits = float(np.linalg.norm(at - middle)) / length - 0.5, rounding / length
    finding.keep("place of a force", max(0.0, beyond), WRITTEN + digits)
    aside = along[0] * (at - middle)[1] - along[1] * (at - middle)[0]
    finding.keep("place off its joint", abs(float(aside)) / length**2, TOLERANCE + digits)
    if row["eccentricity_ratio"]:
        written = abs(float(row["eccentricity_ratio"]))
        finding.keep("eccentricity", abs(2.0 * float(np.linalg.norm(at - middle)) / length - written), SAME + digits)


def _check_strip(joint: Joint, at: np.ndarray, normal: float, crush: float, largest: float, finding: Finding) -> None:
    """Check that a joint has room for the strip that bears its force, by the moment that is missing.

    Forces have converged to a share of the `largest` load: smaller forces may be at the very end.
    """
    if joint.single or not normal > 0.0 or not math.isfinite(crush):
        return
    reach = float(np.linalg.norm(at - joint.ends.mean(axis=0)) / np.linalg.norm(joint.ends[1] - joint.ends[0]))
    missing = normal * (reach + normal / crush / 2.0 - 0.5)
    finding.keep("crushing strength (joints.csv)", max(0.0, missing) / largest, SETTLED)


def check_rigid(scene: Scene, rows: list[Row], finding: Finding, strain: float = 0.0) -> None:
    """Check that displacements of blocks.csv are those of rigid blocks, or of blocks that strain alike throughout.

    They may be `strain` times the largest velocity from rigid; infinite where they need not be.
    """
    blocks: dict[int, list[list[float]]] = {}
    for row in rows:
        if row["u"]:
            blocks.setdefault(int(row["block"]), []).append([float(row[name]) for name in ("x", "y", "u", "v")])
    largest = max((abs(value) for block in blocks.values() for corner in block for value in corner[2:]), default=0.0)
    for number, corners in blocks.items():
        x, y, u, v = np.array(corners).T
        if scene.blocks[number - 1].fixed:
            finding.keep("motion of fixed blocks", float(np.abs([u, v]).max()) / max(largest, 1e-300), SAME)
            continue
        arm_x, arm_y = x - x.mean(), y - y.mean()
        spin = float((arm_x * v - arm_y * u).sum() / (arm_x**2 + arm_y**2).sum())
        off = max(np.abs(u - u.mean() + spin * arm_y).max(), np.abs(v - v.mean() - spin * arm_x).max())
        if math.isfinite(strain):
            finding.keep("rigid motion", float(off) / max(largest, 1e-300), SAME + strain)
        linear = np.array([np.ones_like(x), arm_x, arm_y]).T
        left = np.array([u, v]).T - linear @ np.linalg.lstsq(linear, np.array([u, v]).T, rcond=None)[0]
        finding.keep("linear motion", float(np.abs(left).max()) / max(largest, 1e-300), SAME)
