"""The associated limit of any blocks as one linear program, solved by HiGHS through scipy.

Three contact forces a joint, three balances a block, one load factor; what is found is the factor
itself, so that nothing is bisected.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from voussoir.results import Results


@dataclass(frozen=True)
class Assembly:
    """Blocks that can move, their joints, and loads."""

    centre: np.ndarray  #: Centres of gravity: (blocks, 2) [m]
    dead: np.ndarray  #: Forces and moments about the centres: (blocks, 3)
    live: np.ndarray
    ends: np.ndarray  #: Both ends of each joint: (joints, 2, 2) [m]
    pairs: np.ndarray  #: Places of its two blocks, -1 for one that is fixed: (joints, 2)


def moments(corners: np.ndarray) -> tuple[float, np.ndarray]:
    """Area and centre of gravity of a polygon."""
    corner = corners - corners[0]
    x, y = corner.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = cross.sum() / 2.0
    centre = ((corner + np.roll(corner, -1, axis=0)) * cross[:, None]).sum(axis=0) / (6.0 * area)
    return abs(area), corners[0] + centre


def assembly_of(run: Results, push: tuple[int, np.ndarray, np.ndarray] | None = None) -> Assembly:
    """Blocks and joints of a run of one case; weights are areas.

    `push` is the block, point and force of a live load over the weight per area; without it the weights act towards +x,
    too.
    """
    blocks, joints = run.blocks_of(1), run.joints_of(1)
    free = [block for block in blocks if block.state != "fixed"]
    place = {block.number: number for number, block in enumerate(free)}
    area, centre = map(np.array, zip(*(moments(block.corners) for block in free)))
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
    whole = {block.number: moments(block.corners)[1] for block in blocks}
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
    scale = np.abs(assembly.dead).max()
    found = solve(assembly, friction, method, tolerance, scale, assembly.live.ravel() / scale)
    if found.status != 0:
        raise RuntimeError(f"HiGHS gave no answer: {found.message}")
    return float(-found.fun)


def solve(
    assembly: Assembly, friction: float, method: str, tolerance: float, scale: float = 1.0,
    live: np.ndarray | None = None
) -> Any:
    """The linear program of three forces a joint and, with live loads, their factor, of which most is wanted.

    Forces over the scale are N1 and N2 at both ends and T along the joint, on its second block; the first feels the
    opposite. Without live loads the answer is whether some forces balance the dead ones.
    """
    from scipy.optimize import linprog
    from scipy.sparse import coo_array

    joints, factors = len(assembly.ends), 0 if live is None else 1
    values, (rows, columns) = _balance(assembly)
    if live is not None:
        loaded = np.flatnonzero(live)
        rows = np.append(rows, loaded)
        columns = np.append(columns, np.full(len(loaded), 3 * joints))
        values = np.append(values, live[loaded])
    shape = 3 * len(assembly.centre), 3 * joints + factors
    row = np.arange(2 * joints)
    first = 3 * (row // 2)
    cone = coo_array((
        np.concatenate([-friction * np.ones(4 * joints), np.where(row % 2 == 0, 1.0, -1.0)]),
        (np.tile(row, 3), np.concatenate([first, first + 1, first + 2])),
    ), shape=(2 * joints, shape[1]))
    lower = np.append(np.tile([0.0, 0.0, -np.inf], joints), np.zeros(factors))
    options = {"primal_feasibility_tolerance": tolerance}
    if live is not None:
        options["dual_feasibility_tolerance"] = tolerance
    return linprog(
        np.append(np.zeros(3 * joints), -np.ones(factors)), A_ub=cone.tocsr(), b_ub=np.zeros(2 * joints),
        A_eq=coo_array((values, (rows, columns)), shape=shape).tocsr(), b_eq=-assembly.dead.ravel() / scale,
        bounds=np.column_stack([lower, np.full(shape[1], np.inf)]), method=method, options=options)


def _balance(assembly: Assembly) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Effect of the joint forces on the blocks: entries, and their rows and columns."""
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
    return np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
