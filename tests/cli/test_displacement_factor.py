"""Supports that spread: the factor of what led points go, searched where blocks move."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from bridges import polygon, voussoirs
from dda_command import rows_of, run_dda
from test_live_loads import rows

#: Semicircle of 16 voussoirs, t/R 0.15 and R 10 m, on a support that is fixed and one that is led
SPREADS = (
    "".join(polygon(block) for block in voussoirs([9.25, 10.75], 180.0, 16))
    + polygon([(-11, -1), (-9, -1), (-9, 0), (-11, 0)], "block fixed")
    + polygon([(9, -1), (11, -1), (11, 0), (9, 0)])
    + "displacement block 18 9.1 -0.9 1 0\ndisplacement block 18 10.9 -0.9 1 0\n"
)
STIFF = "&joint friction_deg = 89 /\n&material young = 1e12 /\n"
MOVING = STIFF + "&analysis geometry = 'current', steps = 4000 /\n"


def test_a_semicircle_falls_where_its_supports_have_spread_by_its_kinematics(tmp_path: Path) -> None:
    """0.0588 of the span of 20 m, from the kinematics of three hinges, in metres."""
    search = "&search parameter = 'displacement_factor', low = 1.0, high = 1.3, tolerance = 1e-4 /\n"
    (row,) = rows(tmp_path, MOVING + search, SPREADS)
    assert row["verdict"] == "found" and row["collapses_at"] == "high"
    assert float(row["critical"]) / 20.0 == pytest.approx(0.0588, abs=3e-4)


@pytest.mark.parametrize("spread", [0.4, 1.0])
def test_the_crown_sinks_with_the_hinge_at_its_extrados(tmp_path: Path, spread: float) -> None:
    """Each half turns rigidly between the hinges at the crown's extrados and the intrados at 56.25 degrees."""
    measured = SPREADS + "measure block 8 0 10.75\nmeasure block 8 0 9.25\n"
    rows(tmp_path, MOVING + f"&load displacement_factor = {spread} /\n", measured)
    extrados, intrados = [-float(row["v"]) for row in rows_of(tmp_path / "x" / "points.csv")[-2:]]
    angle = math.radians(56.25)
    across, height = 9.25 * math.sin(angle), 10.75 - 9.25 * math.cos(angle)
    moved = math.hypot(across, height)**2 - (across + spread / 2.0)**2
    assert extrados == pytest.approx(height - math.sqrt(moved), rel=1e-4)
    # the half turns about that hinge, which takes the intrados up on the way
    turns = math.atan2(height, across) - math.atan2(math.sqrt(moved), across + spread / 2.0)
    assert intrados == pytest.approx(extrados - 1.5 * (1.0 - math.cos(turns)), rel=1e-4)


def test_decisions_agree_with_it(tmp_path: Path) -> None:
    sweep = "&sweep parameter = 'displacement_factor', values = 0, 0.4, 1.16, 1.19, 1.3 /\n"
    verdicts = [row["verdict"] for row in rows(tmp_path, MOVING + sweep, SPREADS)]
    assert verdicts == ["stable", "stable", "stable", "collapsed", "collapsed"]


def test_a_range_without_a_collapse_is_named(tmp_path: Path) -> None:
    deck = ("&arch half_angle_deg = 60, thickness_ratio = 0.15, voussoirs = 9 /\n&support right_dx = 0.001 /\n"
            "&joint friction_deg = 40 /\n&analysis geometry = 'current' /\n"
            "&search parameter = 'displacement_factor', low = 0, high = 20 /\n")
    (tmp_path / "x.nml").write_text(deck)
    done = run_dda("run", "x.nml", cwd=tmp_path)
    assert "no collapse up to search%high = 20; raise it" in done.stdout
