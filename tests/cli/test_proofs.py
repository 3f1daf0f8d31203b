"""Proofs of static verdicts: their figures, the tables that hold them, and the safety numbers of what stands."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest
from test_loading_path import run_wall
from test_live_loads import BLOCK, GROUND, PUSHED, WEIGHT, rows, table

ARCH = (
    "&arch radius = 1.0, half_angle_deg = {}, voussoirs = {}, thickness_ratio = {} /\n"
    "&material unit_weight = 1.0 /\n"
)
ROUGH = "&joint friction_deg = 90 /\n"
LATERAL = "&joint friction_deg = 30 /\n&analysis flow = 'associated' /\n&output thrust_joint = 1 /\n"
NO_PROOF = {
    "no-tables": "&output joints = .false., blocks = .false. /\n",
    "moving": "&analysis geometry = 'current' /\n",
    "strength": "&joint cohesion = 1e3 /\n",
}


def proofs(folder: Path) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    """Rows of proof_forces.csv and proof_motion.csv."""
    both = []
    for name in ("proof_forces", "proof_motion"):
        with (folder / "x" / f"{name}.csv").open(newline="") as lines:
            both.append(list(csv.DictReader(lines)))
    return both[0], both[1]


@pytest.mark.parametrize("row", table("practice_thrust_range.csv"), ids=lambda row: "-".join(list(row.values())[:3]))
@pytest.mark.parametrize("joint", ["", "&output thrust_joint = 2 /\n"], ids=["crown", "haunch"])
def test_thrust_of_an_arch_lies_between_the_ends_of_a_linear_programme(
    tmp_path: Path, row: dict[str, str], joint: str
) -> None:
    half, count, ratio = float(row["embrace_deg"]) / 2.0, int(row["voussoirs"]), float(row["thickness_ratio"])
    (found,) = rows(tmp_path, ARCH.format(half, count, ratio) + ROUGH + joint, head="")
    weight = count * math.sin(2.0 * math.radians(half) / count) * ratio
    assert found["verdict"] == "stable"
    assert float(found["thrust_min"]) == pytest.approx(float(row["Hmin_over_W"]) * weight, rel=1e-8)
    assert float(found["thrust_max"]) == pytest.approx(float(row["Hmax_over_W"]) * weight, rel=1e-8)
    assert float(found["safety_thickness"]) == pytest.approx(ratio / float(found["exact"]), rel=1e-12)
    assert abs(float(found["imbalance"])) < 1e-12 and float(found["law_violation"]) < 1e-12


def test_an_odd_number_of_voussoirs_has_thrust_too(tmp_path: Path) -> None:
    (odd,) = rows(tmp_path, ARCH.format(75, 35, 0.2) + ROUGH, head="")
    (even,) = rows(tmp_path, ARCH.format(75, 36, 0.2) + ROUGH, head="")
    for name in ("thrust_min", "thrust_max"):
        assert float(odd[name]) == pytest.approx(float(even[name]), rel=2e-2)


def test_thrust_between_two_walls_has_no_upper_bound(tmp_path: Path) -> None:
    """A block between two rough walls is held by at least its weight over twice the friction, and by any more."""
    walls = "block fixed\n-1 0\n0 0\n0 2\n-1 2\nblock fixed\n1 0\n2 0\n2 2\n1 2\n"
    (row,) = rows(tmp_path, LATERAL, walls + BLOCK)
    assert row["verdict"] == "stable"
    least = WEIGHT / 2.0 / math.tan(math.radians(30.0))
    assert float(row["thrust_min"]) == pytest.approx(least, rel=1e-8)
    assert row["thrust_max"] == ""


def test_a_collapse_below_the_associated_limit_has_no_proof(tmp_path: Path) -> None:
    """A wall that falls at 5/9 under Coulomb friction, and at 0.6078 under the associated rule."""
    sweep = "&sweep parameter = 'horizontal_coefficient', values = 0.5, 0.58, 0.62 /\n"
    below, between, beyond = run_wall(tmp_path, 4, 8, 0.75, sweep)
    assert [row["verdict"] for row in (below, between, beyond)] == ["stable", "collapsed", "collapsed"]
    assert float(below["imbalance"]) < 1e-9 and below["mechanism_power"] == ""
    assert between["imbalance"] == between["law_violation"] == between["mechanism_power"] == ""
    assert beyond["imbalance"] == "" and float(beyond["mechanism_power"]) > 0.0


@pytest.mark.parametrize("groups", NO_PROOF.values(), ids=NO_PROOF)
def test_figures_are_empty_where_there_is_no_proof(tmp_path: Path, groups: str) -> None:
    (row,) = rows(tmp_path, groups, GROUND + BLOCK)
    assert row["verdict"] == "stable"
    assert row["imbalance"] == row["law_violation"] == row["mechanism_power"] == ""


def test_searches_of_anything_else_are_proven_on_both_sides(tmp_path: Path) -> None:
    (row,) = rows(tmp_path, "&search parameter = 'friction_deg' /\n", PUSHED.replace("live", "load"))
    assert float(row["critical"]) == pytest.approx(math.degrees(math.atan(1000.0 / WEIGHT)), rel=1e-7)
    forces, motion = proofs(tmp_path)
    assert forces and motion
    assert float(forces[0]["value"]) > float(row["critical"]) > float(motion[0]["value"])
    assert float(row["mechanism_power"]) > 0.0


@pytest.mark.parametrize(("groups", "written"), [("", True), ("&output proof = .false. /\n", False)], ids=["on", "off"])
def test_proofs_are_written_unless_the_deck_says_no(tmp_path: Path, groups: str, written: bool) -> None:
    (row,) = rows(tmp_path, ARCH.format(75, 12, 0.2) + ROUGH + groups, head="")
    assert (tmp_path / "x" / "proof_forces.csv").exists() is written
    assert bool(row["imbalance"]) is written
    assert bool(row["thrust_min"]) is written


@pytest.mark.parametrize(("count", "written"), [(100, True), (101, False)])
def test_proofs_are_written_unasked_for_at_most_100_cases(tmp_path: Path, count: int, written: bool) -> None:
    sweep = f"&sweep parameter = 'friction_deg', first = 30, last = 60, count = {count} /\n&output joints = .true. /\n"
    found = rows(tmp_path, ARCH.format(75, 4, 0.2) + sweep, head="")
    assert len(found) == count
    assert (tmp_path / "x" / "proof_forces.csv").exists() is written


def test_a_block_on_held_points_alone_stands(tmp_path: Path) -> None:
    """Its forces may have any sign: nothing bounds them, and nothing divides by their number."""
    held = "block\n0 0\n1 0\n1 2\n0 2\nfix 0 0\nfix 1 0\n"
    (row,) = rows(tmp_path, "", held)
    assert row["verdict"] == "stable"
