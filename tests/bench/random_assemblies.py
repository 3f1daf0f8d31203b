"""Random assemblies of dry blocks: walls with openings, corbels, rings, piers, Voronoi cuts, slopes.

The same seed gives the same assemblies on every machine.
"""

from __future__ import annotations

import argparse
import math
import random
import sys

from assembly import Assembly, Joint, Polygon, area_and_centre, clip, find_joints

WIDE = 1e3


def box(x0: float, y0: float, x1: float, y1: float) -> Polygon:
    """A rectangle."""
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def ground_at(y: float) -> Polygon:
    """Ground below a level."""
    return box(-WIDE, y - 1.0, WIDE, y)


def wall(pick: random.Random) -> tuple[list[Polygon], list[Polygon]]:
    """A wall in a bond of random widths, with an opening under which nothing stands."""
    courses, units = pick.randint(2, 9), pick.randint(2, 7)
    height = pick.uniform(0.5, 1.0)
    opening = (pick.uniform(0.1, 0.6), pick.uniform(0.3, 0.9), pick.randint(0, courses - 1))
    blocks = []
    for course in range(courses):
        cuts = [0.0, *sorted(2.0 * (i + 0.5 * (course % 2) + pick.uniform(-0.2, 0.2)) for i in range(1, units)),
                2.0 * units]
        for a, b in zip(cuts, cuts[1:]):
            middle = 0.5 * (a + b) / cuts[-1]
            if pick.random() < 0.7 or not opening[0] < middle < opening[1] or course >= opening[2]:
                blocks.append(box(a, course * height, b, (course + 1) * height))
    return blocks, [ground_at(0.0)]


def corbel(pick: random.Random) -> tuple[list[Polygon], list[Polygon]]:
    """A stack that steps out, with a counterweight upon it."""
    blocks, x = [], 0.0
    courses = pick.randint(3, 12)
    for course in range(courses):
        width = pick.uniform(1.5, 3.0)
        blocks.append(box(x, course, x + width, course + 1.0))
        if pick.random() < 0.4:
            blocks.append(box(x - 1.5, course, x, course + 1.0))
        x += pick.uniform(-0.15, 0.3)
    return blocks, [ground_at(0.0)]


def ring(pick: random.Random) -> tuple[list[Polygon], list[Polygon]]:
    """An arch of one to three rings whose joints need not meet."""
    half = math.radians(pick.uniform(30.0, 100.0))
    radius, rings = 10.0, pick.randint(1, 3)
    thickness = pick.uniform(0.8, 2.5) / rings
    facets = pick.randint(6, 24)
    blocks: list[Polygon] = []
    ground: list[Polygon] = []
    angles = [half * (2.0 * i / facets - 1.0) for i in range(facets + 1)]
    for k in range(rings):
        inner, outer = radius + k * thickness, radius + (k + 1) * thickness
        # the facets of all rings meet; a voussoir of an inner ring may be cut once more
        corner = [[(r * math.sin(a), r * math.cos(a)) for a in angles] for r in (inner, outer)]
        for i in range(facets):
            blocks.append([corner[0][i + 1], corner[1][i + 1], corner[1][i], corner[0][i]])
        ground.append(_beyond(corner[0][0], corner[1][0], -1.0))
        ground.append(_beyond(corner[0][-1], corner[1][-1], 1.0))
    return blocks, ground


def _beyond(inner: tuple[float, float], outer: tuple[float, float], side: float) -> Polygon:
    """Ground at a springing."""
    dx, dy = outer[0] - inner[0], outer[1] - inner[1]
    far = [(inner[0] + side * dy, inner[1] - side * dx), (outer[0] + side * dy, outer[1] - side * dx)]
    corners = [inner, outer, far[1], far[0]]
    return corners if area_and_centre(corners)[0] > 0.0 else corners[::-1]


def piers(pick: random.Random) -> tuple[list[Polygon], list[Polygon]]:
    """Two or three piers of stacked blocks with lintels upon them."""
    blocks, x, width = [], 0.0, pick.uniform(0.6, 1.5)
    courses, span = pick.randint(1, 8), pick.uniform(1.5, 4.0)
    bays = pick.randint(1, 3)
    for _ in range(bays + 1):
        for course in range(courses):
            if pick.random() < 0.3:
                blocks += [box(x, course, x + 0.5 * width, course + 1.0),
                           box(x + 0.5 * width, course, x + width, course + 1.0)]
            else:
                blocks.append(box(x, course, x + width, course + 1.0))
        x += width + span
    for bay in range(bays):
        left = bay * (width + span) + 0.5 * width
        blocks.append(box(left, courses, left + width + span, courses + pick.uniform(0.5, 1.0)))
    return blocks, [ground_at(0.0)]


