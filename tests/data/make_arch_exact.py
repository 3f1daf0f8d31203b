#!/usr/bin/env python3
"""Exact critical thickness of polygon arches: computes the rows of ``arch_exact.csv`` again.

A circular arch of rigid polygon voussoirs with radial joints stands under its
own weight when the joints can carry forces N1, N2 >= 0 at their two corners
and abs(T) <= tan(phi) (N1 + N2) along them.  The least ratio of thickness to
radius for which such forces exist is found here on half an arch: two unknowns
(thrust and its moment), the weights in closed form, in arithmetic of 60
digits.  The active joints are found by cutting planes, the ratio by Newton
steps on them.

Each result is then certified on the whole arch of polygons, which shares no
formula with that, again with 60 digits: its forces balance every voussoir and
lie in every friction cone, and its mechanism closes, opens no joint inwards
and takes no work from gravity.  Both together bound the ratio from either side.

The arches are those of the table: a new one is a row whose answer is empty.
The radius is 1 and the weight per volume is 1 throughout; angles of joints
count clockwise from the crown.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from pathlib import Path

import mpmath as mp
import numpy as np

DIGITS = 60
TINY = mp.mpf(10) ** -40  #: What counts as zero in the arithmetic of `DIGITS` digits
NO_SLIP_DEG = Fraction(90)  #: Friction angle from which joints do not slip [deg]
LARGEST_RATIO = 2.0  #: Thickness ratios from here on have no intrados

COLUMNS = [
    "case", "half_angle_deg", "voussoirs", "joints_deg", "facet_deg", "friction_deg",
    "springing", "eta_exact", "status", "intrados_hinge_deg", "extrados_hinge_deg", "mode",
]


# ----------------------------------------------------------------- the arches


@dataclass(frozen=True)
class Case:
    """One arch, its angles as the decimal figures a deck would hold [deg]."""

    name: str
    half_angle: str
    voussoirs: int | None = None
    joints: tuple[str, ...] = ()
    facet: str = ""
    friction: str = "90"
    springing: str = "frictional"

    @property
    def friction_angle(self) -> Fraction:
        """Friction angle [deg]."""
        return Fraction(self.friction)

    def half_joints(self) -> list[Fraction]:
        """Angles of the joints of one half from the crown outwards [deg]."""
        if self.joints:
            return [Fraction(angle) for angle in self.joints]
        step = 2 * Fraction(self.half_angle) / self.voussoirs
        first = Fraction(self.voussoirs % 2, 2)
        return [(first + k) * step for k in range(self.voussoirs // 2 + 1)]

    def all_joints(self) -> list[Fraction]:
        """Angles of all joints from the left springing to the right [deg]."""
        half = self.half_joints()
        return [-angle for angle in reversed(half) if angle > 0] + half

    def chords(self, span: Fraction) -> int:
        """Number of equal chords on each side of a voussoir of that span [deg]."""
        if not self.facet:
            return 1
        return max(1, ceil(span / Fraction(self.facet) - Fraction(1, 10**9)))

    def slips(self, angle: Fraction) -> bool:
        """Whether the joint at that angle [deg] may slip."""
        at_springing = abs(angle) == Fraction(self.half_angle)
        held = at_springing and self.springing == "no-slip"
        return self.friction_angle < NO_SLIP_DEG and not held


@dataclass(frozen=True)
class Answer:
    """Critical thickness ratio of one arch and what is active there."""

    status: str
    mode: str
    eta: mp.mpf | None = None
    thrust: mp.mpf | None = None
    moment: mp.mpf | None = None
    #: Opening of the intrados corner of each joint of one half: (joint) -> rate
    opens_intrados: dict[int, mp.mpf] | None = None
    opens_extrados: dict[int, mp.mpf] | None = None
    slips: dict[int, mp.mpf] | None = None  #: Slip of each joint of one half, with the sign of the shear force
    turns: tuple[float, ...] = ()  #: Thickness ratios at which standing turns to falling or back


# ------------------------------------------------ mp: half an arch, two unknowns


@dataclass(frozen=True)
class HalfArch:
    """Joints of one half: what they carry, in floats or in mpmath numbers.

    With the thrust h and its moment q about the centre, both over eta, joint j
    carries the normal force N = h cos + w sin at the distance (q + m s)/N from
    the centre, m = 1 + eta^2/12, and the shear w cos - h sin.

    Attributes
    ----------
    cosine, sine : numpy.ndarray
        Of the joint angles.
    weight : numpy.ndarray
        Weight between the crown and the joint, over eta: w.
    lever : numpy.ndarray
        Moment of that weight about the centre, over eta m: s.
    low, high : scalar or None
        Bounds that friction sets to the thrust; None where it sets none.
    low_joint, high_joint : tuple[int, int]
        The joint that sets the bound and the sign of its shear force.
    friction : scalar
        Tangent of the friction angle; 0 where no joint slips.
    """

    cosine: np.ndarray
    sine: np.ndarray
    weight: np.ndarray
    lever: np.ndarray
    low: object = None
    high: object = None
    low_joint: tuple[int, int] = (-1, 0)
    high_joint: tuple[int, int] = (-1, 0)
    friction: object = 0

    def to_floats(self) -> HalfArch:
        """Return the same arch in double precision."""
        arrays = [a.astype(float) for a in (self.cosine, self.sine, self.weight, self.lever)]
        low, high = (None if b is None else float(b) for b in (self.low, self.high))
        return HalfArch(*arrays, low, high, self.low_joint, self.high_joint)


def radians(angle: Fraction) -> mp.mpf:
    """Angle in radians from an exact number of degrees."""
    return mp.mpf(angle.numerator) / angle.denominator * mp.pi / 180


def half_arch(case: Case) -> HalfArch:
    """Weights, levers and friction bounds of one half of an arch."""
    angles = case.half_joints()
    # An odd number of voussoirs has half of its key stone before the first joint; the
    # lever of that half is the same for all joints and is part of q.
    weight = [chord_sums(case, -angles[0], angles[0])[0] / 2 if angles[0] else mp.mpf(0)]
    lever = [mp.mpf(0)]
    for start, end in zip(angles, angles[1:]):
        block_weight, block_lever = chord_sums(case, start, end)
        weight.append(weight[-1] + block_weight)
        lever.append(lever[-1] + block_lever)
    arch = HalfArch(
        np.array([mp.cos(radians(a)) for a in angles], dtype=object),
        np.array([mp.sin(radians(a)) for a in angles], dtype=object), np.array(weight, dtype=object),
        np.array(lever, dtype=object))
    return with_friction(arch, case, angles)


def chord_sums(case: Case, start: Fraction, end: Fraction) -> tuple[mp.mpf, mp.mpf]:
    """Weight over eta and lever over eta m of the voussoir between two joints."""
    chords = case.chords(end - start)
    step = (end - start) / chords
    sine, apothem = mp.sin(radians(step)), mp.cos(radians(step / 2))
    middles = [radians(start + step * (2 * k + 1) / 2) for k in range(chords)]
    return chords * sine, sine * apothem * mp.fsum(mp.sin(middle) for middle in middles)


def with_friction(arch: HalfArch, case: Case, angles: list[Fraction]) -> HalfArch:
    """Add the bounds that the friction cones set to the thrust.

    abs(w cos - h sin) <= tan(phi) (h cos + w sin) are two half lines of h a joint:
    h sin(phi + a) >= w cos(phi + a) and h sin(phi - a) >= -w cos(phi - a).
    """
    bounds = {1: [], -1: []}
    for joint, angle in enumerate(angles):
        if not case.slips(angle):
            continue
        for sign in (1, -1):
            turned = radians(case.friction_angle + sign * angle)
            factor, limit = mp.sin(turned), sign * arch.weight[joint] * mp.cos(turned)
            if abs(factor) < TINY:
                if limit > TINY:
                    bounds[1].append((mp.inf, (joint, sign)))
                continue
            bounds[1 if factor > 0 else -1].append((limit / factor, (joint, sign)))
    low, low_joint = max(bounds[1], key=lambda b: b[0], default=(None, (-1, 0)))
    high, high_joint = min(bounds[-1], key=lambda b: b[0], default=(None, (-1, 0)))
    arrays = (arch.cosine, arch.sine, arch.weight, arch.lever)
    friction = mp.tan(radians(case.friction_angle)) if low_joint[1] or high_joint[1] else 0
    return HalfArch(*arrays, low, high, low_joint, high_joint, friction)


@dataclass(frozen=True)
class Line:
    """Room for the thrust between the intrados of one joint and the extrados of another.

    room(h) = slope h + constant is the difference of the two bounds of q.
    """

    intrados: int
    extrados: int
    slope: object
    constant: object

    def at(self, thrust: object) -> object:
        """Room at a thrust."""
        return self.slope * thrust + self.constant


def line_of(arch: HalfArch, eta: object, intrados: int, extrados: int) -> Line:
    """Line of a pair of joints."""
    inner, outer, m = 1 - eta / 2, 1 + eta / 2, 1 + eta**2 / 12
    slope = outer * arch.cosine[extrados] - inner * arch.cosine[intrados]
    constant = (
        outer * arch.weight[extrados] * arch.sine[extrados]
        - inner * arch.weight[intrados] * arch.sine[intrados]
        + m * (arch.lever[intrados] - arch.lever[extrados])
    )
    return Line(intrados, extrados, slope, constant)


def moment_bounds(arch: HalfArch, eta: object, thrust: object) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest q that each joint admits."""
    normal = thrust * arch.cosine + arch.weight * arch.sine
    lever = (1 + eta**2 / 12) * arch.lever
    return (1 - eta / 2) * normal - lever, (1 + eta / 2) * normal - lever


