"""Two wedges on a bent base, whose blocks meet with four corners at its bend: friction that holds them, by a search."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import rows_of, run_deck

WEDGES = """block fixed material 3\n0 0\n-3.0 3.0\n-4.0 3.0\n-4.0 -2.0\n0 -2.0
block fixed material 3\n0 0\n0 -2.0\n6.0 -2.0\n6.0 -1.057961884251
block material 2\n0 0\n0 2.0\n-2.0 2.0
block material 1\n0 0\n4.0 -0.705307922834\n4.0 1.294692077166\n0 2.0
material 2 unit_weight {weight!r}\nmaterial 3\njoint 1 2 friction_deg 0
"""


def friction_that_holds(weight: float) -> float:
    """Thrust of the wedge on 45 degrees is what the one on 10 degrees can bear, by halving [deg]."""
    low, high = 10.0, 45.0
    while high - low > 1e-12:
        middle = (low + high) / 2
        thrust = 2.0 * weight * math.tan(math.radians(45 - middle))
        borne = 8.0 * 2240.0 * 9.81 * math.tan(math.radians(middle - 10))
        low, high = (middle, high) if thrust > borne else (low, middle)
    return low


@pytest.mark.parametrize("weight", [1e3, 1e4, 5e4])
@pytest.mark.parametrize("geometry, young", [("reference", 5e9), ("current", 5e9), ("current", 5e12)])
def test_friction_that_holds_two_wedges_is_found(tmp_path: Path, weight: float, geometry: str, young: float) -> None:
    (tmp_path / "x.blocks").write_text(WEDGES.format(weight=weight))
    run_deck(
        tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&search parameter = 'friction_deg' /\n"
        f"&analysis geometry = '{geometry}' /\n&material young = {young!r} /\n", "--out", "out", "--quiet")
    (row,) = rows_of(tmp_path / "out" / "results.csv")
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(friction_that_holds(weight), rel=1e-7 if young > 1e10 else 1e-4)