def voronoi(pick: random.Random) -> tuple[list[Polygon], list[Polygon]]:
    """A rectangle cut into the cells of random points."""
    width, height = pick.uniform(2.0, 8.0), pick.uniform(2.0, 6.0)
    points = [(pick.uniform(0.0, width), pick.uniform(0.0, height)) for _ in range(pick.randint(4, 60))]
    blocks = []
    for p in points:
        cell = box(0.0, 0.0, width, height)
        for q in points:
            if q != p and cell:
                cell = clip(cell, (0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])), (q[0] - p[0], q[1] - p[1]))
        if cell:
            blocks.append(cell)
    return blocks, [ground_at(0.0)]


def slope(pick: random.Random, size: int = 0) -> tuple[list[Polygon], list[Polygon]]:
    """A slope cut by two sets of joints; the second one is displaced from layer to layer."""
    size = size or pick.randint(3, 9)
    dip = math.radians(pick.uniform(5.0, 40.0))
    cross = math.radians(pick.uniform(60.0, 110.0)) + dip
    along, up = (math.cos(dip), -math.sin(dip)), (math.sin(dip), math.cos(dip))
    lean = (math.cos(cross - dip) / math.sin(cross - dip))
    face = size * pick.uniform(0.4, 0.9)
    blocks, ground = [], []
    for layer in range(-1, size):
        shift = pick.uniform(0.0, 1.0)
        for column in range(-2, size):
            corners = []
            for u, w in ((0, 0), (1, 0), (1, 1), (0, 1)):
                a, h = 1.6 * (column + shift + u) + lean * (layer + w), float(layer + w)
                corners.append((a * along[0] + h * up[0], a * along[1] + h * up[1]))
            x = sum(c[0] for c in corners) / 4.0
            if layer < 0 or column < 0:
                ground.append(corners)
            elif x < 1.6 * face + 0.3 * (size - layer):
                blocks.append(corners)
    return blocks, ground


FAMILIES = (wall, corbel, ring, piers, voronoi, slope)


def load(pick: random.Random, assembly: Assembly) -> None:
    """Weights, and something live: a push on all blocks, a tilted one, or a force on one block."""
    kind = pick.random()
    chosen = pick.randrange(len(assembly.blocks))
    angle = pick.uniform(-math.pi, math.pi)
    for number, block in enumerate(assembly.blocks):
        area, _ = area_and_centre(block)
        assembly.dead.append([0.0, -area, 0.0])
        if kind < 0.6:
            assembly.live.append([area, 0.0, 0.0])
        elif kind < 0.75:
            assembly.live.append([area * math.cos(angle), area * math.sin(angle), 0.0])
        else:
            force = [math.cos(angle), math.sin(angle), pick.uniform(-0.3, 0.3)]
            assembly.live.append(force if number == chosen else [0.0, 0.0, 0.0])


def give_friction(pick: random.Random, joints: list[Joint]) -> None:
    """One angle for all joints or one for each, between 0.2 and 89.9 degrees; some cannot slide."""
    common = pick.uniform(0.2, 89.9) if pick.random() < 0.5 else pick.uniform(20.0, 50.0)
    various, no_slip = pick.random() < 0.2, pick.random() < 0.1
    for joint in joints:
        angle = pick.uniform(0.2, 89.9) if various else common
        joint.friction = math.tan(math.radians(angle))
        if no_slip and pick.random() < 0.3:
            joint.kind = "no_slip"


def shape(seed: int) -> tuple[Assembly, list[Polygon], random.Random]:
    """Blocks and joints of a seed, its ground, and what picks the rest; the families take turns."""
    family = FAMILIES[seed % len(FAMILIES)]
    pick = random.Random(seed)
    while True:
        blocks, ground = family(pick)
        if 4 <= len(blocks) <= 100:
            break
    assembly = Assembly(f"{family.__name__}_{seed}", blocks, find_joints(blocks, ground))
    give_friction(pick, assembly.joints)
    return assembly, ground, pick


def make(seed: int) -> Assembly:
    """The assembly of a seed."""
    assembly, _, pick = shape(seed)
    load(pick, assembly)
    return assembly


def make_pushed(seed: int) -> tuple[Assembly, list[Polygon]]:
    """The assembly of a seed under weights and a push of all blocks, and its ground."""
    assembly, ground, _ = shape(seed)
    for block in assembly.blocks:
        area, _ = area_and_centre(block)
        assembly.dead.append([0.0, -area, 0.0])
        assembly.live.append([area, 0.0, 0.0])
    return assembly, ground


def main() -> None:
    """Write assemblies to the standard output."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seeds", type=int, nargs="+", help="first seed, and how many")
    first, count = (*parser.parse_args().seeds, 1)[:2]
    for seed in range(first, first + count):
        sys.stdout.write(make(seed).text())


if __name__ == "__main__":
    main()
