"""The associated limit of any blocks as one linear program, solved by HiGHS through scipy.

Three contact forces a joint, three balances a block, one load factor; what is found is the factor
itself, so that nothing is bisected.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from voussoir.results import Block, Results


@dataclass(frozen=True)
class Assembly:
    """Blocks that can move, their joints, and loads."""

    centre: np.ndarray  #: Centres of gravity: (blocks, 2) [m]
    #: Forces and moments about the centres: (blocks, 3)
    dead: np.ndarray
    live: np.ndarray
    ends: np.ndarray  #: Both ends of each joint: (joints, 2, 2) [m]
    pairs: np.ndarray  #: Places of its two blocks, -1 for one that is fixed: (joints, 2)


def moments(block: Block) -> tuple[float, np.ndarray]:
    """Area and centre of gravity of a polygon."""
    corner = block.corners - block.corners[0]
    x, y = corner.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2.0
    centre = ((corner + np.roll(corner, -1, axis=0)) * cross[:, None]).sum(axis=0) / (6.0 * area)
    return abs(area), block.corners[0] + centre


def assembly_of(run: Results, push: tuple[int, np.ndarray, np.ndarray] | None = None) -> Assembly:
    """What a run of one case says of its blocks and joints; weights are areas.

    `push` is the block, point and force of a live load over the weight per area; without it the weights act towards +x,
    too.
    """
    blocks, joints = run.blocks_of(1), run.joints_of(1)
    free = [block for block in blocks if block.state != "fixed"]
    place = {block.number: number for number, block in enumerate(free)}
    area, centre = map(np.array, zip(*map(moments, free)))
    dead, live = np.zeros((2, len(free), 3))
    dead[:, 1] = -area
    if push is None:
        live[:, 0] = area
    else:
        number, point, force = push
        arm = point - centre[place[number]]
        live[place[number]] = *force, arm[0] * force[1] - arm[1] * force[0]
    ends = np.stack(
        [np.column_stack((joints[f"x_{end}"], joints[f"y_{end}"])) for end in ("intrados", "extrados")], axis=1)
    pairs = np.array(
        [[place.get(int(joints[f"block_{side}"][row]), -1) for side in (1, 2)] for row in range(len(joints))])
    whole = {block.number: moments(block)[1] for block in blocks}
    for row in range(len(joints)):  # ends so that their normal points from the first block to the second
        first, second = (whole[int(joints[f"block_{side}"][row])] for side in (1, 2))
        along = ends[row, 1] - ends[row, 0]
        if along[0] * (second - first)[1] - along[1] * (second - first)[0] < 0.0:
            ends[row] = ends[row, ::-1]
    return Assembly(centre, dead, live, ends, pairs)


def limit_factor(assembly: Assembly, friction: float, method: str, tolerance: float) -> float:
    """The factor of the live loads at which the blocks fall by the associated rule.

    `method` is "highs-ds" (simplex) or "highs-ipm" (interior points); RuntimeError if it gives no answer.
    """
    from scipy.optimize import linprog
    from scipy.sparse import coo_array

    joints, blocks = len(assembly.ends), len(assembly.centre)
    along = assembly.ends[:, 1] - assembly.ends[:, 0]
    along /= np.linalg.norm(along, axis=1)[:, None]
    normal = np.column_stack((-along[:, 1], along[:, 0]))
    rows, columns, values = [], [], []
    for side, sign in ((0, -1.0), (1, 1.0)):
        joint = np.flatnonzero(assembly.pairs[:, side] >= 0)
        block = assembly.pairs[joint, side]
        for kind, (force, end) in enumerate(((normal, 0), (normal, 1), (along, 0))):
            arm = assembly.ends[joint, end] - assembly.centre[block]
            moment = arm[:, 0] * force[joint, 1] - arm[:, 1] * force[joint, 0]
            for balance, part in enumerate((force[joint, 0], force[joint, 1], moment)):
                rows.append(3 * block + balance)
                columns.append(3 * joint + kind)
                values.append(sign * part)
    scale = np.abs(assembly.dead).max()
    loaded = np.flatnonzero(assembly.live)
    rows.append(loaded)
    columns.append(np.full(len(loaded), 3 * joints))
    values.append(assembly.live.ravel()[loaded] / scale)
    place = np.concatenate(rows), np.concatenate(columns)
    balance = coo_array((np.concatenate(values), place), shape=(3 * blocks, 3 * joints + 1))
    row = np.arange(2 * joints)
    first = 3 * (row // 2)
    cone = coo_array(
        (
            np.concatenate([-friction * np.ones(4 * joints), np.where(row % 2 == 0, 1.0, -1.0)]),
            (np.tile(row, 3), np.concatenate([first, first + 1, first + 2])),
        ),
        shape=(2 * joints, 3 * joints + 1),
    )
    options = {"primal_feasibility_tolerance": tolerance, "dual_feasibility_tolerance": tolerance}
    found = linprog(
        np.append(np.zeros(3 * joints), -1.0), A_ub=cone.tocsr(), b_ub=np.zeros(2 * joints), A_eq=balance.tocsr(),
        b_eq=-assembly.dead.ravel() / scale,
        bounds=np.column_stack([np.append(np.tile([0.0, 0.0, -np.inf], joints), 0.0), np.full(3 * joints + 1, np.inf)]),
        method=method, options=options
    )
    if found.status != 0:
        raise RuntimeError(f"HiGHS gave no answer: {found.message}")
    return float(-found.fun)
