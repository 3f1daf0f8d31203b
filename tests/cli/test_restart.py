"""Restart files: what a run leaves for another one to go on from, and what is refused."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda
from fuzz_restart import file_of, numbers_of

#: A stone that slides on its base; held by a spring if asked for
STONE = "block fixed\n-1 -1\n9 -1\n9 0\n-1 0\nblock\n0 0\n1 0\n1 1\n0 1\nmeasure 0.5 1\n"
DECK = """&scene kind = 'blocks', geometry = 'x.blocks' /
&joint friction_deg = 10 /
&load horizontal_coefficient = 0.5 /
&analysis mode = 'dynamic', geometry = '{geometry}', time_step = 0.01, {more} /
&output restart = .true., energy = .true. /
"""


def run(folder: Path, name: str, more: str, geometry: str = "current") -> subprocess.CompletedProcess[str]:
    """Write a deck and run it."""
    (folder / "x.blocks").write_text(STONE)
    (folder / f"{name}.nml").write_text(DECK.format(more=more, geometry=geometry))
    return run_dda("run", f"{name}.nml", "--quiet", cwd=folder, timeout=60.0)


def rows(folder: Path, table: str = "results.csv") -> list[dict[str, str]]:
    """Rows of a table."""
    return rows_of(folder / table)


def change(folder: Path, edit: Callable[[list[int], list[float]], None]) -> None:
    """Change numbers of first/case_1.restart and give the file a true check sum."""
    file = folder / "first" / "case_1.restart"
    whole, number = numbers_of(file.read_bytes())
    edit(whole, number)
    file.write_bytes(file_of(whole, number))


def go_on(folder: Path, more: str = "steps = 20") -> subprocess.CompletedProcess[str]:
    """Go on from first/case_1.restart."""
    return run(folder, "rest", f"restart = 'first/case_1.restart', {more}")


def test_a_run_whose_steps_are_spent_already_computes_none(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 12").returncode == 0
    for steps in (12, 11, 1):
        done = go_on(tmp_path, f"steps = {steps}, duration = 1.0")
        assert done.returncode == 3, done.stderr
        assert [row["verdict"] for row in rows(tmp_path / "rest")] == ["undecided"]
        assert len(rows(tmp_path / "rest", "points.csv")) == 1


def test_a_run_whose_duration_is_over_already_computes_none(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 12, duration = 0.12").returncode == 0
    for duration in (0.12, 0.05):
        done = go_on(tmp_path, f"steps = 99, duration = {duration}")
        assert done.returncode == 0, done.stderr
        assert [row["steps"] for row in rows(tmp_path / "rest")] == ["12"]
        assert [row["verdict"] for row in rows(tmp_path / "rest")] == ["completed"]


def test_what_a_duration_has_cut_short_goes_on_in_whole_steps(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 99, duration = 0.055").returncode == 0
    assert go_on(tmp_path, "steps = 99, duration = 0.095").returncode == 0
    times = [float(row["time"]) for row in rows(tmp_path / "rest", "points.csv")]
    assert times == pytest.approx([0.055, 0.065, 0.075, 0.085, 0.095], abs=1e-12)


def test_the_new_deck_sets_the_time_step(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 3").returncode == 0
    done = go_on(tmp_path, "steps = 7, restitution = 0.5")
    assert done.returncode == 0
    done = run_dda("run", "rest.nml", "--set", "analysis%time_step=0.002", "--quiet", cwd=tmp_path)
    assert done.returncode == 0
    times = [float(row["time"]) for row in rows(tmp_path / "rest", "points.csv")]
    assert times == pytest.approx([0.03, 0.032, 0.034, 0.036, 0.038], abs=1e-12)


@pytest.mark.parametrize(
    ("first", "rest", "words"),
    [
        ("", "unknowns = 3,", "other unknowns"),
        ("unknowns = 3,", "unknowns = 6,", "other unknowns"),
    ],
)
def test_other_unknowns_are_refused(tmp_path: Path, first: str, rest: str, words: str) -> None:
    assert run(tmp_path, "first", f"{first} steps = 3").returncode == 0
    done = go_on(tmp_path, f"{rest} steps = 7")
    assert done.returncode == 2
    assert words in done.stderr


def test_another_geometry_is_refused(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 3", "reference").returncode == 0
    done = go_on(tmp_path)
    assert done.returncode == 2
    assert "another geometry" in done.stderr


#: Numbers of 2 blocks with 8 corners and one joint of two contacts: 9 counts and 10 of the joint;
#: 16 of the corners, 12 of motions, 12 of velocities, 6 of strain rates, 6 of stresses, 2 reaches,
#: 12 of the march, 24 of the joint
MADE_UP = {
    "another number of joints": (lambda whole, number: whole.__setitem__(5, 2), "counts"),
    "joints below zero": (lambda whole, number: whole.__setitem__(5, -1), "counts"),
    "steps below zero": (lambda whole, number: whole.__setitem__(7, -5), "counts"),
    "three contacts": (lambda whole, number: whole.__setitem__(10, 3), "joints"),
    "no contact": (lambda whole, number: whole.__setitem__(10, 0), "joints"),
    "third side": (lambda whole, number: whole.__setitem__(11, 3), "joints"),
    "corner 0": (lambda whole, number: whole.__setitem__(13, 0), "joints"),
    "corner 9": (lambda whole, number: whole.__setitem__(13, 9), "joints"),
    "edge -7": (lambda whole, number: whole.__setitem__(15, -7), "joints"),
    "edge of its own block": (lambda whole, number: whole.__setitem__(15, whole[13]), "joints"),
    "neither open nor closed": (lambda whole, number: whole.__setitem__(17, 2), "joints"),
    "slides sideways": (lambda whole, number: whole.__setitem__(19, 7), "joints"),
    "weaker than nothing": (lambda whole, number: number.__setitem__(94, -1e-3), "joints"),
    "stronger than whole": (lambda whole, number: number.__setitem__(95, 1.5), "joints"),
    "other corners": (lambda whole, number: number.__setitem__(3, 0.5), "other blocks"),
    "a fixed block that moves": (lambda whole, number: number.__setitem__(16, 1.0), "fixed blocks"),
    "no number": (lambda whole, number: number.__setitem__(22, float("nan")), "none"),
    "infinite speed": (lambda whole, number: number.__setitem__(34, float("inf")), "none"),
    "beyond the moon": (lambda whole, number: number.__setitem__(22, 1e14), "motions"),
    "inside out": (lambda whole, number: number.__setitem__(25, -1.5), "strains"),
    "no area": (lambda whole, number: number.__setitem__(26, -1.0), "strains"),
    "sheared to nothing": (lambda whole, number: number.__setitem__(27, 2.0), "strains"),
    "faster than all": (lambda whole, number: number.__setitem__(34, 1e200), "motions"),
    "strains faster than all": (lambda whole, number: number.__setitem__(43, 1e200), "motions"),
    "accelerated by more than all": (lambda whole, number: number.__setitem__(49, -1e200), "motions"),
    "reach below zero": (lambda whole, number: number.__setitem__(59, -1.0), "search distances"),
    "endless reach": (lambda whole, number: number.__setitem__(59, 1e9), "search distances"),
    "time below zero": (lambda whole, number: number.__setitem__(60, -0.1), "time"),
    "two times": (lambda whole, number: number.__setitem__(62, 0.5), "time"),
    "no step": (lambda whole, number: number.__setitem__(61, 0.0), "step"),
    "endless energy": (lambda whole, number: number.__setitem__(64, 1e300), "energies"),
    "length below zero": (lambda whole, number: number.__setitem__(72, -1.0), "joints"),
    "shares of more than all": (lambda whole, number: number.__setitem__(75, 2.0), "joints"),
    "endless force": (lambda whole, number: number.__setitem__(85, 1e200), "joints"),
}


@pytest.mark.parametrize("case", MADE_UP)
def test_made_up_numbers_are_refused_with_a_reason(tmp_path: Path, case: str) -> None:
    assert run(tmp_path, "first", "steps = 5").returncode == 0
    edit, reason = MADE_UP[case]
    change(tmp_path, edit)
    done = go_on(tmp_path)
    assert done.returncode == 2, done.stderr
    line, = done.stderr.splitlines()
    assert line.startswith("first/case_1.restart:1: error: expected the end of a run of these blocks")
    assert reason in line.split(" got ")[1]
    assert not (tmp_path / "rest").exists()
    assert run_dda("check", "rest.nml", cwd=tmp_path).stderr == done.stderr


def test_numbers_that_are_not_changed_are_taken(tmp_path: Path) -> None:
    """The files that the tests above change are good before."""
    assert run(tmp_path, "first", "steps = 5").returncode == 0
    before = (tmp_path / "first" / "case_1.restart").read_bytes()
    change(tmp_path, lambda whole, number: None)
    assert (tmp_path / "first" / "case_1.restart").read_bytes() == before
    assert go_on(tmp_path).returncode == 0
    whole, number = numbers_of(before)
    assert (whole[:9], len(whole), len(number)) == ([2, 8, 6, 1, 1, 1, 0, 5, whole[8]], 22, 96)


def test_a_case_of_many_that_cannot_go_on_says_why(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 5").returncode == 0
    change(tmp_path, lambda whole, number: whole.__setitem__(12, 99))
    # so many that two jobs read the file at the same moment
    (tmp_path / "rest.nml").write_text(
        DECK.format(more="restart = 'first/case_1.restart', steps = 9", geometry="current")
        + "&sweep parameter = 'restitution', first = 0, last = 1, count = 300 /\n"
    )
    done = run_dda("run", "rest.nml", "--quiet", "--jobs", "2", cwd=tmp_path)
    assert done.returncode == 3
    assert {row["verdict"] for row in rows(tmp_path / "rest")} == {"undecided"}
    assert (tmp_path / "rest" / "log.txt").read_text().count("joints that these blocks") == 300


def test_an_earlier_file_stays_where_a_new_one_cannot_be_written(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 5").returncode == 0
    before = (tmp_path / "first" / "case_1.restart").read_bytes()
    (tmp_path / "first" / "case_1.restart.part").mkdir()
    assert run(tmp_path, "first", "steps = 9").returncode == 4
    assert (tmp_path / "first" / "case_1.restart").read_bytes() == before


def test_resume_notices_that_the_restart_file_has_changed(tmp_path: Path) -> None:
    assert run(tmp_path, "first", "steps = 5").returncode == 0
    assert go_on(tmp_path).returncode == 0
    words = ["run", "rest.nml", "--resume"]
    assert "1 of 1 cases are already computed" in run_dda(*words, cwd=tmp_path).stdout
    before = rows(tmp_path / "rest", "points.csv")
    change(tmp_path, lambda whole, number: number.__setitem__(34, 2.0 * number[34]))
    assert "nothing to resume" in run_dda(*words, cwd=tmp_path).stdout
    assert rows(tmp_path / "rest", "points.csv") != before
