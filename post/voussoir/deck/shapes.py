"""Outlines of drawings and files of geometry as polygons of shapely, with their layers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional

from voussoir.deck.blocks import polygons_of
from voussoir.extras import load
from voussoir.files import plain
from voussoir.imports.dxf_drawing import Drawing, read_dxf
from voussoir.imports.geojson import read_json, read_wkt
from voussoir.imports.linework import Found
from voussoir.imports.meshes import read_mesh
from voussoir.imports.notes import Notes
from voussoir.imports.plane import Plane
from voussoir.imports.snapping import snapped
from voussoir.imports.traces import BOUNDARY, Trace, traces_of

#: Endings of files that are read
ENDINGS = (".dxf", ".geojson", ".json", ".wkt", ".msh", ".vtk", ".vtu")
_TEXTS = (".geojson", ".json", ".wkt")


@dataclass(frozen=True)
class ImportedShape:
    """An outline."""

    polygon: Any  #: Of shapely, in metres
    layer: str  #: Its layer, or its property role, layer or name; empty if it has none


@dataclass
class Content:
    """Content of a file besides outlines: its lines if it has no outlines, and remarks."""

    lines: list[Trace] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)


def read_shapes(
    file: Path, scale: Optional[float], tolerance: float, snap: float = 0.0, plane: str = "",
    content: Optional[Content] = None
) -> tuple[list[ImportedShape], list[str], tuple[float, str]]:
    """Outlines of a file: the outlines, in words what was dropped, and the scale with who says so.

    The file's ending says how it is read. The scale, metres a unit, is by default what a drawing says, else 1. Chords
    are within a tolerance of their arcs, corners and ends within the distance `snap` become one [m]. `content` receives
    lines and remarks. ValueError if the file is none of its kind, MissingPackage if it needs one.
    """
    ending = file.suffix.lower()
    if ending not in ENDINGS:
        cure = "; 'dda cut' reads files of lines, and a geometry of gmsh is imported as its mesh, FILE.msh"
        raise ValueError(
            f"expected a file of {', '.join(ENDINGS)}, got '{file.suffix}'" + (cure if ending == ".geo" else ""))
    plain(file).open("rb").close()  # readers of others say less of what cannot be opened
    load("shapely", "an outline")
    content = Content() if content is None else content
    notes = content.notes
    drawing = Drawing(file) if ending == ".dxf" else None
    said = drawing.metres() if drawing and scale is None else None
    whose = "given" if scale is not None else "the drawing" if said else "no unit is named; --unit U names it"
    factor = scale or said or 1.0
    view = Plane(plane)
    if drawing:
        found: Found = read_dxf(drawing, tolerance / factor, snap / factor, view, notes)
    elif ending == ".wkt":
        found = read_wkt(file, view, scale is not None)
    elif ending in _TEXTS:
        found = read_json(file, plane, view, tolerance / factor, scale is not None)
    else:
        found = read_mesh(file, view, notes)
    rows = list(found)
    if constant := view.depth(tolerance / factor):
        notes.left_out.append(constant)
    content.lines = [] if drawing else _only_lines(rows, factor)
    if content.lines:
        return [], notes.dropped, (factor, whose)
    shapes = _snapped_shapes(list(_polygons(rows, notes)), snap / factor, notes)
    affinity = load("shapely.affinity", "an outline")
    scaled = [
        ImportedShape(affinity.scale(polygon, factor, factor, origin=(0.0, 0.0)), layer) for polygon, layer in shapes]
    return scaled, notes.dropped, (factor, whose)


def _only_lines(rows: list[tuple[str, Any, str]], scale: float) -> list[Trace]:
    """Lines of a file that has no outlines except those of the boundary."""
    given = [(geometry, layer) for _, geometry, layer in rows if geometry is not None and not geometry.is_empty]
    lines = [pair for pair in given if pair[0].geom_type in ("LineString", "MultiLineString", "LinearRing")]
    rims = [pair for pair in given if pair[0].geom_type in ("Polygon", "MultiPolygon") and pair[1].lower() == BOUNDARY]
    if not lines or len(lines) + len(rims) != len(rows):
        return []
    return [trace for geometry, layer in lines + rims for trace in traces_of(geometry, layer, scale)]


def _polygons(rows: list[tuple[str, Any, str]], notes: Notes) -> Iterator[tuple[Any, str, str]]:
    """Polygons that are valid, with words and layers; spikes are cut off, closed lines taken as outlines."""
    shape, validation = load("shapely.geometry", "an outline"), load("shapely.validation", "an outline")
    for words, geometry, layer in rows:
        if geometry is None:
            notes.drop(words, layer)
            continue
        if geometry.geom_type in ("LineString", "LinearRing") and geometry.is_closed and len(geometry.coords) > 3:
            notes.repaired.append(f"{words}: a closed line is taken as an outline")
            geometry = shape.Polygon(geometry.coords)
        found, lost = polygons_of(geometry)
        for what in lost:
            place = "" if geometry.is_empty else f"near ({geometry.centroid.x:.10g}, {geometry.centroid.y:.10g})"
            notes.drop(f"{words}: {what}", place)
        for polygon in found:
            if not polygon.is_valid:
                parts = polygons_of(validation.make_valid(polygon))[0]
                if len(parts) != 1 or abs(parts[0].area - polygon.area) > 1e-9 * polygon.area:
                    x, y = map(float, re.findall(r"[^\s\[\]]+", validation.explain_validity(polygon).partition("[")[2]))
                    notes.drop(f"{words}: an outline that crosses itself", f"at ({x:.10g}, {y:.10g})")
                    continue
                notes.repaired.append(f"{words}: a part of the outline that encloses no area is cut off")
                polygon = parts[0]
            yield polygon, layer, words


def _snapped_shapes(shapes: list[tuple[Any, str, str]], snap: float, notes: Notes) -> list[tuple[Any, str]]:
    """Polygons and layers, their corners moved by at most a distance if it is not 0."""
    polygons = [polygon for polygon, _, _ in shapes]
    if snap > 0.0:
        polygons = snapped(polygons, snap, notes)
    found = []
    for polygon, (_, layer, words) in zip(polygons, shapes):
        if polygon.is_empty or not polygon.is_valid or not polygon.area > 0.0:
            notes.drop(f"{words}: no outline is left where corners are joined")
            continue
        found.append((polygon, layer))
    return found
