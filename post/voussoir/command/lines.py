"""`voussoir lines`: a picture of what `dda lines` has drawn."""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

from voussoir.files import read_text

#: Layers of the picture from below: role, colour by its place in INK, width of the line
_LINES = (("joint", 0, 0.5), ("boundary", 0, 1.4), ("material", 1, 1.0), ("bolt", 2, 1.6))
#: Points: role, mark, name in the legend
_POINTS = (("measure", "o", "monitoring"), ("fix", "^", "fixed"), ("load", "v", "loaded"), ("hole", "x", "removed"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = "Draws the lines, bolts and points of a joint map."
    parser.add_argument("table", metavar="TABLE", type=Path, help="table of dda lines, NAME_lines.csv")
    parser.add_argument(
        "--out", metavar="FILE", type=Path, help="picture, .png, .svg or .pdf (default: TABLE with the ending .png)")


def run(arguments: argparse.Namespace) -> int:
    """Draw."""
    picture = arguments.out or arguments.table.with_suffix(".png")
    if picture.suffix not in (".png", ".svg", ".pdf"):
        raise ValueError(f"expected a picture whose name ends in .png, .svg or .pdf, got {picture}")
    try:
        lines = read_lines(arguments.table)
    except OSError as problem:
        raise ValueError(f"expected a table of dda lines: {problem}") from problem
    draw(lines, picture)
    print(picture)
    return 0


def read_lines(table: Path) -> dict[str, list[tuple[float, ...]]]:
    """Ends x1, y1, x2, y2 of all lines by their role."""
    lines: dict[str, list[tuple[float, ...]]] = {}
    for number, row in enumerate(csv.DictReader(read_text(table).splitlines()), 2):
        try:
            ends = tuple(float(row[column]) for column in ("x1", "y1", "x2", "y2"))
            lines.setdefault(row["role"], []).append(ends)
        except (KeyError, TypeError, ValueError) as problem:
            raise ValueError(
                f"{table}:{number}: error: expected a row of a table of dda lines, got: {problem}") from problem
    if not lines:
        raise ValueError(f"{table}:1: error: expected a table of dda lines, got one without rows")
    return lines


def draw(lines: dict[str, list[tuple[float, ...]]], picture: Path) -> None:
    """Draw lines and points."""
    import matplotlib.pyplot as plt
    from matplotlib.collections import LineCollection

    from voussoir.plot.figure_style import INK, house_style, save

    with house_style():
        figure, axes = plt.subplots(figsize=(7.0, 6.0))
        for role, ink, width in _LINES:
            parts = [((x1, y1), (x2, y2)) for x1, y1, x2, y2 in lines.get(role, [])]
            label = {"bolt": "bolt", "material": "material line"}.get(role) if parts else None
            axes.add_collection(LineCollection(parts, colors=INK[ink], linewidths=width, label=label))
        for role, mark, label in _POINTS:
            points = [line for line in lines.get(role, []) if line[:2] == line[2:]]
            held = [(p[:2], p[2:]) for p in lines.get(role, []) if p[:2] != p[2:]]
            name = label if held else None
            axes.add_collection(LineCollection(held, colors=INK[1], linewidths=1.0, linestyles="--", label=name))
            if points:
                x, y = [p[0] for p in points], [p[1] for p in points]
                axes.plot(x, y, mark, color=INK[1], markersize=5, label=label)
        axes.set_aspect("equal")
        axes.autoscale_view()
        axes.grid(False)
        axes.set_xlabel("$x$ [m]")
        axes.set_ylabel("$y$ [m]")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=4)
        save(figure, picture.parent, picture.stem, (picture.suffix[1:],))
