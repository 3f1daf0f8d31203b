"""Messages as a set: file, line, what was wanted, what was found, what to do."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest
from dda_command import run_dda
from test_bad_input import COMMAND_LINES, GOOD, MISTAKES, SETTINGS

#: What was wanted or is wrong; what was found; after the semicolon, what to do, as an order
MESSAGE = re.compile(
    r"(?P<file>[^:\n]+):(?P<line>\d+): error: (?P<fault>[^\n]+?); (?P<advice>[^;\n]+)\n"
)
FAULT = re.compile(
    r"want(s|ed)\b.+\bfound\b|unknown|there is no such file|is repeated|exclude one another"
    r"|, but |is no key|cannot be|is swept|is both|has no item|wants|is a list|is not yet there"
)
ORDER = re.compile(
    r"(change|check|choose|close|copy|correct|give|join|leave|make|move|name|number|put|raise"
    r"|remove|rename|save|shorten|sort|split|sweep|write|add)\b"
    r"|'dda help( \w+)?' (lists|says|shows)"
)


def assert_whole(text: str) -> re.Match[str]:
    """Check that a message says all it has to, and take it apart."""
    parts = MESSAGE.fullmatch(text)
    assert parts, text
    assert FAULT.search(parts["fault"]), text
    assert ORDER.match(parts["advice"]), text
    return parts


@pytest.mark.parametrize("mistake", MISTAKES)
def test_message_about_a_deck_is_whole(tmp_path: Path, mistake: str) -> None:
    (tmp_path / "deck.nml").write_text(MISTAKES[mistake][1])
    assert_whole(run_dda("check", "deck.nml", cwd=tmp_path).stderr)


@pytest.mark.parametrize("setting", SETTINGS)
def test_message_about_a_setting_is_whole(tmp_path: Path, setting: str) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    done = run_dda("check", "deck.nml", "--set", SETTINGS[setting][0], cwd=tmp_path)
    assert_whole(done.stderr)


@pytest.mark.parametrize("arguments", COMMAND_LINES.values(), ids=COMMAND_LINES)
def test_message_about_a_command_line_is_whole(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    parts = assert_whole(run_dda(*arguments, cwd=tmp_path).stderr)
    assert parts["file"] == "dda"
    assert 1 <= int(parts["line"]) <= len(arguments)


FILES = {
    "missing": (None, "there is no such file"),
    "empty": (b"", "empty"),
    "binary": (bytes(range(256)), "control character"),
}


@pytest.mark.parametrize("kind", FILES)
def test_message_about_a_file_is_whole(tmp_path: Path, kind: str) -> None:
    content, words = FILES[kind]
    if content is not None:
        (tmp_path / "deck.nml").write_bytes(content)
    assert words in assert_whole(run_dda("check", "deck.nml", cwd=tmp_path).stderr)["fault"]


def test_message_about_a_folder_is_whole(tmp_path: Path) -> None:
    assert "folder" in assert_whole(run_dda("check", ".", cwd=tmp_path).stderr)["fault"]


def test_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    (tmp_path / "taken").write_text("a file, not a folder")
    done = run_dda("run", "deck.nml", "--out", "taken", cwd=tmp_path)
    assert done.returncode == 4
    assert assert_whole(done.stderr)["file"] == "taken/results.csv"


MISSPELT = {
    "&arhc /\n": "&arch",
    "&serach /\n": "&search",
    "&arch vousoirs = 36 /\n": "voussoirs",
    "&joint fricton = 30 /\n": "friction_deg",
    "&analysis max_displacement = 0.1 /\n": "max_displacement_ratio",
    "&search parameter = 'thikness' /\n": "thickness_ratio",
    "&arch springing = 'no_slip' /\n": "'no-slip'",
    "&material plane = 'stres' /\n": "'stress'",
}


@pytest.mark.parametrize("text", MISSPELT)
def test_misspelt_name_is_told_the_nearest(tmp_path: Path, text: str) -> None:
    (tmp_path / "deck.nml").write_text(text)
    fault = assert_whole(run_dda("check", "deck.nml", cwd=tmp_path).stderr)["fault"]
    near = re.search(r"(?:nearest known \w+ is|did you mean) (.+?)(?:\?|$)", fault)
    assert near and near[1] == MISSPELT[text]


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [(["rnu", "deck.nml"], "run"), (["run", "deck.nml", "--quite"], "--quiet")],
)
def test_misspelt_command_is_told_the_nearest(arguments: list[str], meant: str) -> None:
    assert f"did you mean '{meant}'?" in run_dda(*arguments).stderr


def test_deck_without_its_ending_is_told_the_ending(tmp_path: Path) -> None:
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
        f"cat deck.nml | '{os.environ['DDA']}' check /dev/stdin",
        cwd=tmp_path,
        shell=True,
        text=True,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
