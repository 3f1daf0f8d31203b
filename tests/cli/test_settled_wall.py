"""A wall at rest whose blocks move in time: once its forces are found, steps only look at them."""

from __future__ import annotations

import csv
from pathlib import Path

from block_scene import block
from dda_command import run_dda

COURSES, COLUMNS, LENGTH, HEIGHT = 10, 13, 0.25, 0.125


def wall() -> str:
    """Bricks in running bond on a fixed floor: more than 300 joints, all of one group."""
    text = block([(0.0, -HEIGHT), (COLUMNS * LENGTH, -HEIGHT), (COLUMNS * LENGTH, 0.0), (0.0, 0.0)], "fixed")
    for course in range(COURSES):
        heads = [column * LENGTH for column in range(COLUMNS + 1)]
        if course % 2:
            heads = [0.0, *(head + LENGTH / 2.0 for head in heads[:-1]), COLUMNS * LENGTH]
        low, high = course * HEIGHT, (course + 1) * HEIGHT
        for left, right in zip(heads, heads[1:]):
            text += block([(left, low), (right, low), (right, high), (left, high)])
    return text


def test_a_wall_at_rest_is_only_looked_at(tmp_path: Path) -> None:
    """After 40 steps nothing is left to be found: two passes a step, of motion and of speeds, and nothing moves."""
    (tmp_path / "x.blocks").write_text(wall() + f"measure {LENGTH!r} {0.9 * COURSES * HEIGHT!r}\n")
    passes = []
    for steps in (40, 80):
        (tmp_path / "x.nml").write_text(
            "&scene kind = 'blocks', geometry = 'x.blocks' /\n&joint friction_deg = 35 /\n"
            f"&analysis mode = 'dynamic', geometry = 'current', time_step = 1e-3, duration = 1e3, steps = {steps} /\n")
        done = run_dda("run", "x.nml", "--quiet", cwd=tmp_path)
        assert done.returncode in (0, 3), done.stderr
        with (tmp_path / "x" / "results.csv").open() as table:
            passes.append(int(next(csv.DictReader(table))["open_close_iterations"]))
    assert passes[1] - passes[0] <= 2 * 40
    with (tmp_path / "x" / "points.csv").open() as table:
        rows = list(csv.DictReader(table))
    assert abs(float(rows[-1]["v"]) - float(rows[len(rows) // 2]["v"])) < 1e-7 * COURSES * HEIGHT
