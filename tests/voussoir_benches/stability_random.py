"""Random slopes, towers, walls and flights, whose answers are formulas."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from voussoir_benches.checks import DENSITY, GRAVITY, Check
from voussoir_benches.expectations import Critical, Verdict
from voussoir_benches.limit_lp_blocks import moments
from voussoir_benches.measures import end
from voussoir_benches.scene import GEOMETRIES, Scene, block_scene, rectangle, written_block, written_blocks
from voussoir_benches.stability_blocks import BASE, at_rest, moving, wall


def random_blocks(count: int, seed: int) -> Iterator[Scene]:
    """Slopes, towers, walls, slides, lumps, flights and pushed walls in turn; the same seed makes the same ones."""
    chance = np.random.default_rng([seed, 1])
    kinds = (_slope, _tower, _wall, _slide, _lump, _flight, _pushed_wall, _tower)
    for number in range(1, count + 1):
        yield kinds[number % len(kinds)](number, chance)


def _geometry(chance: np.random.Generator) -> tuple[str, dict[str, dict[str, Any]]]:
    """One of the two geometries, and the groups of a deck for it."""
    geometry = str(chance.choice([name for name, _ in GEOMETRIES]))
    young = dict(GEOMETRIES)[geometry]
    return geometry, {"analysis": {"geometry": geometry}, "material": {"young": young}}


def _slope(number: int, chance: np.random.Generator) -> Scene:
    """A block on a slope: it stands where tan a is below tan phi and b/h."""
    slope = float(np.round(chance.uniform(1.0, 80.0), 3))
    friction = float(np.round(min(89.0, max(0.1, slope + chance.normal(0.0, 10.0))), 3))
    width = float(np.round(chance.uniform(0.1, 5.0), 3))
    height = float(np.round(width / math.tan(math.radians(slope)) * chance.uniform(0.2, 1.5), 3))
    falls = slope >= friction or math.tan(math.radians(slope)) >= width / height
    geometry, groups = _geometry(chance)
    return block_scene(
        "random blocks", f"{number}: slope {slope:g} deg, friction {friction:g}, {width:g} x {height:g} m, {geometry}",
        "", BASE + written_block(rectangle(0.0, 0.0, width, height)), Verdict("collapsed" if falls else "stable"),
        joint={"friction_deg": friction}, load={"gravity_direction_deg": slope - 90.0}, **groups)


def _tower(number: int, chance: np.random.Generator) -> Scene:
    """Blocks on one another, pushed: the least of all joints' tipping and of the friction."""
    left = np.zeros(0)
    while True:
        count = int(chance.integers(2, 12))
        widths = np.round(chance.uniform(0.5, 2.0, count), 3)
        heights = np.round(chance.uniform(0.1, 1.5, count), 3)
        left = np.round(np.cumsum(chance.uniform(-0.15, 0.15, count)) - widths / 2.0, 3)
        friction = float(np.round(chance.choice([chance.uniform(1.0, 40.0), 60.0]), 2))
        exact = tower_push(left, widths, heights, math.tan(math.radians(friction)))
        if exact > 0.01:
            break
    level = np.concatenate([[0.0], np.cumsum(heights)])
    text = BASE + written_blocks(rectangle(*map(float, row)) for row in zip(left, level, widths, heights))
    return _pushed(f"{number}: tower of {count}", text, friction, exact, chance)


def _pushed(
    name: str, text: str, friction: float, exact: float, chance: np.random.Generator, most: float = 2.0
) -> Scene:
    """A search for the horizontal force over the weight."""
    geometry, groups = _geometry(chance)
    return block_scene(
        "random blocks", f"{name}, friction {friction:g}, {geometry}", "", text,
        Critical(exact) if geometry == "reference" else Critical(exact, 1e-4), joint={"friction_deg": friction},
        search={"parameter": "horizontal_coefficient", "low": 0.0, "high": most}, **groups)


def tower_push(left: np.ndarray, widths: np.ndarray, heights: np.ndarray, friction: float) -> float:
    """Force to the right over the weight at which a tower slides or tips, by its blocks from the lowest on [m].

    The least over all joints; negative if the tower does not stand by itself.
    """
    level = np.concatenate([[0.0], np.cumsum(heights)])
    mass = widths * heights
    least = friction
    for i in range(len(left)):
        above = slice(i, None)
        x = np.average(left[above] + widths[above] / 2.0, weights=mass[above])
        y = np.average(level[i:-1] + heights[above] / 2.0, weights=mass[above])
        right = left[i] + widths[i]
        start = left[i]
        if i > 0:
            right = min(right, left[i - 1] + widths[i - 1])
            start = max(start, left[i - 1])
        if x < start:
            return -1.0
        least = min(least, (right - x) / (y - level[i]))
    return float(least)


def _wall(number: int, chance: np.random.Generator) -> Scene:
    """A wall at rest: its base carries its weight, no joint pulls."""
    courses, bricks = int(chance.integers(1, 12)), int(chance.integers(1, 7))
    length, height = (float(np.round(chance.uniform(0.1, 1.0), 3)) for _ in range(2))
    friction = float(np.round(chance.uniform(0.0, 89.9), 2))
    geometry, groups = _geometry(chance)
    text = BASE + written_blocks(wall(courses, bricks, length, height))
    answer = at_rest(DENSITY * GRAVITY * courses * bricks * length * height)
    groups["material"]["poisson"] = 0.0
    return block_scene(
        "random blocks", f"{number}: wall of {courses} x {bricks}, friction {friction:g}, {geometry}", "", text,
        answer, joint={"friction_deg": friction}, **groups)


