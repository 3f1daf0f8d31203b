"""Read loads, restraints, bars and materials from a file of blocks or lines, for pictures."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from voussoir.block_file import entries_of
from voussoir.files import read_text
from voussoir.plot.case_scene import CaseScene
from voussoir.results import Results

Point = tuple[float, float]


@dataclass
class Source:
    """What acts on blocks, and what they are made of."""

    materials: list[int] = field(default_factory=list)  #: Material of each block of the file
    #: Where forces act [m], at the end of their histories [N/m], and whether they are live
    loads: list[tuple[Point, Point, bool]] = field(default_factory=list)
    #: Points and lines that are held: both ends [m], and "x", "y" or "" for both directions
    still: set[Point] = field(default_factory=set)  #: Of these points those of no block: they do not move
    held: list[tuple[Point, Point, str]] = field(default_factory=list)
    bars: list[tuple[Point, Point]] = field(default_factory=list)  #: Ends of bolts, anchors and ties [m]
    water: list[list[Point]] = field(default_factory=list)  #: Lines of heads at the end of their histories [m]
    surface: list[list[Point]] = field(default_factory=list)  #: The level surface of the fill [m]
    absorbing: list[tuple[Point, Point]] = field(default_factory=list)  #: Lines of faces that let waves out [m]
    missing: list[str] = field(default_factory=list)  #: What is not known, for its file is not there or not read


def source_of(run: Results) -> Source:
    """What the deck and its file of blocks say; the file is looked for beside the results and above them."""
    source = Source()
    x, y, fx, fy = _lists(run, source, "live", "x", "y", "fx", "fy")
    for number, point in enumerate(zip(x, y)):
        force = (fx[number] if number < len(fx) else 0.0, fy[number] if number < len(fy) else 0.0)
        source.loads.append((point, force, True))
    x1, y1, x2, y2 = _lists(run, source, "tie", "x1", "y1", "x2", "y2")
    source.bars += zip(zip(x1, y1), zip(x2, y2))
    name = run.setting("scene%geometry")
    if run.kind not in ("blocks", "lines") or not name:
        return source
    if run.setting("scene%analysis"):
        source.missing.append(f"loads and restraints of {run.setting('scene%analysis')}")
    files = [folder / name for folder in (run.folder, run.folder.absolute().parent)]
    file = next(filter(Path.is_file, files), None)
    if file is None:
        source.missing.append(f"{'bolts' if run.kind == 'lines' else 'loads and restraints'} of {name}")
        return source
    text = read_text(file)
    if run.kind == "blocks":
        _read(text, source)
        _raise_water(run, source)
    else:  # of a plain file of lines, rows of seven numbers are bolts
        source.bars += source_of_lines(text).bars
    return source


def add_vehicle(run: Results, number: int, scene: CaseScene, source: Source) -> None:
    """Add the axles of &vehicle where they are in a case, and the surface of the fill below them."""
    corners = np.vstack(scene.shapes(0.0))
    (left, _), (right, top) = corners.min(axis=0), corners.max(axis=0)
    row, depth = run.case(number), run.setting("fill%height")
    level = None if depth is None else float(top) + float(row.get("height", depth))
    axles, spacings = _lists(run, source, "vehicle", "axles", "spacings")
    place = float(row.get("worst_position", math.nan))
    if math.isnan(place):
        place = float(row.get("position") or run.setting("vehicle%position") or math.nan)
    if row.get("worst_direction") == "backward":
        axles, spacings = axles[::-1], spacings[::-1]
    places = [] if math.isnan(place) else list(itertools.accumulate(spacings, initial=place))
    for axle, x in zip(axles, places):
        # those beside the arch stand as high as its ends
        heights = scene.crossings(min(max(x, float(left)), float(right))) if level is None else [level]
        point = x, max(heights, default=float(top))
        source.loads.append((point, (0.0, -axle), True))
        if level is not None or not left <= x <= right:
            source.still.add(point)
    if level is not None:
        ends = [float(left), float(right), *places]
        source.surface.append([(min(ends), level), (max(ends), level)])


def _raise_water(run: Results, source: Source) -> None:
    """Raise all lines of heads by what the deck says; where that is searched or swept they are as the file has them."""
    if not source.water:
        return
    names = {name.rpartition("%")[2] for name in (*run.swept, run.setting("search%parameter") or "")}
    if "water_rise" in names:
        source.missing.append("the rise of the water, which varies")
        return
    rise = float(run.setting("load%water_rise") or 0.0)
    source.water = [[(x, y + rise) for x, y in line] for line in source.water]


def _lists(run: Results, source: Source, group: str, *keys: str) -> list[list[float]]:
    """Lists of a group of the deck; empty ones, and a word about them, where they are swept."""
    stems = {name.rpartition("%")[2].partition("(")[0] for name in run.swept}
    if stems & set(keys) and run.settings(f"{group}%{keys[0]}"):
        source.missing.append(f"&{group}, which is swept")
        return [[] for _ in keys]
    return [[float(value) for value in run.settings(f"{group}%{key}")] for key in keys]


def source_of_lines(text: str) -> Source:
    """Bolts of a plain file of lines: its rows of seven numbers."""
    rows = [_numbers(line.split()) for line in text.splitlines()]
    return Source(bars=[((row[0], row[1]), (row[2], row[3])) for row in rows if len(row) == 7])


def read_source(text: str) -> Source:
    """Contents of a file of blocks."""
    source = Source()
    _read(text, source)
    return source


def _read(text: str, source: Source) -> None:
    """Take in the entries of a file of blocks."""
    for words, rows in entries_of(text):
        _take(words, _numbers(rows[-1]) if rows else [], source)


def _numbers(words: list[str]) -> list[float]:
    """Those that a row begins with."""
    found = []
    for word in words:
        try:
            found.append(float(word.replace("d", "e")))
        except ValueError:
            break
    return found


def _take(entry: list[str], last: list[float], source: Source) -> None:
    """Take in one entry; `last` is the last row of its history."""
    name, words = entry[0], entry[1:]
    if name == "block":
        source.materials.append(int(words[words.index("material") + 1]) if "material" in words else 1)
        return
    values = _numbers(words[2:] if words[:1] == ["block"] else words)
    if name in ("load", "live") and len(values) >= 2:
        force = values[2:4] if len(values) >= 4 else last[1:3]
        if len(force) == 2:  # a record's forces are in another file
            source.loads.append(((values[0], values[1]), (force[0], force[1]), name == "live"))
    elif name in ("fix", "fix_line", "displacement") and len(values) >= 2:
        ends = values[2:4] if name == "fix_line" else values[:2]
        along = words[-1] if words[-1] in ("x", "y") else ""
        source.held.append(((values[0], values[1]), (ends[0], ends[1]), along))
    elif name == "bar" and len(values) >= 4:
        source.bars.append(((values[0], values[1]), (values[2], values[3])))
    elif name == "absorb" and len(values) >= 4:
        source.absorbing.append(((values[0], values[1]), (values[2], values[3])))
    elif name == "water":
        rise = last[1] if len(last) > 1 else 0.0
        source.water.append([(x, y + rise) for x, y in zip(values[::2], values[1::2])])
