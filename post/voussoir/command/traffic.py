"""`voussoir traffic`: vehicles of a list on an arch, their load factors and worst positions."""

from __future__ import annotations

import argparse
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

from voussoir.command.assess import check
from voussoir.command.options import add_sheet, magnification, whole_number
from voussoir.files import read_text, write_text

if TYPE_CHECKING:
    from voussoir.deck.traffic import Passage

#: Heads of the table, and the columns of traffic.csv
HEADS = ("vehicle", "weight [kN]", "width [m]", "load [kN/m]", "load factor", "position [m]", "direction", "opposite")
COLUMNS = (
    "vehicle,weight_kN,effective_width_m,load_kN_per_m,load_factor,verdict,position_m,direction,opposite_load_factor,"
    "opposite_position_m")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Moves vehicles of a list over the arch of a deck. Weights [kN] are divided by an effective width to loads per "
        "metre of depth. The rule is printed: w = b + 2 s h + min(t, b + 2 s h), with b the width of a wheel, t the "
        "track, h the depth of fill at the crown and s its spread. Prints load factor, worst position and direction "
        "per vehicle, and the load factor in the opposite direction. Writes traffic.csv, one deck per vehicle, and a "
        "chart of load factor against position."
    )
    parser.add_argument("deck", metavar="DECK", type=Path, help="deck of an arch; its &vehicle is ignored")
    parser.add_argument(
        "--list", metavar="FILE", type=Path,
        help="CSV file of vehicles: name, axles_kN, spacings_m (separated by blanks), optional track_m, wheel_width_m, "
        "length_m, source (default: input/traffic/vehicles.csv of the package)")
    parser.add_argument("--vehicle", metavar="NAME", nargs="+", help="vehicles of the list (default: all)")
    parser.add_argument(
        "--convoy", metavar="N", type=whole_number(1), default=1, help="number of equal vehicles in a row")
    parser.add_argument(
        "--gap", metavar="G", type=magnification, nargs="+", default=[5.0],
        help="distances of last and first axle in a convoy [m]; the worst one is reported (default: 5)")
    width = parser.add_mutually_exclusive_group()
    width.add_argument(
        "--rule", choices=("wheels", "cs454"), default="wheels",
        help="rule of the effective width: wheels as above, or cs454, w = 1.5 m + h")
    width.add_argument(
        "--effective-width", metavar="W", type=magnification, help="effective width [m] (default: by the rule)")
    parser.add_argument(
        "--barrel-width", metavar="W", type=magnification, default=math.inf,
        help="width of the barrel, upper limit of the effective width [m] (default: no limit)")
    parser.add_argument("--one-direction", action="store_true", help="forward direction only")
    add_sheet(parser, "STEM_traffic in the current folder")


def run(arguments: argparse.Namespace) -> int:
    """Compute, print, write and draw."""
    from voussoir.deck.traffic import RULES, read_vehicles, sample_list, worst_convoy
    from voussoir.plot.figure_style import house_style, save
    from voussoir.plot.position_chart import draw_positions
    from voussoir.plot.sheet import Sheet

    check(read_text(arguments.deck), arguments.deck)
    if arguments.effective_width == 0.0 or arguments.barrel_width == 0.0 or 0.0 in arguments.gap:
        raise ValueError("expected widths and gaps above 0, got 0")
    file = arguments.list or sample_list()
    known = read_vehicles(file)
    names = arguments.vehicle or list(known)
    for name in names:
        if name not in known:
            raise ValueError(f"expected a vehicle of {file}, one of {', '.join(known)}, got '{name}'")
    given = arguments.effective_width
    print(f"effective width: {RULES[arguments.rule]}" if given is None else f"effective width: {given:g} m, given")
    out = arguments.out or Path(f"{arguments.deck.stem}_traffic")
    out.mkdir(parents=True, exist_ok=True)
    sheet, everything = Sheet(arguments.width, arguments.title, arguments.legend), [COLUMNS]
    rows: list[tuple[str, ...]] = [HEADS]
    files: list[Path] = []
    for name in names:
        worst, passages = worst_convoy(
            arguments.deck, known[name], arguments.convoy, arguments.gap, rule=arguments.rule, width=given,
            barrel=arguments.barrel_width, both=not arguments.one_direction)
        rows.append(row_of(worst))
        everything += [csv_of(passage) for passage in passages]
        stem = re.sub(r"[^\w.-]+", "_", name)
        files.append(write_text(out / f"{stem}.nml", worst.text))
        cases = worst.found.positions
        if cases is not None and "found" in cases["verdict"]:
            with house_style(arguments.font, arguments.min_font):
                place = worst.found.place
                other = (worst.opposite, worst.opposite_place) if math.isfinite(worst.opposite_place) else None
                figure = draw_positions(
                    worst.found.own, cases, None if math.isnan(place) else place, sheet, worst.found.axles, other)
                files += save(figure, out, stem, tuple(arguments.format))
    files.append(write_text(out / "traffic.csv", "\n".join(everything) + "\n"))
    widths = [max(len(row[place]) for row in rows) for place in range(len(HEADS))]
    for row in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip())
    print("\n".join(map(str, files)))
    return 0


def row_of(passage: Passage) -> tuple[str, ...]:
    """A line of the table, in three digits."""
    from voussoir.plot.units import digits

    row = passage.found.factor or {}
    total = passage.weight / 1e3
    words = {math.inf: "unlimited", 0.0: "0"}
    factor, other = (words.get(value, digits(value)) for value in (passage.factor, passage.opposite))
    if math.isnan(passage.factor):
        factor = str(row.get("verdict", "none"))
    place = passage.found.place
    return (
        passage.name, digits(total), digits(passage.width), digits(total / passage.width), factor,
        "-" if math.isnan(place) else digits(place), str(row.get("worst_direction", "")) or "-",
        "-" if math.isnan(passage.opposite) else other)


def csv_of(passage: Passage) -> str:
    """A row of traffic.csv, with all digits."""
    row = passage.found.factor or {}
    total = passage.weight / 1e3
    name = f'"{passage.name}"' if "," in passage.name else passage.name
    numbers = [total, passage.width, total / passage.width, passage.factor]
    cells = ["" if math.isnan(number) else repr(number) for number in numbers]
    place = "" if math.isnan(passage.found.place) else repr(float(passage.found.place))
    others = ["" if math.isnan(number) else repr(number) for number in (passage.opposite, passage.opposite_place)]
    return ",".join([name, *cells, str(row.get("verdict", "")), place, str(row.get("worst_direction", "")), *others])
