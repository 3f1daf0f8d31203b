"""Outlines of a DXF drawing: polylines, arcs and single lines as polygons whose chords meet at common corners."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Optional

import numpy as np

from voussoir.extras import load

#: Ends and corners as near as this share of the tolerance are one
_SAME = 0.1
_PURPOSE = "a DXF drawing"
#: What a reader gives: words for messages, a geometry or None where there is none, the layer
Found = Iterator[tuple[str, Any, str]]


@dataclass(frozen=True)
class Edge:
    """A straight line, or an arc, between two points; bulge is the tangent of a quarter of its turn, as in DXF."""

    start: complex
    end: complex
    bulge: float = 0.0


@dataclass(frozen=True)
class Drawn:
    """An entity as edges in a row; words for messages, and its layer."""

    words: str
    layer: str
    edges: tuple[Edge, ...]
    closed: bool


@lru_cache(maxsize=1)
def _drawing(file: Path) -> Any:
    """The drawing of a file."""
    ezdxf = load("ezdxf", _PURPOSE)
    try:
        return ezdxf.readfile(file)
    except ezdxf.DXFStructureError as problem:
        raise ValueError(f"expected a DXF drawing, got: {problem}") from problem


def metres_a_unit(file: Path) -> Optional[float]:
    """What the drawing says that its unit is [m]; None if it names none."""
    units = load("ezdxf.units", _PURPOSE)
    named = _drawing(file).units
    return units.conversion_factor(named, units.M) if named else None


def read_dxf(file: Path, tolerance: float) -> Found:
    """Closed polylines, circles, ellipses, splines; what single lines and arcs of a layer enclose.

    Arcs are cut where corners of other outlines lie on them, so that both sides of a curved joint have the same chords.
    """
    shape = load("shapely.geometry", _PURPOSE)
    drawn: list[Drawn] = []
    for entity in _taken_apart(_drawing(file).modelspace()):
        words = f"{entity.dxftype()} on layer {entity.dxf.layer}"
        edges = _edges_of(entity, tolerance)
        if not edges:
            yield f"{words}: no outline", None, ""
            continue
        closed = abs(edges[0].start - edges[-1].end) <= _SAME * tolerance
        drawn.append(Drawn(words, entity.dxf.layer, edges, closed))
    corners = np.array([edge.start for one in drawn for edge in one.edges] + [one.edges[-1].end for one in drawn])
    loose: dict[str, list[Drawn]] = {}
    for one in drawn:
        if one.closed:
            chords = (_chords(edge, corners, tolerance, edge.bulge != 0.0) for edge in one.edges)
            points = [point for row in chords for point in row[:-1]]
            if len(points) > 2:
                yield one.words, shape.Polygon([(point.real, point.imag) for point in points]), one.layer
            else:
                yield f"{one.words}: no area", None, ""
        else:
            loose.setdefault(one.layer, []).append(one)
    for layer, lines in loose.items():
        yield from _enclosed(layer, lines, corners, tolerance)


def _enclosed(layer: str, lines: list[Drawn], corners: np.ndarray, tolerance: float) -> Found:
    """What the open lines of a layer enclose, and how many of their pieces enclose nothing."""
    shape, join = load("shapely.geometry", _PURPOSE), load("shapely.ops", _PURPOSE)
    ends = _Ends(_SAME * tolerance)
    pieces = []
    for edge in (edge for line in lines for edge in line.edges):
        points = [ends.of(point) for point in _chords(edge, corners, tolerance)]
        pieces += [shape.LineString(pair) for pair in zip(points, points[1:]) if pair[0] != pair[1]]
    faces, cuts, dangles, rings = join.polygonize_full(join.unary_union(pieces))
    for number, face in enumerate(faces.geoms, 1):  # without the corners of others on its straight edges
        yield f"outline {number} of lines on layer {layer}", face.simplify(_SAME**2 * tolerance), layer
    left = len(cuts.geoms) + len(dangles.geoms) + len(rings.geoms)
    if left:
        kinds = sorted({line.words.split()[0] for line in lines})
        words = " encloses" if left == 1 else "s enclose"
        yield f"{' and '.join(kinds)} on layer {layer}: {left} piece{words} nothing", None, ""


class _Ends:
    """Points as pairs of numbers, those that nearly meet as one."""

    def __init__(self, reach: float) -> None:
        self._reach = reach
        self._cells: dict[tuple[int, int], tuple[float, float]] = {}

    def of(self, point: complex) -> tuple[float, float]:
        """The first point that was within reach of this one, or itself."""
        i, j = round(point.real / self._reach), round(point.imag / self._reach)
        around = ((i + di, j + dj) for di in (0, -1, 1) for dj in (0, -1, 1))
        known = next((self._cells[cell] for cell in around if cell in self._cells), None)
        if known is None or abs(complex(*known) - point) > self._reach:
            known = self._cells[i, j] = (point.real, point.imag)
        return known


def _taken_apart(entities: Iterable[Any]) -> Iterator[Any]:
    """Entities, those of inserted blocks in their places."""
    for entity in entities:
        if entity.dxftype() != "INSERT":
            yield entity
            continue
        for one in entity.multi_insert() if entity.mcount > 1 else [entity]:
            for inner in _taken_apart(one.virtual_entities()):
                if inner.dxf.layer == "0":  # of the layer of its insert
                    inner.dxf.layer = entity.dxf.layer
                yield inner


def _edges_of(entity: Any, tolerance: float) -> tuple[Edge, ...]:
    """An entity as edges: arcs of circles as they are, other curves as chords; none of what is no line."""
    kind = entity.dxftype()
    if kind in ("LWPOLYLINE", "POLYLINE"):
        parts = [part for part in entity.virtual_entities() if part.dxftype() in ("LINE", "ARC")]
        edges = [edge for part in parts for edge in _edges_of(part, tolerance)]
        return _in_a_row([edge for edge in edges if edge.start != edge.end])
    if kind == "ARC":
        turn = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0) or 2.0 * math.pi
        side = -1.0 if entity.dxf.extrusion.z < 0.0 else 1.0  # seen from behind
        centre = entity.ocs().to_wcs(entity.dxf.center)
        start, end = (complex(point.x, point.y) for point in (entity.start_point, entity.end_point))
        if turn < 6.28:  # a whole turn begins where it ends: it needs two
            return (Edge(start, end, side * math.tan(turn / 4.0)),)
        middle = complex(centre.x, centre.y)
        middle += (start - middle) * complex(math.cos(turn / 2.0), side * math.sin(turn / 2.0))
        return tuple(Edge(*pair, side * math.tan(turn / 8.0)) for pair in ((start, middle), (middle, end)))
    if kind == "CIRCLE":
        centre = entity.ocs().to_wcs(entity.dxf.center)
        right, left = (complex(centre.x + sign * entity.dxf.radius, centre.y) for sign in (1.0, -1.0))
        return (Edge(right, left, 1.0), Edge(left, right, 1.0))
    try:
        path = load("ezdxf.path", _PURPOSE).make_path(entity)
    except TypeError:
        return ()
    points = [complex(point.x, point.y) for point in path.flattening(tolerance)]
    return tuple(Edge(*pair) for pair in zip(points, points[1:]) if pair[0] != pair[1])


def _in_a_row(edges: list[Edge]) -> tuple[Edge, ...]:
    """Edges of a polyline, each from where the one before it ends: an arc of ezdxf runs against the clock."""
    row: list[Edge] = []
    for number, edge in enumerate(edges):
        turned = Edge(edge.end, edge.start, -edge.bulge)
        if number == 0:
            after = edges[1] if len(edges) > 1 else edge
            gap = {one: min(abs(one.end - after.start), abs(one.end - after.end)) for one in (edge, turned)}
            row.append(min(gap, key=gap.__getitem__))
        else:
            row.append(min((edge, turned), key=lambda one: abs(one.start - row[-1].end)))
    return tuple(row)


def _chords(edge: Edge, corners: np.ndarray, tolerance: float, cut: bool = True) -> list[complex]:
    """Points of an edge from its start to its end: corners that lie on it, and of an arc the ends of its chords."""
    if not cut:
        return [edge.start, edge.end]
    reach, way = _SAME * tolerance, edge.end - edge.start
    if edge.bulge == 0.0:
        along = ((corners - edge.start) / way).real
        off = abs(corners - edge.start - along * way)
        length, turn, centre = abs(way), 0.0, edge.start
    else:
        turn = 4.0 * math.atan(edge.bulge)
        centre = edge.start + way * complex(0.5, (1.0 - edge.bulge**2) / (4.0 * edge.bulge))
        radius = abs(edge.start - centre)
        angle = np.angle((corners - centre) / (edge.start - centre)) * math.copysign(1.0, turn)
        along = np.where(angle < -math.pi * 1e-9, angle + 2.0 * math.pi, angle) / abs(turn)
        off = abs(abs(corners - centre) - radius)
        length = radius * abs(turn)
    margin = reach / length
    on = (off <= reach) & (along > margin) & (along < 1.0 - margin)
    stops = [(0.0, edge.start)]
    for place, point in sorted(zip(along[on], corners[on]), key=lambda pair: pair[0]):
        if place - stops[-1][0] > margin:
            stops.append((float(place), complex(point)))
    stops.append((1.0, edge.end))
    if turn == 0.0:
        return [point for _, point in stops]
    most = 2.0 * math.acos(max(1.0 - tolerance / radius, 0.5))
    points = [edge.start]
    for (low, _), (high, end) in zip(stops, stops[1:]):
        count = math.ceil((high - low) * abs(turn) / most - 1e-9)
        for step in range(1, count):
            spin = turn * (low + (high - low) * step / count)
            points.append(centre + (edge.start - centre) * complex(math.cos(spin), math.sin(spin)))
        points.append(end)
    return points
