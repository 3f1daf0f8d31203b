"""`voussoir plot`: pictures of a folder of results."""

from __future__ import annotations

import argparse
from pathlib import Path

from voussoir import results
from voussoir.command.options import magnification

#: Most cases that are drawn without being named
MOST_CASES = 12
_AUTO = "auto"
#: A table of more bytes is large
LARGE = 10_000_000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Draw the cases of a folder that dda run has written, arches and blocks alike: line of thrust, hinges, slips, "
        "contact forces, loads, held points, ways of measured points; or chart the critical values of a sweep."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results")
    parser.add_argument(
        "--case", metavar="N", type=int, nargs="+",
        help=f"cases to draw (default: the first {MOST_CASES}; none with --chart or --fragility)")
    parser.add_argument(
        "--chart",
        metavar="COLUMN",
        nargs="?",
        const=_AUTO,
        help="chart the critical values against this column, such as half_angle_deg; without a "
        "name against the swept column with the most values (default: no chart)",
    )
    parser.add_argument(
        "--fragility",
        metavar="COLUMN",
        nargs="?",
        const=_AUTO,
        help="draw the share of records that make the blocks collapse against this swept column, "
        "amplitude or scale without a name; or, of searches, against the critical values",
    )
    parser.add_argument("--out", metavar="DIR", type=Path, help="where the pictures go (default: DIR/plots)")
    parser.add_argument(
        "--format", metavar="ENDING", nargs="+", choices=("svg", "pdf", "png"), default=("svg",),
        help="of svg, pdf, png (default: svg)")
    parser.add_argument(
        "--magnify",
        metavar="M",
        nargs="?",
        const=_AUTO,
        type=lambda word: word if word == _AUTO else magnification(word),
        help="draw the displaced shape, magnified; without a number that is chosen, and stated (default: what "
        "stands is drawn as it stands, a collapse mechanism so that it is seen)",
    )
    parser.add_argument("--numbers", action="store_true", help="write the blocks' numbers on them")
    parser.add_argument("--coordinates", action="store_true", help="draw the axes, in metres")
    parser.add_argument("--no-forces", action="store_true", help="leave the contact forces out")


def run(arguments: argparse.Namespace) -> int:
    """Draw."""
    from voussoir.plot.case_picture import draw_case
    from voussoir.plot.design_chart import chart_columns, draw_chart
    from voussoir.plot.figure_style import house_style, save

    # of a large table only what the chart needs is held
    table = arguments.folder / "results.csv"
    bare = arguments.chart and not arguments.case and not arguments.fragility
    large = table.is_file() and table.stat().st_size > LARGE
    read = results.read(arguments.folder, chart_columns if bare and large else None)
    out = arguments.out or arguments.folder / "plots"
    paths: list[Path] = []
    with house_style():
        if arguments.chart:
            column = None if arguments.chart == _AUTO else arguments.chart
            name = "chart" if column is None else f"chart_{column}"
            paths += save(draw_chart(read, column), out, name, tuple(arguments.format))
        if arguments.fragility:
            from voussoir.plot.fragility import draw_fragility

            figure, fit = draw_fragility(read, None if arguments.fragility == _AUTO else arguments.fragility)
            if fit:
                print(f"lognormal fragility: median {fit.median:.6g}, dispersion {fit.dispersion:.4g}")
            paths += save(figure, out, "fragility", tuple(arguments.format))
        for number in _cases(arguments, read):
            figure = draw_case(
                read, number, arguments.magnify, not arguments.no_forces, arguments.numbers, arguments.coordinates
            )
            paths += save(figure, out, f"case_{number}", tuple(arguments.format))
    for path in paths:
        print(path)
    return 0


def _cases(arguments: argparse.Namespace, read: results.Results) -> list[int]:
    """Cases to draw."""
    if arguments.case or arguments.chart or arguments.fragility:
        return arguments.case or []
    drawn = [int(number) for number in read.cases["case"][:MOST_CASES]]
    if len(drawn) < len(read.cases):
        print(f"the first {MOST_CASES} of {len(read.cases)} cases; --case N draws others")
    return drawn
