"""Axles on arches: where they stand, and the position of the least load factor."""

from __future__ import annotations

from pathlib import Path

import pytest
from bridges import spans
from dda_command import rows_of, run_dda
from test_live_loads import SEARCH, rows, table

ARCH = "&arch radius = 1.0, half_angle_deg = 60.0, voussoirs = 20 /\n&material unit_weight = 1.0 /\n"


def bridge(spans_wanted: int) -> str:
    """A bridge of a table, without its load."""
    row = next(row for row in table("practice_multi_span.csv") if row["spans"] == str(spans_wanted))
    return "".join(line + "\n" for line in spans(row).splitlines() if not line.startswith("live"))


def axles(text: str) -> str:
    """A deck of a bridge with a vehicle."""
    return f"&material unit_weight = 1.0 /\n&joint friction_deg = 35 /\n&vehicle {text} /\n" + SEARCH


@pytest.mark.parametrize(
    "vehicle",
    ["axles = 0.3, length = 0", "axles = 0.3, length = 0.05", "axles = 0.3, 0.15, spacings = 0.3, length = 0",
     "axles = 0.2, 0.2, 0.1, spacings = 0.2, 0.15, length = 0.05"],
)
def test_no_swept_position_is_worse_than_the_worst(tmp_path: Path, vehicle: str) -> None:
    associated = "&analysis flow = 'associated' /\n"
    (worst,) = rows(tmp_path, axles(vehicle + ", worst = .true., both_directions = .false.") + associated, bridge(2))
    places = [-0.7 + 0.11 * i for i in range(31)] + [float(worst["worst_position"]) + 0.004 * i for i in range(-5, 6)]
    sweep = associated + f"&sweep parameter = 'position', values = {', '.join(map(repr, places))} /\n"
    swept = rows(tmp_path, axles(vehicle + ", position = 0") + sweep, bridge(2))
    factors = {float(row["position"]): float(row["critical"]) for row in swept if row["critical"]}
    assert float(worst["critical"]) <= min(factors.values()) * (1.0 + 1e-9)
    assert float(worst["critical"]) == pytest.approx(factors[float(worst["worst_position"])], rel=1e-8)
    assert "position" in (tmp_path / "x" / "log.txt").read_text() or worst["worst_position"]


@pytest.mark.parametrize(("voussoirs", "friction"), [(24, 40), (32, 30), (40, 40)])
def test_rings_under_fill_are_decided(tmp_path: Path, voussoirs: int, friction: int) -> None:
    """Soft forces of fill set no scale: with them as a measure blocks drifted for hundreds of metres, or for ever."""
    deck = (
        f"&arch shape = 'segmental', span = 10, rise = 2.5, thickness = 0.6, voussoirs = {voussoirs}, rings = 3 /\n"
        f"&joint friction_deg = {friction} /\n&fill height = 0.4, unit_weight = 18e3, passive_coefficient = 2 /\n"
        "&vehicle axles = 1e4, 1.5e4, 1e4, spacings = 1.2, 2, {} /\n" + SEARCH
    )
    limit = deck.format("worst = .true., both_directions = .false.") + "&analysis flow = 'associated' /\n"
    (worst,) = rows(tmp_path, limit, head="")
    (row,) = rows(tmp_path, deck.format(f"position = {worst['worst_position']}"), head="")
    assert row["verdict"] == "found"
    assert 0.9 * float(row["exact_low"]) < float(row["critical"]) < float(row["exact_high"])
    assert int(row["factorisations"]) < 1500


def test_the_worst_position_of_a_symmetric_arch_has_a_mirror_image(tmp_path: Path) -> None:
    (worst,) = rows(tmp_path, ARCH + "&vehicle axles = 0.1, length = 0, worst = .true. /\n" + SEARCH, head="")
    place = float(worst["worst_position"])
    both = f"&sweep parameter = 'position', values = {place!r}, {-place!r} /\n"
    mirrored = rows(tmp_path, ARCH + "&vehicle axles = 0.1, length = 0, position = 0 /\n" + SEARCH + both, head="")
    for row in mirrored:
        assert float(row["critical"]) == pytest.approx(float(worst["critical"]), rel=1e-6)
    assert "the least load factor" not in (tmp_path / "x" / "log.txt").read_text()


