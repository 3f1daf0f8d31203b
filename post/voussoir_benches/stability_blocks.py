"""Stiff and extreme scenes of blocks at rest, with exact answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import islice

from voussoir_benches.checks import Check, Outcome, verdict
from voussoir_benches.expectations import Critical, Measured, Refused, Verdict
from voussoir_benches.scene import (
    Corners, Scene, block_scene, in_both, rectangle, written_block, written_blocks,
)

#: Weight of a cubic metre of the decks that set it [N/m3]
WEIGHT = 25000.0
#: Material of blocks that press one another straight
STIFF = {"unit_weight": WEIGHT, "poisson": 0.0}
#: A base at height 0
BASE = written_block(rectangle(-10.0, -1.0, 20.0, 1.0), "fixed")


def block_scenes() -> Iterator[Scene]:
    """All scenes of blocks at rest but the random ones."""
    yield from _contrasts()
    yield from _stacks()
    yield from _slopes()
    yield from _corners()
    yield from _indeterminate()
    yield from _slivers()
    yield from _far_away()
    yield from _directions()


def normal_force(joint: int) -> Callable[[Outcome], float]:
    """Measure of a joint's normal force [N/m]; joints that are closed, counted from 1."""

    def measure(outcome: Outcome) -> float:
        closed = [row for row in outcome.rows("joints") if row["state"] != "open"]
        return float(closed[joint - 1]["normal_force"])

    return measure


def support(outcome: Outcome) -> float:
    """Sum of the normal forces of all joints at height 0 [N/m]."""
    rows = outcome.rows("joints")
    heights = [max(abs(float(row["y_intrados"])), abs(float(row["y_extrados"]))) for row in rows]
    return sum(float(row["normal_force"]) for row, y in zip(rows, heights) if y < 1e-3)


def pull(outcome: Outcome) -> float:
    """By how much the most negative normal force is below zero [N/m]."""
    return max(0.0, -min(float(row["normal_force"]) for row in outcome.rows("joints")))


def tower(widths: Sequence[float], height: float = 1.0, words: Sequence[str] = ()) -> str:
    """Centred blocks on one another on the base, from the lowest on."""
    text = BASE
    for i, width in enumerate(widths):
        corners = rectangle(-width / 2.0, i * height, width, height)
        text += written_block(corners, words[i] if words else "")
    return text


def weights(forces: Sequence[float], accept: float = 1e-8) -> Measured:
    """The scene stands, and the normal forces of its joints are the weights above them."""
    checks = [Check(f"N of joint {i} [N/m]", force, normal_force(i), accept) for i, force in enumerate(forces, 1)]
    return Measured((verdict("stable", "verdict"), *checks))


def _contrasts() -> Iterator[Scene]:
    """Blocks a thousand million times as stiff, heavy, large as their neighbours."""
    guard = "penalty of a joint from the two blocks it parts"
    orders = {"soft on stiff": "32", "stiff on soft": "23", "soft between stiff": "323", "by turns": "232323"}
    for geometry in ("reference", "current"):
        for low, high in ((1e3, 1e12), (5e6, 5e15)):
            for order, kinds in orders.items():
                count = len(kinds)
                text = tower([1.0] * count, words=[f"material {kind}" for kind in kinds])
                text += f"material 2 young {low!r}\nmaterial 3 young {high!r}\n"
                # moving blocks are strained by no more than the usual masonry
                weight = WEIGHT if geometry == "reference" else WEIGHT * low / 5e9
                yield block_scene(
                    "contrast", f"{order}, E {low:g} and {high:g} Pa, {geometry}", guard, text,
                    weights([weight * (count - i) for i in range(count)], 1e-6),
                    material={"unit_weight": weight, "poisson": 0.0}, analysis={"geometry": geometry})
    yield from _mass_contrasts()


