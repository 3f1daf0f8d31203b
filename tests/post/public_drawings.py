"""Forty drawings as people publish them, with the areas of their blocks by formulas: ten forms, in metres and in
millimetres, at the origin and far from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from drawn_files import Point, groups

UNITS = {"m": (1.0, 6), "mm": (1e-3, 4)}  #: Metres of a unit by its name, and its number as $INSUNITS
#: Where drawings begin [m]: at the origin, and in a national grid
PLACES = {"near": (0.0, 0.0), "far": (512340.25, 5412345.5)}
STONES = 7  #: Voussoirs of a ring
Lines = list[str]


@dataclass
class Drawn:
    """Entities of a form, and the exact values of its blocks."""

    entities: list[Lines]
    blocks: Lines = field(default_factory=list)
    tables: Lines = field(default_factory=list)
    areas: list[tuple[float, float]] = field(default_factory=list)  #: Exact area, length of its curves [m2, m]
    box: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)  #: Around all blocks, from the beginning [m]
    refused: str = ""  #: Instead: words of the refusal, a regular expression
    place: Point = ()  #: Place that the refusal names in units of the file, from the beginning [m]


@dataclass(frozen=True)
class Pen:
    """Entities of a drawing in its own unit and place."""

    metre: float  #: Units per metre
    at: Point  #: Beginning [m]

    def xy(self, point: Point, first: int = 10) -> Lines:
        """A point of the model space."""
        return groups(*(part for code, value, low in zip((first, first + 10), point, self.at)
                        for part in (code, repr((value + low) * self.metre))))

    def size(self, value: float) -> str:
        """A length."""
        return repr(value * self.metre)

    def line(self, layer: str, start: Point, end: Point) -> Lines:
        """A LINE."""
        rows = groups(0, "LINE", 5, "A1", 100, "AcDbEntity", 8, layer, 100, "AcDbLine")
        return rows + self.xy(start) + self.xy(end, 11)

    def arc(self, layer: str, radius: float, low: float, high: float) -> Lines:
        """An ARC about the beginning, between two angles [deg]."""
        return groups(0, "ARC", 8, layer) + self.xy((0.0, 0.0)) + groups(40, self.size(radius), 50, low, 51, high)

    def poly(self, layer: str, points: list[Point], closed: int = 1, bulges: tuple[float, ...] = ()) -> Lines:
        """A LWPOLYLINE."""
        rows = groups(0, "LWPOLYLINE", 100, "AcDbEntity", 8, layer, 100, "AcDbPolyline", 90, len(points))
        rows += groups(70, closed, 43, 0)
        for number, point in enumerate(points):
            rows += self.xy(point) + (groups(42, repr(bulges[number])) if bulges else [])
        return rows

    def ellipse(self, layer: str, half: float, ratio: float, low: float, high: float) -> Lines:
        """An ELLIPSE about the beginning, its major axis level, between two parameters."""
        return groups(0, "ELLIPSE", 8, layer) + self.xy((0.0, 0.0)) + groups(
            11, self.size(half), 21, 0, 31, 0, 40, ratio, 41, repr(low), 42, repr(high))

    def bezier(self, layer: str, points: list[Point]) -> Lines:
        """A SPLINE of degree 3 with four control points."""
        rows = groups(0, "SPLINE", 8, layer, 70, 8, 71, 3, 72, 8, 73, 4, 74, 0)
        for knot in (0, 0, 0, 0, 1, 1, 1, 1):
            rows += groups(40, knot)
        for point in points:
            rows += self.xy(point) + groups(30, 0)
        return rows


def on_circle(radius: float, angle: float, ratio: float = 1.0) -> Point:
    """A point at an angle from the x axis [rad], of an ellipse at a parameter."""
    return radius * math.cos(angle), ratio * radius * math.sin(angle)


def base(pen: Pen, low: float, width: float) -> list[Lines]:
    """A support below y = 0, 0.5 m deep."""
    return [pen.poly("Fixed", [(low, -0.5), (low + width, -0.5), (low + width, 0.0), (low, 0.0)])]


def arcs(pen: Pen) -> Drawn:
    """Two arcs and the joints between them, on one layer."""
    turns = [math.pi * k / STONES for k in range(STONES + 1)]
    joints = [pen.line("arch", on_circle(3.0, turn), on_circle(3.6, turn)) for turn in turns]
    step = math.pi / STONES
    return Drawn(
        [*base(pen, -4.0, 8.0), pen.arc("arch", 3.0, 0, 180), pen.arc("arch", 3.6, 0, 180), *joints],
        areas=[(4.0, 0.0)] + [(step * (3.6**2 - 3.0**2) / 2.0, 6.6 * step)] * STONES, box=(-4.0, -0.5, 4.0, 3.6))


def bulges(pen: Pen) -> Drawn:
    """Voussoirs as polylines whose curved sides are bulges; one is an old POLYLINE."""
    stones, step = [], math.pi / STONES
    bulge = math.tan(step / 4.0)
    for k in range(STONES):
        low, high = k * step, (k + 1) * step
        corners = [on_circle(3.6, low), on_circle(3.6, high), on_circle(3.0, high), on_circle(3.0, low)]
        turns = (bulge, 0.0, -bulge, 0.0)
        if k:
            stones.append(pen.poly("arch", corners, 1, turns))
            continue
        rows = groups(0, "POLYLINE", 8, "arch", 66, 1, 10, 0, 20, 0, 30, 0, 70, 1)
        for corner, turn in zip(corners, turns):
            rows += groups(0, "VERTEX", 8, "arch") + pen.xy(corner) + groups(42, repr(turn))
        stones.append(rows + groups(0, "SEQEND", 8, "arch"))
    return Drawn(
        [*base(pen, -4.0, 8.0), *stones],
        areas=[(4.0, 0.0)] + [(step * (3.6**2 - 3.0**2) / 2.0, 6.6 * step)] * STONES, box=(-4.0, -0.5, 4.0, 3.6))


def ellipses(pen: Pen) -> Drawn:
    """Two halves of ellipses, half as high as wide, and the joints between them."""
    turns = [math.pi * k / STONES for k in range(STONES + 1)]
    joints = [pen.line("rib", on_circle(4.0, turn, 0.5), on_circle(5.0, turn, 0.5)) for turn in turns]
    step = math.pi / STONES
    return Drawn(
        [*base(pen, -5.5, 11.0), *(pen.ellipse("rib", half, 0.5, 0.0, math.pi) for half in (4.0, 5.0)), *joints],
        areas=[(5.5, 0.0)] + [(step * 0.5 * (5.0**2 - 4.0**2) / 2.0, 9.0 * step)] * STONES, box=(-5.5, -0.5, 5.5, 2.5))


def splines(pen: Pen) -> Drawn:
    """Shells between two splines, cut by upright joints at known parameters."""
    frames = [[(-x, 0.0), (-x, h), (x, h), (x, 0.0)] for x, h in ((2.0, 2.0), (3.0, 3.0))]

    def coefficients(points: list[Point]) -> list[np.ndarray]:
        matrix = np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]], float)
        return [matrix @ np.array([point[axis] for point in points]) for axis in (0, 1)]

    def below(points: list[Point], low: float, high: float) -> float:
        """Integral of (x dy - y dx)/2 along the spline, of a polynomial exactly."""
        x, y = (np.polynomial.Polynomial(row) for row in coefficients(points))
        sums = (x * y.deriv() - y * x.deriv()).integ() / 2.0
        return float(sums(high) - sums(low))

    shares = [0.0, 0.3, 0.7, 1.0]
    areas, joints = [], []
    ends = [[tuple(float(np.polynomial.Polynomial(row)(t)) for row in coefficients(frame)) for t in shares]
            for frame in frames]
    for inner, outer in zip(*ends):
        joints.append(pen.line("shell", inner, outer))
    for k in range(3):
        low, high = shares[k], shares[k + 1]
        corners = [ends[0][k + 1], ends[1][k + 1], ends[1][k], ends[0][k]]
        straight = sum((a[0] * b[1] - a[1] * b[0]) / 2.0 for a, b in (corners[:2], corners[2:]))
        areas.append((abs(straight + below(frames[0], low, high) - below(frames[1], low, high)), 12.0))
    return Drawn(
        [*base(pen, -3.5, 7.0), *(pen.bezier("shell", frame) for frame in frames), *joints],
        areas=[(3.5, 0.0), *areas], box=(-3.5, -0.5, 3.5, 2.25))


def inserts(pen: Pen) -> Drawn:
    """A stone as a block: mirrored, turned, in an array and within another block."""
    unit = Pen(pen.metre, (0.0, 0.0))
    stone = unit.poly("0", [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.25, 0.5)])
    blocks = groups(0, "BLOCK", 2, "STONE", 10, 0, 20, 0) + stone + groups(0, "ENDBLK")
    blocks += groups(0, "BLOCK", 2, "PAIR") + unit.xy((0.0, 0.0)) + groups(0, "INSERT", 2, "stone", 8, "0") + unit.xy(
        (0.0, 0.0)) + groups(0, "INSERT", 2, "STONE", 8, "0", 41, -1) + unit.xy((3.0, 0.0)) + groups(0, "ENDBLK")
    placed = [
        groups(0, "INSERT", 2, "Stone", 8, "wall", 41, 2, 42, -1) + pen.xy((0.0, 1.0)),
        groups(0, "INSERT", 2, "STONE", 8, "wall", 50, 90) + pen.xy((4.0, 0.0)),
        groups(0, "INSERT", 2, "STONE", 8, "wall", 70, 2, 71, 2, 44, unit.size(1.5), 45, unit.size(1.0)) + pen.xy(
            (5.0, 0.0)),
        groups(0, "INSERT", 2, "PAIR", 8, "wall") + pen.xy((9.0, 0.0))]
    one = 0.4375
    return Drawn([*base(pen, -1.0, 14.0), *placed], blocks,
                 areas=[(7.0, 0.0), (2.0 * one, 0.0)] + [(one, 0.0)] * 7, box=(-1.0, -0.5, 13.0, 1.5))


def layers(pen: Pen) -> Drawn:
    """Stones, one closed by its last point, and a filled brick; remarks, a hidden layer and a sheet are none of it."""
    remarks = [
        groups(0, "TEXT", 8, "notes") + pen.xy((0.0, 5.0)) + groups(40, 0.2, 1, "elevation"),
        groups(0, "DIMENSION", 8, "dims", 2, "*D1") + pen.xy((0.0, 6.0)),
        groups(0, "HATCH", 8, "stone", 2, "ANSI31", 70, 0) + pen.xy((0.0, 0.0)),
        groups(0, "POINT", 8, "notes") + pen.xy((1.0, 1.0)),
        pen.line("axes", (-2.0, -2.0), (9.0, 9.0)),
        [*pen.line("stone", (0.0, 0.1), (50.0, 0.1)), *groups(67, 1)]]
    solid = groups(0, "SOLID", 8, "brick")
    for number, corner in enumerate([(2.0, 0.0), (3.0, 0.0), (2.0, 1.0), (3.0, 1.0)]):
        solid += pen.xy(corner, 10 + number)
    outline = pen.poly("stone", [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])
    chimney = pen.poly("stone", [(0.5, 2.0), (1.5, 2.0), (1.5, 3.0), (0.5, 3.0), (0.5, 2.0)], 0)
    tables = groups(0, "SECTION", 2, "TABLES", 0, "TABLE", 2, "LAYER", 0, "LAYER", 2, "axes", 70, 0, 62, -7,
                    0, "LAYER", 2, "stone", 70, 0, 62, 3, 0, "ENDTAB", 0, "ENDSEC")
    return Drawn([*base(pen, -1.0, 5.0), outline, chimney, solid, *remarks], tables=tables,
                 areas=[(2.5, 0.0), (4.0, 0.0), (1.0, 0.0), (1.0, 0.0)], box=(-1.0, -0.5, 4.0, 3.0))


def discs(pen: Pen) -> Drawn:
    """Whole curves: a circle, one drawn from behind, an ellipse, a polyline of two bulges."""
    behind = Pen(pen.metre, (-pen.at[0], pen.at[1]))
    whole = [
        groups(0, "CIRCLE", 8, "disc") + pen.xy((1.0, 1.0)) + groups(40, pen.size(1.0)),
        groups(0, "CIRCLE", 8, "disc") + behind.xy((-4.0, 1.0)) + groups(40, pen.size(1.0), 210, 0, 220, 0, 230, -1),
        groups(0, "ELLIPSE", 8, "disc") + pen.xy((8.0, 1.0)) + groups(11, pen.size(2.0), 21, 0, 31, 0, 40, 0.5),
        pen.poly("disc", [(11.0, 1.0), (13.0, 1.0)], 1, (1.0, 1.0))]
    return Drawn([*base(pen, -1.0, 15.0), *whole],
                 areas=[(7.5, 0.0), *[(math.pi, 2.0 * math.pi)] * 2, (2.0 * math.pi, 10.0), (math.pi, 2.0 * math.pi)],
                 box=(-1.0, -0.5, 14.0, 2.0))


def open_ends(pen: Pen) -> Drawn:
    """The ring of arcs with a joint that stops 8 mm short of the outer arc."""
    ring = arcs(pen)
    turn = 3.0 * math.pi / STONES
    end = on_circle(3.592, turn)
    ring.entities[6] = pen.line("arch", on_circle(3.0, turn), end)
    return Drawn(ring.entities, refused=r"an end that stops at most 0\.008 m short of another line, on layer arch",
                 place=end)


def crossing(pen: Pen) -> Drawn:
    """An outline that crosses itself among sound ones."""
    bow = pen.poly("stone", [(0.0, 0.0), (2.0, 1.0), (2.0, 0.0), (0.0, 2.0)])
    return Drawn([*base(pen, -1.0, 5.0), bow, pen.poly("stone", [(3.0, 0.0), (4.0, 0.0), (4.0, 1.0)])],
                 refused="LWPOLYLINE on layer stone: an outline that crosses itself", place=(4.0 / 3.0, 2.0 / 3.0))


def stray(pen: Pen) -> Drawn:
    """A line that bounds nothing, far from all others of its layer."""
    box = [pen.line("stone", a, b) for a, b in zip([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)],
                                                   [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)])]
    return Drawn([*base(pen, -1.0, 5.0), *box, pen.line("stone", (3.0, 2.0), (3.0, 4.0))],
                 refused="LINE on layer stone: 1 piece encloses nothing", place=(3.0, 2.0))


#: Forms by their names
FORMS: tuple[Callable[[Pen], Drawn], ...] = (
    arcs, bulges, ellipses, splines, inserts, layers, discs, open_ends, crossing, stray)


def drawings() -> Iterator[tuple[str, str, Drawn, Pen]]:
    """Names, texts of DXF files, what is known of them, and their pens."""
    for form in FORMS:
        for unit, (metres, number) in UNITS.items():
            for place, at in PLACES.items():
                pen = Pen(1.0 / metres, at)
                drawn = form(pen)
                lines = groups(0, "SECTION", 2, "HEADER", 9, "$ACADVER", 1, "AC1015", 9, "$INSUNITS", 70, number)
                lines += groups(0, "ENDSEC") + drawn.tables
                lines += groups(0, "SECTION", 2, "BLOCKS") + drawn.blocks + groups(0, "ENDSEC")
                lines += groups(0, "SECTION", 2, "ENTITIES") + [row for entity in drawn.entities for row in entity]
                text = "\n".join([*lines, *groups(0, "ENDSEC", 0, "EOF")]) + "\n"
                yield f"{form.__name__}-{unit}-{place}", text, drawn, pen
