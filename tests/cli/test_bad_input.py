"""Bad input: one line FILE:LINE: error: ..., status 2, nothing computed, other decks run."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from dda_command import run_dda

GOOD = "&arch thickness_ratio = 0.12 /\n"

# name: (line of the mistake, deck, what the message must speak of)
GRAMMAR = {
    "only-blank-lines": (1, "\n\n\n", "group"),
    "only-a-comment": (1, "! nothing here\n", "group"),
    "text-before-the-first-group": (2, "\nhello\n&arch /\n", "hello"),
    "text-between-groups": (2, "&arch /\nhello\n&joint /\n", "hello"),
    "text-after-the-last-group": (3, "&arch /\n&joint /\nhello", "hello"),
    "text-behind-a-group": (1, "&arch / hello\n", "hello"),
    "unknown-group": (3, "! arches\n&scene /\n&arhc /\n", "arhc"),
    "repeated-group": (4, "&arch\n/\n\n&arch /\n", "arch"),
    "repeated-search": (2, "&search /\n&search /\n", "search"),
    "unknown-key": (3, "&arch\n radius = 10.0\n radios = 5.0\n/\n", "radios"),
    "key-of-another-group": (2, "&arch\n title = 'x' /\n", "title"),
    "repeated-key": (3, "&arch\n radius = 5\n radius = 6\n/\n", "radius"),
    "repeated-key-with-the-same-value": (3, "&arch\n radius = 5\n radius = 5\n/\n", "radius"),
    "repeated-key-in-other-letters": (3, "&arch\n radius = 5\n RADIUS = 5\n/\n", "radius"),
    "key-without-equals": (2, "&arch\n radius\n/\n", "radius"),
    "key-without-value": (2, "&arch\n radius =\n/\n", "radius"),
    "value-without-key": (2, "&arch\n = 5\n/\n", "="),
    "group-not-closed-at-the-end": (1, "&arch\n radius = 5\n", "arch"),
    "group-not-closed-before-the-next": (1, "&arch\n radius = 5\n&joint /\n", "arch"),
    "ampersand-without-name": (2, "&arch /\n& /\n", "&"),
    "quote-not-closed": (2, "&scene\n title = 'no end\n/\n", "quote"),
    "control-character": (2, "&arch\n radius = 5\x07 /\n", "character"),
    "two-values-for-one": (2, "&arch\n radius = 5, 6\n/\n", "radius"),
    "decimal-comma": (2, "&arch\n radius = 0,12\n/\n", "radius"),
    "empty-item-of-a-list": (2, "&arch\n joints_deg = 0, , 90\n/\n", "joints_deg"),
}

TYPES = {
    "word-for-a-number": (2, "&arch\n radius = ten\n/\n", "ten"),
    "quoted-number": (2, "&arch\n radius = '5'\n/\n", "5"),
    "flag-for-a-number": (2, "&arch\n radius = .true.\n/\n", "radius"),
    "number-with-a-unit": (2, "&arch\n radius = 5m\n/\n", "5m"),
    "fraction-for-a-count": (2, "&arch\n voussoirs = 3.5\n/\n", "3.5"),
    "huge-count": (2, "&arch\n voussoirs = 99999999999\n/\n", "99999999999"),
    "word-without-quotes": (2, "&arch\n springing = frictional\n/\n", "quotes"),
    "unknown-word": (2, "&arch\n springing = 'glued'\n/\n", "glued"),
    "number-for-a-word": (2, "&material\n plane = 1\n/\n", "plane"),
    "number-for-a-flag": (2, "&output\n joints = 1\n/\n", "joints"),
    "word-for-a-flag": (2, "&output\n joints = 'maybe'\n/\n", "maybe"),
    "unknown-mode": (2, "&analysis\n mode = 'quick'\n/\n", "quick"),
    "unknown-kind": (2, "&scene\n kind = 'bridge'\n/\n", "bridge"),
    "nan": (3, "&arch\n voussoirs = 36\n radius = NaN\n/\n", "NaN"),
    "infinity": (3, "&arch\n voussoirs = 36\n radius = Inf\n/\n", "Inf"),
    "minus-infinity": (2, "&load\n horizontal_coefficient = -Infinity\n/\n", "Infinity"),
    "overflow": (2, "&arch\n radius = 1e400\n/\n", "1e400"),
    "nan-in-a-list": (2, "&arch\n joints_deg = 0, NaN, 90\n/\n", "NaN"),
    "nan-in-a-sweep": (3, "&sweep\n parameter = 'radius'\n values = 1, NaN\n/\n", "NaN"),
}

# group, key and values that are refused
RANGES = [
    ("arch", "radius", ["0", "-10", "1e300"]),
    ("arch", "thickness_ratio", ["0", "-0.1", "2", "2.0", "3"]),
    ("arch", "half_angle_deg", ["0", "-90", "180", "200"]),
    ("arch", "voussoirs", ["0", "-4"]),
    ("arch", "facet_deg", ["0", "-1"]),
    ("arch", "joints_deg", ["0", "0, 50, 180", "-10, 0, 90", "0, -50, 90"]),
    ("material", "density", ["0", "-2240"]),
    ("material", "unit_weight", ["0", "-1"]),
    ("material", "young", ["0", "-5e9"]),
    ("material", "poisson", ["0.5", "0.7", "-1"]),
    ("joint", "friction_deg", ["-1", "90.5", "180"]),
    ("joint", "cohesion", ["-1"]),
    ("joint", "tension", ["-1"]),
    ("load", "gravity", ["-9.81", "0"]),
    ("analysis", "steps", ["0", "-1"]),
    ("analysis", "max_displacement_ratio", ["0", "-0.1"]),
    ("analysis", "time_step", ["0", "-1"]),
    ("analysis", "penalty_ratio", ["0", "-1"]),
    ("analysis", "collapse_displacement", ["0", "-1"]),
    ("analysis", "unknowns", ["0", "4", "5", "7"]),
    ("search", "tolerance", ["0", "-1e-8", "1"]),
]

JOINTS = {
    "not-starting-at-0": (2, "&arch\n joints_deg = 5, 50, 90\n/\n", "0"),
    "not-increasing": (2, "&arch\n joints_deg = 0, 60, 50\n/\n", "increasing"),
    "twice-the-same": (2, "&arch\n joints_deg = 0, 50, 50, 90\n/\n", "increasing"),
    "with-voussoirs": (3, "&arch\n joints_deg = 0, 50, 90\n voussoirs = 4\n/\n", "voussoirs"),
    "with-another-half-angle": (3, "&arch\n joints_deg = 0, 50, 90\n half_angle_deg = 80\n/\n", "half_angle_deg"),
    "after-another-half-angle": (3, "&arch\n half_angle_deg = 80\n joints_deg = 0, 50, 90\n/\n", "half_angle_deg"),
}

SWEEPS_AND_SEARCHES = {
    "search-of-nothing-known": (2, "&search\n parameter = 'thikness_ratio'\n/\n", "thikness_ratio"),
    "search-of-a-count": (2, "&search\n parameter = 'voussoirs'\n/\n", "voussoirs"),
    "search-of-a-word": (2, "&search\n parameter = 'springing'\n/\n", "springing"),
    "search-without-ends": (2, "&search\n parameter = 'radius'\n/\n", "low"),
    "search-low-above-high": (3, "&search\n low = 0.5\n high = 0.2\n/\n", "0.5"),
    "search-low-equals-high": (3, "&search\n low = 0.2\n high = 0.2\n/\n", "0.2"),
    "search-low-negative": (2, "&search\n low = -0.1\n/\n", "-0.1"),
    "search-high-above-2": (2, "&search\n high = 2.5\n/\n", "2.5"),
    "search-of-a-missing-joint": (
        3, "&arch\n joints_deg = 0, 50, 90 /\n&search parameter='joints_deg(9)', low=1, high=5 /\n", "joints_deg"),
    "sweep-without-parameter": (1, "&sweep\n values = 1, 2\n/\n", "parameter"),
    "sweep-of-nothing-known": (2, "&sweep\n parameter = 'raduis'\n values = 1\n/\n", "raduis"),
    "sweep-without-values": (1, "&sweep\n parameter = 'radius'\n/\n", "values"),
    "sweep-with-values-and-texts": (1, "&sweep\n parameter = 'radius'\n values = 1\n texts = 'a'\n/\n", "values"),
    "sweep-first-without-count": (1, "&sweep\n parameter = 'radius'\n first = 1\n last = 2\n/\n", "count"),
    "sweep-count-0": (5, "&sweep\n parameter = 'radius'\n first = 1\n last = 2\n count = 0\n/\n", "count"),
    "sweep-value-out-of-range": (3, "&sweep\n parameter = 'thickness_ratio'\n values = 0.1, 2.0\n/\n", "2"),
    "sweep-fraction-for-a-count": (3, "&sweep\n parameter = 'voussoirs'\n values = 12, 12.5\n/\n", "12.5"),
    "sweep-words-for-numbers": (3, "&sweep\n parameter = 'radius'\n texts = 'a'\n/\n", "radius"),
    "sweep-numbers-for-words": (3, "&sweep\n parameter = 'springing'\n values = 1\n/\n", "texts"),
    "sweep-unknown-word": (3, "&sweep\n parameter = 'springing'\n texts = 'glued'\n/\n", "glued"),
    "sweep-same-parameter-twice": (
        2, "&sweep parameter='radius', values=1 /\n&sweep parameter='radius', values=2 /\n", "radius"),
    "sweep-of-what-is-searched": (
        2, "&search /\n&sweep parameter='thickness_ratio', values=0.1, 0.2 /\n", "thickness_ratio"),
    "sweep-of-a-joint-not-there": (
        2, "&arch joints_deg = 0, 50, 90 /\n&sweep parameter='joints_deg(4)', values=60 /\n", "joints_deg"),
    "sweep-of-joints-out-of-order": (
        2, "&arch joints_deg = 0, 50, 90 /\n&sweep parameter='joints_deg(2)', values=60, 95 /\n", "95"),
    "first-sweep-linked": (1, "&sweep parameter='radius', values=1, 2, linked=.true. /\n", "linked"),
    "linked-sweep-of-another-length": (
        2, "&sweep parameter='radius', values=1, 2 /\n" "&sweep parameter='young', values=1e9, linked=.true. /\n", "2"),
    "nine-sweeps": (
        9,
        "".join(
            f"&sweep parameter='{key}', values=0.5 /\n"
            for key in ("radius thickness_ratio facet_deg density young cohesion tension gravity time_step").split()
        ),
        "8",
    ),
    "dynamic-associated": (
        1, "&analysis mode='dynamic', flow='associated', steps=10 /\n", "needs mode = 'static', got 'dynamic'"),
    "limerick-associated": (
        1, "&analysis mode='limerick', flow='associated' /\n", "needs mode = 'static', got 'limerick'"),
    "too-many-cases": (
        2,
        "&sweep parameter='radius', first=1, last=2, count=1000 /\n"
        "&sweep parameter='young', first=1e9, last=2e9, count=1000 /\n",
        "100000",
    ),
}

RANGED = {
    f"{group}-{key}={value}": (2, f"&{group}\n {key} = {value}\n/\n", key)
    for group, key, values in RANGES
    for value in values
}
MISTAKES = GRAMMAR | TYPES | RANGED | JOINTS | SWEEPS_AND_SEARCHES


def assert_refused(folder: Path, name: str, line: int, wanted: str, *options: str) -> None:
    """Check that run and check refuse a deck with one line and leave nothing behind.

    Parameters
    ----------
    folder
        Where the program runs
    name
        Name of the deck
    line
        Line that the message must name
    wanted
        What the message must speak of
    options
        Options beside the name
    """
    before = sorted(folder.iterdir())
    for verb in ("run", "check"):
        done = run_dda(verb, name, *options, cwd=folder)
        assert done.returncode == 2, done.stderr
        assert done.stdout == ""
        assert done.stderr.startswith(f"{name}:{line}: error: ")
        assert done.stderr.count("\n") == 1
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


def test_missing_file_is_refused(tmp_path: Path) -> None:
    assert_refused(tmp_path, "missing.nml", 1, "no such file")


def test_folder_in_place_of_a_deck_is_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.nml").mkdir()
    assert_refused(tmp_path, "folder.nml", 1, "folder")


def test_empty_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.nml").write_text("")
    assert_refused(tmp_path, "empty.nml", 1, "empty")


def test_binary_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "binary.nml").write_bytes(bytes(range(256)) * 10)
    assert_refused(tmp_path, "binary.nml", 1, "character")


def test_link_to_nowhere_is_refused(tmp_path: Path) -> None:
    (tmp_path / "link.nml").symlink_to("nowhere.nml")
    assert_refused(tmp_path, "link.nml", 1, "no such file")


def test_quiet_does_not_silence_errors(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text("&arch radius = -1 /\n")
    assert_refused(tmp_path, "deck.nml", 1, "radius", "--quiet")


def test_gravity_may_be_zero_where_the_weight_is_given(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text("&load gravity = 0 /\n&material unit_weight = 22e3 /\n")
    assert run_dda("check", "deck.nml", cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("half_angle", ["90", "90.0", "9e1"])
def test_half_angle_may_repeat_the_last_joint(tmp_path: Path, half_angle: str) -> None:
    (tmp_path / "deck.nml").write_text(f"&arch joints_deg = 0, 50, 90, half_angle_deg = {half_angle} /\n")
    assert run_dda("check", "deck.nml", cwd=tmp_path).returncode == 0


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


def test_only_good_cases_are_computed_or_none(tmp_path: Path) -> None:
    text = "&sweep\n parameter = 'half_angle_deg'\n values = 45, 90, 180\n/\n"
    (tmp_path / "deck.nml").write_text(text)
    assert_refused(tmp_path, "deck.nml", 3, "180")


SETTINGS = {
    "without-value": ("arch%radius", "arch%radius"),
    "empty-value": ("arch%radius=", "radius"),
    "without-group": ("radius=5", "radius=5"),
    "unknown-group": ("arc%radius=5", "arc"),
    "unknown-key": ("arch%raduis=5", "raduis"),
    "wrong-type": ("arch%radius=ten", "ten"),
    "nan": ("arch%radius=NaN", "nan"),
    "out-of-range": ("arch%thickness_ratio=2", "thickness_ratio"),
    "two-values-for-one": ("arch%radius=5,6", "radius"),
    "unknown-word": ("arch%springing=glued", "glued"),
    "item-not-there": ("arch%joints_deg(2)=45", "joints_deg"),
    "sweep-values": ("sweep%values=1,2", "sweep"),
    "sweep-parameter": ("sweep%parameter=radius", "sweep"),
    "more-than-a-value": ("arch%radius=5 /", "5 /"),
    "against-the-deck": ("arch%joints_deg=10,50,90", "0"),
}


@pytest.mark.parametrize("setting", SETTINGS)
def test_errors_of_set_name_set(tmp_path: Path, setting: str) -> None:
    value, wanted = SETTINGS[setting]
    (tmp_path / "deck.nml").write_text(GOOD)
    for verb in ("run", "check"):
        done = run_dda(verb, "deck.nml", "--set", value, cwd=tmp_path)
        assert done.returncode == 2
        assert done.stdout == ""
        assert re.match(r"--set:\d+: error: ", done.stderr), done.stderr
        assert wanted.lower() in done.stderr.lower()
    assert not (tmp_path / "deck").exists()


def test_second_set_is_distinguished_from_the_first(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    good, bad = "arch%radius=5", "joint%friction_deg=-5"
    done = run_dda("run", "deck.nml", "--set", good, "--set", bad, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("--set:2: error: ")


@pytest.mark.parametrize("cases", ["0", "2", "1-2", "1-", "-1", "1--1", "2-1", "x", "1,,1", "1, 1", "1.0", "1-1-1"])
def test_errors_of_cases_name_cases(tmp_path: Path, cases: str) -> None:
    (tmp_path / "deck.nml").write_text(GOOD)
    done = run_dda("run", "deck.nml", "--cases", cases, cwd=tmp_path)
    assert done.returncode == 2
    assert re.fullmatch(r"--cases:1: error: expected cases from 1 to 1, got '.*'; write them like 1-4,7\n", done.stderr)
    assert not (tmp_path / "deck").exists()


def test_set_of_what_is_swept_is_refused(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text("&sweep parameter='radius', values=1, 2 /\n")
    done = run_dda("run", "deck.nml", "--set", "arch%radius=5", cwd=tmp_path)
    assert done.returncode == 2
    assert "--set" in done.stderr


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
    assert "error: " in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["deck.nml"]
