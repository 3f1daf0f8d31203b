"""Limit analysis of arches as linear programs, solved by HiGHS through scipy: the peer in time.

Two programs say whether an arch of rigid blocks can stand. The general one has three contact
forces a joint and three balances a block, sparse. The compact one has two unknowns in all, the
crown thrust and its place, and holds for symmetric arches with a joint at the crown only.
"""

from __future__ import annotations

from typing import Any

import numpy as np

#: HiGHS' answers: an admissible system of forces was found, or there is none
_FEASIBLE, _INFEASIBLE = 0, 2


def scipy_version() -> str | None:
    """Version of scipy, None where it is missing."""
    try:
        import scipy
    except ImportError:
        return None
    return str(scipy.__version__)


def stands_by_general(
    half_angle: float, voussoirs: int, ratio: float, friction: float, method: str = "highs", tolerance: float = 1e-7
) -> bool:
    """Whether an arch stands, by the general program: whether admissible joint forces balance the weights.

    Parameters
    ----------
    half_angle : float
        Half angle of embrace [rad].
    ratio : float
        Thickness over radius.
    method : str, optional
        "highs-ds" (simplex), "highs-ipm" (interior points), or "highs", which chooses.
    tolerance : float, optional
        By how much HiGHS may violate rows.
    """
    from scipy.optimize import linprog
    from scipy.sparse import coo_array

    joints = voussoirs + 1
    balance, loads = _balance(half_angle, voussoirs, ratio)
    number = np.arange(2 * joints)
    first = 3 * (number // 2)
    sign = np.where(number % 2 == 0, 1.0, -1.0)
    cone_entries = (
        np.concatenate([-friction * np.ones(4 * joints), sign]),
        (np.tile(number, 3), np.concatenate([first, first + 1, first + 2])),
    )
    cone = coo_array(cone_entries, shape=(2 * joints, 3 * joints)).tocsr()
    lower = np.tile([0.0, 0.0, -np.inf], joints)
    return _stands(
        linprog(
            np.zeros(3 * joints), A_ub=cone, b_ub=np.zeros(2 * joints), A_eq=balance, b_eq=loads,
            bounds=np.column_stack([lower, np.full(3 * joints, np.inf)]), method=method,
            options={"primal_feasibility_tolerance": tolerance})
    )


def _balance(half_angle: float, voussoirs: int, ratio: float) -> tuple[Any, np.ndarray]:
    """Equilibrium of the blocks: matrix of the joint forces' share (sparse), and the loads."""
    from scipy.sparse import coo_array

    angle, inner, outer, weight, centre = _blocks(half_angle, voussoirs, ratio)
    joints = voussoirs + 1
    # forces N1 at the intrados, N2 at the extrados, T along the joint towards the extrados, on the
    # block to the right of the joint; the block to its left feels the opposite
    normal = np.column_stack([np.cos(angle), -np.sin(angle)])
    along = np.column_stack([np.sin(angle), np.cos(angle)])
    rows, columns, values = [], [], []
    for side, sign in ((0, 1.0), (1, -1.0)):
        block = np.arange(voussoirs)
        joint = block + side
        for kind, (force, place) in enumerate(((normal, inner), (normal, outer), (along, inner))):
            arm = place[joint] - centre
            moment = arm[:, 0] * force[joint, 1] - arm[:, 1] * force[joint, 0]
            for balance, part in enumerate((force[joint, 0], force[joint, 1], moment)):
                rows.append(3 * block + balance)
                columns.append(3 * joint + kind)
                values.append(sign * part)
    shape = (3 * voussoirs, 3 * joints)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    loads = np.zeros(3 * voussoirs)
    loads[1::3] = weight
    return coo_array(entries, shape=shape).tocsr(), loads


def stands_by_compact(half_angle: float, voussoirs: int, ratio: float, friction: float) -> bool:
    """Whether a symmetric arch with a joint at the crown stands, by the compact program.

    Parameters
    ----------
    half_angle, voussoirs, ratio, friction
        As for `stands_by_general`; the number of voussoirs is even.

    Returns
    -------
    bool
        Whether some horizontal thrust at some height of the crown leads through all joints.
    """
    from scipy.optimize import linprog

    if voussoirs % 2:
        raise ValueError(f"voussoirs must be an even number for the compact program, got {voussoirs}")
    angle, _, _, weight, centre = _blocks(half_angle, voussoirs, ratio)
    half = voussoirs // 2
    angle, weight, lever = angle[half:], weight[half:], centre[half:, 0]
    carried = np.concatenate([[0.0], np.cumsum(weight)])
    moment = np.concatenate([[0.0], np.cumsum(weight * lever)])
    cos, sin = np.cos(angle), np.sin(angle)
    # normal force H cos + W sin, shear force H sin - W cos; with the crown's moment Q about the
    # centre of the circle the thrust cuts a joint at the radius (Q + sum W x)/N
    low, high = 1.0 - ratio / 2.0, 1.0 + ratio / 2.0
    one = np.ones_like(cos)
    zero = np.zeros_like(cos)
    rows = np.vstack(
        [
            np.column_stack([low * cos, -one]), np.column_stack([-high * cos, one]),
            np.column_stack([sin - friction * cos, zero]), np.column_stack([-sin - friction * cos, zero])]
    )
    bounds = np.concatenate(
        [
            moment - low * carried * sin, high * carried * sin - moment, carried * (cos + friction * sin),
            carried * (friction * sin - cos)]
    )
    free = [(None, None), (None, None)]
    return _stands(linprog(np.zeros(2), A_ub=rows, b_ub=bounds, bounds=free, method="highs"))


def _blocks(half_angle: float, voussoirs: int, ratio: float) -> tuple[np.ndarray, ...]:
    """Joint angles, corners at intrados and extrados, weights and centres of gravity.

    The radius is 1, and so is the weight per area.
    """
    angle = half_angle * np.linspace(-1.0, 1.0, voussoirs + 1)
    ray = np.column_stack([np.sin(angle), np.cos(angle)])
    inner, outer = (1.0 - ratio / 2.0) * ray, (1.0 + ratio / 2.0) * ray
    corner = np.stack([inner[:-1], inner[1:], outer[1:], outer[:-1]])
    # from the first corner, so that a thin ring loses no digits
    edge = corner - corner[0]
    cross = edge[1:-1, :, 0] * edge[2:, :, 1] - edge[1:-1, :, 1] * edge[2:, :, 0]
    area = cross.sum(axis=0) / 2.0
    first = (cross[:, :, None] * (edge[1:-1] + edge[2:])).sum(axis=0) / 6.0
    return angle, inner, outer, np.abs(area), corner[0] + first / area[:, None]


def _stands(result: Any) -> bool:
    """Answer of a solved program."""
    if result.status not in (_FEASIBLE, _INFEASIBLE):
        raise RuntimeError(f"HiGHS gave no answer: {result.message}")
    return result.status == _FEASIBLE
