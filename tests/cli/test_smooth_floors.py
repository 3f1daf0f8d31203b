"""Sliders on floors of many blocks: an internal edge is no obstacle, at no friction, speed, shape or step."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import block, rows_of, run_blocks


@pytest.mark.parametrize("height, passes", [(0.9e-4, True), (-0.9e-4, True), (2e-3, False)])
def test_a_step_is_an_obstacle_beyond_the_contact_tolerance(tmp_path: Path, height: float, passes: bool) -> None:
    """Of blocks of 1 m; a wall of 2 mm stops the slider's foot."""
    text = "".join(block([(a, -3.0), (b, -3.0), (b, y), (a, y)], "fixed")
                   for a, b, y in [(-3.0, 0.0, 0.0), (0.0, 3.0, height)])
    text += block([(-1.6, 0.0), (-0.6, 0.0), (-0.6, 1.0), (-1.6, 1.0)], "velocity 2 0 0") + "measure -1.1 0.5\n"
    run_blocks(tmp_path, text, "&joint friction_deg = 0 /\n&analysis mode = 'dynamic', geometry = 'current', "
               "time_step = 0.005, duration = 0.5, unknowns = 3, steps = 20000 /\n")
    speed = float(rows_of(tmp_path / "out" / "points.csv")[-1]["vx"])
    assert (abs(speed - 2.0) < 1e-3) if passes else speed < 1.5
