"""Polygons of shapely made fit for blocks: collections taken apart, holes cut open."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from voussoir.extras import load

_PURPOSE = "polygons"


def polygons_of(shapes: Any) -> tuple[list[Any], list[str]]:
    """Polygons of a geometry or of several, and in words what is none; TypeError if something is no geometry."""
    base = load("shapely.geometry.base", _PURPOSE)
    if not isinstance(shapes, (base.BaseGeometry, Iterable)):
        raise TypeError(f"expected geometries of shapely, got {shapes!r}")
    found: list[Any] = []
    dropped: list[str] = []
    for number, shape in enumerate([shapes] if isinstance(shapes, base.BaseGeometry) else shapes, 1):
        if not isinstance(shape, base.BaseGeometry):
            raise TypeError(f"expected a geometry of shapely, got {shape!r}")
        for part in getattr(shape, "geoms", [shape]):
            if part.geom_type == "Polygon" and part.area > 0.0:
                found.append(part)
            elif hasattr(part, "geoms"):
                inner, lost = polygons_of(part)
                found += inner
                dropped += lost
            else:
                dropped.append(f"geometry {number}, a {part.geom_type} without area")
    return found, dropped


def pieces_of(polygon: Any) -> list[Any]:
    """A polygon, or the pieces without holes that upright lines through the middle of each hole make of it."""
    if not polygon.interiors:
        return [polygon]
    load("shapely", _PURPOSE)
    from shapely.geometry import LineString
    from shapely.ops import split

    low, high = polygon.bounds[1], polygon.bounds[3]
    reach = high - low
    middles = sorted(ring.envelope.centroid.x for ring in polygon.interiors)
    middle = middles[len(middles) // 2]  # halves are cut further
    line = LineString([(middle, low - reach), (middle, high + reach)])
    parts = (part.simplify(1e-9 * reach) for part in split(polygon, line).geoms)  # without corners that nearly meet
    return [piece for part in parts for piece in pieces_of(part)]
