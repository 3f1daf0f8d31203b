"""Loads on blocks from a deck and its file of blocks, and the friction between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from voussoir.verify.blocks import Bar, Law, PointForce, Source
from voussoir.verify.contacts import TOUCH, Block, Joint, depth
from voussoir.verify.deck import Deck, VerifyError
from voussoir.verify.fill import Pull, chords_of, fill_weights, has_fill, lowest_below, pressures, surface_of
from voussoir.verify.rational import PI
from voussoir.verify.water import water_loads

#: Friction angles of files of blocks count up to this one [deg]
MOST_FRICTION_DEG = "89.9"


def loads_on(deck: Deck, source: Source, blocks: list[Block]) -> np.ndarray:
    """Forces and moments about the centres of blocks: force along x and y, and moment, of each block: (n, 3)."""
    load = np.zeros((len(blocks), 3), dtype=object if deck.exact else float)
    for i, part in _parts_on(deck, source, blocks):
        load[i] += part
    return load


def sizes_on(deck: Deck, source: Source, blocks: list[Block]) -> np.ndarray:
    """Sizes of all loads on blocks, which may cancel one another: beside them rounding is small: (n, 3)."""
    size = np.zeros((len(blocks), 3))
    for i, part in _parts_on(deck, source, blocks):
        size[i] += np.abs(part.astype(float))
    return size


def _parts_on(deck: Deck, source: Source, blocks: list[Block]) -> Iterator[tuple[int, np.ndarray]]:
    """Place of a block and force and moment of a load on it, for all loads."""
    direction, push = deck.direction(), deck.push()
    for i, block in enumerate(blocks):
        material = source.material[i] if source.material else 1
        weight = source.weights.get(material, deck.unit_weight()) * block.area
        mass = source.densities.get(material, deck.number("material%density")) * block.area
        if not deck.gives("arch%lune_deg"):
            yield i, np.array([weight * (direction[0] + push) + mass * source.shaking[0],
                               weight * direction[1] + mass * source.shaking[1], 0 * weight])
        elif not block.fixed:
            yield _on_block(_wedge(deck, block, weight / block.area), 1, blocks)
    factor = deck.number("load%load_factor")
    for force in [*source.forces, *live_of(deck, blocks)]:
        yield _on_block(force, factor if force.live else 1, blocks)
    for water in source.water:
        for number, place, vector in water_loads(water, deck.number("load%water_rise"), blocks):
            yield _on_block(PointForce(number, tuple(place), tuple(vector), False), 1, blocks)
    for number, x, weight in fill_weights(deck, blocks) if has_fill(deck) else ():
        yield _on_block(PointForce(number, (x, blocks[number - 1].centre[1]), (0, -weight), False), 1, blocks)


def live_of(deck: Deck, blocks: list[Block]) -> list[PointForce]:
    """Live loads of a deck: forces of &live and of the axles of &vehicle."""
    free = [block for block in blocks if not block.fixed]
    x, y = deck.numbers("live%x"), deck.numbers("live%y")
    fx = deck.numbers("live%fx") or [0] * len(x)
    fy = deck.numbers("live%fy") or [0] * len(x)
    forces = []
    for point, force in zip(zip(x, y), zip(fx, fy)):
        number = max(free, key=lambda block: depth(block, np.array(point))).number
        forces.append(PointForce(number, point, force, True))
    return forces + _axles_of_deck(deck, blocks)


def pulls_of(deck: Deck, source: Source, blocks: list[Block]) -> list[Pull]:
    """Forces of any size up to a bound: bars that pull, fill that presses."""
    pulls = []
    ends = [deck.numbers(f"tie%{name}") for name in ("x1", "y1", "x2", "y2")]
    strength: Sequence[float | None] = deck.numbers("tie%strength") or [None] * len(ends[0])
    ties = [Bar(np.array(place).reshape(2, 2), most) for *place, most in zip(*ends, strength)]
    for bar in [*source.bars, *ties]:
        numbers = []
        for end in bar.ends:
            block = max(blocks, key=lambda block: depth(block, end))
            numbers.append(block.number if depth(block, end) >= -TOUCH * block.size else 0)
        along = (bar.ends[0] - bar.ends[1]).astype(float)
        pulls.append(Pull("bar", (numbers[0], numbers[1]), bar.ends, along / np.linalg.norm(along), bar.strength))
    if has_fill(deck):
        live = [(np.array(force.point), np.array(force.force)) for force in live_of(deck, blocks)]
        pulls += pressures(deck, blocks, live)
    return pulls


def _wedge(deck: Deck, block: Block, weight: float) -> PointForce:
    """Weight of a block of a lune, whose depth is the angle times the distance from x = 0, where it acts."""
    sums = np.array([0, 0, 0], dtype=object)
    for way in (1, -1):
        corners = []
        for start, end in zip(block.corners, np.roll(block.corners, -1, axis=0)):
            if way * start[0] >= 0:
                corners.append(start)
            if start[0] * end[0] < 0:
                corners.append(start + start[0] / (start[0] - end[0]) * (end - start))
        for a, b, c in ((corners[0], p, q) for p, q in zip(corners[1:], corners[2:])):
            area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
            # a parabola over a triangle is the mean of the middles of its sides
            middles = [(a + b) / 2, (b + c) / 2, (c + a) / 2]
            sums = sums + np.array([way * area / 3 * sum(m[0] * f for m, f in zip(middles, column))
                                    for column in ([1, 1, 1], [m[0] for m in middles], [m[1] for m in middles])])
    angle = deck.number("arch%lune_deg") * (PI if deck.exact else math.pi) / 180
    return PointForce(block.number, (sums[1] / sums[0], sums[2] / sums[0]), (0, -weight * angle * sums[0]), False)


def _axles_of_deck(deck: Deck, blocks: list[Block]) -> list[PointForce]:
    """Axles of a vehicle, in pieces between the corners below them."""
    place = deck.number("vehicle%position") if deck.gives("vehicle%position") else 0
    forces = []
    spread = deck.number("fill%spread") if has_fill(deck) else 0
    surface = surface_of(deck, chords_of(deck, blocks)) if spread > 0 else 0
    for k, weight in enumerate(deck.numbers("vehicle%axles")):
        middle = place + sum(deck.numbers("vehicle%spacings")[:k])
        half = deck.number("vehicle%length") / 2
        if spread > 0:
            half += spread * max(0, surface - lowest_below(blocks, middle))
        corners = [x for block in blocks for x in block.corners[:, 0] if abs(x - middle) < half]
        cuts = sorted([middle - half, *corners, middle + half])
        for left, right in zip(cuts, cuts[1:]):
            share = (right - left) / (2 * half) if half > 0 else 1
            below = _upper(blocks, (left + right) / 2)
            if share > 0 and below is not None and not below[0].fixed:
                point = ((left + right) / 2, below[1])
                forces.append(PointForce(below[0].number, point, (0, -share * weight), True))
    return forces


def _upper(blocks: list[Block], x: float) -> tuple[Block, float] | None:
    """The highest block at a place, and its height there."""
    found = None
    for block in blocks:
        for start, end in zip(block.corners, np.roll(block.corners, -1, axis=0)):
            if (start[0] - x) * (end[0] - x) > 0:
                continue
            y = max(start[1], end[1])
            if start[0] != end[0]:
                y = start[1] + (x - start[0]) / (end[0] - start[0]) * (end[1] - start[1])
            if found is None or y > found[1]:
                found = (block, y)
    return found


def _on_block(force: PointForce, factor: float, blocks: list[Block]) -> tuple[int, np.ndarray]:
    """Place of the block that a force acts on, force and moment about its centre."""
    number = force.block
    if number == 0:
        number = max(blocks, key=lambda block: depth(block, np.array(force.point))).number
    block = next(block for block in blocks if block.number == number)
    vector, arm = factor * np.array(force.force), np.array(force.point) - block.centre
    return number - 1, np.array([*vector, arm[0] * vector[1] - arm[1] * vector[0]])


def friction_of(deck: Deck, source: Source, joint: Joint, springing: bool) -> float:
    """Coefficient of friction of a joint or springing joint; infinite where it cannot slide."""
    law = Law(*(deck.number(f"joint%{name}") for name in ("friction_deg", "cohesion", "tension")))
    if source.lines:
        listed = min(source.lines, key=lambda line: _distance(line[0], joint.edges[0]))[1]
        law = Law(*(getattr(law if deck.gives(f"joint%{name}") else listed, name)
                    for name in ("friction_deg", "cohesion", "tension")))
    if max(law.cohesion, law.tension) > 0:
        raise VerifyError("joints with cohesion or tension have no proof")
    angle, most = law.friction_deg, deck.read(MOST_FRICTION_DEG)
    if source.material and not source.lines:
        pair = sorted((source.material[joint.first - 1], source.material[joint.second - 1]))
        angle = min(source.friction_deg.get((pair[0], pair[1]), angle), most)
    elif deck.is_shape():
        angle = most if springing and deck.text("arch%springing") == "no-slip" else min(angle, most)
    elif angle >= most or springing and deck.text("arch%springing") == "no-slip":
        return math.inf
    sine, cosine = deck.sine_cosine(angle)
    return sine / cosine


def strength_of(deck: Deck, source: Source, joint: Joint) -> float | None:
    """Compressive strength of the weaker of the two blocks of a joint; None where neither is crushed."""
    own = deck.number("material%compressive_strength") if deck.gives("material%compressive_strength") else None
    materials = [source.material[number - 1] if source.material else 1 for number in (joint.first, joint.second)]
    found = [source.strengths.get(material, own) for material in materials]
    return min((value for value in found if value is not None), default=None)


def _distance(line: np.ndarray, edge: np.ndarray) -> float:
    """How far the middle and the ends of an edge lie from a line at most."""
    along = line[1] - line[0]
    away = np.array([edge[0], edge.mean(axis=0), edge[1]]) - line[0]
    share = np.clip(away @ along / (along @ along), 0.0, 1.0)
    return float(np.linalg.norm(away - share[:, None] * along, axis=1).max())


def may_hold(source: Source, block: Block, point: np.ndarray, force: np.ndarray) -> bool:
    """Whether a file of blocks holds a point of a block against a force."""
    for held in source.held:
        if held.block not in (0, block.number):
            continue
        if any(value != 0.0 and not along for value, along in zip(force, held.along)):
            continue
        start, end = np.array(held.ends[0]), np.array(held.ends[1])
        length = float(np.linalg.norm(end - start))
        share = float((point - start) @ (end - start)) / length**2 if length > 0.0 else 0.0
        nearest = start + min(max(share, 0.0), 1.0) * (end - start)
        if np.linalg.norm(point - nearest) <= 1e-9 * block.size and depth(block, point) >= -TOUCH * block.size:
            return True
    return False
