"""Joints that crush bear their force on a strip: closed forms, linear programmes of tangents, what is refused."""

from __future__ import annotations

import math
import os
from pathlib import Path

import pytest
from crushing_bridges import check as check_bridge
from crushing_bridges import crushing_bridge
from dda_command import rows_of
from test_live_loads import SEARCH, rows

DDA = os.environ["DDA"]
ASSOCIATED = "&analysis flow = 'associated' /\n"
BLOCK = "block fixed\n-1 -1\n2 -1\n2 0\n-1 0\nblock\n0 0\n1 0\n1 2\n0 2\n"
BRIDGE = (
    "&arch shape = '{shape}', span = 10, rise = {rise}, thickness = 0.6, voussoirs = 24 /\n"
    "&joint friction_deg = 40 /\n&vehicle axles = 1000, position = -2.4 /\n" + ASSOCIATED + SEARCH
)

TURNING = (
    "&arch shape = 'segmental', span = 11.6, voussoirs = 18, rise = 5.382, crown_thickness = 0.5979, "
    "springing_thickness = 1.056, spans = 3, pier_width = 3.086, pier_height = 3.816, rings = 4 /\n"
    "&joint friction_deg = 42.95 /\n&material compressive_strength = 13700000.0 /\n"
    "&fill height = 0.2281, unit_weight = 17840.0, passive_coefficient = 0.2791 /\n"
    "&vehicle axles = 107600.0, 54290.0, 57510.0, 105400.0, 45750.0, spacings = 2.562, 5.057, 2.418, 1.123, "
    "length = 0.3, position = -4.16 /\n",
    "&arch shape = 'basket', span = 3.324, voussoirs = 18, rise = 0.7025, thickness = 0.2446, spans = 3, "
    "pier_width = 0.9312, pier_height = 1.163, rings = 4 /\n"
    "&joint friction_deg = 23.64 /\n&material compressive_strength = 606900.0, unit_weight = 22020.0 /\n"
    "&fill height = 0.2189, unit_weight = 20450.0, spread = 0.25, backing_height = 0.8063 /\n"
    "&vehicle axles = 101900.0, 63650.0, spacings = 1.4, length = 0.3, position = -0.104 /\n",
)


def material(strength: float, weight: float = 1.0) -> str:
    """Blocks of a weight and a strength."""
    return f"&material unit_weight = {weight!r}, compressive_strength = {strength!r} /\n"


def limit(tmp_path: Path, live: str, strength: float, own: str = "") -> tuple[float, float]:
    """The proven interval of the load factor of a block of weight 2 and width 1."""
    deck = "&joint friction_deg = 85 /\n" + ASSOCIATED + SEARCH
    deck += f"&material unit_weight = 1{own and f', compressive_strength = {strength!r}'} /\n"
    (row,) = rows(tmp_path, deck, BLOCK + f"live {live}\n")
    assert row["verdict"] == "found"
    return float(row["exact_low"]), float(row["exact_high"])


@pytest.mark.parametrize("flow", ["associated", "coulomb"])
@pytest.mark.parametrize("strength", [2.1, 3.0, 5.0, 1e3])
def test_a_joint_that_crushes_is_a_hinge_of_the_mechanism(tmp_path: Path, strength: float, flow: str) -> None:
    """The block turns about the edge of the strip: the mechanism is a rotation at any strength."""
    deck = f"&joint friction_deg = 85 /\n&analysis flow = '{flow}' /\n" + SEARCH + material(strength)
    (row,) = rows(tmp_path, deck, BLOCK + "live 0 1.5 1 0\n")
    assert (row["verdict"], row["collapse_mode"], float(row["sliding_share"])) == ("found", "rotational", 0.0)
    (joint,) = rows_of(tmp_path / "x" / "joints.csv")
    assert joint["mechanism"] == ("hinge_intrados" if float(joint["x_intrados"]) == 1.0 else "hinge_extrados")
    assert float(joint["normal_force"]) == pytest.approx(2.0, rel=1e-9)


