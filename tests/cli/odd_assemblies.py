"""Small odd assemblies: a box split again and again with pieces missing, and blocks that stand on corners.

The same seed gives the same assembly. Live loads may cancel weights, joints may be smooth, limits may be nothing.
"""

from __future__ import annotations

import math
import random
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))
from assembly import Polygon, area_and_centre, clip  # noqa: E402

Shapes = tuple[list[Polygon], list[Polygon]]  #: Fixed polygons, polygons that can move
FLOOR = [(-9.0, -1.0), (9.0, -1.0), (9.0, 0.0), (-9.0, 0.0)]
UNIT_WEIGHT = 2e4


def box(left: float, bottom: float, right: float, top: float) -> Polygon:
    """A rectangle."""
    return [(left, bottom), (right, bottom), (right, top), (left, top)]


def is_block(polygon: Polygon) -> bool:
    """Whether a polygon is no sliver."""
    return len(polygon) > 2 and area_and_centre(polygon)[0] > 0.02 and all(
        math.dist(a, b) > 0.03 for a, b in zip(polygon, polygon[1:] + polygon[:1]))


def pieces(pick: random.Random) -> Shapes:
    """A box whose largest pieces are split, so that corners lie on edges; some pieces are gone, some fixed."""
    width, height = pick.uniform(1, 4), pick.uniform(0.6, 3)
    blocks = [box(0.0, 0.0, width, height)]
    wanted = pick.randint(2, 14)
    for _ in range(200):
        if len(blocks) >= wanted:
            break
        k = max(range(len(blocks)), key=lambda i: area_and_centre(blocks[i])[0] * pick.uniform(0.3, 1))
        area, (x, y) = area_and_centre(blocks[k])
        angle = pick.choice([0.0, math.pi / 2, pick.uniform(0, math.pi)])
        through = (x + 0.2 * pick.uniform(-1, 1) * math.sqrt(area), y + 0.2 * pick.uniform(-1, 1) * math.sqrt(area))
        normal = (math.cos(angle), math.sin(angle))
        halves = [clip(blocks[k], through, normal), clip(blocks[k], through, (-normal[0], -normal[1]))]
        if all(is_block(half) for half in halves):
            blocks[k:k + 1] = halves
    for _ in range(min(pick.choice([0, 0, 1, 2, 3]), len(blocks) - 1)):
        blocks.pop(pick.randrange(len(blocks)))
    fixed = [FLOOR]
    if pick.random() < 0.4:
        fixed.append(box(-2.0, 0.0, 0.0, height))
    if pick.random() < 0.3:
        fixed.append(box(width, 0.0, width + 2.0, height))
    for _ in range(pick.choice([0, 0, 0, 1, 2])):
        if len(blocks) > 2:
            fixed.append(blocks.pop(pick.randrange(len(blocks))))
    return fixed, blocks


def stool(pick: random.Random) -> Shapes:
    """A block on one to three pointed feet."""
    feet = sorted(pick.uniform(0, 2) for _ in range(pick.choice([1, 2, 2, 3])))
    seat = [(feet[0], 0.0)]
    for a, b in zip(feet, feet[1:]):
        seat += [((a + b) / 2, pick.uniform(0.1, 0.4)), (b, 0.0)]
    right, left = pick.uniform(feet[-1] + 0.1, feet[-1] + 0.8), pick.uniform(feet[0] - 0.6, feet[0] - 0.1)
    return [FLOOR], [[*seat, (right, 0.5), (right, 0.9), (left, 0.9), (left, 0.5)]]


