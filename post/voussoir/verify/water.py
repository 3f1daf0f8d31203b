"""Water below a line of heads, as forces on the edges of blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from voussoir.verify.contacts import Block
from voussoir.verify.fill import is_covered

#: Corners of other blocks nearer to an edge than this share of its length lie on it
ON_EDGE = 1e-8


@dataclass
class Water:
    """A line of heads, how far it has risen, the weight of the water, and its share in joints."""

    line: list[tuple[float, float]]
    rise: float
    unit_weight: float
    factor: float


def water_loads(water: Water, rise: float, blocks: list[Block]) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """Forces of the water, all lines risen, on the blocks that move: the block, where the force acts, and the force."""
    found = []
    for block in blocks:
        for start, end in zip(block.corners, np.roll(block.corners, -1, axis=0)):
            if block.fixed:
                continue
            shares = _shares(blocks, block, start, end)
            for low, high in zip(shares, shares[1:]):
                first, last = start + low * (end - start), start + high * (end - start)
                factor = water.factor if is_covered(blocks, block, first, last) else 1
                for place, force in _on_part(water, rise, first, last):
                    found.append((block.number, place, factor * force))
    return found


def _shares(blocks: list[Block], block: Block, start: np.ndarray, end: np.ndarray) -> list[float]:
    """Places of the corners of other blocks along an edge."""
    along, found = end - start, [0, 1]
    square = along @ along
    for other in blocks:
        if other is block:
            continue
        away = other.corners - start
        share = (away @ along) / square
        off = np.abs(along[0] * away[:, 1] - along[1] * away[:, 0]) / square
        found += [s for s, d in zip(share, off) if ON_EDGE < s < 1 - ON_EDGE and d <= ON_EDGE]
    return sorted(set(found))


def _on_part(water: Water, rise: float, start: np.ndarray, end: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Forces on a part of an edge, the block on its left: one for each leg of the line of heads above it."""
    inward = np.array([start[1] - end[1], end[0] - start[0]])
    line, size, found = water.line, abs(water.line[-1][0] - water.line[0][0]), []
    for number, ((left, head), (right, other)) in enumerate(zip(line, line[1:])):
        way = end[0] - start[0]
        if abs(way) > 1e-12 * size:
            bounds = sorted(((left - start[0]) / way, (right - start[0]) / way))
            low, high = max(0, bounds[0]), min(1, bounds[1])
        else:
            # an upright edge at a corner of the line belongs to the leg on its left
            near = 1e-12 * size
            above = left < start[0] <= right or number == 0 and abs(start[0] - left) < near
            above = above or number == len(line) - 2 and abs(start[0] - right) < near
            low, high = (0, 1) if above else (1, 0)
        if not low < high:
            continue
        depths = []
        for share in (low, high):
            x, y = start + share * (end - start)
            depths.append(head + (x - left) * (other - head) / (right - left) + water.rise + rise - y)
        if max(depths) <= 0:
            continue
        if min(depths) < 0:
            dry = low + (high - low) * depths[0] / (depths[0] - depths[1])
            low, high = (dry, high) if depths[0] < 0 else (low, dry)
            depths = [max(0, depth) for depth in depths]
        force = water.unit_weight * (high - low) * (depths[0] + depths[1]) / 2 * inward
        middle = (depths[0] + 2 * depths[1]) / (3 * (depths[0] + depths[1]))
        found.append((start + (low + middle * (high - low)) * (end - start), force))
    return found
