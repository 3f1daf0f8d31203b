"""Trains of blocks on level floors, between walls or in free flight: one dimension, exact event by event."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field

from scene import Check, Run, Scene, block
from states import EXACT, ROUNDING, State, end_checks, in_time, measured, moving, rectangle

G = 9.81
#: No blocks meet more slowly [m/s]: below twice the speed of free fall in a step, 0.08 m/s at 4 ms, they do not rebound
SLOWEST = 0.1
APART = 1e-4  #: Impacts of one block are farther apart in time [s], and none is nearer to the end of the run


TOUCH = 1e-12  #: Gap [m] and approach speed [m/s] of rounding


@dataclass
class Train:
    """Blocks in a row: left ends, widths, masses and velocities; walls have infinite mass."""

    left: list[float]
    width: list[float]
    mass: list[float]
    speed: list[float]
    restitution: float
    friction: float = 0.0  #: Deceleration of sliding blocks [m/s2]
    time: float = 0.0
    #: Time of the last impact of each block, and the slowest approach and the shortest time between impacts of a block
    struck: list[float] = field(default_factory=list)
    slowest: float = math.inf
    apart: float = math.inf
    impacts: int = 0
    stops: int = 0

    def advance(self, h: float) -> None:
        """Move for a time without impacts."""
        for k, v in enumerate(self.speed):
            slide = min(h, abs(v) / self.friction) if self.friction > 0.0 and v != 0.0 else h
            slowing = math.copysign(self.friction, v) if v != 0.0 else 0.0
            self.left[k] += v * slide - slowing * slide**2 / 2.0
            self.speed[k] = 0.0 if slide < h else v - slowing * h
            self.stops += slide < h
        self.time += h

    def meet(self, k: int) -> float:
        """Time until block k meets the next one."""
        gap = self.left[k + 1] - self.left[k] - self.width[k]
        if gap <= TOUCH and self.speed[k] - self.speed[k + 1] > TOUCH:
            return 0.0  # blocks that touch after a plastic impact
        found, past = math.inf, 0.0
        # between the times at which one of the two stops, the relative motion is a parabola
        stops = [abs(self.speed[i]) / self.friction for i in (k, k + 1)] if self.friction > 0.0 else [math.inf] * 2
        for end in sorted({*stops, math.inf}):
            v, a, x = 0.0, 0.0, gap
            for i, sign in ((k, -1.0), (k + 1, 1.0)):
                u, t = self.speed[i], min(past, stops[i - k])
                slowing = math.copysign(self.friction, u) if u != 0.0 else 0.0
                x += sign * (u * t - slowing * t * t / 2.0)
                if past < stops[i - k]:
                    v += sign * (u - slowing * past)
                    a -= sign * slowing
            for root in _roots(a / 2.0, v, x):
                if root <= end - past and v + a * root < 0.0:
                    found = min(found, past + root)
            past = end
            if found < math.inf:
                break
        return found

    def run(self, duration: float) -> None:
        """Move for a time, one impact after the other."""
        self.struck = [-math.inf] * len(self.left)
        while True:
            times = [self.meet(k) for k in range(len(self.left) - 1)]
            first = min(times, default=math.inf)
            if self.time + first > duration or self.impacts > 1000:
                self.apart = min([self.apart, *(duration - t for t in self.struck)])
                self.advance(duration - self.time)
                return
            k = times.index(first)
            self.advance(first)
            self.hit(k)

    def hit(self, k: int) -> None:
        """Impact of block k on the next one."""
        before = self.speed[k] - self.speed[k + 1]
        one, two = 1.0 / self.mass[k], 1.0 / self.mass[k + 1]
        impulse = (1.0 + self.restitution) * before / (one + two)
        self.speed[k] -= impulse * one
        self.speed[k + 1] += impulse * two
        self.slowest = min(self.slowest, before)
        self.apart = min(self.apart, self.time - self.struck[k], self.time - self.struck[k + 1])
        self.struck[k] = self.struck[k + 1] = self.time
        self.impacts += 1


def _roots(a: float, b: float, c: float) -> list[float]:
    """Positive roots of a t2 + b t + c, without cancellation."""
    if a == 0.0:
        return [-c / b] if b < 0.0 <= c else []
    under = b * b - 4.0 * a * c
    if under < 0.0:
        return []
    q = -(b + math.copysign(math.sqrt(under), b)) / 2.0
    return [root for root in (q / a, c / q if q != 0.0 else -1.0) if root > 0.0]


@dataclass
class Options:
    """What a train is like."""

    count: tuple[int, int] = (2, 4)
    friction_deg: float = 0.0
    has_gravity: bool | None = None
    has_walls: bool | None = False
    whole_steps: bool = False
    restitution: tuple[float, ...] = (0.0, 0.2, 0.5, 0.7, 1.0)
    rows: int = 1
    may_stop: bool = True
    is_second_order: bool = False  #: Whether blocks stop within steps, for which the integration is of second order


def draw(pick: random.Random, options: Options, restitution: float) -> tuple[Train, list[float], float, float]:
    """A train before its motion, its densities, its height, and its longest step."""
    count, height = pick.randint(*options.count), pick.uniform(0.3, 1.5)
    step = pick.choice([4e-3, 2e-3, 1e-3, 2.5e-3])
    mu = math.tan(math.radians(options.friction_deg))
    # a narrower block tips over as friction slows its foot
    widths = [max(pick.uniform(0.3, 1.2), 1.1 * mu * height) for _ in range(count)]
    densities = [pick.choice([2400.0, pick.uniform(1000.0, 9000.0)]) for _ in range(count)]
    speeds = [pick.uniform(-2.0, 2.0) if pick.random() < 0.6 else 0.0 for _ in range(count)]
    speeds[0] = pick.uniform(0.5, 3.0)
    gaps = [pick.uniform(0.05, 0.8) for _ in range(count)]
    if options.whole_steps:
        gaps = [pick.randint(20, 200) * step * abs(speeds[k] - speeds[(k + 1) % count]) or 0.3 for k in range(count)]
    lefts = [0.0]
    for k in range(count - 1):
        lefts.append(lefts[-1] + widths[k] + gaps[k])
    masses = [w * height * d for w, d in zip(widths, densities)]
    if options.has_walls or (options.has_walls is None and pick.random() < 0.5):
        lefts = [lefts[0] - gaps[-1] - 1.0, *lefts, lefts[-1] + widths[-1] + pick.uniform(0.05, 0.8)]
        widths, speeds, densities = [1.0, *widths, 1.0], [0.0, *speeds, 0.0], [0.0, *densities, 0.0]
        masses = [math.inf, *masses, math.inf]
    return Train(lefts, widths, masses, speeds, restitution, mu * G), densities, height, step


@dataclass
class Row:
    """A train before and after its motion."""

    begun: Train
    ended: Train
    densities: list[float]
    height: float
    step: float


def row_of(pick: random.Random, options: Options, restitution: float, duration: float) -> Row | None:
    """A row whose answer is sharp, or nothing after some tries."""
    for _ in range(20):
        begun, densities, height, step = draw(pick, options, restitution)
        ended = Train(begun.left[:], begun.width[:], begun.mass[:], begun.speed[:], restitution, begun.friction)
        ended.run(duration)
        if ended.slowest > SLOWEST and ended.apart > APART and 1 <= ended.impacts <= 30 and (
                options.may_stop or not ended.stops):
            return Row(begun, ended, densities, height, step)
    return None


def accuracy(row: Row, options: Options) -> tuple[tuple[float, float], float, str]:
    """Length and speed of a tolerance, the tolerance, and its reason."""
    if not options.is_second_order:
        return (0.3, max(map(abs, row.begun.speed))), EXACT, ROUNDING
    # a way of a dt2/8 for each stop; the next impact is later by that over its speed
    way = (1 + row.ended.stops) * row.ended.friction * row.step**2
    return (way, way * row.ended.friction / SLOWEST), 1.0, "second order in the step where blocks stop within a step"


def train(pick: random.Random, options: Options) -> Scene:
    """Rows of blocks that meet face to face; several rows stand beside one another on one floor."""
    restitution = pick.choice(options.restitution)
    gravity = pick.random() < 0.6 if options.has_gravity is None else options.has_gravity
    rows: list[Row | None] = [None]
    while None in rows:
        duration = pick.uniform(0.2, 1.3)
        rows = [row_of(pick, options, restitution, duration) for _ in range(options.rows)]
    blocks, materials, points, checks, number, offset = "", "", "", [], 2, 0.0
    masses, momentum, size = [], 0.0, 0.0
    for row in filter(None, rows):
        begun, ended = row.begun, row.ended
        offset -= min(*begun.left, *ended.left) - 1.0
        scale, tolerance, reason = accuracy(row, options)
        for k, density in enumerate(row.densities):
            corners = rectangle(offset + begun.left[k], 0.0, begun.width[k], row.height)
            if density == 0.0:
                blocks += block(corners, "fixed")
            else:
                materials += f"material {number} density {density!r}\n"
                blocks += moving(corners, (begun.speed[k], 0.0, 0.0), f"material {number}")
                points += measured(number, corners)
                expected = State(offset + ended.left[k] + ended.width[k] / 2.0, row.height / 2.0, 0.0, ended.speed[k])
                checks += end_checks(len(masses), corners, expected, scale, tolerance, reason)
                momentum += begun.mass[k] * begun.speed[k]
                size += begun.mass[k] * abs(begun.speed[k])
                masses.append(begun.mass[k])
            number += 1
        offset += max(left + width for left, width in zip(begun.left + ended.left, begun.width * 2)) + 1.0
    if options.friction_deg == 0.0 and all(0.0 not in row.densities for row in filter(None, rows)):
        checks.append(Check("momentum", lambda run: sum(m * run.points[2 * k][-1]["vx"] for k, m in enumerate(masses)),
                            momentum, 1e-10 * size, "forces on two blocks are equal and opposite to rounding"))
    floor = rectangle(-30.0, -1.0, offset + 60.0, 1.0)
    keys = {**in_time(pick, duration, restitution), "time_step": min(row.step for row in filter(None, rows))}
    return Scene(f"{materials}{block(floor, 'fixed')}{blocks}{points}", keys, checks,
                 f"&joint friction_deg = {options.friction_deg!r} /\n&load gravity = {G if gravity else 0.0} /\n",
                 {"young": 1e12}, is_step_free=not options.is_second_order, is_second_order=options.is_second_order)


def last_energy(run: Run) -> float:
    """Energy of motion at the end over that at the beginning."""
    return run.energy[-1]["kinetic"]


def elastic_row(pick: random.Random) -> Scene:
    """Elastic blocks between walls: a hundred impacts keep the energy."""
    while True:
        begun, densities, height, step = draw(pick, Options(has_walls=True, count=(1, 3)), 1.0)
        energy = sum(m * v * v for m, v in zip(begun.mass, begun.speed) if m < math.inf) / 2.0
        duration, ended = 1.0, begun
        while ended.impacts < 100 and duration < 40.0:
            duration *= 1.3
            ended = Train(begun.left[:], begun.width[:], begun.mass[:], begun.speed[:], 1.0)
            ended.run(duration)
        if ended.slowest > SLOWEST and ended.apart > APART and 100 <= ended.impacts < 150:
            break
    text = block(rectangle(-30.0, -1.0, 90.0, 1.0), "fixed")
    for k, density in enumerate(densities):
        corners = rectangle(begun.left[k], 0.0, begun.width[k], height)
        text += block(corners, "fixed") if density == 0.0 else (
            moving(corners, (begun.speed[k], 0.0, 0.0), f"material {k + 2}")
            + f"material {k + 2} density {density!r}\n")
    check = Check("kinetic energy", last_energy, energy, 1e-6 * energy, "restitution 1 takes no energy of 100 impacts")
    return Scene(text, {**in_time(pick, duration, 1.0), "time_step": step}, [check],
                 f"&joint friction_deg = 0 /\n&load gravity = {pick.choice([0.0, G])} /\n&output energy = .true. /\n",
                 {"young": 1e12})


FAMILIES = {
    "train": lambda pick: train(pick, Options()),
    "train_walls": lambda pick: train(pick, Options(has_walls=True, count=(1, 3))),
    "train_whole_steps": lambda pick: train(pick, Options(whole_steps=True, has_walls=None)),
    "train_nearly_smooth": lambda pick: train(pick, Options(friction_deg=0.001, has_gravity=True, has_walls=None)),
    "train_rough": lambda pick: train(pick, Options(friction_deg=20.0, has_gravity=True, has_walls=None,
                                                    restitution=(0.2, 0.5, 0.8), may_stop=False)),
    "train_stops": lambda pick: train(pick, Options(friction_deg=20.0, has_gravity=True, has_walls=None,
                                                    restitution=(0.2, 0.5, 0.8), is_second_order=True)),
    "train_rows": lambda pick: train(pick, Options(rows=3, has_walls=None, count=(2, 3))),
    "elastic_row": elastic_row,
}
