"""Confined blocks, which must stand, and blocks that must fall: static runs in current geometry.

A confined scene carries its loads without friction, so it stands under any law of friction; a hundredth of the weight
may push it to either side. In a falling scene no forces within the friction cones balance the loads, so it falls under
any law of friction. test_confined.py proves both by linear programmes.
`penalty_ratio` and Young's modulus are drawn over six decades each.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))

from assembly import Polygon  # noqa: E402
from scene import Scene, block  # noqa: E402

G, DENSITY = 9.81, 2400.0


@dataclass
class Layout:
    """Shapes, friction and loads of a scene."""

    blocks: list[Polygon]  #: Blocks that can move
    ground: list[Polygon]  #: Fixed blocks
    friction: float  #: Friction angle [deg]
    push: float = 0.0  #: Horizontal load over the weight
    tilt: float = 0.0  #: Angle by which all points are turned about the origin [deg]


def box(left: float, low: float, right: float, high: float) -> Polygon:
    """A rectangle."""
    return [(left, low), (right, low), (right, high), (left, high)]


def turned(polygon: Polygon, angle_deg: float) -> Polygon:
    """A polygon turned about the origin."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return [(c * x - s * y, s * x + c * y) for x, y in polygon]


def basin(width: float, height: float) -> list[Polygon]:
    """A floor and two walls around the strip from 0 to width."""
    return [box(-5.0 - width, -1.0, 2.0 * width + 5.0, 0.0), box(-2.0, 0.0, 0.0, height),
            box(width, 0.0, width + 2.0, height)]


def any_friction(pick: random.Random) -> float:
    """Smooth in a third of the scenes."""
    return pick.choice([0.0, pick.uniform(1.0, 60.0), pick.uniform(10.0, 40.0)])


def oedometer(pick: random.Random) -> Layout:
    """One block between two walls."""
    width, height = pick.uniform(0.3, 3.0), pick.uniform(0.3, 5.0)
    return Layout([box(0.0, 0.0, width, height)], basin(width, height * pick.uniform(0.3, 2.0)), any_friction(pick))


def confined_column(pick: random.Random) -> Layout:
    """A column of blocks between two walls."""
    width, y, blocks = pick.uniform(0.3, 2.0), 0.0, []
    for _ in range(pick.randint(2, 10)):
        height = pick.uniform(0.2, 1.5)
        blocks.append(box(0.0, y, width, y + height))
        y += height
    return Layout(blocks, basin(width, y + height * pick.uniform(-0.7, 2.0)), any_friction(pick))


def bonded_basin(pick: random.Random) -> Layout:
    """Courses of bricks that fill a basin, pushed against a wall or not."""
    columns, course = pick.randint(1, 4), pick.uniform(0.3, 0.8)
    courses, blocks = pick.randint(2, 6), []
    for i in range(courses):
        shift = 0.5 if i % 2 else 0.0
        heads = sorted({0.0, float(columns), *(k + shift for k in range(columns))})
        blocks += [box(a, i * course, b, (i + 1) * course) for a, b in zip(heads, heads[1:])]
    return Layout(blocks, basin(float(columns), (courses + 0.5) * course), any_friction(pick),
                  push=pick.choice([0.0, pick.uniform(-0.2, 0.2)]))


def basin_pyramid(pick: random.Random) -> Layout:
    """A rough pyramid of bricks whose lowest course touches both walls."""
    columns, course, blocks = pick.randint(2, 5), pick.uniform(0.3, 0.8), []
    for i in range(pick.randint(2, columns)):
        blocks += [box(k + 0.5 * i, i * course, k + 1.0 + 0.5 * i, (i + 1) * course) for k in range(columns - i)]
    return Layout(blocks, basin(float(columns), course * pick.uniform(0.5, 3.0)), pick.uniform(10.0, 60.0))


