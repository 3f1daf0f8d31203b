"""The tables of `dda run` as columns with types; damage is reported with file and line."""

from __future__ import annotations

import csv
from collections.abc import Callable, Collection, Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from voussoir.files import plain

#: Columns of whole numbers, by name; every other column of numbers has floats
_WHOLE = frozenset(
    "case blocks voussoirs steps open_close_iterations factorisations joint frame step block vertex point block_1 "
    "block_2".split())
#: Columns of words; what is left are numbers
_WORDS = frozenset(
    ("deck mode geometry verdict collapses_at collapse_mode springing_hinge state state_1 state_2 mechanism"
     " worst_direction").split()
)
#: What to do about a table that is damaged
_AGAIN = "run the deck again with --resume"
#: Rows that are text at one time: text takes ten times the memory of numbers
_AT_ONCE = 10000
#: Columns that a table must have, each once; results.csv has those of swept parameters beside them
_NEEDED = {
    "results.csv": (
        "deck case blocks half_angle_deg thickness_ratio friction_deg mode geometry verdict"
        " critical critical_low critical_high collapses_at exact relative_error collapse_mode"
        " sliding_share intrados_hinge_deg extrados_hinge_deg springing_hinge steps"
    ).split(),
    "joints.csv": (
        "case joint angle_deg x_intrados y_intrados x_extrados y_extrados normal_force shear_force eccentricity_ratio "
        "opening_intrados opening_extrados slip state block_1 block_2 x y force_x force_y mechanism slides_x slides_y"
    ).split(),
    "blocks.csv": "case block state vertex x y u v".split(),
    "frames.csv": "case frame step time block vertex x y".split(),
    "frame_joints.csv": "case frame joint x_1 y_1 x_2 y_2 x y force_x force_y state_1 state_2".split(),
    "points.csv": "case step time point x y u v vx vy".split(),
    "reactions.csv": "case time block point fx fy moment".split(),
}
#: Columns of several angles joined by semicolons
_LISTS = frozenset(("intrados_hinge_deg", "extrados_hinge_deg"))
#: Columns of numbers whatever is swept
_NUMBERS = frozenset(name for names in _NEEDED.values() for name in names) - _WHOLE - _WORDS - _LISTS


class DamagedTable(ValueError):
    """A table that dda does not write so: the message begins with file and line."""


#: Of the names of all columns those that are read
Choice = Callable[[list[str]], Collection[str]]


def read_pieces(
    file: Path, at_once: int | None, choice: Choice | None = None
) -> Iterator[tuple[list[str], list[np.ndarray]]]:
    """Names of a table's chosen columns, and these with their types of so many rows at one time (None: all).

    A table without rows has one piece. DamagedTable if dda does not write such a table.
    """
    try:
        with plain(file).open(newline="", encoding="utf-8") as lines:
            reader = csv.reader(lines)
            names = next(reader, [])
            lost = [name for name in _NEEDED.get(file.name, ("case",)) if names.count(name) != 1]
            if lost:
                found = names.count(lost[0])
                raise DamagedTable(f"{file}:1: error: expected one column {lost[0]}, got {found}; " + _AGAIN)
            kept = set(names if choice is None else choice(names))
            rows = [(reader.line_num, row) for row in islice(reader, at_once)]
            while True:
                yield [name for name in names if name in kept], _columns(file, names, rows, kept)
                rows = [(reader.line_num, row) for row in islice(reader, at_once)]
                if not rows:
                    return
    except (UnicodeDecodeError, csv.Error) as problem:
        raise DamagedTable(
            f"{file}:{_spoilt_line(file)}: error: expected a table, got: {problem}; " + _AGAIN) from problem


