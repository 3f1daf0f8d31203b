"""The 53 arches of the paper's Tables 1 to 4 against their exact critical thickness."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

ROOT = Path(__file__).parents[2]
DECKS = ROOT / "input" / "paper"
TABLES = ["table1", "table2", "table3", "table4"]

Row = dict[str, str]


EXACT = rows_of(ROOT / "tests" / "data" / "paper_exact.csv")


Key = tuple[str, float, int, float]


def key_of(table: str, row: Row) -> Key:
    """Identity of an arch: table, half angle, blocks, imposed joint (0 where there is none)."""
    half_angle = float(row.get("alpha_deg") or row["half_angle_deg"])
    imposed = float(row.get("beta_imposed_deg") or row.get("joints_deg(2)") or 0.0)
    return table, half_angle, int(row["blocks"]), imposed


KEYS = [key_of(row["table"], row) for row in EXACT]
each_arch = pytest.mark.parametrize(
    ("key", "exact"), list(zip(KEYS, EXACT)), ids=["-".join(map(str, key)) for key in KEYS]
)


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[Key, Row]]:
    """Rows of results.csv of all four decks, run together, for each geometry."""
    folder = tmp_path_factory.mktemp("paper")
    decks = [DECKS / f"{table}.nml" for table in TABLES]
    done = run_dda("run", *decks, "--out", folder, "--quiet")
    assert done.returncode == 0, done.stderr
    rows: dict[str, dict[Key, Row]] = {"reference": {}, "current": {}}
    for table in TABLES:
        for row in rows_of(folder / table / "results.csv"):
            rows[row["geometry"]][key_of(table, row)] = row
    return rows


def test_all_53_arches_are_there(results: dict[str, dict[Key, Row]]) -> None:
    assert sorted(results["reference"]) == sorted(KEYS)
    assert len(KEYS) == 53


def assert_hinges(row: Row, exact: Row) -> None:
    """Check that an arch turns at the crown, at the exact haunch joint and at the springings."""
    assert row["collapse_mode"] == "rotational"
    assert [float(row["intrados_hinge_deg"])] == [float(exact["intrados_hinge_deg"])]
    assert row["extrados_hinge_deg"] == f"0;{exact['alpha_deg']}"
    assert row["springing_hinge"] == "extrados"


@each_arch
def test_arch_has_its_exact_thickness(key: Key, exact: Row, results: dict[str, dict[Key, Row]]) -> None:
    row = results["reference"][key]
    eta = float(exact["eta_exact"])
    assert row["verdict"] == "found"
    assert row["collapses_at"] == "low"
    assert float(row["critical"]) == pytest.approx(eta, rel=1e-8)
    assert abs(float(row["relative_error"])) <= 1e-8
    assert float(row["critical_low"]) < eta < float(row["critical_high"])
    assert float(row["exact"]) == pytest.approx(eta, rel=1e-12)


@each_arch
def test_arch_turns_at_its_exact_hinges(key: Key, exact: Row, results: dict[str, dict[Key, Row]]) -> None:
    assert_hinges(results["reference"][key], exact)


@each_arch
def test_arch_whose_blocks_move_needs_a_little_more(key: Key, exact: Row, results: dict[str, dict[Key, Row]]) -> None:
    row = results["current"].get(key)
    if row is None:
        pytest.skip("the deck has no current geometry")
    assert row["verdict"] == "found"
    assert float(row["exact"]) == pytest.approx(float(exact["eta_exact"]), rel=1e-12)
    assert 1e-5 < float(row["relative_error"]) < 0.05
    assert_hinges(row, exact)


@pytest.mark.parametrize("table", TABLES)
def test_title_of_the_deck_names_its_table(table: str) -> None:
    assert f"Table {table[-1]}" in run_dda("check", DECKS / f"{table}.nml").stdout