def test_a_corner_of_a_pier_bears_nothing_where_joints_crush(tmp_path: Path) -> None:
    """The joints of the two springings end at one corner each, which has no area: they have no force."""
    deck = (
        "&arch span = 2.233, rise = 1.558, thickness = 0.1105, voussoirs = 18, spans = 2, pier_width = 0.3778, "
        "pier_height = 0.4839 /\n&fill height = 0.3, unit_weight = 20e3 /\n&vehicle axles = 4e5, position = 0.4 /\n"
        "&joint friction_deg = 56 /\n&material unit_weight = 17530, compressive_strength = 2e6 /\n"
    )
    (row,) = rows(tmp_path, deck + ASSOCIATED, head="")
    assert row["verdict"] == "collapsed"
    joints = rows_of(tmp_path / "x" / "joints.csv")
    corners = [joint for joint in joints if all(joint[f"{x}_intrados"] == joint[f"{x}_extrados"] for x in "xy")]
    assert len(corners) == 2
    assert all(float(joint["normal_force"]) == float(joint["force_y"]) == 0.0 for joint in corners)


@pytest.mark.parametrize("place", [0.5, 0.6, 0.9])
@pytest.mark.parametrize("strength", [1e4, 1e6, 1e9])
def test_a_column_of_any_strength_bears_up_to_it(tmp_path: Path, place: float, strength: float) -> None:
    """A live load that the joints carry alone is not carried at any factor."""
    low, high = limit(tmp_path, f"{place!r} 2 0 -1", strength, "own")
    slope = 4.0 / strength - 1.0 + 2.0 * (place - 0.5)
    most = (-slope + math.sqrt(slope**2 + 4.0 / strength * (2.0 - 4.0 / strength))) / (2.0 / strength)
    assert low <= most * (1 + 1e-11) and most * (1 - 1e-11) <= high
    assert high - low <= 1e-8 * most


@pytest.mark.parametrize(("held", "verdict"), [("fix 0.5 2\n", "stable"), ("fix 0.5 2 x\n", "found")])
def test_what_hangs_on_a_pin_is_carried_at_any_factor(tmp_path: Path, held: str, verdict: str) -> None:
    deck = "&joint friction_deg = 45 /\n" + ASSOCIATED + SEARCH + material(50.0)
    (row,) = rows(tmp_path, deck, BLOCK + held + "live 0.5 2 0 -1\n")
    assert row["verdict"] == verdict


@pytest.mark.parametrize(("share", "verdict"), [(1 - 1e-6, "stable"), (1 + 1e-6, "collapsed")])
def test_a_column_is_decided_near_its_strength(tmp_path: Path, share: float, verdict: str) -> None:
    blocks = BLOCK + f"load 0.5 2 0 {-3.0 * share!r}\n"
    (row,) = rows(tmp_path, material(5.0) + ASSOCIATED, blocks)
    assert row["verdict"] == verdict
    assert float(row["law_violation"]) <= 1e-11


def test_the_least_strength_is_found(tmp_path: Path) -> None:
    blocks = BLOCK + "load 0 1.5 0.4 0\n"
    deck = "&joint friction_deg = 85 /\n&material unit_weight = 1 /\n" + ASSOCIATED
    deck += "&search parameter = 'compressive_strength', low = 2.1, high = 100 /\n"
    (row,) = rows(tmp_path, deck, blocks)
    assert float(row["critical"]) == pytest.approx(5.0, rel=1e-7)


def beside_tangents(folder: Path, deck: str) -> tuple[dict[str, str], float]:
    """Row of a search, and the load factor that a linear programme of tangents has for its scene."""
    pytest.importorskip("scipy", reason="the linear programme wants scipy")
    verify = pytest.importorskip("voussoir.verify.command", reason="PYTHONPATH wants python/")
    from live_assemblies import programme
    from voussoir.verify.deck import read_deck

    (row,) = rows(folder, deck, head="")
    (results,) = {path.parent for path in folder.rglob("results.csv")}
    blocks = verify.read_table(results / "blocks.csv")[1]
    scene = verify.scene_of(read_deck(results).with_value("load_factor", "1"), blocks, [folder], verify.Finding())
    return row, programme(scene, crushes=True)


