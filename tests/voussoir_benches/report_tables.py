"""Parts of the three reports: tables as CSV and as Markdown, points in groups."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from voussoir.files import fresh

Point = TypeVar("Point")


def write_csv(file: Path, heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a table as CSV."""
    with fresh(file).open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)


def markdown(heads: Sequence[str], sides: str, rows: Iterable[Sequence[str]]) -> list[str]:
    """Lines of a table in Markdown; `sides` says by l or r how each column stands."""
    marks = [{"l": "---", "r": "---:"}[side] for side in sides]
    head, *body = ["| " + " | ".join(cells) + " |" for cells in (heads, *rows)]
    return [head, "|" + "|".join(marks) + "|", *body]


def grouped(points: Iterable[Point], name: str) -> dict[str, list[Point]]:
    """Points by one of their fields, as they come."""
    groups: dict[str, list[Point]] = {}
    for point in points:
        groups.setdefault(getattr(point, name), []).append(point)
    return groups
