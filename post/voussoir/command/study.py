"""`voussoir study`: a deck run with one key halved again and again, and the order of convergence."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from voussoir.command.options import add_sheet
from voussoir.files import write_text

if TYPE_CHECKING:
    from voussoir.deck.study import Series, Study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Runs a deck with the value of a key, then with that value halved N times: --halve time_step 4 makes five "
        "runs. Prints results, their differences and the observed order of convergence, or why there is none. Writes "
        "study.csv and a picture. Results are critical values, thrusts, and displacements of monitoring points."
    )
    parser.add_argument("deck", metavar="DECK", type=Path, help="deck; its sweeps are cases of each run")
    way = parser.add_mutually_exclusive_group(required=True)
    way.add_argument(
        "--halve", metavar=("KEY", "N"), nargs=2, help="key to halve, such as time_step, and number of halvings")
    way.add_argument(
        "--double", metavar=("KEY", "N"), nargs=2,
        help="key to double, such as voussoirs or young, and number of doublings")
    parser.add_argument(
        "--y", metavar="COLUMN", nargs="+", default=(),
        help="columns of results.csv, and u, v for monitoring points (default: all with values)")
    parser.add_argument(
        "--at", metavar="T", type=float, help="time of the displacements of monitoring points [s] (default: the end)")
    parser.add_argument("--exact", metavar="X", type=float, help="exact value, if there is one result")
    parser.add_argument(
        "--set", metavar="KEY=VALUE", nargs="+", default=(), help="other keys of the deck (default: as in the deck)")
    parser.add_argument("--jobs", metavar="J", type=int, default=1, help="number of cases computed at the same time")
    add_sheet(parser, "STEM_study in the current folder")


def run(arguments: argparse.Namespace) -> int:
    """Run, print and draw."""
    from voussoir.deck.study import StudyError, study
    from voussoir.deck.text import value_of
    from voussoir.plot.figure_style import house_style, save
    from voussoir.plot.sheet import Sheet
    from voussoir.plot.study_chart import draw_study

    key, word = arguments.halve or arguments.double
    if not word.isascii() or not word.isdigit() or not 1 <= int(word) <= 20:
        raise StudyError(f"expected the number of halvings as a whole number from 1 to 20, got '{word}'")
    pairs = [pair.partition("=") for pair in arguments.set]
    found = study(
        arguments.deck, key, int(word), bool(arguments.double), arguments.at, arguments.exact, arguments.y,
        arguments.jobs, **{name: value_of(value) for name, _, value in pairs})
    print("\n".join(table_of(found)))
    out = arguments.out or Path(f"{arguments.deck.stem}_study")
    out.mkdir(parents=True, exist_ok=True)
    print(write_text(out / "study.csv", csv_of(found)))
    with house_style(arguments.font, arguments.min_font):
        sheet = Sheet(arguments.width, arguments.title, arguments.legend)
        for path in save(sheet.resized(draw_study(found, arguments.legend)), out, "study", tuple(arguments.format)):
            print(path)
    return 0


def table_of(found: Study) -> list[str]:
    """The study as lines of text."""
    from voussoir.deck.study import SAME

    lines = []
    for series in found.series:
        if series.verdict()[1] == SAME:
            unit = f" {series.unit}" if series.unit else ""
            lines += [f"{series.name}: {series.values[-1]:.9g}{unit}", f"  {SAME}", ""]
            continue
        exact = not math.isnan(series.exact)
        head = f"{found.key.rpartition('%')[2]:>14}{'steps':>10}{'value':>22}{'error' if exact else 'difference':>14}"
        lines += [series.name + (f" [{series.unit}]" if series.unit else ""), head + f"{'order':>9}"]
        for number, row in enumerate(rows_of(found, series)):
            steps = int(found.steps[number])
            value, error, order = (
                "" if math.isnan(cell) else text for cell, text in
                zip(row[1:], (f"{row[1]:.12g}", f"{row[2]:.3e}", f"{row[3]:.2f}")))
            lines.append(f"{row[0]:>14.6g}{steps:>10}{value:>22}{error:>14}{order:>9}")
        limit, rest = series.limit()
        words = series.verdict()[1]
        if not math.isnan(limit):
            words += f"; extrapolated value {limit:.12g}, the finest run differs by {rest:.2e}"
        lines += ["  " + words, ""]
    return lines + ["note: " + line for line in found.notes()]


def rows_of(found: Study, series: Series) -> list[tuple[float, float, float, float]]:
    """Value of the key, the result, its error or difference from the run before, and the order, of each run."""
    errors, orders = series.errors.tolist(), series.orders.tolist()
    count = len(found.values)
    errors = [math.nan] * (count - len(errors)) + errors
    orders = [math.nan] * (count - len(orders)) + orders
    return list(zip(found.values, series.values.tolist(), errors, orders))


def csv_of(found: Study) -> str:
    """The study as a table."""
    lines = ["result,unit,value_of_key,steps,value,error,order"]
    for series in found.series:
        for number, row in enumerate(rows_of(found, series)):
            cells = ["" if math.isnan(cell) else repr(cell) for cell in row]
            name = '"' + series.name + '"' if "," in series.name else series.name
            lines.append(",".join([name, series.unit, cells[0], str(int(found.steps[number])), *cells[1:]]))
    return "\n".join(lines) + "\n"
