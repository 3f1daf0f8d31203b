"""Campaigns: the cases of one deck, computed by many processes, merged into one table."""

from __future__ import annotations

import fcntl
import hashlib
import shutil
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from voussoir.campaign.merge import replace
from voussoir.campaign.part import Part, run_part
from voussoir.dda_program import Asked, DdaError, ask

#: Most cases of a part, and parts a worker: all are to end at about the same time
LARGEST_PART, PARTS_A_WORKER = 10000, 8
#: Begin of results.csv, by which it is known
_ORIGIN = b"deck,case"
#: Folders that this process has, with their open lock files
_LOCKS: dict[Path, BinaryIO] = {}
#: Status and message of a part
Outcome = tuple[int, str]
#: Computes parts and yields the outcome of each as it ends
Engine = Callable[[list[Part]], Iterator[Outcome]]


@dataclass(frozen=True)
class Campaign:
    """What is computed, and where its results go."""

    dda: Path  #: The program dda
    deck: Path  #: The deck
    settings: tuple[str, ...]  #: Values of --set
    out: Path  #: Folder of the results
    total: int  #: Number of cases of the deck
    asked: Asked  #: What the deck asks for, as the program says it

    @property
    def parts(self) -> Path:
        """Folder of the parts."""
        return self.out / "parts"


def open_campaign(
    dda: Path, deck: Path, settings: list[str], out: Path, discard: bool, shared: bool = False,
) -> Campaign:
    """Start a campaign, or continue one: its folder exists and names its purpose.

    `discard` removes the results of an earlier one; a `shared` folder is that of a job array. DdaError if the
    deck is bad input, or the folder holds another campaign.
    """
    asked = ask(dda, deck, settings)
    campaign = Campaign(dda, deck.resolve(), tuple(settings), out, asked.cases, asked)
    out.mkdir(parents=True, exist_ok=True)
    lock(out, shared)
    file = out / "campaign.record"
    digest = hashlib.sha256(asked.record.encode()).hexdigest()
    text = f"{digest}\n{asked.record}"
    if not discard and not file.exists():
        check_origin(out / "results.csv")
    if discard:
        shutil.rmtree(campaign.parts, ignore_errors=True)
        for name in ("campaign.record", "deck.record", "results.csv"):
            (out / name).unlink(missing_ok=True)
    campaign.parts.mkdir(parents=True, exist_ok=True)
    known = content_of(file).decode(errors="replace")
    first, _, record = known.partition("\n")
    true = first == hashlib.sha256(record.encode(errors="replace")).hexdigest()
    if true and record != asked.record:
        raise DdaError(
            f"{deck}:1: error: expected the campaign that {out} was begun for, got another one (other "
            f"{changed_keys(record, asked.record)}); choose another --out, or discard its contents with --discard")
    if known != text:
        if content_of(out / "deck.record") != asked.record.encode():
            (out / "results.csv").unlink(missing_ok=True)  # of whatever was there before
        replace(file, lambda opened: opened.write(text.encode()))
    return campaign


def check_origin(table: Path) -> None:
    """Refuse to replace a table that dda has not written: its first line begins otherwise; DdaError of status 4."""
    if table.is_symlink() or not table.is_file():
        return
    with table.open("rb") as file:
        begin = file.read(len(_ORIGIN))
    if not begin.startswith(_ORIGIN) and not _ORIGIN.startswith(begin):
        raise DdaError(
            f"{table}:1: error: expected a table that begins with {_ORIGIN.decode()}, got a file that dda has not "
            "written; choose another --out, or discard its contents with --discard", 4)


def changed_keys(old: str, new: str) -> str:
    """Differences between two records: keys, "program" (another build), "name of the deck", "files"."""

    def values(record: str) -> dict[str, list[str]]:
        lines = record.splitlines() or [""]
        program, _, deck = lines[0].partition(" on ")
        found: dict[str, list[str]] = {"program": [program], "name of the deck": [deck]}
        name = ""
        for line in lines[1:]:
            if line.startswith("files"):
                found["files"] = [line]
            elif line.startswith("  "):
                found[name].append(line)
            else:
                name = line
                found.setdefault(name, [])
        return found

    one, other = values(old), values(new)
    return ", ".join(sorted(key for key in {*one, *other} if one.get(key) != other.get(key)))


