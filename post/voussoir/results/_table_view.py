"""Tables as text and as HTML: what has no cell is left out, the middle of long tables too."""

from __future__ import annotations

from typing import Any

import numpy as np

from voussoir.html_page import cell, escape, table

#: Rows that are shown of a long table, and the width of its text
MOST_ROWS, WIDTH = 12, 100
#: Columns of the deck, which leave their place to results
LAST = ("deck", "mode", "geometry")


def cell_text(cell: Any) -> str:
    """A cell; empty where nothing is known."""
    if isinstance(cell, tuple):
        return ", ".join(f"{angle:g}" for angle in cell)
    if isinstance(cell, (float, np.floating)):
        return "" if np.isnan(cell) else f"{cell:.7g}"
    return str(cell)


def _shown(columns: dict[str, np.ndarray], rows: int) -> tuple[list[str], list[list[str]]]:
    """Names and texts of the columns that have a cell, their middle rows left out."""
    places = list(range(rows))
    if rows > MOST_ROWS:
        places = places[: MOST_ROWS // 2] + places[-(MOST_ROWS // 2) :]
    names, texts = [], []
    for name, column in sorted(columns.items(), key=lambda item: item[0] in LAST):
        cells = [cell_text(column[place]) for place in places]
        if any(cells):
            if rows > MOST_ROWS:
                cells.insert(MOST_ROWS // 2, "...")
            names.append(name)
            texts.append(cells)
    return names, texts


def as_text(columns: dict[str, np.ndarray], rows: int) -> str:
    """A table for a terminal: as many columns as fit; the others are named below."""
    names, texts = _shown(columns, rows)
    lines = [""] * (1 + max(map(len, texts), default=0))
    fitting = 0
    for name, cells in zip(names, texts):
        width = max(map(len, [name, *cells]))
        if fitting and len(lines[0]) + 2 + width > WIDTH:
            break
        gap = "  " if fitting else ""
        lines = [line + gap + cell.rjust(width) for line, cell in zip(lines, [name, *cells])]
        fitting += 1
    lines.append(f"{rows} row{'s' * (rows != 1)}, {len(columns)} columns")
    if fitting < len(names):
        lines[-1] += "; not shown: " + " ".join(names[fitting:])
    return "\n".join(lines)


def as_html(columns: dict[str, np.ndarray], rows: int) -> str:
    """A table for a notebook."""
    names, texts = _shown(columns, rows)
    heads = [cell(escape(name), tag="th") for name in names]
    body = table(heads, ([cell(escape(text)) for text in row] for row in zip(*texts)))
    return f'<div style="overflow-x:auto">{body}</div><p>{rows} row{"s" * (rows != 1)}, {len(columns)} columns</p>'
