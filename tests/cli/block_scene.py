"""Small files of blocks for tests, and what a run of them tells."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

from dda_command import rows_of, run_deck

Point = tuple[float, float]


def turned(points: list[Point], angle_deg: float) -> list[Point]:
    """Turn points about the origin."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return [(c * x - s * y, s * x + c * y) for x, y in points]


def block(points: list[Point], words: str = "") -> str:
    """A block of a file of blocks."""
    return f"block {words}\n" + "".join(f"{x!r} {y!r}\n" for x, y in points)


def bar(start: Point, end: Point, words: str) -> str:
    """A bar of a file of blocks."""
    return f"bar {start[0]!r} {start[1]!r} {end[0]!r} {end[1]!r} {words}\n"


def box(x: float, y: float, width: float, height: float, words: str = "") -> str:
    """A rectangle of a file of blocks, by its lower left corner."""
    return block([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], words)


def wall(courses: int, bricks: int, length: float, height: float, beyond: float = 0.0) -> str:
    """Bricks in running bond, half ones at the ends of every other course, on a fixed floor that goes beyond them."""
    end = bricks * length
    text = box(0.0 - beyond, -height, end + 2.0 * beyond, height, "fixed")
    for course in range(courses):
        heads = [0.0, *((brick + 0.5 * (course % 2)) * length for brick in range(1 - course % 2, bricks)), end]
        text += "".join(box(left, course * height, right - left, height) for left, right in zip(heads, heads[1:]))
    return text


def on_slope(angle_deg: float, width: float = 1.0) -> str:
    """A block on a fixed slope that rises to the right."""
    base = turned([(-6.0, -3.0), (6.0, -3.0), (6.0, 0.0), (-6.0, 0.0)], angle_deg)
    return block(base, "fixed") + block(turned([(0.0, 0.0), (width, 0.0), (width, 1.0), (0.0, 1.0)], angle_deg))


def run_scene(folder: Path, blocks: str, groups: str, *options: str, accepted: tuple[int, ...] = (0,)) -> Path:
    """Run a file of blocks in the folder: the folder of its tables."""
    (folder / "x.blocks").write_text(blocks)
    deck = f"&scene kind = 'blocks', geometry = 'x.blocks' /\n{groups}\n"
    run_deck(folder, deck, "--out", "out", "--quiet", *options, accepted=accepted)
    return folder / "out"


def run_blocks(folder: Path, blocks: str, groups: str) -> dict[str, str]:
    """The row of results of a file of blocks, which may be undecided."""
    return rows_of(run_scene(folder, blocks, groups, accepted=(0, 3)) / "results.csv")[0]


def bar_forces(folder: Path) -> list[float]:
    """Forces of the bars at the end of the run."""
    rows = rows_of(folder / "out" / "bars.csv")
    last = rows[-1]["time"]
    return [float(row["force"]) for row in rows if row["time"] == last]


def depth_of(first: list[Point], second: list[Point]) -> float:
    """How far two convex polygons have entered one another, along the face that parts them soonest; 0 if they have not.

    Separating axes: no face of either has all corners of the other in front of it.
    """
    depth = math.inf
    for polygon in (first, second):
        for (x, y), (u, v) in zip(polygon, polygon[1:] + polygon[:1]):
            size = math.hypot(u - x, v - y)
            one, other = ([((v - y) * (a - x) - (u - x) * (b - y)) / size for a, b in corners]
                          for corners in (first, second))
            depth = min(depth, max(one) - min(other), max(other) - min(one))
    return max(0.0, depth)


def deepest_entry(folder: Path) -> float:
    """Deepest entry of two convex blocks over the root of the smaller area, of all frames of a run."""
    frames: dict[str, dict[str, list[Point]]] = {}
    for row in rows_of(folder / "frames.csv"):
        frames.setdefault(row["frame"], {}).setdefault(row["block"], []).append((float(row["x"]), float(row["y"])))
    deepest = 0.0
    for frame in frames.values():
        blocks = sorted(frame.values(), key=lambda corners: min(x for x, _ in corners))
        reach = [max(x for x, _ in corners) for corners in blocks]
        size = [math.sqrt(abs(sum(x * v - u * y for (x, y), (u, v) in zip(c, c[1:] + c[:1]))) / 2.0) for c in blocks]
        for i, first in enumerate(blocks):
            later = itertools.takewhile(lambda k: min(x for x, _ in blocks[k]) < reach[i], range(i + 1, len(blocks)))
            deepest = max([deepest, *(depth_of(first, blocks[k]) / min(size[i], size[k]) for k in later)])
    return deepest
