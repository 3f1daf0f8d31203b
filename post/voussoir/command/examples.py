"""`voussoir examples`: the decks that came with the program."""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

from voussoir.dda_program import DdaError, find_input


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.add_argument("--copy", metavar="DIR", type=Path, help="copy them to DIR/input (default: list them)")


def run(arguments: argparse.Namespace) -> int:
    """List the decks, or copy them.

    Exit status: 0, 2 without decks, 4 where they cannot be copied.
    """
    try:
        folder = find_input("paper").parent
    except DdaError as missing:
        sys.stderr.write(f"voussoir: error: {missing}\n")
        return 2
    if arguments.copy is None:
        for deck in sorted(folder.rglob("*.nml")):
            print(deck.relative_to(folder.parent))
        return 0
    target = arguments.copy / "input"
    try:
        shutil.copytree(folder, target, dirs_exist_ok=True)
    except (OSError, shutil.Error) as problem:
        sys.stderr.write(f"{target}:1: error: expected a folder to copy to, got: {problem}\n")
        return 4
    print(f"{target}: {len(list(target.rglob('*.nml')))} decks")
    return 0