def read_columns(file: Path, at_once: int | None = _AT_ONCE, choice: Choice | None = None) -> dict[str, np.ndarray]:
    """Read a table's chosen columns with their types, as `read_pieces` does.

    Of a table in several pieces a column of one value is that value once, seen in each row, and cannot be written to.
    """
    names: list[str] = []
    pieces: list[list[np.ndarray]] = []
    for names, piece in read_pieces(file, at_once, choice):
        pieces.append([_once(column) for column in piece])
    columns = dict(zip(names, zip(*pieces)))
    if any(len({piece.dtype.kind for piece in column}) > 1 for column in columns.values()):
        return read_columns(file, None, choice)  # a swept parameter whose words are numbers here and there
    pieces.clear()  # each column is held twice only while it is joined
    return {name: _joined(columns.pop(name)) for name in list(columns)}


def _once(piece: np.ndarray) -> np.ndarray:
    """A column of one value in all rows as that value, seen in each row."""
    if len(piece) < 2:
        return piece
    if piece.dtype.kind == "O":  # tuples, whose comparison is that of arrays
        same = all(cell == piece[0] for cell in piece)
    else:
        same = np.array_equal(piece[1:], piece[:-1], equal_nan=piece.dtype.kind == "f")
    return np.broadcast_to(piece[:1].copy(), len(piece)) if same else piece


def _joined(pieces: tuple[np.ndarray, ...]) -> np.ndarray:
    """Pieces of a column as one."""
    if len(pieces) == 1:
        return np.array(pieces[0])
    firsts = np.concatenate([piece[:1] for piece in pieces])
    if all(piece.strides == (0,) for piece in pieces) and _once(firsts).strides == (0,):
        return np.broadcast_to(firsts[:1], sum(map(len, pieces)))
    return np.concatenate(pieces)


def _columns(file: Path, names: list[str], rows: list[tuple[int, list[str]]], kept: set[str]) -> list[np.ndarray]:
    """Columns of some rows that are kept, each row with its line."""
    for number, row in rows:
        if len(row) != len(names):
            raise DamagedTable(f"{file}:{number}: error: expected {len(names)} cells, got {len(row)}; " + _AGAIN)
    cells = list(zip(*(row for _, row in rows))) or [()] * len(names)
    lines = [number for number, _ in rows]
    return [_typed(file, lines, name, column) for name, column in zip(names, cells) if name in kept]


def _spoilt_line(file: Path) -> int:
    """The first line that is no text; 1 if all are."""
    for number, line in enumerate(file.read_bytes().split(b"\n"), 1):
        try:
            if "\0" in line.decode("utf-8"):
                return number
        except UnicodeDecodeError:
            return number
    return 1


def _typed(file: Path, lines: list[int], name: str, cells: tuple[str, ...]) -> np.ndarray:
    """A column with its type."""
    try:
        return column_of(name, cells)
    except (ValueError, OverflowError):
        pass
    for line, cell in zip(lines, cells):
        try:
            column_of(name, (cell,))
        except (ValueError, OverflowError):
            raise DamagedTable(
                f"{file}:{line}: error: expected {name} as dda writes it, got '{cell[:40]}'; " + _AGAIN) from None
    raise DamagedTable(f"{file}:1: error: expected {name} as dda writes it, got another column; " + _AGAIN)


def column_of(name: str, cells: tuple[str, ...]) -> np.ndarray:
    """A column with its type; ValueError or OverflowError where a cell has another one."""
    if name in _LISTS:
        column = np.empty(len(cells), dtype=object)
        known = {cell: tuple(float(part) for part in cell.split(";") if part) for cell in set(cells)}
        column[:] = [known[cell] for cell in cells]
        return column
    if name in _WHOLE:
        return np.array(cells, dtype=np.int64)
    if name in _NUMBERS:
        return np.array([cell or "nan" for cell in cells], dtype=float)
    if name not in _WORDS:
        try:
            return np.array([cell or "nan" for cell in cells], dtype=float)
        except ValueError:  # a swept parameter that takes words
            pass
    return np.array(cells, dtype=str)
