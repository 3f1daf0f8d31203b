"""Classes of scenes whose error against run time is drawn: decks, answers, methods and their settings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from voussoir_benches.scene import BLOCKS, Corners, rectangle, written_block, written_blocks
from voussoir_benches.stability_blocks import wall as half_bond

RIGID = "DDA, rigid blocks"  #: Names of the methods, as legends have them; where each stands is a panel's affair
ELASTIC = "DDA, elastic blocks"
COULOMB = "DDA, Coulomb friction"
ASSOCIATED = "DDA, associated limit"
ORIGINAL = "Shi's scheme"
SIMPLEX = "HiGHS, simplex (associated)"
INTERIOR = "HiGHS, interior point (associated)"
#: Tolerances of searches by dda, and of the original's
_FINE = tuple({"search": {"tolerance": 10.0**-k}} for k in (1, 2, 4, 6, 8, 10, 12))
_COARSE = tuple({"search": {"tolerance": 10.0**-k}} for k in (1, 2, 3))
HIGHS_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-10)  #: Tolerances of HiGHS: it takes none below 1e-10

Settings = tuple[Mapping[str, Any], ...]


@dataclass(frozen=True)
class SceneClass:
    """A class of scenes, by one of them."""

    name: str  #: A word for tables
    title: str  #: What it is, for its panel
    groups: dict[str, Any]  #: What all decks of it share
    methods: dict[str, Settings]  #: Settings of each method of dda: groups that go before the shared ones
    friction_deg: float  #: Of all joints
    files: dict[str, str] = field(default_factory=dict)  #: Files beside the deck
    live_block: int | None = None  #: Block of the live load, where there is one
    live_point: tuple[float, float] = (0.0, 0.0)  #: Where it acts


def _each(group: str, key: str, values: tuple[Any, ...], **more: Any) -> Settings:
    """Settings that vary one key; further groups hold for all."""
    return tuple({**more, group: {**more.get(group, {}), key: value}} for value in values)


def _with(settings: Settings, **analysis: Any) -> Settings:
    """Settings with keys of &analysis."""
    return tuple({**one, "analysis": {**one.get("analysis", {}), **analysis}} for one in settings)


def _searched(kind: Mapping[str, Any], parameter: str, friction: float) -> dict[str, Any]:
    """Groups of decks with a search."""
    return {
        **kind, "joint": {"friction_deg": friction}, "output": {"joints": False, "blocks": False, "proof": False},
        "search": {"parameter": parameter}}


def arch() -> SceneClass:
    """A semicircle of 36 voussoirs: its critical thickness."""
    groups = _searched({"arch": {"half_angle_deg": 90.0, "voussoirs": 36}}, "thickness_ratio", 60.0)
    stiffness = _each("analysis", "penalty_ratio", (1.0, 1e4))
    methods = {
        RIGID: _FINE + stiffness,
        ELASTIC: _with(_FINE + stiffness, unknowns=6),
        ORIGINAL: _with(_COARSE, mode="limerick"),
    }
    return SceneClass("arch", "Arch: critical thickness of 36 voussoirs", groups, methods, 60.0)


def moving_arch() -> SceneClass:
    """The same with blocks that move: how far its answer is from that of rigid ones."""
    groups = _searched({"arch": {"half_angle_deg": 90.0, "voussoirs": 36}}, "thickness_ratio", 60.0)
    current = {"analysis": {"geometry": "current"}, "search": {"tolerance": 1e-6}}
    young = tuple(5.0 * 10.0**k for k in range(8, 14))
    methods = {
        ELASTIC: _each("material", "young", young, **current)
        + _with(_each("search", "tolerance", (1e-2, 1e-4, 1e-8), material={"young": 5e12}), geometry="current"),
        RIGID: _with(
            _each("search", "tolerance", (1e-2, 1e-4, 1e-6, 1e-8))
            + _each("analysis", "penalty_ratio", (1.0, 10.0, 1000.0), search={"tolerance": 1e-6}),
            geometry="current",
            unknowns=3,
        ),
        ORIGINAL: _each("material", "young", (5e9, 5e11), analysis={"mode": "limerick"}, search={"tolerance": 1e-2}),
    }
    return SceneClass("moving arch", "Arch that moves: critical thickness", groups, methods, 60.0)


def wall(courses: int = 8, bricks: int = 5) -> SceneClass:
    """A wall of bricks, half a brick displaced: the horizontal load at collapse."""
    text = written_block(rectangle(-1.0, -0.5, bricks + 2.0, 0.5), "fixed")
    text += written_blocks(half_bond(courses, bricks, 1.0, 0.5))
    kind = {"scene": {"kind": "blocks", "geometry": BLOCKS}}
    groups = _searched(kind, "horizontal_coefficient", 30.0)
    original = tuple({"search": {"low": 0.1, "high": 1.0, "tolerance": 10.0**-k}} for k in (1, 2))
    methods = {COULOMB: _FINE, ASSOCIATED: _with(_FINE, flow="associated"), ORIGINAL: _with(original, mode="limerick")}
    title = f"Wall of {courses} courses: horizontal load at collapse"
    return SceneClass("wall", title, groups, methods, 30.0, {BLOCKS: text})


def three_rings(rings: int = 3, voussoirs: int = 16) -> SceneClass:
    """An arch of three rings that slide on one another: the load at its quarter point."""
    inner, depth, half = 5.0, 0.25, math.radians(75.0)
    angles = [half * (2.0 * k / voussoirs - 1.0) for k in range(voussoirs + 1)]

    def point(radius: float, angle: float) -> tuple[float, float]:
        return radius * math.sin(angle), radius * math.cos(angle)

    shapes: list[Corners] = []
    for ring in range(rings):
        low, high = inner + ring * depth, inner + (ring + 1) * depth
        shapes += [[point(low, a), point(high, a), point(high, b), point(low, b)] for a, b in zip(angles, angles[1:])]
    text = "".join(map(written_block, shapes))
    outer = inner + rings * depth
    for angle, side in ((angles[0], -1.0), (angles[-1], 1.0)):
        away = side * math.cos(angle), -side * math.sin(angle)
        near = [point(inner - 0.2, angle), point(outer + 0.2, angle)]
        far = [(x + away[0], y + away[1]) for x, y in reversed(near)]
        text += written_block([*near, *far], "fixed")
    quarter = voussoirs // 4
    a, b = (point(outer, angles[quarter + k]) for k in (0, 1))
    x, y = (a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0
    number = (rings - 1) * voussoirs + quarter + 1
    text += f"live block {number} {x!r} {y!r} 0 -1000\n"
    groups = _searched({"scene": {"kind": "blocks", "geometry": BLOCKS}}, "load_factor", 35.0)
    original = tuple({"search": {"low": 1.0, "high": 100.0, "tolerance": 10.0**-k}} for k in (1, 2))
    methods = {
        COULOMB: _FINE[1:6:2], ASSOCIATED: _with(_FINE, flow="associated"), ORIGINAL: _with(original, mode="limerick")
    }
    title = "Three rings: collapse load at the quarter point"
    return SceneClass("three rings", title, groups, methods, 35.0, {BLOCKS: text}, number, (x, y))
