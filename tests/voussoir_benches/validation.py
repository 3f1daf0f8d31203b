"""`voussoir validation`: problems with exact answers and the results of the program."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from voussoir.command.options import add_decks, add_quiet, whole_number
from voussoir.dda_program import DdaError, find_dda, find_input, version_of
from voussoir.files import read_text, write_text
from voussoir_benches.validation_page import SKETCHES, page, screen_line, sketches, write_lines
from voussoir_benches.validation_run import Line, all_scenes, run_scene


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=Path("validation"),
        help="folder for validation.csv and validation.md (default: validation)")
    parser.add_argument("--scenes", metavar="NAME", nargs="+", help="names of decks (default: all)")
    parser.add_argument(
        "--halvings", metavar="N", type=whole_number(0), default=2,
        help="number of halvings of the step for the convergence rate")
    add_decks(parser)
    add_quiet(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the scenes and write the table: 1 if an error is larger than accepted."""
    decks = arguments.decks or find_input("benchmarks")
    lines = _lines(arguments, decks)
    (arguments.out / SKETCHES).mkdir(parents=True, exist_ok=True)
    write_lines(lines, arguments.out / "validation.csv")
    for name, text in sketches(lines).items():
        write_text(arguments.out / SKETCHES / name, text)
    write_text(arguments.out / "validation.md", page(lines, titles_of(decks), version_of(find_dda())))
    return 0 if all(line.accepted for line in lines) else 1


def titles_of(decks: Path) -> dict[str, str]:
    """Titles of the decks of a folder by their names."""
    found = {deck.stem: re.search(r"title = '((?:[^']|'')*)'", read_text(deck)) for deck in decks.glob("*.nml")}
    return {name: title[1].replace("''", "'") if title else name for name, title in found.items()}


def _lines(arguments: argparse.Namespace, decks: Path) -> list[Line]:
    """Lines of all scenes that were asked for."""
    scenes = all_scenes()
    names = {str(scene.deck) for scene in scenes}
    unknown = [name for name in arguments.scenes or () if name not in names]
    if unknown:
        known = ", ".join(sorted(names))
        raise DdaError(f"expected a scene, got '{unknown[0]}'; the scenes are {known}")
    lines = []
    for scene in scenes:
        if arguments.scenes and scene.deck not in arguments.scenes:
            continue
        for line in run_scene(decks, scene, arguments.halvings):
            lines.append(line)
            if not arguments.quiet:
                print(screen_line(line), flush=True)
    return lines
