"""Messages as a set: file, line, what is expected, what it got, what to do."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from dda_command import run_dda
from limerick_files import HAS_XML, INPUT, SQUARE
from test_bad_input import GOOD, assert_whole

def test_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    (tmp_path / "taken").write_text("a file, not a folder")
    done = run_dda("run", "deck.nml", "--out", "taken", cwd=tmp_path)
    assert done.returncode == 4
    assert assert_whole(done.stderr)["file"] == "taken/run.lock"


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [(["rnu", "deck.nml"], "run"), (["run", "deck.nml", "--quite"], "--quiet")],
)
def test_misspelt_command_is_shown_the_nearest(arguments: list[str], meant: str) -> None:
    assert f"did you mean '{meant}'?" in run_dda(*arguments).stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "--jobs", "2"], ["check", "--resume"], ["check", "--out", "x"],
        ["check", "--cases", "1"], ["cut", "--set", "arch%radius=1"], ["cut", "--resume"],
        ["export", "--jobs", "2"], ["export", "--cases", "1"],
    ],
    ids=" ".join,
)
def test_option_of_another_subcommand_is_refused(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    verb, *options = arguments
    done = run_dda(verb, "deck.nml", *options, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr == (
        f"dda:3: error: expected an option of dda {verb}, got {options[0]}, which dda run takes; " "remove it\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["deck.nml"]


#: A square in DDAML; what stands before the end of its geometry
JOINTS = "<Joint type='1'>0 0 1 0</Joint><Joint type='1'>1 0 1 1</Joint>"
JOINTS += "<Joint type='1'>1 1 0 1</Joint><Joint type='1'>0 1 0 0</Joint>"
SQUARE_XML = f"<DDA><Geometry><Jointlist>{JOINTS}</Jointlist></Geometry></DDA>"
#: What is wrong, in both forms; the unit tests of the readers have many more
LINES = (SQUARE.replace("0.01", "0.6", 1), SQUARE_XML[:-2])
ANALYSES = ("2 5 1 1 0.01 0.01\n1 1 1 0.2 0 0 0 0 0 0 0 0 0\n30 0 0\n",
            (INPUT / "terrace_ddaml.ana").read_text().replace("Unitmass", "Mass"))


@pytest.mark.parametrize("text", LINES if HAS_XML else LINES[:1])
def test_message_about_lines_is_whole(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.geo").write_text(text)
    assert assert_whole(run_dda("cut", "a.geo", cwd=tmp_path).stderr)["file"] == "a.geo"


@pytest.mark.parametrize("text", ANALYSES if HAS_XML else ANALYSES[:1])
def test_message_about_an_analysis_is_whole(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.ana").write_text(text)
    (tmp_path / "a.geo").write_text((INPUT / "terrace.geo").read_text())
    (tmp_path / "a.nml").write_text("&scene kind='lines', geometry='a.geo', analysis='a.ana' /\n")
    stderr = run_dda("check", "a.nml", cwd=tmp_path).stderr
    errors = [line for line in stderr.splitlines(keepends=True) if " warning: " not in line]
    assert_whole("".join(errors))


def test_deck_without_its_ending_is_shown_the_ending(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    assert assert_whole(run_dda("check", "deck", cwd=tmp_path).stderr)["advice"] == "write deck.nml"


@pytest.mark.parametrize("name", ["deck ", " deck.nml", "deck.nml  ", "a b.nml"])
def test_blanks_belong_to_a_name(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(GOOD)
    assert run_dda("check", name, cwd=tmp_path).returncode == 0
    assert run_dda("check", name + " ", cwd=tmp_path).returncode == 2
    done = run_dda("run", name, "--out", "out ", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out " / "results.csv").read_text().count("\n") == 2


def test_deck_may_come_through_a_pipe(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    done = subprocess.run(
        f"cat deck.nml | '{os.environ['DDA']}' check /dev/stdin", cwd=tmp_path, shell=True, text=True,
        capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
