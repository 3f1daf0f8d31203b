"""Options that several subcommands have, and the kinds of values that options take."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path


def add_quiet(parser: argparse.ArgumentParser) -> None:
    """Add --quiet."""
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def add_decks(parser: argparse.ArgumentParser) -> None:
    """Add --decks."""
    parser.add_argument(
        "--decks", metavar="DIR", type=Path, help="folder of the decks (default: those that came with the program)"
    )


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
