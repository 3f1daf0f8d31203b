"""Rows of the tables of a run as texts whose numbers have been checked, and their checksums.

Damage is an error with file and line.
"""

from __future__ import annotations

import csv
import math
import re
import zlib
from io import StringIO
from pathlib import Path

from voussoir.files import plain, read_text
from voussoir.verify.deck import VerifyError

Row = dict[str, str]
#: Columns that are used of each table: whole numbers, numbers, numbers that may be missing, words
COLUMNS: dict[str, tuple[str, str, str, str]] = {
    "results": ("case", "", "critical critical_low critical_high exact exact_low exact_high imbalance mechanism_power "
                "path_time worst_position", "verdict collapses_at worst_direction seconds"),
    "joints": ("case joint block_1 block_2", "x_intrados y_intrados x_extrados y_extrados normal_force shear_force x y "
               "force_x force_y", "eccentricity_ratio", ""),
    "blocks": ("case block", "x y", "u v", "state"),
    "proof_forces": ("case block_1 block_2", "x_1 y_1 x_2 y_2 normal_1", "value normal_2 shear", "kind"),
    "proof_motion": ("case block", "x y u v spin", "value", ""),
    "bars": ("case bar", "force", "", ""),
}
#: Tables that not every run leaves
OPTIONAL = ("bars",)
#: Texts of a row that are shown of a cell
SHOWN = 40


#: Tables whose lines are in the sum beside those of results.csv, where a run leaves them
SUMMED = (
    "joints.csv", "log.txt", "frames.csv", "frame_joints.csv", "points.csv", "energy.csv", "blocks.csv",
    "proof_forces.csv", "proof_motion.csv", "bars.csv", "reactions.csv",
)

#: A comma that parts two fields: an even number of quotes is behind it
_COMMA = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')


def read_table(path: Path) -> dict[int, list[Row]]:
    """Rows of a table by their case."""
    rows: dict[int, list[Row]] = {}
    if not path.exists():
        if path.stem in OPTIONAL:
            return rows
        raise VerifyError(f"no {path.name}: run the deck with output%joints = .true. and output%blocks = .true.")
    needed = COLUMNS[path.stem]
    reader = csv.reader(StringIO(read_text(path), newline=""), strict=True)
    try:
        names = next(reader, [])
        for name in " ".join(needed).split():
            if names.count(name) != 1:
                raise VerifyError(f"{path}:1: error: expected one column {name}, got {names.count(name)}")
        for cells in reader:
            place = f"{path}:{reader.line_num}: error: expected"
            if len(cells) != len(names):
                raise VerifyError(f"{place} {len(names)} cells, got {len(cells)}")
            row = dict(zip(names, cells))
            _check_numbers(row, needed, place)
            rows.setdefault(int(row["case"]), []).append(row)
    except csv.Error as error:
        raise VerifyError(f"{path}:{max(reader.line_num, 1)}: error: expected a table, got: {error}") from error
    return rows


def _check_numbers(row: Row, needed: tuple[str, str, str, str], place: str) -> None:
    """Check that the cells of a row are numbers where numbers are used."""
    whole, numbers, optional, _ = (names.split() for names in needed)
    for name in whole:
        if not (row[name].isascii() and row[name].isdigit() and len(row[name]) <= 10):
            raise VerifyError(f"{place} a whole number in column {name}, got {row[name][:SHOWN]!r}")
    for name in numbers + [name for name in optional if row[name]]:
        try:
            finite = math.isfinite(float(row[name]))
        except ValueError:
            finite = False
        if not finite:
            raise VerifyError(f"{place} a number in column {name}, got {row[name][:SHOWN]!r}")


def recorded_sums(folder: Path) -> dict[int, int]:
    """Sums that the program has written down: the sum of each case."""
    path = folder / "sizes.record"
    if not path.exists():
        raise VerifyError("no sizes.record: run the deck again, or check proofs alone by --ignore-sums")
    first, *lines = read_text(path).splitlines() or [""]
    if first != "case,bytes,sum":
        raise VerifyError("sizes.record has no checksums: run the deck again, or check proofs alone by --ignore-sums")
    sums = {}
    for number, line in enumerate(lines, 2):
        if not re.fullmatch(r"\d{1,10},\d{1,20},\d{1,10}", line, re.ASCII):
            raise VerifyError(f"{path}:{number}: error: expected a case, its bytes and their sum, got {line[:40]!r}")
        case, _, total = line.split(",")
        sums[int(case)] = int(total)
    return sums


def sums_of(folder: Path) -> dict[int, int]:
    """Sums of the tables as they are: CRC-32 of each line, added up for each case; lines of no case under 0."""
    sums = _sums_of_results(folder / "results.csv")
    for path in [folder / name for name in SUMMED]:
        if not path.exists():
            continue
        blank = b" " if path.suffix == ".txt" else b","
        with plain(path).open("rb") as lines:
            next(lines, None)
            for line in lines:
                word = line.split(blank, 1)[0]
                case = int(word) if word.isdigit() else 0
                sums[case] = (sums.get(case, 0) + zlib.crc32(line.rstrip(b"\n"))) % 2**32
    return sums


def _sums_of_results(table: Path) -> dict[int, int]:
    """Sums of the rows of results.csv, without their seconds: no two runs agree in these."""
    header, *rows = (_COMMA.split(line) for line in read_text(table).rstrip("\n").split("\n"))
    case, seconds = header.index("case"), header.index("seconds")
    sums: dict[int, int] = {}
    for row in rows:
        number = int(row[case]) if len(row) > case and row[case].isdigit() else 0
        row[seconds:seconds + 1] = [""] * (len(row) > seconds)
        sums[number] = (sums.get(number, 0) + zlib.crc32(",".join(row).encode())) % 2**32
    return sums
