"""Drawings and models as text, written by hand as many scripts write them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from pathlib import Path

Point = tuple[float, ...]
UNITS = {"mm": 4, "m": 6}


def groups(*pairs: object) -> list[str]:
    """Lines of a DXF file from codes and values in turn."""
    return [str(part) for part in pairs]


def polyline(layer: str, points: Iterable[Point], closed: int | None = 1, bulges: Iterable[float] = ()) -> list[str]:
    """A LWPOLYLINE; `closed` None leaves its flag out."""
    rows, turns = list(points), list(bulges)
    lines = groups(0, "LWPOLYLINE", 8, layer, 90, len(rows))
    lines += groups(70, closed) if closed is not None else []
    for number, (x, y) in enumerate(rows):
        lines += groups(10, repr(x), 20, repr(y)) + (groups(42, repr(turns[number])) if turns else [])
    return lines


def line(layer: str, start: Point, end: Point) -> list[str]:
    """A LINE."""
    first, second = (*start, 0.0)[:3], (*end, 0.0)[:3]
    return groups(0, "LINE", 8, layer, 10, first[0], 20, first[1], 30, first[2], 11, second[0], 21, second[1], 31,
                  second[2])


def arc(layer: str, centre: Point, radius: float, low: float, high: float) -> list[str]:
    """An ARC between two angles [deg]."""
    return groups(0, "ARC", 8, layer, 10, centre[0], 20, centre[1], 40, repr(radius), 50, low, 51, high)


def ellipse(layer: str, half: float, ratio: float, low: float, high: float) -> list[str]:
    """An ELLIPSE about the origin, its major axis level, between two angles [rad]."""
    return groups(0, "ELLIPSE", 8, layer, 10, 0, 20, 0, 30, 0, 11, repr(half), 21, 0, 31, 0, 40, repr(ratio), 41, low,
                  42, high)


def bezier(layer: str, points: list[Point]) -> list[str]:
    """A SPLINE of degree 3 with four control points."""
    lines = groups(0, "SPLINE", 8, layer, 70, 8, 71, 3, 72, 8, 73, 4, 74, 0)
    for knot in (0, 0, 0, 0, 1, 1, 1, 1):
        lines += groups(40, knot)
    for x, y in points:
        lines += groups(10, repr(x), 20, repr(y), 30, 0)
    return lines


def drawing(*entities: list[str], unit: str = "", blocks: list[str] | None = None) -> str:
    """A DXF file; without a unit it has no header."""
    lines: list[str] = []
    if unit:
        lines += groups(0, "SECTION", 2, "HEADER", 9, "$INSUNITS", 70, UNITS[unit], 0, "ENDSEC")
    if blocks:
        lines += [*groups(0, "SECTION", 2, "BLOCKS"), *blocks, *groups(0, "ENDSEC")]
    lines += groups(0, "SECTION", 2, "ENTITIES")
    for entity in entities:
        lines += entity
    return "\n".join([*lines, *groups(0, "ENDSEC", 0, "EOF")]) + "\n"


def block(name: str, *entities: list[str]) -> list[str]:
    """A block of a DXF file, to be inserted."""
    lines = groups(0, "BLOCK", 2, name, 10, 0, 20, 0)
    for entity in entities:
        lines += entity
    return lines + groups(0, "ENDBLK")


def insert(name: str, layer: str = "0", x: float = 0.0, columns: int = 1, rows: int = 1) -> list[str]:
    """An INSERT, perhaps an array with steps of 2."""
    return groups(0, "INSERT", 8, layer, 2, name, 10, x, 20, 0, 70, columns, 71, rows, 44, 2, 45, 2)


def box(x: float, y: float, width: float, height: float) -> list[Point]:
    """Corners of a rectangle."""
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def feature(corners: list, role: str = "", kind: str = "Polygon") -> dict:
    """A feature of GeoJSON."""
    rows = [list(point) for point in corners]
    coordinates = [[*rows, rows[0]]] if kind == "Polygon" else rows
    return {"type": "Feature", "properties": {"role": role}, "geometry": {"type": kind, "coordinates": coordinates}}


def geojson(path: Path, features: list[dict], **more: object) -> Path:
    """Write a collection of features."""
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features, **more}))
    return path


def mesh(low: Point, high: Point, turn: float = 0.0) -> dict:
    """A box as COMPAS writes a mesh, turned about z [deg]."""
    cos, sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    vertex = {str(n): {"x": x * cos - y * sin, "y": x * sin + y * cos, "z": z} for n, (x, y, z) in enumerate(corners)}
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return {"dtype": "compas.datastructures/Mesh", "data": {
        "vertex": vertex, "face": {str(n): list(face) for n, face in enumerate(faces)}}}


def assembly(path: Path, parts: list[tuple[dict, bool]]) -> Path:
    """Write an assembly of COMPAS: blocks, and whether each is a support."""
    nodes = {str(n): {"block": part, "is_support": support} for n, (part, support) in enumerate(parts)}
    graph = {"dtype": "compas.datastructures/Graph", "data": {
        "default_node_attributes": {"is_support": False, "block": None}, "node": nodes, "edge": {}}}
    path.write_text(json.dumps({"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}))
    return path
