"""Rigid blocks as convex polygons, and the joints where their edges lie along one another."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

Point = tuple[float, float]
Polygon = list[Point]

NEGLIGIBLE = 1e-9  #: Lengths below this share of an edge are none
#: Names of joint kinds in the order of the Fortran program's numbers
KINDS = ("contact", "no_slip", "corner", "corner_no_slip", "pin", "mirror")
MOST_FRICTION_DEG = 89.9  #: Friction above this counts as this in a file of blocks


def area_and_centre(polygon: Polygon) -> tuple[float, Point]:
    """Area and centre of gravity of a polygon that runs counter-clockwise."""
    twice, x, y = 0.0, 0.0, 0.0
    x0, y0 = polygon[0]
    for (ax, ay), (bx, by) in zip(polygon[1:-1], polygon[2:]):
        cross = (ax - x0) * (by - y0) - (bx - x0) * (ay - y0)
        twice += cross
        x += cross * (x0 + ax + bx) / 3.0
        y += cross * (y0 + ay + by) / 3.0
    return 0.5 * twice, (x / twice, y / twice)


def clip(polygon: Polygon, point: Point, normal: Point) -> Polygon:
    """The part of a convex polygon on that side of a line to which its normal does not point."""
    heights = [(x - point[0]) * normal[0] + (y - point[1]) * normal[1] for x, y in polygon]
    size = max(map(abs, heights), default=0.0)
    heights = [0.0 if abs(h) < NEGLIGIBLE * size else h for h in heights]
    kept: Polygon = []
    for i, (a, ha) in enumerate(zip(polygon, heights)):
        b, hb = polygon[(i + 1) % len(polygon)], heights[(i + 1) % len(polygon)]
        if ha <= 0.0:
            kept.append(a)
        if ha * hb < 0.0:
            share = ha / (ha - hb)
            kept.append((a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])))
    return kept if len(kept) > 2 else []


@dataclass
class Joint:
    """Two corners, from the first to the second; the normal to the right of this way points from the first block
    to the second; 0 is the ground."""

    blocks: tuple[int, int]
    start: Point
    finish: Point
    kind: str = "contact"
    friction: float = 0.5


@dataclass
class Assembly:
    """Blocks that can move, their joints and loads."""

    name: str
    blocks: list[Polygon]
    joints: list[Joint]
    dead: list[list[float]] = field(default_factory=list)
    live: list[list[float]] = field(default_factory=list)

    def centres(self) -> list[Point]:
        """Centres of gravity of the blocks."""
        return [area_and_centre(block)[1] for block in self.blocks]

    def rows(self) -> Iterator[tuple[Joint, float, list[list[list[float]]]]]:
        """Each joint with its length and its rows: openings and slip by the motion of both blocks."""
        centres = self.centres()
        for joint in self.joints:
            (ax, ay), (bx, by) = joint.start, joint.finish
            length = math.hypot(bx - ax, by - ay)
            tx, ty = (bx - ax) / length, (by - ay) / length
            places = [(ax, ay, ty, -tx), (bx, by, ty, -tx), (0.5 * (ax + bx), 0.5 * (ay + by), tx, ty)]
            sides = []
            for block, sign in zip(joint.blocks, (-1.0, 1.0)):
                if block == 0:
                    sides.append([[0.0, 0.0, 0.0]] * 3)
                    continue
                cx, cy = centres[block - 1]
                sides.append([[sign * nx, sign * ny, sign * ((x - cx) * ny - (y - cy) * nx)]
                              for x, y, nx, ny in places])
            yield joint, length, sides

    def text(self) -> str:
        """The joint graph as numbers: what tests/bench/limit_of_graphs.f90 reads."""
        lines = [f"{len(self.blocks)} {len(self.joints)} {self.name}"]
        for dead, live in zip(self.dead, self.live):
            lines.append(" ".join(repr(number) for number in (*dead, *live)))
        for joint, length, sides in self.rows():
            numbers = [number for side in sides for row in side for number in row]
            lines.append(f"{joint.blocks[0]} {joint.blocks[1]} {KINDS.index(joint.kind) + 1} "
                         + " ".join(repr(number) for number in (joint.friction, length, *numbers)))
        return "\n".join(lines) + "\n"


def find_joints(blocks: list[Polygon], ground: list[Polygon]) -> list[Joint]:
    """Joints wherever an edge of one block lies along an edge of another one or of the ground."""
    edges = []
    for number, polygon in [*enumerate(blocks, start=1), *((0, polygon) for polygon in ground)]:
        for a, b in zip(polygon, polygon[1:] + polygon[:1]):
            edges.append((number, a, b))
    joints = []
    for i, (first, a, b) in enumerate(edges):
        for second, c, d in edges[i + 1:]:
            if first == second:
                continue
            shared = _shared(a, b, c, d)
            if shared:
                joints.append(Joint((first, second), *shared) if first else Joint((second, first), *shared[::-1]))
    for joint in joints:
        if joint.blocks[1] == 0:
            joint.blocks = joint.blocks[::-1]
            joint.start, joint.finish = joint.finish, joint.start
    return joints


def _shared(a: Point, b: Point, c: Point, d: Point) -> tuple[Point, Point] | None:
    """The part that two edges of opposite direction share, from the start of the first to its end."""
    ex, ey = b[0] - a[0], b[1] - a[1]
    length = math.hypot(ex, ey)
    ex, ey = ex / length, ey / length
    tiny = 100.0 * NEGLIGIBLE * length
    along = []
    for x, y in (c, d):
        if abs((x - a[0]) * ey - (y - a[1]) * ex) > tiny:
            return None
        along.append((x - a[0]) * ex + (y - a[1]) * ey)
    if along[0] <= along[1]:
        return None
    low, high = max(0.0, along[1]), min(length, along[0])
    if high - low <= 10.0 * tiny:
        return None
    return (a[0] + low * ex, a[1] + low * ey), (a[0] + high * ex, a[1] + high * ey)


def block_text(assembly: Assembly, ground: list[list[tuple[float, float]]]) -> str:
    """The assembly as a file of blocks; each block has a material, each pair of them a law."""
    lines = []
    for polygon in ground:
        lines += ["block fixed", *(f"{x!r} {y!r}" for x, y in polygon)]
    for number, polygon in enumerate(assembly.blocks, start=2):
        lines += [f"block material {number}", *(f"{x!r} {y!r}" for x, y in polygon)]
    lines += [f"material {number + 2} density 1000" for number in range(len(assembly.blocks))]
    laws = {tuple(sorted(number + 1 for number in joint.blocks)): joint for joint in assembly.joints}
    for joint in assembly.joints:
        law = laws[tuple(sorted(number + 1 for number in joint.blocks))]
        most = math.tan(math.radians(MOST_FRICTION_DEG))
        joint.friction = min(most, math.inf if law.kind == "no_slip" else law.friction)
    for joint in assembly.joints:
        joint.kind = "contact"
    for (one, other), joint in laws.items():
        lines.append(f"joint {one} {other} friction_deg {math.degrees(math.atan(joint.friction))!r}")
    return "\n".join(lines) + "\n"
