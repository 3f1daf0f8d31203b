"""Work-precision of blocks that move in time: the points as CSV, and a table."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from voussoir.bench.work_precision_motion import MotionPoint, order

#: Errors that the table tells the cost of
GOALS = (1e-2, 1e-3, 1e-4, 1e-6)


def write_motion_csv(points: Sequence[MotionPoint], file: Path) -> None:
    """Write all points."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["scene", "step", "error", "seconds", "steps"])
        writer.writerows(
            [point.scene, repr(point.step), repr(point.error), repr(point.seconds), point.steps] for point in points
        )


def motion_table(points: Sequence[MotionPoint]) -> list[str]:
    """Markdown lines: order of convergence, and the longest step that reaches each accuracy."""
    lines = [
        "| scene | order | largest error | least error " + "".join(f"| error <= {goal:.0e} " for goal in GOALS) + "|",
        "| --- | ---: | ---: | ---: " + "| --- " * len(GOALS) + "|",
    ]
    for scene, own in _by_scene(points).items():
        slope = order(own)
        told = "rounding at any step" if slope is None else f"{slope:.1f}"
        errors = [point.error for point in own]
        cells = [_cheapest(own, goal) for goal in GOALS]
        lines.append(f"| {scene} | {told} | {max(errors):.1e} | {min(errors):.1e} | " + " | ".join(cells) + " |")
    return lines


def _by_scene(points: Sequence[MotionPoint]) -> dict[str, list[MotionPoint]]:
    """The points of each scene."""
    scenes: dict[str, list[MotionPoint]] = {}
    for point in points:
        scenes.setdefault(point.scene, []).append(point)
    return scenes


def _cheapest(points: Sequence[MotionPoint], goal: float) -> str:
    """The longest step that reaches an accuracy, and its time."""
    reached = [point for point in points if point.error <= goal]
    if not reached:
        return "none"
    best = max(reached, key=lambda point: point.step)
    return f"{best.step * 1e3:g} ms: {best.seconds * 1e3:.1f} ms"