def tightest_line(arch: HalfArch, eta: object, thrust: object) -> Line:
    """Pair of joints that leaves the least room at a thrust."""
    least, greatest = moment_bounds(arch, eta, thrust)
    return line_of(arch, eta, int(np.argmax(least)), int(np.argmin(greatest)))


@dataclass(frozen=True)
class Optimum:
    """Thrust with most room; the lines and the friction bound that limit it."""

    room: object
    thrust: object
    lines: tuple[Line, ...]
    bound: str = ""


def most_room(arch: HalfArch, eta: object, tolerance: object) -> Optimum:
    """Maximise the room over the thrust by cutting planes, a finite ascent."""
    low, high = (bound if bound is not None else none for bound, none in ((arch.low, -mp.inf), (arch.high, mp.inf)))
    if low > high or low == mp.inf:
        return Optimum(-mp.inf, None, (), "empty")
    left, left_line = left_end(arch, eta)
    if left_line.slope <= 0:
        return Optimum(left_line.at(left), left, (left_line,), "low")
    right, right_line = right_end(arch, eta, left)
    if right is None:
        return Optimum(mp.inf, None, ())
    if right_line.slope >= 0:
        return Optimum(right_line.at(right), right, (right_line,), "high")
    while True:
        thrust = (right_line.constant - left_line.constant) / (left_line.slope - right_line.slope)
        line = tightest_line(arch, eta, thrust)
        if line in (left_line, right_line) or line.at(thrust) >= left_line.at(thrust) - tolerance:
            return Optimum(left_line.at(thrust), thrust, (left_line, right_line))
        if line.slope > 0:
            left_line = line
        else:
            right_line = line


