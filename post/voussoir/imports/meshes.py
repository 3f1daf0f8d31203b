"""Polygons of meshes, by meshio."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from voussoir.extras import load
from voussoir.imports.limits import one_line
from voussoir.imports.linework import Found
from voussoir.imports.notes import Notes
from voussoir.imports.plane import Plane


def read_mesh(file: Path, plane: Plane, notes: Notes) -> Found:
    """Triangles, quadrilaterals and polygons of a mesh, their layers those of gmsh's physical groups; points and lines
    are left out.
    """
    geometry = load("shapely.geometry", "a mesh")
    mesh = _mesh_of(file)
    points = np.asarray(mesh.points, dtype=float)
    if points.ndim != 2 or points.shape[1] not in (2, 3) or not np.all(abs(points) <= 1e12):
        raise ValueError("expected points of a mesh with two or three numbers within 1e12, got others")
    used: list[tuple[str, np.ndarray, str]] = []
    surfaces: list[int] = []  # 0 where not known
    for cells, groups, entities in zip(mesh.cells, _groups_of(mesh), _surfaces_of(mesh)):
        if cells.type in ("vertex", "line", "line3"):
            notes.left_out.append(f"{len(cells.data)} cells '{cells.type}'")
            continue
        for number, cell in enumerate(cells.data, 1):
            words, corners = f"{cells.type} {number}", np.asarray(cell)
            if cells.type not in ("triangle", "quad", "polygon") or len(corners) < 3:
                yield f"{words}: no polygon", None, ""
            elif corners.min() < 0 or corners.max() >= len(points):
                raise ValueError(f"{words}: expected points from 1 to {len(points)}, got others")
            else:
                used.append((words, corners, groups[number - 1] if number <= len(groups) else ""))
                surfaces.append(entities[number - 1] if number <= len(entities) else 0)
    if len(used) > 1 and (0 in surfaces or len(set(surfaces)) < len(surfaces)):
        notes.warnings.append(
            f"each of the {len(used)} elements is one block; give a stone one polygon, or it breaks at their sides")
    for words, corners, layer in used:
        yield words, geometry.Polygon(plane.flat(points[corners])), layer


def _groups_of(mesh: Any) -> list[list[str]]:
    """Names of the physical groups of the cells, for each piece of the mesh; of a group without a name its number."""
    names = {}
    for name, found in (getattr(mesh, "field_data", None) or {}).items():
        pair = np.ravel(np.asarray(found))
        if len(pair) == 2 and pair[1] == 2:
            names[int(pair[0])] = str(name)
    tags = (getattr(mesh, "cell_data", None) or {}).get("gmsh:physical")
    if tags is None:
        return [[] for _ in mesh.cells]
    return [[names.get(int(tag), f"group {int(tag)}" if tag else "") for tag in np.ravel(part)] for part in tags]


def _surfaces_of(mesh: Any) -> list[list[int]]:
    """Surfaces of gmsh that the cells are of, for each piece of the mesh; empty where they are not known."""
    tags = (getattr(mesh, "cell_data", None) or {}).get("gmsh:geometrical")
    return [[] for _ in mesh.cells] if tags is None else [[int(tag) for tag in np.ravel(part)] for part in tags]


def _mesh_of(file: Path) -> Any:
    """A mesh of meshio; ValueError, for any of its errors, if the file is none."""
    meshio = load("meshio", "a mesh")
    try:
        return meshio.read(file)
    except MemoryError:
        raise
    except (Exception, SystemExit) as problem:  # meshio ends the program, or fails with errors of any kind
        words = "a broken file" if isinstance(problem, SystemExit) else f"{type(problem).__name__}: {one_line(problem)}"
        raise ValueError(f"expected a mesh in a {file.suffix} file that meshio reads, got {words}") from None
