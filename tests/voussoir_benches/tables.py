"""Tables of scenes: JSON files whose rows stand for one scene or, with axes, for many.

A text that begins with "=" is an expression of the names of `NAMES`, of the axes and of what `let` defines; another
text has them in braces. `each` lists the axes: a name, or several separated by commas, and its values; all products are
made, and `number` counts them from 1. A product for which `if` is false is left out. An entry of a list with `each`
stands for as many entries, each the value of its `item`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from voussoir.files import read_text

#: Names that all tables may use
NAMES: dict[str, Any] = {name: getattr(math, name) for name in dir(math) if not name.startswith("_")}


def rows(file: str, names: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Rows of a table beside this module with their values, a row per product of its axes."""
    for row in json.loads(read_text(Path(__file__).with_name(file))):
        yield from expanded(row, {**NAMES, **names})


def expanded(row: dict[str, Any], names: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Rows that one row of a table stands for."""
    row = dict(row)
    axes, formulas, condition = row.pop("each", {}), row.pop("let", {}), row.pop("if", True)
    for number, own in enumerate(_products(list(axes.items()), names), 1):
        own["number"] = number
        for name, formula in formulas.items():
            own[name] = valued(formula, own)
        if valued(condition, own):
            yield valued(row, own)


def _products(axes: list[tuple[str, Any]], names: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Names with the values of each product of axes; an axis may use those before it."""
    if not axes:
        yield dict(names)
        return
    (name, values), *others = axes
    for item in valued(values, names):
        keys = name.split(", ")
        yield from _products(others, {**names, **dict(zip(keys, item if len(keys) > 1 else [item], strict=True))})


def valued(item: Any, names: dict[str, Any]) -> Any:
    """An entry of a table with its expressions evaluated."""
    if isinstance(item, dict):
        return {key: valued(entry, names) for key, entry in item.items()}
    if isinstance(item, list):
        several = [isinstance(entry, dict) and "each" in entry for entry in item]
        parts = [[row["item"] for row in expanded(entry, names)] if many else [valued(entry, names)]
                 for entry, many in zip(item, several)]
        return [entry for part in parts for entry in part]
    if not isinstance(item, str):
        return item
    return eval(item[1:], dict(names)) if item.startswith("=") else item.format(**names) if "{" in item else item
