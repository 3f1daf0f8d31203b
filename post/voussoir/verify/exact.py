"""Limits in rational arithmetic: forces and mechanisms that balance and keep every law exactly.

Blocks, joints and loads are those of the deck's own decimals; sines are rounded to forty decimals, and
coefficients of friction to either side, to the side that proves less.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from voussoir.verify.blocks import Source, arch_corners, led_springings, read_blocks
from voussoir.verify.contacts import Joint, find_joints, make_block
from voussoir.verify.deck import Deck, VerifyError
from voussoir.verify.lines import read_lines
from voussoir.verify.loads import loads_on
from voussoir.verify.proofs import Finding, Scene, held_points
from voussoir.verify.rational import Column, square_root
from voussoir.verify.read import Row
from voussoir.verify.simplex import find_best

#: Most joints that are computed exactly
MOST_JOINTS = 200
#: Half of the relative width of an interval about a critical thickness
HALF_WIDTH = Fraction(4, 10**13)
#: Coefficients of friction are moved by this share
NUDGE = Fraction(1, 10**30)
#: Loads that are linear in these, and nothing else depends on them
LINEAR = ("load_factor", "horizontal_coefficient")


@dataclass
class ExactScene:
    """Blocks and joints in fractions: for each joint its blocks, its ends and its edge."""

    scene: Scene
    corners: list[np.ndarray]
    place: dict[tuple[float, float], np.ndarray]

    def at(self, point: np.ndarray) -> np.ndarray:
        """The corner that a point was rounded from."""
        return self.place[float(point[0]), float(point[1])]


def exact_scene(deck: Deck, rows: list[Row], files: list[Path]) -> ExactScene:
    """Blocks and joints of a case in fractions, from its rows of blocks.csv and the files that its deck names."""
    deck, source = replace(deck, exact=True), Source()
    fixed = {int(row["block"]): row["state"] == "fixed" for row in rows}
    if deck.text("scene%kind") == "blocks":
        source = read_blocks(files[0], deck)
        corners, still = source.corners, [fixed.get(k + 1, True) for k in range(len(source.corners))]
    elif deck.text("scene%kind") == "arch" and not deck.is_shape():
        corners = arch_corners(deck)
        ends = [_abutment(corners[0], False), _abutment(corners[-1], True)]
        still = [False] * len(corners) + [True, True]
        corners = corners + ends
    else:
        corners_of: dict[int, list[list[Fraction]]] = {}
        for row in rows:
            corners_of.setdefault(int(row["block"]), []).append([Fraction(row["x"]), Fraction(row["y"])])
        corners, still = [np.array(corners_of[n]) for n in sorted(corners_of)], [fixed[n] for n in sorted(corners_of)]
        source.held = led_springings(deck, corners)
    rounded = [make_block(k + 1, c.astype(float), f) for k, (c, f) in enumerate(zip(corners, still))]
    blocks = [make_block(k + 1, c, f) for k, (c, f) in enumerate(zip(corners, still))]
    if deck.gives("scene%analysis"):
        source = read_lines(files[0], files[1], rounded, deck)
    place = {(float(x), float(y)): np.array([x, y]) for block in corners for x, y in block}
    # blocks that are not there in the last stage touch nothing
    there = [block for block in rounded if not source.changes or block.number in fixed]
    joints = find_joints(there, float(deck.number("scene%contact_tolerance")))
    return ExactScene(Scene(blocks, joints, source, deck), corners, place)


def _abutment(voussoir: np.ndarray, right: bool) -> np.ndarray:
    """A fixed block behind a springing joint, as long as the joint is."""
    half = len(voussoir) // 2
    inner, outer = (voussoir[half - 1], voussoir[half]) if right else (voussoir[0], voussoir[-1])
    along = outer - inner
    out = np.array([along[1], -along[0]]) if right else np.array([-along[1], along[0]])
    return np.array([inner, outer, outer + out, inner + out])


def _columns(exact: ExactScene, nudge: Fraction, number: dict[int, int], origin: np.ndarray) -> list[Column]:
    """What a unit of each force at the joints and held points does to the blocks."""
    scene, columns = exact.scene, []
    for joint in scene.joints:
        columns += _columns_of(exact, joint, scene.friction(joint), nudge, number, origin)
    for block in scene.blocks:
        for point, along in [] if block.fixed else held_points(scene, block):
            for k in range(2):
                for way in (1, -1) if along[k] else ():
                    vector = np.array([way * (1 - k), way * k])
                    columns.append(_effect(vector, point - origin, (0, block.number), number))
    row = 3 * len(number)
    for pull in scene.pulls:
        # a unit of a bar's force is as long as the bar
        unit = pull.points[0] - pull.points[1] if pull.kind == "bar" else pull.direction
        column: Column = {}
        for pulled, point, way in zip(pull.blocks, pull.points, (-1, 1)):
            for i, value in _effect(way * unit, point - origin, (0, pulled), number).items():
                column[i] = column.get(i, Fraction(0)) + value
        if pull.most is not None:
            # a row of its own says that the force and what is left of the bound are the bound
            column[row] = Fraction(1)
            columns.append({row: Fraction(1)})
            row += 1
        columns.append(column)
    return columns


def _columns_of(
    exact: ExactScene, joint: Joint, friction: Fraction | float, nudge: Fraction, number: dict[int, int],
    origin: np.ndarray,
) -> list[Column]:
    """Effect of a unit of each force of a joint: a normal one at each end, with friction either way."""
    ends, edges = [exact.at(end) for end in joint.ends], [[exact.at(at) for at in edge] for edge in joint.edges]
    along = [edge[1] - edge[0] for edge in edges]
    feet = [edge[0] + way * ((end - edge[0]) @ way / (way @ way)) for end, edge, way in zip(ends, edges, along)]
    middle, columns = (feet[0] + feet[1]) / 2 - origin, []
    for k in range(1 if joint.single else 2):
        press = _effect(np.array([along[k][1], -along[k][0]]), ends[k] - origin, joint, number)
        slide = _effect(_tangent(along, k), middle, joint, number)
        if isinstance(friction, Fraction):
            columns += [_sum(press, slide, way * friction * (1 + nudge)) for way in (1, -1)]
        else:
            columns += [press, slide, _sum({}, slide, Fraction(-1))]
    return columns


def _tangent(along: list[np.ndarray], k: int) -> np.ndarray:
    """The direction of a joint of two edges, as long as the one at its end k: that between theirs."""
    if along[0][0] * along[1][1] == along[0][1] * along[1][0]:
        return along[k]
    lengths = [square_root(way @ way) for way in along]
    between = along[0] / lengths[0] + along[1] / lengths[1]
    return np.asarray(between * (lengths[k] / square_root(between @ between)))


def _sum(column: Column, other: Column, share: Fraction) -> Column:
    """A column and a share of another."""
    return {i: value for i in column | other if (value := column.get(i, Fraction(0)) + share * other.get(i, 0))}


def _bounds(exact: ExactScene, nudge: Fraction) -> list[Fraction]:
    """Bounds of the forces of bars and fill, in the units of their columns."""
    bounds = []
    for pull in exact.scene.pulls:
        if pull.most is not None:
            along = pull.points[0] - pull.points[1]
            length = square_root(along @ along) if pull.kind == "bar" else Fraction(1)
            bounds.append(Fraction(pull.most) / length * (1 + nudge))
    return bounds


def _effect(vector: np.ndarray, arm: np.ndarray, joint: Joint | tuple[int, int], number: dict[int, int]) -> Column:
    """Force and moment about the origin on the second block, and the opposite on the first."""
    first, second = joint if isinstance(joint, tuple) else (joint.first, joint.second)
    parts, column = [*vector, arm[0] * vector[1] - arm[1] * vector[0]], {}
    for block, way in ((first, -1), (second, 1)):
        if block in number:
            column.update({3 * number[block] + k: Fraction(way * part) for k, part in enumerate(parts) if part})
    return column


def _load(exact: ExactScene, number: dict[int, int], origin: np.ndarray) -> list[Fraction]:
    """Loads on the blocks that move, with moments about the origin."""
    scene, found = exact.scene, []
    load = loads_on(scene.deck, scene.source, scene.blocks)
    for block in number:
        fx, fy, moment = load[block - 1]
        arm = scene.blocks[block - 1].centre - origin
        found += [Fraction(fx), Fraction(fy), Fraction(moment + arm[0] * fy - arm[1] * fx)]
    return found


def _numbers(exact: ExactScene) -> dict[int, int]:
    """Place of each block that moves."""
    return {block: k for k, block in enumerate(block.number for block in exact.scene.blocks if not block.fixed)}


def proves(exact: ExactScene, carried: bool) -> bool:
    """Whether forces that carry the loads, or a mechanism that the loads drive, are proven exactly."""
    number, origin = _numbers(exact), exact.corners[0][0]
    nudge = -NUDGE if carried else NUDGE
    right = [-value for value in _load(exact, number, origin)] + _bounds(exact, nudge)
    columns = _columns(exact, nudge, number, origin)
    # equal forces and one of the last column are a beginning; the least of that column is the share that is not carried
    rest, equal = dict(enumerate(right)), max(abs(value) for value in right)
    for column in columns:
        for i, value in column.items():
            rest[i] -= equal * value
    found = find_best([*columns, {i: value for i, value in rest.items() if value}], right, -1)
    return found is not None and (found[-1] == 0) is carried


def limit(exact: ExactScene, name: str, way: int) -> tuple[Fraction, Fraction] | None:
    """The largest value of a load's coefficient, from below by forces and from above by a mechanism.

    Towards larger values (way 1) or smaller ones (-1); None where there is no limit, or none was proven.
    """
    number, origin = _numbers(exact), exact.corners[0][0]
    loads = []
    for value in (0, way, 2 * way):
        scene = replace(exact.scene, deck=exact.scene.deck.with_value(name, str(value)))
        loads.append(_load(replace(exact, scene=scene), number, origin))
    dead, once, twice = loads
    if [b - a for a, b in zip(dead, once)] != [b - a for a, b in zip(once, twice)]:
        raise VerifyError(f"loads are not linear in {name}")
    live = {i: b - a for i, (a, b) in enumerate(zip(dead, once)) if b != a}
    found = []
    for nudge in (-NUDGE, NUDGE):
        columns = _columns(exact, nudge, number, origin)
        right = [-value for value in dead] + _bounds(exact, nudge)
        vertex = find_best([*columns, live], right, 1)
        if vertex is None:
            return None
        found.append(way * vertex[-1])
    return min(found), max(found)


def check_exactly(deck: Deck, files: list[Path], rows: dict[str, list[Row]], finding: Finding) -> None:
    """Prove the limit of a case, or its verdict where it has none, from its files and its rows of each table.

    The finding receives an interval that contains the limit, and what is wrong.
    """
    (result,), name = rows["results"], deck.searched or "load_factor"

    def scene(value: str | None = None) -> ExactScene:
        exact = exact_scene(deck if value is None else deck.with_value(name, value), rows["blocks"], files)
        if len(exact.scene.joints) > MOST_JOINTS:
            raise VerifyError(f"expected at most {MOST_JOINTS} joints for --exact, got {len(exact.scene.joints)}")
        if any(math.isfinite(exact.scene.crush(joint)) for joint in exact.scene.joints):
            raise VerifyError("joints that crush are not proven exactly: their law is no cone")
        return exact

    if result["exact_low"] and name in LINEAR:
        bounds = [Fraction(result["exact_low"]), Fraction(result["exact_high"])]
        proven = limit(scene(), name, -1 if result["collapses_at"] == "low" else 1)
        if proven is None or not bounds[0] <= proven[0] <= proven[1] <= bounds[1]:
            got = "none was proven" if proven is None else f"got {float(proven[0])!r}"
            finding.faults.append(f"limit expected from exact_low to exact_high by rational arithmetic, {got}")
            return
        ours = (bounds[0] + bounds[1]) / 2
        _keep_interval(name, min(ours, proven[0]), max(ours, proven[1]), finding)
        return
    falls: list[str | None] = [row["value"] for row in rows["proof_motion"][:1]]
    carries: list[str | None] = [row["value"] for row in rows["proof_forces"][:1]]
    if deck.searched is None:
        carries, falls = [None for _ in carries], [None for _ in falls]
    elif name == "thickness_ratio" and result["exact"]:
        exact = Fraction(result["exact"])
        carries, falls = [str(exact * (1 + HALF_WIDTH))], [str(exact * (1 - HALF_WIDTH))]
    for value, expected in [*((value, True) for value in carries), *((value, False) for value in falls)]:
        if not proves(scene(value), expected):
            at = "" if value is None else f" at {name} = {float(Fraction(value))!r}"
            what = "forces that carry the loads" if expected else "a mechanism that the loads drive"
            finding.faults.append(f"expected {what}{at} by rational arithmetic, none was proven")
    if deck.searched is not None and carries and falls:
        low, high = sorted(Fraction(value) for value in (carries[0], falls[0]) if value is not None)
        _keep_interval(name, low, high, finding)
    elif carries or falls:
        at = f" at {name} = {(carries + falls)[0]}" if deck.searched is not None else ""
        what = "forces carry the loads" if carries else "the loads drive a mechanism"
        finding.interval = f"{what}{at}, proven"


def _keep_interval(name: str, low: Fraction, high: Fraction, finding: Finding) -> None:
    """Print an interval, rounded outward."""
    below, above = math.nextafter(float(low), -math.inf), math.nextafter(float(high), math.inf)
    finding.interval = f"{name} is critical from {below!r} to {above!r}, proven; width {above - below:.1e}"
