"""Groups of a DXF file, text or binary: sections, their entries and the places of these in space."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

_BINARY = b"AutoCAD Binary DXF\r\n\x1a\x00"
#: Largest number of a drawing, as in decks
LARGEST = 1e12


@dataclass(frozen=True)
class Entry:
    """An entry such as an entity: its kind, its groups, and the line or byte at which it begins."""

    kind: str
    place: str
    groups: list[tuple[int, str]] = field(default_factory=list)

    def text(self, code: int, default: str = "") -> str:
        """The first value of a group."""
        return next((value for key, value in self.groups if key == code), default)

    def number(self, code: int, default: float | None = None) -> float:
        """The first value of a group as a number; ValueError if it has none and there is no default."""
        word = next((value for key, value in self.groups if key == code), None)
        if word is None:
            if default is None:
                raise ValueError(f"{self.place}: expected a group {code} of {self.kind}, got none")
            return default
        return self.to_number(code, word)

    def whole(self, code: int, default: int = 0) -> int:
        """The first value of a group as a whole number."""
        number = self.number(code, default)
        if number != int(number):
            raise ValueError(f"{self.place}: expected a whole number in group {code} of {self.kind}, got {number:g}")
        return int(number)

    def point(self, code: int, default: tuple[float, float, float] | None = None) -> tuple[float, float, float]:
        """The point of a group: codes C, C + 10 and, 0 by default, C + 20."""
        if default is not None and not any(key == code for key, _ in self.groups):
            return default
        return self.number(code), self.number(code + 10), self.number(code + 20, 0.0)

    def rows(self, code: int, *others: int) -> list[tuple[float, ...]]:
        """Rows of numbers that each begin with a group, with the groups that follow it, 0 by default."""
        found: list[list[float]] = []
        for key, value in self.groups:
            if key == code:
                found.append([self.to_number(key, value), *[0.0] * len(others)])
            elif key in others and found:
                found[-1][1 + others.index(key)] = self.to_number(key, value)
        return [tuple(row) for row in found]

    def axes(self) -> np.ndarray:
        """Columns are the axes of the entry's own coordinates, by the arbitrary axis rule of DXF: (3, 3)."""
        if not any(code == 210 for code, _ in self.groups):
            return np.eye(3)
        normal = np.array(self.point(210, (0.0, 0.0, 1.0)))
        length = float(np.linalg.norm(normal))
        if not length > 0.0:
            raise ValueError(f"{self.place}: expected a normal of {self.kind} that has a length, got none")
        normal /= length
        near_z = abs(normal[0]) < 1.0 / 64.0 and abs(normal[1]) < 1.0 / 64.0
        first = np.cross((0.0, 1.0, 0.0) if near_z else (0.0, 0.0, 1.0), normal)
        first /= np.linalg.norm(first)
        return np.column_stack((first, np.cross(normal, first), normal))

    def to_number(self, code: int, word: str) -> float:
        """A value as a number."""
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if not abs(number) <= LARGEST:
            raise ValueError(
                f"{self.place}: expected a number within {LARGEST:g} in group {code} of {self.kind}, got '{word[:40]}'")
        return number


@dataclass(frozen=True)
class Placement:
    """An affine map of space: matrix x + shift."""

    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def points(self, given: np.ndarray) -> np.ndarray:
        """Points (n, 3) of points."""
        return np.asarray(given @ self.matrix.T + self.shift)

    def inserts(self, insert: Entry, base: tuple[float, float, float], columns: int, rows: int) -> Iterator[Placement]:
        """Placements of a block that is inserted in this one, columns and rows of it."""
        axes = insert.axes()
        turn = math.radians(insert.number(50, 0.0))
        spin = np.array([[math.cos(turn), -math.sin(turn), 0.0], [math.sin(turn), math.cos(turn), 0.0], [0, 0, 1]])
        scale = np.diag([insert.number(code, 1.0) for code in (41, 42, 43)])
        if not all(np.diag(scale)):
            raise ValueError(f"{insert.place}: expected scales of an insert other than 0, got 0")
        matrix = axes @ spin @ scale
        for row in range(rows):
            for column in range(columns):
                step = np.array([column * insert.number(44, 0.0), row * insert.number(45, 0.0), 0.0])
                shift = axes @ (np.array(insert.point(10)) + spin @ step) - matrix @ np.array(base)
                yield Placement(self.matrix @ matrix, self.matrix @ shift + self.shift)


