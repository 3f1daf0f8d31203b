"""Bars: bolts, anchors and ties, against closed forms and against values computed elsewhere."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import bar, bar_forces, block, on_slope, run_blocks, turned

STIFF = "&material density=2400 young=1e12 poisson=0 /\n&joint friction_deg=0 /\n"
ALONG = turned([(1.0, 0.5), (4.0, 0.5)], 30.0)


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_an_elastic_bolt_carries_a_block_on_a_smooth_slope(tmp_path: Path, geometry: str) -> None:
    scene = on_slope(30.0) + bar(*ALONG, "stiffness 3e6")
    row = run_blocks(tmp_path, scene, STIFF + f"&analysis geometry='{geometry}' /\n")
    assert row["verdict"] == "stable"
    assert bar_forces(tmp_path)[0] == pytest.approx(2400 * 9.81 * 0.5, rel=1e-8)


@pytest.mark.parametrize(
    ("slope", "friction", "angle", "strength"),
    [
        (42.0, 36.0, 15.0, 0.11196514012171913),
        (42.0, 36.0, 0.0, 0.12920428618240953),
        (35.0, 30.0, 30.0, 0.08715574274765818),
        (50.0, 38.0, 38.0, 0.20791169081775931),
        (60.0, 20.0, 20.0, 0.6427876096865394),
        (30.0, 10.0, -20.0, None),
    ],
)
def test_a_bolt_holds_a_block_from_its_least_strength_on(
    tmp_path: Path, slope: float, friction: float, angle: float, strength: float | None
) -> None:
    psi, phi, beta = map(math.radians, (slope, friction, angle))
    least = (math.sin(psi) - math.cos(psi) * math.tan(phi)) / (math.cos(beta) + math.sin(beta) * math.tan(phi))
    assert strength is None or least == pytest.approx(strength, rel=1e-12)
    start = (1.0, 0.5)
    end = (1.0 + 3.0 * math.cos(beta), 0.5 - 3.0 * math.sin(beta))
    deck = f"&material unit_weight=5e5 young=1e10 /\n&joint friction_deg={friction} /\n"
    for factor, verdict in ((1 - 1e-8, "collapsed"), (1 + 1e-8, "stable")):
        scene = on_slope(slope, 2.0) + bar(
            *turned([start, end], slope), f"stiffness 1e7 strength {1e6 * least * factor!r}"
        )
        row = run_blocks(tmp_path, scene, deck)
        assert row["verdict"] == verdict
        assert bar_forces(tmp_path)[0] == pytest.approx(1e6 * least, rel=1e-6)


def test_a_bonded_block_is_pushed_off_when_its_bond_and_its_bar_have_given_all(tmp_path: Path) -> None:
    """Cohesion times length, friction times weight and the strength of a bar that yields at once."""
    scene = block([(-9, -1), (9, -1), (9, 0), (-9, 0)], "fixed") + block([(0, 0), (2, 0), (2, 1), (0, 1)])
    scene += bar((1.0, 0.5), (-5.0, 0.5), "stiffness 1e12 strength 1000") + "live block 2 1 0.25 1 0\n"
    deck = "&material density=2000 unit_weight=2e4 /\n&joint friction_deg=30 cohesion=1e4 /\n"
    row = run_blocks(tmp_path, scene, deck + "&search parameter='load_factor' low=0 high=1e6 /\n")
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(2e4 + 4e4 / math.sqrt(3) + 1000.0, rel=1e-7)
