"""`voussoir export`: the blocks of a case as a drawing or a file of geometry."""

from __future__ import annotations

import argparse
from pathlib import Path

from voussoir import results
from voussoir.command.options import magnification
from voussoir.dda_program import DdaError
from voussoir.deck.export import WRITERS, outlines_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Writes the blocks of a case as closed outlines in metres: DXF, GeoJSON, WKT, meshes. Fixed blocks and each "
        "material have their own layers. voussoir import reads the file."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results")
    parser.add_argument("file", metavar="FILE", type=Path, help=f"file with the ending {', '.join(WRITERS)}")
    parser.add_argument("--case", metavar="N", type=int, default=1, help="number of the case")
    parser.add_argument(
        "--magnify", metavar="M", type=magnification, default=0.0,
        help="factor of the displacements; 1 for the end of the run")


def run(arguments: argparse.Namespace) -> int:
    """Write."""
    file, write = arguments.file, WRITERS.get(arguments.file.suffix.lower())
    if write is None:
        raise ValueError(f"expected a file of {', '.join(WRITERS)}, got '{file.suffix}'")
    outlines = outlines_of(results.read(arguments.folder), arguments.case, arguments.magnify)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        lost = write(outlines, file)
    except OSError as problem:
        raise DdaError(f"{file}:1: error: expected a file that can be written, got: {problem}", 4) from problem
    fixed = sum(outline.layer == "fixed" for outline in outlines)
    print(f"{file}: {len(outlines)} blocks, {fixed} of them fixed" + (f"; it cannot hold {lost}" if lost else ""))
    return 0