def _mass_contrasts() -> Iterator[Scene]:
    """Feathers, anvils and pebbles."""
    guard, light = "forces balance to a share of what bears on the block itself", {"unit_weight": 1.0}
    for ratio in (1e3, 1e6, 1e9):
        heavy = f"material 2 unit_weight {ratio!r} density {ratio!r}\n"
        for name, kinds, forces in (
            ("feather on mountain", "21", (ratio + 1.0, 1.0)),
            ("mountain on feather", "12", (ratio + 1.0, ratio)),
            ("feathers between", "2121", (2.0 * ratio + 2.0, ratio + 2.0, ratio + 1.0, 1.0)),
        ):
            text = tower([1.0] * len(kinds), words=["material 2" if kind == "2" else "" for kind in kinds]) + heavy
            name = f"{name}, mass ratio {ratio:g}"
            yield from in_both("contrast", name, guard, text, weights(forces, 1e-6), material=light)
    for size in (1e-1, 1e-2, 10.0**-4.5):
        text = BASE + written_blocks([rectangle(-size / 2.0, 0.0, size, size), rectangle(-0.5, size, 1.0, 1.0)])
        bears = weights([1.0 + size**2, 1.0], 1e-6)
        yield from in_both("contrast", f"anvil on a pebble of {size:.2g} m", guard, text, bears, material=light)


def _pushed(
    group: str, name: str, text: str, exact: float, friction_deg: float, guard: str = "cone first, then Coulomb",
    accept: float = 1e-4
) -> Iterator[Scene]:
    """A search for the horizontal force over the weight, in both geometries."""
    yield from in_both(
        group, name, guard, text, Critical(exact), Critical(exact, accept * exact),
        joint={"friction_deg": friction_deg}, material={"unit_weight": WEIGHT},
        search={"parameter": "horizontal_coefficient", "low": 0.0, "high": 2.0})


def _stacks() -> Iterator[Scene]:
    """Towers: the weights above every joint, the push that tips or slides them."""
    for count in (1, 3, 10, 100):
        cubes = tower([1.0] * count)
        bears = weights([WEIGHT * (count - i) for i in range(count)])
        yield from in_both("stack", f"{count} cubes", "direct factor of the chain", cubes, bears, material=STIFF)
        for friction in (5.0, 85.0):
            exact = min(math.tan(math.radians(friction)), 1.0 / count)
            yield from _pushed("stack", f"{count} cubes pushed, friction {friction:g} deg", cubes, exact, friction)
    for half in (5.0, 30.0, 60.0, 85.0):
        yield from _wedge(half)


def _wedge(half_deg: float) -> Iterator[Scene]:
    """A wedge in a notch without friction: W/(2 sin b) on either side."""
    slope = math.tan(math.radians(half_deg))
    sides = (
        [(0.0, 0.0), (0.0, -1.0), (2.0 * slope + 1.0, -1.0), (2.0 * slope, 2.0)],
        [(0.0, 0.0), (-2.0 * slope, 2.0), (-2.0 * slope - 1.0, -1.0), (0.0, -1.0)],
    )
    force = WEIGHT * slope / (2.0 * math.sin(math.radians(half_deg)))
    text = "".join(written_block(side, "fixed") for side in sides)
    text += written_block([(0.0, 0.0), (slope, 1.0), (-slope, 1.0)])
    yield from in_both(
        "stack", f"wedge in a notch of {2 * half_deg:g} deg, no friction",
        "corners in a notch are the corner of no contact", text, weights([force, force]), weights([force, force], 1e-6),
        joint={"friction_deg": 0.0}, material={"unit_weight": WEIGHT})


def _slopes() -> Iterator[Scene]:
    """A block on a slope, its friction angle a little more, a little less, and just as steep."""
    block = written_block(rectangle(0.0, 0.0, 1.0, 0.2))
    for slope in (5.0, 30.0, 60.0, 75.0):
        low = written_block(rectangle(0.0, 0.0, 1.0, 0.5 / math.tan(math.radians(slope))))
        text, load = BASE + (low if slope > 70.0 else block), {"gravity_direction_deg": -90.0 + slope}
        for distance in (-0.1, -1e-3, -1e-6, 1e-6, 1e-3, 0.1):
            yield from in_both(
                "slope", f"{slope:g} deg, friction {distance:+g} deg", "rest is judged by the residual of equilibrium",
                text, Verdict("stable" if distance > 0.0 else "collapsed"), joint={"friction_deg": slope + distance},
                load=load)
        yield block_scene(
            "slope", f"{slope:g} deg, searched", "the bracket holds the angle of friction itself", text,
            Critical(slope), load=load, search={"parameter": "friction_deg", "low": 0.0, "high": 89.0})
    still = Measured((verdict("stable", "verdict"), Check("drift [m]", 0.0, _aside, 1e-9, scale=1.0)))
    for friction in (0.0, 1e-6, 89.9, 90.0):
        yield from in_both(
            "slope", f"flat, friction {friction:g} deg", "no force, no motion", BASE + block + "measure 0.5 0.2\n",
            still, joint={"friction_deg": friction})
    for friction in (60.0, 89.9):
        tall = BASE + written_block(rectangle(0.0, 0.0, 0.5, 1.0))
        yield from _pushed("slope", f"toppling at friction {friction:g}", tall, 0.5, friction)


