"""Lines without outlines as a file for `dda cut`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

#: Layer of lines that bound the model
BOUNDARY = "boundary"


@dataclass(frozen=True)
class Trace:
    """A line through points (n, 2) [m], and its layer."""

    points: np.ndarray
    layer: str

    @property
    def segments(self) -> np.ndarray:
        """Ends of its straight parts that have a length: (m, 4)."""
        ends = np.hstack((self.points[:-1], self.points[1:]))
        return ends[np.any(self.points[:-1] != self.points[1:], axis=1)]


def traces_of(geometry: Any, layer: str, scale: float) -> list[Trace]:
    """Traces of a line, of several, or of the outline of a polygon."""
    if geometry.geom_type == "Polygon":
        return [trace for ring in (geometry.exterior, *geometry.interiors) for trace in traces_of(ring, layer, scale)]
    if hasattr(geometry, "geoms"):
        return [trace for part in geometry.geoms for trace in traces_of(part, layer, scale)]
    return [Trace(scale * np.asarray(geometry.coords)[:, :2], layer)]


def line_file(traces: list[Trace], reach: float) -> tuple[str, dict[str, int], int, int]:
    """The file, joint materials by layer, numbers of all lines and of boundary lines; crossings within reach are one.

    Lines of the layer "boundary" come first; every layer is a joint material. The edge-node distance ratio gives the
    reach [m].
    """
    rows = sorted(traces, key=lambda trace: trace.layer.lower() != BOUNDARY)
    layers = {layer: number for number, layer in enumerate(dict.fromkeys(trace.layer for trace in rows), 1)}
    lines = [(*ends, layers[trace.layer]) for trace in rows for ends in trace.segments.tolist()]
    count = sum(len(trace.segments) for trace in rows if trace.layer.lower() == BOUNDARY)
    points = np.vstack([trace.points for trace in rows])
    width, height = np.ptp(points, axis=0)
    ratio = min(reach / (1.25 * 1.02 * max(height / 2.0, width / 2.6)), 0.5)
    head = [f"{ratio:.6g}", f"{len(lines)} {count}", "0", "0", "0 0 0 0"]
    text = "\n".join([*head, *(" ".join(map(repr, line)) for line in lines)]) + "\n"
    return text, layers, len(lines), count