def left_end(arch: HalfArch, eta: object) -> tuple[object, Line]:
    """Return the least thrust, or one so low that the room still grows."""
    if arch.low is not None:
        return arch.low, tightest_line(arch, eta, arch.low)
    thrust = -arch.weight[-1]
    while (line := tightest_line(arch, eta, thrust)).slope <= 0:
        thrust = 2 * thrust
    return thrust, line


def right_end(arch: HalfArch, eta: object, left: object) -> tuple[object | None, Line | None]:
    """Return the greatest thrust, or one beyond the most room, or None: room without end."""
    if arch.high is not None:
        return arch.high, tightest_line(arch, eta, arch.high)
    inner, outer = 1 - eta / 2, 1 + eta / 2
    if outer * min(arch.cosine) > inner * max(arch.cosine):
        return None, None
    step = arch.weight[-1]
    while (line := tightest_line(arch, eta, left + step)).slope > 0:
        step = 2 * step
        if step > 1e30:
            return None, None
    return left + step, line


def frozen_room(arch: HalfArch, optimum: Optimum) -> Callable[[object], object]:
    """Room as a function of eta, the active joints unchanged."""
    pairs = [(line.intrados, line.extrados) for line in optimum.lines]

    def room(eta: object) -> object:
        lines = [line_of(arch, eta, *pair) for pair in pairs]
        if optimum.bound:
            return lines[0].at(optimum.thrust)
        shares = line_shares(lines)
        return sum(share * line.constant for share, line in zip(shares, lines))

    return room


