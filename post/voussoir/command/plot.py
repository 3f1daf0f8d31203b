"""`voussoir plot`: pictures of a folder of results, or of a file of blocks or lines."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from voussoir import results
from voussoir.command.options import add_sheet, magnification

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Most cases that are drawn without being named
MOST_CASES = 12
_AUTO = "auto"
#: A table of more bytes is large
LARGE = 10_000_000
#: Endings of files that are drawn without a run
_FILES = (".blocks", ".geo")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Draws the cases of a folder of results: thrust line, hinges, slips, contact forces, loads, restraints, "
        "trajectories of monitoring points. Charts a sweep. Draws a file of blocks or lines without a run. With more "
        "than 40 marked joints, colours of their lines show the states, and shades of blocks show displacements."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results, or FILE.blocks, FILE.geo")
    parser.add_argument(
        "--case", metavar="N", type=int, nargs="+",
        help=f"cases to draw (default: the first {MOST_CASES}; none with --chart, --x, --map or --fragility)")
    add_charts(parser)
    add_sheet(parser, "DIR/plots; beside a file plots")
    parser.add_argument(
        "--magnify",
        metavar="M",
        nargs="?",
        const=_AUTO,
        type=lambda word: word if word == _AUTO else magnification(word),
        help="magnification of the displacements; without a number the program chooses and states it (default: "
        "stable structures undeformed, mechanisms enlarged)",
    )
    parser.add_argument("--numbers", action="store_true", help="draw block numbers")
    parser.add_argument("--coordinates", action="store_true", help="draw axes in metres")
    forces = parser.add_mutually_exclusive_group()
    forces.add_argument(
        "--forces", action="store_true", default=None,
        help="draw the contact forces (default: without a thrust line, for up to 150 joints)")
    forces.add_argument(
        "--no-forces", dest="forces", action="store_false", help="omit the contact forces (default: as under --forces)")


def add_charts(parser: argparse.ArgumentParser) -> None:
    """Add the options of charts."""
    parser.add_argument(
        "--chart",
        metavar="COLUMN",
        nargs="?",
        const=_AUTO,
        help="chart of critical values against this column, such as half_angle_deg; without a name, against the "
        "swept column with the most values (default: no chart)",
    )
    parser.add_argument("--x", metavar="KEY", help="chart of --y against this swept key (default: no chart)")
    parser.add_argument(
        "--map", metavar="KEY", nargs=2,
        help="map of --y over two swept keys, with contours; of verdicts without --y and search (default: no map)")
    parser.add_argument(
        "--y", metavar="COLUMN", help="column of results.csv for --x and --map (default: the critical value)")
    parser.add_argument(
        "--fragility",
        metavar="COLUMN",
        nargs="?",
        const=_AUTO,
        help="share of records that collapse the blocks against this swept column (without a name: amplitude or "
        "scale) or, for searches, against the critical values (default: no chart)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Draw."""
    from voussoir.plot.figure_style import house_style, save

    if arguments.y and not (arguments.x or arguments.map):
        raise ValueError("--y needs --x KEY or --map KEY KEY")
    with house_style(arguments.font, arguments.min_font):
        for name, figure in _figures(arguments):
            out = arguments.out or (Path("plots") if arguments.folder.is_file() else arguments.folder / "plots")
            for path in save(figure, out, name, tuple(arguments.format)):
                print(path)
    return 0


def _figures(arguments: argparse.Namespace) -> Iterator[tuple[str, Figure]]:
    """The pictures that are asked for, with the names of their files."""
    from voussoir.plot.sheet import Sheet

    sheet = Sheet(arguments.width, arguments.title, arguments.legend)
    if arguments.folder.suffix in _FILES and arguments.folder.is_file():
        from voussoir.plot.bare_scene import draw_file

        yield arguments.folder.stem, draw_file(arguments.folder, sheet, arguments.numbers, arguments.coordinates)
        return
    # of a large table only what the chart needs is held
    from voussoir.plot.design_chart import chart_columns

    table = arguments.folder / "results.csv"
    bare = arguments.chart and not (arguments.case or arguments.fragility or arguments.x or arguments.map)
    large = table.is_file() and table.stat().st_size > LARGE
    read = results.read(arguments.folder, chart_columns if bare and large else None)
    for name, figure in _charts(arguments, read):
        yield name, sheet.resized(figure)
    from voussoir.plot.case_picture import draw_case

    for number in _cases(arguments, read):
        yield f"case_{number}", draw_case(
            read, number, arguments.magnify, arguments.forces, arguments.numbers, arguments.coordinates, sheet)


def _charts(arguments: argparse.Namespace, read: results.Results) -> Iterator[tuple[str, Figure]]:
    """The charts that are asked for, with the names of their files."""
    if arguments.chart:
        from voussoir.plot.design_chart import draw_chart

        column = None if arguments.chart == _AUTO else arguments.chart
        yield "chart" if column is None else f"chart_{column}", draw_chart(read, column)
    if arguments.x:
        from voussoir.plot.sweep_chart import draw_sweep

        yield _file_name("sweep", arguments.x, arguments.y), draw_sweep(
            read, arguments.x, arguments.y, arguments.legend)
    if arguments.map:
        from voussoir.plot.sweep_chart import draw_map

        yield _file_name("map", *arguments.map, arguments.y), draw_map(
            read, tuple(arguments.map), arguments.y, arguments.legend)
    if arguments.fragility:
        from voussoir.plot.fragility import draw_fragility

        figure, fit = draw_fragility(read, None if arguments.fragility == _AUTO else arguments.fragility)
        if fit:
            print(f"lognormal fragility: median {fit.median:.6g}, dispersion {fit.dispersion:.4g}")
        yield "fragility", figure


def _file_name(*words: str | None) -> str:
    """A name of a file from names of keys."""
    return "_".join(re.sub(r"\W+", "_", word).strip("_") for word in words if word)


def _cases(arguments: argparse.Namespace, read: results.Results) -> list[int]:
    """Cases to draw."""
    if arguments.case or arguments.chart or arguments.fragility or arguments.x or arguments.map:
        return arguments.case or []
    drawn = [int(number) for number in read.cases["case"][:MOST_CASES]]
    if len(drawn) < len(read.cases):
        print(f"the first {MOST_CASES} of {len(read.cases)} cases; --case N draws others")
    return drawn
