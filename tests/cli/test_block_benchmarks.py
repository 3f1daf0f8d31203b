"""Scenes of polygons with exact answers: the decks of input/benchmarks."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

DECKS = Path(__file__).resolve().parents[2] / "input" / "benchmarks"


def table(folder: Path, name: str = "results.csv") -> list[dict[str, str]]:
    """Rows of a result table."""
    return rows_of(folder / name)


def run(deck: str, folder: Path, *settings: str) -> Path:
    """Run one deck of the benchmarks and return the folder of its results."""
    arguments = [part for setting in settings for part in ("--set", setting)]
    done = run_dda("run", DECKS / f"{deck}.nml", "--out", folder, "--quiet", *arguments)
    assert done.returncode == 0, done.stderr
    return folder


def critical(deck: str, folder: Path, *settings: str) -> list[float]:
    """Critical values of all cases of a deck."""
    rows = table(run(deck, folder, *settings))
    assert {row["verdict"] for row in rows} == {"found"}
    return [float(row["critical"]) for row in rows]


DEGREE = math.pi / 180.0
# weight 25000 N/m, face of 2 m: c A = W (sin a - cos a tan phi)
COHESION = 12500.0 * (math.sin(40 * DEGREE) - math.cos(40 * DEGREE) * math.tan(25 * DEGREE))
# areas 2 and 8: W1 tan(45 - phi) = W2 tan(phi - 10)
WEDGES = 1000.0 * 2.0 / 8.0 * math.tan(15 * DEGREE) / math.tan(20 * DEGREE)
# the load makes atan(k) with the vertical, the slope 10 degrees more
TOPPLING = math.tan(math.atan(0.25) - 10 * DEGREE)

CRITICAL = {
    "post_and_lintel": [1.0 / 3.0],
    "push": [0.5, 0.3],
    "column": [0.2],
    "two_wedges": [WEDGES],
    "slide_with_cohesion": [COHESION],
    "toppling": [TOPPLING],
}


@pytest.mark.parametrize("deck, exact", CRITICAL.items())
def test_critical_value_is_the_exact_one(deck: str, exact: list[float], tmp_path: Path) -> None:
    """To 1e-8 in reference geometry; moving blocks of 5e9 Pa strain by some 1e-5."""
    assert critical(deck, tmp_path / "r") == pytest.approx(exact, rel=2e-8)
    moved = critical(deck, tmp_path / "c", "analysis%geometry=current")
    assert moved == pytest.approx(exact, rel=1e-4)


def test_two_wedges_are_those_of_the_literature() -> None:
    assert WEDGES * 8.0 / 2000.0 == pytest.approx(0.736184, abs=5e-7)


@pytest.mark.parametrize("deck", ["lateral_arch", "lateral_arch_blocks"])
def test_seven_voussoirs_fall_at_0_3736_of_gravity(deck: str, tmp_path: Path) -> None:
    """0.373612 by limit analysis, the same from polygons as from the arch generator."""
    assert critical(deck, tmp_path / "r") == pytest.approx([0.373612], abs=5e-7)
    moved = critical(deck, tmp_path / "c", "analysis%geometry=current")
    assert moved == pytest.approx([0.373612], rel=1e-3)


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_joint_of_a_stack_carries_what_lies_above(geometry: str, tmp_path: Path) -> None:
    folder = run("stack", tmp_path / "out", f"analysis%geometry={geometry}")
    rows = table(folder, "joints.csv")
    assert len(rows) == 10
    for above, row in zip(range(10, 0, -1), rows):
        assert float(row["normal_force"]) == pytest.approx(25000.0 * above, rel=1e-8)
        assert float(row["eccentricity_ratio"]) == pytest.approx(0.0, abs=1e-8)
        assert float(row["shear_force"]) == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_wedge_carries_weight_over_twice_sine_and_friction(geometry: str, tmp_path: Path) -> None:
    folder = run("wedge_in_notch", tmp_path / "out", f"analysis%geometry={geometry}")
    rows = table(folder, "joints.csv")
    weight = 25000.0 * math.tan(30 * DEGREE)
    assert len(rows) == 6
    for row in rows:
        friction = math.tan((int(row["case"]) - 1) * 10.0 * DEGREE)
        held = math.sin(30 * DEGREE) + friction * math.cos(30 * DEGREE)
        assert float(row["normal_force"]) == pytest.approx(weight / (2.0 * held), rel=1e-8)


@pytest.mark.parametrize("geometry", ["reference", "current"])
@pytest.mark.parametrize("deck, verdict", [("overhang_stands", "stable"), ("overhang_falls", "collapsed")])
def test_stack_leans_out_to_the_harmonic_limit(deck: str, verdict: str, geometry: str, tmp_path: Path) -> None:
    rows = table(run(deck, tmp_path / "out", f"analysis%geometry={geometry}"))
    assert [row["verdict"] for row in rows] == [verdict]


def test_block_slides_a_tenth_of_a_degree_below_its_slope(tmp_path: Path) -> None:
    rows = table(run("slope", tmp_path / "out"))
    assert [row["verdict"] for row in rows] == ["collapsed", "collapsed", "stable", "stable"]


def test_four_blocks_meet_in_one_point_and_stand(tmp_path: Path) -> None:
    folder = run("four_corners", tmp_path / "out")
    assert [row["verdict"] for row in table(folder)] == ["stable", "stable"]
    for case in "12":
        rows = [row for row in table(folder, "joints.csv") if row["case"] == case]
        base = [float(row["normal_force"]) for row in rows if row["y_intrados"] == row["y_extrados"] == "0"]
        assert len(rows) == 6
        if case == "1":
            assert sum(base) == pytest.approx(100000.0, rel=1e-8)


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_slope_of_columns_stands_at_40_and_falls_from_32_9_on(geometry: str, tmp_path: Path) -> None:
    """Goodman and Bray: 38.15 degrees by limit equilibrium, 33.4 by limit analysis."""
    rows = table(run("goodman_bray", tmp_path / "out", f"analysis%geometry={geometry}"))
    verdict = {float(row["friction_deg"]): row["verdict"] for row in rows}
    assert verdict[40.0] == "stable"
    assert verdict[32.9] == verdict[30.0] == "collapsed"


def test_small_dry_wall_falls_at_seven_elevenths_of_its_weight(tmp_path: Path) -> None:
    """7/11 on the loading path with friction 0.75 and 0.65; limit analysis says 0.691 and 0.642."""
    assert critical("dry_wall_2x4", tmp_path / "out") == pytest.approx([7 / 11, 7 / 11], abs=1e-6)
