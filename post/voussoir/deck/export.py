"""Blocks of results as drawings and files of geometry, which `voussoir import` reads back."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from voussoir.extras import load
from voussoir.files import fresh, write_text
from voussoir.plot.source_file import source_of
from voussoir.results import Results


@dataclass(frozen=True)
class Outline:
    """A block as it is drawn: its number, corners (n, 2) [m] and layer."""

    number: int
    corners: np.ndarray
    layer: str


def outlines_of(run: Results, case: int, magnify: float = 0.0) -> list[Outline]:
    """Blocks of a case, on the layer "fixed", "blocks", or "material N" for materials from 2 on.

    They have moved by so many times their displacements; ValueError if these are not known, KeyError without blocks.
    """
    materials = source_of(run).materials
    found = []
    for block in run.blocks_of(case):
        material = materials[block.number - 1] if block.number <= len(materials) else 1
        layer = "fixed" if block.state == "fixed" else "blocks" if material == 1 else f"material {material}"
        moved = block.corners if magnify == 0.0 else block.corners + magnify * block.displacement
        if not np.all(np.isfinite(moved)):
            raise ValueError(f"expected displacements of case {case}, got none of block {block.number}")
        found.append(Outline(block.number, moved, layer))
    return found


def write_geojson(outlines: list[Outline], file: Path) -> str:
    """A feature a block, with its role and number."""
    features = [
        {
            "type": "Feature",
            "properties": {"role": outline.layer, "block": outline.number},
            "geometry": {"type": "Polygon", "coordinates": [_ring(outline)]},
        }
        for outline in outlines
    ]
    write_text(file, json.dumps({"type": "FeatureCollection", "features": features}, indent=1) + "\n")
    return ""


def write_wkt(outlines: list[Outline], file: Path) -> str:
    """A polygon a line, its layer and a semicolon before it."""
    lines = [
        f"{outline.layer}; POLYGON ((" + ", ".join(f"{float(x)!r} {float(y)!r}" for x, y in _ring(outline)) + "))"
        for outline in outlines
    ]
    write_text(file, "\n".join(lines) + "\n")
    return "numbers of blocks"


def write_dxf(outlines: list[Outline], file: Path) -> str:
    """A closed polyline a block on its layer, in metres."""
    ezdxf = load("ezdxf", "a DXF drawing")
    drawing = ezdxf.new(units=6)
    for layer in dict.fromkeys(outline.layer for outline in outlines):
        drawing.layers.add(layer)
    for outline in outlines:
        drawing.modelspace().add_lwpolyline(_ring(outline)[:-1], close=True, dxfattribs={"layer": outline.layer})
    drawing.saveas(fresh(file))
    return "numbers of blocks"


def write_mesh(outlines: list[Outline], file: Path) -> str:
    """A cell a block, by meshio."""
    meshio = load("meshio", "a mesh")
    points = np.vstack([outline.corners for outline in outlines])
    starts = np.cumsum([0, *(len(outline.corners) for outline in outlines)])
    cells: list[tuple[str, list[Any]]] = []
    for outline, start in zip(outlines, starts):
        kind = {3: "triangle", 4: "quad"}.get(len(outline.corners), "polygon")
        corners = list(range(start, start + len(outline.corners)))
        if cells and cells[-1][0] == kind and len(cells[-1][1][0]) == len(corners):
            cells[-1][1].append(corners)
        else:
            cells.append((kind, [corners]))
    try:
        meshio.Mesh(np.column_stack((points, np.zeros(len(points)))), cells).write(fresh(file))
    except meshio.WriteError as problem:
        raise ValueError(f"expected a mesh that can hold these blocks, got: {problem}") from problem
    return "layers and numbers of blocks, and fixed blocks"


#: How a file is written, by its ending; each gives in words what the file cannot hold
WRITERS = {
    ".dxf": write_dxf, ".geojson": write_geojson, ".json": write_geojson, ".wkt": write_wkt, ".vtk": write_mesh,
    ".vtu": write_mesh, ".msh": write_mesh}


def _ring(outline: Outline) -> list[tuple[float, float]]:
    """Its corners, the first again at the end."""
    return [(float(x), float(y)) for x, y in [*outline.corners, outline.corners[0]]]
