"""`voussoir import`: a drawing or a file of geometry as a deck and its file of blocks."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from voussoir.deck.blocks import BLOCKS_FILE, Blocks
from voussoir.deck.shapes import READERS, ImportedShape, read_shapes
from voussoir.extras import MissingPackage

#: Words that make a layer or a property one of what does not move
FIXED = ("fixed", "ground", "support", "abutment")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Make a deck and its file of blocks from closed outlines: DXF (closed polylines, circles, "
        "blocks that are inserted; arcs become chords), GeoJSON, WKT, meshes, assemblies of COMPAS (json)."
    )
    parser.add_argument("file", metavar="FILE", type=Path, help=f"of {', '.join(READERS)}")
    parser.add_argument("--out", metavar="DECK", type=Path, help="the deck (default: FILE with the ending nml)")
    parser.add_argument("--scale", metavar="S", type=float, default=1.0, help="metres a unit of the file")
    parser.add_argument(
        "--tolerance", metavar="T", type=float, default=1e-3, help="how far a chord may be from its arc [m]"
    )
    parser.add_argument(
        "--fixed",
        metavar="WORD",
        nargs="+",
        default=list(FIXED),
        help="layers, or values of the property role or layer, of what does not move",
    )


def run(arguments: argparse.Namespace) -> int:
    """Read, write, and say what was dropped.

    Exit status: 0, 2 for a file that cannot be read or holds no outline, 4 for one that cannot be written.
    """
    try:
        shapes, dropped = read_shapes(arguments.file, arguments.scale, arguments.tolerance)
    except (MissingPackage, OSError, ValueError) as problem:
        sys.stderr.write(f"{arguments.file}:1: error: {problem}\n")
        return 2
    if not shapes:
        sys.stderr.write(f"{arguments.file}:1: error: expected closed outlines, got none; close the polylines\n")
        return 2
    blocks = blocks_of(shapes, tuple(word.lower() for word in arguments.fixed))
    deck = arguments.out or Path(arguments.file.with_suffix(".nml").name)
    name = deck.with_suffix(".blocks").name
    blocks.groups["scene"] |= {"title": arguments.file.stem, "geometry": name}
    try:
        deck.parent.mkdir(parents=True, exist_ok=True)
        deck.with_suffix(".blocks").write_text(blocks.files[BLOCKS_FILE], encoding="utf-8")
        deck.write_text(blocks.text(), encoding="utf-8")
    except OSError as problem:
        sys.stderr.write(f"{deck}:1: error: expected a file that can be written, got: {problem}\n")
        return 4
    fixed = sum(shape.fixed for shape in blocks.shapes)
    for words in dropped:
        print(f"dropped: {words}")
    print(
        f"{deck}, {name}: {len(blocks.shapes)} blocks, {fixed} of them fixed; "
        f"chords within {arguments.tolerance:g} m of their arcs"
    )
    if not fixed:
        print("nothing is fixed: put what holds the blocks on a layer named 'fixed', or --fixed WORD")
    return 0


def blocks_of(shapes: list[ImportedShape], fixed: tuple[str, ...]) -> Blocks:
    """Blocks from outlines: a material a layer, in the order in which the layers come.

    Parameters
    ----------
    fixed : tuple of str
        Layers of what does not move, in small letters.
    """
    blocks = Blocks()
    moving = dict.fromkeys(shape.layer for shape in shapes if shape.layer.lower() not in fixed)
    materials = {layer: number for number, layer in enumerate(moving, 1)}
    for shape in shapes:
        still = shape.layer.lower() in fixed
        blocks.add_polygon(shape.polygon, still, 1 if still else materials[shape.layer])
    return blocks
