"""`voussoir export`: the blocks of a case as a drawing or a file of geometry."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from voussoir import results
from voussoir.command.options import magnification
from voussoir.deck.export import WRITERS, outlines_of
from voussoir.extras import MissingPackage


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Write the blocks of a case as closed outlines, fixed ones and each material on a layer of their own, "
        "in metres: DXF, GeoJSON, WKT, meshes. voussoir import reads them back."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results")
    parser.add_argument("file", metavar="FILE", type=Path, help=f"of {', '.join(WRITERS)}")
    parser.add_argument("--case", metavar="N", type=int, default=1, help="number of the case")
    parser.add_argument(
        "--magnify", metavar="M", type=magnification, default=0.0,
        help="how many times their displacements the blocks have moved; 1 for where they are at the end")


def run(arguments: argparse.Namespace) -> int:
    """Write; exit status 0, 2 for results or an ending that will not do, 4 for a file that cannot be written."""
    file = arguments.file
    try:
        if file.suffix.lower() not in WRITERS:
            raise ValueError(f"expected a file of {', '.join(WRITERS)}, got '{file.suffix}'")
        outlines = outlines_of(results.read(arguments.folder), arguments.case, arguments.magnify)
    except (FileNotFoundError, KeyError, ValueError) as problem:
        words = problem.args[0] if isinstance(problem, KeyError) else problem
        sys.stderr.write(f"{arguments.folder}:1: error: {words}\n")
        return 2
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        lost = WRITERS[file.suffix.lower()](outlines, file)
    except (MissingPackage, ValueError) as problem:
        sys.stderr.write(f"{file}:1: error: {problem}\n")
        return 2
    except OSError as problem:
        sys.stderr.write(f"{file}:1: error: expected a file that can be written, got: {problem}\n")
        return 4
    fixed = sum(outline.layer == "fixed" for outline in outlines)
    print(f"{file}: {len(outlines)} blocks, {fixed} of them fixed" + (f"; it cannot hold {lost}" if lost else ""))
    return 0
