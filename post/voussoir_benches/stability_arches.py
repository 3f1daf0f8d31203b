"""Stiff and extreme arches, whose critical thickness limit analysis knows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from voussoir import theory
from voussoir_benches.expectations import Critical, Refused, Same, Verdict
from voussoir_benches.scene import Scene

#: Weight of a cubic metre of the decks' default masonry [N/m3]
UNIT_WEIGHT = 2240.0 * 9.81
#: Young's modulus with which moving blocks come near to rigid ones [Pa]
NEARLY_RIGID = 5e12
#: Friction angles from here on mean that nothing slides [deg]
NO_SLIP_DEG = 89.9

_SEARCH: dict[str, Any] = {"search": {"parameter": "thickness_ratio"}}


def exact_thickness(arch: dict[str, Any], friction_deg: float = 50.0) -> float | None:
    """Critical thickness ratio by limit analysis of the same polygons: 0 where each stands, None where none does."""
    options: dict[str, Any] = {
        "facet": math.radians(arch["facet_deg"]) if "facet_deg" in arch else None,
        "friction": None if friction_deg >= NO_SLIP_DEG else math.radians(friction_deg),
        "springing_no_slip": arch.get("springing") == "no-slip",
    }
    if "joints_deg" in arch:
        solution = theory.discrete_solution(np.radians(arch["joints_deg"]), **options)
    else:
        solution = theory.discrete_solution(
            arch.get("voussoirs", 36), math.radians(arch.get("half_angle_deg", 90.0)), **options)
    return {"found": solution.eta, "stands_always": 0.0, "none_admissible": None}[solution.status]


def searched(
    group: str, name: str, guard: str, arch: dict[str, Any] | None = None, friction_deg: float = 90.0,
    current: bool = False, **others: dict[str, Any]
) -> Scene:
    """A search for the critical thickness; where blocks move it may differ by what elasticity explains."""
    arch = {"voussoirs": 36, "half_angle_deg": 90.0} if arch is None else arch
    exact = exact_thickness(arch, friction_deg)
    deck = {"arch": arch, "joint": {"friction_deg": friction_deg}, **_SEARCH, **others}
    expectation = Critical(exact)
    if current:
        deck["analysis"] = {"geometry": "current", **others.get("analysis", {})}
        deck["material"] = {"young": NEARLY_RIGID, **others.get("material", {})}
        elastic = UNIT_WEIGHT * arch.get("radius", 10.0) / deck["material"]["young"]
        expectation = Critical(exact, 30.0 * elastic + 1e-7 * (exact or 0.0))
    return Scene(group, name + (", moving" if current else ""), deck, expectation, guard)


def arches() -> Iterator[Scene]:
    """All arches but the random ones."""
    yield from _stiffness()
    yield from _friction()
    yield from _near_critical()
    yield from _shapes()
    yield from _scales()
    yield from _steps()
    yield from _refused()


def _stiffness() -> Iterator[Scene]:
    """Young's modulus and penalty."""
    guard = "verdict by energy shares: no length or stiffness in it"
    for exponent in range(6, 19):
        for unknowns in (3, 6):
            yield searched(
                "Young's modulus", f"1e{exponent} Pa, {unknowns} unknowns", guard, material={"young": 10.0**exponent},
                analysis={"unknowns": unknowns})
    for exponent in range(9, 19):
        yield searched(
            "Young's modulus", f"1e{exponent} Pa", "collapse at 100 elastic motions", current=True,
            material={"young": 10.0**exponent})
    for exponent in range(-2, 9):
        for unknowns in (3, 6):
            yield searched(
                "penalty ratio", f"1e{exponent}, {unknowns} unknowns", "step no longer than 2 m/dt2 = 1e-13 p",
                analysis={"penalty_ratio": 10.0**exponent, "unknowns": unknowns})
    for exponent in range(-2, 9, 2):
        yield searched(
            "penalty ratio", f"1e{exponent}", "multipliers within the step", current=True,
            analysis={"penalty_ratio": 10.0**exponent})


def _friction() -> Iterator[Scene]:
    """Friction angles."""
    angles = (0.0, 1e-3, 1.0, 5.0, 10.0, 17.0, 17.5, 18.0, 20.0, 21.0, 21.5, 21.6, 22.0, 30.0, 45.0)
    for angle in (*angles, 60.0, 75.0, 85.0, 88.0, 89.0, 89.5, 89.89, 89.9, 89.99):
        yield searched("friction", f"{angle:g} deg", "convex cone first, then Coulomb", friction_deg=angle)
    for half_angle in (135.0, 140.0, 145.0):
        arch = {"half_angle_deg": half_angle, "voussoirs": round(half_angle * 0.4)}
        for angle in range(55, 90, 5):
            for current in (False, True):
                yield searched(
                    "friction, large angles", f"{half_angle:g} deg, friction {angle} deg",
                    "convex cone first, then Coulomb by Anderson's acceleration", arch, friction_deg=float(angle),
                    current=current)


