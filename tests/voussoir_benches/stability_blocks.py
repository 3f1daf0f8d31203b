"""Blocks of stiff and extreme scenes as their file has them, and what such scenes must answer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from voussoir_benches.checks import Check, verdict
from voussoir_benches.expectations import Measured
from voussoir_benches.measures import closed_force, pull, relative_rise, support
from voussoir_benches.scene import Corners, Scene, block_scene, rectangle, written_block

WEIGHT = 25000.0  #: Weight of a cubic metre of the decks that set it [N/m3]
STIFF = {"unit_weight": WEIGHT, "poisson": 0.0}  #: Material of blocks that press one another straight
BASE = written_block(rectangle(-10.0, -1.0, 20.0, 1.0), "fixed")  #: A base at height 0


def tower(widths: Sequence[float], words: Sequence[str] = ()) -> str:
    """Centred blocks 1 m high on one another on the base, from the lowest on."""
    return BASE + "".join(
        written_block(rectangle(-width / 2.0, i * 1.0, width, 1.0), words[i] if words else "")
        for i, width in enumerate(widths))


def heavy(ratio: float) -> str:
    """Material 2 of so many times the weight and mass of 1 N/m3 and kg/m3."""
    return f"material 2 unit_weight {ratio!r} density {ratio!r}\n"


def on_slope(slope_deg: float) -> str:
    """A block that does not topple on a slope."""
    return written_block(rectangle(0.0, 0.0, 1.0, 0.5 / math.tan(math.radians(slope_deg)) if slope_deg > 70.0 else 0.2))


def turned(corners: Corners, angle_deg: float) -> Corners:
    """Corners turned anticlockwise about the origin."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return [(c * x - s * y, s * x + c * y) for x, y in corners]


def wall(courses: int, bricks: int, length: float, height: float) -> list[Corners]:
    """Bricks in half bond."""
    found: list[Corners] = []
    for course in range(courses):
        odd = course % 2
        ends = [0.0, *((i + 0.5 * odd) * length for i in range(1 - odd, bricks)), bricks * length]
        found += [rectangle(left, course * height, right - left, height) for left, right in zip(ends, ends[1:])]
    return found


def stable(*checks: Check) -> Measured:
    """The scene stands, and quantities are as they must be."""
    return Measured((verdict("stable", "verdict"), *checks))


def weights(forces: Sequence[float], accept: float = 1e-8) -> Measured:
    """The scene stands, and the normal forces of its joints are the weights above them."""
    joints = enumerate(forces, 1)
    return stable(*(Check(f"N of joint {i} [N/m]", force, closed_force(i), accept) for i, force in joints))


def at_rest(weight: float) -> Measured:
    """The scene stands, its base carries the weight [N/m], and no joint pulls."""
    return stable(Check("force on the base [N/m]", weight, support, 1e-8),
                  Check("tension in a joint [N/m]", 0.0, pull, 0.0, scale=1.0))


def moving(
    group: str, name: str, guard: str, blocks: str, checks: Sequence[Check], step: float, duration: float,
    deck: dict[str, Any]
) -> Scene:
    """A scene of blocks that move in time, with its energies."""
    analysis = {
        "mode": "dynamic", "geometry": "current", "time_step": step, "duration": duration, "steps": 1000000,
        **deck.get("analysis", {})}
    output = {"joints": False, "condition": False, "energy": True}
    rise = Check("rise of energy over the speed's", 0.0, relative_rise, 1e-6, scale=1.0)
    answer = Measured((verdict("completed", "verdict"), *checks, rise))
    return block_scene(group, name, guard, blocks, answer, **{**deck, "analysis": analysis, "output": output})
