"""Pictures of files of blocks and of lines, before anything is run."""

from __future__ import annotations

import csv
import re
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from voussoir.block_file import entries_of
from voussoir.dda_program import DdaError, call, path_word
from voussoir.files import plain, read_text
from voussoir.plot.case_marks import draw_held, draw_loads, entry, load_arrows
from voussoir.plot.case_picture import draw_blocks, draw_guides, draw_supports
from voussoir.plot.case_scene import CaseScene, view
from voussoir.plot.figure_style import INK
from voussoir.plot.motion import motion_of
from voussoir.plot.sheet import Sheet
from voussoir.plot.source_file import Source, read_source, source_of_lines
from voussoir.results import Block

#: Endings of files that are drawn without a run
ENDINGS = (".blocks", ".geo")
#: Distance of a point from an edge over the size of all within which it lies on it
ON_EDGE = 1e-3
#: A line of DDAML
_LINE = re.compile(r"<Line\b[^>]*>([^<]*)</Line>", re.IGNORECASE)


def draw_file(file: Path, sheet: Sheet = Sheet(), numbers: bool = False, coordinates: bool = False) -> Figure:
    """Draw the blocks of a file of blocks or of lines, what acts on them, and lines that are no edge of a block.

    The file's name ends in .blocks or .geo. Blocks have their numbers on them with `numbers`, and the axes are drawn
    [m] with `coordinates`. DdaError, with its own message, if `dda` cannot read the file.
    """
    lines: list[np.ndarray] = []
    if plain(file).suffix == ".geo":
        blocks, materials, title = cut_blocks(file)
        source = source_of_lines(read_text(file))
        lines = loose_lines(lines_of(read_text(file)), blocks)
    else:
        blocks, source = read_blocks(file)
        materials = source.materials
        title = counted(len(blocks), "block") + f", {sum(block.state == 'fixed' for block in blocks)} of them fixed"
    free = [block for block in blocks if block.state != "fixed"]
    supports = [block for block in blocks if block.state == "fixed"]
    scene = CaseScene(free, supports, False, False, False)
    motion = motion_of(free, supports, 0.0, 0.0)
    shapes, fixed = scene.shapes(0.0), [block.corners for block in supports]
    size = float(np.subtract(*view(shapes, fixed)[::-1]).max())
    low, high = view([*shapes, *load_arrows(source, size, motion)], fixed)
    pen = sheet.pen(len(blocks))
    figure, axes = sheet.start(low, high)
    entries = draw_supports(axes, fixed, pen)
    if free:
        entries += draw_blocks(axes, scene, shapes, materials, pen)
    if lines:
        style = {"linewidth": 0.5 * pen, "linestyle": (0, (4, 2))}
        axes.add_collection(LineCollection(
            lines, colors=INK[1], linewidths=style["linewidth"], linestyles=[style["linestyle"]], zorder=1.2))
        entries.append(entry("lines that end off the blocks' edges", color=INK[1], **style))
    entries += draw_loads(axes, source, size, motion, pen) + draw_held(axes, source, motion, pen)
    draw_guides(axes, scene, shapes, (low, high), pen, numbers, coordinates)
    return sheet.finish(figure, axes, f"{file.name}: {title}", entries)


def counted(count: int, word: str) -> str:
    """A number of things in words, such as "2 blocks"."""
    return f"{count} {word}{'s' * (count != 1)}"


def read_blocks(file: Path) -> tuple[list[Block], Source]:
    """Blocks of a file of blocks, and what acts on them; `dda` checks the file first."""
    with tempfile.TemporaryDirectory(prefix="voussoir-") as folder:
        deck = Path(folder) / "deck.nml"
        name = str(file.absolute()).replace("'", "''")
        deck.write_text(f"&scene kind = 'blocks', geometry = '{name}' /\n", encoding="utf-8")
        try:
            call("check", deck)
        except DdaError as error:
            raise DdaError(str(error).replace(str(file.absolute()), str(file))) from error
    text = read_text(file)
    blocks: list[Block] = []
    for words, rows in entries_of(text):
        if words[0] == "block":
            corners = np.array([[float(word.replace("d", "e")) for word in row[:2]] for row in rows])
            state = "fixed" if "fixed" in words else "free"
            blocks.append(Block(len(blocks) + 1, state, corners, np.full_like(corners, np.nan)))
    return blocks, read_source(text)


def cut_blocks(file: Path) -> tuple[list[Block], list[int], str]:
    """Blocks that `dda cut` makes of lines, their materials, and their number in words."""
    with tempfile.TemporaryDirectory(prefix="voussoir-") as folder:
        table = Path(folder) / "blocks.csv"
        call("cut", "--quiet", path_word(file), "--out", table)
        rows = list(csv.DictReader(read_text(table).splitlines()))
    blocks: list[Block] = []
    materials: list[int] = []
    held = 0
    for row in rows:
        x, y = ([float(word) for word in row[name].split(";")] for name in ("corner_x", "corner_y"))
        corners = np.column_stack((x, y))
        state = "held" if int(row["fixed_points"]) > 1 else "free"
        held += state == "held"
        blocks.append(Block(int(row["block"]), state, corners, np.full_like(corners, np.nan)))
        materials.append(int(row["material"]))
    return blocks, materials, counted(len(blocks), "block") + f", {held} of them with restraints"


def loose_lines(lines: list[np.ndarray], blocks: list[Block]) -> list[np.ndarray]:
    """Lines with an end on no edge of a block: they are cut off there."""
    starts = np.vstack([block.corners for block in blocks])
    along = np.vstack([np.roll(block.corners, -1, axis=0) - block.corners for block in blocks])
    near = ON_EDGE * float(np.ptp(starts, axis=0).max())
    square = np.einsum("ij,ij->i", along, along)

    def gap(point: np.ndarray) -> float:
        share = np.clip(np.einsum("ij,ij->i", point - starts, along) / square, 0.0, 1.0)
        return float(np.hypot(*(starts + share[:, None] * along - point).T).min())

    return [line for line in lines if max(gap(line[0]), gap(line[1])) > near]


def lines_of(text: str) -> list[np.ndarray]:
    """Lines of a file of lines, plain or DDAML: (2, 2) each [m]."""
    found = [match.split() for match in _LINE.findall(text)]
    if "<" not in text:
        found = [words for words in (line.split() for line in text.splitlines()) if len(words) == 5]
    return [np.array([float(word) for word in words[:4]]).reshape(2, 2) for words in found if len(words) >= 4]
