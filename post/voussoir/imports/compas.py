"""Blocks of files of COMPAS: assemblies, meshes, polygons. The ends that all blocks share give the plane."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from voussoir.extras import load
from voussoir.imports.linework import Found
from voussoir.imports.plane import AXES

_PURPOSE = "a file of COMPAS"
#: Most directions that are tried
_MOST_DIRECTIONS = 200


@dataclass(frozen=True)
class _Body:
    """A block: its faces as points (n, 3), and whether it is a support."""

    kind: str
    faces: list[np.ndarray]
    is_support: bool

    @property
    def points(self) -> np.ndarray:
        """Corners of all faces."""
        return np.vstack(self.faces)


def is_compas(content: Any) -> bool:
    """Whether JSON is of COMPAS: an object with a dtype, or a list of such."""
    parts = content if isinstance(content, list) else [content]
    return bool(parts) and all(isinstance(part, dict) and isinstance(part.get("dtype"), str) for part in parts)


def read_compas(content: Any, plane: str, tolerance: float) -> Found:
    """Blocks as outlines, seen along the direction in which all of them have the same two ends; supports are fixed.

    z is up. ValueError, with what differs, if there is no such direction, or two and no name of a plane.
    """
    bodies = list(_bodies(content, False))
    solid = [body for body in bodies if body.faces]
    if not solid:
        raise ValueError("expected an assembly, meshes or polygons of COMPAS, got none")
    axes = _axes_named(solid, plane, tolerance) if plane else _axes_shared(solid, tolerance)
    for number, body in enumerate(bodies, 1):
        words = f"{body.kind} {number}"
        if not body.faces:
            yield f"{words}: no faces", None, ""
            continue
        yield words, _outline(body, axes, tolerance, words), "fixed" if body.is_support else ""


def _bodies(content: Any, is_support: bool) -> Iterator[_Body]:
    """Blocks of an object, a list or an assembly."""
    if isinstance(content, list):
        for part in content:
            yield from _bodies(part, is_support)
        return
    if not isinstance(content, dict):
        return
    kind = str(content.get("dtype", "part")).rpartition("/")[2]
    data = content.get("data", content.get("value"))
    data = data if isinstance(data, dict) else {}
    graph = data.get("graph")
    graph = graph.get("data", graph.get("value")) if isinstance(graph, dict) else None
    if isinstance(graph, dict):
        nodes = graph.get("node")
        if not isinstance(nodes, dict):
            raise ValueError("expected nodes of the graph of an assembly, got none")
        default = graph.get("default_node_attributes", {})
        for name, node in nodes.items():
            if not isinstance(node, dict):
                raise ValueError(f"node {name[:40]}: expected an object, got {str(node)[:40]!r}")
            node = {**default, **node} if isinstance(default, dict) else node
            yield from _bodies(node.get("block"), bool(node.get("is_support")))
    else:
        yield _Body(kind, _faces(data, kind), is_support)


def _faces(data: dict[str, Any], kind: str) -> list[np.ndarray]:
    """Faces of a mesh, a polyhedron or a polygon; none of what is neither."""
    if isinstance(data.get("vertex"), dict) and isinstance(data.get("face"), dict):
        default = data.get("default_vertex_attributes")
        default = default if isinstance(default, dict) else {}
        try:
            points = {key: [float({**default, **vertex}[axis]) for axis in "xyz"]
                      for key, vertex in data["vertex"].items()}
            faces = [[points[str(key)] for key in face] for face in data["face"].values()]
        except (KeyError, TypeError, ValueError, AttributeError):
            raise ValueError(f"expected faces of {kind} whose corners have x, y and z, got others") from None
    elif isinstance(data.get("vertices"), list) and isinstance(data.get("faces"), list):
        try:
            faces = [[data["vertices"][key] for key in face] for face in data["faces"]]
        except (IndexError, TypeError):
            raise ValueError(f"expected faces of {kind} that name its vertices, got others") from None
    else:
        faces = [data["points"]] if isinstance(data.get("points"), list) else []
    try:
        found = [np.array(face, dtype=float).reshape(len(face), 3) for face in faces]
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"expected points of {kind} with three numbers, got others") from None
    if any(not np.all(abs(face) <= 1e12) for face in found):
        raise ValueError(f"expected points of {kind} within 1e12, got others")
    return [face for face in found if len(face) > 2]


def _axes_named(bodies: list[_Body], plane: str, tolerance: float) -> np.ndarray:
    """Rows are the directions to the right, up and along the view of a plane, in which bodies must share their ends."""
    axes = np.eye(3)[list(AXES[plane])]
    if (spread := _spread(bodies, axes[2])) > tolerance:
        raise ValueError(_no_plane(spread, axes[2]))
    return axes


def _axes_shared(bodies: list[_Body], tolerance: float) -> np.ndarray:
    """Directions to the right, up and along the view in which bodies share their ends.

    Those that supports share, too, come before those in which supports extend beyond the other blocks.
    """
    blocks = [body for body in bodies if not body.is_support] or bodies
    spreads = [(_spread(bodies, way), way) for way in _directions(min(blocks, key=lambda body: len(body.faces)))]
    shared = [way for spread, way in spreads if spread <= tolerance]
    exact = [way for way in shared if _spread([replace(body, is_support=False) for body in bodies], way) <= tolerance]
    level = next(filter(None, ([way for way in ways if abs(way[2]) < 1e-6] for ways in (exact, shared))), [])
    if len(level) > 1:
        names = " and along ".join(_name(way) for way in level)
        raise ValueError(f"expected blocks that share both ends in one level direction, got it along {names}; "
                         "choose --plane xz or --plane yz")
    if level:
        return _upright_axes(level[0])
    if any(abs(way[2]) > 1.0 - 1e-9 for way in shared):
        return np.eye(3)
    if shared:
        raise ValueError(f"expected blocks seen in a level direction, as z is up, got {_name(shared[0])}")
    if not spreads:
        raise ValueError("expected faces with an area, got none")
    raise ValueError(_no_plane(*min(spreads, key=lambda pair: pair[0])))


def _no_plane(spread: float, way: np.ndarray) -> str:
    """What is wrong with blocks that do not share their ends."""
    return (
        f"expected blocks that share both ends of their depth, and supports that reach as far, got ends that differ by "
        f"{spread:.3g} along {_name(way)}; this is no plane model")


def _directions(body: _Body) -> Iterator[np.ndarray]:
    """Normals of the faces of a body, each once: level ones with the larger component positive."""
    known: list[np.ndarray] = []
    for face in body.faces:
        around = face - face[0]
        normal = np.cross(around[1:-1], around[2:]).sum(axis=0)
        length = float(np.linalg.norm(normal))
        if not length > 0.0:
            continue
        normal /= length
        normal *= math.copysign(1.0, normal[int(np.argmax(abs(normal)))])
        if all(abs(normal @ other) < 1.0 - 1e-9 for other in known):
            known.append(normal)
            yield normal
        if len(known) == _MOST_DIRECTIONS:
            return


def _spread(bodies: list[_Body], way: np.ndarray) -> float:
    """How much the ends of bodies along a direction differ, or how far a corner is from both ends.

    Supports may extend beyond the ends of the others.
    """
    ends: dict[bool, list[tuple[float, float]]] = {False: [], True: []}
    between = 0.0
    for body in bodies:
        heights = body.points @ way
        low, high = float(heights.min()), float(heights.max())
        ends[body.is_support].append((low, high))
        between = max(between, float(np.minimum(heights - low, high - heights).max()))
    low, high = np.array(ends[False] or ends[True]).T
    short = [max(one - low.max(), high.min() - two) for one, two in ends[True]] if ends[False] else []
    return float(max(float(np.ptp(low)), float(np.ptp(high)), between, *short))


def _upright_axes(way: np.ndarray) -> np.ndarray:
    """Directions to the right, up and along a level view: z is up."""
    right = np.array([way[1], -way[0], 0.0])
    right = np.round(right / np.linalg.norm(right), 15)
    right *= math.copysign(1.0, right[int(np.argmax(abs(right)))])
    return np.array([right, [0.0, 0.0, 1.0], way])


def _name(way: np.ndarray) -> str:
    """A direction in words."""
    for axis, letter in enumerate("xyz"):
        if abs(way[axis]) > 1.0 - 1e-9:
            return letter
    return "(" + ", ".join(f"{part:.3g}" for part in way) + ")"


def _outline(body: _Body, axes: np.ndarray, tolerance: float, words: str) -> Any:
    """The outline at the ends of a body; ValueError if it is not the same at both."""
    shape, join = load("shapely.geometry", _PURPOSE), load("shapely.ops", _PURPOSE)
    along = body.points @ axes[2]
    outlines = []
    for end in dict.fromkeys((float(along.min()), float(along.max()))):
        faces = [face @ axes[:2].T for face in body.faces if np.all(abs(face @ axes[2] - end) <= tolerance)]
        polygons = [shape.Polygon(face) for face in faces]
        if not faces or not all(polygon.is_valid for polygon in polygons):
            raise ValueError(f"{words}: expected plane faces at both ends of its depth, got others")
        outlines.append(join.unary_union(polygons))
    spread = outlines[0].hausdorff_distance(outlines[-1])
    if spread > tolerance:
        raise ValueError(f"{words}: expected the same outline at both ends of its depth, got outlines that differ by "
                         f"{spread:.3g}; this is no plane model")
    return outlines[0]
