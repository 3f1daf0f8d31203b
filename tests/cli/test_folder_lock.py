"""One run a folder: the second ends at once and says why, and a killed one holds up no other."""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

LONG = """&search /
&output joints = .true., blocks = .true. /
&sweep parameter = 'half_angle_deg', first = 40, last = 100, count = {} /
"""
SHORT = "&arch thickness_ratio = 0.12, voussoirs = 8 /\n"


@contextmanager
def running(folder: Path, *words: str) -> Iterator[subprocess.Popen]:
    """A run that has begun to write its rows into the folder `out`, and then halts."""
    with subprocess.Popen(
        [os.environ["DDA"], "run", "long.nml", "--out", "out", "--quiet", *words], cwd=folder
    ) as process:
        table = folder / "out" / "results.csv"
        patience = time.monotonic() + 60.0
        while not table.exists() or table.stat().st_size < 1000:
            assert process.poll() is None, "the run ended before it could be disturbed"
            assert time.monotonic() < patience
            time.sleep(0.002)
        process.send_signal(signal.SIGSTOP)
        try:
            yield process
        finally:
            process.send_signal(signal.SIGCONT)
            process.wait(timeout=60)


def write(folder: Path, cases: int = 600) -> None:
    """Write the decks."""
    (folder / "long.nml").write_text(LONG.format(cases))
    (folder / "short.nml").write_text(SHORT)


def cases_of(table: Path) -> list[int]:
    """Cases of a table, in their order."""
    return [int(row["case"]) for row in rows_of(table)]


@pytest.mark.parametrize("words", [["long.nml"], ["long.nml", "--resume"], ["short.nml", "--jobs", "2"]], ids=" ".join)
def test_second_run_in_a_folder_gives_4_and_leaves_the_first_whole(tmp_path: Path, words: list[str]) -> None:
    write(tmp_path)
    with running(tmp_path) as first:
        done = run_dda("run", *words, "--out", "out", cwd=tmp_path, timeout=60)
        assert done.returncode == 4
        assert done.stdout == ""
        assert done.stderr == (
            "out/run.lock:1: error: expected a folder that no other run or deck writes to, got one in "
            "use; choose another folder with --out, or wait for that run to end\n"
        )
    assert first.returncode == 0
    assert cases_of(tmp_path / "out" / "results.csv") == list(range(1, 601))
    assert sorted(set(cases_of(tmp_path / "out" / "joints.csv"))) == list(range(1, 601))
    assert run_dda("run", "long.nml", "--out", "plain", "--quiet", cwd=tmp_path).returncode == 0
    for name in ("joints.csv", "log.txt", "deck.record"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "plain" / name).read_bytes()
    assert "600 of 600" in run_dda("run", "long.nml", "--out", "out", "--resume", cwd=tmp_path).stdout


def test_other_folders_are_free(tmp_path: Path) -> None:
    write(tmp_path)
    with running(tmp_path):
        for out in ("other", "out/below"):
            assert run_dda("run", "short.nml", "--out", out, cwd=tmp_path).returncode == 0


def test_other_decks_of_a_command_run_on(tmp_path: Path) -> None:
    write(tmp_path)
    (tmp_path / "all" / "short").mkdir(parents=True)
    with (tmp_path / "all" / "short" / "run.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        (tmp_path / "free.nml").write_text(SHORT)
        done = run_dda("run", "short.nml", "free.nml", "--out", "all", cwd=tmp_path)
    assert done.returncode == 4
    assert cases_of(tmp_path / "all" / "free" / "results.csv") == [1]
    assert [path.name for path in (tmp_path / "all" / "short").iterdir()] == ["run.lock"]


@pytest.mark.parametrize("signals", [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_run_holds_up_no_other(tmp_path: Path, signals: int) -> None:
    write(tmp_path)
    with running(tmp_path) as process:
        process.send_signal(signals)
        process.send_signal(signal.SIGCONT)
        process.wait(timeout=60)
    assert (tmp_path / "out" / "run.lock").exists()
    done = run_dda("run", "long.nml", "--out", "out", "--resume", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert sorted(cases_of(tmp_path / "out" / "results.csv")) == list(range(1, 601))


def test_two_names_of_one_folder_are_one_folder(tmp_path: Path) -> None:
    write(tmp_path, 3)
    (tmp_path / "all").mkdir()
    (tmp_path / "all" / "long").symlink_to("short")
    (tmp_path / "all" / "short").mkdir()
    done = run_dda("run", "short.nml", "long.nml", "--out", "all", "--quiet", cwd=tmp_path)
    assert done.returncode == 4
    assert "all/long/run.lock:1: error:" in done.stderr
    assert cases_of(tmp_path / "all" / "short" / "results.csv") == [1]


def test_lock_that_cannot_be_made_gives_4(tmp_path: Path) -> None:
    write(tmp_path)
    (tmp_path / "out" / "run.lock").mkdir(parents=True)
    done = run_dda("run", "short.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 4
    assert "out/run.lock:1: error: the file cannot be written" in done.stderr
    assert not (tmp_path / "out" / "results.csv").exists()


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler here")
def test_file_system_without_locks_is_reported(tmp_path: Path) -> None:
    """As some network file systems, flock refuses whatever is asked."""
    (tmp_path / "no_locks.c").write_text(
        "#include <errno.h>\nint flock(int file, int how) { errno = ENOLCK; return -1; }\n")
    library = tmp_path / "no_locks.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, tmp_path / "no_locks.c"], check=True)
    write(tmp_path)
    for quiet in ([], ["--quiet"]):
        done = subprocess.run(
            [os.environ["DDA"], "run", "short.nml", "--out", "out", *quiet], cwd=tmp_path,
            env={**os.environ, "LD_PRELOAD": str(library)}, capture_output=True, text=True, check=False)
        assert done.returncode == 0
        warning = "" if quiet else (
            "out/run.lock:1: warning: this file system has no locks; let no other run write to out\n"
        )
        assert done.stderr == warning
    assert not list((tmp_path / "out").glob("run.lock.*"))
