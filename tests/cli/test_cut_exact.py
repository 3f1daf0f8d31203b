"""Blocks of random lines against an arrangement in rational numbers, where nothing is rounded."""

from __future__ import annotations

import math
import random
from collections import defaultdict
from fractions import Fraction
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

Point = tuple[Fraction, Fraction]
Line = tuple[Point, Point]


def cross(o: Point, a: Point, b: Point) -> Fraction:
    """Twice the area of a triangle."""
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def holds(line: Line, p: Point) -> bool:
    """Tell whether a point lies on a segment."""
    (a, b) = line
    return cross(a, b, p) == 0 and all(min(a[i], b[i]) <= p[i] <= max(a[i], b[i]) for i in range(2))


def common_points(one: Line, other: Line) -> set[Point]:
    """Find the points that two segments share: ends on the other one, or the crossing."""
    (a, b), (c, d) = one, other
    points = {p for p in one if holds(other, p)} | {p for p in other if holds(one, p)}
    det = (b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0])
    if points or det == 0:
        return points
    s = ((c[0] - a[0]) * (d[1] - c[1]) - (c[1] - a[1]) * (d[0] - c[0])) / det
    p = (a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]))
    return {p} if holds(one, p) and holds(other, p) else set()


def exact_areas(lines: list[Line]) -> list[Fraction]:
    """Cut lines into blocks without rounding."""
    nodes = [set() for _ in lines]
    for i, one in enumerate(lines):
        for j in range(i):
            for p in common_points(one, lines[j]):
                nodes[i].add(p)
                nodes[j].add(p)
    around: dict[Point, set[Point]] = defaultdict(set)
    for points in nodes:
        row = sorted(points)
        for p, q in zip(row, row[1:]):
            around[p].add(q)
            around[q].add(p)
    loose = [p for p in around if len(around[p]) == 1]
    while loose:
        p = loose.pop()
        if len(around[p]) != 1:
            continue
        q = around[p].pop()
        around[q].discard(p)
        if len(around[q]) == 1:
            loose.append(q)
    turn = {
        p: sorted(qs, key=lambda q, p=p: math.atan2(float(q[1] - p[1]), float(q[0] - p[0])))
        for p, qs in around.items()
    }
    areas, seen = [], set()
    for start in around:
        for second in around[start]:
            edge, loop = (start, second), []
            while edge not in seen:
                seen.add(edge)
                loop.append(edge[0])
                fan = turn[edge[1]]
                edge = (edge[1], fan[fan.index(edge[0]) - 1])
            area = sum(cross(loop[0], p, q) for p, q in zip(loop[1:], loop[2:])) / 2
            if area > 0:
                areas.append(area)
    return sorted(areas)


def random_lines(rng: random.Random, n: int, grid: int) -> list[Line]:
    """Make a frame and lines between points of a coarse grid, so that many meet in one point."""
    corners = [(0, 0), (grid, 0), (grid, grid), (0, grid)]
    pairs = list(zip(corners, corners[1:] + corners[:1]))
    while len(pairs) < n + 4:
        a, b = ((rng.randint(0, grid), rng.randint(0, grid)) for _ in range(2))
        if a != b:
            pairs.append((a, b))
    return [tuple((Fraction(x), Fraction(y)) for x, y in pair) for pair in pairs]


@pytest.mark.parametrize(("n", "grid"), [(3, 4), (8, 4), (8, 12), (25, 7), (60, 9), (60, 1000)])
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("offset", [0, 2**20])
def test_blocks_are_those_of_exact_arithmetic(tmp_path: Path, n: int, grid: int, seed: int, offset: int) -> None:
    lines = random_lines(random.Random(1000 * n + seed), n, grid)
    rows = [" ".join(str(int(v) + offset) for p in line for v in p) + " 1\n" for line in lines]
    (tmp_path / "a.geo").write_text(f"0\n{len(lines)} 0\n0\n0\n0\n0\n0\n0\n" + "".join(rows))
    done = run_dda("cut", "a.geo", "--out", "a.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    areas = sorted(float(row["area"]) for row in rows_of(tmp_path / "a.csv"))
    assert sum(areas) == pytest.approx(grid**2, rel=1e-9)
    exact = [float(a) for a in exact_areas(lines)]
    if "islands" not in done.stdout:
        assert areas == pytest.approx(exact, rel=1e-9, abs=1e-9)
        return
    # a block around others is cut into pieces; its exact area includes them
    alone = [area for area in exact if any(abs(area - own) <= 1e-9 * (1.0 + own) for own in areas)]
    count = int(done.stdout.split("islands")[1].split()[0])
    assert len(alone) >= len(exact) - count
