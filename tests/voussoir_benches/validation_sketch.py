"""Sketches of the problems of the verification manual: blocks as drawn, and their scaled displacements."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from voussoir_benches.deck_runs import read_rows

#: Width and largest height of a sketch [px]
_WIDTH, _HEIGHT = 260.0, 200.0
_MARGIN = 0.2  #: Margin around the movable blocks over their extent; fixed blocks beyond it are cut off
#: Drawn displacement over the extent of the movable blocks, and the true one up to which it is drawn
_DRAWN, _SMALL = 0.12, 0.1
_ROUND_OFF = 1e-11  #: Displacement below which it is round-off, over the extent
_FIXED = 'fill="#b8b0a0" stroke="#444" stroke-width="0.8"'
_FREE = 'fill="#efe8d8" stroke="#444" stroke-width="0.8"'
_MOVED = 'fill="none" stroke="#c4502a" stroke-width="0.9" stroke-dasharray="3 2"'


@dataclass(frozen=True)
class Shape:
    """A block: its corners and their displacements, and if it is fixed."""

    corners: np.ndarray  #: (corners, 2) [m]
    displacements: np.ndarray  #: (corners, 2) [m]
    is_fixed: bool


def shapes_of(file: Path, case: int) -> tuple[Shape, ...]:
    """Return the blocks of a case in `blocks.csv`; none if there is no such file."""
    blocks: dict[str, list[dict[str, str]]] = {}
    for row in read_rows(file, case):
        blocks.setdefault(row["block"], []).append(row)
    return tuple(
        Shape(_columns(rows, "x", "y"), _columns(rows, "u", "v"), rows[0]["state"] == "fixed")
        for rows in blocks.values())


def _columns(rows: list[dict[str, str]], *names: str) -> np.ndarray:
    """Columns of numbers: (rows, names)."""
    return np.array([[float(row[name]) for name in names] for row in rows])


def sketch(shapes: Sequence[Shape]) -> str:
    """Return the sketch as SVG.

    Displacements below a tenth of the extent of the movable blocks, and mechanisms, are drawn dashed in one size.
    Larger displacements are not drawn.
    """
    free = [shape for shape in shapes if not shape.is_fixed] or list(shapes)
    low, high = (edge([edge(shape.corners, axis=0) for shape in free], axis=0) for edge in (np.min, np.max))
    extent = float(np.max(high - low))
    moved = max(float(np.hypot(*shape.displacements.T).max()) for shape in free)
    low, high = _with_supports(low - _MARGIN * extent, high + _MARGIN * extent, shapes)
    scale = float(min(_WIDTH / (high - low)[0], _HEIGHT / (high - low)[1]))
    size = (high - low) * scale
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]:.0f}" height="{size[1]:.0f}" '
        f'viewBox="0 0 {size[0]:.0f} {size[1]:.0f}">',
        '<rect width="100%" height="100%" fill="#fff"/>']
    flip = np.array([1.0, -1.0])
    for shape in sorted(shapes, key=lambda shape: not shape.is_fixed):
        corners = (shape.corners - (low[0], high[1])) * flip * scale
        parts.append(_polygon(corners, _FIXED if shape.is_fixed else _FREE))
    is_mechanism = abs(moved - 1.0) < _ROUND_OFF  # blocks.csv scales them to a largest value of 1
    if is_mechanism or _ROUND_OFF * extent < moved < _SMALL * extent:
        for shape in free:
            drawn = shape.corners + shape.displacements * (_DRAWN * extent / moved)
            parts.append(_polygon((drawn - (low[0], high[1])) * flip * scale, _MOVED))
    return "\n".join([*parts, "</svg>", ""])


def _with_supports(
    low: np.ndarray, high: np.ndarray, shapes: Sequence[Shape]
) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a view, moved to the nearest fixed block if none is in it."""
    margin = _MARGIN / (1.0 + 2.0 * _MARGIN) * float(np.max(high - low))
    boxes = [(shape.corners.min(axis=0), shape.corners.max(axis=0)) for shape in shapes if shape.is_fixed]
    gaps = [np.maximum(0.0, np.maximum(low - box[1], box[0] - high)) for box in boxes]
    if not boxes or min(gap.max() for gap in gaps) == 0.0:
        return low, high
    nearest = boxes[int(np.argmin([gap.max() for gap in gaps]))]
    return np.minimum(low, nearest[1] - margin), np.maximum(high, nearest[0] + margin)


def _polygon(corners: Iterable[Sequence[float]], style: str) -> str:
    """A polygon in SVG."""
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return f'<polygon points="{points}" {style}/>'
