"""Blocks that walls or notches confine stand, however stiff the springs that carry them at the walls."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import box, run_blocks


def between_walls(width: float, height: float) -> str:
    """A floor and two walls."""
    return (box(-5.0, -1.0, width + 10.0, 1.0, "fixed") + box(-2.0, 0.0, 2.0, height, "fixed")
            + box(width, 0.0, 2.0, height, "fixed"))


@pytest.mark.parametrize("unknowns", [3, 6])
def test_block_keeps_its_floor_however_deep_it_sinks_into_soft_springs(tmp_path: Path, unknowns: int) -> None:
    # deeper than the search for contacts reaches beyond a block that hardly moves
    row = run_blocks(tmp_path, between_walls(0.15, 3.5) + box(0.0, 0.0, 0.15, 3.0), (
        "&material density = 2420, young = 1e7 /\n&joint friction_deg = 14 /\n"
        f"&analysis geometry = 'current', penalty_ratio = 1, unknowns = {unknowns} /\n"))
    assert row["verdict"] == "stable"


@pytest.mark.parametrize("penalty", [1.0, 1e3, 1e6])
@pytest.mark.parametrize("unknowns", [3, 6])
def test_block_without_its_floor_falls_between_smooth_walls(tmp_path: Path, penalty: float, unknowns: int) -> None:
    walls = box(-2.0, 0.0, 2.0, 6.0, "fixed") + box(1.9, 0.0, 2.0, 6.0, "fixed")
    row = run_blocks(tmp_path, walls + box(0.0, 1.0, 1.9, 3.7), (
        "&joint friction_deg = 0 /\n"
        f"&analysis geometry = 'current', penalty_ratio = {penalty}, unknowns = {unknowns} /\n"))
    assert row["verdict"] == "collapsed"
