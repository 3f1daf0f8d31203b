"""Outlines of drawings and files of geometry as polygons of shapely, with their layers."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional

from voussoir.deck.dxf_shapes import Found, metres_a_unit, read_dxf
from voussoir.deck.shapely_blocks import polygons_of
from voussoir.extras import load
from voussoir.files import read_text


@dataclass(frozen=True)
class ImportedShape:
    """An outline."""

    polygon: Any  #: Of shapely, in metres
    layer: str  #: Its layer, or its property role, layer or name; empty if it has none


def read_shapes(
    file: Path, scale: Optional[float], tolerance: float
) -> tuple[list[ImportedShape], list[str], tuple[float, str]]:
    """Outlines of a file: the outlines, in words what was dropped, and the scale with who says so.

    The file's ending says how it is read, see `READERS`. The scale, metres a unit, is by default what a drawing says,
    else 1; chords are within a tolerance of their arcs [m]. ValueError if the file is none of its kind, MissingPackage
    if it needs one.
    """
    if file.suffix.lower() not in READERS:
        raise ValueError(f"expected a file of {', '.join(READERS)}, got '{file.suffix}'")
    affinity = load("shapely.affinity", "an outline")
    said = metres_a_unit(file) if scale is None and file.suffix.lower() == ".dxf" else None
    whose = "--scale" if scale is not None else "the drawing" if said else "no unit is named; --scale S sets another"
    scale = scale or said or 1.0
    shapes, dropped = [], []
    for words, geometry, layer in READERS[file.suffix.lower()](file, tolerance / scale):
        if geometry is None:
            dropped.append(words)
            continue
        found, lost = polygons_of(geometry)
        dropped += [f"{words}: {what}" for what in lost]
        for polygon in found:
            if not polygon.is_valid:
                dropped.append(f"{words}: an outline that crosses itself")
                continue
            scaled = affinity.scale(polygon, scale, scale, origin=(0.0, 0.0))
            shapes.append(ImportedShape(scaled, layer))
    return shapes, dropped, (scale, whose)


def read_wkt(file: Path, tolerance: float) -> Found:
    """Geometries in well-known text, one a line; a layer may stand before it, with a semicolon."""
    wkt = load("shapely.wkt", "WKT")
    for number, line in enumerate(read_text(file).splitlines(), 1):
        layer, _, text = line.rpartition(";")
        if not text.strip():
            continue
        try:
            yield f"line {number}", wkt.loads(text), layer.strip()
        except Exception as problem:  # shapely's errors differ by version
            raise ValueError(f"expected WKT in line {number}, got: {problem}") from problem


def read_geojson(file: Path, tolerance: float) -> Found:
    """Features, or a geometry; the property role, layer or name is the layer."""
    geometry = load("shapely.geometry", "GeoJSON")
    try:
        content = json.loads(read_text(file))
    except json.JSONDecodeError as problem:
        raise ValueError(f"expected JSON, got: {problem}") from problem
    if isinstance(content, list) or "dtype" in content:
        yield from read_compas(file)
        return
    for number, feature in enumerate(content.get("features", [content]), 1):
        shape = feature.get("geometry", feature) if feature.get("type") == "Feature" else feature
        known = feature.get("properties") or {}
        layer = next((str(known[key]) for key in ("role", "layer", "name") if known.get(key)), "")
        yield f"feature {number}", geometry.shape(shape) if shape else None, layer


def read_compas(file: Path) -> Found:
    """Blocks of an assembly, meshes or polygons of COMPAS: their faces at one end of the depth; supports are fixed."""
    compas = load("compas", "a file of COMPAS")
    content = compas.json_load(file)
    parts = content if isinstance(content, list) else [content]
    found: list[tuple[Any, str]] = []
    for part in parts:
        if hasattr(part, "graph"):
            nodes = [part.graph.node_attributes(node) for node in part.graph.nodes()]
            found += [(node["block"], "fixed" if node.get("is_support") else "") for node in nodes]
        else:
            found.append((part, ""))
    axis = _depth([_faces(part) for part, _ in found])
    for number, (part, layer) in enumerate(found, 1):
        words, faces = f"{type(part).__name__} {number}", _faces(part)
        if axis is None or not faces:
            yield f"{words}: no outline of one depth", None, ""
        else:
            yield words, _end_face(faces, axis), layer


def _faces(part: Any) -> list[list[list[float]]]:
    """Faces of a mesh of COMPAS, or the one that a polygon is; none of what is neither."""
    if hasattr(part, "face_coordinates"):
        return [part.face_coordinates(face) for face in part.faces()]
    return [[list(point) for point in part.points]] if hasattr(part, "points") else []


def _depth(bodies: list[list[list[list[float]]]]) -> int | None:
    """The axis along which all bodies have one depth or two ends: y where z is up, else z or x."""
    for axis in (1, 2, 0):
        ends = [{round(point[axis], 9) for face in faces for point in face} for faces in bodies]
        if bodies and all(len(values) <= 2 for values in ends):
            return axis
    return None


def _end_face(faces: list[list[list[float]]], axis: int) -> Any:
    """The outline that a body has at the lower end of its depth."""
    shape, join = load("shapely.geometry", "a file of COMPAS"), load("shapely.ops", "a file of COMPAS")
    low = min(point[axis] for face in faces for point in face)
    first, second = (place for place in range(3) if place != axis)
    ends = [face for face in faces if all(abs(point[axis] - low) < 1e-9 for point in face)]
    return join.unary_union([shape.Polygon([(point[first], point[second]) for point in face]) for face in ends])


def read_mesh(file: Path, tolerance: float) -> Found:
    """Polygons of a mesh, by meshio; the place of their kind is no layer."""
    meshio = load("meshio", "a mesh")
    geometry = load("shapely.geometry", "a mesh")
    mesh = meshio.read(file)
    for cells in mesh.cells:
        for number, cell in enumerate(cells.data, 1):
            words = f"{cells.type} {number}"
            if len(cell) < 3 or cells.type not in ("triangle", "quad", "polygon"):
                yield f"{words}: no polygon", None, ""
                continue
            yield words, geometry.Polygon(mesh.points[cell][:, :2]), ""


#: How a file is read, by its ending
READERS = {
    ".dxf": read_dxf, ".geojson": read_geojson, ".json": read_geojson, ".wkt": read_wkt, ".msh": read_mesh,
    ".vtk": read_mesh, ".vtu": read_mesh}
