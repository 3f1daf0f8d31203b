"""Entities of a DXF drawing as plane curves, those of inserted blocks in their places."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from voussoir.imports.curves import Curve, Line
from voussoir.imports.dxf_curves import curves_of
from voussoir.imports.dxf_groups import Entry, Placement, sections_of
from voussoir.imports.linework import Drawn, Found, outlines
from voussoir.imports.notes import Notes
from voussoir.imports.plane import Plane

#: Most entities of a drawing whose inserts are expanded
MOST_ENTITIES = 100_000
#: What a drawing says its unit is [m], by the number of $INSUNITS
_METRES = {
    1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 1e-3, 5: 1e-2, 6: 1.0, 7: 1e3, 8: 2.54e-8, 9: 2.54e-5, 10: 0.9144,
    11: 1e-10, 12: 1e-9, 13: 1e-6, 14: 0.1, 15: 10.0, 16: 100.0, 17: 1e9, 18: 149597870700.0, 19: 9460730472580800.0,
    20: 3.0856775814913673e16, 21: 1200.0 / 3937.0}
#: What bounds no block by its kind
_REMARKS = frozenset(
    "TEXT MTEXT DIMENSION ARC_DIMENSION LARGE_RADIAL_DIMENSION LEADER MULTILEADER MLEADER POINT HATCH ATTDEF ATTRIB "
    "TOLERANCE VIEWPORT IMAGE WIPEOUT XLINE RAY OLE2FRAME OLEFRAME ACAD_TABLE LIGHT SUN SECTIONOBJECT SEQEND "
    "ACAD_PROXY_ENTITY PDFUNDERLAY DWFUNDERLAY DGNUNDERLAY GEOPOSITIONMARKER RTEXT SHAPE".split())


class Drawing:
    """A DXF drawing."""

    def __init__(self, file: Path) -> None:
        self._sections = sections_of(file)
        self._blocks: dict[str, list[Entry]] = {}
        self._bases: dict[str, tuple[float, float, float]] = {}
        for entry in self._sections.get("BLOCKS", []):
            if entry.kind == "BLOCK":
                name = entry.text(2).lower()
                self._blocks[name] = []
                self._bases[name] = entry.point(10, (0.0, 0.0, 0.0))
            elif entry.kind not in ("SECTION", "ENDBLK") and self._blocks:
                self._blocks[next(reversed(self._blocks))].append(entry)
        layers = [entry for entry in self._sections.get("TABLES", []) if entry.kind == "LAYER"]
        nameless = next((entry for entry in layers if not entry.text(2)), None)
        if nameless:
            raise ValueError(f"{nameless.place}: expected a layer with a name in group 2, got none")
        #: Layers that are off (a colour below 0) or frozen, in small letters
        self.hidden = frozenset(
            entry.text(2).lower() for entry in layers if entry.whole(62, 7) < 0 or entry.whole(70) & 1)

    def metres(self) -> float | None:
        """The unit that the drawing names [m]; None if it names none."""
        header = next(iter(self._sections.get("HEADER", [])), None)
        groups = header.groups if header else []
        for number, (code, value) in enumerate(groups[:-1]):
            if (code, value.upper()) == (9, "$INSUNITS"):
                try:
                    return _METRES.get(int(groups[number + 1][1]))
                except ValueError:
                    raise ValueError(f"expected a number of $INSUNITS, got '{groups[number + 1][1][:40]}'") from None
        return None

    def entities(self) -> Iterator[tuple[Entry, list[Entry], Placement, str]]:
        """Entities of the model space with their vertices, their placements and layers; ValueError if too many."""
        model = [entry for entry in self._sections["ENTITIES"][1:] if entry.text(67, "0") != "1"]
        count = self._count(model, {}, ())
        if count > MOST_ENTITIES:
            raise ValueError(
                f"expected at most {MOST_ENTITIES} entities with those of inserted blocks, got {count:.3g}; "
                "import parts of the drawing")
        yield from self._placed(model, Placement(), "0")

    def _count(self, entries: list[Entry], known: dict[str, float], outer: tuple[str, ...]) -> float:
        """Number of entities once all inserts are expanded."""
        total = 0.0
        for entry in entries:
            if entry.kind != "INSERT":
                total += 1.0
                continue
            name = entry.text(2).lower()
            if name in outer:
                raise ValueError(f"{entry.place}: expected blocks without circles of inserts, got '{name}' in itself")
            if len(outer) > 50:
                raise ValueError(f"{entry.place}: expected inserts nested at most 50 deep, got more")
            if name not in known:
                known[name] = 1.0 + self._count(self._blocks.get(name, []), known, (*outer, name))
            total += known[name] * _repeats(entry, 70) * _repeats(entry, 71)
        return total

    def _placed(
        self, entries: list[Entry], placement: Placement, layer: str
    ) -> Iterator[tuple[Entry, list[Entry], Placement, str]]:
        """Entities in a placement; those on layer 0 are on the layer of the insert."""
        number = 0
        while number < len(entries):
            entry = entries[number]
            number += 1
            own = entry.text(8) or "0"
            own = layer if own == "0" else own
            name = entry.text(2).lower()
            if entry.kind == "INSERT" and name in self._blocks:
                for inner in placement.inserts(entry, self._bases[name],
                                               _repeats(entry, 70), _repeats(entry, 71)):
                    yield from self._placed(self._blocks[name], inner, own)
                continue
            vertices = []
            if entry.kind == "POLYLINE":
                while number < len(entries) and entries[number].kind == "VERTEX":
                    vertices.append(entries[number])
                    number += 1
            yield entry, vertices, placement, own


def _repeats(insert: Entry, code: int) -> int:
    """Number of columns or rows of an insert."""
    return max(1, insert.whole(code, 1))


def read_dxf(drawing: Drawing, tolerance: float, snap: float, plane: Plane, notes: Notes) -> Found:
    """Closed polylines, circles, ellipses, splines; what single lines and arcs of a layer enclose."""
    drawn: list[Drawn] = []
    for entry, vertices, placement, layer in drawing.entities():
        words = f"{entry.kind} on layer {layer}"
        if layer.lower() in drawing.hidden:
            notes.left_out.append(f"hidden layer {layer}")
            continue
        if entry.kind in _REMARKS:
            notes.left_out.append(words)
            continue
        shape = curves_of(entry, vertices)
        if shape is None:
            notes.drop(f"{words}: no outline", f"at {entry.place}")
            continue
        curves = tuple(curve for curve in shape.placed(placement, plane) if not _is_point(curve))
        if not curves:
            notes.drop(f"{words}: no length", f"at {entry.place}")
            continue
        drawn.append(Drawn(words, layer, curves, shape.is_closed, shape.may_close))
    yield from outlines(drawn, tolerance, snap, notes)


def _is_point(curve: Curve) -> bool:
    """Whether a curve has no length."""
    if isinstance(curve, Line):
        return curve.start == curve.end
    points = curve.at(np.linspace(0.0, 1.0, 5))
    return bool(np.all(points == points[0])) or not math.isfinite(abs(points).max())
