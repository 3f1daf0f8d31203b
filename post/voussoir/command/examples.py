"""`voussoir examples`: the decks that came with the program."""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

from voussoir.dda_program import DdaError, find_input
from voussoir.files import fresh


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.add_argument("--copy", metavar="DIR", type=Path, help="copy the decks to DIR/input (default: list them)")


def run(arguments: argparse.Namespace) -> int:
    """List the decks, or copy them."""
    folder = find_input("paper").parent
    if arguments.copy is None:
        for deck in sorted(folder.rglob("*.nml")):
            print(deck.relative_to(folder.parent))
        return 0
    target = arguments.copy / "input"
    try:
        shutil.copytree(
            folder, target, dirs_exist_ok=True, copy_function=lambda one, other: shutil.copy2(one, fresh(Path(other))))
    except (OSError, shutil.Error) as problem:
        raise DdaError(f"{target}:1: error: expected a folder to copy to, got: {problem}", 4) from problem
    print(f"{target}: {len(list(target.rglob('*.nml')))} decks")
    return 0
