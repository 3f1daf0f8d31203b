"""Event-driven motion of rigid convex polygons, independent of the program.

Between events the equations of motion are integrated by Runge and Kutta's method of fourth order, exact for free
flight. Corners on edges carry forces that keep them apart, with Coulomb friction. An event is an impact or the end of a
slip. Impacts obey Newton's restitution on all contacts at once, with Coulomb's law between total impulses and the
velocities after it. `Ambiguous` is raised where the laws have no unique answer: scenes are drawn anew.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, nnls
from states import State, properties

Array = NDArray[np.float64]
Point = tuple[float, float]
#: Depth of an event, and distance that counts as contact, over the size of the smallest body
DEPTH, TOUCH = 1e-9, 1e-7
#: Speed that counts as none, and slack of laws of contact, over the largest speed or acceleration
SLOW, SLACK = 1e-8, 1e-7
FORCE = 1e-6  #: Force beyond the cones of friction that ends a state, over the largest
#: Largest turn of a body in a step [rad], longest step [s], and most steps of a run
TURN, STEP, MOST_STEPS = 0.02, 4e-3, 3000
#: States of a frictional contact
OPEN, STICK, SLIP_LEFT, SLIP_RIGHT = range(4)


class Ambiguous(Exception):
    """The laws of contact have no answer here, or several."""


def cross(a: Array, b: Array) -> float:
    """Cross product of two vectors."""
    return float(a[0] * b[1] - a[1] * b[0])


@dataclass
class Body:
    """A convex polygon; one of mass 0 is fixed."""

    shape: Array  #: Corners about the centre, anticlockwise
    mass: float
    inertia: float  #: Polar moment of inertia over the mass

    @staticmethod
    def of(points: Sequence[Point], density: float) -> tuple[Body, Array]:
        """Body of a polygon, and the place of its centre."""
        area, centre, polar = properties(points)
        return Body(np.array(points) - np.array(centre), density * area, polar), np.array([*centre, 0.0])


@dataclass(frozen=True)
class Contact:
    """A corner of one body at an edge of another."""

    one: int
    corner: int
    other: int
    edge: int


@dataclass
class World:
    """Bodies that move."""

    gravity: Point = (0.0, -9.81)
    restitution: float = 0.0
    friction: float = 0.0
    slowest: float = 0.0  #: Slower impacts have no answer: a bounce that dies away has impacts without end
    bodies: list[Body] = field(default_factory=list)
    #: Centre and turn of each body, and their rates: (bodies, 3)
    place: Array = field(default_factory=lambda: np.zeros((0, 3)))
    speed: Array = field(default_factory=lambda: np.zeros((0, 3)))
    time: float = 0.0
    #: Times of impacts and the greatest speed of approach of each
    impacts: list[tuple[float, float]] = field(default_factory=list)
    rolled: float = 0.0  #: Largest rate of turning of a body on a contact that stays [rad/s]
    lost: float = 0.0  #: Largest acceleration that ended as a corner slid off its edge
    last: dict[Contact, int] = field(default_factory=dict)  #: States of the last contact forces, tried first

    def add(self, points: Sequence[Point], velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
            density: float = 2400.0) -> None:
        """Add a block; one of density 0 is fixed."""
        body, place = Body.of(points, density)
        self.bodies.append(body)
        self.place = np.vstack([self.place, place])
        self.speed = np.vstack([self.speed, velocity])

    def state(self, number: int) -> State:
        """State of a body."""
        return State(*self.place[number].tolist(), *self.speed[number].tolist())

    def energy(self) -> float:
        """Energy of motion and of height."""
        mass, inertia = np.array([(body.mass, body.inertia) for body in self.bodies]).T
        twice = (self.speed[:, :2] ** 2).sum(axis=1) + inertia * self.speed[:, 2] ** 2
        return float(mass @ (twice / 2.0 - self.place[:, :2] @ self.gravity))

    @property
    def size(self) -> float:
        """Size of the smallest body that moves."""
        return min(float(np.abs(body.shape).max()) for body in self.bodies if body.mass > 0.0)

    @property
    def inverse_mass(self) -> Array:
        """Diagonal of the inverse of the mass matrix, over the largest inverse mass."""
        found = [[1.0 / b.mass, 1.0 / b.mass, 1.0 / (b.mass * b.inertia)] if b.mass > 0.0 else [0.0] * 3
                 for b in self.bodies]
        return np.array(found).ravel() * max(b.mass for b in self.bodies)

    def corners(self, place: Array) -> list[Array]:
        """Corners of the bodies."""
        return [body.shape @ np.array([[math.cos(q[2]), math.sin(q[2])], [-math.sin(q[2]), math.cos(q[2])]]) + q[:2]
                for body, q in zip(self.bodies, place)]

    def near(self, corners: list[Array]) -> Iterator[tuple[int, int, Array, Array, Array]]:
        """Pairs of bodies that are near: numbers, depths of corners of the first behind edges, edges, normals."""
        low, high = [c.min(axis=0) for c in corners], [c.max(axis=0) for c in corners]
        reach = 0.5 * self.size
        for i, j in itertools.permutations(range(len(corners)), 2):
            apart = (low[i] > high[j] + reach).any() or (low[j] > high[i] + reach).any()
            if not apart and self.bodies[i].mass + self.bodies[j].mass > 0.0:
                edges = np.roll(corners[j], -1, axis=0) - corners[j]
                length = np.hypot(edges[:, 0], edges[:, 1])[:, None]
                normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / length
                away = corners[i][:, None, :] - corners[j][None, :, :]
                yield i, j, (away * normals[None]).sum(axis=2), edges, normals

    def depths(self, place: Array) -> list[float]:
        """Depths to which pairs of bodies overlap: the least along the normals of both."""
        found = {pair: -self.size for pair in itertools.combinations(range(len(self.bodies)), 2)}
        apart: dict[tuple[int, int], float] = {}
        for i, j, gaps, _, _ in self.near(self.corners(place)):
            pair = min(i, j), max(i, j)
            apart[pair] = max(apart.get(pair, -math.inf), float(gaps.min(axis=0).max()))
        return list((found | {pair: -gap for pair, gap in apart.items()}).values())

    def touching(self) -> list[Contact]:
        """Contacts of corners that touch an edge from outside."""
        corners, found = self.corners(self.place), []
        near = TOUCH * self.size
        for i, j, gaps, edges, normals in self.near(corners):
            for corner, edge in zip(*np.nonzero(np.abs(gaps) < near)):
                length = float(np.hypot(*edges[edge]))
                along = float((corners[i][corner] - corners[j][edge]) @ edges[edge]) / length
                beside = (corners[i][corner - 1], corners[i][(corner + 1) % len(corners[i])])
                is_outside = all((p - corners[i][corner]) @ normals[edge] > -10.0 * near for p in beside)
                if -near < along < length + near and is_outside:
                    found.append(Contact(i, int(corner), j, int(edge)))
        return found

    def rows(self, contacts: list[Contact], place: Array, speed: Array) -> tuple[Array, Array, Array]:
        """Rows of normal and tangential relative motion of contacts, and their second rates at no acceleration."""
        corners, n = self.corners(place), 3 * len(self.bodies)
        normal, tangent, bent = np.zeros((len(contacts), n)), np.zeros((len(contacts), n)), np.zeros((len(contacts), 2))
        for k, c in enumerate(contacts):
            edge = corners[c.other][(c.edge + 1) % len(corners[c.other])] - corners[c.other][c.edge]
            t = edge / np.hypot(*edge)
            out = np.array([t[1], -t[0]])
            point = corners[c.one][c.corner]
            r, s = point - place[c.one, :2], point - place[c.other, :2]
            for rows, d in ((normal, out), (tangent, t)):
                rows[k, 3 * c.one:3 * c.one + 3] = *d, cross(r, d)
                rows[k, 3 * c.other:3 * c.other + 3] = *-d, -cross(s, d)
            w, z = speed[c.one, 2], speed[c.other, 2]
            slip = tangent[k] @ speed.ravel()
            # the frame of the edge turns: centripetal parts, and Coriolis' part of a corner that slides
            centripetal = -w * w * r + z * z * s
            bent[k] = out @ centripetal + 2.0 * z * slip, t @ centripetal
        return normal, tangent, bent

    def solve(self, free: Array, contacts: list[Contact], rows: tuple[Array, Array], least: Array, side: Array,
              slips: Array) -> Array:
        """Rates of motion nearest to the free ones that the laws of contact allow.

        `least` are the least normal rates, `side` the tangential rates of sticking contacts, `slips` the directions of
        slip that are known, or 0.
        """
        if self.friction == 0.0:
            root = np.sqrt(self.inverse_mass)
            return smooth(free, rows[0] * root, least - rows[0] @ free, root)
        if self.last.keys() == set(contacts):
            states = [self.last[c] for c in contacts]
            tried = self.rate(free, rows, least, side, states)
            if self.is_right(free, rows, least, side, slips, states, tried):
                return tried
        if len(contacts) > 4:
            raise Ambiguous("too many frictional contacts")
        found: list[Array] = []
        for states in itertools.product(range(4), repeat=len(contacts)):
            tried = self.rate(free, rows, least, side, states)
            if self.is_right(free, rows, least, side, slips, states, tried):
                scale = 1e-6 * (np.abs(tried).max() + np.abs(free).max() + 1e-12)
                if all(np.abs(tried - other).max() > scale for other in found):
                    found.append(tried)
                    self.last = dict(zip(contacts, states))
        if len(found) != 1:
            raise Ambiguous(f"{len(found)} answers")
        return found[0]

    def rate(self, free: Array, rows: tuple[Array, Array], least: Array, side: Array, states: Sequence[int]) -> Array:
        """Rates of motion of contacts with these states."""
        hold = held(rows, states)
        value = np.append(least[[s != OPEN for s in states]], side[[s == STICK for s in states]])
        if not len(hold):
            return free
        push = (self.rays(rows, states, sticks=False) * self.inverse_mass).T
        return free + push @ np.linalg.lstsq(hold @ push, value - hold @ free, rcond=1e-11)[0]

    def rays(self, rows: tuple[Array, Array], states: Sequence[int], sticks: bool) -> Array:
        """Directions of forces: of sticking contacts the edges of the friction cone, or else normal and tangent."""
        found, mu = [], self.friction
        for normal, tangent, state in zip(*rows, states):
            if state == STICK:
                found += [normal + mu * tangent, normal - mu * tangent] if sticks else [normal, tangent]
            elif state != OPEN:
                found.append(normal + (mu if state == SLIP_LEFT else -mu) * tangent)
        return np.array(found).reshape(-1, rows[0].shape[1])

    def is_right(self, free: Array, rows: tuple[Array, Array], least: Array, side: Array, slips: Array,
                 states: Sequence[int], rate: Array) -> bool:
        """Whether rates of motion obey the laws of contact in these states."""
        normal, tangent = rows
        slack = SLACK * (np.abs(least - normal @ free).max() + np.abs(tangent @ free).max() * (not slips.any()) + 1e-12)
        wanted = np.append(least[[s != OPEN for s in states]], side[[s == STICK for s in states]])
        hold = held(rows, states)
        if (normal @ rate < least - slack).any() or (len(hold) and np.abs(hold @ rate - wanted).max() > slack):
            return False
        for state, known, slip in zip(states, slips, tangent @ rate - side):
            direction = {SLIP_LEFT: -1.0, SLIP_RIGHT: 1.0, STICK: 0.0, OPEN: known}[state]
            if direction != known if known != 0.0 else direction != 0.0 and direction * slip < slack:
                return False
        return self.beyond(rows, states, rate - free) <= slack

    def beyond(self, rows: tuple[Array, Array], states: Sequence[int], change: Array) -> float:
        """Part of a change of rates that no forces within the cones of friction give."""
        moves, root = self.inverse_mass > 0.0, np.sqrt(self.inverse_mass)
        rays = (self.rays(rows, states, sticks=True) * root).T[moves]
        return float(nnls(rays, change[moves] / root[moves])[1]) if rays.size else 0.0

    def acceleration(self, contacts: list[Contact], place: Array, speed: Array, slips: Array | None = None) -> Array:
        """Accelerations under gravity and forces of contacts: (bodies, 3).

        With directions of slips the states of contacts are found, else they are kept.
        """
        free = np.array([[*self.gravity, 0.0] if b.mass > 0.0 else [0.0] * 3 for b in self.bodies]).ravel()
        if not contacts:
            return free.reshape(-1, 3)
        normal, tangent, bent = self.rows(contacts, place, speed)
        rows, least, side = (normal, tangent), -bent[:, 0], -bent[:, 1]
        if slips is None and self.friction > 0.0:
            return self.rate(free, rows, least, side, [self.last[c] for c in contacts]).reshape(-1, 3)
        known = np.zeros(len(contacts)) if slips is None else slips
        return self.solve(free, contacts, rows, least, side, known).reshape(-1, 3)

    @property
    def fastest(self) -> float:
        """Speed that others are compared with."""
        own = float(np.abs(self.speed[:, :2]).max() + np.abs(self.speed[:, 2]).max() * self.size)
        return own + math.sqrt(math.hypot(*self.gravity) * self.size) * 1e-2 + 1e-12

    def collide(self) -> list[Contact]:
        """Change velocities at contacts that close, and return the contacts that are left."""
        contacts = self.touching()
        if not contacts:
            return contacts
        normal, tangent, _ = self.rows(contacts, self.place, self.speed)
        before = self.speed.ravel()
        gap_rate = normal @ before
        closing = gap_rate < -SLOW * self.fastest
        if not closing.any():
            return [c for c, rate in zip(contacts, gap_rate) if rate < SLOW * self.fastest]
        self.impacts.append((self.time, float(-gap_rate.min())))
        if self.impacts[-1][1] < self.slowest:
            raise Ambiguous("a slow impact")
        least = np.where(closing, -self.restitution * gap_rate, np.minimum(0.0, -self.restitution * gap_rate))
        self.last, energy = {}, self.energy()
        nothing = np.zeros(len(contacts))
        self.speed = self.solve(before, contacts, (normal, tangent), least, nothing, nothing).reshape(-1, 3)
        self.last = {}
        if self.energy() > energy + 1e-9 * abs(energy):
            raise Ambiguous("restitution would bring in energy")
        return [c for c, rate in zip(contacts, normal @ self.speed.ravel()) if rate < SLOW * self.fastest]

    def step(self, contacts: list[Contact], h: float) -> tuple[Array, Array]:
        """Place and speed after a step of Runge and Kutta's method."""
        q, v = self.place, self.speed
        a1 = self.acceleration(contacts, q, v)
        a2 = self.acceleration(contacts, q + h / 2.0 * v, v + h / 2.0 * a1)
        a3 = self.acceleration(contacts, q + h / 2.0 * v + h * h / 4.0 * a1, v + h / 2.0 * a2)
        a4 = self.acceleration(contacts, q + h * v + h * h / 2.0 * a2, v + h * a3)
        return q + h * v + h * h / 6.0 * (a1 + a2 + a3), v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)

    def events(self, contacts: list[Contact], slips: Array, moved: tuple[Array, Array]) -> Array:
        """What ends a step, positive after it: depths, ways off edges, and forces beyond the cones of friction, over
        their tolerances, less 1, and slips that have slowed down to half of what counts as one."""
        deep = [*(d / DEPTH for d in self.depths(moved[0])), *(self.off_edge(c, moved[0]) / TOUCH for c in contacts)]
        normal, tangent, _ = self.rows(contacts, *moved)
        if self.friction > 0.0 and contacts:
            change = (self.acceleration(contacts, *moved) - self.acceleration([], *moved)).ravel()
            states = [self.last[c] for c in contacts]
            beyond = self.beyond((normal, tangent), states, change)
            deep.append(beyond / (FORCE * np.abs(change).max() + 1e-12) * self.size)
        slow = -tangent @ moved[1].ravel() * slips if slips.any() else np.zeros(0)
        return np.append(np.array(deep) / self.size - 1.0, slow / (SLOW * self.fastest) + 0.5)

    def off_edge(self, contact: Contact, place: Array) -> float:
        """How far a corner is beyond an end of its edge; negative between the ends."""
        way, edge = self.way_along(contact, place)
        return float(max(-way @ edge, (way - edge) @ edge)) / float(np.hypot(*edge))

    def until_event(self, contacts: list[Contact], slips: Array, h: float) -> tuple[float, tuple[Array, Array]]:
        """The step, or its part until just past the first event."""

        def past(part: float) -> float:
            # nothing has happened at the start: the last event lies just behind
            return float(self.events(contacts, slips, self.step(contacts, part)).max()) - 0.1 if part > 0.0 else -1.0

        # corners in flight may clip one another within a step
        end = next((k * h for k in ([1.0] if contacts else [0.25, 0.5, 0.75, 1.0]) if past(k * h) > 0.0), 0.0)
        part = brentq(past, 0.0, end, xtol=1e-15 * h) if end else h
        return part, self.step(contacts, part)

    def project(self) -> None:
        """Take the errors of integration from gaps and velocities of contacts that are kept."""
        contacts = [c for c in self.touching() if self.last.get(c) != OPEN]
        normal, tangent, _ = self.rows(contacts, self.place, self.speed)
        small, root = 1e-6 * self.fastest, np.sqrt(self.inverse_mass)
        kept = [k for k in range(len(contacts)) if abs(normal[k] @ self.speed.ravel()) < small]
        stuck = [k for k in kept if self.last.get(contacts[k]) == STICK
                 and abs(tangent[k] @ self.speed.ravel()) < small]
        if not kept:
            return
        rows = np.vstack([normal[kept], tangent[stuck]])
        back = np.linalg.lstsq(rows * root, rows @ self.speed.ravel(), rcond=1e-11)[0]
        self.speed = self.speed - (root * back).reshape(-1, 3)
        gaps = [self.gap(contacts[k]) for k in kept]
        back = np.linalg.lstsq(normal[kept] * root, np.array(gaps), rcond=1e-11)[0]
        self.place = self.place - (root * back).reshape(-1, 3)

    def way_along(self, contact: Contact, place: Array) -> tuple[Array, Array]:
        """The way from the start of an edge to a corner, and the edge."""
        one, other = (self.corners(place)[k] for k in (contact.one, contact.other))
        return one[contact.corner] - other[contact.edge], other[(contact.edge + 1) % len(other)] - other[contact.edge]

    def gap(self, contact: Contact) -> float:
        """Distance of a corner from the line of an edge."""
        way, edge = self.way_along(contact, self.place)
        return -cross(edge, way) / float(np.hypot(*edge))

    def run(self, duration: float) -> None:
        """Move for a time."""
        end = self.time + duration
        for _ in range(MOST_STEPS):
            if self.time >= end - 1e-15:
                return
            contacts = self.collide()
            slips = np.zeros(len(contacts))
            if contacts and self.friction > 0.0:
                slip = self.rows(contacts, self.place, self.speed)[1] @ self.speed.ravel()
                slips = np.where(np.abs(slip) > SLOW * self.fastest, np.sign(slip), 0.0)
            spin, speed = float(np.abs(self.speed[:, 2]).max()), float(np.abs(self.speed[:, :2]).max())
            h = min(STEP, end - self.time, TURN / (spin + 1e-9), 0.2 * self.size / (speed + 1e-9))
            most = float(np.abs(self.acceleration(contacts, self.place, self.speed, slips)).max())
            turning = [float(s) for c in contacts for s in np.abs(self.speed[[c.one, c.other], 2]) if s > 1e-6]
            self.rolled = max([self.rolled, *turning])
            self.project()
            part, (self.place, self.speed) = self.until_event(contacts, slips, h)
            self.lost = max([self.lost, *(most for c in contacts if self.off_edge(c, self.place) > TOUCH * self.size)])
            self.time += part
        raise Ambiguous("events without end")


def held(rows: tuple[Array, Array], states: Sequence[int]) -> Array:
    """Rows of motion that contacts with these states prescribe."""
    return np.vstack([rows[0][[s != OPEN for s in states]], rows[1][[s == STICK for s in states]]])


def smooth(free: Array, rows: Array, least: Array, root: Array) -> Array:
    """Smallest change, in the metric of mass, that gives rows their least values (Lawson and Hanson's LDP)."""
    size = np.abs(least).max()
    if size == 0.0 or (least <= 0.0).all():
        return free
    matrix = np.vstack([rows.T, least / size])
    factors = nnls(matrix, np.eye(len(matrix))[-1])[0]
    held = factors > 0.0
    # the held rows once more as equations, to round-off
    change = np.linalg.lstsq(rows[held], least[held], rcond=1e-12)[0]
    return free + root * change
