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
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from voussoir.campaign.part import SEAL, finished_by, slices_of, write_seal

#: Tables with a case in each row
TABLES = (
    "joints.csv",
    "blocks.csv",
    "proof_forces.csv",
    "proof_motion.csv",
    "log.txt",
    "frames.csv",
    "frame_joints.csv",
    "points.csv",
    "energy.csv",
    "reactions.csv",
    "bars.csv",
    "sizes.record",
    "results.csv",
)


@dataclass(frozen=True)
class Summary:
    """What a merged table holds."""

    #: Cases with a row
    cases: int
    #: Those of them that are undecided
    undecided: int


def merge(
    parts: Path, out: Path, record: str | None = None, headers: dict[str, str] | None = None
) -> None:
    """Merge all parts into the folder of the campaign; each table is replaced at once.

    What that folder has of the same campaign is a part like the others.

    Parameters
    ----------
    parts : Path
        Folder of the parts.
    out : Path
        Folder of the campaign.
    record, headers : optional
        As of `finished_by`.
    """
    owner: dict[int, Path] = {}
    candidates = [*([out] if record else []), *(sorted(parts.iterdir()) if parts.is_dir() else ())]
    for attempt in candidates:
        for case in finished_by(attempt, record, headers):
            owner.setdefault(case, attempt)
    attempts = [path for path in candidates if path in set(owner.values())]
    if not attempts:
        attempts = [path for path in candidates if (path / "results.csv").exists()][:1]
    (out / SEAL).unlink(missing_ok=True)
    (out / "disk.record").unlink(missing_ok=True)  # of another run: these tables are written whole
    for name in TABLES:
        if headers is not None and name not in headers:
            (out / name).unlink(missing_ok=True)  # of another deck
        else:
            merge_table(name, attempts, owner, out, headers)
    copy_pictures(attempts, owner, out)
    if record is not None:
        replace(out / "deck.record", lambda file: file.write(record.encode()))
    write_seal(out)


def merge_table(
    name: str,
    attempts: list[Path],
    owner: dict[int, Path],
    out: Path,
    headers: dict[str, str] | None = None,
) -> None:
    """Merge one table, sorted by case.

    Parameters
    ----------
    name : str
        Name of its file.
    attempts : list of Path
        Folders of the attempts.
    owner : dict of int to Path
        For each case the attempt that it is taken from.
    out : Path
        Folder of the campaign; the table is left out where no attempt has one.
    headers : dict of str to str, optional
        First lines of the tables.
    """
    sources = [attempt / name for attempt in attempts if (attempt / name).exists()]
    if not sources:
        return
    with sources[0].open("rb") as first:
        header = first.readline()
    if headers is not None:
        header = headers[name].encode() + b"\n"
    places = [
        (case, number, start, stop)
        for number, source in enumerate(sources)
        for case, start, stop in slices_of(source)
        if owner.get(case) == source.parent
    ]
    if name in ("results.csv", "log.txt", "sizes.record"):  # a row a case, however often it was written
        places = list({place[0]: place for place in reversed(places)}.values())
    places.sort()

    def write(file: BinaryIO) -> None:
        file.write(header)
        opened, at = None, -1
        for _, number, start, stop in places:
            if number != at:
                if opened:
                    opened.close()
                opened, at = sources[number].open("rb"), number
            opened.seek(start)
            file.write(opened.read(stop - start))
        if opened:
            opened.close()

    replace(out / name, write)


def copy_pictures(attempts: list[Path], owner: dict[int, Path], out: Path) -> None:
    """Move the files of single cases into the folder of the campaign.

    Parameters
    ----------
    attempts : list of Path
        Folders of the attempts.
    owner : dict of int to Path
        For each case the attempt that it is taken from.
    out : Path
        Folder of the campaign.
    """
    for attempt in attempts:
        for path in [*attempt.glob("*/case_*"), *attempt.glob("case_*")]:
            case = re.match(r"case_(\d+)", path.name)
            if case and attempt != out and owner.get(int(case[1])) == attempt:
                copy = out / path.relative_to(attempt)
                copy.parent.mkdir(exist_ok=True)
                shutil.copy2(path, copy)


def merged(out: Path, cases: set[int]) -> Summary:
    """Count what a merged table holds.

    Parameters
    ----------
    out : Path
        Folder of the campaign.
    cases : set of int
        Cases of it that are whole.

    Returns
    -------
    Summary
        How many of them there are, and how many are undecided.
    """
    if not cases:
        return Summary(0, 0)
    with (out / "results.csv").open(newline="", encoding="utf-8", errors="replace") as file:
        rows = csv.DictReader(file)
        return Summary(len(cases), [row["verdict"] for row in rows].count("undecided"))


def replace(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file under another name, then give it its own: it is never there by halves.

    Parameters
    ----------
    path : Path
        Name of the file.
    write : callable
        Takes the open file.
    """
    part = path.with_name(f"{path.name}.{uuid.uuid4().hex}.part")
    try:
        with part.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
