"""Blocks that fall flat on a smooth floor, bounce and slide, or fly past: closed forms, gravity of any direction."""

from __future__ import annotations

import math
import random

from scene import Scene, block
from states import State, end_checks, in_time, measured, moving, properties, rectangle, turned

G = 9.81
#: No impact is slower [m/s]: below twice the speed of free fall in a step, 0.08 m/s at 4 ms, blocks do not rebound
SLOWEST = 0.1


def bounced(height: float, speed: float, gravity: float, restitution: float, time: float) -> tuple[float, float, float]:
    """Height, upward speed, and slowest impact of a point above a floor; it ends at an impact that is too slow."""
    slowest = math.inf
    while slowest > SLOWEST:
        impact = math.sqrt(speed**2 + 2.0 * gravity * height)
        flight = (speed + impact) / gravity
        if flight > time:
            return height + speed * time - gravity * time**2 / 2.0, speed - gravity * time, slowest
        slowest = min(slowest, impact)
        time, height, speed = time - flight, 0.0, restitution * impact
    return height, speed, slowest


def rotated_bounce(pick: random.Random) -> Scene:
    """A block that falls along the normal of a smooth floor of any direction, and slides along it."""
    while True:
        angle, restitution = pick.uniform(-math.pi, math.pi), pick.choice([0.3, 0.5, 0.8, 1.0])
        width, tall, height = (pick.uniform(0.3, 2.0) for _ in range(3))
        along, up = pick.uniform(-2.0, 2.0), pick.uniform(-2.0, 2.0)
        time = math.sqrt(2.0 * height / G) * pick.uniform(1.2, 4.0)
        end, speed, slowest = bounced(height, up, G, restitution, time)
        if slowest > SLOWEST:
            break
    corners = rectangle(-width / 2.0, height, width, tall)
    _, (x, y), _ = properties(corners)
    floor = turned(rectangle(-20.0, -1.0, 40.0, 1.0), angle)
    ((vx, vy), (ex, ey), (evx, evy)) = turned([(along, up), (along * time, y + end - height), (along, speed)], angle)
    shape = turned(corners, angle)
    blocks = block(floor, "fixed") + moving(shape, (vx, vy, 0.0)) + measured(2, shape)
    direction = math.remainder(math.degrees(angle) - 90.0, 360.0)
    fastest = max(abs(along), math.sqrt(up**2 + 2.0 * G * height))
    return Scene(
        blocks, in_time(pick, time, restitution),
        end_checks(0, shape, State(ex, ey, 0.0, evx, evy), (height, fastest)),
        f"&joint friction_deg = 0 /\n&load gravity = {G}, gravity_direction_deg = {direction!r} /\n",
        {"young": 1e12}, is_step_free=True)


def flight(pick: random.Random) -> Scene:
    """A block that flies towards another one and falls past the level of its top, but is not yet there.

    No side of the two is crossed while the gap between them lasts: the block falls freely.
    """
    angle, friction = pick.uniform(-math.pi, math.pi), pick.choice([0.0, 30.0, 60.0, 80.0])
    width, tall = pick.uniform(0.3, 2.0), pick.uniform(0.3, 2.0)
    gap, time = pick.uniform(0.01, 0.3), pick.uniform(2e-3, 2e-2)
    along = gap / time * pick.uniform(0.3, 0.99)
    fallen = G * time**2 / 2.0
    # level with the top at some time of the flight
    corners = rectangle(-width, fallen * pick.random(), width, tall)
    _, (x, y), _ = properties(corners)
    below = turned(rectangle(gap, -2.0, pick.uniform(0.3, 3.0), 2.0), angle)
    shape, ((vx, vy), (ex, ey), (evx, evy)) = turned(corners, angle), turned(
        [(along, 0.0), (x + along * time, y - fallen), (along, -G * time)], angle)
    direction = math.remainder(math.degrees(angle) - 90.0, 360.0)
    return Scene(
        block(below, "fixed") + moving(shape, (vx, vy, 0.0)) + measured(2, shape), in_time(pick, time, 0.0),
        end_checks(0, shape, State(ex, ey, 0.0, evx, evy), (gap, along)),
        f"&joint friction_deg = {friction} /\n&load gravity = {G}, gravity_direction_deg = {direction!r} /\n",
        {"young": 1e12}, is_step_free=True)


FAMILIES = {"rotated_bounce": rotated_bounce, "flight": flight}
