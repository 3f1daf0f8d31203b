"""Geometries of GeoJSON (RFC 7946) and of well-known text."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from voussoir.extras import load
from voussoir.files import read_text
from voussoir.imports.compas import is_compas, read_compas
from voussoir.imports.layers import layer_of
from voussoir.imports.limits import one_line
from voussoir.imports.linework import Found
from voussoir.imports.plane import Plane

#: Depth of the lists of coordinates by the type of a geometry, and the least number of positions of a line
_DEPTH = {"Point": 0, "MultiPoint": 1, "LineString": 1, "MultiLineString": 2, "Polygon": 2, "MultiPolygon": 3}
_LEAST = {"LineString": 2, "MultiLineString": 2, "Polygon": 4, "MultiPolygon": 4}
_TYPES = (*_DEPTH, "GeometryCollection", "Feature", "FeatureCollection")
#: A file without a unit whose size is below this many units, or this share of its distance from the origin, is in
#: degrees if it can be: 0.1 degree is 11 km, 0.1 m no structure
_LEAST_SIZE, _LEAST_SHARE = 0.1, 0.02
#: Names of longitude and latitude as coordinate reference systems
_GEOGRAPHIC = re.compile(r"CRS:?84|EPSG:+4326$|SRID=4326$", re.IGNORECASE)
_ADVICE = (
    "expected coordinates of length, got longitude and latitude (RFC 7946); project them to metres first, such as with "
    "ogr2ogr -t_srs EPSG:32632, or name their unit with --unit m")


def read_json(file: Path, plane_name: str, plane: Plane, tolerance: float, has_unit: bool) -> Found:
    """Features, or a geometry, or what COMPAS has written; the property role, layer, material or name is the layer,
    with `fixed` and the properties of a material.

    ValueError if GeoJSON without a unit is in degrees.
    """
    text = read_text(file)
    try:
        content = json.loads(text)
    except json.JSONDecodeError as problem:
        raise ValueError(f"line {problem.lineno}: expected JSON, got: {problem.msg}") from None
    except ValueError:  # the interpreter's limit
        raise ValueError("expected JSON, got a number of thousands of digits") from None
    if is_compas(content):
        yield from read_compas(content, plane_name, tolerance)
        return
    if not isinstance(content, dict) or content.get("type") not in _TYPES:
        kind = content.get("type") if isinstance(content, dict) else None
        got = f"the type {str(kind)[:40]!r}" if kind is not None else f"a JSON {_json_word(content)}"
        hint = "; convert TopoJSON to GeoJSON" if kind == "Topology" else ""
        raise ValueError(
            f"expected GeoJSON, with a type such as FeatureCollection, or a file of COMPAS, got {got}{hint}")
    if _GEOGRAPHIC.search(json.dumps(content.get("crs") or "")):
        raise ValueError(_ADVICE)
    features = content.get("features") if content["type"] == "FeatureCollection" else [content]
    if not isinstance(features, list):
        raise ValueError("expected a list of features, got none")
    found = []
    for number, feature in enumerate(features, 1):
        words = f"feature {number}"
        if not isinstance(feature, dict):
            raise ValueError(f"{words}: expected an object, got {str(feature)[:40]!r}")
        shape = feature.get("geometry") if feature.get("type") == "Feature" else feature
        known = feature.get("properties")
        known = known if isinstance(known, dict) else {}
        found.append((words, None if shape is None else _geometry(shape, plane, words), layer_of(known, words)))
    if not has_unit:
        _check_is_length([geometry for _, geometry, _ in found if geometry is not None])
    yield from found


def _json_word(content: object) -> str:
    """The kind of a JSON value, in JSON's own words."""
    words = {dict: "object", list: "array", str: "string", bool: "boolean", type(None): "null"}
    return words.get(type(content), "number")


def _geometry(shape: Any, plane: Plane, words: str) -> Any:
    """A geometry of shapely; ValueError if the object is no geometry of GeoJSON."""
    base = load("shapely.geometry", "GeoJSON")
    kind = shape.get("type") if isinstance(shape, dict) else None
    if kind == "GeometryCollection" and isinstance(shape.get("geometries"), list):
        return base.GeometryCollection([_geometry(part, plane, words) for part in shape["geometries"]])
    if kind not in _DEPTH:
        raise ValueError(f"{words}: expected a geometry of GeoJSON, got {str(kind or shape)[:40]!r}")
    return base.shape({"type": kind, "coordinates": _coordinates(
        shape.get("coordinates"), _DEPTH[kind], _LEAST.get(kind, 0), plane, f"{words}: {kind}")})


def _coordinates(given: Any, depth: int, least: int, plane: Plane, words: str) -> Any:
    """Positions in lists of a depth, in a plane."""
    if not isinstance(given, list):
        raise ValueError(f"{words}: expected lists of coordinates, got {str(given)[:40]!r}")
    if depth > 1:
        return [_coordinates(part, depth - 1, least, plane, words) for part in given]
    positions = [given] if depth == 0 else given
    if len(positions) < least:
        raise ValueError(f"{words}: expected at least {least} positions, got {len(positions)}")
    for position in positions:
        if not isinstance(position, list) or len(position) < 2 or not all(map(_is_number, position[:3])):
            raise ValueError(f"{words}: expected positions of two or three numbers, got {str(position)[:40]!r}")
    space = [[*position[:3], 0.0][:3] for position in positions]
    flat = [tuple(point) for point in plane.flat(space).tolist()] if space else []
    return flat[0] if depth == 0 else flat


def _is_number(value: Any) -> bool:
    """Whether a value is a finite number of a drawing."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= 1e12


def read_wkt(file: Path, plane: Plane, has_unit: bool) -> Found:
    """Geometries in well-known text, one a line; a layer may stand before it, with a semicolon.

    ValueError if text without a unit is in degrees.
    """
    wkt, errors = load("shapely.wkt", "WKT"), load("shapely.errors", "WKT")
    base = load("shapely.geometry", "WKT")
    found = []
    for number, line in enumerate(read_text(file).splitlines(), 1):
        layer, _, text = line.rpartition(";")
        if not text.strip():
            continue
        if _GEOGRAPHIC.search(layer):
            raise ValueError(_ADVICE)
        try:
            geometry = wkt.loads(text)
        except (errors.ShapelyError, ValueError, TypeError) as problem:
            raise ValueError(f"expected WKT in line {number}, got: {one_line(problem)}") from None
        same = json.loads(json.dumps(base.mapping(geometry)).replace('"LinearRing"', '"LineString"'))
        shape = geometry if geometry.is_empty else _geometry(same, plane, f"line {number}")
        found.append((f"line {number}", shape, re.sub(r"^SRID=\d+$", "", layer.strip())))
    if not has_unit:
        _check_is_length([shape for _, shape, _ in found])
    yield from found


def _check_is_length(shapes: list[Any]) -> None:
    """Refuse geometries whose coordinates can be longitude and latitude and are of no size as metres."""
    bounds = np.array([shape.bounds for shape in shapes if not shape.is_empty])
    if not len(bounds):
        return
    low, high = bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)
    size, away = math.hypot(*(high - low)), math.hypot(*(high + low)) / 2.0
    in_range = np.all(abs(low) <= (180.0, 90.0)) and np.all(abs(high) <= (180.0, 90.0))
    if in_range and 0.0 < size < max(_LEAST_SIZE, _LEAST_SHARE * away):
        raise ValueError(_ADVICE)
