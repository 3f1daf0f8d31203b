"""The worst position of a vehicle: both directions of travel, dead loads that fall, no fixed position that is worse."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda
from random_bridges import Bridge, check, random_bridge, random_study, run

DDA = os.environ["DDA"]
#: An arch that is higher on its right: the heavier axle stands worst on one side
STEPPED = Bridge(
    "&arch shape = 'segmental', span = 8, rise = 1.5, right_rise = 2.5, thickness = 0.5, voussoirs = 25 /\n"
    "&fill height = 0.3, unit_weight = 18e3 /\n", [60e3, 20e3], [2.5], 0.3, "coulomb")
#: Its dead loads stand only where fill presses its right side
LEANING = Bridge(
    "&arch shape = 'circular', span = 6.0, rise = 2.9, thickness = 0.25, voussoirs = 20 /\n"
    "&joint friction_deg = 60.0 /\n&load horizontal_coefficient = 0.2 /\n"
    "&fill height = 0.3, unit_weight = 18e3, passive_coefficient = 1.0, spread = 0.25 /\n", [60e3], [], 0.5,
    "associated")
#: Rings that slide on one another: the first collapse is least elsewhere than the associated limit
SLIDING = Bridge(
    "&arch shape = 'pointed', span = 8.872, voussoirs = 8, rise = 5.999, thickness = 0.7555, rings = 2 /\n"
    "&joint friction_deg = 34.74 /\n&fill height = 1.205, unit_weight = 16510.0, passive_coefficient = 0.8731 /\n"
    "&material unit_weight = 25800.0 /\n", [14830.0], [], 0.3, "coulomb")
#: The paths of neighbouring positions differ: the factor jumps by 5 %
JUMPING = Bridge(
    "&arch shape = 'segmental', span = 6.545, voussoirs = 23, rise = 1.773, thickness = 0.4465 /\n"
    "&joint friction_deg = 43.3 /\n&fill height = 0.3678, unit_weight = 21930.0, passive_coefficient = 2.481 /\n",
    [28520.0, 106200.0], [1.84], 0.3, "coulomb")


def row_of(folder: Path, deck: str) -> dict[str, str]:
    """The row of a deck of one case."""
    (folder / "x.nml").write_text(deck)
    assert run_dda("run", "x.nml", "--quiet", cwd=folder).returncode == 0
    (row,) = rows_of(folder / "x" / "results.csv")
    return row


def test_the_worse_direction_is_found_and_named(tmp_path: Path) -> None:
    """By the axles the other way round in the deck: 3.946 and 2.569."""
    turned = Bridge(STEPPED.groups, STEPPED.axles[::-1], STEPPED.spacings, STEPPED.length, STEPPED.flow)
    one_way = "worst = .true., both_directions = .false."
    forward = row_of(tmp_path, STEPPED.deck(one_way))
    backward = row_of(tmp_path, turned.deck(one_way))
    assert float(forward["critical"]) == pytest.approx(3.946, abs=5e-4)
    assert float(backward["critical"]) == pytest.approx(2.569, abs=5e-4)
    assert forward["worst_direction"] == backward["worst_direction"] == "forward"
    for bridge, way in ((STEPPED, "backward"), (turned, "forward")):
        row = row_of(tmp_path, bridge.deck("worst = .true."))
        assert row["worst_direction"] == way
        assert float(row["critical"]) == pytest.approx(float(backward["critical"]), rel=1e-9)
        # the leftmost axle stands at the position, so that a deck of the axles in that order has the same factor
        place = f"position = {row['worst_position']}"
        fixed = row_of(tmp_path, bridge.deck(place, backward=way == "backward"))
        assert float(fixed["critical"]) == pytest.approx(float(row["critical"]), rel=1e-9)
        assert fixed["worst_position"] == fixed["worst_direction"] == ""


def test_the_log_names_position_and_direction(tmp_path: Path) -> None:
    row = row_of(tmp_path, STEPPED.deck("worst = .true."))
    said = r"least load factor with the leftmost axle at (\S+) m, driving backward"
    place = re.search(said, (tmp_path / "x" / "log.txt").read_text())
    assert float(place[1]) == pytest.approx(float(row["worst_position"]), rel=1e-5)


@pytest.mark.parametrize("flow", ["coulomb", "associated"])
def test_equal_directions_of_a_symmetric_bridge_are_both_named(tmp_path: Path, flow: str) -> None:
    """By decks of both fixed positions; a bridge that is higher on its right has one direction only."""
    groups = STEPPED.groups.replace(", right_rise = 2.5", "")
    bridge = Bridge(groups, STEPPED.axles, STEPPED.spacings, STEPPED.length, flow)
    row = row_of(tmp_path, bridge.deck("worst = .true."))
    said = r"in either direction, with the leftmost axle at (\S+) m \((\w+)\) or (\S+) m \((\w+)\)"
    place, way, other, turned = re.search(said, (tmp_path / "x" / "log.txt").read_text()).groups()
    assert way == row["worst_direction"] and {way, turned} == {"forward", "backward"}
    assert float(place) + float(other) == pytest.approx(-2.5, abs=2e-5)
    for at, direction in ((place, way), (other, turned)):
        fixed = row_of(tmp_path, bridge.deck(f"position = {at}", backward=direction == "backward"))
        assert float(fixed["critical"]) == pytest.approx(float(row["critical"]), rel=1e-5)
    row_of(tmp_path, bridge.deck("worst = .true., both_directions = .false."))
    assert "driving forward" in (tmp_path / "x" / "log.txt").read_text()


def test_equal_axles_stand_at_one_position_in_either_direction(tmp_path: Path) -> None:
    row_of(tmp_path, Bridge(STEPPED.groups, [40e3, 40e3], [2.5], 0.3, "coulomb").deck("worst = .true."))
    assert re.search(r"leftmost axle at \S+ m, in either direction", (tmp_path / "x" / "log.txt").read_text())


@pytest.mark.parametrize("flow", ["coulomb", "associated"])
def test_dead_loads_that_fall_with_the_vehicle_on_one_side_collapse(tmp_path: Path, flow: str) -> None:
    bridge = Bridge(LEANING.groups, LEANING.axles, LEANING.spacings, LEANING.length, flow)
    row = row_of(tmp_path, bridge.deck("worst = .true."))
    assert row["verdict"] == "collapsed" and row["critical"] == ""
    place = f"position = {row['worst_position']}"
    tiny = bridge.deck(place).replace("&search parameter = 'load_factor' /", "&load load_factor = 1e-9 /")
    tiny = tiny.replace("&load horizontal_coefficient = 0.2 /\n", "").replace(
        "load_factor = 1e-9", "load_factor = 1e-9, horizontal_coefficient = 0.2")
    assert row_of(tmp_path, tiny)["verdict"] == "collapsed"


def test_a_first_collapse_that_is_least_beside_the_least_limit_is_found(tmp_path: Path) -> None:
    """9.82 at the position of the least associated limit; 9.10 and less elsewhere."""
    verdict, faults = check(DDA, tmp_path, SLIDING)
    assert (verdict, faults) == ("found", [])
    assert float(row_of(tmp_path, SLIDING.deck("worst = .true."))["critical"]) < 9.1


def test_a_jump_of_the_factor_between_positions_is_named(tmp_path: Path) -> None:
    """By fixed positions on both sides of the place in the log; a factor that does not jump has no such remark."""
    row_of(tmp_path, JUMPING.deck("worst = .true."))
    said = r"jumps with the position .*: from (\S+) to at least (\S+) at (\S+) m, driving (\w+)"
    smaller, larger, place, way = re.search(said, (tmp_path / "x" / "log.txt").read_text()).groups()
    places = [float(place) + 2e-5 * side for side in (-1, 1)]
    sweep = f"&sweep parameter = 'position', values = {places[0]!r}, {places[1]!r} /\n"
    factors = sorted(float(row["critical"]) for row in run(
        DDA, tmp_path, "fixed", JUMPING.deck("position = 0", sweep, way == "backward")))
    assert factors[0] == pytest.approx(float(smaller), rel=2e-4)
    assert factors[1] > 1.04 * factors[0] and factors[1] > float(larger) * (1.0 - 2e-4)
    row_of(tmp_path, STEPPED.deck("worst = .true."))
    assert "jumps with" not in (tmp_path / "x" / "log.txt").read_text()


@pytest.mark.parametrize(("seed", "backward", "places"), [
    (4720013, False, (-2.602, -2.59, -2.577)),
    (9710222, True, (-8.378, -8.377)),
])
def test_positions_whose_paths_fall_early_are_found_between_others(
        tmp_path: Path, seed: int, backward: bool, places: tuple[float, ...]) -> None:
    """Bands of a hundredth of the road: their paths jump where those of others jump, and fall."""
    bridge = random_bridge(seed)
    (worst,) = run(DDA, tmp_path, "worst", bridge.deck("worst = .true."))
    sweep = f"&sweep parameter = 'position', values = {', '.join(map(repr, places))} /\n"
    fixed = run(DDA, tmp_path, "fixed", bridge.deck("position = 0", sweep, backward))
    assert worst["verdict"] == "found"
    assert float(worst["critical"]) <= min(float(row["critical"]) for row in fixed) * (1.0 + 1e-6)


def test_a_bridge_whose_limits_are_not_found_is_undecided_at_once(tmp_path: Path) -> None:
    """Three spans on piers that crush: where no position has a limit, the road was halved for ever."""
    bridge = random_bridge(70016)
    (row,) = run(DDA, tmp_path, "worst", bridge.deck("worst = .true."))
    (fixed,) = run(DDA, tmp_path, "fixed", bridge.deck("position = 0"))
    assert row["verdict"] == fixed["verdict"]


def test_bounds_of_another_position_are_none_of_the_least_factor(tmp_path: Path) -> None:
    """A bridge that cannot slide, whose limits do not meet beside its worst position."""
    deck = random_study(70098).split("&sweep")[0].replace("40.31", "90")
    assert "friction_deg = 90 " in deck and "worst = .true." in deck
    (row,) = run(DDA, tmp_path, "x", deck)
    assert row["verdict"] == "found" or (row["exact_low"], row["exact_high"]) == ("", "")


def test_the_worst_position_of_joints_that_crush_and_cannot_slide_is_found(tmp_path: Path) -> None:
    """The same as at 45 degrees, as nothing slides there."""
    deck = random_study(70039).replace("values = 25, 45, 90", "values = 45, 90")
    sliding, rough = run(DDA, tmp_path, "x", deck)
    assert sliding["verdict"] == rough["verdict"] == "found"
    assert float(rough["critical"]) == pytest.approx(float(sliding["critical"]), rel=2e-9)


@pytest.mark.parametrize("seed", [1, 2, 3, 9, 11, 12])
def test_no_fixed_position_is_worse_than_the_worst(tmp_path: Path, seed: int) -> None:
    verdict, faults = check(DDA, tmp_path, random_bridge(seed))
    assert verdict in ("found", "collapsed", "stable")
    assert not faults