@pytest.mark.parametrize(
    ("shape", "rise", "strength"),
    [(shape, rise, strength) for shape, rise in (("segmental", 2.5), ("parabolic", 3.5), ("segmental", 1.8))
     for strength in (4e5, 1.3e6, 1e7)]
    + [("pointed", 6.0, 1.3e6), ("pointed", 5.5, 1.3e6), ("pointed", 6.0, 1e7), ("elliptic", 3.0, 2e6)],
)
def test_an_arch_carries_what_a_programme_of_tangents_has(
    tmp_path: Path, shape: str, rise: float, strength: float
) -> None:
    row, limit = beside_tangents(tmp_path, BRIDGE.format(shape=shape, rise=rise) + material(strength, 2e4))
    assert float(row["critical"]) == pytest.approx(limit, rel=1e-7)


RINGS = (
    "&arch shape = 'segmental', span = 13.36, voussoirs = 8, rise = 3.61, thickness = 1.104, rings = 3 /\n"
    "&joint friction_deg = {friction} /\n&vehicle axles = 93170, length = 0.3, position = {place} /\n"
    + ASSOCIATED + SEARCH
)


@pytest.mark.parametrize("friction", [25.87, 45.0])
@pytest.mark.parametrize("place", [-3.0, 0.0])
@pytest.mark.parametrize("strength", [1.5e6, 5.503e6])
def test_rings_that_crush_and_slide_carry_what_a_programme_of_tangents_has(
    tmp_path: Path, friction: float, place: float, strength: float
) -> None:
    row, limit = beside_tangents(tmp_path, RINGS.format(friction=friction, place=place) + material(strength, 2e4))
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(limit, rel=1e-7)
    assert int(row["factorisations"]) < 60


def test_rings_under_passive_fill_that_crush_are_found(tmp_path: Path) -> None:
    """The limit that tangents of the parabolas have, each a layer of the graph of joints."""
    bridge = (
        "&arch shape = 'catenary', span = 9.639, voussoirs = 20, rise = 1.731, thickness = 0.5015, rings = 3,\n"
        "joint_direction = 'radial' /\n&joint friction_deg = 60.65 /\n"
        "&vehicle axles = 78430, 15420, spacings = 1.184, length = 0.2757, position = 0.8581 /\n"
        "&fill height = 1.025, unit_weight = 20570, passive_coefficient = 2.538, backing_height = 0.3489 /\n"
        "&material compressive_strength = 616900 /\n" + ASSOCIATED + SEARCH
    )
    (row,) = rows(tmp_path, bridge, head="")
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(0.348006381, rel=1e-8)
    assert int(row["factorisations"]) < 60


def test_joints_slide_within_friction_as_they_begin_to_crush(tmp_path: Path) -> None:
    """Forces of a stable arch whose joints stick at their limit before they crush: |T| <= tan(47.93 deg) N."""
    (row,) = rows(
        tmp_path, "&arch shape = 'pointed', span = 2.4, voussoirs = 20, rise = 1.748, thickness = 0.225, rings = 3 /\n"
        "&joint friction_deg = 47.93 /\n&material compressive_strength = 27480000 /\n", head="")
    assert row["verdict"] == "stable"
    joints = rows_of(tmp_path / "x" / "joints.csv")
    largest = max(float(joint["normal_force"]) for joint in joints)
    for joint in joints:
        bound = math.tan(math.radians(47.93)) * float(joint["normal_force"])
        assert abs(float(joint["shear_force"])) <= bound + 1e-9 * largest


