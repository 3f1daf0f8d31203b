"""An arch as its joints know it: blocks, directions, and the motion that their openings make."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from voussoir.results import Table

#: A motion that misses the far springing by more than this share of itself is no mechanism's
CLOSES = 0.05


@dataclass(frozen=True)
class JointChain:
    """The joints of one case, from the left springing to the right one.

    Attributes
    ----------
    intrados, extrados : ndarray
        Ends of the joints: (n, 2) [m].
    outward : ndarray
        Unit vectors from intrados to extrados: (n, 2).
    along : ndarray
        Unit vectors across the joints, from the block before to the block behind: (n, 2).
    """

    intrados: np.ndarray
    extrados: np.ndarray
    outward: np.ndarray
    along: np.ndarray


def chain_of(joints: Table) -> JointChain:
    """The chain of one case.

    Parameters
    ----------
    joints : Table
        Its rows of joints.csv.

    Returns
    -------
    JointChain
        The chain.
    """
    intrados = np.column_stack((joints["x_intrados"], joints["y_intrados"]))
    extrados = np.column_stack((joints["x_extrados"], joints["y_extrados"]))
    outward = (extrados - intrados) / np.linalg.norm(extrados - intrados, axis=1)[:, None]
    return JointChain(intrados, extrados, outward, outward @ np.array([[0.0, -1.0], [1.0, 0.0]]))


def outlines(chain: JointChain, facet_deg: float | None) -> list[np.ndarray]:
    """Corners of the blocks between the joints.

    Parameters
    ----------
    chain : JointChain
        The joints.
    facet_deg : float or None
        Largest angle of a chord of a block's sides [deg]; None for one chord a block.

    Returns
    -------
    list of ndarray
        A block each, (m, 2) [m]: the intrados from left to right, the extrados back.
    """
    angle = np.arctan2(chain.outward[:, 0], chain.outward[:, 1])
    blocks = []
    for k in range(len(angle) - 1):
        span = math.degrees(angle[k + 1] - angle[k])
        chords = math.ceil(span / facet_deg - 1e-9) if facet_deg else 1
        turn = np.linspace(angle[k], angle[k + 1], chords + 1)
        rays = np.column_stack((np.sin(turn), np.cos(turn)))
        inner = rays * np.linalg.norm(chain.intrados[k])
        outer = rays * np.linalg.norm(chain.extrados[k])
        inner[[0, -1]], outer[[0, -1]] = chain.intrados[[k, k + 1]], chain.extrados[[k, k + 1]]
        blocks.append(np.vstack((inner, outer[::-1])))
    return blocks


def thrust_points(chain: JointChain, joints: Table) -> np.ndarray:
    """Where the line of thrust passes the joints.

    Parameters
    ----------
    chain : JointChain
        The joints.
    joints : Table
        Their rows.

    Returns
    -------
    ndarray
        Points, (n, 2) [m]; NaN where a joint carries nothing.
    """
    share = 0.5 * (1.0 - joints["eccentricity_ratio"])[:, None]
    return chain.intrados + share * (chain.extrados - chain.intrados)


def forces(chain: JointChain, joints: Table) -> np.ndarray:
    """Force of each joint on the block behind it.

    Parameters
    ----------
    chain : JointChain
        The joints.
    joints : Table
        Their rows.

    Returns
    -------
    ndarray
        Vectors, (n, 2) [N/m].
    """
    normal, shear = joints["normal_force"][:, None], joints["shear_force"][:, None]
    return normal * chain.along + shear * chain.outward


def displaced(
    chain: JointChain, joints: Table, blocks: list[np.ndarray]
) -> list[np.ndarray] | None:
    """Displacements of the blocks' corners that the openings and slips of the joints make.

    The left springing rests; behind each joint the blocks move by what it opens and slips, rigidly.

    Parameters
    ----------
    chain : JointChain
        The joints.
    joints : Table
        Their rows.
    blocks : list of ndarray
        Corners of the blocks.

    Returns
    -------
    list of ndarray or None
        Displacement of each corner [m]; None where the far springing would not rest as well, that
        is where the blocks' own deformation counts beside the joints'.
    """
    openings = joints["opening_intrados"], joints["opening_extrados"]
    depth = np.linalg.norm(chain.extrados - chain.intrados, axis=1)
    spin = (openings[0] - openings[1]) / depth
    jump = openings[0][:, None] * chain.along + joints["slip"][:, None] * chain.outward
    # a turn by w about p moves x by w (ez x (x - p)): kept as w and the motion of the origin
    turned = np.column_stack((chain.intrados[:, 1], -chain.intrados[:, 0])) * spin[:, None]
    total_spin, total = np.cumsum(spin), np.cumsum(jump + turned, axis=0)

    def motion(points: np.ndarray, k: int) -> np.ndarray:
        return total[k] + total_spin[k] * np.column_stack((-points[:, 1], points[:, 0]))

    moved = [motion(block, k) for k, block in enumerate(blocks)]
    largest = max(np.abs(part).max() for part in moved)
    ends = np.vstack((chain.intrados[-1], chain.extrados[-1]))
    if not largest > 0.0 or np.abs(motion(ends, -1)).max() > CLOSES * largest:
        return None
    return moved
