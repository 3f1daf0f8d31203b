"""Random bridges of 1 to 4 rings with fill and strength: their bounds, brackets, and the same bridges mirrored.

`python3 crushing_bridges.py --dda build/bin/dda --count 300 --seed 1` searches the load factor under Coulomb friction.
Status 1 if one is undecided, takes more than five seconds, leaves its bounds, or is contradicted by its mirror image.
"""

from __future__ import annotations

import math
import random
import re
import resource
import sys
from dataclasses import replace
from pathlib import Path

from random_bridges import Bridge, campaign, group, random_arch, random_fill, rounded, run

#: Processor time that a search may take [s]
MOST_SECONDS = 5.0
#: Error of a limit by limit analysis, and what forces may leave of a load
SAME = 1e-8


def crushing_bridge(seed: int) -> tuple[Bridge, float]:
    """A bridge and the position of its leftmost axle."""
    pick = random.Random(f"crushing {seed}")
    span = rounded(math.exp(pick.uniform(math.log(2.0), math.log(20.0))))
    arch = random_arch(pick, span)
    rings = pick.randint(1, 4)
    arch.pop("rings", None)
    if rings > 1:
        arch["rings"] = rings
        arch["voussoirs"] = min(arch["voussoirs"], 20)
    groups = group("arch", arch)
    if pick.random() < 0.85:
        groups += group("joint", {"friction_deg": rounded(pick.uniform(18.0, 65.0))})
    groups += group("fill", random_fill(pick, span))
    material = {"compressive_strength": rounded(10.0 ** pick.uniform(5.5, 7.5))}
    if pick.random() < 0.5:
        material["unit_weight"] = rounded(pick.uniform(16e3, 27e3))
    groups += group("material", material)
    if pick.random() < 0.15:
        groups += group("load", {"horizontal_coefficient": rounded(pick.uniform(-0.1, 0.1))})
    axles = [rounded(pick.uniform(5e3, 120e3)) for _ in range(pick.choice((1, 1, 2, 2, 3, 4, 5)))]
    spacings = [rounded(span * pick.uniform(0.05, 0.6)) for _ in axles[1:]]
    length = pick.choice((0.0, 0.3, 0.3, rounded(span * pick.uniform(0.01, 0.1))))
    return Bridge(groups, axles, spacings, length, "coulomb"), rounded(span * pick.uniform(-0.45, 0.3))


def number(groups: str, key: str, default: float) -> float:
    """A number of a deck."""
    found = re.search(rf"\b{key} = ([-+.\de]+)", groups)
    return float(found[1]) if found else default


def mirrored(bridge: Bridge, place: float) -> tuple[Bridge, float] | None:
    """The bridge seen from the other side; none if its springings lie at different heights."""
    if "right_rise" in bridge.groups:
        return None
    groups = re.sub(r"(horizontal_coefficient = )([-+.\de]+)", lambda text: f"{text[1]}{-float(text[2])!r}",
                    bridge.groups)
    others = number(groups, "spans", 1.0) - 1.0
    middle = 0.5 * others * (number(groups, "span", 0.0) + number(groups, "pier_width", 0.0))
    other = replace(bridge, groups=groups, axles=bridge.axles[::-1], spacings=bridge.spacings[::-1])
    return other, 2.0 * middle - place - sum(bridge.spacings)


def bounds(row: dict[str, str]) -> list[float]:
    """Least, likely and largest factor that a row leaves, and its associated limit."""
    if row["verdict"] == "collapsed":
        return [0.0, 0.0, 0.0, math.inf]
    return [float(row[key]) for key in ("critical_low", "critical", "critical_high", "exact_high")]


def outside(row: dict[str, str]) -> str:
    """What an answer says against itself; empty if nothing."""
    low, value, high, limit = bounds(row)
    if not 0.0 <= low <= value <= high:
        return f"{value} is not between {low} and {high}"
    if high > limit * (1.0 + SAME):
        return f"{high} is beyond the associated limit {limit}"
    if row["verdict"] == "found" and not max(float(row["imbalance"]), float(row["law_violation"])) <= SAME:
        return f"forces leave {row['imbalance']} and violate {row['law_violation']}"
    return ""


def contradiction(row: dict[str, str], other: dict[str, str]) -> str:
    """What the mirrored bridge says against a row; empty if nothing, or if it is another one."""
    mine, its = bounds(row), bounds(other)
    if row["verdict"] == other["verdict"] == "found" and abs(mine[3] / its[3] - 1.0) > SAME:
        # tapered rings between piers are not quite symmetric
        return ""
    if mine[0] <= its[1] <= mine[2] and its[0] <= mine[1] <= its[2]:
        return ""
    return f"{row['verdict']} {mine[:3]}, mirrored {other['verdict']} {its[:3]}"


def timed(dda: str, folder: Path, bridge: Bridge, place: float) -> tuple[dict[str, str] | None, float]:
    """The row of a bridge, none if it is refused, and its processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = run(dda, folder, "x", bridge.deck(f"position = {place!r}"))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return found[0] if found else None, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def check(dda: str, folder: Path, seed: int) -> tuple[str, list[str]]:
    """Verdict of a bridge, empty if it is refused, and its faults."""
    bridge, place = crushing_bridge(seed)
    row, seconds = timed(dda, folder, bridge, place)
    if row is None:
        return "", []
    faults = [f"{seconds:.1f} s"] if seconds > MOST_SECONDS else []
    if row["verdict"] == "undecided":
        return "undecided", [*faults, "undecided"]
    faults.append(outside(row))
    image = mirrored(bridge, place)
    if image:
        other, _ = timed(dda, folder, *image)
        assert other is not None
        faults.append("mirrored: undecided" if other["verdict"] == "undecided" else contradiction(row, other))
    return row["verdict"], [text for text in faults if text]


if __name__ == "__main__":
    sys.exit(campaign(__doc__, 300, check))