def test_a_search_without_an_answer_says_its_limit_and_how_far_it_came(tmp_path: Path) -> None:
    """Three rings that slide below fill: jumps of the path may not converge, but limit analysis bounds the factor."""
    deck = (
        "&arch shape = 'segmental', span = 8, rise = 2, thickness = 0.75, voussoirs = 24, rings = 3 /\n"
        "&joint friction_deg = 35 /\n&fill height = 0.3, unit_weight = 20e3, passive_coefficient = 1.0 /\n"
        "&vehicle axles = 60e3, 100e3, spacings = 2.5, position = -4.666779879376229 /\n" + SEARCH
    )
    (limit,) = rows(tmp_path, deck + "&analysis flow = 'associated' /\n", head="")
    (tmp_path / "x.nml").write_text(deck)
    status = run_dda("run", "x.nml", "--quiet", cwd=tmp_path).returncode
    (row,) = rows_of(tmp_path / "x" / "results.csv")
    assert float(row["exact_high"]) == pytest.approx(float(limit["critical"]), rel=1e-9)
    assert status == (3 if row["verdict"] == "undecided" else 0)
    if row["verdict"] == "undecided":
        reached = (tmp_path / "x" / "log.txt").read_text().split(" at ")[1].split()[0]
        assert 1.0 < float(reached) <= float(row["exact_high"])


def test_an_arch_that_falls_unless_both_sides_lean_carries_nothing_where_the_axle_stands_worst(tmp_path: Path) -> None:
    """Only the side away from an axle leans against the fill: with an axle of no weight left of the crown it falls."""
    deck = (
        "&arch shape = 'catenary', span = 2.389, voussoirs = 12, rise = 0.7639, thickness = 0.1074, "
        "buttress_width = 0.301, buttress_height = 1.5684 /\n&joint friction_deg = 51.32 /\n"
        "&material unit_weight = 20e3 /\n&fill height = 0.021, unit_weight = 18e3, passive_coefficient = 2.778 /\n"
        "&vehicle axles = 2e4, {} /\n"
    )
    verdicts = {}
    for place in ("position = 0", "position = -0.3", "position = 0.3"):
        (row,) = rows(tmp_path, deck.format(place) + "&load load_factor = 1e-6 /\n", head="")
        verdicts[place] = row["verdict"]
    assert verdicts == {"position = 0": "stable", "position = -0.3": "collapsed", "position = 0.3": "collapsed"}
    (worst,) = rows(tmp_path, deck.format("worst = .true.") + SEARCH, head="")
    assert worst["verdict"] == "collapsed"
    assert abs(float(worst["worst_position"])) > 0.1


@pytest.mark.parametrize("sweep", ["position', values = 0, 100", "rise', values = 1, 90"])
def test_cases_that_are_not_computed_are_not_checked(tmp_path: Path, sweep: str) -> None:
    """A share of a campaign checks its own cases: 2 s for each part of 10 000 were lost."""
    position = "" if sweep.startswith("position") else ", position = 0"
    (tmp_path / "x.nml").write_text(
        "&arch shape = 'segmental', span = 8, rise = 2, thickness = 0.5, voussoirs = 9 /\n"
        f"&vehicle axles = 1{position} /\n{SEARCH}&sweep parameter = '{sweep} /\n")
    assert run_dda("run", "x.nml", "--quiet", cwd=tmp_path).returncode == 2
    assert run_dda("run", "x.nml", "--quiet", "--cases", "2", cwd=tmp_path).returncode == 2
    done = run_dda("run", "x.nml", "--quiet", "--cases", "1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
