"""One part of a campaign: run by a worker, wherever that is.

Everything here and in case_set uses the standard library alone, so that a worker, which receives both modules,
needs no more than Python, the program `dda` and the folder of the campaign. No two attempts write to the same
file: each has a folder of its own, and what an attempt before it has finished is not computed again. So a worker
may be killed at any moment, and its program may even go on without it. Tables are read line by line.
"""

from __future__ import annotations

import csv
import hashlib
import signal
import subprocess
import uuid
from array import array
from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass
from pathlib import Path

from voussoir.campaign.case_set import CaseSet

#: Digests of an attempt's tables, written when its program has ended
SEAL = "tables.sha256"


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
    #: Numbers of the cases, ascending
    cases: Sequence[int]
    #: Cases computed at the same time
    jobs: int = 1
    #: Text of deck.record that attempts must have; None for any
    record: str | None = None
    #: First lines of the tables by their names
    headers: dict[str, str] | None = None


def run_part(part: Part) -> tuple[int, str]:
    """Compute the cases of a part that no attempt has finished yet: worst exit status of the program, and its message.

    A program that was killed is started again on the rest. Where it dies without having finished anything, the case at
    which it died is left out, so that one case cannot hold up the others.
    """
    left_out: set[int] = set()
    done = finished_in(part.folder, part.cases, part.record, part.headers)
    while True:
        rest = [case for case in part.cases if case not in done and case not in left_out]
        if not rest:
            return 0, ""
        status, message = run_attempt(part, rest)
        if status in (2, 4):
            return status, message
        if status in (0, 3):  # it ended by itself: all are finished
            return 0, ""
        if -status in (signal.SIGINT, signal.SIGTERM):
            return 3, "stopped before all cases were finished; call again to go on"
        before, done = done, finished_in(part.folder, part.cases, part.record, part.headers)
        if not len(done) > len(before):
            left_out.add(rest[0])


def run_attempt(part: Part, cases: list[int]) -> tuple[int, str]:
    """Run the program once, in a folder of its own: exit status, and what it printed on standard error."""
    folder = part.folder / f"{cases[0]}-{cases[-1]}.{uuid.uuid4().hex}"
    command = [str(part.dda), "run", str(part.deck), "--out", str(folder), "--quiet"]
    command += ["--jobs", str(part.jobs), "--cases", ranges_of(cases)]
    for setting in part.settings:
        command += ["--set", setting]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode in (0, 3):
        if part.record is not None and content_of(folder / "deck.record") != part.record.encode():
            return 2, (
                f"{part.deck}:1: error: expected the deck and its files as they were when the "
                "campaign began, got changed ones; call again with --anew"
            )
        write_seal(folder)
    return done.returncode, done.stderr.strip()


def finished_in(
    folder: Path, cases: Iterable[int], record: str | None = None, headers: dict[str, str] | None = None,
    problems: list[str] | None = None) -> Set[int]:
    """Which cases some attempt has finished; the options are those of `finished_by`."""
    wanted = CaseSet(cases)
    if not wanted:
        return wanted
    low, high = next(iter(wanted)), max(wanted)
    found = CaseSet()
    for attempt in sorted(folder.iterdir()) if folder.is_dir() else ():
        span = span_of(attempt)
        if span and span[0] <= high and span[-1] >= low:
            for case in finished_by(attempt, record, headers, problems):
                if case in wanted:
                    found.add(case)
    return found


def span_of(attempt: Path) -> range | None:
    """Cases between the first and the last one that an attempt was made for, by its name."""
    first, _, last = attempt.name.partition(".")[0].partition("-")
    return range(int(first), int(last) + 1) if first.isdecimal() and last.isdecimal() else None


def finished_by(
    attempt: Path, record: str | None = None, headers: dict[str, str] | None = None, problems: list[str] | None = None
) -> Set[int]:
    """Which cases an attempt has finished: a whole row of results.csv is written last.

    Parameters
    ----------
    record : str, optional
        Text that its deck.record must have; with another one it has finished nothing.
    headers : dict of str to str, optional
        First lines of its tables; where one has another first line, or rows of other sizes than
        sizes.record tells, nothing is taken from them.
    problems : list of str, optional
        Receives a line for each thing that is damaged, with file and line.
    """
    said = [] if problems is None else problems
    if not (attempt / "results.csv").exists():
        return CaseSet()
    try:
        return _finished_by(attempt, record, headers or {}, said)
    except (OSError, csv.Error) as error:
        said.append(f"{attempt / 'results.csv'}:1: warning: expected a table, got: {error}")
        return CaseSet()


