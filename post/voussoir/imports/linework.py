"""Outlines of line work: closed curves, and what open ones of a layer enclose; ends that stop short are found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Optional

import numpy as np

from voussoir.extras import load
from voussoir.imports.curves import MOST_CHORDS, Curve, Line, Points, nearest, polyline
from voussoir.imports.notes import Notes
from voussoir.imports.snapping import Cells, Ends

#: Ends and corners as near as this share of the tolerance are one
SAME = 0.1
_PURPOSE = "a DXF drawing"
#: What a reader gives: words for messages, a geometry and its layer, or None and the place of what is none
Found = Iterator[tuple[str, Any, str]]


@dataclass(frozen=True)
class Drawn:
    """An entity as curves in a row."""

    words: str  #: For messages
    layer: str
    curves: tuple[Curve, ...]
    is_closed: bool
    may_close: bool = False  #: The file does not say whether it is closed


def outlines(drawn: list[Drawn], tolerance: float, snap: float, notes: Notes) -> Found:
    """Outlines of all entities; curves are cut where others end on them, so that both sides of a joint have one shape.

    Open ends within the distance `snap` of another line of their layer are moved there. Those that stop short of one
    are added to `notes.short`.
    """
    shape = load("shapely.geometry", _PURPOSE)
    reach = SAME * tolerance
    drawn = [replace(one, is_closed=one.is_closed or _gap(one) <= reach) for one in drawn]
    layers: dict[str, list[Drawn]] = {}
    for one in drawn:
        if not one.is_closed:
            layers.setdefault(one.layer, []).append(one)
    for name, lines in layers.items():
        lines = _closed_alone(lines, reach, notes)
        layers[name] = _snapped(lines, snap, tolerance, notes) if snap > 0.0 else lines
    all_open = [one for lines in layers.values() for one in lines]
    rings = [one for one in [*drawn, *all_open] if one.is_closed]
    rows = _cut_rows(rings + [one for one in all_open if not one.is_closed], tolerance)
    for one in rings:
        points = [point for row in rows[id(one)] for point in row[:-1]]
        if len(points) > 2:
            yield one.words, shape.Polygon([(point.real, point.imag) for point in points]), one.layer
        else:
            yield f"{one.words}: no area", None, _at(points[0] if points else one.curves[0].start)
    for name, lines in layers.items():
        yield from _enclosed(name, [one for one in lines if not one.is_closed], rows, reach, notes)


def _at(point: complex) -> str:
    """A place in words, in the file's own unit."""
    return f"at ({point.real:.10g}, {point.imag:.10g})"


def _gap(one: Drawn) -> float:
    """Distance between the ends of an entity."""
    return abs(one.curves[0].start - one.curves[-1].end)


def _closed_alone(drawn: list[Drawn], reach: float, notes: Notes) -> list[Drawn]:
    """Entities, those that may be closed and meet no other entity closed."""
    if not any(one.may_close for one in drawn):
        return drawn
    row = []
    owned = [(one, curve) for one in drawn for curve in one.curves]
    cells = Cells([curve for _, curve in owned], reach, reach)
    for one in drawn:
        ends = np.array([one.curves[0].start, one.curves[-1].end])
        around = {number for end in ends.tolist() for number in cells.near(end)} if one.may_close else set()
        others = (owned[number][1] for number in around if owned[number][0] is not one)
        if not one.may_close or len(one.curves) < 2 or any(
                nearest(curve, ends, reach)[1].min() <= reach for curve in others):
            row.append(one)
            continue
        notes.repaired.append(f"{one.words}: closed by a line from its last point to its first")
        row.append(replace(one, curves=(*one.curves, Line(ends[1], ends[0])), is_closed=True))
    return row


def _snapped(drawn: list[Drawn], snap: float, tolerance: float, notes: Notes) -> list[Drawn]:
    """Entities whose open ends are moved to the nearest other line within a distance."""
    snap *= 1.0 + 1e-6  # a gap as wide as asked may be read wider
    curves = [curve for one in drawn for curve in one.curves]
    cells = Cells(curves, snap, tolerance)
    targets: dict[complex, complex] = {}
    for one in drawn:
        for curve, end in ((one.curves[0], one.curves[0].start), (one.curves[-1], one.curves[-1].end)):
            others = [curves[place] for place in cells.near(end) if curves[place] is not curve]
            corners = [point for other in others for point in (other.start, other.end)]
            corners += [curve.start if end == curve.end else curve.end]
            near = [point for point in corners if abs(point - end) <= snap]
            target = min(near, key=lambda point: abs(point - end), default=None)
            if target is None:
                target = _on_others(end, others, snap, tolerance)
            if target is not None and abs(target - end) > 0.0:
                targets[end] = complex(target)
    places = _places(targets, snap)
    row = list(drawn)
    for number, one in enumerate(drawn):
        old = (one.curves[0].start, one.curves[-1].end)
        ends = [places.get(end, end) for end in old]
        moved = [abs(new - end) for new, end in zip(ends, old)]
        notes.snapped += [distance for distance in moved if distance > SAME * tolerance]
        row[number] = replace(one, curves=_with_ends(one.curves, ends[0], ends[1]))
    return [replace(one, is_closed=len(one.curves) > 1 and _gap(one) <= SAME * tolerance) for one in row]


