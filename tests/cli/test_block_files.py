"""Files of blocks at the command line: plans, refusals, measured points, pictures, restart files."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

BASE = "block fixed\n-1 -1\n2 -1\n2 0\n-1 0\n"
BLOCK = "block\n0 0\n1 0\n1 2\n0 2\n"


def write(folder: Path, blocks: str, groups: str = "", name: str = "x") -> Path:
    """Write a deck and its file of blocks."""
    (folder / "x.blocks").write_text(blocks)
    deck = folder / f"{name}.nml"
    deck.write_text(f"&scene kind = 'blocks', geometry = 'x.blocks' /\n{groups}\n")
    return deck


def test_check_says_what_was_found(tmp_path: Path) -> None:
    tip = "block\n0.5 2\n1 3\n0 3\n"
    done = run_dda("check", write(tmp_path, BASE + BLOCK + tip))
    assert done.returncode == 0
    assert "2 free, 1 fixed" in done.stdout
    assert "1 of two normal springs and one shear spring, 1 of one corner against an edge" in done.stdout


def test_check_says_the_points(tmp_path: Path) -> None:
    deck = write(tmp_path, BLOCK + "fix 0 0\nfix 1 0\nmeasure 0.5 1\nload 0.5 2 1 0\n")
    done = run_dda("check", deck)
    assert done.returncode == 0 and done.stderr == ""
    assert "2 fixed or prescribed, 1 loaded, 1 monitoring" in done.stdout


def test_warnings_name_file_and_line(tmp_path: Path) -> None:
    twice = BLOCK.replace("1 2\n", "1 2\n1 2\n")
    deck = write(tmp_path, BASE + twice + twice.replace("2\n", "4\n").replace(" 0\n", " 2\n"))
    for command in ("check", "run"):
        done = run_dda(command, deck, cwd=tmp_path)
        assert done.returncode == 0
        # the same words for another line are counted, not repeated
        (line,) = done.stderr.splitlines()
        assert line.endswith("x.blocks:6: warning: corners given twice are merged (and 1 more like it)")


@pytest.mark.parametrize(
    "blocks, line, words",
    [
        (BASE + BLOCK.replace("0 0\n1 0", "0 0.1\n1 0.1"), 6, "block 2 has no support"),
        (BLOCK, 1, "block 1 has no support"),
        (BASE + "block\n0 0\n1 1\n1 0\n0 1\n", 6, "its edges 1 and 3 meet at"),
        (BASE + BLOCK.replace("1 2", "1,5 2"), 9, "a corner x y"),
    ],
)
def test_bad_blocks_are_refused_with_file_and_line(tmp_path: Path, blocks: str, line: int, words: str) -> None:
    done = run_dda("run", write(tmp_path, blocks), cwd=tmp_path)
    assert done.returncode == 2
    (message,) = done.stderr.splitlines()
    assert f"x.blocks:{line}: error: " in message
    assert words in message
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize(
    "blocks, line, words",
    [
        (BASE.replace("block", "block fixed\n5 5\n6 5\n6 6\nblock", 1), 1, "all blocks are fixed"),
        (BASE + BLOCK.replace("0\n", "3\n", 2).replace("2\n", "5\n"), 6, "has no support"),
        (BASE + BLOCK + "material 2 density 1\n" + "block\n1e7 0\n10000000.1 0\n1e7 0.1\n", 12, "few digits"),
        ((BASE + BLOCK).replace("1", "1000").replace("2", "2000"), 1, "strains it by"),
    ],
)
def test_doubtful_blocks_are_warned_of_with_file_and_line(tmp_path: Path, blocks: str, line: int, words: str) -> None:
    deck = write(tmp_path, blocks, "&analysis mode = 'dynamic', steps = 2, duration = 1e-6 /")
    done = run_dda("run", deck, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert any(
        f"x.blocks:{line}: warning: " in text and words in text for text in done.stderr.splitlines()
    ), done.stderr


def test_blocks_that_are_all_fixed_stand_where_they_are(tmp_path: Path) -> None:
    done = run_dda("run", write(tmp_path, BASE), "--out", tmp_path / "out", "--quiet")
    assert done.returncode == 0
    assert rows_of(tmp_path / "out" / "results.csv")[0]["verdict"] == "stable"


def test_pictures_show_joints_that_come_and_go(tmp_path: Path) -> None:
    """A block slides off its base: the joint is there and then it is not."""
    groups = "&joint friction_deg = 0 /\n&load horizontal_coefficient = 1 /\n"
    groups += "&analysis geometry = 'current', collapse_displacement = 3.0 /\n&output frames = 6 /"
    deck = write(tmp_path, BASE + "block\n0 0\n1 0\n1 0.5\n0 0.5\n", groups)
    done = run_dda("run", deck, "--out", tmp_path / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    frames = rows_of(tmp_path / "out" / "frames.csv")
    numbers = sorted({int(row["frame"]) for row in frames})
    assert len(numbers) >= 4
    assert len(list((tmp_path / "out" / "frames").glob("case_1_*_joints.vtu"))) == len(numbers)
    joints = rows_of(tmp_path / "out" / "frame_joints.csv")
    assert {row["frame"] for row in joints} < {str(number) for number in numbers}


@pytest.mark.parametrize("held", ["", "fix 0 2\n", "displacement 1 2\n0 0 0\n0.5 0.1 0.05\n"])
def test_dynamic_run_goes_on_from_its_restart_file_to_the_last_bit(tmp_path: Path, held: str) -> None:
    groups = "&joint friction_deg = 20 /\n&load horizontal_coefficient = 0.5 /\n"
    groups += "&analysis mode = 'dynamic', time_step = 0.01, steps = {} /\n&output restart = .true. /"
    blocks = BASE + BLOCK + "measure 0.5 1\n" + held
    whole = write(tmp_path, blocks, groups.format(80), "whole")
    first = write(tmp_path, blocks, groups.format(30), "first")
    rest = write(tmp_path, blocks, groups.format("80, restart = 'first/case_1.restart'"), "rest")
    for deck in (whole, first, rest):
        done = run_dda("run", deck, "--quiet", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "whole/case_1.restart").read_bytes() == (tmp_path / "rest/case_1.restart").read_bytes()
    assert rows_of(tmp_path / "whole/points.csv")[30:] == rows_of(tmp_path / "rest/points.csv")


def test_resume_notices_that_the_blocks_have_changed(tmp_path: Path) -> None:
    deck = write(tmp_path, BASE + BLOCK)
    assert run_dda("run", deck, "--out", tmp_path / "out").returncode == 0
    again = run_dda("run", deck, "--out", tmp_path / "out", "--resume")
    assert "x.nml: resumed, 1 of 1 cases are already computed" in again.stdout
    (tmp_path / "x.blocks").write_text(BASE + BLOCK.replace("2\n", "3\n"))
    changed = run_dda("run", deck, "--out", tmp_path / "out", "--resume")
    assert "x.nml: nothing to resume" in changed.stdout
    assert {row["y"] for row in rows_of(tmp_path / "out/blocks.csv")} >= {"3"}


@pytest.mark.parametrize("name", ["", "nowhere.blocks", ".", "empty.blocks"])
def test_a_file_that_cannot_be_read_is_reported_with_the_line_of_the_deck(tmp_path: Path, name: str) -> None:
    (tmp_path / "empty.blocks").write_text("")
    (tmp_path / "deck.nml").write_text(f"&scene kind = 'blocks',\n  geometry = '{name}' /\n")
    done = run_dda("check", "deck.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"deck.nml:2: error: scene%geometry = '{name}': ")
