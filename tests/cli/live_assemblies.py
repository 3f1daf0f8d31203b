"""Random walls, arches and heaps with live loads, and the linear programme of their joints as verify finds them."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import numpy as np
from bridges import abutment, polygon, voussoirs

MANY = 2.0**40  #: A factor beside which rounding of the dead loads is not felt


def random_wall(source: random.Random) -> str:
    """Courses of bricks of random lengths and heights, on fixed ground, some leaning."""
    length, height = source.uniform(2.0, 6.0), 0.0
    lean = source.choice([0.0, 0.0, source.uniform(-0.1, 0.1)])
    text = polygon([(-1.0, -1.0), (length + 1.0, -1.0), (length + 1.0, 0.0), (-1.0, 0.0)], "block fixed")
    courses = source.randint(2, 6)
    for _ in range(courses):
        top = height + source.uniform(0.3, 0.8)
        heads = sorted({0.0, length, *(source.uniform(0.15, 0.85) * length for _ in range(source.randint(0, 4)))})
        heads = [x for k, x in enumerate(heads) if k == 0 or x - heads[k - 1] > 0.1 or x == length]
        for left, right in zip(heads, heads[1:]):
            text += polygon([(left + lean * height, height), (right + lean * height, height),
                             (right + lean * top, top), (left + lean * top, top)])
        height = top
    # on the left face of the top course
    x, y = lean * (height - 0.1), height - 0.1
    force = (source.uniform(0.2, 1.0), source.uniform(-0.5, 0.3))
    return text + f"live {x!r} {y!r} {force[0]!r} {force[1]!r}\n"


def random_arch(source: random.Random) -> str:
    """A ring or two, loaded on an extrados chord."""
    embrace, count, thickness = source.uniform(100, 170), source.randint(6, 24), source.uniform(0.15, 0.3)
    rings = source.choice([1, 1, 2])
    radii = [1.0 - thickness / 2.0 + thickness * k / rings for k in range(rings + 1)]
    blocks = voussoirs(radii, embrace, count)
    half = math.radians(embrace / 2.0)
    text = "".join(polygon(block) for block in blocks)
    text += abutment(radii[0], radii[-1], -half) + abutment(radii[0], radii[-1], half)
    loaded = (rings - 1) * count + source.randrange(count // 4, count // 2)
    (ax, ay), (bx, by) = blocks[loaded][2:]
    return text + f"live block {loaded + 1} {(ax + bx) / 2!r} {(ay + by) / 2!r} {source.uniform(-0.05, 0.05)!r} -0.3\n"


def random_assembly(seed: int) -> tuple[str, float]:
    """A file of blocks and its friction angle."""
    source = random.Random(seed)
    text = (random_wall if source.random() < 0.6 else random_arch)(source)
    return text, math.degrees(math.atan(source.uniform(0.35, 0.9)))


@dataclass
class Effects:
    """What forces of one do to the free blocks of a scene, in the largest dead load of a block."""

    normal: np.ndarray  #: A column for each corner of a joint: a force along the normal
    along: np.ndarray  #: A column for each corner: a force along the joint
    first: list[int]  #: First corner of each joint, and how many corners come before the end
    friction: np.ndarray  #: Friction of each corner's joint
    dead: np.ndarray
    live: np.ndarray
    strength: list[float]  #: Strength of each joint over its length


def effects(scene) -> Effects:
    """Effects of joint forces and loads of a scene of voussoir.verify, its load being that of a factor of one."""
    from voussoir.verify.loads import loads_on
    from voussoir.verify.proofs import push

    dead = loads_on(scene.deck.with_value("load_factor", "0"), scene.source, scene.blocks)
    # of many, lest rounding of the weights be in it
    live = (loads_on(scene.deck.with_value("load_factor", repr(MANY)), scene.source, scene.blocks) - dead) / MANY
    free = [block.number - 1 for block in scene.blocks if not block.fixed]
    unit = np.abs(dead).max()
    columns: dict[str, list[np.ndarray]] = {"normal": [], "tangent": []}
    first, friction = [0], []
    for joint in scene.joints:
        for end in joint.ends[: 1 if joint.single else 2]:
            for name, made in columns.items():
                effect = np.zeros((len(scene.blocks), 3))
                push(effect, scene.blocks[joint.second - 1], end, getattr(joint, name))
                push(effect, scene.blocks[joint.first - 1], end, -getattr(joint, name))
                made.append(effect[free].ravel())
            friction.append(scene.friction(joint))
        first.append(len(friction))
    return Effects(
        np.array(columns["normal"]).T, np.array(columns["tangent"]).T, first, np.array(friction),
        dead[free].ravel() / unit, live[free].ravel() / unit, [scene.crush(joint) / unit for joint in scene.joints],
    )


def programme(scene, crushes: bool = False) -> float | None:
    """Largest load factor of a scene of voussoir.verify by HiGHS, its load being that of a factor of one.

    A joint that crushes has tangents of its parabola as cuts, each where the last solution lies beyond the parabola,
    until none does: what cuts allow is never less than what the parabola does.

    Parameters
    ----------
    scene
        Blocks, joints, deck and file of blocks, of voussoir.verify.proofs.
    crushes
        Whether joints have the strength of their blocks.
    """
    from scipy.optimize import linprog

    of = effects(scene)
    rays = np.stack([of.normal + of.friction * of.along, of.normal - of.friction * of.along], axis=2)
    matrix = np.c_[rays.reshape(len(of.dead), -1), of.live]
    pressed = [(2 * first, strength) for first, strength in zip(of.first, of.strength)] if crushes else []
    cost = np.zeros(matrix.shape[1])
    cost[-1] = -1.0
    cuts: list[np.ndarray] = []
    most: list[float] = []

    def touch(first: int, strength: float, share: float) -> None:
        for way in (1.0, -1.0):
            # more at one corner than at the other: at most as much as the tangent has
            cut = np.zeros(matrix.shape[1])
            cut[first:first + 2], cut[first + 2:first + 4] = way - (1 - 2 * share), -way - (1 - 2 * share)
            cuts.append(cut)
            most.append(share**2 * strength)

    for first, strength in pressed:
        for share in np.geomspace(1e-3, 1.0, 8):
            touch(first, strength, share)
    while True:
        found = linprog(cost, A_eq=matrix, b_eq=-of.dead, bounds=(0.0, None), method="highs-ds",
                        A_ub=np.array(cuts) if cuts else None, b_ub=most or None,
                        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10})
        if found.status != 0:
            return None
        before = len(cuts)
        for first, strength in pressed:
            ends = found.x[first:first + 2].sum(), found.x[first + 2:first + 4].sum()
            if abs(ends[0] - ends[1]) > sum(ends) * (1 - sum(ends) / strength) + 1e-9 * strength:
                touch(first, strength, sum(ends) / strength)
        if len(cuts) == before:
            return -found.fun


@dataclass
class HeldState:
    """A collapse under Coulomb's law: forces that balance a factor of the live load, and how the blocks then move.

    Each figure is a share of the largest: of the forces, or of the motion at the corners of joints.
    """

    factor: float
    #: Imbalance of the forces, what they have beyond the law, and the largest change of a capacity in one more round
    imbalance: float
    beyond: float
    change: float
    #: Closing of corners, opening of those that press, slip of joints below their capacity, slip along the friction
    closing: float
    opening: float
    slip: float
    uphill: float
    power: float  #: Power of the live load


def held_state(scene, share: float, rounds: int = 400) -> HeldState:
    """Collapse of a scene by capacities of friction that are held, and follow the normal forces until these stay.

    Parameters
    ----------
    scene
        Blocks, joints, deck and file of blocks, of voussoir.verify.proofs.
    share
        How much of the way to the new capacities each round goes: all of it need not end.
    rounds
        Most rounds of the linear programme.
    """
    from scipy.optimize import linprog

    of = effects(scene)
    corners, joints = of.normal.shape[1], len(of.first) - 1
    matrix = np.c_[of.normal, of.along[:, of.first[:-1]], of.live]
    cost = np.zeros(matrix.shape[1])
    cost[-1] = -1.0
    friction = of.friction[of.first[:-1]]
    options = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}

    def pressing(normal: np.ndarray) -> np.ndarray:
        return np.add.reduceat(normal, of.first[:-1])

    cones = np.zeros((2 * joints, matrix.shape[1]))
    for joint in range(joints):
        for row, way in ((2 * joint, 1.0), (2 * joint + 1, -1.0)):
            cones[row, of.first[joint]:of.first[joint + 1]] = -friction[joint]
            cones[row, corners + joint] = way
    free = [(0.0, None)] * corners + [(None, None)] * (joints + 1)
    found = linprog(cost, A_eq=matrix, b_eq=-of.dead, A_ub=cones, b_ub=np.zeros(2 * joints), bounds=free,
                    method="highs-ds", options=options)
    capacity = friction * pressing(found.x[:corners])
    for _ in range(rounds):
        held = [(0.0, None)] * corners + [(-most, most) for most in capacity] + [(None, None)]
        found = linprog(cost, A_eq=matrix, b_eq=-of.dead, bounds=held, method="highs-ds", options=options)
        asked = friction * pressing(found.x[:corners])
        change = float(np.abs(asked - capacity).max() / asked.max())
        if change < 1e-11:
            break
        capacity = (1.0 - share) * capacity + share * asked
    normal, shear = found.x[:corners], found.x[corners:-1]
    velocity = found.eqlin.marginals * (1.0 if of.live @ found.eqlin.marginals > 0.0 else -1.0)
    opens, slips = of.normal.T @ velocity, of.along[:, of.first[:-1]].T @ velocity
    moved = max(np.abs(opens).max(), np.abs(slips).max())
    largest = normal.max()
    below = np.abs(shear) < asked - 1e-9 * largest
    return HeldState(
        factor=float(found.x[-1]), imbalance=float(np.abs(matrix @ found.x + of.dead).max()) / largest,
        beyond=float(np.max(np.abs(shear) - asked)) / largest, change=change,
        closing=float(max(-opens.min(), 0.0)) / moved,
        opening=float(np.abs(opens[normal > 1e-9 * largest]).max(initial=0.0)) / moved,
        slip=float(np.abs(slips[below]).max(initial=0.0)) / moved,
        uphill=float(max(np.max(shear * slips, initial=0.0), 0.0)) / (moved * largest), power=float(of.live @ velocity))
