"""Blocks dropped on resting blocks, and impacts of several bodies at once: closed forms and invariants."""

from __future__ import annotations

import math
import random

from bounces import SLOWEST, bounced
from polygons import FLOOR, G, polygon
from scene import Check, Run, Scene, block
from states import EXACT, State, end_checks, in_time, measured, moving, properties, rectangle, turned


def groups(friction: float, gravity: float, energy: bool = False) -> str:
    """Friction, gravity and output."""
    return (f"&joint friction_deg = {friction!r} /\n&load gravity = {gravity!r} /\n"
            + "&output energy = .true. /\n" * energy)


def drop_on_resting(pick: random.Random) -> Scene:
    """Several piles: blocks rest on one another, and one falls flat on each pile and bounces."""
    restitution, friction = pick.choice([0.3, 0.5, 0.8, 1.0]), pick.choice([0.0, 0.0, 20.0])
    duration = pick.uniform(0.5, 0.8 if restitution < 0.5 else 1.2)
    text, points, checks, number, moved = "", "", [], 2, 0
    for pile in range(pick.randint(1, 3)):
        low, width = 0.0, pick.uniform(0.6, 1.5)
        for _ in range(pick.randint(1, 3)):
            tall = pick.uniform(0.3, 1.0)
            shape = rectangle(4.0 * pile - width / 2.0, low, width, tall)
            low += tall
            text += block(shape)
            points += measured(number, shape)
            _, (x, y), _ = properties(shape)
            checks += end_checks(moved, shape, State(x, y), (1.0, 3.0))
            number, moved = number + 1, moved + 1
        while True:
            gap = pick.uniform(0.1, 1.5)
            end, speed, slowest = bounced(gap, 0.0, G, restitution, duration)
            if slowest > 2.0 * SLOWEST:
                break
        # its centre is above the block that it falls on: the impulses at the two corners are positive
        shape = rectangle(4.0 * pile - pick.uniform(0.2, 0.3) * width, low + gap, 0.5 * width, pick.uniform(0.3, 1.0))
        _, (x, y), _ = properties(shape)
        text += block(shape)
        points += measured(number, shape)
        checks += end_checks(moved, shape, State(x, y - gap + end, 0.0, 0.0, speed), (1.0, 3.0))
        number, moved = number + 1, moved + 1
    return Scene(block(FLOOR, "fixed") + text + points, in_time(pick, duration, restitution), checks,
                 groups(friction, G), {"young": 1e12}, is_step_free=True)


def momenta(count: int, masses: list[float]) -> dict[str, object]:
    """Functions that read the momentum of a run along x and y."""
    def along(name: str) -> object:
        return lambda run: sum(mass * run.points[2 * k][-1][name] for k, mass in enumerate(masses[:count]))
    return {"x": along("vx"), "y": along("vy")}


def risen(run: Run) -> float:
    """Largest rise of the sum of the energies from one step to the next, over the first."""
    total = [row["kinetic"] + row["gravity"] + row["elastic"] + row["contact"] for row in run.energy]
    return max(0.0, *(b - a for a, b in zip(total, total[1:]))) / run.energy[0]["kinetic"]


def cluster(pick: random.Random) -> Scene:
    """Blocks that touch are hit, or several meet at once, in free flight: momentum stays and energy never rises."""
    restitution, friction = pick.choice([0.0, 0.4, 0.8, 1.0]), pick.choice([0.0, 0.0, 20.0, 40.0])
    count, width, gap = pick.randint(2, 4), pick.uniform(0.4, 1.0), pick.uniform(0.1, 0.4)
    tall, text, points, masses, speeds = pick.uniform(0.4, 1.0), "", "", [], []
    shapes = [rectangle(k * width, 0.0, width, tall) for k in range(count)]
    shapes.insert(0, rectangle(-gap - width, 0.0, width, tall))
    if pick.random() < 0.5:
        shapes.append(rectangle(count * width + gap, 0.0, width, tall))
    angle = pick.uniform(-math.pi, math.pi)
    for k, shape in enumerate(shapes):
        density = pick.choice([2240.0, pick.uniform(1000.0, 8000.0)])
        v = 2.0 if k == 0 else (-2.0 if k == count + 1 else 0.0)
        shape, ((vx, vy),) = turned(shape, angle), turned([(v, 0.0)], angle)
        text += f"material {k + 2} density {density!r}\n" + moving(shape, (vx, vy, 0.0), f"material {k + 2}")
        points += measured(k + 1, shape)
        masses.append(density * width * tall)
        speeds.append((vx, vy))
    size = 2.0 * sum(masses[::max(1, count)])
    checks = invariants(masses, speeds, size)
    if restitution == 1.0 and friction == 0.0:
        checks.append(kept_energy())
    return Scene(text + points, in_time(pick, 0.4, restitution), checks, groups(friction, 0.0, True), {"young": 1e12})


