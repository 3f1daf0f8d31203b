"""Rings of the voussoirs of arches of any shape."""

from __future__ import annotations

import numpy as np


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