def content_of(file: Path) -> bytes:
    """Bytes of a file; none if it is not there."""
    return file.read_bytes() if file.is_file() else b""


def lock(out: Path, shared: bool) -> None:
    """Take a folder until this process ends, however it ends; shares of a job array take it together.

    DdaError of status 4 if another campaign or run has it.
    """
    name = out / "run.lock"
    if name.is_symlink():
        name.unlink()
    file = name.open("ab")
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError as error:
        file.close()
        raise DdaError(
            f"{out / 'run.lock'}:1: error: expected a folder that no other run or campaign writes "
            "to, got one in use; choose another folder with --out, or wait for that one to end",
            4,
        ) from error
    except OSError as error:
        sys.stderr.write(
            f"{out / 'run.lock'}:1: warning: this file system knows no locks "
            f"({error.strerror}): nothing keeps another campaign from {out}\n")
    _LOCKS[out] = file


def unlock(out: Path) -> None:
    """Give a folder back."""
    if out in _LOCKS:
        _LOCKS.pop(out).close()


def parts_of(campaign: Campaign, cases: range, workers: int) -> list[Part]:
    """Parts of which some of these cases are: those that were begun, and new ones of the rest, equal parts of all."""
    largest = max(1, min(LARGEST_PART, -(-len(cases) // (PARTS_A_WORKER * workers))))
    spans = begun(campaign)
    at, new = cases.start, []
    for first, last in [*sorted(spans), (cases.stop, cases.stop)]:
        new += [(low, min(low + largest, first, cases.stop) - 1) for low in range(at, min(first, cases.stop), largest)]
        at = max(at, last + 1)
    mine = [span for span in spans if span[0] < cases.stop and span[1] >= cases.start]
    return [
        Part(
            campaign.dda, campaign.deck, campaign.settings, spans.get(span, campaign.parts / f"{span[0]}-{span[1]}"),
            *span, campaign.asked.record)
        for span in sorted([*mine, *new])
    ]


def begun(campaign: Campaign) -> dict[tuple[int, int], Path]:
    """Folders of parts by their first and last cases; tables that were merged already are a part."""
    found = {}
    for folder in campaign.parts.iterdir() if campaign.parts.is_dir() else ():
        first, _, last = folder.name.partition("-")
        if first.isdecimal() and last.isdecimal() and 0 < int(first) <= int(last) <= campaign.total:
            found[int(first), int(last)] = folder
    if not found and content_of(campaign.out / "deck.record") == campaign.asked.record.encode():
        found[1, campaign.total] = campaign.out
    return found


def share(total: int, index: int, of: int) -> range:
    """Cases of one member of a job array, from 1; those of all members are all cases, each once."""
    return range((index - 1) * total // of + 1, index * total // of + 1)


def local_engine(workers: int) -> Engine:
    """Processes on this machine."""

    def run(parts: list[Part]) -> Iterator[Outcome]:
        with ThreadPoolExecutor(workers) as pool:
            futures = [pool.submit(run_part, part) for part in parts]
            try:
                for future in as_completed(futures):
                    yield future.result()
            finally:
                pool.shutdown(cancel_futures=True)

    return run


def run_parts(parts: list[Part], engine: Engine, shown: bool = False) -> Outcome:
    """Run all parts and report on standard error how many have ended: the worst status, 4 before 2, and its message."""
    worst, message = 0, ""
    for done, (status, text) in enumerate(engine(parts), start=1):
        if shown:
            sys.stderr.write(f"\rpart {done} of {len(parts)} " + "\n" * (done == len(parts)))
            sys.stderr.flush()
        if status == 4 or status == 2 and worst != 4:
            worst, message = status, text
        if worst:
            break
    return worst, message