def _aside(outcome: Outcome) -> float:
    """Way of point 1 to the side [m]."""
    rows = outcome.rows("points")
    return float(rows[-1]["u"]) if rows else 0.0


def _corners() -> Iterator[Scene]:
    """Corners that touch corners, and blocks that stand on one corner."""
    guard = "a corner before a corner is held by the edge that it would cross last"
    four = [rectangle(x, y, 1.0, 1.0) for y in (0.0, 1.0) for x in (-1.0, 0.0)]
    post, side = rectangle(0.0, 0.0, 1.0, 1.0), rectangle(1.0, 0.0, 1.0, 1.0)
    roof, saddle = [(0.0, 0.0), (2.0, 0.0), (1.0, 2.0)], [(1.0, 2.0), (2.0, 4.0), (0.0, 4.0)]
    for name, shapes, answer in (
        ("four at one point", four, Verdict("stable")),
        ("corner on corner and nothing else", [post, rectangle(1.0, 1.0, 1.0, 1.0)], Refused("has no support")),
        ("an edge over two corners that meet", [post, side, rectangle(0.5, 1.0, 1.0, 1.0)], Verdict("stable")),
        ("a wedge upside down on the tip of another", [roof, saddle], Refused("has no support")),
    ):
        yield from in_both("corners", name, guard, BASE + written_blocks(shapes), answer)
    square = [(0.0, 0.0), (1.0, 1.0), (0.0, 2.0), (-1.0, 1.0)]
    for tilt in (-1.0, -1e-4, 1.0, 30.0):
        yield from in_both(
            "corners", f"a square on its corner, gravity turned by {tilt:g} deg", "one corner holds no moment",
            BASE + written_block(square), Verdict("collapsed"), load={"gravity_direction_deg": -90.0 + tilt})


def wall(courses: int, bricks: int, length: float, height: float) -> list[Corners]:
    """Bricks in half bond."""
    found: list[Corners] = []
    for course in range(courses):
        odd = course % 2
        ends = [0.0, *((i + 0.5 * odd) * length for i in range(1 - odd, bricks)), bricks * length]
        found += [rectangle(left, course * height, right - left, height) for left, right in zip(ends, ends[1:])]
    return found


def at_rest(weight: float) -> Measured:
    """The scene stands, its base carries the weight [N/m], and no joint pulls."""
    base = Check("force on the base [N/m]", weight, support, 1e-8)
    return Measured((verdict("stable", "verdict"), base, Check("tension in a joint [N/m]", 0.0, pull, 0.0, scale=1.0)))


def _indeterminate() -> Iterator[Scene]:
    """Walls and stools with more joints than their balance needs."""
    group, guard = "indeterminate", "the give of the joints shares the forces out"
    for courses, bricks in ((20, 1), (4, 4), (10, 5)):
        text = BASE + written_blocks(wall(courses, bricks, 0.5, 0.25))
        answer = at_rest(WEIGHT * courses * bricks * 0.5 * 0.25)
        yield from in_both(group, f"wall of {courses} courses, {bricks} long", guard, text, answer, material=STIFF)
    for legs in (2, 3, 4, 7):
        posts = [rectangle(i * 4.0 / (legs - 1), 0.0, 0.2, 1.0) for i in range(legs)]
        text = BASE + written_blocks([*posts, rectangle(0.0, 1.0, 4.2, 0.5)])
        answer = at_rest(WEIGHT * (legs * 0.2 + 4.2 * 0.5))
        yield from in_both(group, f"stool of {legs} legs", guard, text, answer, material=STIFF)
    text = "".join(written_block(rectangle(x, -1.0, 1.0, 3.0), "fixed") for x in (-2.0, 1.0))
    text += written_blocks(rectangle(-1.0 + 0.5 * i, 0.0, 0.5, 1.0) for i in range(4))
    for friction, word in ((89.9, "stable"), (0.0, "collapsed")):
        name = f"four blocks between two walls, friction {friction:g} deg"
        yield from in_both(group, name, guard, text, Verdict(word), joint={"friction_deg": friction}, material=STIFF)


