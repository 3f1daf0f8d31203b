"""Stacks of slabs that stick and slip on shaking ground, beside an integrator in one dimension.

The ground's acceleration is linear between the times of a record. Between events each slab has an acceleration that
is linear, too: positions are cubic in time, and events are roots of quadratics. An event is the end of a slip, or a
friction force that reaches its limit.
"""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scene import Scene, block
from states import State, end_checks, in_time, measured, rectangle

Array = NDArray[np.float64]
G = 9.81
REASON = "second order in the step: a slip may turn late by as much as an acceleration that changes is off in the step"
#: Time by which the laws of contact are applied after an event [s], and slip that counts as none there [m/s]
LATER, STILL = 1e-9, 1e-12
#: Largest slip of a slab on another [m]: with two of it a slab of 2 m still has its weight above the one below
FARTHEST = 0.4


@dataclass
class Stack:
    """Slabs on the ground, from the bottom to the top; joint k is below slab k."""

    mass: Array
    friction: Array
    place: Array  #: Places and speeds against the ground [m, m/s]
    speed: Array
    farthest: float = 0.0  #: Largest slip of a slab on another so far [m]

    @property
    def limit(self) -> Array:
        """Largest friction force of each joint."""
        return self.friction * G * np.cumsum(self.mass[::-1])[::-1]

    def forces(self, shake: float, states: Sequence[int]) -> tuple[Array, Array]:
        """Accelerations and forces of friction; states are the directions of slip, 0 for none."""
        n = len(self.mass)
        # unknowns: accelerations, then forces; slab k is pulled by joints k and k + 1
        matrix, right = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
        for k, state in enumerate(states):
            matrix[k, k], matrix[k, n + k], right[k] = self.mass[k], -1.0, -self.mass[k] * shake
            if k + 1 < n:
                matrix[k, n + k + 1] = 1.0
            if state:
                matrix[n + k, n + k], right[n + k] = 1.0, -state * self.limit[k]
            else:
                matrix[n + k, k] = 1.0
                if k:
                    matrix[n + k, k - 1] = -1.0
        found = np.linalg.solve(matrix, right)
        return found[:n], found[n:]

    def states(self, shake: float) -> list[int]:
        """Directions of slip that obey Coulomb's law."""
        slip = np.diff(self.speed, prepend=0.0)
        known = [[int(np.sign(s))] if abs(s) > STILL else [0, -1, 1] for s in slip]
        for states in itertools.product(*known):
            rates, forces = self.forces(shake, states)
            starts = np.diff(rates, prepend=0.0)
            if all(abs(f) <= t if not s else abs(v) > STILL or s * a > 0.0
                   for s, f, t, v, a in zip(states, forces, self.limit, slip, starts)):
                return list(states)
        raise ArithmeticError("no state obeys Coulomb's law")

    def advance(self, start: float, shake: tuple[float, float], length: float) -> int:
        """Move while the ground's acceleration is linear, from the first value to the second; number of events."""
        time, events = 0.0, 0
        rise = (shake[1] - shake[0]) / length
        while time < length:
            states = self.states(shake[0] + rise * (time + LATER))
            rates, forces = self.forces(shake[0] + rise * time, states)
            rates_1, forces_1 = (end - now for end, now in zip(self.forces(shake[0] + rise * (time + 1.0), states),
                                                               (rates, forces)))
            slip = (np.diff(each, prepend=0.0) for each in (self.speed, rates, rates_1 / 2.0))
            turns = [min(after(c), default=math.inf) if s else math.inf for s, *c in zip(states, *slip)]
            yields = [min(after((f - t, f1, 0.0)) + after((f + t, f1, 0.0)), default=math.inf) if not s else math.inf
                      for s, f, f1, t in zip(states, forces, forces_1, self.limit)]
            h = min(*turns, *yields, length - time)
            self.place = self.place + h * (self.speed + h * (rates / 2.0 + h * rates_1 / 6.0))
            self.speed = self.speed + h * (rates + h * rates_1 / 2.0)
            self.farthest = max([self.farthest, *np.abs(np.diff(self.place))])
            for k, turn in enumerate(turns):
                # what comes to rest does so to the last digit
                if turn == h or not states[k]:
                    self.speed[k] = self.speed[k - 1] if k else 0.0
            time += h
            events += time < length
        return events

    def follow(self, record: Sequence[tuple[float, float]]) -> int:
        """Follow a record of times and accelerations; number of events."""
        return sum(self.advance(t, (a, b), u - t) for (t, a), (u, b) in itertools.pairwise(record))


def after(quadratic: Sequence[float]) -> list[float]:
    """Times beyond LATER at which c + b t + a t**2 is 0."""
    roots = np.roots(np.trim_zeros(np.array(quadratic)[::-1], "f"))
    return [float(t.real) for t in roots if abs(t.imag) < 1e-9 * abs(t) and t.real > LATER]


def stack(pick: random.Random, count: int) -> Scene:
    """Slabs that lie on one another, with another friction in each joint, on shaking ground."""
    tall, width = ([pick.uniform(*each) for _ in range(count)] for each in ((0.1, 0.25), (2.0, 3.0)))
    density = [pick.uniform(1500.0, 5000.0) for _ in range(count)]
    friction: list[float] = []
    while len(friction) < count:
        # joints of one friction would begin to slip at once
        friction += [f for f in [pick.uniform(5.0, 30.0)] if all(abs(f - other) > 2.0 for other in friction)]
    mass = np.array([d * w * h for d, w, h in zip(density, width, tall)])
    while True:
        times, most = [0.0], G * pick.uniform(0.3, 1.0)
        while times[-1] < 0.8:
            times.append(times[-1] + pick.uniform(0.05, 0.2))
        record = [(time, pick.uniform(-most, most)) for time in times]
        slabs = Stack(mass, np.tan(np.radians(friction)), np.zeros(count), np.zeros(count))
        events = slabs.follow(record)
        if slabs.farthest < FARTHEST:
            break
    keys = in_time(pick, times[-1], 0.0)
    step = float(str(keys["time_step"]))
    # a step has one acceleration: the speed of a linear one is off by at most so much within it
    steep = max(abs(b - a) / (u - t) for (t, a), (u, b) in itertools.pairwise(record))
    late = (1 + events) * steep * step**2 / 8.0
    text, checks, low = block(rectangle(-30.0, -1.0, 60.0, 1.0), "fixed"), [], 0.0
    text += "".join(f"material {k + 2} density {d!r}\n" for k, d in enumerate(density))
    text += "".join(f"joint {k + 1} {k + 2} friction_deg {f!r}\n" for k, f in enumerate(friction))
    for k in range(count):
        shape = rectangle(-width[k] / 2.0, low, width[k], tall[k])
        text += block(shape, f"material {k + 2}") + measured(k + 2, shape)
        end = State(float(slabs.place[k]), low + tall[k] / 2.0, 0.0, float(slabs.speed[k]))
        checks += end_checks(k, shape, end, (times[-1], 1.0), late, REASON, "x vx")
        low += tall[k]
    text += "base_acceleration\n" + "".join(f"{time!r} {rate!r} 0\n" for time, rate in record)
    return Scene(text, keys, checks, material={"young": 1e12}, is_second_order=True)


FAMILIES = {f"stack_{count}": lambda pick, count=count: stack(pick, count) for count in (1, 2, 3)}
