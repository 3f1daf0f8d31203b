"""Limit analysis of arches as linear programs, solved by HiGHS through scipy: the peer in time.

Two programs say whether an arch of rigid blocks can stand. The general one has three contact
forces a joint and three balances a block, sparse. The compact one has two unknowns in all, the
crown thrust and its place, and holds for symmetric arches with a joint at the crown only.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from voussoir_benches.limit_lp_blocks import Assembly, solve

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
    """Return true if admissible joint forces balance the weights of an arch: half angle [rad], thickness over radius.

    By "highs-ds" (simplex), "highs-ipm" (interior points), or "highs", which chooses; rows may be violated by the
    tolerance.
    """
    angle, inner, outer, weight, centre = _blocks(half_angle, voussoirs, ratio)
    dead = np.zeros((voussoirs, 3))
    dead[:, 1] = -weight
    # joints lead from the block on their left to that on their right; beyond the springings nothing moves
    left = np.arange(-1, voussoirs)
    right = np.append(np.arange(voussoirs), -1)
    arch = Assembly(centre, dead, dead, np.stack([outer, inner], axis=1), np.column_stack([left, right]))
    return _stands(solve(arch, friction, method, tolerance))


def stands_by_compact(half_angle: float, voussoirs: int, ratio: float, friction: float) -> bool:
    """Return true if a thrust at some height of the crown leads through all joints of an even number of voussoirs."""
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
    return bool(result.status == _FEASIBLE)
