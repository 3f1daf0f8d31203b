"""Water on joints and faces, against closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, run_blocks

HEIGHT = 30.0


def dam(base: float, factor: float) -> str:
    """A triangular dam with a full reservoir on its upright face."""
    return (
        block([(-20.0, -5.0), (40.0, -5.0), (40.0, 0.0), (-20.0, 0.0)], "fixed")
        + block([(0.0, 0.0), (base, 0.0), (0.0, HEIGHT)])
        + f"water -10 {HEIGHT} 0 {HEIGHT} {base!r} 0 unit_weight 9810 factor {factor}\n"
    )


@pytest.mark.parametrize("factor", [0.0, 0.4, 1.0])
def test_a_dam_overturns_below_its_least_base(tmp_path: Path, factor: float) -> None:
    least = math.sqrt(9.81 * HEIGHT**2 / (2.0 * (24.0 - factor * 9.81)))
    if factor in (0.0, 1.0):
        assert least == pytest.approx({0.0: 13.562355990018844, 1.0: 17.6380091209447}[factor])
    deck = "&material unit_weight=24000 /\n&joint friction_deg=89.95 /\n"
    for share, verdict in ((1 - 1e-6, "collapsed"), (1 + 1e-6, "stable")):
        assert run_blocks(tmp_path, dam(least * share, factor), deck)["verdict"] == verdict


@pytest.mark.parametrize(
    ("factor", "base", "friction"),
    [(0.0, 13.562355990018844, 42.11853327026098), (1.0, 17.6380091209447, 49.62095990058765)],
)
def test_a_dam_slides_below_its_least_friction(tmp_path: Path, factor: float, base: float, friction: float) -> None:
    row = run_blocks(
        tmp_path, dam(1.0000001 * base, factor),
        "&material unit_weight=24000 /\n&search parameter='friction_deg' low=20 high=80 /\n")
    assert float(row["critical"]) == pytest.approx(friction, rel=1e-6)


def plane(water: str) -> str:
    """The slope of Sau Mau Ping: 60 m high, a plane at 35 degrees, a tension crack."""
    crack = 46.0 / math.tan(math.radians(35.0))
    crest = 60.0 / math.tan(math.radians(50.0))
    return (
        block([(0.0, 0.0), (0.0, -20.0), (crack, -20.0), (crack, 46.0)], "fixed")
        + block([(crack, -20.0), (120.0, -20.0), (120.0, 60.0), (crack, 60.0)], "fixed material 2")
        + "material 2 density 2000\njoint 1 2 friction_deg 0 cohesion 0\n"
        + block([(0.0, 0.0), (crack, 46.0), (crack, 60.0), (crest, 60.0)])
        + water.format(crack=repr(crack))
    )


@pytest.mark.parametrize(
    ("level", "safety"),
    [(0.0, 1.5843310659876608), (7.0, 1.4164960580294252), (14.0, 1.2060325697984489)],
)
def test_a_slope_with_water_in_its_crack_has_its_safety(tmp_path: Path, level: float, safety: float) -> None:
    friction = math.degrees(math.atan(math.tan(math.radians(35.0)) / safety))
    row = run_blocks(
        tmp_path,
        plane(f"water 0 0 {{crack}} {46.0 + level} unit_weight 9810\n" if level else ""),
        f"&material unit_weight=26000 young=1e10 /\n&joint friction_deg={friction!r} /\n"
        "&search parameter='cohesion' low=1e3 high=2e5 tolerance=1e-8 /\n",
    )
    assert float(row["critical"]) == pytest.approx(1e5 / safety, rel=1e-6)


def wall() -> str:
    """A block that water rises on from the left."""
    return (
        block([(-10.0, -2.0), (10.0, -2.0), (10.0, 0.0), (-10.0, 0.0)], "fixed")
        + block([(0.0, 0.0), (3.0, 0.0), (3.0, 5.0), (0.0, 5.0)])
    )


def test_water_that_rises_in_time_brings_the_wall_down_at_its_level(tmp_path: Path) -> None:
    level = (24000.0 * 15.0 * 1.5 / 9810.0 + 125.0 / 3.0) / 12.5
    deck = "&material unit_weight=24000 /\n&joint friction_deg=80 /\n"
    scene = wall() + "water -10 0 0 0 factor 0\n0 0\n10 10\n"
    row = run_blocks(tmp_path, scene, deck)
    assert row["verdict"] == "collapsed"
    row = run_blocks(tmp_path, scene.replace("10 10\n", f"10 {level - 1e-4}\n"), deck)
    assert row["verdict"] == "stable"
    row = run_blocks(tmp_path, scene.replace("10 10\n", f"10 {level + 1e-4}\n"), deck)
    assert row["verdict"] == "collapsed"


def layers(columns: int, courses: int, shift: float) -> tuple[str, float]:
    """Slabs on a plane of 25 degrees, cut across, under a line of heads along the plane; their length."""
    sine, cosine = math.sin(math.radians(25.0)), math.cos(math.radians(25.0))

    def at(along: float, above: float) -> tuple[float, float]:
        return along * cosine + above * sine, -along * sine + above * cosine

    total = 4.0 * columns
    text = block([at(-5.0, -5.0), at(total + 5.0, -5.0), at(total + 5.0, 0.0), at(-5.0, 0.0)], "fixed")
    for course in range(courses):
        moved = shift * (course % 2)
        cuts = sorted({0.0, total, *(4.0 * (k + moved) for k in range(columns))})
        for left, right in zip(cuts, cuts[1:]):
            text += block([at(left, course), at(right, course), at(right, course + 1.0), at(left, course + 1.0)])
    ends = (*at(-10.0, 0.0), *at(total + 10.0, 0.0))
    return text + "water " + " ".join(map(repr, ends)) + "\n", total


@pytest.mark.parametrize(("columns", "shift"), [(20, 0.0), (20, 0.5), (60, 0.0)])
def test_water_rises_in_a_slope_until_it_slides_on_its_plane(tmp_path: Path, columns: int, shift: float) -> None:
    """Heads r above the plane press it by gw r, both ends and the joints by what stands above: all slides at once."""
    courses, friction, weight, water = 5, math.tan(math.radians(35.0)), 25000.0, 9810.0
    scene, length = layers(columns, courses, shift)
    sine, cosine = math.sin(math.radians(25.0)), math.cos(math.radians(25.0))
    # the pressure gw (r - y/cos) grows towards the plane; ends balance but for their heights: alike at both of them
    row = run_blocks(
        tmp_path,
        scene,
        f"&material unit_weight = {weight} /\n&joint friction_deg = 35 /\n"
        "&search parameter = 'water_rise', low = -1, high = 10, tolerance = 1e-8 /\n",
    )
    assert row["verdict"] == "found"
    down = weight * courses * length * sine
    needed = weight * courses * length * cosine - down / friction
    assert float(row["critical"]) == pytest.approx(needed / (water * length), rel=1e-8)