def wedge(pick: random.Random) -> Shapes:
    """A wedge in a notch."""
    left, right, depth = pick.uniform(0.3, 1.2), pick.uniform(0.3, 1.2), pick.uniform(0.5, 1.5)
    bed = [[(-3.0, -1.0), (0.0, -1.0), (0.0, 0.0), (-depth, depth * math.tan(left)), (-3.0, depth * math.tan(left))],
           [(0.0, -1.0), (3.0, -1.0), (3.0, depth * math.tan(right)), (depth, depth * math.tan(right)), (0.0, 0.0)]]
    a, b = pick.uniform(0.2, 0.9) * depth, pick.uniform(0.2, 0.9) * depth
    top = max(b * math.tan(right), a * math.tan(left)) + pick.uniform(0.1, 0.6)
    return bed, [[(0.0, 0.0), (b, b * math.tan(right)), ((b - a) / 2, top), (-a, a * math.tan(left))]]


def ladder(pick: random.Random) -> Shapes:
    """A slab that leans against a wall."""
    length, slope, thick = pick.uniform(1, 3), pick.uniform(0.3, 1.3), pick.uniform(0.05, 0.3)
    x, y = length * math.cos(slope), length * math.sin(slope)
    up = (-thick * math.sin(slope), thick * math.cos(slope))
    return [FLOOR, box(x, 0.0, x + 2, 4.0)], [[(0.0, 0.0), (x, y), (x + up[0], y + up[1]), up]]


def beam(pick: random.Random) -> Shapes:
    """A beam on two tips, with a block on it or not."""
    tips, top = [pick.uniform(-0.5, 0.5), pick.uniform(1, 2)], pick.uniform(0.3, 1)
    fixed = [FLOOR, *([(x - 0.2, 0.0), (x + 0.2, 0.0), (x, top)] for x in tips)]
    left, right = pick.uniform(-1.5, tips[0] + 0.3), pick.uniform(tips[1] - 0.3, 3)
    blocks = [box(left, top, right, top + 0.3)]
    if pick.random() < 0.6:
        at = pick.uniform(left, right - 0.2)
        end = min(right + 0.3, at + pick.uniform(0.2, 0.9))
        blocks.append([(at, top + 0.3), (end, top + 0.3), (end, top + pick.uniform(0.5, 1.3)), (at, top + 0.5)])
    return fixed, blocks


def post(pick: random.Random) -> Shapes:
    """A regular polygon on the floor beside a wall or between two."""
    count, radius = pick.choice([3, 4, 5, 6]), pick.uniform(0.3, 0.6)
    turn = pick.choice([0.0, math.pi / count, pick.uniform(0, 1)])
    corners = [(radius * math.cos(turn + 2 * math.pi * i / count), radius * math.sin(turn + 2 * math.pi * i / count))
               for i in range(count)]
    low, left, right = (min(y for _, y in corners), min(x for x, _ in corners), max(x for x, _ in corners))
    fixed = [FLOOR, box(left - 2, 0.0, left, 2.0)]
    if pick.random() < 0.6:
        fixed.append(box(right, 0.0, right + 2, 2.0))
    return fixed, [[(x, y - low) for x, y in corners]]


def odd_assembly(seed: int) -> tuple[str, float]:
    """A file of blocks and its friction angle [deg]."""
    pick = random.Random(seed)
    kind = pieces if pick.random() < 0.6 else pick.choice([stool, wedge, ladder, beam, post])
    fixed, blocks = kind(pick)
    text = ""
    for head, polygons in (("block fixed", fixed), ("block", blocks)):
        for polygon in polygons:
            text += f"{head}\n" + "".join(f"{x!r} {y!r}\n" for x, y in polygon)
    force = pick.choice([(1, 0), (0.3, 0), (-1, 0), (0, -1), (0, 1), (1, -1), (0.3, 1), (-1, 0.5)])
    loaded = range(len(blocks)) if pick.random() < 0.6 else [len(blocks) // 2]
    for i in loaded:
        area, (x, y) = area_and_centre(blocks[i])
        fx, fy = (UNIT_WEIGHT * area * part for part in force)
        text += f"live block {len(fixed) + i + 1} {x!r} {y!r} {fx!r} {fy!r}\n"
    return text, pick.choice([0.0, 10.0, 25.0, 35.0, 50.0, 70.0, pick.uniform(0, 89)])
