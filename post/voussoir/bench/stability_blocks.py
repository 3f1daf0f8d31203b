"""Stiff and extreme scenes of blocks at rest, with exact answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from voussoir.bench.stability_judge import Critical, Measured, Refused, Shifted, Verdict
from voussoir.bench.stability_scene import Corners, Scene, block_scene, rectangle, written_block
from voussoir.bench.validation_scene import Check, Outcome, verdict

#: Weight of a cubic metre of the decks that set it [N/m3]
WEIGHT = 25000.0
#: Both geometries, with the modulus that makes moving blocks nearly rigid [Pa]
GEOMETRIES = (("reference", 5e9), ("current", 5e12))
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
    for geometry in ("reference", "current"):
        for low, high in ((1e3, 1e12), (5e6, 5e15)):
            for order in ("soft on stiff", "stiff on soft", "soft between stiff", "by turns"):
                kinds = {"soft on stiff": "32", "stiff on soft": "23", "by turns": "232323"}
                words = [f"material {kind}" for kind in kinds.get(order, "323")]
                text = tower([1.0] * len(words), words=words)
                text += f"material 2 young {low!r}\nmaterial 3 young {high!r}\n"
                count = len(words)
                # moving blocks are strained by no more than the usual masonry
                weight = WEIGHT if geometry == "reference" else WEIGHT * low / 5e9
                yield block_scene(
                    "contrast", f"{order}, E {low:g} and {high:g} Pa, {geometry}", guard, text,
                    weights([weight * (count - i) for i in range(count)], 1e-6),
                    material={"unit_weight": weight, "poisson": 0.0}, analysis={"geometry": geometry})
    yield from _mass_contrasts()


def _mass_contrasts() -> Iterator[Scene]:
    """Feathers, anvils and pebbles."""
    guard = "forces balance to a share of what bears on the block itself"
    for geometry, young in GEOMETRIES:
        deck = {"analysis": {"geometry": geometry}, "material": {"unit_weight": 1.0, "young": young}}
        for ratio in (1e3, 1e6, 1e9):
            heavy = f"material 2 unit_weight {ratio!r} density {ratio!r}\n"
            for name, words, forces in (
                ("feather on mountain", ("material 2", ""), (ratio + 1.0, 1.0)),
                ("mountain on feather", ("", "material 2"), (ratio + 1.0, ratio)),
                (
                    "feathers between",
                    ("material 2", "", "material 2", ""),
                    (2.0 * ratio + 2.0, ratio + 2.0, ratio + 1.0, 1.0),
                ),
            ):
                yield block_scene(
                    "contrast", f"{name}, mass ratio {ratio:g}, {geometry}", guard,
                    tower([1.0] * len(words), words=words) + heavy, weights(forces, 1e-6), **deck)
        for size in (1e-1, 1e-2, 10.0**-4.5):
            anvil = written_block(rectangle(-0.5, size, 1.0, 1.0))
            pebble = written_block(rectangle(-size / 2.0, 0.0, size, size))
            yield block_scene(
                "contrast", f"anvil on a pebble of {size:.2g} m, {geometry}", guard, BASE + pebble + anvil,
                weights([1.0 + size**2, 1.0], 1e-6), **deck)


def _pushed(
    group: str, name: str, text: str, exact: float, friction_deg: float, guard: str = "cone first, then Coulomb",
    accept: float = 1e-4
) -> Iterator[Scene]:
    """A search for the horizontal force over the weight, in both geometries."""
    for geometry, young in GEOMETRIES:
        yield block_scene(
            group, f"{name}, {geometry}", guard, text,
            Critical(exact) if geometry == "reference" else Shifted(exact, accept * exact),
            joint={"friction_deg": friction_deg}, material={"unit_weight": WEIGHT, "young": young},
            analysis={"geometry": geometry}, search={"parameter": "horizontal_coefficient", "low": 0.0, "high": 2.0}
        )


def _stacks() -> Iterator[Scene]:
    """Towers: the weights above every joint, the push that tips or slides them."""
    for count in (1, 3, 10, 100):
        for geometry, young in GEOMETRIES:
            yield block_scene(
                "stack", f"{count} cubes, {geometry}", "direct factor of the chain", tower([1.0] * count),
                weights([WEIGHT * (count - i) for i in range(count)]),
                material={"unit_weight": WEIGHT, "young": young, "poisson": 0.0}, analysis={"geometry": geometry})
        for friction in (5.0, 85.0):
            exact = min(math.tan(math.radians(friction)), 1.0 / count)
            name = f"{count} cubes pushed, friction {friction:g} deg"
            yield from _pushed("stack", name, tower([1.0] * count), exact, friction)
    for half in (5.0, 30.0, 60.0, 85.0):
        yield from _wedge(half)


def _wedge(half_deg: float) -> Iterator[Scene]:
    """A wedge in a notch without friction: W/(2 sin b) on either side."""
    slope = math.tan(math.radians(half_deg))
    sides = (
        [(0.0, 0.0), (0.0, -1.0), (2.0 * slope + 1.0, -1.0), (2.0 * slope, 2.0)],
        [(0.0, 0.0), (-2.0 * slope, 2.0), (-2.0 * slope - 1.0, -1.0), (0.0, -1.0)],
    )
    wedge = [(0.0, 0.0), (slope, 1.0), (-slope, 1.0)]
    force = WEIGHT * slope / (2.0 * math.sin(math.radians(half_deg)))
    text = "".join(written_block(side, "fixed") for side in sides) + written_block(wedge)
    for geometry, young in GEOMETRIES:
        yield block_scene(
            "stack", f"wedge in a notch of {2 * half_deg:g} deg, no friction, {geometry}",
            "corners in a notch are the corner of no contact", text,
            weights([force, force], 1e-8 if geometry == "reference" else 1e-6), joint={"friction_deg": 0.0},
            material={"unit_weight": WEIGHT, "young": young}, analysis={"geometry": geometry}
        )


def _slopes() -> Iterator[Scene]:
    """A block on a slope, its friction angle a little more, a little less, and just as steep."""
    block = written_block(rectangle(0.0, 0.0, 1.0, 0.2))
    for slope in (5.0, 30.0, 60.0, 75.0):
        low = written_block(rectangle(0.0, 0.0, 1.0, 0.5 / math.tan(math.radians(slope))))
        for distance in (-0.1, -1e-3, -1e-6, 1e-6, 1e-3, 0.1):
            for geometry, young in GEOMETRIES:
                yield block_scene(
                    "slope", f"{slope:g} deg, friction {distance:+g} deg, {geometry}",
                    "rest is judged by what is left of balance", BASE + (low if slope > 70.0 else block),
                    Verdict("stable" if distance > 0.0 else "collapsed"), joint={"friction_deg": slope + distance},
                    material={"young": young}, analysis={"geometry": geometry},
                    load={"gravity_direction_deg": -90.0 + slope}
                )
        yield block_scene(
            "slope", f"{slope:g} deg, searched", "the bracket holds the angle of friction itself",
            BASE + (low if slope > 70.0 else block), Critical(slope), load={"gravity_direction_deg": -90.0 + slope},
            search={"parameter": "friction_deg", "low": 0.0, "high": 89.0})
    for friction in (0.0, 1e-6, 89.9, 90.0):
        for geometry, young in GEOMETRIES:
            yield block_scene(
                "slope", f"flat, friction {friction:g} deg, {geometry}", "no force, no motion",
                BASE + block + "measure 0.5 0.2\n",
                Measured((verdict("stable", "verdict"), Check("drift [m]", 0.0, _aside, 1e-9, scale=1.0))),
                joint={"friction_deg": friction}, material={"young": young}, analysis={"geometry": geometry}
            )
    for friction in (60.0, 89.9):
        tall = BASE + written_block(rectangle(0.0, 0.0, 0.5, 1.0))
        yield from _pushed("slope", f"toppling at friction {friction:g}", tall, 0.5, friction)


def _aside(outcome: Outcome) -> float:
    """Way of point 1 to the side [m]."""
    rows = outcome.rows("points")
    return float(rows[-1]["u"]) if rows else 0.0


def _corners() -> Iterator[Scene]:
    """Corners that touch corners, and blocks that stand on one corner."""
    four = [rectangle(x, y, 1.0, 1.0) for y in (0.0, 1.0) for x in (-1.0, 0.0)]
    square = [(0.0, 0.0), (1.0, 1.0), (0.0, 2.0), (-1.0, 1.0)]
    guard = "a corner before a corner is held by the edge that it would cross last"
    for geometry, young in GEOMETRIES:
        more = {"analysis": {"geometry": geometry}, "material": {"young": young}}
        text = BASE + "".join(map(written_block, four))
        yield block_scene("corners", f"four at one point, {geometry}", guard, text, Verdict("stable"), **more)
        post = BASE + written_block(rectangle(0.0, 0.0, 1.0, 1.0))
        over = written_block(rectangle(1.0, 1.0, 1.0, 1.0))
        yield block_scene(
            "corners", f"corner on corner and nothing else, {geometry}", guard, post + over, Refused("has no support"),
            **more)
        side = written_block(rectangle(1.0, 0.0, 1.0, 1.0))
        bridge = [(0.5, 1.0), (1.5, 1.0), (1.5, 2.0), (0.5, 2.0)]
        yield block_scene(
            "corners", f"an edge over two corners that meet, {geometry}", guard, post + side + written_block(bridge),
            Verdict("stable"), **more)
        roof = [(0.0, 0.0), (2.0, 0.0), (1.0, 2.0)]
        saddle = [(1.0, 2.0), (2.0, 4.0), (0.0, 4.0)]
        yield block_scene(
            "corners", f"a wedge upside down on the tip of another, {geometry}", guard,
            BASE + written_block(roof) + written_block(saddle), Refused("has no support"), **more)
    for geometry, young in GEOMETRIES:
        for tilt in (-1.0, -1e-4, 1.0, 30.0):
            yield block_scene(
                "corners", f"a square on its corner, gravity turned by {tilt:g} deg, {geometry}",
                "one corner holds no moment", BASE + written_block(square), Verdict("collapsed"),
                load={"gravity_direction_deg": -90.0 + tilt}, analysis={"geometry": geometry}, material={"young": young}
            )


def wall(courses: int, bricks: int, length: float, height: float) -> tuple[list[Corners], int]:
    """Bricks in half bond, and how many lie in the lowest course."""
    found: list[Corners] = []
    for course in range(courses):
        odd = course % 2
        ends = [0.0, *((i + 0.5 * odd) * length for i in range(1 - odd, bricks)), bricks * length]
        found += [rectangle(left, course * height, right - left, height) for left, right in zip(ends, ends[1:])]
    return found, bricks


def _indeterminate() -> Iterator[Scene]:
    """Walls and stools with more joints than their balance needs."""
    guard = "the give of the joints shares the forces out"
    fine = verdict("stable", "verdict")
    no_pull = Check("tension in a joint [N/m]", 0.0, pull, 0.0, scale=1.0)
    for geometry, young in GEOMETRIES:
        more = {"analysis": {"geometry": geometry}, "material": {"unit_weight": WEIGHT, "young": young, "poisson": 0.0}}
        for courses, bricks in ((20, 1), (4, 4), (10, 5)):
            text = BASE + "".join(map(written_block, wall(courses, bricks, 0.5, 0.25)[0]))
            whole = WEIGHT * courses * bricks * 0.5 * 0.25
            force = Check("force on the base [N/m]", whole, support, 1e-8)
            name = f"wall of {courses} courses, {bricks} long, {geometry}"
            checks = Measured((fine, force, no_pull))
            yield block_scene("indeterminate", name, guard, text, checks, **more)
        for legs in (2, 3, 4, 7):
            posts = [rectangle(i * 4.0 / (legs - 1), 0.0, 0.2, 1.0) for i in range(legs)]
            text = BASE + "".join(map(written_block, posts))
            text += written_block(rectangle(0.0, 1.0, 4.2, 0.5))
            whole = WEIGHT * (legs * 0.2 + 4.2 * 0.5)
            force = Check("force on the base [N/m]", whole, support, 1e-8)
            name = f"stool of {legs} legs, {geometry}"
            checks = Measured((fine, force, no_pull))
            yield block_scene("indeterminate", name, guard, text, checks, **more)
        jambs = written_block(rectangle(-2.0, -1.0, 1.0, 3.0), "fixed")
        jambs += written_block(rectangle(1.0, -1.0, 1.0, 3.0), "fixed")
        row = [rectangle(-1.0 + 0.5 * i, 0.0, 0.5, 1.0) for i in range(4)]
        for friction, word in ((89.9, "stable"), (0.0, "collapsed")):
            yield block_scene(
                "indeterminate", f"four blocks between two walls, friction {friction:g} deg, {geometry}", guard,
                jambs + "".join(map(written_block, row)), Verdict(word), joint={"friction_deg": friction}, **more)


def _slivers() -> Iterator[Scene]:
    """Slender and flat blocks: the weight passes through, nothing turns."""
    guard = "unknowns about the centre of the block"
    for ratio in (1e2, 1e4, 1e6):
        for name, width, height in (("upright", 1.0 / ratio, 1.0), ("lying", 1.0, 1.0 / ratio)):
            text = BASE + written_block(rectangle(0.0, 0.0, width, height))
            weight = WEIGHT * width * height
            for geometry, young in GEOMETRIES:
                if geometry == "current" and name == "upright" and ratio > 1e4:
                    continue
                yield block_scene(
                    "slender block", f"{ratio:g}, {name}, {geometry}", guard, text, weights([weight], 1e-6),
                    material={"unit_weight": WEIGHT, "young": young, "poisson": 0.0}, analysis={"geometry": geometry})
    for thickness in (1e-3, 1e-5, 1e-7):
        layers = rectangle(-0.5, 0.0, 1.0, thickness), rectangle(-0.5, thickness, 1.0, 1.0)
        for geometry, young in GEOMETRIES:
            yield block_scene(
                "slender block", f"a block on a sheet of {thickness:g} m, {geometry}", guard,
                BASE + "".join(map(written_block, layers)), weights([WEIGHT * (1.0 + thickness), WEIGHT], 1e-6),
                material={"unit_weight": WEIGHT, "young": young, "poisson": 0.0}, analysis={"geometry": geometry})


def _far_away() -> Iterator[Scene]:
    """Places far from zero, models of a nanometre and of a thousand kilometres."""
    guard = "an origin of their own for blocks far away"
    for offset in (1e3, 1e5, 1e7):
        for size in (1.0, 0.1):
            base = rectangle(offset - 10.0 * size, offset - size, 20.0 * size, size)
            text = written_block(base, "fixed")
            for i in range(3):
                text += written_block(rectangle(offset, offset + i * size, size, size))
            name = f"three cubes of {size:g} m at {offset:g} m, pushed"
            exact = 1.0 / 3.0
            for geometry, young in GEOMETRIES:
                # the corners are rounded to the spacing of numbers at their place
                spacing = 4.0 * math.ulp(offset) / size
                far = block_scene(
                    "far away", f"{name}, {geometry}", guard, text,
                    Shifted(exact, (1e-8 if geometry == "reference" else 1e-4) + spacing), joint={"friction_deg": 60.0},
                    material={"unit_weight": WEIGHT, "young": young}, analysis={"geometry": geometry},
                    search={"parameter": "horizontal_coefficient"}
                )
                yield far
    for scale in (1e-9, 1e-6, 1e6):
        text = written_block([(x * scale, y * scale) for x, y in rectangle(-9, -1, 19, 1)], "fixed")
        for i in range(3):
            text += written_block(rectangle(0.0, i * scale, scale, scale))
        for geometry, young in GEOMETRIES:
            yield block_scene(
                "far away", f"three cubes of {scale:g} m, pushed, {geometry}", "every threshold is a ratio", text,
                Shifted(1.0 / 3.0, 1e-8 if geometry == "reference" else 1e-4), joint={"friction_deg": 60.0},
                material={"unit_weight": WEIGHT, "young": young * scale}, analysis={"geometry": geometry},
                search={"parameter": "horizontal_coefficient"}
            )


def _directions() -> Iterator[Scene]:
    """Gravity up, to the side, and turned together with the scene."""
    guard = "nothing knows which way is down"
    for geometry, young in GEOMETRIES:
        more = {"analysis": {"geometry": geometry}, "material": {"young": young}}
        for direction in (90.0, 0.0, 180.0):
            yield block_scene(
                "direction", f"a cube, gravity {direction:g} deg, {geometry}", guard, tower([1.0]),
                Verdict("collapsed"), load={"gravity_direction_deg": direction}, **more)
        for turn in (17.3, 90.0, 180.0, -133.0):
            c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))

            def turned(corners: Corners, c: float = c, s: float = s) -> Corners:
                return [(c * x - s * y, s * x + c * y) for x, y in corners]

            text = written_block(turned(rectangle(-10.0, -1.0, 20.0, 1.0)), "fixed")
            for i in range(3):
                text += written_block(turned(rectangle(0.0, i * 1.0, 1.0, 1.0)))
            for lean, word in ((-18.4, "stable"), (-18.5, "collapsed")):
                yield block_scene(
                    "direction", f"three cubes leaning by {-lean:g} of 18.435 deg, turned {turn:g}, {geometry}", guard,
                    text, Verdict(word), joint={"friction_deg": 60.0},
                    load={"gravity_direction_deg": (turn - 90.0 + lean + 360.0) % 360.0}, **more)