def line_shares(lines: list[Line]) -> list[object]:
    """Shares of two lines of opposite slope in a mechanism without thrust work."""
    rising, falling = lines
    total = rising.slope - falling.slope
    return [-falling.slope / total, rising.slope / total]


def solve_mp(case: Case) -> Answer:
    """Critical thickness ratio of an arch in the arithmetic of `DIGITS` digits."""
    arch = half_arch(case)
    turns = find_turns(arch, case)
    bracket = turns.bracket
    if turns.always:
        bracket = descend(arch, bracket[0])
        if bracket is None:
            return Answer("always_stable", "none", turns=turns.ratios)
    elif not turns.ratios:
        empty = most_room(arch, mp.mpf(1), TINY).bound == "empty"
        return Answer("none_stable", "sliding" if empty else "none")
    optimum, eta = climb(arch, *bracket)
    verify(case, arch, optimum, eta)
    return describe(arch, optimum, eta, turns.ratios)


@dataclass(frozen=True)
class Turns:
    """Where an arch turns between falling and standing as its thickness grows."""

    ratios: tuple[float, ...]
    bracket: tuple[float, float]
    always: bool


def find_turns(arch: HalfArch, case: Case) -> Turns:
    """Scan thickness ratios from far below any critical one to the greatest, in floats."""
    floats = arch.to_floats()
    alpha = float(radians(Fraction(case.half_angle)))
    thinnest = min(1e-4, 1e-3 * alpha**4 / 48)
    grid = np.concatenate([np.geomspace(thinnest, 0.02, 200), np.linspace(0.02, LARGEST_RATIO - 1e-6, 800)[1:]])
    stands = np.array([most_room(floats, eta, 1e-15).room > 0 for eta in grid])
    where = np.flatnonzero(stands[1:] != stands[:-1])
    ratios = tuple(float(grid[k + 1]) for k in where)
    first = where[0] if where.size else 0
    return Turns(ratios, (float(grid[first]), float(grid[first + 1])), bool(stands[0]))


def descend(arch: HalfArch, standing: float) -> tuple[mp.mpf, mp.mpf] | None:
    """Bracket below a ratio at which the arch stands, or None: it stands down to 1e-25."""
    high = mp.mpf(standing)
    while high > mp.mpf(10) ** -25:
        low = high / 10
        if most_room(arch, low, TINY).room <= 0:
            return low, high
        high = low
    return None


def climb(arch: HalfArch, low: float, high: float) -> tuple[Optimum, mp.mpf]:
    """Root of the most room between two ratios: Newton on the active joints, kept in bracket."""
    low, high = mp.mpf(low), mp.mpf(high)
    eta, last = low, None
    for _ in range(200):
        optimum = most_room(arch, eta, TINY)
        active = {(line.intrados, line.extrados) for line in optimum.lines}, optimum.bound
        if active == last and abs(optimum.room) < TINY:
            return optimum, eta
        last = active
        low, high = (eta, high) if optimum.room < 0 else (low, eta)
        room = frozen_room(arch, optimum)
        try:
            proposal = mp.findroot(room, (eta, eta * (1 + mp.mpf(10) ** -8)), tol=TINY**2)
        except (ValueError, ZeroDivisionError):
            proposal = (low + high) / 2
        eta = proposal if low <= proposal <= high else (low + high) / 2
    raise ArithmeticError("the active joints do not settle")


def verify(case: Case, arch: HalfArch, optimum: Optimum, eta: mp.mpf) -> None:
    """Every joint admits the forces; a little less thickness leaves no room for any force."""
    q = moment_of(arch, optimum, eta)
    least, greatest = moment_bounds(arch, eta, optimum.thrust)
    worst = min(min(q - least), min(greatest - q))
    if worst < -TINY:
        raise ArithmeticError(f"{case.name}: a joint is violated by {mp.nstr(worst, 5)}")
    for ratio, sign in ((1 - mp.mpf(10) ** -18, -1), (1 + mp.mpf(10) ** -18, 1)):
        room = most_room(arch, eta * ratio, TINY).room
        if sign * room <= 0:
            raise ArithmeticError(f"{case.name}: room {mp.nstr(room, 5)} at {sign:+d}e-18")