def _near_critical() -> Iterator[Scene]:
    """Decisions on both sides of critical."""
    arches = ((10.0, 12), (20.0, 8), (45.0, 18), (90.0, 36), (90.0, 1000), (140.0, 56), (150.0, 60))
    for half_angle, voussoirs in arches:
        arch = {"half_angle_deg": half_angle, "voussoirs": voussoirs}
        exact = float(exact_thickness(arch, 90.0) or 0.0)
        for distance in (-1e-3, -1e-6, -1e-8, -1e-9, 1e-9, 1e-8, 1e-6, 1e-3):
            deck = {"arch": {**arch, "thickness_ratio": exact * (1.0 + distance)}}
            yield Scene(
                "near critical", f"{half_angle:g} deg, {voussoirs} voussoirs, {distance:+.0e}",
                {**deck, "joint": {"friction_deg": 90.0}}, Verdict("stable" if distance > 0.0 else "collapsed"),
                "rest follows the half angle and the rounding of weights")


def _shapes() -> Iterator[Scene]:
    """Half angles, numbers of voussoirs, slivers, aspect ratios."""
    shallow = "bracket no narrower than rounding allows, else undecided"
    for half_angle in (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 60.0, 75.0):
        arch = {"half_angle_deg": half_angle, "voussoirs": 18}
        yield searched("half angle", f"{half_angle:g} deg", shallow, arch)
    for half_angle in (100.0, 110.0, 120.0, 130.0, 135.0, 140.0, 145.0, 148.0, 150.0):
        arch = {"half_angle_deg": half_angle, "voussoirs": round(half_angle * 0.4)}
        for current in (False, True):
            yield searched("half angle", f"{half_angle:g} deg", "", arch, current=current)
    for count in (3, 4, 5, 6, 7, 8, 9, 10, 11, 35, 37, 99, 100, 360, 1000, 3000, 10000):
        arch = {"half_angle_deg": 90.0, "voussoirs": count}
        yield searched("voussoirs", f"{count}", "only the worst joint changes its face", arch)
    for half_angle, count in ((45.0, 1000), (140.0, 1000), (45.0, 3000), (140.0, 3000)):
        arch = {"half_angle_deg": half_angle, "voussoirs": count}
        yield searched("voussoirs", f"{count}, {half_angle:g} deg", "", arch)
    for width in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        for place, joints in (
            ("crown", [0.0, width, 54.5, 90.0]),
            ("haunch", [0.0, 54.5, 54.5 + width, 90.0]),
            ("springing", [0.0, 54.5, 90.0 - width, 90.0]),
        ):
            name = f"{width:g} deg at the {place}"
            sliver = {"joints_deg": joints, "facet_deg": 0.5}
            yield searched("sliver", name, "joints differ by 100 in stiffness at most", sliver)
    for ratio in (1e-6, 1e-4, 1e-2):
        yield _decided("aspect ratio", f"4 voussoirs, thickness {ratio:g} r", 4, ratio, "collapsed")
        yield _decided("aspect ratio", f"3 voussoirs, thickness {ratio:g} r", 3, ratio, "stable")
    for count in (4, 100, 10000):
        for ratio in (0.5, 1.5, 1.99):
            name = f"{count} voussoirs, thickness {ratio:g} r"
            yield _decided("aspect ratio", name, count, ratio, "stable")


def _decided(group: str, name: str, voussoirs: int, ratio: float, word: str) -> Scene:
    """A decision of a semicircle."""
    arch = {"voussoirs": voussoirs, "half_angle_deg": 90.0, "thickness_ratio": ratio}
    deck = {"arch": arch, "joint": {"friction_deg": 90.0}}
    return Scene(group, name, deck, Verdict(word), "rest above what rounding makes of weights")


