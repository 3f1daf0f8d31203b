"""Random walls, arches and heaps with live loads, and the linear programme of their joints as verify finds them."""

from __future__ import annotations

import math
import random

import numpy as np
from bridges import abutment, polygon, voussoirs

#: A factor beside which rounding of the dead loads is not felt
MANY = 2.0**40


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
    """A file of blocks and its friction angle.

    Parameters
    ----------
    seed
        The same seed gives the same assembly.
    """
    source = random.Random(seed)
    text = (random_wall if source.random() < 0.6 else random_arch)(source)
    return text, math.degrees(math.atan(source.uniform(0.35, 0.9)))


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
    from voussoir.verify.loads import loads_on
    from voussoir.verify.proofs import push

    dead = loads_on(scene.deck.with_value("load_factor", "0"), scene.source, scene.blocks)
    # of many, lest rounding of the weights be in it
    live = (loads_on(scene.deck.with_value("load_factor", repr(MANY)), scene.source, scene.blocks) - dead) / MANY
    free = [block.number - 1 for block in scene.blocks if not block.fixed]
    unit = np.abs(dead).max()
    columns, pressed = [], []
    for joint in scene.joints:
        friction = scene.friction(joint)
        if crushes:
            pressed.append((len(columns), scene.crush(joint) / unit))
        for k in (0,) if joint.single else (0, 1):
            for sign in (1.0, -1.0):
                effect = np.zeros((len(scene.blocks), 3))
                for vector, at in ((joint.normal, joint.ends[k]), (sign * friction * joint.tangent, joint.ends[k])):
                    push(effect, scene.blocks[joint.second - 1], at, vector)
                    push(effect, scene.blocks[joint.first - 1], at, -vector)
                columns.append(effect[free].ravel())
    matrix = np.array([*columns, live[free].ravel() / unit]).T
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
        found = linprog(cost, A_eq=matrix, b_eq=-dead[free].ravel() / unit, bounds=(0.0, None), method="highs-ds",
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