@pytest.mark.parametrize("groups, falls", [
    ("&arch shape = 'circular', span = 4.022, voussoirs = 15, rise = 1.654, thickness = 0.2274, rings = 4 /\n"
     "&joint friction_deg = 50.31 /\n&fill height = 0.1053, unit_weight = 16040.0 /\n"
     "&material compressive_strength = 425400.0 /\n&vehicle axles = 19490.0, 29650.0, spacings = 1.275, "
     "length = 0.0, position = 0.1965 /\n", True),
    ("&arch shape = 'pointed', span = 2.565, voussoirs = 18, rise = 1.878, thickness = 0.1559, right_rise = 2.251, "
     "spans = 2, pier_width = 0.4258, pier_height = 1.129, rings = 4 /\n&fill height = 0.3487, unit_weight = 18980.0, "
     "passive_coefficient = 1.819, backing_height = 0.6846 /\n&material compressive_strength = 10940000.0, "
     "unit_weight = 16500.0 /\n&vehicle axles = 80780.0, 22170.0, 49710.0, spacings = 1.263, 1.282, "
     "length = 0.1651, position = 0.4687 /\n", False),
])
def test_corners_that_hardly_bear_open_as_their_joints_begin_to_crush(
    tmp_path: Path, groups: str, falls: bool
) -> None:
    """The path begins with forces within the strips of all joints: else its end would be undecided."""
    (row,) = rows(tmp_path, groups + "&analysis flow = 'coulomb' /\n" + SEARCH, head="")
    assert row["verdict"] == ("collapsed" if falls else "found")
    assert falls or float(row["critical"]) < float(row["exact_high"])


def test_great_strengths_are_none(tmp_path: Path) -> None:
    bridge = BRIDGE.format(shape="segmental", rise=2.5)
    (bare,) = rows(tmp_path, bridge + "&material unit_weight = 2e4 /\n", head="")
    for strength in (1e16, 1e18, 1e24, 1e30):
        (row,) = rows(tmp_path, bridge + material(strength, 2e4), head="")
        assert float(row["critical"]) == pytest.approx(float(bare["critical"]), rel=1e-9)


@pytest.mark.parametrize("strength", [2.5, 5.0, 1e3])
def test_a_block_under_coulomb_friction_turns_over_or_slides(tmp_path: Path, strength: float) -> None:
    """Pushed half way up it turns about its strip, or slides at the friction of its weight."""
    turning = 2.0 * (1.0 - 2.0 / strength) / 2.0 / 1.5
    for friction in (85.0, 15.0):
        deck = f"&joint friction_deg = {friction} /\n" + SEARCH + material(strength)
        (row,) = rows(tmp_path, deck, BLOCK + "live 0 1.5 1 0\n")
        sliding = 2.0 * math.tan(math.radians(friction))
        assert float(row["critical"]) == pytest.approx(min(turning, sliding), rel=1e-8)


@pytest.mark.parametrize(("friction", "strength"), [(40.0, 1.3e6), (22.0, 4e5), (18.0, 1.3e6), (40.0, 1e30)])
def test_an_arch_follows_its_path_to_the_limit_where_nothing_slides(
    tmp_path: Path, friction: float, strength: float
) -> None:
    bridge = BRIDGE.format(shape="segmental", rise=2.5).replace("friction_deg = 40", f"friction_deg = {friction}")
    (limit,) = rows(tmp_path, bridge + material(strength, 2e4), head="")
    (path,) = rows(tmp_path, bridge.replace(ASSOCIATED, "") + material(strength, 2e4), head="")
    assert path["verdict"] == "found"
    assert float(path["critical"]) <= float(limit["exact_high"]) * (1 + 1e-12)
    if path["mode"] == "rotational":
        assert float(path["critical"]) == pytest.approx(float(limit["critical"]), rel=1e-9)
    load = f"&load load_factor = {0.999 * float(path['critical'])!r} /\n"
    (row,) = rows(tmp_path, bridge.replace(ASSOCIATED + SEARCH, load) + material(strength, 2e4), head="")
    assert row["verdict"] == "stable"
    assert float(row["law_violation"]) <= 1e-9


@pytest.mark.parametrize("friction", ["89.9", "90"])
def test_joints_that_need_no_slip_have_the_limit_of_steep_friction(tmp_path: Path, friction: str) -> None:
    """The mechanism turns alone: forces at 80 degrees carry the limit of more friction."""
    bridge = ("&arch shape = 'parabolic', span = 16.01, voussoirs = 34, rise = 6.547, thickness = 0.6859 /\n"
              "&joint friction_deg = {0} /\n&fill height = 2.222, unit_weight = 14590, backing_height = 3.036 /\n"
              "&vehicle axles = 99210, length = 0.3, position = 8 /\n" + SEARCH)
    (steep,) = rows(tmp_path, bridge.format(80) + material(1792000.0, 26690.0), head="")
    (row,) = rows(tmp_path, bridge.format(friction) + material(1792000.0, 26690.0), head="")
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(float(steep["critical"]), rel=1e-8)


