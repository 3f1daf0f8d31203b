"""Joint forces and displacements as joints.csv and blocks.csv tell them, checked like the proofs."""

from __future__ import annotations

import math

import numpy as np

from voussoir.verify_contacts import TOUCH, Joint, numbers_of
from voussoir.verify_loads import loads_on
from voussoir.verify_proofs import Finding, Row, Scene, largest_of, push

#: What told forces may leave of a load: those of a search are of the bracket's end that stands
TOLD = 1e-7
#: What rounding leaves between columns that say the same
SAME = 1e-9


def check_joints(scene: Scene, rows: list[Row], finding: Finding, allowed: float = 0.0) -> None:
    """Check that told joint forces balance the loads and keep the law of every joint.

    Parameters
    ----------
    scene : Scene
        The case, at a value that stands.
    rows : list of dict
        Rows of joints.csv.
    finding : Finding
        Receives the figures.
    allowed : float
        What the forces may leave besides, as the bracket of a search is as wide.
    """
    left = loads_on(scene.deck, scene.source, scene.blocks)
    free = np.array([not block.fixed and not _is_held(scene, block.number) for block in scene.blocks])
    largest = largest_of(left[free], scene.length) if free.any() else 1.0
    pairs = numbers_of(scene.joints)
    for row in rows:
        number, first, second = (int(row[name]) for name in ("joint", "block_1", "block_2"))
        ends = np.array([[float(row[f"{axis}_{side}"]) for axis in "xy"] for side in ("intrados", "extrados")])
        joint = _near(pairs.get((min(first, second), max(first, second)), []), ends, scene, first)
        vector = np.array([float(row["force_x"]), float(row["force_y"])])
        at = np.array([float(row["x"]), float(row["y"])])
        if joint is None:
            finding.faults.append(f"blocks {first} and {second} have no joint {number}")
            continue
        way = 1.0 if joint.first == first else -1.0
        normal, shear = float(row["normal_force"]), float(row["shear_force"])
        apart = max(abs(way * float(vector @ joint.normal) - normal), abs(way * float(vector @ joint.tangent) - shear))
        finding.keep("columns of a joint", apart / largest, SAME)
        _check_place(row, joint, at, normal, finding)
        friction = scene.friction(joint)
        beyond = max(0.0, -normal)
        if math.isfinite(friction):
            beyond = max(beyond, (abs(shear) - friction * normal) / max(1.0, friction))
        finding.keep("law of told forces", beyond / largest, TOLD)
        # the shear force acts halfway, where its moment is that of anywhere along the joint
        push(left, scene.blocks[second - 1], at, vector)
        push(left, scene.blocks[first - 1], at, -vector)
    if free.any():
        finding.keep("balance of told forces", largest_of(left[free], scene.length) / largest, TOLD + allowed)


def _is_held(scene: Scene, number: int) -> bool:
    """Whether a point of a block may be held."""
    return any(held.block in (0, number) for held in scene.source.held)


def _near(joints: list[Joint], ends: np.ndarray, scene: Scene, first: int) -> Joint | None:
    """The joint with two ends."""
    reach = TOUCH * scene.blocks[first - 1].size
    for joint in joints:
        if min(np.abs(joint.ends - ends).max(), np.abs(joint.ends[::-1] - ends).max()) <= reach:
            return joint
    return None


def _check_place(row: Row, joint: Joint, at: np.ndarray, normal: float, finding: Finding) -> None:
    """The force acts between the ends of its joint, where its eccentricity says."""
    middle, length = joint.ends.mean(axis=0), float(np.linalg.norm(joint.ends[1] - joint.ends[0]))
    if joint.single or not normal > 0.0:
        return
    beyond = max(0.0, float(np.linalg.norm(at - middle)) / length - 0.5)
    finding.keep("place of a force", beyond, TOLD)
    finding.keep("place off its joint", abs(float((at - middle) @ joint.normal)) / length)
    if row["eccentricity_ratio"]:
        told = abs(float(row["eccentricity_ratio"]))
        finding.keep("eccentricity", abs(2.0 * float(np.linalg.norm(at - middle)) / length - told), SAME)


def check_rigid(scene: Scene, rows: list[Row], finding: Finding, strain: float = 0.0) -> None:
    """Check that told velocities of a mechanism are those of rigid blocks, or of blocks that strain alike throughout.

    Parameters
    ----------
    scene : Scene
        The case.
    rows : list of dict
        Rows of blocks.csv.
    finding : Finding
        Receives the figures.
    strain : float
        How far blocks may be from rigid, over the largest velocity.
    """
    told: dict[int, list[list[float]]] = {}
    for row in rows:
        if row["u"]:
            told.setdefault(int(row["block"]), []).append([float(row[name]) for name in ("x", "y", "u", "v")])
    largest = max((abs(value) for block in told.values() for corner in block for value in corner[2:]), default=0.0)
    for number, corners in told.items():
        x, y, u, v = np.array(corners).T
        if scene.blocks[number - 1].fixed:
            finding.keep("motion of fixed blocks", float(np.abs([u, v]).max()))
            continue
        arm_x, arm_y = x - x.mean(), y - y.mean()
        spin = float((arm_x * v - arm_y * u).sum() / (arm_x**2 + arm_y**2).sum())
        off = max(np.abs(u - u.mean() + spin * arm_y).max(), np.abs(v - v.mean() - spin * arm_x).max())
        finding.keep("rigid motion", float(off) / max(largest, 1e-300), SAME + strain)
        linear = np.array([np.ones_like(x), arm_x, arm_y]).T
        left = np.array([u, v]).T - linear @ np.linalg.lstsq(linear, np.array([u, v]).T, rcond=None)[0]
        finding.keep("linear motion", float(np.abs(left).max()) / max(largest, 1e-300), SAME)
