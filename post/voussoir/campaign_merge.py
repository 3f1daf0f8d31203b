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
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from voussoir.campaign_part import finished_by

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


def merge(parts: Path, out: Path) -> None:
    """Merge all parts into the folder of the campaign; each table is replaced at once.

    Parameters
    ----------
    parts : Path
        Folder of the parts.
    out : Path
        Folder of the campaign.
    """
    attempts = sorted(path for path in parts.iterdir() if (path / "results.csv").exists())
    owner: dict[int, Path] = {}
    for attempt in attempts:
        for case in finished_by(attempt):
            owner.setdefault(case, attempt)
    (out / "disk.record").unlink(missing_ok=True)  # of another run: these tables are written whole
    for name in TABLES:
        merge_table(name, attempts, owner, out)
    copy_pictures(attempts, owner, out)
    records = [attempt / "deck.record" for attempt in attempts]
    for record in [path for path in records if path.exists()][:1]:
        replace(out / "deck.record", lambda file: file.write(record.read_bytes()))


def merge_table(name: str, attempts: list[Path], owner: dict[int, Path], out: Path) -> None:
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
    """
    sources = [attempt / name for attempt in attempts if (attempt / name).exists()]
    if not sources:
        return
    with sources[0].open("rb") as first:
        header = first.readline()
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


def slices_of(table: Path) -> Iterator[tuple[int, int, int]]:
    """Where the rows of each case are; rows of one case that follow one another are one slice.

    Parameters
    ----------
    table : Path
        One of TABLES.

    Yields
    ------
    tuple of int
        Case, first byte, byte behind the last one. A row that was cut off is left out.
    """
    with table.open("rb") as file:
        header = fields_of(file.readline(), table.suffix)
        column = header.index("case")
        case, start, stop = 0, 0, file.tell()
        for line in file:
            fields = fields_of(line, table.suffix)
            whole = line.endswith(b"\n") and (len(fields) == len(header) or table.suffix == ".txt")
            this = int(fields[column]) if whole and fields[column].isdigit() else 0
            if this != case:
                if case:
                    yield case, start, stop
                case, start = this, stop
            stop += len(line)
        if case:
            yield case, start, stop


def fields_of(line: bytes, suffix: str) -> list[str]:
    """Fields of a row: parted by commas, in the log by blanks.

    Parameters
    ----------
    line : bytes
        The row.
    suffix : str
        Ending of the file.

    Returns
    -------
    list of str
        The fields.
    """
    text = line.decode("utf-8", errors="replace").rstrip("\n")
    if suffix == ".txt":
        return text.split(" ")
    return next(csv.reader([text]), [""]) if '"' in text else text.split(",")


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
        for path in attempt.glob("*/case_*"):
            case = re.match(r"case_(\d+)", path.name)
            if case and owner.get(int(case[1])) == attempt:
                (out / path.parent.name).mkdir(exist_ok=True)
                shutil.copy2(path, out / path.parent.name / path.name)


def merged(out: Path) -> Summary:
    """Count what a merged table holds.

    Parameters
    ----------
    out : Path
        Folder of the campaign.

    Returns
    -------
    Summary
        Nothing where there is no table yet.
    """
    if not (out / "results.csv").exists():
        return Summary(0, 0)
    with (out / "results.csv").open(newline="", encoding="utf-8", errors="replace") as file:
        verdicts = [row["verdict"] for row in csv.DictReader(file)]
    return Summary(len(verdicts), verdicts.count("undecided"))


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