def invariants(masses: list[float], speeds: list[tuple[float, float]], size: float) -> list[Check]:
    """Checks of momentum and energy."""
    found = [Check(f"momentum along {name}", function, sum(m * v[k] for m, v in zip(masses, speeds)), 1e-10 * size,
                   "forces on two blocks are equal and opposite to rounding")
             for k, (name, function) in enumerate(momenta(len(masses), masses).items())]
    return [*found, Check("rise of energy", risen, 0.0, 1e-9, "impacts and friction only take energy", truncation=1e-6)]


def kept_energy() -> Check:
    """A check that the energy of motion stays."""
    return Check("energy of motion over the first", lambda run: run.energy[-1]["kinetic"] / run.energy[0]["kinetic"],
                 1.0, EXACT, "restitution 1 without friction takes no energy")


def swarm(pick: random.Random) -> Scene:
    """Spinning polygons fly towards one another without gravity: momentum stays, energy never rises or stays."""
    restitution, friction = pick.choice([0.3, 0.7, 1.0, 1.0]), pick.choice([0.0, 0.0, 30.0])
    text, points, masses, speeds = "", "", [], []
    for k in range(pick.randint(3, 7)):
        shape = turned(polygon(pick, pick.uniform(0.3, 0.6)), pick.uniform(-math.pi, math.pi))
        x, y = 1.6 * math.cos(0.9 * k) * (1.0 + 0.3 * k), 1.6 * math.sin(0.9 * k) * (1.0 + 0.3 * k)
        shape = [(px + x, py + y) for px, py in shape]
        speed = pick.uniform(1.0, 3.0) / math.hypot(x, y)
        density, spin = pick.uniform(1000.0, 8000.0), pick.uniform(-3.0, 3.0)
        text += f"material {k + 2} density {density!r}\n"
        text += moving(shape, (-x * speed, -y * speed, spin), f"material {k + 2}")
        points += measured(k + 1, shape)
        masses.append(density * properties(shape)[0])
        speeds.append((-x * speed, -y * speed))
    checks = invariants(masses, speeds, 3.0 * sum(masses))
    if restitution == 1.0 and friction == 0.0:
        checks.append(kept_energy())
    return Scene(text + points, in_time(pick, pick.uniform(0.8, 2.0), restitution), checks,
                 groups(friction, 0.0, True), {"young": 1e12})


def symmetric_meeting(pick: random.Random) -> Scene:
    """A block and its two mirror images meet at once: the answer is its own mirror image."""
    restitution, friction = pick.choice([0.0, 0.3, 0.7, 1.0]), pick.choice([0.0, 20.0, 40.0])
    half, tall, low = pick.uniform(0.3, 0.8), pick.uniform(0.4, 1.0), pick.uniform(0.05, 0.5)
    gap, reach, speed = pick.uniform(0.1, 0.3), pick.uniform(0.4, 1.0), pick.uniform(0.5, 2.0)
    left = rectangle(-half - gap - reach, low, reach, pick.uniform(0.3, 1.0))
    right = [(-x, y) for x, y in reversed(left)]
    middle = rectangle(-half, 0.0, 2.0 * half, tall)
    text = block(FLOOR, "fixed") + moving(left, (speed, 0.0, 0.0)) + block(middle) + moving(right, (-speed, 0.0, 0.0))
    text += measured(2, left) + measured(3, middle) + measured(4, right)
    keys = in_time(pick, gap / speed + pick.uniform(0.02, 0.1), restitution)

    def sum_of(name: str, sign: float) -> Check:
        return Check(f"{name} of mirror images", lambda run: run.points[0][-1][name] - sign * run.points[4][-1][name],
                     0.0, EXACT * speed, "a symmetric scene has a symmetric answer")

    middle_x = Check("vx of the middle", lambda run: run.points[2][-1]["vx"], 0.0, EXACT * speed, "symmetry")
    return Scene(text, keys, [sum_of("vx", -1.0), sum_of("vy", 1.0), middle_x], groups(friction, 0.0), {"young": 1e12})


FAMILIES = {"drop_on_resting": drop_on_resting, "cluster": cluster, "swarm": swarm,
            "symmetric_meeting": symmetric_meeting}
