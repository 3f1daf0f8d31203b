"""The parts of a campaign into the tables that one run would have written.

Rows are sorted by case, and each case is taken whole from one attempt, so the tables do not depend
on who computed what (`seconds` aside). Only places are held in memory, never the tables.
"""

from __future__ import annotations

import csv
import os
import re
import shutil
import uuid
from array import array
from collections.abc import Callable, Set
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np

from voussoir.campaign.part import SEAL, finished_by, slices_of, write_seal

#: Tables with a case in each row
TABLES = (
    "joints.csv", "blocks.csv", "proof_forces.csv", "proof_motion.csv", "log.txt", "frames.csv", "frame_joints.csv",
    "points.csv", "energy.csv", "reactions.csv", "bars.csv", "sizes.record", "results.csv")


#: Bytes that are copied at a time
_PIECE = 1 << 20
#: Where the rows of a case are: number of the table, first byte, byte behind the last
_PLACE = np.dtype([("case", "i8"), ("number", "i4"), ("start", "i8"), ("stop", "i8")])


@dataclass(frozen=True)
class Summary:
    """What a merged table holds."""

    #: Cases with a row
    cases: int
    #: Those of them that are undecided
    undecided: int


class Owner:
    """The attempt that each case is taken from: the first that has it."""

    def __init__(self) -> None:
        #: Attempts that have a case, in the order in which they came
        self.attempts: list[Path] = []
        self._place = array("i")

    def take(self, case: int, attempt: Path) -> None:
        """Give a case to an attempt, unless another one has it."""
        if case >= len(self._place):
            self._place.extend([-1] * (case + 1 - len(self._place)))
        if self._place[case] >= 0:
            return
        if self.attempts[-1:] != [attempt]:
            self.attempts.append(attempt)
        self._place[case] = len(self.attempts) - 1

    def get(self, case: int) -> Path | None:
        """The attempt of a case."""
        place = self._place[case] if case < len(self._place) else -1
        return self.attempts[place] if place >= 0 else None


def merge(parts: Path, out: Path, record: str | None = None, headers: dict[str, str] | None = None) -> None:
    """Merge all parts into the folder of the campaign; each table is replaced at once.

    What that folder has of the same campaign is a part like the others; `record` and `headers` are as of `finished_by`.
    """
    candidates = [*([out] if record else []), *(sorted(parts.iterdir()) if parts.is_dir() else ())]
    owner = Owner()
    spans: list[tuple[int, int, Path]] = []
    in_order = True
    for attempt in candidates:
        cases = finished_by(attempt, record, headers)
        for case in cases:
            owner.take(case, attempt)
        if cases:
            in_order &= getattr(cases, "in_order", False) and (attempt / SEAL).is_file()
            spans.append((next(iter(cases)), max(cases), attempt))
    attempts = owner.attempts or [path for path in candidates if (path / "results.csv").exists()][:1]
    spans.sort()
    if in_order and spans and all(one[1] < other[0] for one, other in zip(spans, spans[1:])):
        ordered = [attempt for _, _, attempt in spans]
    else:
        ordered = []
    (out / SEAL).unlink(missing_ok=True)
    (out / "disk.record").unlink(missing_ok=True)  # of another run: these tables are written whole
    for name in TABLES:
        if headers is not None and name not in headers:
            (out / name).unlink(missing_ok=True)  # of another deck
        elif ordered:
            join_tables(name, ordered, out, headers)
        else:
            merge_table(name, attempts, owner, out, headers)
    copy_pictures(attempts, owner, out)
    if record is not None:
        replace(out / "deck.record", lambda file: file.write(record.encode()))
    write_seal(out)


def join_tables(name: str, attempts: list[Path], out: Path, headers: dict[str, str] | None = None) -> None:
    """Put one table of attempts one behind the other: each has its cases in order, and all before the next one.

    Every case is written to all tables before the next one is, so that the order of one is that of all.
    """
    sources = [attempt / name for attempt in attempts if (attempt / name).exists()]
    if not sources:
        return

    def write(file: BinaryIO) -> None:
        for source in sources:
            with source.open("rb") as body:
                header = body.readline()
                if source is sources[0]:
                    file.write(header if headers is None else headers[name].encode() + b"\n")
                shutil.copyfileobj(body, file, _PIECE)

    replace(out / name, write)


def merge_table(
    name: str, attempts: list[Path], owner: Owner, out: Path, headers: dict[str, str] | None = None
) -> None:
    """Merge one table, sorted by case, each case from its owner; it is left out where no attempt has one."""
    sources = [attempt / name for attempt in attempts if (attempt / name).exists()]
    if not sources:
        return
    with sources[0].open("rb") as first:
        header = first.readline()
    if headers is not None:
        header = headers[name].encode() + b"\n"
    found = (
        (case, number, start, stop)
        for number, source in enumerate(sources)
        for case, start, stop in slices_of(source)
        if owner.get(case) == source.parent
    )
    places = np.fromiter(found, dtype=_PLACE)
    if name in ("results.csv", "log.txt", "sizes.record"):  # a row a case, however often it was written
        places = places[np.unique(places["case"], return_index=True)[1]]
    places.sort(order=("case", "number", "start"))
    # what lies one behind the other is copied at once
    first = np.ones(len(places), dtype=bool)
    first[1:] = (places["number"][1:] != places["number"][:-1]) | (places["start"][1:] != places["stop"][:-1])
    stops = places["stop"][np.append(first[1:], True)] if len(places) else []

    def write(file: BinaryIO) -> None:
        file.write(header)
        opened, at = None, -1
        for place, stop in zip(places[first], stops):
            number, start = int(place["number"]), int(place["start"])
            if number != at:
                if opened:
                    opened.close()
                opened, at = sources[number].open("rb"), number
            opened.seek(start)
            for at_byte in range(start, stop, _PIECE):
                file.write(opened.read(min(_PIECE, stop - at_byte)))
        if opened:
            opened.close()

    replace(out / name, write)


def copy_pictures(attempts: list[Path], owner: Owner, out: Path) -> None:
    """Move the files of single cases into the folder of the campaign."""
    for attempt in attempts:
        for path in [*attempt.glob("*/case_*"), *attempt.glob("case_*")]:
            case = re.match(r"case_(\d+)", path.name)
            if case and attempt != out and owner.get(int(case[1])) == attempt:
                copy = out / path.relative_to(attempt)
                copy.parent.mkdir(exist_ok=True)
                shutil.copy2(path, copy)


def merged(out: Path, cases: Set[int]) -> Summary:
    """Count what a merged table holds."""
    if not cases:
        return Summary(0, 0)
    with (out / "results.csv").open("rb") as file:
        # most rows are told apart without parting them
        doubtful = [line for line in file if b"undecided" in line or line.startswith(b"deck,")]
    rows = csv.reader(line.decode("utf-8", "replace") for line in doubtful)
    verdict = next(rows).index("verdict")
    return Summary(len(cases), sum(row[verdict] == "undecided" for row in rows))


def replace(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file under another name, then give it its own: it is never there by halves."""
    part = path.with_name(f"{path.name}.{uuid.uuid4().hex}.part")
    try:
        with part.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