def _slivers() -> Iterator[Scene]:
    """Slender and flat blocks: the weight passes through, nothing turns."""
    group, guard = "slender block", "unknowns about the centre of the block"
    for ratio in (1e2, 1e4, 1e6):
        for name, width, height in (("upright", 1.0 / ratio, 1.0), ("lying", 1.0, 1.0 / ratio)):
            text = BASE + written_block(rectangle(0.0, 0.0, width, height))
            bears = weights([WEIGHT * width * height], 1e-6)
            scenes = in_both(group, f"{ratio:g}, {name}", guard, text, bears, material=STIFF)
            # an upright needle that moves is left out
            yield from islice(scenes, 1 if name == "upright" and ratio > 1e4 else 2)
    for thickness in (1e-3, 1e-5, 1e-7):
        text = BASE + written_blocks([rectangle(-0.5, 0.0, 1.0, thickness), rectangle(-0.5, thickness, 1.0, 1.0)])
        bears = weights([WEIGHT * (1.0 + thickness), WEIGHT], 1e-6)
        yield from in_both(group, f"a block on a sheet of {thickness:g} m", guard, text, bears, material=STIFF)


def _far_away() -> Iterator[Scene]:
    """Places far from zero, models of a nanometre and of a thousand kilometres."""
    push = {"joint": {"friction_deg": 60.0}, "search": {"parameter": "horizontal_coefficient"}}
    for offset in (1e3, 1e5, 1e7):
        for size in (1.0, 0.1):
            text = written_block(rectangle(offset - 10.0 * size, offset - size, 20.0 * size, size), "fixed")
            text += written_blocks(rectangle(offset, offset + i * size, size, size) for i in range(3))
            # the corners are rounded to the spacing of numbers at their place
            near, moved = (Critical(1.0 / 3.0, bound + 4.0 * math.ulp(offset) / size) for bound in (1e-8, 1e-4))
            yield from in_both(
                "far away", f"three cubes of {size:g} m at {offset:g} m, pushed",
                "an origin of their own for blocks far away", text, near, moved, material={"unit_weight": WEIGHT},
                **push)
    near, moved = (Critical(1.0 / 3.0, bound) for bound in (1e-8, 1e-4))
    for scale in (1e-9, 1e-6, 1e6):
        text = written_block([(x * scale, y * scale) for x, y in rectangle(-9, -1, 19, 1)], "fixed")
        text += written_blocks(rectangle(0.0, i * scale, scale, scale) for i in range(3))
        for scene in in_both(
            "far away", f"three cubes of {scale:g} m, pushed", "every threshold is a ratio", text, near, moved,
            material={"unit_weight": WEIGHT}, **push
        ):
            if isinstance(scene.deck, dict):
                scene.deck["material"]["young"] *= scale
            yield scene


def _directions() -> Iterator[Scene]:
    """Gravity up, to the side, and turned together with the scene."""
    group, guard = "direction", "nothing knows which way is down"
    for direction in (90.0, 0.0, 180.0):
        load = {"gravity_direction_deg": direction}
        name = f"a cube, gravity {direction:g} deg"
        yield from in_both(group, name, guard, tower([1.0]), Verdict("collapsed"), load=load)
    for turn in (17.3, 90.0, 180.0, -133.0):
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        base, *cubes = (
            [(c * x - s * y, s * x + c * y) for x, y in corners]
            for corners in (rectangle(-10.0, -1.0, 20.0, 1.0), *(rectangle(0.0, i * 1.0, 1.0, 1.0) for i in range(3)))
        )
        text = written_block(base, "fixed") + written_blocks(cubes)
        for lean, word in ((-18.4, "stable"), (-18.5, "collapsed")):
            yield from in_both(
                group, f"three cubes leaning by {-lean:g} of 18.435 deg, turned {turn:g}", guard, text, Verdict(word),
                joint={"friction_deg": 60.0}, load={"gravity_direction_deg": (turn - 90.0 + lean + 360.0) % 360.0})
