"""Points that are led where friction allows no motion: the run ends with a reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import block, rows_of, run_blocks


@pytest.mark.parametrize("friction, height, unknowns, jams", [
    (40.0, 0.45, 3, True), (40.0, 0.45, 6, True), (60.0, 0.45, 6, True),
    (40.0, 0.40, 3, False), (40.0, 0.40, 6, False)])
def test_a_led_block_that_jams_ends_with_a_reason(
    tmp_path: Path, friction: float, height: float, unknowns: int, jams: bool
) -> None:
    """Led at a height of which friction times it exceeds half the width, 0.35 m, a block turns into its floor."""
    blocks = (block([(-50.0, -1.0), (50.0, -1.0), (50.0, 0.0), (-50.0, 0.0)], "fixed")
              + block([(0.0, 0.0), (0.7, 0.0), (0.7, 0.9), (0.0, 0.9)])
              + f"displacement block 2 0.35 {height!r}\n0 0 0\n0.5 0.14 0\n")
    row = run_blocks(tmp_path, blocks, f"&joint friction_deg = {friction!r} /\n&analysis mode = 'dynamic', "
                     "geometry = 'current', steps = 1000000, time_step = 0.002, duration = 0.05, "
                     f"unknowns = {unknowns} /\n")
    assert row["verdict"] == ("undecided" if jams else "completed")
    if jams:
        assert "contacts lock against a prescribed displacement" in (tmp_path / "out" / "log.txt").read_text()


def test_a_block_that_is_led_into_a_wall_jams_there(tmp_path: Path) -> None:
    """It has gone 0.05 m, to the wall, at 0.28 m/s."""
    blocks = (block([(-5.0, -1.0), (5.0, -1.0), (5.0, 0.0), (-5.0, 0.0)], "fixed")
              + block([(0.75, 0.0), (2.0, 0.0), (2.0, 2.0), (0.75, 2.0)], "fixed")
              + block([(0.0, 0.0), (0.7, 0.0), (0.7, 0.9), (0.0, 0.9)])
              + "displacement block 3 0.35 0.45\n0 0 0\n0.5 0.14 0\nmeasure 0.35 0.45\n")
    row = run_blocks(tmp_path, blocks, "&joint friction_deg = 10 /\n&analysis mode = 'dynamic', geometry = 'current', "
                     "steps = 100000, time_step = 0.01, duration = 0.5, unknowns = 3 /\n")
    assert row["verdict"] == "undecided"
    assert "contacts lock against a prescribed displacement" in (tmp_path / "out" / "log.txt").read_text()
    last = rows_of(tmp_path / "out" / "points.csv")[-1]
    assert float(last["u"]) == pytest.approx(0.05, abs=1e-8)
    assert float(last["time"]) == pytest.approx(0.05 / 0.28, abs=1e-7)
