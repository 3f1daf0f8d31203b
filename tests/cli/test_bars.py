"""Bars: bolts, anchors and ties, against closed forms and against values computed elsewhere."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import bar, bar_forces, block, on_slope, rows_of, run_blocks, turned
from dda_command import run_dda

STIFF = "&material density=2400 young=1e12 poisson=0 /\n&joint friction_deg=0 /\n"
ALONG = turned([(1.0, 0.5), (4.0, 0.5)], 30.0)


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_an_elastic_bolt_carries_a_block_on_a_smooth_slope(tmp_path: Path, geometry: str) -> None:
    scene = on_slope(30.0) + bar(*ALONG, "stiffness 3e6")
    row = run_blocks(tmp_path, scene, STIFF + f"&analysis geometry='{geometry}' /\n")
    assert row["verdict"] == "stable"
    assert bar_forces(tmp_path)[0] == pytest.approx(2400 * 9.81 * 0.5, rel=1e-8)


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_a_block_swings_on_its_bolt_with_its_period(tmp_path: Path, geometry: str) -> None:
    scene = on_slope(30.0) + bar(*ALONG, "stiffness 3e6")
    scene += f"measure {ALONG[0][0]!r} {ALONG[0][1]!r}\n"
    deck = f"&analysis mode='dynamic' geometry='{geometry}' time_step=1e-3 duration=0.9 steps=9000 /\n"
    run_blocks(tmp_path, scene, STIFF + deck)
    rows = rows_of(tmp_path / "out" / "points.csv")
    time = [float(row["time"]) for row in rows]
    way = [math.hypot(float(row["u"]), float(row["v"])) for row in rows]
    middle = 2400 * 9.81 * 0.5 / 3e6
    assert max(way) == pytest.approx(2.0 * middle, rel=1e-3)
    up = [
        time[i] + (time[i + 1] - time[i]) * (middle - way[i]) / (way[i + 1] - way[i])
        for i in range(len(way) - 1)
        if way[i] < middle <= way[i + 1]
    ]
    period = (up[-1] - up[0]) / (len(up) - 1)
    assert len(up) == 5
    assert period == pytest.approx(0.17771531752633465, rel=1e-3)


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


@pytest.mark.parametrize("geometry", ["reference", "current"])
@pytest.mark.parametrize("words", ["stiffness", "ea"])
def test_three_bolts_share_a_slab_by_their_stiffness(tmp_path: Path, geometry: str, words: str) -> None:
    scene = block([(-2.0, 3.0), (4.0, 3.0), (4.0, 4.0), (-2.0, 4.0)], "fixed")
    scene += block([(-1.4, 0.0), (3.6, 0.0), (3.6, 1.0), (-1.4, 1.0)])
    for x, stiffness in ((0.0, 2e7), (1.0, 1e7), (2.5, 3e7)):
        value = stiffness if words == "stiffness" else 2.5 * stiffness
        scene += bar((x, 0.5), (x, 3.0), f"{words} {value}")
    deck = f"&material unit_weight=6000 young=1e15 /\n&analysis geometry='{geometry}' /\n"
    row = run_blocks(tmp_path, scene, deck)
    assert row["verdict"] == "stable"
    exact = [13491.891891891893, 5513.513513513512, 10994.594594594591]
    assert bar_forces(tmp_path) == pytest.approx(exact, rel=1e-8)


def test_a_bar_that_is_too_weak_yields_and_one_that_breaks_lets_go(tmp_path: Path) -> None:
    deck = STIFF + "&analysis mode='dynamic' time_step=1e-3 duration=0.3 steps=900 /\n"
    weight = 2400 * 9.81 * 0.5
    place = f"measure {ALONG[0][0]!r} {ALONG[0][1]!r}\n"
    ways = []
    for words in ("", "breaks"):
        scene = on_slope(30.0) + place
        scene += bar(*ALONG, f"stiffness 3e6 strength {0.6 * weight!r} {words}")
        run_blocks(tmp_path, scene, deck)
        last = rows_of(tmp_path / "out" / "points.csv")[-1]
        ways.append(math.hypot(float(last["u"]), float(last["v"])))
        state = rows_of(tmp_path / "out" / "bars.csv")[-1]
        assert state["state"] == ("broken" if words else "yielding")
    # it yields once it is 0.6 W/k longer, with the speed that it has then
    k, mass, time = 3e6, 2400.0, 0.3
    omega = math.sqrt(k / mass)
    first = math.acos(0.4) / omega
    speed = weight / k * omega * math.sin(omega * first)
    left = time - first
    for way, force in zip(ways, (0.4 * weight, weight), strict=True):
        assert way == pytest.approx(0.6 * weight / k + speed * left + 0.5 * force / mass * left**2, rel=5e-3)


def test_a_bonded_block_is_pushed_off_when_its_bond_and_its_bar_have_given_all(tmp_path: Path) -> None:
    """Cohesion times length, friction times weight and the strength of a bar that yields at once."""
    scene = block([(-9, -1), (9, -1), (9, 0), (-9, 0)], "fixed") + block([(0, 0), (2, 0), (2, 1), (0, 1)])
    scene += bar((1.0, 0.5), (-5.0, 0.5), "stiffness 1e12 strength 1000") + "live block 2 1 0.25 1 0\n"
    deck = "&material density=2000 unit_weight=2e4 /\n&joint friction_deg=30 cohesion=1e4 /\n"
    row = run_blocks(tmp_path, scene, deck + "&search parameter='load_factor' low=0 high=1e6 /\n")
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(2e4 + 4e4 / math.sqrt(3) + 1000.0, rel=1e-7)


def test_a_prestressed_bolt_presses_a_joint_as_much(tmp_path: Path) -> None:
    scene = block([(0.0, -2.0), (2.0, -2.0), (2.0, 0.0), (0.0, 0.0)], "fixed")
    scene += block([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])
    scene += bar((1.0, 0.5), (1.0, -1.0), "stiffness 1e3 prestress 5e4")
    run_blocks(tmp_path, scene, "&material unit_weight=1000 young=1e10 /\n")
    assert bar_forces(tmp_path)[0] == pytest.approx(5e4, rel=1e-6)
    joint = rows_of(tmp_path / "out" / "joints.csv")[0]
    assert float(joint["normal_force"]) == pytest.approx(52000.0, rel=1e-6)


def test_a_bar_only_pulls_unless_it_moves_in_time(tmp_path: Path) -> None:
    scene = block([(0.0, -2.0), (1.0, -2.0), (1.0, -1.0), (0.0, -1.0)], "fixed")
    scene += block([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    scene += bar((0.5, 0.5), (0.5, -1.5), "stiffness 1e8")
    deck = "&material unit_weight=1000 young=1e10 /\n"
    assert run_blocks(tmp_path, scene, deck)["verdict"] == "collapsed"
    moving = deck + "&analysis mode='dynamic' time_step=1e-3 duration=0.1 steps=900 /\n"
    run_blocks(tmp_path, scene, moving)
    assert bar_forces(tmp_path)[0] < 0.0
    run_blocks(tmp_path, scene.replace("1e8", "1e8 slack"), moving)
    assert bar_forces(tmp_path)[0] == 0.0


BAD = {
    "no stiffness": ("bar 0.5 0.5 0.5 -1", "expected either stiffness or ea, got neither"),
    "both": ("bar 0.5 0.5 0.5 -1 stiffness 1 ea 1", "expected either stiffness or ea, got both"),
    "negative": ("bar 0.5 0.5 0.5 -1 stiffness -1", "stiffness must be a number above 0, got -1"),
    "word": ("bar 0.5 0.5 0.5 -1 stiffness 1 strong", "got 'strong'"),
    "no length": ("bar 0.5 0.5 0.5 0.5 stiffness 1", "expected a bar with a length"),
    "one block": ("bar 0.5 0.5 0.6 0.5 stiffness 1", "both ends in one block"),
    "too tight": ("bar 0.5 0.5 0.5 -1 stiffness 1 strength 1 prestress 2", "at most the strength"),
    "three numbers": ("bar 0.5 0.5 0.5 stiffness 1", "4 numbers after 'bar'"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_bars_are_refused_with_their_line(case: str, tmp_path: Path) -> None:
    line, message = BAD[case]
    scene = block([(0.0, -2.0), (1.0, -2.0), (1.0, 0.0), (0.0, 0.0)], "fixed")
    scene += block([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    (tmp_path / "scene.blocks").write_text(scene + line + "\n")
    (tmp_path / "scene.nml").write_text("&scene kind='blocks' geometry='scene.blocks' /\n")
    done = run_dda("check", "scene.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert "scene.blocks:11: error: " in done.stderr and message in done.stderr


def buttressed_arch(thickness: float, n: int, height: float, width: float) -> str:
    """A semicircle on piers flush with its intrados, tied below its springings."""
    inner, outer = 1.0 - thickness / 2.0, 1.0 + thickness / 2.0
    scene = ""
    for i in range(n):
        angles = (math.pi * (1 - (i + 1) / n), math.pi * (1 - i / n))
        rays = [(math.cos(angle), math.sin(angle)) for angle in angles]
        corners = [(inner, 0), (outer, 0), (outer, 1), (inner, 1)]
        scene += block([(r * rays[k][0], r * rays[k][1]) for r, k in corners])
    for side in (-1, 1):
        left, right = sorted((side * inner, side * (inner + width)))
        scene += block([(left, -height), (right, -height), (right, 0.0), (left, 0.0)])
    low = -height - 1.0
    scene += block([(-4.0, low), (4.0, low), (4.0, -height), (-4.0, -height)], "fixed")
    return scene + bar((-inner, -0.1), (inner, -0.1), "stiffness 1e3")


@pytest.mark.parametrize(
    ("thickness", "n", "height", "width", "least", "greatest"),
    [
        (0.15, 20, 1.0, 0.25, 0.03178338931350643, 0.4103399619645495),
        (0.15, 20, 1.0, 0.3, 0.0, 0.4428941218888534),
        (0.2, 16, 3.0, 0.2, 0.10463387529244535, 0.3324197698157423),
    ],
)
def test_a_tie_holds_an_arch_within_the_range_of_its_force(
    tmp_path: Path, thickness: float, n: int, height: float, width: float, least: float, greatest: float) -> None:
    scene = buttressed_arch(thickness, n, height, width)
    deck = "&material unit_weight=1 young=1e9 /\n&joint friction_deg=89.95 /\n"
    row = run_blocks(tmp_path, scene, deck + "&output thrust_bar=1 /\n")
    weight = 0.5 * n * math.sin(math.pi / n) * 2.0 * thickness
    assert float(row["thrust_min"]) / weight == pytest.approx(least, rel=1e-6, abs=1e-12)
    assert float(row["thrust_max"]) / weight == pytest.approx(greatest, rel=1e-6)
    without = scene[: scene.index("bar ")]
    verdict = run_blocks(tmp_path, without, deck)["verdict"]
    assert verdict == ("collapsed" if least > 0.0 else "stable")
    if least > 0.0:
        for factor, wanted in ((1 - 1e-6, "collapsed"), (1 + 1e-6, "stable")):
            strong = scene + f" strength {weight * least * factor!r}"
            strong = strong.replace("1e3\n", "1e3")
            assert run_blocks(tmp_path, strong, deck)["verdict"] == wanted
