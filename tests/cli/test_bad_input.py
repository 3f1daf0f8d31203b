"""Bad input: one line FILE:LINE: error: ..., status 2, nothing computed, other decks run."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from dda_command import run_dda

GOOD = "&arch thickness_ratio = 0.12 /\n"

#: What is expected or wrong; what it got; after the semicolon, what to do, as an order
MESSAGE = re.compile(r"(?P<file>[^:\n]+):(?P<line>\d+): error: (?P<fault>[^\n]+?); (?P<advice>[^;\n]+)\n")
FAULT = re.compile(
    r"(expected|must \w+|needs)\b.+\bgot\b|needs|unknown|there is no such file|is repeated"
    r"|exclude one another|, but |is no key|cannot be|is swept|is both|has no item|is a list|is not yet there"
    r"|is empty|is blank|is not well-formed"
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


#: Name: line of the mistake, deck, what the message must speak of. What the unit tests of decks see
#: refused with its advice is not repeated
MISTAKES = {
    "text-before-the-first-group": (2, "\nhello\n&arch /\n", "hello"),
    "unknown-key": (3, "&arch\n radius = 10.0\n radios = 5.0\n/\n", "radios"),
    "group-not-closed-before-the-next": (1, "&arch\n radius = 5\n&joint /\n", "arch"),
    "quote-not-closed": (2, "&scene\n title = 'no end\n/\n", "quote"),
    "control-character": (2, "&arch\n radius = 5\x07 /\n", "character"),
    "nan-in-a-list": (2, "&arch\n joints_deg = 0, NaN, 90\n/\n", "NaN"),
    "linked-sweep-of-another-length": (
        2, "&sweep parameter='radius', values=1, 2 /\n&sweep parameter='young', values=1e9, linked=.true. /\n", "2"),
    "too-many-cases": (
        2,
        "&sweep parameter='radius', first=1, last=2, count=1000 /\n"
        "&sweep parameter='young', first=1e9, last=2e9, count=1000 /\n",
        "100000",
    ),
}


def wrong_values(key: dict[str, Any]) -> Iterator[str]:
    """Values that a key of `dda help keys --json` does not take: of other kinds, and just beyond its range."""
    kind = key["kind"]
    if kind in ("word", "words"):
        yield from ("nonsense", "1", *(["'nonsense'"] if "words" in key else []))
    elif kind == "flag":
        yield from ("1", "'maybe'")
    elif kind != "text":
        yield from ("ten", "'5'", ".true.", "5m", "NaN", "-Inf", "1e400")
        step = 1.0 if kind == "whole" else 1e-6
        yield from (f"{key[end] + way * step * max(abs(key[end]), 1.0):.10g}"
                    for end, way in (("from", -1), ("to", 1)) if abs(key.get(end, 1e300)) < 1e9)
        yield from (f"{key[end]:.10g}" for end in ("above", "below") if end in key)
    if kind == "whole":
        yield from ("3.5", "99999999999")


def keys() -> Iterator[tuple[str, dict[str, Any]]]:
    """Groups and keys of a deck."""
    for group in json.loads(run_dda("help", "keys", "--json").stdout)["groups"]:
        yield from ((group["name"], key) for key in group["keys"])


@pytest.mark.parametrize(("group", "key"), keys(), ids=lambda value: value if isinstance(value, str) else value["name"])
def test_values_that_a_key_does_not_take_are_refused(tmp_path: Path, group: str, key: dict[str, Any]) -> None:
    for value in wrong_values(key):
        (tmp_path / "deck.nml").write_text(f"&{group}\n {key['name']} = {value}\n/\n")
        done = run_dda("check", "deck.nml", cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, ""), value
        parts = assert_whole(done.stderr)
        assert (parts["file"], parts["line"]) == ("deck.nml", "2") and key["name"] in parts["fault"], done.stderr


def assert_refused(folder: Path, name: str, line: int, wanted: str, *options: str) -> None:
    """Check that run and check refuse a deck with one line and leave nothing behind."""
    before = sorted(folder.iterdir())
    for verb in ("run", "check"):
        done = run_dda(verb, name, *options, cwd=folder)
        assert done.returncode == 2, done.stderr
        assert done.stdout == ""
        parts = assert_whole(done.stderr)
        assert (parts["file"], parts["line"]) == (name, str(line))
        assert wanted.lower() in done.stderr.split("error: ", 1)[1].lower()
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("mistake", MISTAKES)
def test_deck_is_refused_with_file_and_line(tmp_path: Path, mistake: str) -> None:
    line, text, wanted = MISTAKES[mistake]
    (tmp_path / "deck.nml").write_text(text)
    assert_refused(tmp_path, "deck.nml", line, wanted)


@pytest.mark.parametrize("line_end", ["\r\n", "\r"], ids=["windows", "old-mac"])
def test_lines_are_counted_whatever_their_ends(tmp_path: Path, line_end: str) -> None:
    text = line_end.join(["! arches", "&arch", " radius = -1", "/", ""])
    (tmp_path / "deck.nml").write_bytes(text.encode())
    assert_refused(tmp_path, "deck.nml", 3, "radius")


def test_folder_in_place_of_a_deck_is_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.nml").mkdir()
    assert_refused(tmp_path, "folder.nml", 1, "folder")


@pytest.mark.parametrize(("content", "words"), [(b"", "empty"), (bytes(range(256)) * 10, "control character")])
def test_files_without_text_are_refused(tmp_path: Path, content: bytes, words: str) -> None:
    (tmp_path / "deck.nml").write_bytes(content)
    assert_refused(tmp_path, "deck.nml", 1, words)


def test_link_to_nowhere_is_refused(tmp_path: Path) -> None:
    (tmp_path / "link.nml").symlink_to("nowhere.nml")
    assert_refused(tmp_path, "link.nml", 1, "no such file")


def test_quiet_does_not_silence_errors(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text("&arch radius = -1 /\n")
    assert_refused(tmp_path, "deck.nml", 1, "radius", "--quiet")


def test_other_decks_still_run(tmp_path: Path) -> None:
    (tmp_path / "first.nml").write_text(GOOD)
    (tmp_path / "bad.nml").write_text("&arch\n thickness_ratio = 2 /\n")
    (tmp_path / "last.nml").write_text(GOOD)
    decks = ["first.nml", "bad.nml", "missing.nml", "last.nml"]
    done = run_dda("run", *decks, "--out", "results", cwd=tmp_path)
    assert done.returncode == 2
    lines = done.stderr.splitlines()
    assert [line.split(" ")[0] for line in lines] == ["bad.nml:2:", "missing.nml:1:"]
    assert sorted(path.name for path in (tmp_path / "results").iterdir()) == ["first", "last"]
    assert (tmp_path / "results" / "last" / "results.csv").read_text().count("\n") == 2


def test_bad_deck_keeps_no_deck_of_the_same_name_from_running(tmp_path: Path) -> None:
    for name, text in (("bad", "&arch radius = -1 /\n"), ("good", GOOD)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "deck.nml").write_text(text)
    done = run_dda("run", "bad/deck.nml", "good/deck.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.splitlines()[0].startswith("bad/deck.nml:1: error: ")
    assert (tmp_path / "deck" / "results.csv").read_text().count("stable") == 1


def test_two_good_decks_of_the_same_name_do_not_share_a_folder(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "deck.nml").write_text(GOOD)
    done = run_dda("run", "one/deck.nml", "two/deck.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("two/deck.nml:1: error: ")


@pytest.mark.parametrize(("value", "wanted"), [("arch%radius", "arch%radius"), ("arch%joints_deg=10,50,90", "0")])
def test_errors_of_set_name_set(tmp_path: Path, value: str, wanted: str) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    for verb in ("run", "check"):
        done = run_dda(verb, "deck.nml", "--set", value, cwd=tmp_path)
        assert done.returncode == 2
        assert done.stdout == ""
        assert assert_whole(done.stderr)["file"] == "--set"
        assert wanted.lower() in done.stderr.lower()
    assert not (tmp_path / "deck").exists()


@pytest.mark.parametrize("cases", ["2", "1--1", "x", "1, 1", "1.0", "1-1-1"])
def test_errors_of_cases_name_cases(tmp_path: Path, cases: str) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    done = run_dda("run", "deck.nml", "--cases", cases, cwd=tmp_path)
    assert done.returncode == 2
    assert re.fullmatch(r"--cases:1: error: expected cases from 1 to 1, got '.*'; write them like 1-4,7\n", done.stderr)
    assert not (tmp_path / "deck").exists()


COMMAND_LINES = {
    "no-deck": ["run"],
    "only-options": ["run", "--quiet"],
    "no-deck-to-check": ["check"],
    "unknown-subcommand": ["compute", "deck.nml"],
    "unknown-option": ["run", "deck.nml", "--fast"],
    "out-without-folder": ["run", "deck.nml", "--out"],
    "empty-out": ["run", "deck.nml", "--out", ""],
    "set-without-value": ["run", "deck.nml", "--set"],
    "jobs-without-number": ["run", "deck.nml", "--jobs"],
    "jobs-0": ["run", "deck.nml", "--jobs", "0"],
    "jobs-negative": ["run", "deck.nml", "--jobs", "-2"],
    "jobs-no-number": ["run", "deck.nml", "--jobs", "all"],
    "jobs-fraction": ["run", "deck.nml", "--jobs", "1.5"],
    "jobs-huge": ["run", "deck.nml", "--jobs", "99999999999"],
    "cases-without-numbers": ["run", "deck.nml", "--cases"],
    "cases-empty": ["run", "deck.nml", "--cases", ""],
    "empty-name": ["run", ""],
    "unknown-help": ["help", "me"],
}


@pytest.mark.parametrize("arguments", COMMAND_LINES.values(), ids=COMMAND_LINES)
def test_bad_command_line_is_refused(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    done = run_dda(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    parts = assert_whole(done.stderr)
    assert parts["file"] == "dda" and 1 <= int(parts["line"]) <= len(arguments)
    assert done.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["deck.nml"]
