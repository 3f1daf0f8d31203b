"""Random scenes with known answers, and their runs.

A module of generators has `FAMILIES`, a dictionary of names and functions. Each function takes a `random.Random` and
returns a `Scene`: the file of blocks, the keys of `&analysis`, other groups of the deck, the verdicts that are right,
and `Check`s. A check has the exact value (or 0 for the violation of an invariant), a tolerance in the unit of the
value, and the reason of the tolerance.
`run.py` lists the modules, runs scenes of any seed and counts those that are wrong.

    from scene import Check, Scene, box

    def column(pick: random.Random) -> Scene:
        \"\"\"Column between two walls: it cannot fall.\"\"\"
        blocks = box(-2, -1, 5, 1, "fixed") + box(-1, 0, 1, 3, "fixed") + box(0, 0, 1, 1) + box(1, 0, 1, 3, "fixed")
        return Scene(blocks, {"geometry": "current", "penalty_ratio": 10.0 ** pick.uniform(0, 6)}, verdicts=("stable",))

    FAMILIES = {"column": column}
"""

from __future__ import annotations

import csv
import os
import resource
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

Point = tuple[float, float]
SLOW = 20  #: Processor time [s] beyond which a scene counts as slow; the program is ended there


def block(points: list[Point], words: str = "") -> str:
    """A block of a file of blocks."""
    return f"block {words}\n" + "".join(f"{x!r} {y!r}\n" for x, y in points)


def box(left: float, low: float, width: float, height: float, words: str = "") -> str:
    """A rectangle of a file of blocks."""
    right, top = left + width, low + height
    return block([(left, low), (right, low), (right, top), (left, top)], words)


@dataclass(frozen=True)
class Run:
    """Tables and costs of one run."""

    folder: Path
    status: int
    message: str
    seconds: float  #: Processor time [s]

    @cached_property
    def result(self) -> dict[str, str]:
        """Row of results.csv."""
        return self._rows("results")[0]

    @cached_property
    def log(self) -> str:
        """Text of log.txt."""
        return (self.folder / "out" / "log.txt").read_text()

    @cached_property
    def energy(self) -> list[dict[str, float]]:
        """Rows of energy.csv, one per step."""
        return [{name: float(value) for name, value in row.items()} for row in self._rows("energy")]

    @cached_property
    def points(self) -> list[list[dict[str, float]]]:
        """Rows of points.csv for each measured point, in the order of the file."""
        found: dict[str, list[dict[str, float]]] = {}
        for row in self._rows("points"):
            found.setdefault(row["point"], []).append({name: float(value) for name, value in row.items()})
        return [found[name] for name in sorted(found, key=int)]

    def _rows(self, name: str) -> list[dict[str, str]]:
        with (self.folder / "out" / f"{name}.csv").open(newline="") as lines:
            return list(csv.DictReader(lines))


@dataclass(frozen=True)
class Check:
    """A value of a run beside its exact value."""

    name: str
    value: Callable[[Run], float]
    expected: float
    tolerance: float
    reason: str  #: Why the tolerance is what it is
    #: Largest error beyond the tolerance that truncation explains: it must fall with the square of the step at least
    truncation: float = 0.0


@dataclass(frozen=True)
class Scene:
    """Blocks, a deck, and its right answers."""

    blocks: str
    analysis: dict[str, object]  #: Keys of &analysis
    checks: list[Check] = field(default_factory=list)
    groups: str = ""  #: Other groups of the deck
    material: dict[str, object] = field(default_factory=dict)  #: Keys of &material
    verdicts: tuple[str, ...] = ("completed",)
    #: Whether the answers are the same to the tolerances at every step, with 3 and with 6 unknowns at E = 1e12
    is_step_free: bool = False
    is_second_order: bool = False  #: Whether the tolerances are those of the deck's step, and fall with its square
    may_be_undecided: bool = False  #: Whether `undecided` is counted by itself rather than as wrong

    def deck(self, **changes: object) -> str:
        """The deck, with keys of &analysis changed."""
        material = f"&material {_keys(self.material)} /\n" if self.material else ""
        return (f"&scene kind = 'blocks', geometry = 'scene.blocks' /\n{material}{self.groups}"
                f"&analysis {_keys({**self.analysis, **changes})} /\n")

    def stiff(self) -> Scene:
        """The same scene of blocks that hardly strain."""
        return replace(self, material={**self.material, "young": 1e12})


def _keys(values: dict[str, object]) -> str:
    """Keys and values of a group."""
    return ", ".join(f"{name} = {_text(value)}" for name, value in values.items())


def _text(value: object) -> str:
    """Value in the syntax of a deck."""
    return f"'{value}'" if isinstance(value, str) else repr(value)


def run_scene(dda: Path, folder: Path, scene: Scene, **changes: object) -> Run:
    """Run a scene in a folder; its tables are in folder/out."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.blocks").write_text(scene.blocks)
    (folder / "scene.nml").write_text(scene.deck(**changes))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([dda.resolve(), "run", "scene.nml", "--out", "out", "--quiet"], cwd=folder, text=True,
                          capture_output=True, check=False, env={**os.environ, "OMP_NUM_THREADS": "1"},
                          preexec_fn=_limit)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(folder, done.returncode, done.stderr.strip(), seconds)


def _limit() -> None:
    """Limit the processor time of the program."""
    resource.setrlimit(resource.RLIMIT_CPU, (SLOW, SLOW + 1))