def _finished_by(attempt: Path, record: str | None, headers: dict[str, str], said: list[str]) -> Set[int]:
    """Which cases an attempt has finished; failures are exceptions."""
    if record is not None and content_of(attempt / "deck.record") != record.encode():
        said.append(
            f"{attempt / 'deck.record'}:1: warning: expected the record of this campaign, "
            "got another one; nothing of this folder is taken"
        )
        return CaseSet()
    for name, header in headers.items():
        if first_line(attempt / name) != header.encode():
            said.append(
                f"{attempt / name}:1: warning: expected the first line '{header}', got "
                "another one; its cases are computed again"
            )
            return CaseSet()
    broken = broken_seal(attempt)
    if broken:
        said.append(
            f"{attempt / broken}:1: warning: expected the table as it was written, got a "
            "damaged one; its cases are computed again"
        )
        return CaseSet()
    cases = whole_rows(attempt, said)
    if "sizes.record" not in headers or not cases or (attempt / SEAL).is_file():
        return cases  # what is sealed was written to its end
    had = bytes_of_cases(attempt, headers, max(cases))
    kept = CaseSet()
    for case, size in told_sizes(attempt):
        if case in cases and size == had[case]:
            kept.add(case)
    lost = next((case for case in cases if case not in kept), None)
    if lost is not None:
        said.append(
            f"{attempt / 'sizes.record'}:1: warning: expected the bytes that case {lost} has "
            "in the tables, got others; it is computed again"
        )
    return kept


def whole_rows(attempt: Path, said: list[str]) -> CaseSet:
    """Cases with a whole row in results.csv."""
    span, found, trusted = span_of(attempt), CaseSet(), trusted_length(attempt)
    with (attempt / "results.csv").open("rb") as file:
        header = file.readline()
        names = fields_of(header, ".csv") if header.endswith(b"\n") else []
        if "case" not in names:
            said.append(f"{attempt / 'results.csv'}:1: warning: expected a column case, got none")
            return found
        column, count, read = names.index("case"), len(names), len(header)
        for number, line in enumerate(file, 2):
            read += len(line)
            if not line.endswith(b"\n") or 0 <= trusted < read:
                break
            case = case_of(line, column, count)
            if case and (span is None or case in span):
                found.add(case)
            else:
                said.append(
                    f"{attempt / 'results.csv'}:{number}: warning: expected a row of {count} cells with its case, got "
                    "another one; its case is computed again"
                )
    return found


def bytes_of_cases(attempt: Path, headers: dict[str, str], last: int) -> array[int]:
    """Bytes that each case up to the last one has in the tables."""
    had = array("q", bytes(8 * (last + 1)))
    for name in set(headers) - {"results.csv", "sizes.record"}:
        for case, start, stop in slices_of(attempt / name):
            if case <= last:
                had[case] += stop - start
    return had


def told_sizes(attempt: Path) -> Iterator[tuple[int, int]]:
    """Cases with their bytes as sizes.record tells them."""
    with (attempt / "sizes.record").open("rb") as file:
        file.readline()
        for line in file:
            case, size, *_ = [*line.rstrip(b"\n").split(b","), b""]
            if line.endswith(b"\n") and case.isdigit() and size.isdigit():
                yield int(case), int(size)


def write_seal(folder: Path) -> None:
    """Write the digests of all tables beside them."""
    lines = [
        f"{digest_of(path)} {path.name}\n"
        for path in sorted(folder.iterdir())
        if path.suffix in (".csv", ".txt") or path.name == "sizes.record"
    ]
    (folder / SEAL).write_text("".join(lines), encoding="utf-8")


def broken_seal(folder: Path) -> str:
    """The first table that is not as it was sealed; empty if all are, or nothing was sealed."""
    for line in content_of(folder / SEAL).decode("utf-8", errors="replace").splitlines():
        digest, _, name = line.partition(" ")
        if not name or "/" in name or digest_of(folder / name) != digest:
            return name.replace("/", "") or SEAL
    return ""


def digest_of(file: Path) -> str:
    """SHA-256 of a file; empty if there is none."""
    if not file.is_file():
        return ""
    digest = hashlib.sha256()
    with file.open("rb") as stream:
        while piece := stream.read(1 << 20):
            digest.update(piece)
    return digest.hexdigest()


def first_line(file: Path) -> bytes:
    """The first line of a file without its end; empty if there is none."""
    if not file.is_file():
        return b""
    with file.open("rb") as stream:
        return stream.readline().rstrip(b"\n")


def content_of(file: Path) -> bytes:
    """Bytes of a file; none if it is not there."""
    return file.read_bytes() if file.is_file() else b""


def slices_of(table: Path) -> Iterator[tuple[int, int, int]]:
    """Case, first byte and the byte behind the last one of its rows; rows that follow one another are one slice.

    A row that was cut off is left out.
    """
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


def trusted_length(attempt: Path) -> int:
    """Up to where the rows of results.csv count [bytes], -1 for all of them.

    That is all unless disk.record tells of another machine, or of this one before it was started anew: then it is what
    was on the disk for certain.
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
    """Case numbers as --cases wants them, such as "1-4,7"."""
    ranges: list[list[int]] = []
    for case in cases:
        if ranges and case == ranges[-1][1] + 1:
            ranges[-1][1] = case
        else:
            ranges.append([case, case])
    return ",".join(str(low) if low == high else f"{low}-{high}" for low, high in ranges)
