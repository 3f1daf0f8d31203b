"""dda run --resume: finished cases are kept, everything else is computed as if never begun."""

from __future__ import annotations

import os
import random
import re
import resource
import signal
import subprocess
import time
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

DECK = """&search /
&sweep parameter = 'half_angle_deg', values = 60, 90, 120 /
&sweep parameter = 'voussoirs', values = 4, 7, 12, 36 /
"""
UNDECIDED = """&arch thickness_ratio = 0.12 /
&analysis geometry = 'current' /
&sweep parameter = 'steps', values = 400, 1, 400 /
"""


def write_deck(folder: Path, text: str = DECK) -> Path:
    """Write deck.nml and return the folder that its results go to."""
    (folder / "deck.nml").write_text(text)
    return folder / "deck"


def run(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Run deck.nml in a folder."""
    return run_dda("run", "deck.nml", *options, cwd=folder)


def tables(folder: Path) -> dict[str, list[str]]:
    """Lines of all tables in the order of the alphabet, wall times left out."""
    found = {}
    for file in folder.iterdir():
        if file.is_file():
            lines = file.read_text().splitlines()
            if file.name == "results.csv":
                place = lines[0].split(",").index("seconds") - len(lines[0].split(","))
                lines = [",".join(part[:place] + part[place + 1 or None :])
                         for part in (line.split(",") for line in lines)]
            found[file.name] = sorted(lines)
    return found


def seconds(folder: Path) -> dict[str, str]:
    """Wall time of each case as written, by which a row that was kept is known again."""
    return {row["case"]: row["seconds"] for row in rows_of(folder / "results.csv")}


def cut(file: Path, keep: int) -> None:
    """Cut a file after some bytes, as a kill does."""
    file.write_bytes(file.read_bytes()[:keep])


def test_finished_run_is_left_as_it_is(tmp_path: Path) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    before = {file.name: file.read_bytes() for file in out.iterdir()}
    done = run(tmp_path, "--resume")
    assert done.returncode == 0
    assert "12 of 12 cases are already computed" in done.stdout
    assert {file.name: file.read_bytes() for file in out.iterdir()} == before


def test_first_run_may_be_a_resumed_one(tmp_path: Path) -> None:
    out = write_deck(tmp_path)
    done = run(tmp_path, "--resume")
    assert done.returncode == 0
    assert "nothing to resume" in done.stdout
    assert len(seconds(out)) == 12


def test_quiet_resume_prints_nothing(tmp_path: Path) -> None:
    write_deck(tmp_path)
    run(tmp_path)
    done = run(tmp_path, "--resume", "--quiet")
    assert done.stdout == done.stderr == ""


@pytest.mark.parametrize("seed", range(12))
def test_row_cut_anywhere_is_computed_again(tmp_path: Path, seed: int) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    whole, times = tables(out), seconds(out)
    size = (out / "results.csv").stat().st_size
    keep = size - 1 if seed == 0 else random.Random(seed).randrange(size)
    cut(out / "results.csv", keep)
    rows = max(0, (out / "results.csv").read_text().count("\n") - 1)
    done = run(tmp_path, "--resume", "--jobs", "2")
    assert done.returncode == 0
    assert f"{rows} of 12 cases are already computed" in done.stdout
    assert tables(out) == whole
    again = seconds(out)
    assert sum(again[case] == times[case] for case in times) >= rows


@pytest.mark.parametrize(
    "damage",
    [
        lambda line: line * 2,
        lambda line: "\0" * len(line) + "\n",
        lambda line: line.replace("deck,3,", "deck,300,"),
        lambda line: line.replace("deck,3,", "deck,-3,"),
        lambda line: line.rpartition(",")[0] + "\n",
        lambda line: line.rsplit(",", 11)[0] + 11 * "," + "\n",
        lambda line: line.rsplit(",", 12)[0] + ",,3" + 10 * "," + "\n",
        lambda line: line.replace(",0.", ",1.", 1),
        lambda line: "",
    ],
    ids=["twice", "zeros", "beyond", "negative", "short", "no unknowns", "no seconds", "a digit", "gone"],
)
def test_damaged_row_is_not_taken_as_good(tmp_path: Path, damage) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    whole = tables(out)
    lines = (out / "results.csv").read_text().splitlines(keepends=True)
    lines[3] = damage(lines[3])
    (out / "results.csv").write_text("".join(lines))
    assert run(tmp_path, "--resume").returncode == 0
    assert tables(out) == whole


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("120", "110"),
        lambda text: text.replace("&search /", "&search tolerance = 1e-6 /"),
        lambda text: text + "&joint friction_deg = 45 /",
        lambda text: text + "&output joints = .false. /",
        lambda text: text.replace("4, 7, 12, 36", "4, 7, 12"),
    ],
    ids=["value", "search", "group", "output", "fewer"],
)
def test_changed_deck_is_computed_again(tmp_path: Path, change) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    write_deck(tmp_path, change(DECK))
    done = run(tmp_path, "--resume")
    assert done.returncode == 0
    assert "all cases are computed" in done.stdout
    resumed = tables(out)
    run(tmp_path)
    assert tables(out) == resumed


@pytest.mark.parametrize(
    ("first", "second"),
    [("45", None), (None, "45"), ("45", "40")],
    ids=["dropped", "added", "other"],
)
def test_changed_set_is_computed_again(tmp_path: Path, first: str | None, second: str | None) -> None:
    def setting(value: str | None) -> list[str]:
        return ["--set", f"joint%friction_deg={value}"] if value else []

    out = write_deck(tmp_path)
    run(tmp_path, *setting(first))
    done = run(tmp_path, "--resume", *setting(second))
    assert "all cases are computed" in done.stdout
    assert {row["friction_deg"] for row in rows_of(out / "results.csv")} == {second or "50"}


def test_results_of_another_build_are_computed_again(tmp_path: Path) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    record = (out / "deck.record").read_text()
    (out / "deck.record").write_text(re.sub("build [0-9a-f]{12} on", "build 0123456789ab on", record))
    done = run(tmp_path, "--resume")
    assert "the program have changed; all cases are computed" in done.stdout
    assert (out / "deck.record").read_text() == record


@pytest.mark.parametrize(
    "text",
    [
        "! a comment\n" + DECK.replace("&search /", "&Search\n\n/"),
        DECK.replace("values = 60, 90, 120", "first = 60, last = 120, count = 3"),
    ],
    ids=["comments", "evenly spaced"],
)
def test_same_deck_in_other_words_is_resumed(tmp_path: Path, text: str) -> None:
    write_deck(tmp_path)
    run(tmp_path)
    write_deck(tmp_path, text)
    assert "12 of 12" in run(tmp_path, "--resume").stdout


def test_same_set_as_in_the_deck_is_resumed(tmp_path: Path) -> None:
    write_deck(tmp_path)
    run(tmp_path, "--set", "joint%friction_deg=45")
    write_deck(tmp_path, DECK + "&joint friction_deg = 45.0 /")
    assert "12 of 12" in run(tmp_path, "--resume").stdout


def test_undecided_cases_of_before_count_for_the_status(tmp_path: Path) -> None:
    out = write_deck(tmp_path, UNDECIDED)
    assert run(tmp_path).returncode == 3
    done = run(tmp_path, "--resume")
    assert done.returncode == 3
    assert "2 decided, 1 undecided" in done.stdout
    assert len(seconds(out)) == 3


@pytest.mark.parametrize("signals", [signal.SIGKILL, signal.SIGTERM])
def test_killed_twice_ends_as_an_unbroken_run(tmp_path: Path, signals: int) -> None:
    text = DECK + "&sweep parameter = 'friction_deg', first = 30, last = 60, count = 60 /\n"
    out = write_deck(tmp_path, text)
    table = out / "results.csv"
    enough = 20000
    for attempt in range(2):
        with subprocess.Popen([os.environ["DDA"], "run", "deck.nml", "--quiet", "--resume"], cwd=tmp_path) as process:
            patience = time.monotonic() + 60.0
            while not table.exists() or table.stat().st_size < enough * (attempt + 1):
                assert process.poll() is None, "the run ended before it could be killed"
                assert time.monotonic() < patience
                time.sleep(0.005)
            process.send_signal(signals)
    rows = table.read_text().count("\n") - 1
    done = run(tmp_path, "--resume")
    assert done.returncode == 0
    assert 50 < rows < 720
    assert f"{rows} of 720 cases are already computed" in done.stdout
    resumed = tables(out)
    assert run_dda("run", "deck.nml", "--out", "unbroken", "--quiet", cwd=tmp_path).returncode == 0
    assert tables(tmp_path / "unbroken") == resumed


def test_table_that_cannot_be_replaced_gives_4_and_is_kept(tmp_path: Path) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    before = (out / "results.csv").read_bytes()
    (out / "joints.csv.part").mkdir()
    done = run(tmp_path, "--resume")
    assert done.returncode == 4
    assert "joints.csv.part" in done.stderr
    assert "12 of 12 cases are safe" in done.stderr
    assert (out / "results.csv").read_bytes() == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes into every folder")
def test_read_only_folder_gives_4(tmp_path: Path) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    before = (out / "results.csv").read_bytes()
    out.chmod(0o555)
    done = run(tmp_path, "--resume")
    out.chmod(0o755)
    assert done.returncode == 4
    assert (out / "results.csv").read_bytes() == before


def test_full_disk_keeps_what_is_there(tmp_path: Path) -> None:
    out = write_deck(tmp_path)
    run(tmp_path)
    before = (out / "results.csv").read_bytes()
    least = min(path.stat().st_size for path in out.glob("*.csv"))
    done = subprocess.run(
        [os.environ["DDA"], "run", "deck.nml", "--resume"], cwd=tmp_path, capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (least - 1, least - 1)))
    assert done.returncode == 4
    assert "cannot write" in done.stderr
    assert (out / "results.csv").read_bytes() == before