def moment_of(arch: HalfArch, optimum: Optimum, eta: mp.mpf) -> mp.mpf:
    """Moment q of the thrust at the critical ratio: the intrados bound of the active joint."""
    return max(moment_bounds(arch, eta, optimum.thrust)[0])


def describe(arch: HalfArch, optimum: Optimum, eta: mp.mpf, turns: tuple[float, ...]) -> Answer:
    """Mechanism at the critical ratio: rates of opening and slip."""
    shares = [mp.mpf(1)] if optimum.bound else line_shares(list(optimum.lines))
    opens_extrados, opens_intrados, slips = {}, {}, {}
    for share, line in zip(shares, optimum.lines):
        for opens, joint in ((opens_extrados, line.intrados), (opens_intrados, line.extrados)):
            if share > TINY:
                opens[joint] = opens.get(joint, mp.mpf(0)) + share
    if optimum.bound:
        joint, sign = arch.low_joint if optimum.bound == "low" else arch.high_joint
        slips[joint] = sign * slip_rate(arch, optimum, joint, sign)
    mode = "mixed" if slips else "rotational"
    q = moment_of(arch, optimum, eta)
    return Answer("found", mode, eta, optimum.thrust, q, opens_intrados, opens_extrados, slips, turns)


def slip_rate(arch: HalfArch, optimum: Optimum, joint: int, sign: int) -> mp.mpf:
    """Slip of a joint that takes up the work of the thrust on the opening joints.

    The active side of the cone is tan(phi) (h cos + w sin) - sign (w cos - h sin) >= 0.
    """
    factor = arch.friction * arch.cosine[joint] + sign * arch.sine[joint]
    return -optimum.lines[0].slope / factor


# ------------------------------------------- the whole arch of polygons, every force


@dataclass(frozen=True)
class PolygonArch:
    """Voussoirs of a whole arch as polygons, from the left springing to the right.

    Attributes
    ----------
    angles : list[Fraction]
        Joint angles [deg].
    directions : list[tuple]
        Sine and cosine of each joint angle.
    areas : list
        Of the voussoirs.
    centroids : list[tuple]
        Of the voussoirs.
    eta : mpmath.mpf
        Thickness ratio.
    """

    angles: list[Fraction]
    directions: list[tuple]
    areas: list
    centroids: list[tuple]
    eta: mp.mpf


def chord_directions(case: Case) -> list[list[tuple]]:
    """Sine and cosine of the angles of the vertices of each voussoir."""
    joints = case.all_joints()
    directions = []
    for start, end in zip(joints, joints[1:]):
        chords = case.chords(end - start)
        angles = [radians(start + (end - start) * k / chords) for k in range(chords + 1)]
        directions.append([(mp.sin(angle), mp.cos(angle)) for angle in angles])
    return directions


def polygon_arch(case: Case, directions: list[list[tuple]], eta: mp.mpf) -> PolygonArch:
    """Polygons of an arch of a given thickness: areas and centroids from the vertices."""
    inner, outer = 1 - eta / 2, 1 + eta / 2
    areas, centroids = [], []
    for block in directions:
        intrados = [(inner * s, inner * c) for s, c in block]
        extrados = [(outer * s, outer * c) for s, c in reversed(block)]
        area, centroid = shoelace(intrados + extrados)
        areas.append(area)
        centroids.append(centroid)
    joints = [block[0] for block in directions] + [directions[-1][-1]]
    return PolygonArch(case.all_joints(), joints, areas, centroids, eta)


def shoelace(vertices: list[tuple]) -> tuple[mp.mpf, tuple]:
    """Area and centroid of a polygon with anticlockwise vertices."""
    area = x_sum = y_sum = mp.mpf(0)
    for (x1, y1), (x2, y2) in zip(vertices, vertices[1:] + vertices[:1]):
        cross = x1 * y2 - x2 * y1
        area += cross / 2
        x_sum += (x1 + x2) * cross / 6
        y_sum += (y1 + y2) * cross / 6
    return area, (x_sum / area, y_sum / area)


