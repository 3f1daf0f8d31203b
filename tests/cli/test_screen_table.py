"""The table on the screen: columns that the scene has, cases in order, never wider than the terminal."""

from __future__ import annotations

import fcntl
import os
import pty
import struct
import subprocess
import termios
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

SEARCH = "&arch voussoirs = 12 /\n&search /\n"
THREE = "&sweep parameter = 'half_angle_deg', values = 60, 90, 120 /\n"
WIDE = (
    SEARCH + "&sweep parameter = 'horizontal_coefficient', values = 0, 0.012345678901234567 /\n"
    "&sweep parameter = 'max_displacement_ratio', values = 0.01, 0.0333333333333333 /\n"
    "&sweep parameter = 'gravity_direction_deg', values = -90, -90.123456789 /\n"
    "&sweep parameter = 'springing', texts = 'frictional', 'no-slip' /\n"
)
BASE = "block fixed\n-1 -1\n2 -1\n2 0\n-1 0\n"
BLOCK = "block\n0 0\n1 0\n1 2\n0 2\n"


def table_of(folder: Path, text: str, *options: str, status: int = 0) -> list[str]:
    """Lines of the table, the last line of the run left out."""
    (folder / "deck.nml").write_text(text)
    done = run_dda("run", "deck.nml", *options, cwd=folder)
    assert done.returncode == status, done.stderr
    return [line for line in done.stdout.splitlines() if not line.startswith("deck.nml: ")]


def on_terminal(folder: Path, text: str, columns: int, environment: dict[str, str]) -> list[str]:
    """What a run shows on a terminal of so many columns; one of 0 does not know."""
    (folder / "deck.nml").write_text(text)
    try:
        ours, theirs = pty.openpty()
    except OSError as problem:
        pytest.skip(f"no terminal is to be had here: {problem}")
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    with subprocess.Popen(
        [os.environ["DDA"], "run", "deck.nml"], cwd=folder, stdout=theirs,
        stderr=subprocess.DEVNULL, env=os.environ | environment,
    ) as process:
        os.close(theirs)
        shown = b""
        try:
            while piece := os.read(ours, 65536):
                shown += piece
        except OSError:  # what Linux gives at the end
            pass
        assert process.wait(60.0) in (0, 3)
    os.close(ours)
    return shown.decode().replace("\r\n", "\n").splitlines()


def test_swept_values_come_first_then_what_was_found(tmp_path: Path) -> None:
    head, *rows = table_of(tmp_path, SEARCH + THREE)
    assert head.split() == ("case half_angle_deg thickness_ratio verdict exact error mode intrados hinge".split())
    for shown, row in zip(rows, rows_of(tmp_path / "deck/results.csv"), strict=True):
        words = shown.split()
        assert words[:2] == [row["case"], row["half_angle_deg"]]
        assert words[3] == "found" and words[6] == row["collapse_mode"]
        assert float(words[2]) == pytest.approx(float(row["critical"]), rel=1e-9)
        assert float(words[4]) == pytest.approx(float(row["exact"]), rel=1e-9)
        assert float(words[5]) == pytest.approx(float(row["relative_error"]), rel=0.06)
        assert float(words[7]) == pytest.approx(float(row["intrados_hinge_deg"]))


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("&arch /", "case verdict exact critical mode intrados hinge"),
        ("&arch /\n&analysis mode = 'dynamic', steps = 3, duration = 1e-9 /", "case verdict exact critical"),
        ("&arch voussoirs = 6 /\n&search parameter = 'friction_deg' /",
         "case friction_deg verdict mode intrados hinge"),
        ("&scene kind = 'blocks', geometry = 'x.blocks' /", "case verdict mode"),
        ("&scene kind = 'blocks', geometry = 'x.blocks' /\n"
         "&analysis mode = 'dynamic', duration = 0.01 /", "case verdict"),
        ("&scene kind = 'blocks', geometry = 'x.blocks' /\n&search parameter = 'friction_deg' /\n"
         "&load horizontal_coefficient = 0.2 /\n"
         "&sweep parameter = 'poisson', values = 0.1 /\n", "case poisson friction_deg verdict mode"),
    ],
)
def test_columns_are_those_of_the_scene(tmp_path: Path, text: str, columns: str) -> None:
    (tmp_path / "x.blocks").write_text(BASE + BLOCK)
    assert table_of(tmp_path, text)[0].split() == columns.split()


@pytest.mark.parametrize("cohesion", [3e-7, 1e-3, 12.5, 4e9])
def test_values_of_any_size_are_shown_with_their_digits(tmp_path: Path, cohesion: float) -> None:
    """Cohesion holds a block on a base without friction against its own weight pulling it sideways."""
    (tmp_path / "x.blocks").write_text(BASE + BLOCK.replace("2\n", "0.25\n"))
    text = (
        "&scene kind = 'blocks', geometry = 'x.blocks' /\n&joint friction_deg = 0.0 /\n"
        f"&material unit_weight = {cohesion / 0.05!r} /\n&load horizontal_coefficient = 0.2 /\n"
        f"&search parameter = 'cohesion', low = {cohesion / 9!r}, high = {cohesion * 9!r} /\n"
    )
    (_, row) = table_of(tmp_path, text)
    critical = float(rows_of(tmp_path / "deck/results.csv")[0]["critical"])
    assert float(row.split()[1]) == pytest.approx(critical, rel=5e-9)
    assert critical == pytest.approx(cohesion, rel=1e-6)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_a_critical_value_has_the_digits_of_its_bracket(tmp_path: Path, tolerance: float) -> None:
    """A bracket from 62.0 to 62.6 determines three digits: 62.3, not 62.3046875."""
    spread = (
        "&arch shape = 'segmental', span = 6, rise = 1.5, thickness = 0.45, voussoirs = 9 /\n"
        "&support right_dx = 0.01 /\n&analysis geometry = 'current' /\n"
        f"&search parameter = 'displacement_factor', low = 0, high = 100, tolerance = {tolerance} /\n")
    shown = table_of(tmp_path, spread)[1].split()[1]
    (row,) = rows_of(tmp_path / "deck" / "results.csv")
    value, low, high = (float(row[name]) for name in ("critical", "critical_low", "critical_high"))
    digits = len(shown.replace(".", "").lstrip("0"))
    assert 10.0 ** (digits - 2) <= value / (0.5 * (high - low)) * 1.0001
    assert abs(float(shown) - value) <= 0.5 * (high - low)