def _scales() -> Iterator[Scene]:
    """Units: lengths, densities, weights; directions."""
    guard = "every threshold is a ratio"
    arch = {"voussoirs": 36, "half_angle_deg": 90.0}
    for exponent in (-9, -6, -3, 0, 3, 6, 7, 9):
        radius = {**arch, "radius": 10.0**exponent}
        yield searched("scale", f"radius 1e{exponent} m", guard, radius)
    for exponent in (-12, -6, 0, 9, 18, 30):
        yield searched("scale", f"density 1e{exponent} kg/m3", guard, material={"density": 10.0**exponent})
        yield searched("scale", f"weight 1e{exponent} N/m3", guard, material={"unit_weight": 10.0**exponent})
    for exponent in (-12, -6, 6, 12):
        load = {"gravity": 10.0**exponent}
        yield searched("scale", f"gravity 1e{exponent} m/s2", guard, load=load)
    for tilt in (1.0, 17.3):
        sweep = {"parameter": "gravity_direction_deg", "values": [-90.0 - tilt, -90.0 + tilt]}
        deck = {"arch": arch, **_SEARCH, "sweep": sweep}
        yield Scene("direction", f"tilted by {tilt:g} deg, mirrored", deck, Same(1e-8), guard)
    for ratio in (0.12, 0.15, 0.3, 1.0):
        thick = {**arch, "thickness_ratio": ratio}
        deck = {"arch": thick, "load": {"gravity_direction_deg": 90.0}}
        yield Scene("direction", f"gravity up, {ratio:g} r", deck, Verdict("collapsed"), guard)


def _steps() -> Iterator[Scene]:
    """Lengths of the first step, tolerances."""
    for exponent in range(-7, 4):
        for current in (False, True)[: 1 + (exponent <= 0)]:
            yield searched(
                "time step", f"1e{exponent} s", "steps grow by ten to the longest that is well conditioned",
                current=current, analysis={"time_step": 10.0**exponent})
    for exponent in range(-15, -1):
        yield searched(
            "tolerance", f"1e{exponent}", "bracket no narrower than rounding allows",
            search={"parameter": "thickness_ratio", "tolerance": 10.0**exponent})


def _refused() -> Iterator[Scene]:
    """Input that means nothing."""
    for group, key, value in (
        ("material", "young", 0.0),
        ("material", "young", -5e9),
        ("material", "poisson", 0.5),
        ("material", "poisson", -1.0),
        ("material", "density", 0.0),
        ("material", "density", -1.0),
        ("joint", "friction_deg", 90.1),
        ("arch", "thickness_ratio", 2.0),
        ("arch", "joints_deg", [0.0, 54.5, 54.5, 90.0]),
        ("arch", "half_angle_deg", 180.0),
        ("load", "gravity", 0.0),
        ("analysis", "unknowns", 4),
    ):
        deck: Any = {"arch": {"thickness_ratio": 0.15}, group: {key: value}}
        yield Scene("bad input", f"{key} {value}", deck, Refused(key), "ranges of the deck's keys")
    for word in ("NaN", "Inf", "1e999"):
        deck = f"&material young = {word} /\n".encode()
        yield Scene("bad input", f"young {word}", deck, Refused("young"), "numbers are finite")


def random_arches(count: int, seed: int) -> Iterator[Scene]:
    """Searches with half angle, joints, friction, springing and plan at random; blocks of every fifth one move."""
    chance = np.random.default_rng(seed)
    for number in range(1, count + 1):
        half_angle = float(np.round(chance.uniform(8.0, 150.0), 3))
        arch: dict[str, Any] = {}
        if chance.random() < 0.4:
            inner = np.unique(np.round(chance.uniform(0.0, half_angle, chance.integers(1, 15)), 3))
            inner = inner[(inner > 0.0) & (inner < half_angle - 1e-3)]
            arch["joints_deg"] = [0.0, *inner.tolist(), half_angle]
            arch["facet_deg"] = float(chance.choice([0.5, 1.0, 3.0, 10.0]))
            shape = f"{2 * (len(inner) + 1)} unequal blocks"
        else:
            arch["half_angle_deg"] = half_angle
            arch["voussoirs"] = int(np.round(10.0 ** chance.uniform(np.log10(4.0), 2.5)))
            if chance.random() < 0.3:
                arch["facet_deg"] = float(chance.choice([0.5, 1.0, 3.0, 10.0]))
            shape = f"{arch['voussoirs']} voussoirs"
        if chance.random() < 0.3:
            arch["springing"] = "no-slip"
        friction = float(np.round(chance.choice([chance.uniform(0.0, 89.8), 90.0]), 2))
        plan = {"analysis": {"unknowns": 6}} if chance.random() < 0.2 else {}
        yield searched(
            "random", f"{number}: {half_angle:g} deg, {shape}, friction {friction:g}", "", arch, friction_deg=friction,
            current=number % 5 == 0, **plan)
