"""The parts of a campaign into the tables that one run would have written, sorted by case.

Each case is taken whole from one part, so the tables do not depend on who computed what (`seconds` aside). Only places
are held in memory, never the tables.
"""

from __future__ import annotations

import csv
import os
import re
import shutil
import uuid
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import IO, BinaryIO

import numpy as np

from voussoir.campaign.part import cases_of, slices_of
from voussoir.files import fresh

#: Tables with a case in each row
TABLES = (
    "joints.csv", "blocks.csv", "proof_forces.csv", "proof_motion.csv", "log.txt", "frames.csv", "frame_joints.csv",
    "points.csv", "energy.csv", "reactions.csv", "bars.csv", "sizes.record", "results.csv")
#: Bytes that are copied at a time
_PIECE = 1 << 20
#: Where the rows of a case are: number of the part, first byte, byte behind the last
_PLACE = np.dtype([("case", "i8"), ("number", "i4"), ("start", "i8"), ("stop", "i8")])


def owners(parts: list[Path], total: int) -> tuple[np.ndarray, bool]:
    """Number of the part that each case is taken from, the first that has finished it, -1 for none: (total + 1).

    And whether the parts one behind the other are all cases in order: every case is written to all tables before the
    next one is, so that the order of one table is that of all.
    """
    owner, last, tidy = np.full(total + 1, -1, dtype="i4"), 0, True
    for number, part in enumerate(parts):
        cases = np.fromiter((case for case in cases_of(part / "results.csv") if case <= total), dtype="i8")
        tidy = tidy and bool(np.array_equal(cases, np.arange(last + 1, last + len(cases) + 1)))
        last += len(cases)
        owner[cases[owner[cases] < 0]] = number
    return owner, tidy and last == total


def merge(parts: list[Path], total: int, out: Path, record: str, headers: dict[str, str]) -> np.ndarray:
    """Merge parts into the folder of the campaign, each case from its owner: the owners.

    Each table, by its name and first line, is replaced at once.
    """
    owner, tidy = owners(parts, total)
    for name in TABLES:
        if name not in headers or not any((part / name).exists() for part in parts):
            (out / name).unlink(missing_ok=True)  # of another deck
        elif tidy:
            join_table(name, headers[name], parts, out)
        else:
            merge_table(name, headers[name], parts, owner, out)
    for number, part in enumerate(parts):
        copy_pictures(part, owner == number, out)
    replace(out / "deck.record", lambda file: file.write(record.encode()))
    return owner


def join_table(name: str, header: str, parts: list[Path], out: Path) -> None:
    """Put one table of parts one behind the other."""

    def write(file: BinaryIO) -> None:
        file.write(header.encode() + b"\n")
        for source in (part / name for part in parts if (part / name).exists()):
            with source.open("rb") as body:
                body.readline()
                shutil.copyfileobj(body, file, _PIECE)

    replace(out / name, write)


def merge_table(name: str, header: str, parts: list[Path], owner: np.ndarray, out: Path) -> None:
    """Merge one table, sorted by case, each case from its owner."""
    found = (
        (case, number, start, stop)
        for number, part in enumerate(parts)
        for case, start, stop in slices_of(part / name)
        if case < len(owner) and owner[case] == number
    )
    places = np.fromiter(found, dtype=_PLACE)
    places.sort(order=("case", "number", "start"))
    # what lies one behind the other is copied at once
    first = np.ones(len(places), dtype=bool)
    first[1:] = (places["number"][1:] != places["number"][:-1]) | (places["start"][1:] != places["stop"][:-1])
    stops = places["stop"][np.append(first[1:], True)] if len(places) else []

    def write(file: BinaryIO) -> None:
        file.write(header.encode() + b"\n")
        opened: IO[bytes] | None = None
        at = -1
        for place, stop in zip(places[first], stops):
            number, start = int(place["number"]), int(place["start"])
            if opened is None or number != at:
                if opened:
                    opened.close()
                opened, at = (parts[number] / name).open("rb"), number
            opened.seek(start)
            for at_byte in range(start, stop, _PIECE):
                file.write(opened.read(min(_PIECE, stop - at_byte)))
        if opened:
            opened.close()

    replace(out / name, write)


def copy_pictures(part: Path, owned: np.ndarray, out: Path) -> None:
    """Copy the files of a part's own cases into the folder of the campaign."""
    for path in [*part.glob("*/case_*"), *part.glob("case_*")]:
        case = re.match(r"case_(\d+)", path.name)
        if case and part != out and int(case[1]) < len(owned) and owned[int(case[1])]:
            copy = out / path.relative_to(part)
            if copy.parent != out:
                fresh(copy.parent).mkdir(exist_ok=True)
            shutil.copy2(path, fresh(copy))


def count_verdicts(out: Path) -> Counter[str]:
    """Number of cases of each verdict in a merged table; none where there is no table."""
    if not (out / "results.csv").is_file():
        return Counter()
    with (out / "results.csv").open(encoding="utf-8", errors="replace", newline="") as file:
        rows = csv.reader(file)
        place = next(rows).index("verdict")
        return Counter(row[place] for row in rows)


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
