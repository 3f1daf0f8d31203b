"""Decks run from Python: text in, rows of results.csv out."""

from __future__ import annotations

import csv
import re
import resource
import shutil
import statistics
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from voussoir.dda_program import call, set_options
from voussoir.files import read_text, write_text

Row = dict[str, str]  #: A row of results.csv: its columns as text
#: A case that takes longer [s] is timed by the processor's time of its run, for other work on the
#: machine adds to its wall time; reading and writing are nothing beside it
LONG_CASE = 0.02
ONCE = 5.0  #: A case that takes longer [s] is run once
_NOT_A_NUMBER = re.compile(r"(?:^|,)[-+]?(?:nan|inf|infinity)(?:,|$)", re.IGNORECASE)


@dataclass(frozen=True)
class Finished:
    """Results of a run of one deck."""

    status: int | None  #: Exit status; negative if a signal ended it, None if it took too long
    rows: list[Row] = field(default_factory=list)  #: Rows of results.csv.
    remarks: dict[str, str] = field(default_factory=dict)  #: Remark of log.txt by number of the case.
    message: str = ""  #: What it printed as error
    not_a_number: tuple[str, ...] = ()  #: Names of result files that hold NaN or Inf
    folder: Path = Path()  #: Folder of its results
    seconds: float = 0.0  #: Wall time of the run


def run_deck(
    deck: str | bytes | Path, folder: Path, timeout: float = 600.0, jobs: int = 1,
    files: Mapping[str, str] | None = None, settings: Sequence[str] = ()
) -> Finished:
    """Run a deck, its text or where it is, in a folder with files (names and texts), for a time at most [s]."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(folder / "out", ignore_errors=True)
    word = "deck.nml"
    if isinstance(deck, Path):
        word = str(deck.absolute())
    else:
        (folder / word).write_bytes(deck if isinstance(deck, bytes) else deck.encode())
    for name, text in (files or {}).items():
        write_text(folder / name, text)
    start = time.monotonic()
    try:
        done = call("run", word, "--out", "out", "--jobs", jobs, *set_options(settings), accepted=None, cwd=folder,
                    timeout=timeout)
    except subprocess.TimeoutExpired:
        return Finished(None, message=f"stopped after {timeout:g} s")
    seconds, out = time.monotonic() - start, folder / "out"
    return Finished(
        done.returncode, read_rows(out / "results.csv"), _remarks(out / "log.txt"), done.stderr.strip(),
        tuple(path.name for path in sorted(out.glob("*.csv")) if _holds_no_number(path)), out, seconds)


def read_rows(file: Path, case: int | None = None) -> list[Row]:
    """Rows of a table, or of one case; none if there is no such file."""
    if not file.is_file():
        return []
    with file.open(newline="", encoding="utf-8") as lines:
        return [row for row in csv.DictReader(lines) if case is None or row["case"] == str(case)]


def _remarks(file: Path) -> dict[str, str]:
    """Remarks of log.txt by number of the case."""
    if not file.is_file():
        return {}
    remarks = {}
    for line in read_text(file).splitlines()[1:]:
        number, _, remark = (line.split(maxsplit=2) + ["", "", ""])[:3]
        remarks[number] = remark
    return remarks


def _holds_no_number(file: Path) -> bool:
    """Return true if a table holds NaN or Inf."""
    with file.open(encoding="utf-8") as lines:
        return any(_NOT_A_NUMBER.search(line) for line in lines)


def timed(run: Callable[[int], Finished], repeats: int) -> tuple[Finished, float]:
    """The median time of so many runs; those that take long by the processor's time."""
    start = _processor_time()
    finished = run(1)
    once = _processor_time() - start
    if not finished.rows or once > ONCE:
        return finished, once
    start = _processor_time()
    finished = run(repeats)
    spent = (_processor_time() - start) / repeats
    wall = statistics.median(float(row["seconds"]) for row in finished.rows)
    return finished, spent if wall > LONG_CASE else wall


def _processor_time() -> float:
    """Processor time of the programs that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
