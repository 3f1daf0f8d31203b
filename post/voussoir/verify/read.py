"""Rows of the tables of a run as texts whose numbers have been checked; damage is an error with file and line."""

from __future__ import annotations

import csv
import math
from io import StringIO
from pathlib import Path

from voussoir.files import read_text
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
