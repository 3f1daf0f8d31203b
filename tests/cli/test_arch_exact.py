"""Critical thickness of many arches against an independent limit analysis at 60 digits."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

DATA = Path(__file__).parent.parent / "data" / "arch_exact.csv"


def exact_cases() -> list[dict[str, str]]:
    """Rows of the oracle's table."""
    return rows_of(DATA)


def deck_of(case: dict[str, str]) -> str:
    """Deck that searches the critical thickness of one row."""
    if case["joints_deg"]:
        shape = f"joints_deg = {case['joints_deg'].replace(' ', ', ')}"
    else:
        shape = f"half_angle_deg = {case['half_angle_deg']}\n voussoirs = {case['voussoirs']}"
    facet = f"facet_deg = {case['facet_deg']}" if case["facet_deg"] else ""
    return (
        f"&arch\n {shape}\n {facet}\n springing = '{case['springing']}'\n/\n"
        f"&joint friction_deg = {case['friction_deg']} /\n"
        "&search parameter = 'thickness_ratio' /\n&output joints = .false. /\n"
    )


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, str]]:
    """Row of results.csv of every case, all decks in one run."""
    folder = tmp_path_factory.mktemp("arch_exact")
    decks = []
    for case in exact_cases():
        deck = folder / f"{case['case']}.nml"
        deck.write_text(deck_of(case))
        decks.append(deck)
    run_dda("run", *decks, "--out", folder / "out", "--quiet")
    rows = {}
    for deck in decks:
        (rows[deck.stem],) = rows_of(folder / "out" / deck.stem / "results.csv")
    return rows


def tolerance(case: dict[str, str]) -> float:
    """Largest relative error: 1e-12, and 1e-9 for half angles below 10 degrees."""
    return 1e-12 if float(case["half_angle_deg"]) >= 10.0 else 1e-9


CASES = [pytest.param(case, id=case["case"]) for case in exact_cases()]


@pytest.mark.parametrize("case", CASES)
def test_critical_thickness_is_that_of_limit_analysis(case: dict[str, str], results: dict[str, dict[str, str]]) -> None:
    row = results[case["case"]]
    if case["status"] == "none_stable":
        assert row["verdict"] == "collapsed"
        assert row["critical"] == row["exact"] == ""
    elif case["status"] == "always_stable":
        assert row["verdict"] == "stable"
        assert row["critical"] == row["exact"] == ""
    else:
        exact = float(case["eta_exact"])
        assert row["verdict"] == "found"
        assert abs(float(row["critical"]) - exact) <= tolerance(case) * exact
        assert float(row["critical_low"]) < exact < float(row["critical_high"])


@pytest.mark.parametrize("case", CASES)
def test_exact_value_beside_it_agrees_with_the_oracle(case: dict[str, str], results: dict[str, dict[str, str]]) -> None:
    if case["status"] == "found":
        exact = float(case["eta_exact"])
        assert abs(float(results[case["case"]]["exact"]) - exact) <= 1e-12 * exact


@pytest.mark.parametrize(("half_angle_deg", "voussoirs"), [(1.0, 18), (1.0, 20), (1.2, 16), (1.5, 27), (1.8, 100)])
def test_nearly_flat_arches_lie_inside_their_brackets(tmp_path: Path, half_angle_deg: float, voussoirs: int) -> None:
    (tmp_path / "flat.nml").write_text(
        f"&arch half_angle_deg = {half_angle_deg}, voussoirs = {voussoirs} /\n"
        "&joint friction_deg = 90.0 /\n&search parameter = 'thickness_ratio' /\n"
        "&output joints = .false., blocks = .false. /\n"
    )
    run_dda("run", tmp_path / "flat.nml", "--out", tmp_path / "out", "--quiet")
    (row,) = rows_of(tmp_path / "out" / "results.csv")
    assert row["verdict"] == "found"
    assert float(row["critical_low"]) <= float(row["exact"]) <= float(row["critical_high"])


def search_on_steep_springings(folder: Path, friction_deg: float) -> dict[str, str]:
    """Search an arch of four voussoirs whose springings slope 30 degrees outwards."""
    deck = folder / "steep.nml"
    deck.write_text(
        "&arch half_angle_deg = 120, voussoirs = 4 /\n&search /\n"
        f"&joint friction_deg = {friction_deg} /\n&output joints = .false. /\n"
    )
    run_dda("run", deck, "--out", folder / "out", "--quiet")
    (row,) = rows_of(folder / "out" / "results.csv")
    return row


def test_arch_on_springings_as_steep_as_its_friction_stands_at_the_limit_of_sliding(tmp_path: Path) -> None:
    # thicker than 4 sqrt(3) - 6 it stands without thrust, at the limit of sliding on its springings
    row = search_on_steep_springings(tmp_path, 30.0)
    exact = 4.0 * math.sqrt(3.0) - 6.0
    assert row["verdict"] == "found"
    assert abs(float(row["critical"]) - exact) <= 1e-12 * exact


@pytest.mark.parametrize("friction_deg", [30.5, 31.0, 31.5, 32.0, 32.5])
def test_search_across_sliding_mechanisms_takes_two_decisions(tmp_path: Path, friction_deg: float) -> None:
    row = search_on_steep_springings(tmp_path, friction_deg)
    assert abs(float(row["critical"]) - float(row["exact"])) <= 1e-12 * float(row["exact"])
    assert int(row["steps"]) == 2
