"""`voussoir import`: a drawing or a file of geometry as a deck and its file of blocks."""

from __future__ import annotations

import argparse
import subprocess
from collections.abc import Sequence
from pathlib import Path

from voussoir.command import plot
from voussoir.command.options import magnification, whole_number
from voussoir.dda_program import DdaError, find_dda, path_word
from voussoir.deck.blocks import BLOCKS_FILE, Blocks
from voussoir.deck.shapes import READERS, ImportedShape, read_shapes
from voussoir.files import write_text

#: Words that make a layer or a property one of what does not move
FIXED = ("fixed", "ground", "support", "abutment")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Make a deck and its file of blocks from outlines: DXF (closed polylines, circles, inserted blocks, what "
        "single lines and arcs of a layer enclose; arcs become chords), GeoJSON, WKT, meshes, COMPAS (json)."
    )
    parser.add_argument("file", metavar="FILE", type=Path, help=f"of {', '.join(READERS)}")
    parser.add_argument("--out", metavar="DECK", type=Path, help="the deck (default: FILE with the ending nml)")
    parser.add_argument(
        "--scale", metavar="S", type=_scale, help="metres a unit of the file (default: what a drawing names, else 1)")
    parser.add_argument(
        "--tolerance", metavar="T", type=float, default=1e-3, help="how far a chord may be from its arc [m]")
    parser.add_argument(
        "--fixed", metavar="WORD", nargs="+", default=list(FIXED),
        help="layers, or values of the property role or layer, of what does not move")
    parser.add_argument(
        "--hold", metavar="N", type=whole_number(1), nargs="+", default=[], help="numbers of blocks that do not move")
    parser.add_argument(
        "--search", metavar="PARAMETER", help="ask for the value at which it falls, such as horizontal_coefficient")
    parser.add_argument("--run", action="store_true", help="run the deck, too, and draw what comes out")


def _scale(word: str) -> float:
    """A number above 0."""
    number = magnification(word)
    if number == 0.0:
        raise argparse.ArgumentTypeError(f"must be above 0, got '{word}'")
    return number


def run(arguments: argparse.Namespace) -> int:
    """Read, write, say what was dropped, and run the deck if asked: then 3 for a case that is undecided."""
    try:
        shapes, dropped, (scale, whose) = read_shapes(arguments.file, arguments.scale, arguments.tolerance)
    except OSError as problem:
        raise ValueError(problem) from problem
    if not shapes:
        raise ValueError("expected closed outlines, got none; close the polylines")
    blocks = blocks_of(shapes, tuple(word.lower() for word in arguments.fixed), arguments.hold)
    deck = arguments.out or Path(arguments.file.with_suffix(".nml").name)
    name = deck.with_suffix(".blocks").name
    blocks.groups["scene"] |= {"title": arguments.file.stem, "geometry": name}
    if arguments.search:
        blocks.groups["search"] = {"parameter": arguments.search}
    try:
        deck.parent.mkdir(parents=True, exist_ok=True)
        write_text(deck.with_suffix(".blocks"), blocks.files[BLOCKS_FILE])
        write_text(deck, blocks.text())
    except OSError as problem:
        raise DdaError(f"{deck}:1: error: expected a file that can be written, got: {problem}", 4) from problem
    fixed = sum(shape.fixed for shape in blocks.shapes)
    for words in dropped:
        print(f"dropped: {words}")
    print(
        f"{deck}, {name}: {len(blocks.shapes)} blocks, {fixed} of them fixed; a unit is {scale:g} m ({whose}); "
        f"chords within {arguments.tolerance:g} m of their arcs")
    layers = {shape.material: found.layer for shape, found in zip(blocks.shapes, shapes) if not shape.fixed}
    if len(layers) > 1:
        print("materials: " + ", ".join(f"{number} {layer or '(no layer)'}" for number, layer in layers.items()))
    if not fixed:
        print("nothing is fixed: put what holds the blocks on a layer named 'fixed', or --fixed WORD, or --hold N")
    return _run_deck(deck) if arguments.run and fixed else 2 if arguments.run else 0


def _run_deck(deck: Path) -> int:
    """Run a deck as the program does, and draw its cases; the exit status."""
    folder = deck.with_suffix("")
    status = subprocess.run([str(find_dda()), "run", path_word(deck), "--out", path_word(folder)]).returncode
    if status not in (0, 3):
        return status
    parser = argparse.ArgumentParser()
    plot.add_arguments(parser)
    return plot.run(parser.parse_args([str(folder), "--format", "svg", "png"])) or status


def blocks_of(shapes: list[ImportedShape], fixed: tuple[str, ...], held: Sequence[int] = ()) -> Blocks:
    """Blocks from outlines: a material a layer, in the order in which the layers come.

    `fixed` are the layers, in small letters, of what does not move, `held` numbers of further ones from 1.
    """
    if max(held, default=0) > len(shapes):
        raise ValueError(f"expected numbers of blocks from 1 to {len(shapes)} to hold, got {max(held)}")
    blocks = Blocks()
    still = [shape.layer.lower() in fixed or number in held for number, shape in enumerate(shapes, 1)]
    moving = dict.fromkeys(shape.layer for shape, stays in zip(shapes, still) if not stays)
    materials = {layer: number for number, layer in enumerate(moving, 1)}
    for shape, stays in zip(shapes, still):
        blocks.add_polygon(shape.polygon, stays, 1 if stays else materials[shape.layer])
    return blocks