def _lump(number: int, chance: np.random.Generator) -> Scene:
    """A convex block with a flat foot, pushed: it tips about the foot's end, or slides."""
    exact = 0.0
    while exact < 0.01:
        angles = np.sort(chance.uniform(-0.4 * math.pi, 1.4 * math.pi, int(chance.integers(2, 8))))
        foot = float(chance.uniform(0.2, 1.0))
        sides = np.array([(math.cos(a), math.sin(a)) for a in angles])
        corners = np.round(np.vstack([[-foot, -1.0], [foot, -1.0], sides]) + [0.0, 1.0], 3)
        corners = corners[[0, 1, *(2 + np.flatnonzero(corners[2:, 1] > 0.05))]]
        friction = float(np.round(chance.uniform(1.0, 80.0), 2))
        if len(corners) < 4 or not _is_convex(corners):
            continue
        x, y = moments(corners)[1]
        if x > -foot:
            exact = min(math.tan(math.radians(friction)), (corners[1, 0] - x) / y)
    text = BASE + written_block([(float(x), float(y)) for x, y in corners])
    return _pushed(f"{number}: lump of {len(corners)} corners", text, friction, exact, chance, 10.0)


def _is_convex(corner: np.ndarray) -> bool:
    """Return true if a polygon turns to the left at every corner, by a sine of 0.05 at least."""
    side = np.roll(corner, -1, axis=0) - corner
    side /= np.maximum(np.hypot(*side.T), 1e-9)[:, None]
    after = np.roll(side, -1, axis=0)
    return bool((side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0]).min() > 0.05)


def _pushed_wall(number: int, chance: np.random.Generator) -> Scene:
    """A low wall of little friction, pushed: it slides in some bed joint before anything tips."""
    courses, bricks = int(chance.integers(1, 4)), int(chance.integers(2, 4))
    height = float(np.round(chance.uniform(0.1, 0.3), 3))
    length = float(np.round(height * chance.uniform(2.0, 4.0), 3))
    friction = float(np.round(chance.uniform(1.0, 8.0), 2))
    exact = math.tan(math.radians(friction))
    text = BASE + written_blocks(wall(courses, bricks, length, height))
    return _pushed(f"{number}: wall of {courses} x {bricks} pushed", text, friction, exact, chance)


def _slide(number: int, chance: np.random.Generator) -> Scene:
    """A block that slides for a second: g (sin a - cos a tan phi) t^2/2."""
    slope = float(np.round(chance.uniform(10.0, 60.0), 3))
    friction = float(np.round(slope * chance.uniform(0.0, 0.8), 3))
    angle = math.radians(slope)
    pulled = GRAVITY * (math.sin(angle) - math.cos(angle) * math.tan(math.radians(friction)))
    text = BASE.replace("10.0", "30.0") + written_block(rectangle(0.0, 0.0, 3.0, 0.5))
    step = float(10.0 ** chance.uniform(-3.0, -1.0))
    deck = {
        "joint": {"friction_deg": friction}, "load": {"gravity_direction_deg": slope - 90.0},
        "analysis": {"max_displacement_ratio": 1.0}}
    return moving(
        "random blocks", f"{number}: slide down {slope:g} deg, friction {friction:g}, steps of {step:.1e} s", "",
        text + "measure 1.5 0.25\n", (Check("way in a second [m]", pulled / 2.0, end(0), 1e-3),), step, 1.0,
        deck)


def _flight(number: int, chance: np.random.Generator) -> Scene:
    """A thrown polygon that spins: a parabola, whatever the step."""
    corners = int(chance.integers(3, 9))
    angles = np.sort(chance.uniform(0.0, 2.0 * math.pi, corners))
    while np.diff(np.append(angles, angles[0] + 2.0 * math.pi)).max() > 0.9 * math.pi:
        angles = np.sort(chance.uniform(0.0, 2.0 * math.pi, corners))
    polygon = [(float(math.cos(a)), float(math.sin(a))) for a in angles]
    x, y = map(float, moments(np.array(polygon))[1])
    vx, vy, spin = (float(np.round(v, 3)) for v in chance.uniform(-5.0, 5.0, 3))
    text = written_block(polygon, f"velocity {vx!r} {vy!r} {spin!r}") + f"measure {x!r} {y!r}\n"
    step = float(10.0 ** chance.uniform(-3.0, -1.0))
    checks = (
        Check("u after a second [m]", vx, end(0), 1e-8, scale=1.0),
        Check("v after a second [m]", vy - GRAVITY / 2.0, end(1), 1e-8, scale=1.0),
    )
    return moving(
        "random blocks", f"{number}: flight of {corners} corners, spin {spin:g} rad/s, steps of {step:.1e} s", "", text,
        checks, step, 1.0, {"analysis": {"max_displacement_ratio": 1.0}})
