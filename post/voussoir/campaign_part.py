"""One part of a campaign: run by a worker, wherever that is.

Everything here uses the standard library alone, so that a worker needs no more than Python, the
program `dda` and the folder of the campaign. No two attempts write to the same file: each has a
folder of its own, and what an attempt before it has finished is not computed again. So a worker
may be killed at any moment, and its program may even go on without it.
"""

from __future__ import annotations

import csv
import signal
import subprocess
import uuid
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Part:
    """Some cases of a campaign."""

    #: The program dda
    dda: Path
    #: The deck
    deck: Path
    #: Values of --set
    settings: tuple[str, ...]
    #: Folder of the campaign's parts
    folder: Path
    #: Numbers of the cases, rising
    cases: tuple[int, ...]
    #: Cases computed at the same time
    jobs: int = 1


def run_part(part: Part) -> tuple[int, str]:
    """Compute the cases of a part that no attempt has finished yet.

    A program that was killed is started again on the rest. Where it dies without having finished
    anything, the case at which it died is left out, so that one case cannot hold up the others.

    Parameters
    ----------
    part : Part
        What to compute.

    Returns
    -------
    tuple of int and str
        Worst exit status of the program (0 or 3 if it was never refused), and its message.
    """
    left_out: set[int] = set()
    while True:
        done = finished_in(part.folder, part.cases)
        rest = [case for case in part.cases if case not in done and case not in left_out]
        if not rest:
            return 0, ""
        status, message = run_attempt(part, rest)
        if status in (2, 4):
            return status, message
        if -status in (signal.SIGINT, signal.SIGTERM):
            return 3, "stopped before all cases were finished; call again to go on"
        if not finished_in(part.folder, part.cases) > done:
            left_out.add(rest[0])


def run_attempt(part: Part, cases: list[int]) -> tuple[int, str]:
    """Run the program once, in a folder of its own.

    Parameters
    ----------
    part : Part
        The part.
    cases : list of int
        Which of its cases.

    Returns
    -------
    tuple of int and str
        Exit status and what it printed on standard error.
    """
    folder = part.folder / f"{cases[0]}-{cases[-1]}.{uuid.uuid4().hex}"
    command = [str(part.dda), "run", str(part.deck), "--out", str(folder), "--quiet"]
    command += ["--jobs", str(part.jobs), "--cases", ranges_of(cases)]
    for setting in part.settings:
        command += ["--set", setting]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    return done.returncode, done.stderr.strip()


def finished_in(folder: Path, cases: Iterable[int]) -> set[int]:
    """Which cases some attempt has finished.

    Parameters
    ----------
    folder : Path
        Folder of the parts.
    cases : iterable of int
        Cases to look for.

    Returns
    -------
    set of int
        Those that have a whole row.
    """
    wanted = set(cases)
    if not wanted:
        return set()
    low, high = min(wanted), max(wanted)
    found: set[int] = set()
    for attempt in folder.iterdir() if folder.is_dir() else ():
        first, _, last = attempt.name.partition(".")[0].partition("-")
        if first.isdigit() and last.isdigit() and int(first) <= high and int(last) >= low:
            found |= finished_by(attempt) & wanted
    return found


def finished_by(attempt: Path) -> set[int]:
    """Which cases an attempt has finished: a whole row of results.csv is written last.

    Parameters
    ----------
    attempt : Path
        Folder of the attempt.

    Returns
    -------
    set of int
        Numbers of its cases.
    """
    try:
        with (attempt / "results.csv").open("rb") as file:
            text = file.read(trusted_length(attempt)).decode("utf-8", errors="replace")
    except OSError:
        return set()
    rows = csv.reader(text[: text.rfind("\n") + 1].splitlines())
    header = next(rows, ["case"])
    place = header.index("case")
    return {int(row[place]) for row in rows if len(row) == len(header)}


def trusted_length(attempt: Path) -> int:
    """Up to where the rows of results.csv count.

    Parameters
    ----------
    attempt : Path
        Folder of the attempt.

    Returns
    -------
    int
        Bytes: -1 for all of them, unless disk.record tells of another machine, or of this one
        before it was started anew: then what was on the disk for certain.
    """
    try:
        length, _, start = (attempt / "disk.record").read_text(encoding="utf-8").partition(" ")
    except FileNotFoundError:
        return -1
    if start.strip() == start_name():
        return -1
    return int(length) if length.isdigit() else 0


def start_name() -> str:
    """What the system calls the time since its start; a dash where it has no name for it."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="utf-8").strip()
    except OSError:
        return "-"


def ranges_of(cases: list[int]) -> str:
    """Case numbers as --cases wants them.

    Parameters
    ----------
    cases : list of int
        Rising numbers.

    Returns
    -------
    str
        Such as "1-4,7".
    """
    ranges: list[list[int]] = []
    for case in cases:
        if ranges and case == ranges[-1][1] + 1:
            ranges[-1][1] = case
        else:
            ranges.append([case, case])
    return ",".join(str(low) if low == high else f"{low}-{high}" for low, high in ranges)
