"""Write arch_shapes.csv: critical thicknesses of arches of any shape, by linear programmes of their polygons.

The polygons are made anew here: lines by their equations, lengths by quadrature, joints by root finding. The programme
looks for the largest normal force that every corner of every joint can have while the weight is carried; the critical
thickness is where that is nothing. Run it with a Python that has scipy: python3 make_arch_shapes.py > arch_shapes.csv
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq, linprog
from scipy.sparse import lil_matrix

Line = Callable[[float], np.ndarray]
GAUSS = np.polynomial.legendre.leggauss(40)
TIGHT = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}


def arc(centre: tuple[float, float], a: float, b: float, start: float, end: float) -> tuple[Line, float, float]:
    """An arc of an ellipse, by the angle from upright."""
    return lambda u: np.array([centre[0] + a * math.sin(u), centre[1] + b * math.cos(u)]), start, end


def circle_through(span: float, left: float, right: float) -> tuple[Line, float, float]:
    """The arc over a span with two rises, by its radius."""
    def gap(radius: float) -> float:
        return half(radius, left) + half(radius, right) - span

    def half(radius: float, rise: float) -> float:
        return math.sqrt(2.0 * radius * rise - rise * rise)

    radius = brentq(gap, 0.5 * max(left, right) * (1 + 1e-15), 1e4 * span, xtol=1e-15, rtol=1e-15)
    x = half(radius, left)
    return arc((x - span / 2, left - radius), radius, radius, -math.atan2(x, radius - left),
               math.atan2(span - x, radius - right))


def lines_of(shape: str, span: float, rise: float, right: float) -> list[tuple[Line, float, float]]:
    """The line of the intrados in pieces, each with the ends of its parameter."""
    s = span / 2
    if shape in ("segmental", "circular"):
        return [circle_through(span, rise, right)]
    if shape == "pointed":
        pieces = []
        for h, sign, level in ((rise, 1.0, 0.0), (right, -1.0, rise - right)):
            radius = (s * s + h * h) / (2 * s)
            top = math.atan2(radius - s, h)
            ends = (-math.pi / 2, -top) if sign > 0 else (top, math.pi / 2)
            pieces.append(arc((sign * (radius - s), level), radius, radius, *ends))
        return pieces
    if shape == "elliptic":
        high = max(rise, right)
        a = span / (1 + math.sqrt(1 - (1 - min(rise, right) / high) ** 2))
        angles = [math.acos(1 - h / high) for h in (rise, right)]
        return [arc((a * math.sin(angles[0]) - s, rise - high), a, high, -angles[0], angles[1])]
    if shape == "parabolic":
        x = span / (1 + math.sqrt(right / rise))
        return [(lambda u: np.array([u + x - s, rise - rise * (u / x) ** 2]), -x, span - x)]
    if shape == "catenary":
        def reach(a: float, h: float) -> float:
            return a * math.acosh(1 + h / a)

        a = brentq(lambda a: reach(a, rise) + reach(a, right) - span, 1e-3 * span, 1e3 * span, xtol=1e-15, rtol=1e-15)
        x = reach(a, rise)
        return [(lambda u: np.array([u + x - s, rise + a - a * math.cosh(u / a)]), -x, reach(a, right))]
    if shape == "basket":
        chord = math.hypot(s, rise)
        small, large = chord * (chord - s + rise) / (2 * s), chord * (chord + s - rise) / (2 * rise)
        turn = math.atan2(s - small, large - rise)
        return [arc((small - s, 0), small, small, -math.pi / 2, -turn),
                arc((0, rise - large), large, large, -turn, turn),
                arc((s - small, 0), small, small, turn, math.pi / 2)]
    return [(lambda u: np.array([u, 0.0]), -s, s)]


def rate(line: Line, u: float) -> np.ndarray:
    """Derivative of a line, by extrapolated central differences."""
    h = 1e-3
    d = [(line(u + k) - line(u - k)) / (2 * k) for k in (h, h / 2, h / 4)]
    first = [(4 * d[1] - d[0]) / 3, (4 * d[2] - d[1]) / 3]
    return (16 * first[1] - first[0]) / 15


def length(line: Line, start: float, end: float) -> float:
    """Length of a line between two parameters, by Gauss quadrature."""
    return sum(w * float(np.linalg.norm(rate(line, start + (end - start) * (x + 1) / 2)))
               for x, w in zip(*GAUSS)) * (end - start) / 2


def sections(row: dict[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Directions and feet of the joints: points of the intrados, and where the joint leads from there per thickness."""
    rise = float(row["rise"] or 0)
    pieces = lines_of(row["shape"], float(row["span"]), rise, float(row["right_rise"] or rise))
    n = int(row["voussoirs"])
    lengths = [length(*piece) for piece in pieces]
    whole, feet, ways = sum(lengths), [], []
    for k in range(n + 1):
        at, i = whole * k / n, 0
        while i < len(pieces) - 1 and at > lengths[i] + 1e-12 * whole:
            at -= lengths[i]
            i += 1
        line, a, b = pieces[i]
        u = a if k == 0 else b if k == n else brentq(
            lambda v: length(line, a, v) - at, a, b + 1e-9, xtol=1e-15, rtol=1e-14)
        along = rate(line, u) / np.linalg.norm(rate(line, u))
        way = np.array([-along[1], along[0]])
        if row["shape"] == "flat":
            lean = math.tan(math.radians(float(row["half_angle_deg"])))
            way = np.array([lean * line(u)[0] / (float(row["span"]) / 2), 1.0])
        feet.append(line(u))
        ways.append(way)
    return np.array(feet), np.array(ways)


