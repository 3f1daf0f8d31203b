"""Stiff and extreme arches, whose critical thickness limit analysis knows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from voussoir import theory
from voussoir_benches.expectations import Critical, Refused, Same, Verdict
from voussoir_benches.scene import Scene
from voussoir_benches.tables import rows

UNIT_WEIGHT = 2240.0 * 9.81  #: Weight of a cubic metre of the decks' default masonry [N/m3]
NEARLY_RIGID = 5e12  #: Young's modulus with which moving blocks come near to rigid ones [Pa]
NO_SLIP_DEG = 89.9  #: Friction angles from here on mean that nothing slides [deg]

WHOLE = {"voussoirs": 36, "half_angle_deg": 90.0}  #: The arch of scenes that name none


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
    moving: bool = False, **others: dict[str, Any]
) -> Scene:
    """A search for the critical thickness; where blocks move it may differ by what elasticity explains."""
    arch = WHOLE if arch is None else arch
    exact = exact_thickness(arch, friction_deg)
    search = {"parameter": "thickness_ratio"}
    deck: dict[str, Any] = {"arch": arch, "joint": {"friction_deg": friction_deg}, "search": search, **others}
    expectation = Critical(exact)
    if moving:
        deck["analysis"] = {"geometry": "current", **others.get("analysis", {})}
        deck["material"] = {"young": NEARLY_RIGID, **others.get("material", {})}
        elastic = UNIT_WEIGHT * arch.get("radius", 10.0) / deck["material"]["young"]
        expectation = Critical(exact, 30.0 * elastic + 1e-7 * (exact or 0.0))
    return Scene(group, name + (", moving" if moving else ""), deck, expectation, guard)


def arches() -> Iterator[Scene]:
    """All arches but the random ones."""
    names = {"exact_thickness": exact_thickness, "Refused": Refused, "Same": Same, "Verdict": Verdict}
    for row in rows("stability_arches.json", names):
        deck, answer = row.pop("deck", {}), row.pop("answer", None)
        if isinstance(deck, bytes):
            yield Scene(row["group"], row["name"], deck, answer, row["guard"])
        elif answer is None:
            yield searched(**row, **deck)
        else:
            friction = row.get("friction_deg", 90.0)
            own = {"arch": row.get("arch", WHOLE)} | ({} if friction is None else {"joint": {"friction_deg": friction}})
            yield Scene(row["group"], row["name"], {**own, **deck}, answer, row["guard"])


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
            moving=number % 5 == 0, **plan)
