"""Files of blocks of arches in spans and in rings, loaded on a voussoir: the shapes of tests/data/practice_*.csv."""

from __future__ import annotations

import math
from collections.abc import Iterable

Point = tuple[float, float]
ABUTMENT = 0.3  #: Depth of the fixed blocks behind springings


def polygon(corners: Iterable[Point], head: str = "block") -> str:
    """A block of a file."""
    return head + "\n" + "".join(f"{x!r} {y!r}\n" for x, y in corners)


def area(corners: list[Point]) -> float:
    """Area of a polygon."""
    turned = corners[1:] + corners[:1]
    return abs(sum(x * v - y * u for (x, y), (u, v) in zip(corners, turned))) / 2.0


def place(radius: float, angle: float, shift: float = 0.0) -> Point:
    """A point of a circle, by its angle from the crown."""
    return radius * math.sin(angle) + shift, radius * math.cos(angle)


def voussoirs(radii: list[float], embrace_deg: float, count: int, shift: float = 0.0) -> list[list[Point]]:
    """Rings of voussoirs between radii, from the inner one on, each from the left."""
    half = math.radians(embrace_deg / 2.0)
    angle = [-half + 2.0 * half * k / count for k in range(count + 1)]
    return [[place(r, a, shift), place(r, b, shift), place(s, b, shift), place(s, a, shift)]
            for r, s in zip(radii, radii[1:]) for a, b in zip(angle, angle[1:])]


def abutment(inner: float, outer: float, angle: float, shift: float = 0.0) -> str:
    """A fixed block behind a springing."""
    back = (math.copysign(ABUTMENT * math.cos(angle), angle), -ABUTMENT * abs(math.sin(angle)))
    first, second = place(inner, angle, shift), place(outer, angle, shift)
    far = [(x + back[0], y + back[1]) for x, y in (second, first)]
    return polygon([first, second, *far], "block fixed")


def pier(left: list[Point], right: list[Point], height: float) -> str:
    """A pier between two springings, from intrados to extrados each, and the ground below it."""
    foot = left[0][1] - height
    base = [(left[0][0], foot), (right[0][0], foot)]
    ground = [(base[0][0] - 0.1, foot - 0.5), (base[1][0] + 0.1, foot - 0.5), (base[1][0] + 0.1, foot),
              (base[0][0] - 0.1, foot)]
    return polygon([*base, right[0], right[1], left[1], left[0]]) + polygon(ground, "block fixed")


def spans(row: dict[str, str]) -> str:
    """Spans on piers; one load of the weight of an arch in the middle of an extrados chord of the first."""
    thickness, half = float(row["thickness_ratio"]), math.radians(float(row["embrace_deg"]) / 2.0)
    inner, outer, n = 1.0 - thickness / 2.0, 1.0 + thickness / 2.0, int(row["spans"])
    step = 2.0 * inner * math.sin(half) + float(row["pier_width_over_R"])
    rings = [voussoirs([inner, outer], float(row["embrace_deg"]), int(row["voussoirs"]), s * step) for s in range(n)]
    text = "".join(polygon(block) for ring in rings for block in ring)
    for s in range(n - 1):
        ends = [[place(inner, a, x), place(outer, a, x)] for a, x in ((half, s * step), (-half, (s + 1) * step))]
        text += pier(*ends, float(row["pier_height_over_R"]))
    text += abutment(inner, outer, -half) + abutment(inner, outer, half, (n - 1) * step)
    block = int(row["loaded_voussoir_of_span_1"])
    (ax, ay), (bx, by) = rings[0][block][2:]
    weight = sum(area(voussoir) for voussoir in rings[0])
    return text + f"live block {block + 1} {(ax + bx) / 2.0!r} {(ay + by) / 2.0!r} 0 {-weight!r}\n"


def rings(row: dict[str, str]) -> str:
    """An arch of rings; one load of its weight on a voussoir of the outermost."""
    thickness, n, count = float(row["thickness_ratio"]), int(row["rings"]), int(row["voussoirs_a_ring"])
    radii = [1.0 - thickness / 2.0 + thickness * k / n for k in range(n + 1)]
    blocks = voussoirs(radii, float(row["embrace_deg"]), count)
    half = math.radians(float(row["embrace_deg"]) / 2.0)
    text = "".join(polygon(block) for block in blocks)
    text += abutment(radii[0], radii[-1], -half) + abutment(radii[0], radii[-1], half)
    number = (n - 1) * count + int(row["load_on_voussoir"]) + 1
    weight = sum(area(block) for block in blocks)
    return text + f"live block {number} {row['load_x_over_R']} {row['load_y_over_R']} 0 {-weight!r}\n"