def joint_wrenches(arch: PolygonArch, joint: int, block: int) -> list[tuple]:
    """Force and moment about a voussoir's centroid of unit N1, N2 and T at a joint.

    They act on the voussoir to the right of the joint: N1 at the intrados and N2 at the
    extrados clockwise along the arch, T outwards along the joint.
    """
    s, c = arch.directions[joint]
    x, y = arch.centroids[block]
    wrenches = []
    for radius, (fx, fy) in ((1 - arch.eta / 2, (c, -s)), (1 + arch.eta / 2, (c, -s)), (1, (s, c))):
        wrenches.append((fx, fy, (radius * s - x) * fy - (radius * c - y) * fx))
    return wrenches


def certify(case: Case, answer: Answer) -> mp.mpf:
    """Check the critical state on the whole arch of polygons, in `DIGITS` digits.

    Forces that balance and a mechanism without power, both admissible, bound the critical
    ratio from above and from below.

    Returns
    -------
    mpmath.mpf
        The greatest of: unbalanced force or moment over the greatest joint force, force
        outside a cone over the same, gap of the mechanism at the right springing and
        power of gravity, both over the greatest rate of a joint.
    """
    arch = polygon_arch(case, chord_directions(case), answer.eta)
    forces = joint_forces(case, answer)
    worst = max(unbalance(arch, forces), outside_cones(case, arch, forces), mechanism_gap(case, arch, answer))
    if worst > TINY:
        raise ArithmeticError(f"{case.name}: the certificate fails by {mp.nstr(worst, 5)}")
    return worst


def full_index(count: int, case: Case) -> Iterator[tuple[int, int, int]]:
    """Joint of the whole arch, joint of the half, side (-1 left, 0 crown, 1 right)."""
    at_crown = case.half_joints()[0] == 0
    mirrored = count - 1 if at_crown else count
    for joint in range(mirrored + count):
        if joint < mirrored:
            yield joint, count - 1 - joint, -1
        else:
            half = joint - mirrored
            yield joint, half, 0 if half == 0 and at_crown else 1


def joint_forces(case: Case, answer: Answer) -> list[tuple]:
    """Forces N1, N2, T on the voussoir right of each joint of the whole arch."""
    arch, eta, h = half_arch(case), answer.eta, answer.thrust
    forces = []
    for _, half, side in full_index(len(arch.weight), case):
        normal = h * arch.cosine[half] + arch.weight[half] * arch.sine[half]
        moment = answer.moment + (1 + eta**2 / 12) * arch.lever[half]
        shear = arch.weight[half] * arch.cosine[half] - h * arch.sine[half]
        forces.append(((1 + eta / 2) * normal - moment, moment - (1 - eta / 2) * normal, -side * eta * shear))
    return forces


def unbalance(arch: PolygonArch, forces: list[tuple]) -> mp.mpf:
    """Greatest residual of the equilibrium of a voussoir over the greatest force."""
    worst = mp.mpf(0)
    for block, area in enumerate(arch.areas):
        residual = [mp.mpf(0), -area, mp.mpf(0)]
        for joint, sign in ((block, 1), (block + 1, -1)):
            for force, wrench in zip(forces[joint], joint_wrenches(arch, joint, block)):
                for component in range(3):
                    residual[component] += sign * force * wrench[component]
        worst = max(worst, *(abs(r) for r in residual))
    return worst / max(abs(force) for joint in forces for force in joint)


def outside_cones(case: Case, arch: PolygonArch, forces: list[tuple]) -> mp.mpf:
    """Greatest excess of a joint force over its cone, over the greatest force."""
    worst = mp.mpf(0)
    for angle, (n1, n2, t) in zip(arch.angles, forces):
        worst = max(worst, -n1, -n2)
        if case.slips(angle):
            worst = max(worst, abs(t) - mp.tan(radians(case.friction_angle)) * (n1 + n2))
    return worst / max(abs(force) for joint in forces for force in joint)


def joint_rates(case: Case, answer: Answer) -> list[tuple]:
    """Rates of each joint of the whole arch: opening at intrados and extrados, slip.

    They are those of the voussoir right of the joint; a slip opens both corners by
    tan(phi) times its size (associated flow).
    """
    count = len(case.half_joints())
    friction = mp.tan(radians(case.friction_angle)) if answer.slips else mp.mpf(0)
    rates = []
    for _, half, side in full_index(count, case):
        twice = 2 if side == 0 else 1
        slip = answer.slips.get(half, mp.mpf(0))
        opening = friction * abs(slip)
        rates.append((
            twice * answer.eta * answer.opens_intrados.get(half, mp.mpf(0)) + opening,
            twice * answer.eta * answer.opens_extrados.get(half, mp.mpf(0)) + opening, side * slip))
    return rates


