"""Times of single decisions of dda and of linear programs, in turn, in one run on one machine."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from voussoir import theory
from voussoir_benches import limit_lp
from voussoir_benches.deck_runs import run_deck

FRICTION_DEG = 60.0  #: Friction angle of all joints [deg]: enough for a rotational collapse at every half angle here
DISTANCES = (-1e-3, -1e-5, 1e-5, 1e-3)  #: Distances from critical at which decisions are timed


@dataclass(frozen=True)
class Arch:
    """An arch of equal voussoirs."""

    half_angle_deg: float  #: Half angle of embrace [deg]
    voussoirs: int  #: Their number

    def exact(self) -> float:
        """Critical thickness ratio by limit analysis."""
        alpha, friction = math.radians(self.half_angle_deg), math.radians(FRICTION_DEG)
        return float(theory.discrete_critical(self.voussoirs, alpha, friction=friction))

    def deck(self) -> str:
        """Groups of a deck that all runs share."""
        return (
            f"&arch half_angle_deg = {self.half_angle_deg}, voussoirs = {self.voussoirs} /\n"
            f"&joint friction_deg = {FRICTION_DEG} /\n"
            "&output joints = .false., blocks = .false., proof = .false. /\n"
        )


def decide(arch: Arch, stands: Callable[..., bool], ratio: float) -> bool:
    """One decision of a linear program."""
    alpha, friction = math.radians(arch.half_angle_deg), math.tan(math.radians(FRICTION_DEG))
    return stands(alpha, arch.voussoirs, ratio, friction)


@dataclass(frozen=True)
class Race:
    """Times of one decision [s], and of one search: the least at each ratio, of these the median."""

    arch: Arch  #: What was decided
    decision: float  #: One decision of dda, its arch built within
    right: int  #: Decisions of dda that came out right, of four
    search: float  #: One search of dda to 1e-8
    general: float | None  #: One decision of the linear programs, built and solved; None without scipy
    general_right: int  #: Their decisions that came out right, of four
    compact: float | None
    compact_right: int


def race(arch: Arch, folder: Path, repeats: int) -> Race:
    """Time decisions of dda and of both linear programs in turn, at four distances from critical: the least times."""
    exact = arch.exact()
    ratios = [exact * (1.0 + distance) for distance in DISTANCES]
    truth = [distance > 0.0 for distance in DISTANCES]
    values = ", ".join(map(repr, ratios))
    again = "&sweep parameter = 'radius', values = 10*10.0 /\n"
    decided = f"{arch.deck()}{again}&sweep parameter = 'thickness_ratio', values = {values} /\n"
    searched = f"{arch.deck()}{again}&search tolerance = 1e-8 /\n"
    times: dict[str, list[list[float]]] = {
        name: [[] for _ in ratios] for name in ("decision", "search", "general", "compact")
    }
    right = {"decision": 0, "general": 0, "compact": 0}
    programs = {"general": limit_lp.stands_by_general, "compact": limit_lp.stands_by_compact}
    for _ in range(repeats):
        rows = run_deck(decided, folder / "decided").rows
        for number, row in enumerate(rows):
            times["decision"][number % len(ratios)].append(float(row["seconds"]))
        right["decision"] = sum((row["verdict"] == "stable") == stands for row, stands in zip(rows[:4], truth))
        rows = run_deck(searched, folder / "searched").rows
        times["search"][0] += [float(row["seconds"]) for row in rows]
        if limit_lp.scipy_version() is None:
            continue
        for name, program in programs.items():
            answers = []
            for number, ratio in enumerate(ratios):
                # processor time: waiting for other work must not count against a program
                start = time.process_time()
                answers.append(decide(arch, program, ratio))
                times[name][number].append(time.process_time() - start)
            right[name] = sum(map(bool.__eq__, answers, truth))
    least = {name: _middle_of_least(found) if any(found) else None for name, found in times.items()}
    return Race(
        arch, _middle_of_least(times["decision"]), right["decision"], _middle_of_least(times["search"]),
        least["general"], right["general"], least["compact"], right["compact"])


def _middle_of_least(times: list[list[float]]) -> float:
    """Least time of each ratio, for other work can only add to it; of these the median."""
    return statistics.median(min(found) for found in times if found)
