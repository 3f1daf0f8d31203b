"""`voussoir import`: a drawing or a file of geometry as a deck and its file of blocks, or as lines."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from voussoir.command import plot
from voussoir.command.options import magnification, whole_number
from voussoir.dda_program import LEAVE_RESULTS, DdaError, call, defaults, find_dda, path_word
from voussoir.deck.blocks import BLOCKS_FILE, Blocks
from voussoir.deck.shapes import ENDINGS, Content, ImportedShape, read_shapes
from voussoir.files import write_text
from voussoir.imports.layers import Layer, merged_materials
from voussoir.imports.limits import limited
from voussoir.imports.plane import AXES
from voussoir.imports.traces import line_file

#: Words that make a layer or a property one of what does not move
FIXED = ("fixed", "ground", "support", "abutment")
#: Units of --unit [m]
UNITS = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Makes a deck and its file of blocks from outlines: DXF (closed polylines, circles, inserted blocks, areas "
        "enclosed by lines and arcs of a layer), GeoJSON, WKT, meshes, COMPAS (json). GeoJSON and WKT of lines alone "
        "become a file of lines for dda cut. Layers, the properties role, layer and material, and physical groups of "
        "gmsh are materials. The properties density, unit_weight, young and poisson belong to the material, and "
        "'fixed': true fixes a block. Equal materials are merged. Prints repairs, snapped and dropped pieces."
    )
    parser.add_argument("file", metavar="FILE", type=Path, help=f"file with the ending {', '.join(ENDINGS)}")
    parser.add_argument("--out", metavar="DECK", type=Path, help="deck to write (default: FILE with the ending nml)")
    unit = parser.add_mutually_exclusive_group()
    unit.add_argument(
        "--unit", metavar="U", choices=UNITS,
        help=f"unit of the file: {', '.join(UNITS)} (default: the unit of the drawing, else m)")
    unit.add_argument("--scale", metavar="S", type=_above_zero, help="metres per unit of the file (default: by --unit)")
    parser.add_argument(
        "--tolerance", metavar="T", type=_above_zero, default=1e-3, help="largest distance of a chord from its arc [m]")
    parser.add_argument(
        "--snap", metavar="T", type=magnification, default=0.0,
        help="largest distance of corners, ends and edges that are joined [m]")
    parser.add_argument(
        "--plane", choices=AXES, help="axes to the right and up of points in space (default: xy; for COMPAS the plane "
        "in which all blocks share their ends)")
    parser.add_argument(
        "--fixed", metavar="WORD", nargs="+", default=list(FIXED),
        help="layers, or values of the properties role or layer, of fixed blocks (default: " + ", ".join(FIXED) + ")")
    parser.add_argument(
        "--hold", metavar="N", type=whole_number(1), nargs="+", default=[], help="numbers of further fixed blocks")
    parser.add_argument("--allow-dropped", action="store_true", help="accept dropped pieces that make no block")
    parser.add_argument(
        "--search", metavar="PARAMETER", help="key whose critical value is searched, such as horizontal_coefficient")
    parser.add_argument("--run", action="store_true", help="run the deck and draw the result")


def _above_zero(word: str) -> float:
    """A number above 0."""
    number = magnification(word)
    if number == 0.0:
        raise argparse.ArgumentTypeError(f"must be above 0, got '{word}'")
    return number


@dataclass
class _Imported:
    """Result of an import: texts by their file names, and the printed lines."""

    files: dict[Path, str]
    lines: list[str]
    dropped: int
    fixed: int = 0
    advice: list[str] = field(default_factory=list)


def run(arguments: argparse.Namespace) -> int:
    """Read, write, say what was dropped, and run the deck if asked: then 3 for a case that is undecided."""
    made = limited(import_file, arguments)
    deck = _deck_of(arguments)
    try:
        deck.parent.mkdir(parents=True, exist_ok=True)
        for name, text in made.files.items():
            write_text(name, text)
    except OSError as problem:
        raise DdaError(f"{deck}:1: error: expected a file that can be written, got: {problem}", 4) from problem
    print("\n".join(made.lines + made.advice), flush=True)
    if not arguments.run:
        return 0
    if made.dropped and not arguments.allow_dropped:
        raise ValueError(
            f"expected a file all of whose pieces make blocks, got {made.dropped} dropped (see above); correct it, or "
            "run the rest with --allow-dropped")
    return _run_deck(deck) if made.fixed else 2


def _deck_of(arguments: argparse.Namespace) -> Path:
    """The deck that is written."""
    return arguments.out or Path(arguments.file.with_suffix(".nml").name)


def import_file(arguments: argparse.Namespace) -> _Imported:
    """Read a file by the arguments of the command; ValueError if it makes no blocks and no lines."""
    content, deck = Content(), _deck_of(arguments)
    scale = UNITS[arguments.unit] if arguments.unit else arguments.scale
    shapes, dropped, (scale, whose) = read_shapes(
        arguments.file, scale, arguments.tolerance, arguments.snap, arguments.plane or "", content)
    notes = content.notes.lines(scale)
    if content.lines:
        return _import_lines(arguments, content, notes, f"a unit is {scale:g} m ({whose})")
    if content.notes.short and not arguments.allow_dropped:
        raise ValueError(_short_ends(content, scale))
    if not shapes:
        words = f": {dropped[0]}" if dropped else ""
        words += f" and {len(dropped) - 1} more" if len(dropped) > 1 else ""
        raise ValueError(f"expected closed outlines, got none{words}")
    blocks = blocks_of(shapes, tuple(word.lower() for word in arguments.fixed), arguments.hold)
    name = deck.with_suffix(".blocks").name
    blocks.groups["scene"] |= {"title": arguments.file.stem, "geometry": name}
    if arguments.search:
        blocks.groups["search"] = {"parameter": arguments.search}
    made = _Imported(
        {deck.with_suffix(".blocks"): blocks.files[BLOCKS_FILE], deck: blocks.text()}, notes, len(dropped),
        sum(shape.fixed for shape in blocks.shapes))
    made.lines.append(
        f"{deck}, {name}: {len(blocks.shapes)} blocks, {made.fixed} of them fixed; a unit is {scale:g} m ({whose}); "
        f"chords within {arguments.tolerance:g} m of their arcs")
    made.lines += _said_of(shapes, blocks)
    try:
        friction = float(defaults(find_dda())["joint%friction_deg"])
        made.lines.append(f"assumed: friction angle {friction:g} degrees; change it by &joint friction_deg in {deck}")
    except (FileNotFoundError, DdaError):  # files are imported without the program, too
        pass
    if not made.fixed:
        made.advice.append("no block is fixed: put supports on a layer named 'fixed', or give --fixed WORD or --hold N")
    return made


def _import_lines(arguments: argparse.Namespace, content: Content, notes: list[str], unit: str) -> _Imported:
    """Lines as a file for `dda cut`; ValueError if blocks are asked for."""
    if arguments.run or arguments.search or arguments.hold:
        raise ValueError(
            "expected outlines of blocks, got lines alone; import them without --run, --search and --hold, "
            "and cut them with dda cut")
    file = _deck_of(arguments).with_suffix(".geo")
    text, layers, count, boundary = line_file(content.lines, max(arguments.snap, arguments.tolerance))
    named = ", ".join(f"{number} {layer or '(no layer)'}" for layer, number in layers.items())
    return _Imported({file: text}, [
        *notes, f"{file}: {count} lines, {boundary} of the boundary; {unit}; joint materials: {named}",
        f"cut them into blocks: dda cut {path_word(file)}"], 0)


def _short_ends(content: Content, scale: float) -> str:
    """Error message for ends that stop short of a line."""
    gaps = [gap * scale for _, _, gap in content.notes.short]
    layer, end, gap = max(content.notes.short, key=lambda short: short[2])
    count = "an end that stops" if len(gaps) == 1 else f"{len(gaps)} ends that stop"
    return (
        f"expected lines that meet, got {count} at most {max(gaps):.3g} m short of another line, on {layer} at "
        f"({end.real:.10g}, {end.imag:.10g}) of the drawing; join them with --snap {1.01 * max(gaps):.3g}, "
        "or drop them with --allow-dropped")


def _run_deck(deck: Path) -> int:
    """Run a deck as the program does, and draw its cases; the exit status."""
    folder = deck.with_suffix("")
    words = "run", path_word(deck), "--out", path_word(folder)
    status = call(*words, accepted=None, capture_output=False).returncode
    if status not in LEAVE_RESULTS:
        return status
    parser = argparse.ArgumentParser()
    plot.add_arguments(parser)
    return plot.run(parser.parse_args([str(folder), "--format", "svg", "png"])) or status


def blocks_of(shapes: list[ImportedShape], fixed: tuple[str, ...], held: Sequence[int] = ()) -> Blocks:
    """Blocks from outlines: a material per layer, in the order in which the layers come; equal ones are merged.

    `fixed` are the layers, in small letters, of what does not move, `held` numbers of further ones from 1.
    """
    if max(held, default=0) > len(shapes):
        raise ValueError(f"expected numbers of blocks from 1 to {len(shapes)} for --hold, got {max(held)}")
    blocks = Blocks()
    still = [
        full_layer(shape).is_fixed or shape.layer.lower() in fixed or number in held
        for number, shape in enumerate(shapes, 1)]
    numbers, layers = merged_materials(shape.layer for shape, stays in zip(shapes, still) if not stays)
    for shape, stays in zip(shapes, still):
        blocks.add_polygon(shape.polygon, stays, 1 if stays else numbers[full_layer(shape).material])
    for number, known in layers.items():
        if not known[0].properties:
            continue
        if number == 1:
            blocks.groups["material"] = dict(known[0].properties)
        else:
            blocks.material(number, **dict(known[0].properties))
    return blocks


def full_layer(shape: ImportedShape) -> Layer:
    """The layer of an outline with all that is known of it."""
    return shape.layer if isinstance(shape.layer, Layer) else Layer(shape.layer)


def _said_of(shapes: list[ImportedShape], blocks: Blocks) -> list[str]:
    """Lines about what is fixed and which materials there are."""
    pairs = list(zip(blocks.shapes, map(full_layer, shapes)))
    reasons = Counter(
        "property fixed" if layer.is_fixed else f"layer {layer or '(none)'}" for shape, layer in pairs if shape.fixed)
    lines = []
    if reasons:
        lines.append("fixed: " + ", ".join(f"{count} of {reason}" for reason, count in reasons.items()))
    _, layers = merged_materials(layer for shape, layer in pairs if not shape.fixed)
    several = [number for number, known in layers.items() if len(known) > 1]
    if len(layers) > 1 or any(known[0].properties for known in layers.values()):
        lines.append("materials: " + ", ".join(f"{number} {known[0].words}" for number, known in layers.items()))
    for number in several:
        lines.append(f"merged: {len(layers[number])} layers of equal material into material {number}")
    return lines
