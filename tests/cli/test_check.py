"""dda check: reads everything, prints the scene plan, computes and writes nothing."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import run_dda
from limerick_files import INPUT

PAPER = Path(__file__).parents[2] / "input" / "paper"


def check(folder: Path, text: str, *options: str) -> str:
    """Output of dda check for a valid deck, with blanks and line ends as single blanks."""
    (folder / "deck.nml").write_text(text)
    done = run_dda("check", "deck.nml", *options, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert [path.name for path in folder.iterdir()] == ["deck.nml"]
    return " ".join(done.stdout.split())


def test_plan_names_the_deck_and_its_title(tmp_path: Path) -> None:
    plan = check(tmp_path, "&scene title = 'One, two; \"three\"' /\n")
    assert plan.startswith("deck.nml: One, two; \"three\" ")


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("&arch /\n", ["cases 1", "blocks 36", "joints 37"]),
        ("&arch voussoirs = 7 /\n", ["blocks 7", "joints 8"]),
        ("&arch joints_deg = 0, 54.5, 90 /\n", ["blocks 4", "joints 5"]),
        ("&search /\n", ["search thickness_ratio"]),
        ("&search parameter = 'friction_deg' /\n", ["search friction_deg"]),
        ("&search /\n", ["unknowns 3 per block, 108 in all: rigid", "joint forces of the run itself"]),
        ("&output joints = .false. /\n", ["unknowns 3 per block", "none: output%joints is .false."]),
        ("&search /\n", ["equations chain: each block", "half model (vertical loads)"]),
        (
            "&search /\n&load horizontal_coefficient = 0.01 /\n",
            ["each block touches only its two neighbours velocities"],
        ),
        ("&arch /\n", ["unknowns 6 per block, 216 in all: deformable: strain distributes joint forces"]),
        ("&analysis unknowns = 6 /\n", ["unknowns 6 per block, 216 in all: set by analysis%unknowns"]),
        ("&analysis geometry = 'current' /\n", ["6 per block, 216 in all: deformable: strain moves the corners"]),
        ("&analysis mode = 'dynamic' /\n", ["6 per block", "deformable: moving blocks vibrate", "kept"]),
        ("&arch /\n", ["points none", "other output vtu", "strength none"]),
        ("&output energy = .true., vtu = .false., condition = .true. /\n", ["other output energy, condition"]),
        ("&output vtu = .false. /\n", ["other output none"]),
        ("&joint cohesion = 1e3 /\n", ["6 per block", "which joint breaks first"]),
        ("&analysis collapse_displacement = 0.1 /\n", ["6 per block", "displacement that means"]),
        ("&arch thickness_ratio = 0.1 /\n", ["search none"]),
        (
            "&sweep parameter='voussoirs', values=6, 12, 18 /\n"
            "&sweep parameter='radius', first=1, last=2, count=5 /\n",
            ["cases 15", "swept voussoirs radius", "blocks 6"],
        ),
        (
            "&sweep parameter='half_angle_deg', values=60, 90 /\n"
            "&sweep parameter='voussoirs', values=12, 18, linked=.true. /\n",
            ["cases 2", "swept half_angle_deg voussoirs", "blocks 12"],
        ),
    ],
)
def test_plan_says_what_would_be_computed(tmp_path: Path, text: str, wanted: list[str]) -> None:
    plan = check(tmp_path, text)
    assert [words for words in wanted if words not in plan] == []


def test_plan_of_one_hundred_thousand_cases_is_quick(tmp_path: Path) -> None:
    text = "&sweep parameter = 'radius', first = 1, last = 2, count = 100000 /\n"
    assert "cases 100000" in check(tmp_path, text)


def test_more_cases_may_be_allowed(tmp_path: Path) -> None:
    text = "&sweep parameter = 'radius', first = 1, last = 2, count = 100001 /\n"
    assert "cases 100001" in check(tmp_path, text + "&output max_cases = 200000 /\n")


def test_set_changes_the_plan(tmp_path: Path) -> None:
    assert "blocks 9" in check(tmp_path, "&arch /\n", "--set", "arch%voussoirs=9")


def test_quiet_check_prints_nothing(tmp_path: Path) -> None:
    assert check(tmp_path, "&arch /\n", "--quiet") == ""


def test_every_deck_is_checked(tmp_path: Path) -> None:
    (tmp_path / "good.nml").write_text("&arch /\n")
    (tmp_path / "bad.nml").write_text("&arch\n radius = -1 /\n")
    done = run_dda("check", "bad.nml", "good.nml", "missing.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert "good.nml:" in done.stdout
    lines = done.stderr.splitlines()
    assert [line.split(" ")[0] for line in lines] == ["bad.nml:2:", "missing.nml:1:"]


@pytest.mark.parametrize(("table", "arches"), [("table1", 8), ("table2", 20), ("table3", 15), ("table4", 10)])
def test_decks_of_the_paper_are_good(tmp_path: Path, table: str, arches: int) -> None:
    done = run_dda("check", PAPER / f"{table}.nml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    words = done.stdout.split()
    assert int(words[words.index("cases") + 1]) % arches == 0
    assert not list(tmp_path.iterdir())


RECORDED = {
    "arch": "&arch voussoirs = 4 /\n&sweep parameter = 'radius', values = 1, 2 /\n",
    "blocks": "&scene kind = 'blocks', geometry = 'x.blocks', title = 'Ein Stein' /\n"
              "&analysis geometry = 'current' / &output frames = 2 /\n",
    "lines": "&scene kind = 'lines', geometry = 'x.geo' / &analysis geometry = 'current' /\n",
}


@pytest.mark.parametrize("kind", RECORDED)
def test_record_is_what_a_run_writes_down(tmp_path: Path, kind: str) -> None:
    """Tables with their first lines, and deck.record to the last byte."""
    (tmp_path / "x.blocks").write_text("block fixed\n0 0\n1 0\n1 1\n0 1\nblock\n0 1\n1 1\n1 2\n0 2\nmeasure 0.5 2\n")
    (tmp_path / "x.geo").write_text((INPUT / "terrace.geo").read_text())
    (tmp_path / "d.nml").write_text(RECORDED[kind])
    setting = ["--set", "joint%friction_deg=35"]
    shown = run_dda("check", "d.nml", "--record", *setting, cwd=tmp_path)
    assert shown.returncode == 0, shown.stderr
    only = run_dda("check", "d.nml", "--record", "--quiet", *setting, cwd=tmp_path).stdout
    assert shown.stdout == run_dda("check", "d.nml", *setting, cwd=tmp_path).stdout + only
    assert run_dda("run", "d.nml", "--quiet", *setting, cwd=tmp_path).returncode in (0, 3)
    tables, _, record = only.partition("deck.record:\n")
    assert record == (tmp_path / "d" / "deck.record").read_text()
    assert "joint%friction_deg\n  35\n" in record
    words = [line.split(maxsplit=1) for line in tables.splitlines()[1:]]
    assert tables.startswith("tables:\n")
    assert {name for name, _ in words} == {
        path.name
        for path in (tmp_path / "d").iterdir()
        if path.suffix in (".csv", ".txt") or path.name == "sizes.record"
    }
    for name, header in words:
        assert (tmp_path / "d" / name).read_text().splitlines()[0] == header