def apex_of(row: dict[str, str], thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Where the two arcs of a pointed arch meet, at the intrados and at the extrados."""
    s, rises = float(row["span"]) / 2, (float(row["rise"]), float(row["right_rise"] or row["rise"]))
    radius = np.array([(s * s + h * h) / (2 * s) for h in rises])
    centre = np.array([[radius[0] - s, 0.0], [s - radius[1], rises[0] - rises[1]]])
    far = float(np.linalg.norm(centre[1] - centre[0]))
    outer = radius + thickness
    foot = (far * far + outer[0] ** 2 - outer[1] ** 2) / (2 * far)
    along = (centre[1] - centre[0]) / far
    up = np.array([along[1], -along[0]])
    return np.array([0.0, rises[0]]), centre[0] + foot * along + math.sqrt(outer[0] ** 2 - foot**2) * up


def polygons(row: dict[str, str], feet: np.ndarray, ways: np.ndarray, thickness: float) -> list[np.ndarray]:
    """The voussoirs, each from its left joint at the intrados around to the extrados of that joint."""
    outer = feet + thickness * ways
    blocks = []
    for k in range(len(feet) - 1):
        inner_line, outer_line = [feet[k], feet[k + 1]], [outer[k + 1], outer[k]]
        if row["shape"] == "pointed":
            inner, beyond = apex_of(row, thickness)
            ends = [np.linalg.norm(feet[k + i] - inner) < 1e-9 for i in (0, 1)]
            if ends[0]:
                outer_line[1] = beyond
            elif ends[1]:
                outer_line[0] = beyond
            elif feet[k][0] < inner[0] < feet[k + 1][0]:
                inner_line.insert(1, inner)
                outer_line.insert(1, beyond)
        blocks.append(np.array(inner_line + outer_line))
    return blocks


def least_force(blocks: list[np.ndarray], friction: float) -> float:
    """Largest normal force that all corners of all joints can have, over the mean weight."""
    n = len(blocks)
    balance, load = lil_matrix((3 * n, 3 * (n + 1) + 1)), np.zeros(3 * n)
    mean = 0.0
    for b, corners in enumerate(blocks):
        x, y = corners.T
        x2, y2 = np.roll(x, -1), np.roll(y, -1)
        w = x * y2 - x2 * y
        area = w.sum() / 2
        centre = np.array([((x + x2) * w).sum(), ((y + y2) * w).sum()]) / (6 * area)
        load[3 * b + 1] = area
        mean += area / n
        for joint, ends, sign in ((b, corners[[0, -1]], 1.0), (b + 1, corners[[len(x) // 2 - 1, len(x) // 2]], -1.0)):
            along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
            across = np.array([along[1], -along[0]])
            for k, (point, way) in enumerate(((ends[0], across), (ends[1], across), (ends.mean(axis=0), along))):
                arm = (point - centre) / np.linalg.norm(corners[-1] - corners[0])
                for r, value in enumerate((way[0], way[1], arm[0] * way[1] - arm[1] * way[0])):
                    balance[3 * b + r, 3 * joint + k] += sign * value
    size = 3 * (n + 1)
    law = lil_matrix((4 * (n + 1), size + 1))
    for j in range(n + 1):
        for k in range(2):
            law[4 * j + k, 3 * j + k], law[4 * j + k, size] = -1.0, 1.0
            law[4 * j + 2 + k, 3 * j], law[4 * j + 2 + k, 3 * j + 1] = -friction, -friction
            law[4 * j + 2 + k, 3 * j + 2] = (1.0, -1.0)[k]
    goal = np.zeros(size + 1)
    goal[size] = -1.0
    found = linprog(goal, A_eq=balance.tocsr(), b_eq=load / mean, A_ub=law.tocsr(), b_ub=np.zeros(4 * (n + 1)),
                    bounds=[(None, None)] * (size + 1), method="highs", options=TIGHT)
    return float(found.x[size]) if found.status == 0 else -1.0


def critical(row: dict[str, str], low: float, high: float) -> float:
    """Thickness at which the least force vanishes."""
    feet, ways = sections(row)
    friction = math.tan(math.radians(float(row["friction_deg"])))
    return float(
        brentq(lambda t: least_force(polygons(row, feet, ways, t), friction), low, high, xtol=1e-13, rtol=1e-12)
    )


NAMES = ("shape", "span", "rise", "right_rise", "half_angle_deg", "voussoirs", "friction_deg")
CASES = (
    ("segmental", "6.55", "1.428", "", "", "40", "40"),
    ("segmental", "7.3", "2.9", "1.1", "", "23", "50"),
    ("circular", "4.0", "2.6", "", "", "30", "60"),
    ("pointed", "5.2", "3.9", "", "", "24", "55"),
    ("pointed", "5.2", "4.4", "3.1", "", "30", "60"),
    ("elliptic", "9.0", "2.6", "", "", "33", "55"),
    ("elliptic", "9.0", "3.3", "1.9", "", "28", "60"),
    ("parabolic", "6.0", "2.2", "", "", "21", "45"),
    ("parabolic", "6.0", "2.7", "1.2", "", "26", "45"),
    ("catenary", "6.0", "3.4", "", "", "25", "45"),
    ("catenary", "6.0", "2.4", "1.3", "", "19", "45"),
    ("basket", "8.0", "2.5", "", "", "27", "60"),
)


def main() -> None:
    """Write the table."""
    out = sys.stdout
    out.write(",".join((*NAMES, "critical_thickness")) + "\n")
    for case in CASES:
        row = dict(zip(NAMES, case))
        feet, ways = sections(row)
        friction = math.tan(math.radians(float(row["friction_deg"])))
        grid = float(row["span"]) * np.geomspace(1e-5, 0.2, 40)
        values = [least_force(polygons(row, feet, ways, t), friction) for t in grid]
        first = next(k for k, value in enumerate(values) if value > 0.0)
        out.write(",".join((*case, repr(critical(row, grid[first - 1], grid[first])))) + "\n")
        out.flush()


if __name__ == "__main__":
    main()
