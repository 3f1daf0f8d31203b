"""dda run --resume keeps whole cases whatever tables are wanted, with joints and without."""

from __future__ import annotations

import itertools
import os
import random
import signal
import subprocess
import time
from pathlib import Path

import pytest
from dda_command import run_dda

BASE = "block fixed\n-3 -1\n4 -1\n4 0\n-3 0\n"
#: In the air all the time, and let fall on the base and on one another
FLYING = BASE + "block velocity 1 0 0\n0 1\n1 1\n1 2\n0 2\nmeasure 0.5 1.5\n"
FALLING = BASE + "block\n0 0.01\n1 0.01\n1 1\n0 1\nblock\n0 1.02\n1 1.02\n1 2\n0 2\nmeasure 0.5 1.5\n"
OUTPUTS = ("joints", "blocks", "frames", "energy", "measured points")
#: The tables of a case in the order in which they are written
ORDER = ("frames.csv", "frame_joints.csv", "points.csv", "energy.csv", "joints.csv", "blocks.csv",
         "log.txt", "sizes.record", "results.csv")
CASES = 4


def write(folder: Path, blocks: str, wanted: tuple[str, ...]) -> Path:
    """Write deck.nml and its blocks; the folder that its results go to."""
    if "measured points" not in wanted:
        blocks = blocks.replace("measure", "! measure")
    (folder / "x.blocks").write_text(blocks)
    flag = {name: ".true." if name in wanted else ".false." for name in OUTPUTS}
    (folder / "deck.nml").write_text(
        "&scene kind = 'blocks', geometry = 'x.blocks' /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 0.06, time_step = 0.004 /\n"
        f"&sweep parameter = 'gravity', first = 4, last = 10, count = {CASES} /\n"
        f"&output joints = {flag['joints']}, blocks = {flag['blocks']}, energy = {flag['energy']},\n"
        f" frames = {3 if 'frames' in wanted else 0}, vtu = .false. /\n"
    )
    return folder / "deck"


def run(folder: Path, *options: str) -> str:
    """What a run of deck.nml prints; it must end well."""
    done = run_dda("run", "deck.nml", *options, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def without_seconds(text: str) -> str:
    """The text of results.csv, wall times left out."""
    lines = [line.split(",") for line in text.splitlines(keepends=True)]
    place = lines[0].index("seconds")
    return "".join(",".join(line[:place] + line[place + 1 :]) for line in lines)


def tables(folder: Path) -> dict[str, str]:
    """All tables as they are, wall times left out."""
    found = {path.name: path.read_text() for path in folder.iterdir() if path.name in ORDER}
    found["results.csv"] = without_seconds(found["results.csv"])
    return found


def parts_of(table: Path) -> list[str]:
    """The header of a table, then the rows of each case."""
    lines = table.read_text().splitlines(keepends=True)
    names = lines[0].rstrip("\n").split(" " if table.suffix == ".txt" else ",")
    parts = [lines[0]] + [""] * CASES
    for line in lines[1:]:
        fields = line.rstrip("\n").split(" " if table.suffix == ".txt" else ",")
        parts[int(fields[names.index("case")])] += line
    return parts


def kill(folder: Path, case: int, table: int, share: float) -> None:
    """Leave what a kill leaves that comes while a table gets its rows of a case."""
    for place, name in enumerate(ORDER):
        if not (folder / name).exists():
            continue
        parts = parts_of(folder / name)
        text = "".join(parts[: case + (place < table)])
        if place == table:
            text += parts[case][: int(share * len(parts[case]))]
        (folder / name).write_text(text)


COMBINATIONS = [wanted for n in range(len(OUTPUTS) + 1) for wanted in itertools.combinations(OUTPUTS, n)]


@pytest.mark.parametrize("blocks", [FLYING, FALLING], ids=["no joint", "joints come"])
@pytest.mark.parametrize("wanted", COMBINATIONS, ids=lambda wanted: "-".join(wanted) or "none")
def test_any_tables_are_resumed_byte_for_byte(tmp_path: Path, blocks: str, wanted: tuple[str, ...]) -> None:
    out = write(tmp_path, blocks, wanted)
    run(tmp_path)
    whole = {path.name: path.read_bytes() for path in out.iterdir()}
    assert f"{CASES} of {CASES} cases are already computed" in run(tmp_path, "--resume")
    assert {path.name: path.read_bytes() for path in out.iterdir()} == whole
    told = tables(out)
    dice = random.Random(" ".join(wanted) + blocks)
    case = dice.randint(1, CASES)
    kill(out, case, dice.randrange(len(ORDER)), 0.99 * dice.random())
    assert f"{case - 1} of {CASES} cases are already computed" in run(tmp_path, "--resume")
    assert tables(out) == told


@pytest.mark.parametrize("blocks", [FLYING, FALLING], ids=["no joint", "joints come"])
def test_no_table_has_a_line_that_is_no_row(tmp_path: Path, blocks: str) -> None:
    out = write(tmp_path, blocks, OUTPUTS)
    run(tmp_path)
    for name in ORDER:
        if name != "log.txt":
            widths = {line.count(",") for line in (out / name).read_text().splitlines()}
            assert len(widths) == 1, name
    rows = len((out / "frame_joints.csv").read_text().splitlines()) - 1
    assert (rows > 0) == (blocks == FALLING)


@pytest.mark.parametrize("name", ORDER)
def test_a_case_that_has_lost_rows_of_any_table_is_computed_again(tmp_path: Path, name: str) -> None:
    out = write(tmp_path, FALLING, OUTPUTS)
    run(tmp_path)
    told = {name: sorted(text.splitlines()) for name, text in tables(out).items()}
    parts = parts_of(out / name)
    parts[2] = "".join(parts[2].splitlines(keepends=True)[:-1])
    (out / name).write_text("".join(parts))
    assert f"{CASES - 1} of {CASES} cases are already computed" in run(tmp_path, "--resume")
    assert {name: sorted(text.splitlines()) for name, text in tables(out).items()} == told
    without_rows = parts_of(out / name).count("")
    (out / name).unlink()
    assert f"{without_rows} of {CASES} cases are already computed" in run(tmp_path, "--resume")
    assert {name: sorted(text.splitlines()) for name, text in tables(out).items()} == told


def test_cases_without_joints_are_kept_after_a_kill(tmp_path: Path) -> None:
    out = write(tmp_path, FLYING, OUTPUTS)
    deck = tmp_path / "deck.nml"
    deck.write_text(deck.read_text().replace(f"count = {CASES}", "count = 900"))
    table = out / "results.csv"
    with subprocess.Popen([os.environ["DDA"], "run", "deck.nml", "--quiet"], cwd=tmp_path) as process:
        patience = time.monotonic() + 60.0
        while not table.exists() or table.stat().st_size < 20000:
            assert process.poll() is None, "the run ended before it could be killed"
            assert time.monotonic() < patience
            time.sleep(0.002)
        process.send_signal(signal.SIGKILL)
    rows = table.read_text().count("\n") - 1
    assert 50 < rows < 900
    assert f"{rows} of 900 cases are already computed" in run(tmp_path, "--resume")
    resumed = tables(out)
    run(tmp_path, "--out", "unbroken", "--quiet")
    assert tables(tmp_path / "unbroken") == resumed