@pytest.mark.parametrize("jobs", ["1", "2", "7"])
def test_cases_are_shown_in_order_whoever_computes_them(tmp_path: Path, jobs: str) -> None:
    """The first case of each pair takes a hundred times as long as the second."""
    text = "&search /\n&sweep parameter = 'voussoirs', values = " + ", ".join(["400, 4"] * 20) + " /\n"
    _, *rows = table_of(tmp_path, text, "--jobs", jobs)
    assert [int(row.split()[0]) for row in rows] == list(range(1, 41))
    assert [row.split()[1] for row in rows] == ["400", "4"] * 20


@pytest.mark.parametrize("jobs", ["1", "3"])
def test_of_many_cases_the_undecided_ones_are_shown_in_order(tmp_path: Path, jobs: str) -> None:
    steps = ", ".join(["400", "1", "400", "1", "400"] * 30)
    text = f"&arch thickness_ratio = 0.12 /\n&sweep parameter = 'steps', values = {steps} /\n"
    text += "&analysis geometry = 'current' /\n"
    head, *rows = table_of(tmp_path, text, "--jobs", jobs, status=3)
    assert head.split()[:3] == ["case", "steps", "verdict"]
    told = [row.split() for row in rows if row.split()[0].isdigit()]
    assert [int(words[0]) for words in told] == [n for n in range(1, 151) if n % 5 in (2, 4)]
    assert all(words[1:3] == ["1", "undecided"] for words in told)
    assert len(rows) >= 2 * len(told)


def test_a_resumed_run_shows_what_it_computes_in_order(tmp_path: Path) -> None:
    text = SEARCH + "&sweep parameter = 'voussoirs', values = 4, 6, 8, 10, 12, 14 /\n"
    table_of(tmp_path, text)
    results = tmp_path / "deck/results.csv"
    lines = results.read_text().splitlines(keepends=True)
    results.write_text("".join(lines[:1] + lines[2:3] + lines[5:6]))
    _, *rows = table_of(tmp_path, text, "--resume", "--jobs", "2")
    assert [row.split()[0] for row in rows] == ["1", "3", "4", "6"]


@pytest.mark.parametrize("columns", [1, 9, 20, 40, 61, 80, 101, 132, 250, 0])
@pytest.mark.parametrize(
    "text", [SEARCH + THREE, WIDE, "&arch thickness_ratio = 0.12 /\n&analysis geometry = 'current', steps = 1 /\n"])
def test_no_line_is_wider_than_the_terminal(tmp_path: Path, text: str, columns: int) -> None:
    lines = [line for line in on_terminal(tmp_path, text, columns, {"COLUMNS": ""})
             if not line.startswith("deck.nml: ")]
    columns = columns or 80
    assert max(map(len, lines)) <= columns
    if columns >= 20:
        assert lines[0].split()[0] == "case" and "verdict" in lines[0]
    if columns == 250 and text == WIDE:
        assert "horizontal_coefficient" in lines[0] and lines[0].endswith("intrados hinge")
        assert lines[2].split()[1:5] == ["0", "0.01", "-90", "no-slip"]
        last = ["0.012345678901234567", "0.0333333333333333", "-90.123456789", "no-slip"]
        assert lines[-1].split()[1:5] == last


@pytest.mark.parametrize(
    ("terminal", "variable", "widest"),
    [(120, "70", 120), (70, "120", 70), (0, "64", 64), (0, "120", 120), (0, "wide", 80), (0, "-5", 80),
     (0, "", 80)],
)
def test_a_terminal_that_does_not_know_its_width_is_as_wide_as_the_environment_says(
    tmp_path: Path, terminal: int, variable: str, widest: int
) -> None:
    lines = on_terminal(tmp_path, WIDE, terminal, {"COLUMNS": variable})
    assert widest - 24 < max(map(len, lines[:-1])) <= widest


def test_a_file_gets_at_most_100_columns(tmp_path: Path) -> None:
    lines = table_of(tmp_path, WIDE)
    assert 90 < max(map(len, lines)) <= 100
    # names are cut before columns are left out, and all that tell cases apart are there
    assert lines[0].split()[:7] == [
        "case", "horizontal..", "max_displa..", "gravity_di..", "springing", "thickness_ratio", "verdict"
    ]
    assert len({tuple(line.split()[1:5]) for line in lines[1:]}) == 16
    assert lines[-1].split()[1:5] == ["0.0123456789", "0.0333333333", "-90.12345679", "no-slip"]


def test_long_reasons_go_on_in_the_next_line(tmp_path: Path) -> None:
    text = "&search /\n&analysis geometry = 'current', steps = 1 /\n"
    lines = on_terminal(tmp_path, text, 30, {})
    (log,) = (tmp_path / "deck/log.txt").read_text().splitlines()[1:]
    reason = log.removeprefix("1 undecided ")
    said = [line for line in lines if line.startswith("      ") and "undecided" not in line]
    assert len(said) > 2 and " ".join(line.strip() for line in said) == reason
