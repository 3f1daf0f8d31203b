"""A tiny block beside a large one, where blocks move: right or undecided, never what rounded corners make of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import block, run_blocks

Case = tuple[float, float, int, str]

#: How far the top leans over the width of the foot, horizontal coefficient, friction [deg], verdict
CASES = [
    (0.0, 0.0, 50, "stable"),
    (1.3, 0.0, 50, "collapsed"),
    (0.0, 0.4, 50, "stable"),
    (0.0, 0.55, 50, "collapsed"),
    (0.0, 0.2, 15, "stable"),
    (0.0, 0.3, 15, "collapsed"),
]


def run(folder: Path, below: str, ground: float, size: float, case: Case) -> tuple[str, str]:
    """Verdict and remark of a block twice as high as wide."""
    lean, push, friction, _ = case
    corners = [(0.0, ground), (size, ground), (size * (1 + lean), ground + 2 * size), (size * lean, ground + 2 * size)]
    row = run_blocks(folder, below + block(corners), "&analysis geometry = 'current' /\n"
                     f"&joint friction_deg = {friction} /\n&load horizontal_coefficient = {push!r} /\n")
    return row["verdict"], (folder / "out" / "log.txt").read_text()


@pytest.mark.parametrize("size", [1e-1, 1e-3, 1e-5, 3e-6, 1e-6, 1e-7, 1e-8])
@pytest.mark.parametrize("case", CASES)
def test_a_tiny_block_on_a_fixed_base(tmp_path: Path, size: float, case: Case) -> None:
    base = "block fixed\n-50 -10\n50 -10\n50 0\n-50 0\n"
    verdict, _ = run(tmp_path, base, 0.0, size, case)
    assert verdict == case[-1] or size < 1e-2 and verdict == "undecided"
    if case[1] == 0.0 and size >= 1e-6:
        assert verdict == case[-1]


@pytest.mark.parametrize("size", [1.0, 1e-2, 1e-5, 1e-6, 1e-7])
@pytest.mark.parametrize("case", CASES)
def test_a_tiny_block_on_a_large_one_that_moves(tmp_path: Path, size: float, case: Case) -> None:
    below = "block fixed\n-50 -10\n50 -10\n50 0\n-50 0\nblock\n-40 0\n40 0\n40 10\n-40 10\n"
    verdict, log = run(tmp_path, below, 10.0, size, case)
    if size > 1e-4:
        assert verdict == case[-1]
    else:
        assert verdict == "undecided"
        assert "round-off of coordinates loads a small block with more than its weight" in log
