"""Small files of blocks for tests, and what a run of them tells."""

from __future__ import annotations

import math
from pathlib import Path

from dda_command import rows_of, run_dda

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


def on_slope(angle_deg: float, width: float = 1.0) -> str:
    """A block on a fixed slope that rises to the right."""
    base = turned([(-6.0, -3.0), (6.0, -3.0), (6.0, 0.0), (-6.0, 0.0)], angle_deg)
    return block(base, "fixed") + block(turned([(0.0, 0.0), (width, 0.0), (width, 1.0), (0.0, 1.0)], angle_deg))


def run_blocks(folder: Path, blocks: str, deck: str) -> dict[str, str]:
    """Run a file of blocks in the folder; its tables are in folder/out."""
    (folder / "scene.blocks").write_text(blocks)
    (folder / "scene.nml").write_text("&scene kind='blocks' geometry='scene.blocks' /\n" + deck)
    done = run_dda("run", "scene.nml", "--out", "out", "--quiet", cwd=folder)
    assert done.returncode in (0, 3), done.stderr
    return rows_of(folder / "out" / "results.csv")[0]


def bar_forces(folder: Path) -> list[float]:
    """Forces of the bars at the end of the run."""
    rows = rows_of(folder / "out" / "bars.csv")
    last = rows[-1]["time"]
    return [float(row["force"]) for row in rows if row["time"] == last]
