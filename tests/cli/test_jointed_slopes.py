"""Slopes cut by two sets of joints: admissible forces are found under Coulomb's law by one interior point."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_deck
from jointed_slope import geometry


def decide(folder: Path, lines: str, groups: str) -> dict[str, str]:
    """The row of results of a slope."""
    (folder / "slope.geo").write_text(lines)
    run_deck(folder, f"&scene kind = 'lines', geometry = 'slope.geo' /\n{groups}\n", name="slope")
    return rows_of(folder / "slope" / "results.csv")[0]


@pytest.mark.parametrize("friction", [30, 20, 10])
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_flat_beds_stand_by_one_interior_point(tmp_path: Path, seed: int | None, friction: float) -> None:
    """Beds that dip by 5 degrees, cross joints displaced from layer to layer: no steps of time, no jumps."""
    row = decide(tmp_path, geometry(14.0, 12.0, 5.0, 90.0, 1.5, seed), f"&joint friction_deg = {friction} /")
    assert row["verdict"] == "stable"
    assert int(row["steps"]) == 1
    assert int(row["factorisations"]) <= 60


@pytest.mark.parametrize(("dip", "cross"), [(20.0, 95.0), (12.0, 75.0)])
def test_beds_that_dip_more_than_friction_fall(tmp_path: Path, dip: float, cross: float) -> None:
    lines = geometry(14.0, 12.0, dip, cross, 1.5, 3)
    row = decide(tmp_path, lines, "&joint friction_deg = 10 /")
    assert row["verdict"] == "collapsed"
    assert int(row["factorisations"]) <= 80
