"""A file of blocks as its lines have it: corners, materials, laws of joints, held points and forces."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from voussoir.block_file import entries_of
from voussoir.files import read_text
from voussoir.record import SUPPORTS
from voussoir.verify.contacts import depth, make_block
from voussoir.verify.deck import Deck, VerifyError
from voussoir.verify.water import Water

Point = tuple[float, float]


@dataclass
class PointForce:
    """A force on a point; block 0 if the file leaves it to the place."""

    block: int
    point: Point
    force: Point
    live: bool


@dataclass
class Held:
    """Points that are held: two ends, the same twice for a single point."""

    block: int
    ends: tuple[Point, Point]
    along: tuple[bool, bool]


@dataclass
class Bar:
    """A bar that pulls its ends together, up to its strength."""

    ends: np.ndarray
    strength: float | None


@dataclass
class Change:
    """Blocks that are built or taken away at a time, by their numbers or by what holds their centres."""

    time: float
    adds: bool
    numbers: list[int]
    polygon: np.ndarray

    def means(self, number: int, centre: np.ndarray) -> bool:
        """Whether it is about a block."""
        if len(self.polygon):
            return depth(make_block(0, self.polygon, True), centre) > 0
        return number in self.numbers


@dataclass
class Law:
    """Friction angle, cohesion and tensile strength of a joint."""

    friction_deg: float
    cohesion: float = 0
    tension: float = 0


@dataclass
class Source:
    """What is on a file of blocks, on files of lines, or what an arch has instead."""

    corners: list[np.ndarray] = field(default_factory=list)
    material: list[int] = field(default_factory=list)
    weights: dict[int, float] = field(default_factory=dict)
    densities: dict[int, float] = field(default_factory=dict)
    strengths: dict[int, float] = field(default_factory=dict)
    friction_deg: dict[tuple[int, int], float] = field(default_factory=dict)
    forces: list[PointForce] = field(default_factory=list)
    held: list[Held] = field(default_factory=list)
    shaking: Point = (0, 0)
    bars: list[Bar] = field(default_factory=list)
    water: list[Water] = field(default_factory=list)
    lines: list[tuple[np.ndarray, Law]] = field(default_factory=list)
    changes: list[Change] = field(default_factory=list)
    changing: bool = False  #: Whether loads change with time

    def present(self, time: float) -> list[int]:
        """Numbers of the blocks that are there at a time: before its first change a block is what that changes."""
        there = []
        for number, corners in enumerate(self.corners, 1):
            centre = make_block(number, corners, False).centre
            own = [change for change in self.changes if change.means(number, centre)]
            passed = [change for change in own if change.time <= time]
            if max(passed, key=_time_of).adds if passed else not own or not min(own, key=_time_of).adds:
                there.append(number)
        return there


def _time_of(change: Change) -> float:
    """When blocks come or go."""
    return change.time


def read_blocks(path: Path, deck: Deck) -> Source:
    """What a file of blocks says; its deck fills in what materials leave out."""
    try:
        text = read_text(path)
    except OSError as error:
        raise VerifyError(f"cannot read {path}: name its folder by --decks") from error
    source = Source()
    for entry, rows in entries_of(text):
        _take(entry, [[deck.read(word) for word in row] for row in rows], source, deck)
    return source


def _take(entry: list[str], rows: list[list[float]], source: Source, deck: Deck) -> None:
    """Take in one entry with its rows."""
    keys = dict(zip(entry, entry[1:]))
    source.changing |= len(rows) > 1 and entry[0] in ("load", "live", "base_acceleration", "water")
    if "file" in entry:
        raise VerifyError("records of files are not verified")
    if entry[0] == "block":
        source.corners.append(np.array(rows))
        source.material.append(int(keys.get("material", "1")))
    elif entry[0] == "material":
        number = int(entry[1])
        if "density" in keys:
            source.densities[number] = deck.read(keys["density"])
            source.weights[number] = source.densities[number] * deck.number("load%gravity")
        if "unit_weight" in keys:
            source.weights[number] = deck.read(keys["unit_weight"])
        if "compressive_strength" in keys:
            source.strengths[number] = deck.read(keys["compressive_strength"])
    elif entry[0] == "joint":
        if "residual_deg" in keys or any(float(keys.get(name, "0")) > 0.0 for name in ("cohesion", "tension")):
            raise VerifyError("joints that lose strength by slip have no proof")
        if "friction_deg" in keys:
            pair = sorted((int(entry[1]), int(entry[2])))
            source.friction_deg[pair[0], pair[1]] = deck.read(keys["friction_deg"])
    elif entry[0] == "base_acceleration":
        ax, ay = (rows[-1][1:] if rows else [deck.read(word) for word in entry[1:3]])
        source.shaking = (-ax, -ay)
    elif entry[0] in ("base_velocity", "base_displacement"):
        raise VerifyError(f"{entry[0]} is not verified: only base_acceleration is")
    elif entry[0] == "bar":
        ends = [deck.read(word) for word in entry[1:5]]
        strength = deck.read(keys["strength"]) if "strength" in keys else None
        source.bars.append(Bar(np.array(ends).reshape(2, 2), strength))
    elif entry[0] in ("remove", "add"):
        time = float(deck.read(entry[-1]))
        numbers = [int(word) for word in entry[2:-2]] if entry[1] == "block" else []
        source.changes.append(Change(time, entry[0] == "add", numbers, np.array(rows, dtype=float)))
    elif entry[0] == "water":
        source.water.append(_water(entry, keys, rows, deck))
    elif entry[0] in ("load", "live", "fix", "displacement", "fix_line"):
        _take_point(entry, rows, source, deck)


def _water(entry: list[str], keys: dict[str, str], rows: list[list[float]], deck: Deck) -> Water:
    """A line of heads, at the end of its history."""
    places = []
    for word in entry[1:]:
        if word in ("unit_weight", "factor"):
            break
        places.append(deck.read(word))
    weight, factor = (deck.read(keys.get(name, usual)) for name, usual in (("unit_weight", "9810"), ("factor", "1")))
    return Water(list(zip(places[::2], places[1::2])), rows[-1][1] if rows else 0, weight, factor)


def _take_point(entry: list[str], rows: list[list[float]], source: Source, deck: Deck) -> None:
    """Take in a point that is loaded or held."""
    block, at = (int(entry[2]), 3) if entry[1] == "block" else (0, 1)
    numbers = [deck.read(word) for word in entry[at:] if word not in ("x", "y")]
    point = (numbers[0], numbers[1])
    if entry[0] in ("load", "live"):
        force = rows[-1][1:] if rows else numbers[2:4]
        source.forces.append(PointForce(block, point, (force[0], force[1]), entry[0] == "live"))
        return
    other = (numbers[2], numbers[3]) if entry[0] == "fix_line" else point
    along = (entry[-1] != "y", entry[-1] != "x")
    source.held.append(Held(block, (point, other), along))


def led_springings(deck: Deck, corners: list[np.ndarray]) -> list[Held]:
    """Springings that &support displaces: of its blocks' corners, the first and the last end the joint."""
    places = {"left": len(corners) - int(deck.number("arch%spans")), "right": len(corners)}
    searched = (deck.searched or "").split("%")[-1]
    moved = {key.split("%")[1].split("_")[0] for key in SUPPORTS if deck.gives(key) or key == f"support%{searched}"}
    return [
        Held(place, (tuple(corners[place - 1][0]), tuple(corners[place - 1][-1])), (True, True))
        for side, place in places.items() if side in moved]


def arch_corners(deck: Deck) -> list[np.ndarray]:
    """Corners of the voussoirs of an arch, from the left springing on, in either sense."""
    half = deck.numbers("arch%joints_deg")
    if half:
        angles = [-angle for angle in half[:0:-1]] + half
    else:
        count, end = round(deck.number("arch%voussoirs")), deck.number("arch%half_angle_deg")
        angles = [-end + 2 * end * k / count for k in range(count + 1)]
    radius, ratio = deck.number("arch%radius"), deck.number("arch%thickness_ratio")
    facet = deck.number("arch%facet_deg")
    blocks = []
    for left, right in zip(angles, angles[1:]):
        chords = math.ceil((right - left) / facet - 1e-9) if facet > 0 else 1
        fan = [deck.sine_cosine(left + (right - left) * k / chords) for k in range(chords + 1)]
        rings = (radius * (1 - ratio / 2), radius * (1 + ratio / 2))
        inner, outer = ([(r * sine, r * cosine) for sine, cosine in fan] for r in rings)
        blocks.append(np.array([*inner, *outer[::-1]]))
    return blocks
