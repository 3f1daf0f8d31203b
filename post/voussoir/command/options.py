"""Options that several subcommands have, and the kinds of values that options take."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable
from pathlib import Path


def add_quiet(parser: argparse.ArgumentParser) -> None:
    """Add --quiet."""
    parser.add_argument("--quiet", action="store_true", help="print errors only")


def add_decks(parser: argparse.ArgumentParser) -> None:
    """Add --decks."""
    parser.add_argument("--decks", metavar="DIR", type=Path, help="folder of the decks (default: those of the package)")


def whole_number(least: int) -> Callable[[str], int]:
    """What reads a whole number that is not below the least one."""

    def read(word: str) -> int:
        if not (word.isascii() and word.isdigit()) or int(word) < least:
            raise argparse.ArgumentTypeError(f"must be a whole number from {least}, got '{word}'")
        return int(word)

    return read


def magnification(word: str) -> float:
    """A finite number from 0."""
    try:
        number = float(word)
    except ValueError:
        number = math.nan
    if not 0.0 <= number < math.inf:
        raise argparse.ArgumentTypeError(f"must be a number from 0, got '{word}'")
    return number


#: Units of a width [inch]
INCHES = {"mm": 1.0 / 25.4, "cm": 1.0 / 2.54, "in": 1.0, "pt": 1.0 / 72.0}
#: Least and greatest width of a picture [inch]
NARROWEST, WIDEST = 1.0, 40.0


def picture_width(word: str) -> float:
    """A width with its unit, such as "80mm": in inches."""
    found = re.fullmatch(r"([0-9.]+)\s*(mm|cm|in|pt)", word.strip())
    width = magnification(found[1]) * INCHES[found[2]] if found else math.nan
    if not NARROWEST <= width <= WIDEST:
        raise argparse.ArgumentTypeError(f"must be a width from 25.4mm to 1016mm with its unit, got '{word}'")
    return width


def type_size(word: str) -> float:
    """A size of type [points]."""
    size = magnification(word)
    if not 4.0 <= size <= 40.0:
        raise argparse.ArgumentTypeError(f"must be a size from 4 to 40 points, got '{word}'")
    return size


def add_sheet(parser: argparse.ArgumentParser, where: str) -> None:
    """Add the options of files, widths and types."""
    parser.add_argument("--out", metavar="DIR", type=Path, help=f"folder of the files (default: {where})")
    parser.add_argument(
        "--format", metavar="ENDING", nargs="+", choices=("svg", "pdf", "png"), default=("svg",),
        help="formats: svg, pdf, png (default: svg)")
    parser.add_argument(
        "--width", metavar="W", type=picture_width, default=picture_width("132mm"),
        help="width of the picture with its unit, mm, cm, in or pt (default: 132mm)")
    parser.add_argument(
        "--font", metavar="P", type=type_size, default=9.0, help="size of the type in points (default: 9)")
    parser.add_argument(
        "--min-font", metavar="P", type=type_size, default=5.0,
        help="smallest type of labels and legends in points (default: 5)")
    parser.add_argument(
        "--no-title", dest="title", action="store_false", default=True, help="omit the title (default: draw it)")
    parser.add_argument(
        "--no-legend", dest="legend", action="store_false", default=True, help="omit the legend (default: draw it)")
