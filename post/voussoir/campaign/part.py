"""One part of a campaign, a range of its cases: run by a worker, wherever that is.

Everything here uses the standard library alone, so that a worker, which receives this module, needs no more than
Python, the program `dda` and the folder of the campaign. A part has a folder of its own, which `dda run --resume` keeps
whole: a worker may be killed at any moment, and its program may even go on without it, for it holds the folder.
"""

from __future__ import annotations

import csv
import fcntl
import signal
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Part:
    """Some cases of a campaign."""

    dda: Path  #: The program dda
    deck: Path  #: The deck
    settings: tuple[str, ...]  #: Values of --set
    folder: Path  #: Where its tables are
    #: Its first case and its last
    first: int
    last: int
    record: str  #: Text of deck.record that it must have in the end


def run_part(part: Part) -> tuple[int, str]:
    """Compute the cases of a part that are not finished: worst exit status of the program, and its message.

    A program that was killed is started again. Where it dies without having finished anything, the case at which it
    died is left out, so that one case cannot hold up the others.
    """
    left_out: set[int] = set()
    before = -1
    while True:
        _wait_for(part.folder)
        status, message = _run(part, left_out)
        if status in (0, 3) and (part.folder / "deck.record").read_bytes() != part.record.encode():
            return 2, (
                f"{part.deck}:1: error: expected the deck and its files as they were when the "
                "campaign began, got changed ones; call again with --discard")
        if status in (0, 2, 3, 4):
            return status if status in (2, 4) else 0, message
        if -status in (signal.SIGINT, signal.SIGTERM):
            return 3, "stopped before all cases were finished; call again to go on"
        done = set(cases_of(part.folder / "results.csv"))
        if len(done) == before:
            left_out.add(next(case for case in range(part.first, part.last + 1) if case not in done | left_out))
            if len(done | left_out) > part.last - part.first:
                return 0, ""
        before = len(done)


def _wait_for(folder: Path) -> None:
    """Wait until no program writes to a folder: one may go on though its worker was killed."""
    try:
        with (folder / "run.lock").open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
    except OSError:  # there is none, or the file system knows no locks
        return


def _run(part: Part, left_out: set[int]) -> tuple[int, str]:
    """Run the program once: exit status, and what it printed on standard error."""
    command = [str(part.dda), "run", str(part.deck), "--out", str(part.folder), "--resume", "--force", "--quiet"]
    command += ["--cases", ranges_of(part.first, part.last, left_out)]
    for setting in part.settings:
        command += ["--set", setting]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    return done.returncode, done.stderr.strip()


def ranges_of(first: int, last: int, left_out: set[int]) -> str:
    """A range of cases without some as --cases wants it, such as "1-4,6-7"."""
    starts = [first, *(case + 1 for case in sorted(left_out))]
    stops = [*(case - 1 for case in sorted(left_out)), last]
    return ",".join(f"{low}-{high}" for low, high in zip(starts, stops) if low <= high)


def cases_of(table: Path) -> Iterator[int]:
    """Cases of the whole rows of a table, in the order in which they stand; none if there is no table."""
    return (case for case, _, _ in slices_of(table))


def slices_of(table: Path) -> Iterator[tuple[int, int, int]]:
    """Case, first byte and the byte behind the last one of its rows; rows that follow one another are one slice.

    A row that was cut off is left out.
    """
    if not table.is_file():
        return
    with table.open("rb") as file:
        header = fields_of(file.readline(), table.suffix)
        if "case" not in header:
            return
        column, count = header.index("case"), 0 if table.suffix == ".txt" else len(header)
        case, start, stop = 0, 0, file.tell()
        for line in file:
            this = case_of(line, column, count)
            if this != case:
                if case:
                    yield case, start, stop
                case, start = this, stop
            stop += len(line)
        if case:
            yield case, start, stop


def case_of(line: bytes, column: int, count: int) -> int:
    """Case of a row of so many cells (0: the log, parted by blanks); 0 if it was cut off or is none."""
    if count and b'"' in line:
        cells = [cell.encode() for cell in fields_of(line, ".csv")]
        whole = len(cells) == count
    else:
        cells = line.split(b"," if count else b" ", column + 1)
        whole = not count or line.count(b",") == count - 1
    number = cells[column].rstrip() if whole and line.endswith(b"\n") and len(cells) > column else b""
    return int(number) if number.isdigit() and len(number) < 10 else 0


def fields_of(line: bytes, suffix: str) -> list[str]:
    """Fields of a row: parted by commas, in the log by blanks."""
    text = line.decode("utf-8", errors="replace").rstrip("\n")
    if suffix == ".txt":
        return text.split(" ")
    return next(csv.reader([text.replace("\0", "?")]), [""]) if '"' in text else text.split(",")