@pytest.mark.parametrize("share", [0.5, 0.99, 0.999, 1.001, 1.01, 1.5, 10.0])
@pytest.mark.parametrize("shape", [(1.0, 0.3), (3.0, 1.5)])
def test_two_blocks_between_walls_stand_above_the_closed_form(
        tmp_path: Path, shape: tuple[float, float], share: float) -> None:
    """H (h - H/s) = W a/2 with H at most s h/4; friction that carries W by the thrust without crushing, W a/(2 h)."""
    half, height = shape
    strength = share * 2.0 * half**2 / height
    friction = math.degrees(math.atan(1.05 * 2.0 * height / half))
    deck = f"&joint friction_deg = {friction!r} /\n&analysis flow = 'coulomb' /\n" + material(strength)
    (row,) = rows(tmp_path, deck, beam(half, height))
    assert row["verdict"] == ("stable" if share > 1.0 else "collapsed")


def beam(half: float, height: float) -> str:
    """Two blocks between walls."""
    ends = ((-1.0, 0.0), (2.0 * half, 2.0 * half + 1.0))
    text = "".join(f"block fixed\n{a} {-height}\n{b} {-height}\n{b} {2 * height}\n{a} {2 * height}\n" for a, b in ends)
    return text + "".join(f"block\n{x} 0\n{x + half} 0\n{x + half} {height}\n{x} {height}\n" for x in (0.0, half))


def test_a_search_finds_the_strength_of_two_blocks_between_walls(tmp_path: Path) -> None:
    """2 W a/h**2 with W = g a h."""
    deck = "&joint friction_deg = 45 /\n&analysis flow = 'coulomb' /\n&material unit_weight = 25000 /\n" \
        "&search parameter = 'compressive_strength', low = 1e5, high = 1e7 /\n"
    (row,) = rows(tmp_path, deck, beam(2.0, 0.5))
    assert float(row["critical"]) == pytest.approx(4e5, rel=1e-7)


@pytest.mark.parametrize("deck", TURNING)
def test_rings_whose_joints_turn_back_from_their_limits_are_decided(tmp_path: Path, deck: str) -> None:
    """Joints near their limits leave them and come back: the path aims at where they do, step by step."""
    (row,) = rows(tmp_path, deck + "&analysis flow = 'coulomb' /\n" + SEARCH, head="")
    assert row["verdict"] == "found"
    assert 0.0 < float(row["critical_high"]) <= float(row["exact_high"])
    assert int(row["factorisations"]) < 5000


def test_a_path_ends_at_the_load_that_its_joints_tend_to(tmp_path: Path) -> None:
    """Nothing slides in this collapse, so that the associated limit, found by forces alone, is the right value."""
    bridge, place = crushing_bridge(985140)
    (row,) = rows(tmp_path, bridge.deck(f"position = {place}"), head="")
    assert row["verdict"] == "found"
    assert float(row["critical_high"]) == pytest.approx(float(row["exact_low"]), rel=1e-9)


def test_other_steps_find_values_within_the_bracket_of_a_jump(tmp_path: Path) -> None:
    """A path that aims at its limits by chords jumps once more and finds 2.8288; shorter steps find 2.8509."""
    bridge, place = crushing_bridge(985077)
    (row,) = rows(tmp_path, bridge.deck(f"position = {place}"), head="")
    assert float(row["critical_low"]) < 2.8134 < 2.8509 < float(row["critical_high"]) < float(row["exact_low"])


@pytest.mark.parametrize("seed", [985039, 985085, 985101, 986512, 986619, 14600265])
def test_bridges_lie_between_their_bounds_and_are_like_their_mirror_images(tmp_path: Path, seed: int) -> None:
    """One ring to four that slide and crush; `python3 crushing_bridges.py` checks any number of them."""
    verdict, faults = check_bridge(DDA, tmp_path, seed)
    assert faults == [] and verdict in ("found", "collapsed")