def wedge(pick: random.Random) -> Layout:
    """A wedge in a notch, skew or not, in layers or not."""
    left, right = (math.radians(pick.uniform(3.0, 50.0)) for _ in range(2))
    if pick.random() < 0.6:
        right = left
    height, top = pick.uniform(0.5, 4.0), pick.uniform(0.8, 1.5)
    layers = pick.choice([1, 1, 2, 3])
    cuts = [height * i / layers for i in range(layers + 1)]
    blocks = []
    for low, high in zip(cuts, cuts[1:]):
        foot = [(-low * math.tan(left), low), (low * math.tan(right), low)] if low > 0.0 else [(0.0, 0.0)]
        blocks.append([*foot, (high * math.tan(right), high), (-high * math.tan(left), high)])
    edge = top * height
    rights = [(0.0, 0.0), (0.0, -0.5), (edge * math.tan(right) + 1.0, -0.5), (edge * math.tan(right) + 1.0, edge),
              (edge * math.tan(right), edge)]
    lefts = [(0.0, 0.0), (-edge * math.tan(left), edge), (-edge * math.tan(left) - 1.0, edge),
             (-edge * math.tan(left) - 1.0, -0.5), (0.0, -0.5)]
    return Layout(blocks, [rights, lefts], any_friction(pick))


def corner(pick: random.Random) -> Layout:
    """Blocks in the corner of a tilted basin: they lean on its floor and its lower wall."""
    width, height = pick.uniform(0.5, 2.0), pick.uniform(0.4, 2.0)
    rows, columns = pick.choice([(1, 1), (1, 1), (2, 1), (1, 3), (2, 2)])
    blocks = [box(i * width, j * height, (i + 1) * width, (j + 1) * height)
              for j in range(rows) for i in range(columns)]
    ground = [box(-1.0, -1.0, columns * width + 5.0, 0.0), box(-1.0, 0.0, 0.0, (rows + 0.5) * height)]
    return Layout(blocks, ground, any_friction(pick), tilt=pick.uniform(2.0, 60.0))


def slider(pick: random.Random) -> Layout:
    """A block or a stack on a slope steeper than its friction."""
    friction = pick.choice([0.0, pick.uniform(5.0, 35.0)])
    blocks = [box(0.0, 0.4 * i, 2.0, 0.4 * (i + 1)) for i in range(pick.randint(1, 3))]
    return Layout(blocks, [box(-30.0, -2.0, 30.0, 0.0)], friction, tilt=friction + pick.uniform(1.0, 20.0))


def tilted_column(pick: random.Random) -> Layout:
    """A rough column on a base tilted beyond its slenderness."""
    n, height, slenderness = pick.randint(1, 8), pick.uniform(0.3, 0.8), pick.uniform(1.4, 6.0)
    blocks = [box(0.0, i * height, n * height / slenderness, (i + 1) * height) for i in range(n)]
    steepest = math.degrees(math.atan(1.0 / slenderness))
    return Layout(blocks, [box(-20.0, -2.0, 20.0, 0.0)], 75.0, tilt=steepest * pick.uniform(1.05, 1.6))


def toppler(pick: random.Random) -> Layout:
    """A rough block or column whose horizontal load turns it over."""
    n, height, width = pick.randint(1, 5), pick.uniform(0.3, 0.8), pick.uniform(0.3, 1.0)
    blocks = [box(0.0, i * height, width, (i + 1) * height) for i in range(n)]
    push = width / (n * height) * pick.uniform(1.05, 2.0) * pick.choice([-1.0, 1.0])
    return Layout(blocks, [box(-20.0, -2.0, 20.0, 0.0)], min(89.0, math.degrees(math.atan(1.5 * abs(push))) + 10.0),
                  push=push)


def pushed(pick: random.Random) -> Layout:
    """A row of blocks whose horizontal load is more than its friction."""
    friction, n = pick.uniform(0.0, 35.0), pick.randint(1, 4)
    blocks = [box(2.0 * i, 0.0, 2.0 * i + 2.0, pick.uniform(0.2, 0.5)) for i in range(n)]
    push = (math.tan(math.radians(friction)) + pick.uniform(0.02, 0.2)) * pick.choice([-1.0, 1.0])
    return Layout(blocks, [box(-60.0, -2.0, 60.0, 0.0)], friction, push=push)


