"""A slope cut by two sets of joints, as a geometry file for `dda cut` and `kind = 'lines'`.

The bedding runs through; the cross joints end at it and are displaced from layer to layer, so that block edges lie
along one another over parts of their length. With the defaults 1139 blocks and 3340 joints come out.
"""

from __future__ import annotations

import argparse
import math
import random

Point = tuple[float, float]

DEPTH = 2.0  #: Depth of the ground below and behind the slope [m]


def inside(polygon: list[Point], start: Point, way: Point) -> tuple[float, float] | None:
    """The part of a line, by its parameter, that lies in a convex polygon."""
    low, high = -1e9, 1e9
    for (ax, ay), (bx, by) in zip(polygon, polygon[1:] + polygon[:1]):
        nx, ny = by - ay, ax - bx
        rate, rest = nx * way[0] + ny * way[1], nx * (ax - start[0]) + ny * (ay - start[1])
        if abs(rate) < 1e-12:
            if rest < 0.0:
                return None
        elif rate > 0.0:
            high = min(high, rest / rate)
        else:
            low = max(low, rest / rate)
    return (low, high) if high - low > 1e-6 else None


def part_of(start: Point, way: Point, span: tuple[float, float]) -> tuple[Point, Point]:
    """Both ends of a part of a line."""
    (x, y), (u, v) = start, way
    return (x + span[0] * u, y + span[0] * v), (x + span[1] * u, y + span[1] * v)


def joints(polygon: list[Point], dip: float, cross: float, length: float,
           seed: int | None) -> list[tuple[Point, Point]]:
    """Lines of both sets: beds 1 m apart, and cross joints between them; a seed displaces the layers at random."""
    pick = random.Random(seed)
    bed = (math.cos(dip), math.sin(dip))
    upward = (-bed[1], bed[0])
    across = (math.cos(dip + cross), math.sin(dip + cross))
    heights = [x * upward[0] + y * upward[1] for x, y in polygon]
    lines = []
    for layer in range(math.floor(min(heights)) - 1, math.ceil(max(heights)) + 2):
        start = ((layer + 0.37) * upward[0], (layer + 0.37) * upward[1])
        span = inside(polygon, start, bed)
        if span:
            lines.append(part_of(start, bed, span))
        shift = 0.5 * (layer % 2) if seed is None else pick.random()
        for column in range(-200, 200):
            foot = part_of(start, bed, ((column + shift) * length, 0.0))[0]
            span = inside(polygon, foot, across)
            top = 1.0 / (across[0] * upward[0] + across[1] * upward[1])
            if span and min(top, span[1]) - max(0.0, span[0]) > 1e-6:
                lines.append(part_of(foot, across, (max(0.0, span[0]), min(top, span[1]))))
    return lines


def geometry(height: float, top: float, dip_deg: float, cross_deg: float, length: float, seed: int | None) -> str:
    """Text of the file: a face of 60 degrees, ground below and behind it that is held at four points."""
    run = height / math.tan(math.radians(60.0))
    wide = run + top
    slope = [(0.0, 0.0), (wide, 0.0), (wide, height), (run, height)]
    outline = [(-DEPTH, 0.0), (-DEPTH, -DEPTH), (wide + DEPTH, -DEPTH), (wide + DEPTH, height), (wide, height)]
    bounds = [*zip(outline, outline[1:]), (outline[0], slope[0]), *zip(slope, slope[1:] + slope[:1])]
    cut = joints(slope, math.radians(dip_deg), math.radians(cross_deg), length, seed)
    held = [(-0.7 * DEPTH, -0.7 * DEPTH), (wide + 0.7 * DEPTH, -0.7 * DEPTH),
            (wide + 0.7 * DEPTH, height - 0.3 * DEPTH), (0.5 * wide, -0.7 * DEPTH)]
    text = ["0.001", f"{len(bounds) + len(cut)} {len(bounds)}", "0", "0", f"{len(held)} 0 0 0"]
    text += [f"{a[0]:.10f} {a[1]:.10f} {b[0]:.10f} {b[1]:.10f} 1" for a, b in [*bounds, *cut]]
    text += [f"{x} {y} {x} {y}" for x, y in held]
    return "\n".join(text) + "\n"


def main() -> None:
    """Write the file to the standard output."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--height", type=float, default=36.0, help="of the slope [m] (36)")
    parser.add_argument("--top", type=float, default=34.0, help="width of its top [m] (34)")
    parser.add_argument("--dip", type=float, default=5.0, help="of the bedding out of the ground [deg] (5)")
    parser.add_argument("--cross", type=float, default=90.0, help="from the bedding to the cross joints [deg] (90)")
    parser.add_argument("--length", type=float, default=1.5, help="of the blocks along the bedding [m] (1.5)")
    parser.add_argument("--seed", type=int, help="of random displacements of the layers (every other one, by half)")
    given = parser.parse_args()
    print(geometry(given.height, given.top, given.dip, given.cross, given.length, given.seed), end="")


if __name__ == "__main__":
    main()
