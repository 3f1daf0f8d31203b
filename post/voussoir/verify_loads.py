"""Loads on blocks from a deck and its file of blocks, and the friction between them."""

from __future__ import annotations

import math

import numpy as np

from voussoir.verify_blocks import Law, PointForce, Source
from voussoir.verify_contacts import TOUCH, Block, Joint
from voussoir.verify_deck import Deck, VerifyError

#: Friction angles of files of blocks count up to this one [deg]
MOST_FRICTION_DEG = "89.9"


def loads_on(deck: Deck, source: Source, blocks: list[Block]) -> np.ndarray:
    """Forces and moments about the centres of blocks.

    Parameters
    ----------
    deck : Deck
        The deck of the case.
    source : Source
        Its file of blocks, or nothing.
    blocks : list of Block
        The blocks.

    Returns
    -------
    ndarray
        Force along x and y, and moment, of each block: (n, 3).
    """
    direction, push = deck.direction(), deck.push()
    load = np.zeros((len(blocks), 3), dtype=object if deck.exact else float)
    for i, block in enumerate(blocks):
        material = source.material[i] if source.material else 1
        weight = source.weights.get(material, deck.unit_weight()) * block.area
        mass = source.densities.get(material, deck.number("material%density")) * block.area
        load[i, 0] = weight * (direction[0] + push) + mass * source.shaking[0]
        load[i, 1] = weight * direction[1] + mass * source.shaking[1]
    factor = deck.number("load%load_factor")
    for force in source.forces:
        _add(force, factor if force.live else 1, blocks, load)
    for force in _live_of_deck(deck):
        _add(force, factor, [b for b in blocks if not b.fixed], load)
    for force in _axles_of_deck(deck, blocks):
        _add(force, factor, blocks, load)
    return load


def _axles_of_deck(deck: Deck, blocks: list[Block]) -> list[PointForce]:
    """Axles of a vehicle, in pieces between the corners below them."""
    place = deck.number("vehicle%position") if deck.gives("vehicle%position") else 0
    half = deck.number("vehicle%length") / 2
    forces = []
    for k, weight in enumerate(deck.numbers("vehicle%axles")):
        middle = place + sum(deck.numbers("vehicle%spacings")[:k])
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


def _live_of_deck(deck: Deck) -> list[PointForce]:
    """Forces of &live."""
    x, y = deck.numbers("live%x"), deck.numbers("live%y")
    fx = deck.numbers("live%fx") or [0] * len(x)
    fy = deck.numbers("live%fy") or [0] * len(x)
    return [PointForce(0, place, force, True) for place, force in zip(zip(x, y), zip(fx, fy))]


def _add(force: PointForce, factor: float, blocks: list[Block], load: np.ndarray) -> None:
    """Add a force to the load of its block."""
    number = force.block
    if number == 0:
        number = max(blocks, key=lambda block: depth(block, np.array(force.point))).number
    block = next(block for block in blocks if block.number == number)
    vector, arm = factor * np.array(force.force), np.array(force.point) - block.centre
    load[number - 1] += [*vector, arm[0] * vector[1] - arm[1] * vector[0]]


def depth(block: Block, point: np.ndarray) -> float:
    """How deep a point lies in a block, negative outside.

    Parameters
    ----------
    block : Block
        The block.
    point : ndarray
        The point.

    Returns
    -------
    float
        Its distance from the outline, with a sign.
    """
    start, point = block.corners.astype(float), np.asarray(point, dtype=float)
    end = np.roll(start, -1, axis=0)
    along = end - start
    share = np.clip(((point - start) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
    distance = float(np.linalg.norm(start + share[:, None] * along - point, axis=1).min())
    y, x = point[1], point[0]
    crosses = (start[:, 1] > y) != (end[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = start[:, 0] + (y - start[:, 1]) / along[:, 1] * along[:, 0]
    inside = int((crosses & (x < at)).sum()) % 2 == 1
    return distance if inside else -distance


def friction_of(deck: Deck, source: Source, joint: Joint, springing: bool) -> float:
    """Coefficient of friction of a joint; infinite where it cannot slide.

    Parameters
    ----------
    deck : Deck
        The deck of the case.
    source : Source
        Its file of blocks, or nothing.
    joint : Joint
        The joint.
    springing : bool
        Whether it is a springing joint of an arch.

    Returns
    -------
    float
        The coefficient.
    """
    law = Law(*(deck.number(f"joint%{name}") for name in ("friction_deg", "cohesion", "tension")))
    if source.lines:
        listed = min(source.lines, key=lambda line: _distance(line[0], joint.edge))[1]
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


def _distance(line: np.ndarray, edge: np.ndarray) -> float:
    """How far the middle and the ends of an edge lie from a line at most."""
    along = line[1] - line[0]
    away = np.array([edge[0], edge.mean(axis=0), edge[1]]) - line[0]
    share = np.clip(away @ along / (along @ along), 0.0, 1.0)
    return float(np.linalg.norm(away - share[:, None] * along, axis=1).max())


def may_hold(source: Source, block: Block, point: np.ndarray, force: np.ndarray) -> bool:
    """Whether a file of blocks holds a point of a block against a force.

    Parameters
    ----------
    source : Source
        The file of blocks.
    block : Block
        The block.
    point : ndarray
        The point.
    force : ndarray
        Its force along x and y.

    Returns
    -------
    bool
        The answer.
    """
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
