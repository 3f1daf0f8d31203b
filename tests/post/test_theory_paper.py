"""Every analytic figure that the paper prints, to the printed digit, from the Fortran module."""

import math
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path

import pytest
from dda_command import rows_of

from voussoir import theory

ROOT = Path(__file__).resolve().parents[2]

PRINTED = rows_of(ROOT / "tests" / "data" / "paper_analytic.csv")
DDA = {
    (row["table"], float(row["alpha_deg"]), row["blocks"], float(row["beta_imposed_deg"] or 0)): row
    for row in rows_of(ROOT / "input" / "paper" / "paper_tables.csv")
}
TABLE_ANGLE = {"1": 90.0, "2": 90.0, "3": 140.0}  #: Half angle of the tables whose rows differ in something else [deg]


def solution(table: str, key: str, name: str) -> dict[str, float]:
    """Exact values that a row of the paper speaks of."""
    word, _, number = key.partition("=")
    if table in ("2", "3"):
        alpha, beta = math.radians(TABLE_ANGLE[table]), math.radians(float(number))
        values = {"beta_rad": beta}
        if name:
            values["eta"] = float(theory.equilibrium_thickness(beta, alpha, name))
        return values
    if table == "text":
        limits = theory.limits(name or "ccr")
        places = {
            "limit": ("A_limit", "alpha_limit", "eta_limit", "beta_limit"),
            "beta_max": ("A_beta_max", "alpha_beta_max", "eta_beta_max", "beta_max"),
            "A": (None, "alpha_unit_A", None, None),
        }
        if word in places:
            found = zip(("A", "alpha_rad", "eta", "beta_rad"), places[word])
            values = {quantity: limits[place] for quantity, place in found if place}
            return values | {"alpha_deg": math.degrees(values["alpha_rad"])} | degrees(values)
    alpha = math.radians(TABLE_ANGLE.get(table) or float(number))
    values = {"alpha_rad": alpha}
    if name:
        values |= dict(zip(("beta_rad", "eta", "h"), map(float, theory.critical(alpha, name))))
    return values | degrees(values)


def degrees(values: dict[str, float]) -> dict[str, float]:
    """The hinge in degrees, where there is one."""
    return {"beta_deg": math.degrees(values["beta_rad"])} if "beta_rad" in values else {}


def dda_row(table: str, key: str) -> dict[str, str]:
    """The paper's own DDA run of a row."""
    word, _, number = key.partition("=")
    if table == "1":
        return DDA["table1", 90.0, number, 0.0]
    if table in ("2", "3"):
        return DDA["table" + table, TABLE_ANGLE[table], "4", float(number)]
    return next(row for row in DDA.values() if row["table"] == "table4" and float(row["alpha_deg"]) == float(number))


def exact(row: dict[str, str]) -> float:
    """The value that a printed figure rounds."""
    values = solution(row["table"], row["row"], row["theory"])
    if not row["quantity"].endswith("_percent"):
        return values[row["quantity"]]
    dda = dda_row(row["table"], row["row"])
    if row["quantity"] == "delta_eta_percent":
        return 100.0 * (float(dda["eta_dda"]) - values["eta"]) / values["eta"]
    return 100.0 * (float(dda["beta_dda_deg"]) - values["beta_deg"]) / values["beta_deg"]


@pytest.mark.parametrize("row", PRINTED, ids=lambda row: "-".join(filter(None, list(row.values())[:4])))
def test_printed_figure_is_reproduced(row):
    figure = Decimal(row["printed"])
    assert Decimal(exact(row)).quantize(figure, ROUND_HALF_UP) == figure


def test_all_figures_are_there():
    assert len(PRINTED) == 346
    assert {row["table"] for row in PRINTED} == {"1", "2", "3", "4", "fig1", "text"}


def test_a_wrong_digit_would_be_found():
    row = next(row for row in PRINTED if row["quantity"] == "eta" and row["row"] == "alpha=90")
    figure = Decimal(row["printed"])
    wrong = figure + Decimal(1).scaleb(figure.as_tuple().exponent)
    assert Decimal(exact(row)).quantize(wrong, ROUND_HALF_UP) != wrong