def hanging(pick: random.Random) -> Layout:
    """A piece between two faces that open downward by more than its friction."""
    friction = pick.choice([0.0, pick.uniform(2.0, 30.0)])
    lean = math.tan(math.radians(friction + pick.uniform(2.0, 20.0)))
    wide, height = pick.uniform(0.5, 2.0), pick.uniform(0.3, 2.0)
    height = min(height, 0.8 * wide / lean)
    piece = [(-wide, 0.0), (wide, 0.0), (wide - lean * height, height), (-wide + lean * height, height)]
    (ax, ay), (bx, by) = piece[1], piece[2]
    right = [(ax, ay), (ax + 3.0, ay), (ax + 3.0, by), (bx, by)]
    left = [(-x, y) for x, y in reversed(right)]
    return Layout([piece], [right, left], friction)


def thin_arch(pick: random.Random) -> Layout:
    """A semicircular arch of less than its critical thickness of 0.1075 radii."""
    n, thickness = pick.randint(12, 30), 0.1075 * pick.uniform(0.6, 0.93)
    inner, outer = 1.0 - thickness / 2.0, 1.0 + thickness / 2.0
    at = [(math.cos(math.pi * i / n), math.sin(math.pi * i / n)) for i in range(n + 1)]
    blocks = [[(inner * c, inner * s), (outer * c, outer * s), (outer * d, outer * t), (inner * d, inner * t)]
              for (c, s), (d, t) in zip(at, at[1:])]
    (lx, ly), (kx, ky) = (inner * at[n][0], inner * at[n][1]), (outer * at[n][0], outer * at[n][1])
    right = [(inner, 0.0), (inner, -0.5), (outer, -0.5), (outer, 0.0)]
    return Layout(blocks, [right, [(kx, ky), (kx, -0.5), (lx, -0.5), (lx, ly)]], 60.0)


CONFINED: dict[str, Callable[[random.Random], Layout]] = {
    "oedometer": oedometer, "confined_column": confined_column, "bonded_basin": bonded_basin,
    "basin_pyramid": basin_pyramid, "wedge_in_notch": wedge, "block_in_corner": corner}
FALLING: dict[str, Callable[[random.Random], Layout]] = {
    "slider": slider, "tilted_column": tilted_column, "toppler": toppler, "pushed_row": pushed,
    "hanging_piece": hanging, "thin_arch": thin_arch}


def scene_of(layout: Layout, pick: random.Random, verdict: str) -> Scene:
    """The scene of a layout, at random sizes and stiffnesses."""
    size = 10.0 ** pick.uniform(-1.0, 1.0)
    text = ""
    for words, polygons in (("fixed", layout.ground), ("", layout.blocks)):
        for polygon in polygons:
            text += block([(size * x, size * y) for x, y in turned(polygon, layout.tilt)], words)
    levels = [y for polygon in layout.blocks for _, y in polygon]
    # a column of this height shortens by 3e-9 to 3e-3 of it
    young = DENSITY * G * size * (max(levels) - min(levels)) * 10.0 ** pick.uniform(2.5, 8.5)
    return Scene(
        text, {"mode": "static", "geometry": "current", "penalty_ratio": 10.0 ** pick.uniform(0.0, 6.0),
               "unknowns": pick.choice([3, 6, 6])},
        groups=f"&joint friction_deg = {layout.friction!r} /\n&load horizontal_coefficient = {layout.push!r} /\n",
        material={"density": DENSITY, "young": young, "poisson": pick.choice([0.0, 0.1, 0.2, 0.3, 0.45]),
                  "plane": pick.choice(["stress", "strain"])},
        verdicts=(verdict,))


def _family(draw: Callable[[random.Random], Layout], verdict: str) -> Callable[[random.Random], Scene]:
    """Generator of the scenes of a layout."""
    return lambda pick: scene_of(draw(pick), pick, verdict)


FAMILIES = {name: _family(draw, "stable") for name, draw in CONFINED.items()} | {
    name: _family(draw, "collapsed") for name, draw in FALLING.items()}
