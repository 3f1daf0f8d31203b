"""Error and run time of many settings of dda, and of linear programs, in one run on one machine."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from voussoir import limit_lp, theory
from voussoir.deck_runs import Row, run_deck

#: Friction angle of all joints [deg]: enough for a rotational collapse at every half angle here
FRICTION_DEG = 60.0
#: Distances from critical at which decisions are timed
DISTANCES = (-1e-3, -1e-5, 1e-5, 1e-3)


@dataclass(frozen=True)
class Arch:
    """An arch of equal voussoirs.

    Attributes
    ----------
    half_angle_deg
        Half angle of embrace [deg].
    voussoirs
        Their number.
    """

    half_angle_deg: float
    voussoirs: int

    def exact(self) -> float:
        """Critical thickness ratio by limit analysis."""
        alpha, friction = math.radians(self.half_angle_deg), math.radians(FRICTION_DEG)
        return float(theory.discrete_critical(self.voussoirs, alpha, friction=friction))

    def deck(self) -> str:
        """Groups of a deck that all runs share."""
        return (
            f"&arch half_angle_deg = {self.half_angle_deg}, voussoirs = {self.voussoirs} /\n"
            f"&joint friction_deg = {FRICTION_DEG} /\n&output joints = .false., blocks = .false. /\n"
        )


@dataclass(frozen=True)
class Point:
    """One point of a diagram.

    Attributes
    ----------
    arch
        What was searched.
    family
        What was varied, and with what else.
    setting
        The value it had.
    error
        Relative error of the critical thickness ratio; None where none was found.
    seconds
        Median time.
    decisions
        Factorisations of dda; decisions of a linear program.
    """

    arch: Arch
    family: str
    setting: str
    error: float | None
    seconds: float
    decisions: int


#: Family, group and key, values, further keys of &analysis and &material
_FAMILIES: tuple[tuple[str, str, str, tuple[float, ...], str], ...] = (
    ("tolerance", "search", "tolerance", tuple(10.0**-k for k in range(2, 13)), ""),
    (
        "tolerance, 6 unknowns",
        "search",
        "tolerance",
        tuple(10.0**-k for k in range(2, 13, 2)),
        "&analysis unknowns = 6 /\n",
    ),
    ("penalty", "analysis", "penalty_ratio", tuple(10.0**k for k in range(-2, 7, 2)), ""),
    ("first step", "analysis", "time_step", tuple(10.0**k for k in range(-4, 3)), ""),
    ("most steps", "analysis", "steps", (2, 3, 4, 6, 10, 50), ""),
    (
        "Young's modulus, moving",
        "material",
        "young",
        tuple(5.0 * 10.0**k for k in range(8, 13)),
        "&analysis geometry = 'current' /\n",
    ),
    (
        "displacement a step, moving",
        "analysis",
        "max_displacement_ratio",
        (0.5, 0.05, 0.005),
        "geometry = 'current'",
    ),
    (
        "penalty, moving",
        "analysis",
        "penalty_ratio",
        (1.0, 10.0, 100.0, 1000.0),
        "geometry = 'current'",
    ),
    (
        "Limerick's scheme, tolerance",
        "search",
        "tolerance",
        (1e-1, 1e-2, 1e-3),
        "&analysis mode = 'limerick' /\n",
    ),
)
#: Arches of more voussoirs than this are searched with blocks that do not move only
MOST_MOVING = 100


def dda_points(arch: Arch, folder: Path, repeats: int) -> Iterator[Point]:
    """Searches by dda with every setting.

    Parameters
    ----------
    arch : Arch
        What is searched.
    folder : Path
        Where decks and results go.
    repeats : int
        Runs of each setting; the median counts.

    Yields
    ------
    Point
        One a setting.
    """
    exact = arch.exact()
    for family, group, key, values, more in _FAMILIES:
        original = family.startswith("Limerick")
        if ("moving" in family or original) and arch.voussoirs > MOST_MOVING:
            continue
        for value in values:
            keys = {"search": "parameter = 'thickness_ratio'"}
            text = more
            if more and not more.startswith("&"):
                keys[group] = more
                text = ""
            keys[group] = ", ".join(filter(None, [keys.get(group), f"{key} = {value!r}"]))
            groups = "".join(f"&{name} {line} /\n" for name, line in keys.items())
            deck = arch.deck() + text + groups
            deck += f"&sweep parameter = 'radius', values = {1 if original else repeats}*10.0 /\n"
            rows = run_deck(deck, folder / f"{arch.half_angle_deg:g}_{arch.voussoirs}").rows
            if rows:
                yield _dda_point(arch, family, f"{value:g}", rows, exact)


def _dda_point(arch: Arch, family: str, setting: str, rows: list[Row], exact: float) -> Point:
    """The point of repeated rows."""
    found = rows[0]["verdict"] == "found"
    error = abs(float(rows[0]["critical"]) / exact - 1.0) if found else None
    seconds = statistics.median(float(row["seconds"]) for row in rows)
    return Point(arch, family, setting, error, seconds, int(rows[0]["factorisations"]))


def bisected(arch: Arch, stands: Callable[..., bool], family: str) -> Iterator[Point]:
    """A critical thickness by bisection of linear programs, from 20 % below to 20 % above.

    Parameters
    ----------
    arch : Arch
        What is searched.
    stands : callable
        One of `limit_lp.stands_by_general` and `limit_lp.stands_by_compact`.
    family : str
        Name of the family.

    Yields
    ------
    Point
        One a tolerance.
    """
    exact = arch.exact()
    low, high = 0.8 * exact, 1.2 * exact
    goals = [10.0**-k for k in range(2, 9)]
    decisions = 0
    start = time.perf_counter()
    while goals:
        middle = (low + high) / 2.0
        if decide(arch, stands, middle):
            high = middle
        else:
            low = middle
        decisions += 1
        while goals and high - low <= goals[0] * middle:
            error = abs((low + high) / 2.0 / exact - 1.0)
            seconds = time.perf_counter() - start
            yield Point(arch, family, f"{goals.pop(0):g}", error, seconds, decisions)


def decide(arch: Arch, stands: Callable[..., bool], ratio: float) -> bool:
    """One decision of a linear program."""
    alpha, friction = math.radians(arch.half_angle_deg), math.tan(math.radians(FRICTION_DEG))
    return stands(alpha, arch.voussoirs, ratio, friction)


@dataclass(frozen=True)
class Race:
    """Times of one decision [s], and of one search: the least at each ratio, of these the median.

    Attributes
    ----------
    arch
        What was decided.
    decision
        One decision of dda, its arch built within.
    right
        Decisions of dda that came out right, of four.
    search
        One search of dda to 1e-8.
    general, compact
        One decision of the linear programs, built and solved; None without scipy.
    general_right, compact_right
        Their decisions that came out right, of four.
    """

    arch: Arch
    decision: float
    right: int
    search: float
    general: float | None
    general_right: int
    compact: float | None
    compact_right: int


def race(arch: Arch, folder: Path, repeats: int) -> Race:
    """Time decisions of dda and of both linear programs in turn.

    Parameters
    ----------
    arch : Arch
        What is decided, at four distances from critical.
    folder : Path
        Where decks and results go.
    repeats : int
        Rounds.

    Returns
    -------
    Race
        The least times of all rounds.
    """
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
        right["decision"] = sum(
            (row["verdict"] == "stable") == stands for row, stands in zip(rows[:4], truth)
        )
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
    least = {name: _middle_of_least(found) for name, found in times.items()}
    return Race(
        arch,
        least["decision"],
        right["decision"],
        least["search"],
        least["general"],
        right["general"],
        least["compact"],
        right["compact"],
    )


def _middle_of_least(times: list[list[float]]) -> float | None:
    """Least time of each ratio, for other work can only add to it; of these the median."""
    least = [min(found) for found in times if found]
    return statistics.median(least) if least else None