def mechanism_gap(case: Case, arch: PolygonArch, answer: Answer) -> mp.mpf:
    """How far the mechanism is from closing at the right springing and from zero power."""
    rates = joint_rates(case, answer)
    u, v, spin, power = mp.mpf(0), mp.mpf(0), mp.mpf(0), mp.mpf(0)
    inner = 1 - arch.eta / 2
    for joint, ((s, c), (intrados, extrados, slip)) in enumerate(zip(arch.directions, rates)):
        if min(intrados, extrados) < 0:
            raise ArithmeticError(f"{case.name}: joint {joint} opens inwards")
        # Motion of the point at the centre of the arch: u, v and the spin
        turn = (intrados - extrados) / arch.eta
        spin += turn
        u += c * intrados + s * slip + turn * inner * c
        v += -s * intrados + c * slip - turn * inner * s
        if joint < len(arch.areas):
            power -= arch.areas[joint] * (v + spin * arch.centroids[joint][0])
    return max(abs(u), abs(v), abs(spin), abs(power)) / max(max(map(abs, r)) for r in rates)


# ------------------------------------------------------------------- the program


def degrees(case: Case, joints: list[int]) -> str:
    """Angles of joints of one half, joined for a column [deg]."""
    angles = case.half_joints()
    return ";".join(repr(round(float(angles[joint]), 12)) for joint in sorted(joints))


def row_of(case: Case, answer: Answer) -> dict[str, object]:
    """Row of the table."""
    row = {
        "case": case.name, "half_angle_deg": case.half_angle, "voussoirs": case.voussoirs or "",
        "joints_deg": " ".join(case.joints), "facet_deg": case.facet,
        "friction_deg": case.friction, "springing": case.springing,
        "eta_exact": mp.nstr(answer.eta, 17, strip_zeros=False) if answer.eta else "",
        "status": answer.status, "intrados_hinge_deg": "", "extrados_hinge_deg": "",
        "mode": answer.mode,
    }
    if answer.mode == "rotational":
        parted = answer.opens_intrados.keys() & answer.opens_extrados.keys()
        row["intrados_hinge_deg"] = degrees(case, answer.opens_extrados.keys() - parted)
        row["extrados_hinge_deg"] = degrees(case, answer.opens_intrados.keys() - parted)
    return row


def report(case: Case, answer: Answer, seconds: float) -> None:
    """Say on standard error what was found and how well it is confirmed."""
    eta = mp.nstr(answer.eta, 12) if answer.eta else answer.status
    proof = mp.nstr(certify(case, answer), 1) if answer.eta else "-"
    turns = "" if len(answer.turns) < 2 else f" turns at {answer.turns}"
    print(f"{case.name:28s} {eta:20s} {answer.mode:10s} certificate {proof:>8s} {seconds:6.2f} s{turns}",
          file=sys.stderr, flush=True)


def case_of(row: dict[str, str]) -> Case:
    """The arch of a row of the table."""
    return Case(row["case"], row["half_angle_deg"], int(row["voussoirs"]) if row["voussoirs"] else None,
                tuple(row["joints_deg"].split()), row["facet_deg"], row["friction_deg"], row["springing"])


def main() -> None:
    """Compute every case and write its row as soon as it is there."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("table", type=Path, help="table whose arches are computed, such as arch_exact.csv")
    parser.add_argument("--only", default="", help="only cases whose name contains this")
    arguments = parser.parse_args()
    mp.mp.dps = DIGITS
    with arguments.table.open(newline="", encoding="utf-8") as stream:
        cases = [case_of(row) for row in csv.DictReader(stream) if arguments.only in row["case"]]
    table = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    table.writeheader()
    for case in cases:
        start = time.perf_counter()
        answer = solve_mp(case)
        table.writerow(row_of(case, answer))
        sys.stdout.flush()
        report(case, answer, time.perf_counter() - start)


if __name__ == "__main__":
    main()