def sections_of(file: Path) -> dict[str, list[Entry]]:
    """Entries of the sections of a drawing by their names; ValueError if the file is none."""
    data = file.read_bytes()
    pairs = _of_binary(data) if data.startswith(_BINARY) else _of_text(data)
    sections: dict[str, list[Entry]] = {}
    entries: list[Entry] | None = None
    ended = False
    for place, code, value in pairs:
        if code != 0:
            if entries:
                entries[-1].groups.append((code, value))
            continue
        kind = value.upper()
        if kind == "EOF":
            ended = True
            break
        if kind == "SECTION":
            entries = [Entry(kind, place)]
        elif kind == "ENDSEC" and entries:
            sections.setdefault(entries[0].text(2).upper(), []).extend(entries)
            entries = None
        elif entries is not None:
            entries.append(Entry(kind, place))
    if not ended:
        raise ValueError("expected a DXF drawing that ends with the groups 0, EOF, got a broken one; save it again")
    if "ENTITIES" not in sections:
        raise ValueError("expected a DXF drawing with a section ENTITIES, got none")
    return sections


def _of_text(data: bytes) -> Iterator[tuple[str, int, str]]:
    """Groups of a text file: line, code, value."""
    if b"\0" in data[:4096]:
        raise ValueError("expected a DXF drawing, got a binary file; save it as DXF")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    lines = re.split("\r\n|\n|\r", text)
    for number in range(0, len(lines) - 1, 2):
        word = lines[number].strip()
        try:
            code = int(word)
        except ValueError:
            raise ValueError(f"line {number + 1}: expected a group code of DXF, got '{word[:40]}'") from None
        yield f"line {number + 1}", code, lines[number + 1].strip()


def _of_binary(data: bytes) -> Iterator[tuple[str, int, str]]:
    """Groups of a binary file: place, code, value as text."""
    at = len(_BINARY)
    wide = data[at + 1 : at + 2] == b"\0"  # codes of two bytes, since R13
    try:
        while at < len(data):
            place = f"byte {at}"
            if wide:
                code, at = struct.unpack_from("<h", data, at)[0], at + 2
            elif data[at] == 255:
                code, at = struct.unpack_from("<h", data, at + 1)[0], at + 3
            else:
                code, at = data[at], at + 1
            form = _form(code)
            if form == "s":
                end = data.index(b"\0", at)
                value, at = data[at:end].decode("utf-8", errors="replace"), end + 1
            elif form == "b":
                value, at = "", at + 1 + data[at]
            else:
                value, at = repr(struct.unpack_from(form, data, at)[0]), at + struct.calcsize(form)
            yield place, code, value
    except (IndexError, ValueError, struct.error):
        raise ValueError(f"expected a binary DXF drawing, got one that breaks off at byte {at}") from None


def _form(code: int) -> str:
    """Form of a value of a binary file: s text, b bytes, else that of struct."""
    if 10 <= code < 60 or 110 <= code < 150 or 210 <= code < 240 or 460 <= code < 470 or 1010 <= code < 1060:
        return "<d"
    if 60 <= code < 80 or 170 <= code < 180 or 270 <= code < 290 or 370 <= code < 390 or 400 <= code < 410:
        return "<h"
    if 90 <= code < 100 or 420 <= code < 430 or 440 <= code < 460 or code == 1071:
        return "<i"
    if 160 <= code < 170:
        return "<q"
    if code in (1060, 1070):
        return "<h"
    return "<b" if 290 <= code < 300 else "b" if 310 <= code < 320 or code == 1004 else "s"
