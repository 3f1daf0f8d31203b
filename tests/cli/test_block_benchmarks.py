"""Decks of input/benchmarks: what test_validation.py does not ask of their results, or less closely."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

DECKS = Path(__file__).resolve().parents[2] / "input" / "benchmarks"


def run(deck: str, folder: Path, *settings: str) -> Path:
    """Run one deck of the benchmarks and return the folder of its results."""
    arguments = [part for setting in settings for part in ("--set", setting)]
    done = run_dda("run", DECKS / f"{deck}.nml", "--out", folder, "--quiet", *arguments)
    assert done.returncode == 0, done.stderr
    return folder


def critical(deck: str, folder: Path, *settings: str) -> list[float]:
    """Critical values of all cases of a deck."""
    rows = rows_of(run(deck, folder, *settings) / "results.csv")
    assert {row["verdict"] for row in rows} == {"found"}
    return [float(row["critical"]) for row in rows]


@pytest.mark.parametrize("deck", ["lateral_arch", "lateral_arch_blocks"])
def test_seven_voussoirs_fall_at_0_3736_of_gravity(deck: str, tmp_path: Path) -> None:
    """0.373612 by limit analysis, the same from polygons as from the arch generator."""
    assert critical(deck, tmp_path / "r") == pytest.approx([0.373612], abs=5e-7)
    moved = critical(deck, tmp_path / "c", "analysis%geometry=current")
    assert moved == pytest.approx([0.373612], rel=1e-3)


def test_four_blocks_meet_in_one_point_and_stand(tmp_path: Path) -> None:
    folder = run("four_corners", tmp_path / "out")
    assert [row["verdict"] for row in rows_of(folder / "results.csv")] == ["stable", "stable"]
    for case in "12":
        rows = [row for row in rows_of(folder / "joints.csv") if row["case"] == case]
        base = [float(row["normal_force"]) for row in rows if row["y_intrados"] == row["y_extrados"] == "0"]
        assert len(rows) == 6
        if case == "1":
            assert sum(base) == pytest.approx(100000.0, rel=1e-8)