def _places(targets: dict[complex, complex], snap: float) -> dict[complex, complex]:
    """Where ends are moved: of two that would swap places, that stays to which more others move, else the first."""
    asked = Counter(targets.values())
    order = {end: number for number, end in enumerate(targets)}
    stays = {
        end for end, target in targets.items()
        if targets.get(target) == end and (-asked[end], order[end]) < (-asked[target], order[target])}
    places = {}
    for end, target in targets.items():
        if end in stays:
            continue
        last, steps = target, 0
        while last in targets and last not in stays and steps < len(targets):  # the target moves itself
            last, steps = targets[last], steps + 1
        places[end] = last if abs(last - end) <= snap else target
    return places


def _on_others(end: complex, others: list[Curve], snap: float, tolerance: float) -> Optional[complex]:
    """The nearest point on other curves within a distance."""
    best, found = snap, None
    for curve in others:
        share, off = nearest(curve, np.array([end]), tolerance)
        if off[0] <= best:
            best, found = off[0], complex(curve.at(share)[0])
    return found


def _with_ends(curves: tuple[Curve, ...], start: complex, end: complex) -> tuple[Curve, ...]:
    """Curves in a row with other ends: lines are moved, other curves get a line to the new end."""
    row = list(curves)
    if start != row[0].start:
        if isinstance(row[0], Line):
            row[0] = Line(start, row[0].end)
        else:
            row.insert(0, Line(start, row[0].start))
    if end != row[-1].end:
        if isinstance(row[-1], Line):
            row[-1] = Line(row[-1].start, end)
        else:
            row.append(Line(row[-1].end, end))
    return tuple(curve for curve in row if curve.start != curve.end or not isinstance(curve, Line))


def _cut_rows(drawn: list[Drawn], tolerance: float) -> dict[int, list[list[complex]]]:
    """Points of the curves of each entity, by its identity.

    Curves are cut at corners first, then at the ends of each other's chords too, where they lie together.
    """
    reach = SAME * tolerance
    corners = [point for one in drawn for curve in one.curves for point in (curve.start, curve.end)]
    bent = [curve for one in drawn for curve in one.curves if not isinstance(curve, Line)]
    if (count := sum(curve.chords(0.0, 1.0, tolerance) for curve in bent)) > MOST_CHORDS:
        raise ValueError(f"expected curves of at most {MOST_CHORDS} chords, got {count:.3g}; use a larger --tolerance")
    for _ in range(2):
        known = Points(corners)
        corners = corners + [point for curve in bent for point in polyline(curve, known, reach, tolerance)]
    ends = Ends(reach)
    rows: dict[int, list[list[complex]]] = {}
    for one in drawn:
        for curve in one.curves:
            is_side = one.is_closed and isinstance(curve, Line)
            points = [curve.start, curve.end] if is_side else polyline(curve, known, reach, tolerance)
            rows.setdefault(id(one), []).append([ends.of(point) for point in points])
    return rows


def _enclosed(
    layer: str, lines: list[Drawn], rows: dict[int, list[list[complex]]], reach: float, notes: Notes
) -> Found:
    """What the open lines of a layer enclose, and how many of their pieces enclose nothing."""
    if not lines:
        return
    shape, join = load("shapely.geometry", _PURPOSE), load("shapely.ops", _PURPOSE)
    pieces = [
        shape.LineString([(one.real, one.imag), (two.real, two.imag)])
        for line in lines for points in rows[id(line)] for one, two in zip(points, points[1:]) if one != two]
    network = join.unary_union(pieces)
    faces, cuts, dangles, rings = join.polygonize_full(network)
    for number, face in enumerate(faces.geoms, 1):  # without the corners of others on its straight edges
        yield f"outline {number} of lines on layer {layer}", face.simplify(SAME * reach), layer
    left = len(cuts.geoms) + len(dangles.geoms) + len(rings.geoms)
    if left:
        kinds = sorted({line.words.split()[0] for line in lines})
        words = " encloses" if left == 1 else "s enclose"
        notes.short += [
            (f"layer {layer}", end, gap) for end, gap in _short_ends(network, dangles, reach)]
        lost = next(piece for pieces in (dangles, cuts, rings) for piece in pieces.geoms)
        yield (f"{' and '.join(kinds)} on layer {layer}: {left} piece{words} nothing", None,
               _at(complex(*lost.coords[0])))


def _short_ends(network: Any, dangles: Any, reach: float) -> Iterator[tuple[complex, float]]:
    """Free ends of lines that are nearer to another line than their own free part is long, and how near."""
    join, base = load("shapely.ops", _PURPOSE), load("shapely.geometry", _PURPOSE)
    parts = list(getattr(network, "geoms", [network]))
    merged = join.linemerge([line for line in dangles.geoms]) if len(dangles.geoms) else base.MultiLineString()
    count: dict[tuple[float, float], int] = {}
    for part in parts:
        for end in (part.coords[0], part.coords[-1]):
            count[end] = count.get(end, 0) + 1
    for line in getattr(merged, "geoms", [merged]):
        tips = [line.coords[0], line.coords[-1]]
        free = [tip for tip in tips if count.get(tip) == 1]
        roots = {tip for tip in tips if tip not in free}
        own = line.buffer(reach)
        others = [part for part in parts if not roots & {part.coords[0], part.coords[-1]} and not own.contains(part)]
        for tip in free:
            gaps = [base.Point(other).distance(base.Point(tip)) for other in free if other != tip]
            gaps += [part.distance(base.Point(tip)) for part in others]
            if min(gaps, default=line.length) < 0.999 * line.length:
                yield complex(*tip), min(gaps)
