"""The joints between which a thrust line goes through a block: of arches, and of other blocks that form a chain."""

from __future__ import annotations

import numpy as np

from voussoir.plot.case_scene import CaseScene
from voussoir.results import Table

#: Fewest blocks of a chain
FEWEST = 3


def thrust_pairs(scene: CaseScene, joints: Table) -> list[tuple[int, int]]:
    """Pairs of rows of joints with a piece of the thrust line between them; none where blocks form no arch."""
    if scene.is_arch:
        return [(row, row + 1) for row in range(len(joints) - 1)]
    if scene.voussoirs:
        return ring_joints(joints["block_1"], joints["block_2"], scene.count, scene.voussoirs)
    free = {block.number for block in scene.blocks if block.state == "free"}
    return chain_pairs(joints["block_1"], joints["block_2"], free)


def ring_joints(first: np.ndarray, second: np.ndarray, count: int, voussoirs: int) -> list[tuple[int, int]]:
    """Pairs of joints between which thrust goes through a voussoir; these are numbered first, ring by ring."""
    sides: dict[int, list[int]] = {}
    for joint, pair in enumerate(zip(first, second)):
        inside = [int(block) for block in pair if block <= count]
        same_ring = len({(block - 1) // voussoirs for block in inside}) == 1
        if len(inside) == 1 or same_ring:
            for block in inside:
                sides.setdefault(block, []).append(joint)
    return [(pair[0], pair[1]) for pair in sides.values() if len(pair) == 2]


def chain_pairs(first: np.ndarray, second: np.ndarray, free: set[int]) -> list[tuple[int, int]]:
    """Pairs of joints on the two sides of the blocks of chains from support to support, as in an imported arch.

    Examples
    --------
    >>> chain_pairs(np.array([9, 1, 2, 3]), np.array([1, 2, 3, 9]), {1, 2, 3})
    [(0, 1), (1, 2), (2, 3)]
    """
    joints: dict[int, list[int]] = {}
    for row, pair in enumerate(zip(first.tolist(), second.tolist())):
        for block in pair:
            joints.setdefault(block, []).append(row)
    pairs: list[tuple[int, int]] = []
    seen: set[int] = set()
    for row, ends in enumerate(zip(first.tolist(), second.tolist())):
        if row in seen or len(free.intersection(ends)) != 1:
            continue
        chain, at, block = [row], row, next(end for end in ends if end in free)
        while block in free and len(joints[block]) == 2:
            at = joints[block][0] if joints[block][1] == at else joints[block][1]
            chain.append(at)
            block = int(second[at] if first[at] == block else first[at])
        if block not in free and len(chain) > FEWEST:
            pairs += zip(chain, chain[1:])
            seen.update(chain)
    return pairs
