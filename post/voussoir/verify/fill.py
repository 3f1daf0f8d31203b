"""Fill on an arch, from the corners of its blocks: what it weighs, how axles spread in it, what it can press with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from voussoir.verify.contacts import Block, depth
from voussoir.verify.deck import Deck

#: A point so far outside an edge, over its length, shows what is on it
OUTSIDE = 1e-6
#: A chord that rises less than this share of its length is not pressed
LEVEL = 1e-9
#: A load so near to the crown, as a share of the width of the fill, is on no side
AT_CROWN = 1e-12


@dataclass
class Chord:
    """An upper edge that is open to the sky, from left to right, and its span, 0 on a pier."""

    block: int
    left: np.ndarray
    right: np.ndarray
    span: int

    @property
    def middle(self) -> np.ndarray:
        """Half way."""
        return np.asarray((self.left + self.right) / 2)

    @property
    def rise(self) -> float:
        """How much higher its right end is."""
        rise: float = self.right[1] - self.left[1]
        return rise


@dataclass
class Pull:
    """A force from nothing to a bound on the second of two blocks; the opposite acts on the first.

    A bar pulls its two ends together; fill presses a block, and 0 is in the place of the first.
    """

    kind: str
    blocks: tuple[int, int]
    points: np.ndarray
    direction: np.ndarray
    most: float | None


def has_fill(deck: Deck) -> bool:
    """Whether fill lies on the arch."""
    return "&fill" in deck.values or any(key.startswith("fill%") for key in deck.values)


def chords_of(deck: Deck, blocks: list[Block]) -> list[Chord]:
    """Chords of the extrados that have their voussoir below them, span by span, then what is open of piers."""
    spans = round(float(deck.number("arch%spans")))
    in_span, in_ring = deck.voussoirs // spans, deck.voussoirs // spans // round(float(deck.number("arch%rings")))
    chords = []
    for block in blocks:
        if block.fixed:
            continue
        span, place = (block.number - 1) // in_span + 1, (block.number - 1) % in_span
        edges = list(zip(block.corners, np.roll(block.corners, -1, axis=0)))
        if span > spans:
            edges = [edge for edge in edges if edge[1][0] < edge[0][0] and not is_covered(blocks, block, *edge)]
        else:
            # corners go along the intrados, then back along the extrados, which is the outermost ring's
            edges = edges[len(edges) // 2 : -1] if place >= in_span - in_ring else []
        chords += [Chord(block.number, left, right, span if span <= spans else 0)
                   for right, left in edges if left[0] < right[0]]
    return chords


def is_covered(blocks: list[Block], block: Block, start: np.ndarray, end: np.ndarray) -> bool:
    """Whether another block lies on a part of an edge, the block on its left."""
    first, last = start.astype(float), end.astype(float)
    point = (first + last) / 2 + OUTSIDE * np.array([last[1] - first[1], first[0] - last[0]])
    for other in blocks:
        corners = other.corners
        if other is block or any((corners[:, k] > point[k]).all() or (corners[:, k] < point[k]).all() for k in (0, 1)):
            continue
        if depth(other, point) > 0.0:
            return True
    return False


def surface_of(deck: Deck, chords: list[Chord]) -> float:
    """Height of the surface of the fill."""
    top: float = max(max(chord.left[1], chord.right[1]) for chord in chords)
    return top + deck.number("fill%height")


def fill_weights(deck: Deck, blocks: list[Block]) -> list[tuple[int, float, float]]:
    """Weights of what lies above the chords: the block, where the weight acts along x, and the weight."""
    chords = chords_of(deck, blocks)
    surface, backing = surface_of(deck, chords), _backing(deck, blocks)
    of_fill = deck.number("fill%unit_weight")
    of_backing = deck.number("fill%backing_unit_weight") if deck.gives("fill%backing_unit_weight") \
        else deck.unit_weight()
    found = []
    for chord in chords:
        area, moment = _below(chord, surface)
        weight, first = of_fill * area, of_fill * moment
        if backing is not None:
            area, moment = _below(chord, min(backing, surface))
            weight, first = weight + (of_backing - of_fill) * area, first + (of_backing - of_fill) * moment
        if weight > 0:
            found.append((chord.block, first / weight, weight))
    return found


def _backing(deck: Deck, blocks: list[Block]) -> float | None:
    """Height of the surface of the backing."""
    if not deck.gives("fill%backing_height"):
        return None
    # corners begin at the left end of the intrados
    foot: float = blocks[0].corners[0][1]
    return foot + deck.number("fill%backing_height")


def _below(chord: Chord, top: float) -> tuple[float, float]:
    """Area between a chord and a level line above it, and its moment about x = 0."""
    low, high = sorted((chord.left, chord.right), key=lambda end: float(end[1]))
    if top <= low[1]:
        return 0, 0
    if top < high[1]:
        share = (top - low[1]) / (high[1] - low[1])
        high = np.array([low[0] + share * (high[0] - low[0]), top])
    width = abs(high[0] - low[0])
    depths = top - low[1], top - high[1]
    moment = (low[0] * (2 * depths[0] + depths[1]) + high[0] * (depths[0] + 2 * depths[1])) * width / 6
    return width * (depths[0] + depths[1]) / 2, moment


def pressures(deck: Deck, blocks: list[Block], live: list[tuple[np.ndarray, np.ndarray]]) -> list[Pull]:
    """What an arch can lean against: fill on the side away from the live loads of a span, and backing.

    Live loads are places and forces on points.
    """
    chords = chords_of(deck, blocks)
    surface, backing = surface_of(deck, chords), _backing(deck, blocks)
    passive = deck.number("fill%passive_coefficient")
    if deck.gives("fill%passive_share"):
        sine, _ = deck.sine_cosine(deck.number("fill%friction_deg"))
        passive = deck.number("fill%passive_share") * (1 + sine) / (1 - sine)
    crowns = {span: _crown([c for c in chords if c.span == span]) for span in {c.span for c in chords if c.span}}
    sizes = [float(np.linalg.norm(force.astype(float))) for _, force in live]
    loaded, load_x = 0, 0.0
    if sum(sizes) > 0.0:
        load_x = sum(size * float(place[0]) for size, (place, _) in zip(sizes, live)) / sum(sizes)
        loaded = min(crowns, key=lambda span: abs(crowns[span] - load_x))
    found = []
    width = float(max(c.right[0] for c in chords) - min(c.left[0] for c in chords))
    for chord in chords:
        if chord.span == 0 or abs(chord.rise) <= LEVEL * (chord.right[0] - chord.left[0]):
            continue
        most = passive * deck.number("fill%unit_weight") * (surface - chord.middle[1]) * abs(chord.rise)
        if backing is not None and chord.middle[1] < backing:
            most = None
        elif chord.span == loaded:
            crown = crowns[chord.span]
            if abs(load_x - crown) > AT_CROWN * width and (float(chord.middle[0]) - crown) * (load_x - crown) > 0.0:
                continue
        if most is None or most > 0:
            inward = np.array([1 if chord.rise > 0 else -1, 0])
            found.append(Pull("bounded", (0, chord.block), np.array([chord.middle, chord.middle]), inward, most))
    return found


def _crown(chords: list[Chord]) -> float:
    """Where chords turn from rising to falling; where they do not, their highest point."""
    slopes = sorted((float(c.middle[0]), float(c.rise / (c.right[0] - c.left[0]))) for c in chords)
    for (x, rising), (next_x, falling) in zip(slopes, slopes[1:]):
        if rising >= 0.0 >= falling and rising > falling:
            return x + (next_x - x) * rising / (rising - falling)
    ends = [end for chord in sorted(chords, key=lambda c: float(c.left[0])) for end in (chord.left, chord.right)]
    return float(max(ends, key=lambda end: float(end[1]))[0])


def lowest_below(blocks: list[Block], x: float) -> float:
    """Height of the lower end of the upper edge below an axle; beside all that can move, of the nearest end."""
    free = np.concatenate([block.corners[:, 0] for block in blocks if not block.fixed])
    if not free.min() < x < free.max():
        # what is fixed meets the nearest end there
        x, blocks = min(max(x, free.min()), free.max()), [block for block in blocks if not block.fixed]
    best: tuple[float, float] | None = None
    for block in blocks:
        for start, end in zip(block.corners, np.roll(block.corners, -1, axis=0)):
            # upper edges alone: a joint may stand upright below the axle
            if (start[0] - x) * (end[0] - x) > 0 or start[0] - end[0] <= LEVEL * abs(end[1] - start[1]):
                continue
            y = start[1] + (x - start[0]) / (end[0] - start[0]) * (end[1] - start[1])
            if best is None or y > best[0]:
                best = (y, min(start[1], end[1]))
    assert best is not None
    return best[1]
