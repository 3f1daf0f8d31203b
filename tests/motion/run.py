"""Run random scenes with known answers, and count those that are wrong.

    python3 tests/motion/run.py --dda build/bin/dda --seed 7 --count 100
    python3 tests/motion/run.py --dda build/bin/dda --seed 7 --count 10 --family train --steps

One line per family: scenes, wrong ones, slow ones, undecided ones, and the largest error over its tolerance.
Folders of wrong and slow scenes are kept. With `--steps` each scene runs at steps of 4, 2, 1 and 0.5 ms, with 3 and
with 6 unknowns at E = 1e12. Scenes whose answers differ by more than their tolerance, 1e-6 of the largest length or
speed, are wrong. Where the integration is of second order, the tolerance falls with the square of the step.
"""

from __future__ import annotations

import argparse
import importlib
import itertools
import random
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from scene import SLOW, Check, Run, Scene, run_scene

MODULES = ("bounces", "trains", "polygons", "drops", "supported", "stacks", "confined")  #: Modules of generators
#: Time steps [s] and unknowns at which answers must be the same
STEPS, UNKNOWNS = (4e-3, 2e-3, 1e-3, 5e-4), (3, 6)
#: Error of clean second order over the tolerance, and the tolerance over what may be left beyond it
MOST = 4.0
LEAST_FALL = 3.5  #: Error of a step over that of half the step where truncation is its cause


@dataclass(frozen=True)
class Outcome:
    """Judgement of one scene."""

    family: str
    seed: int
    worst: float = 0.0  #: Largest error over its tolerance
    wrong: str = ""  #: Why the scene is wrong; empty if it is right
    is_slow: bool = False
    is_undecided: bool = False


def families() -> dict[str, Callable[[random.Random], Scene]]:
    """Generators by name."""
    found: dict[str, Callable[[random.Random], Scene]] = {}
    for name in MODULES:
        found |= importlib.import_module(name).FAMILIES
    return found


@cache
def scene_of(family: str, seed: int) -> Scene:
    """The scene of a seed."""
    return families()[family](random.Random(f"{family} {seed}"))


def judge(scene: Scene, run: Run, factor: float = 1.0) -> tuple[float, str]:
    """Largest error over its tolerance times a factor, and what is wrong."""
    if run.status not in (0, 3):
        return 0.0, f"status {run.status}: {run.message}"
    if run.result["verdict"] not in scene.verdicts + ("undecided",) * scene.may_be_undecided:
        return 0.0, f"{run.result['verdict']}, not {' or '.join(scene.verdicts)}"
    worst, words = 0.0, ""
    for check in scene.checks:
        value = check.value(run)
        error = abs(value - check.expected) / (check.tolerance * factor)
        if not error <= worst:
            worst = error
            words = f"{check.name} is {value:.9g}, not {check.expected:.9g} +- {check.tolerance * factor:.2g}"
    return worst, words if not worst <= 1.0 else ""


def order_error(scene: Scene, check: Check, coarse: float, fine: float, factor: float) -> float:
    """Errors of a check at a step and at half of it, as one error over the tolerance at this step."""
    if scene.is_second_order:
        return max(abs(4.0 * fine - coarse) / 3.0 * MOST, abs(coarse) / MOST) / (check.tolerance * factor)
    if abs(coarse) <= check.truncation:
        return min(abs(coarse) / check.tolerance, abs(fine) * LEAST_FALL / abs(coarse))
    return abs(coarse) / check.tolerance


def judge_order(dda: Path, scene: Scene, run: Run, step: float, unknowns: int) -> tuple[float, str]:
    """Largest error over its tolerance that the second order leaves (Richardson), and what is wrong.

    The error of second order itself may be `MOST` times the tolerance, which does not know how far a corner rolls.
    """
    half = run_scene(dda, run.folder / "half", scene, time_step=step / 2.0, unknowns=unknowns)
    factor = (step / float(str(scene.analysis["time_step"]))) ** 2
    worst, words = judge(scene, half) if half.status else (0.0, "")
    for check in [] if half.status else scene.checks:
        coarse, fine = (check.value(one) - check.expected for one in (run, half))
        left = order_error(scene, check, coarse, fine, factor)
        if not left <= worst:
            worst, words = left, f"{check.name} is off by {coarse:.2g}, and by {fine:.2g} at half the step"
    return worst, words if not worst <= 1.0 else ""


def ask(dda: Path, folder: Path, family: str, seed: int) -> Outcome:
    """Run and judge the scene of a seed; its folder is kept if it is wrong or slow."""
    scene = scene_of(family, seed)
    here = folder / f"{family}_{seed}"
    run = run_scene(dda, here, scene)
    if run.seconds >= SLOW:
        return Outcome(family, seed, is_slow=True)
    worst, wrong = judge(scene, run)
    falls = scene.is_second_order or any(check.truncation for check in scene.checks)
    if wrong and falls and run.status == 0:
        step, unknowns = float(str(scene.analysis["time_step"])), int(str(scene.analysis["unknowns"]))
        worst, wrong = judge_order(dda, scene, run, step, unknowns)
    is_undecided = run.status in (0, 3) and run.result["verdict"] == "undecided"
    if not wrong:
        shutil.rmtree(here)
    return Outcome(family, seed, worst, wrong, is_undecided=is_undecided)


def ask_steps(dda: Path, folder: Path, family: str, seed: int) -> Outcome:
    """Compare the answers of the scene of a seed at all steps and unknowns."""
    scene = scene_of(family, seed)
    values: list[list[float]] = []
    own = float(str(scene.analysis["time_step"]))
    for step, unknowns in itertools.product(STEPS, UNKNOWNS):
        here = folder / f"{family}_{seed}_{step}_{unknowns}"
        run = run_scene(dda, here, scene.stiff(), time_step=step, unknowns=unknowns)
        if run.seconds >= SLOW:
            return Outcome(family, seed, is_slow=True)
        if run.status not in (0, 3) or run.result["verdict"] not in scene.verdicts:
            return Outcome(family, seed, wrong=f"at {step} s with {unknowns} unknowns: {judge(scene, run)[1]}")
        if scene.is_second_order:
            worst, wrong = judge(scene, run, (step / own) ** 2)
            if wrong and run.status == 0:
                worst, wrong = judge_order(dda, scene.stiff(), run, step, unknowns)
            if wrong:
                return Outcome(family, seed, worst, f"at {step} s with {unknowns} unknowns: {wrong}")
            continue
        values.append([check.value(run) for check in scene.checks])
    if scene.is_second_order:
        values = [[0.0] * len(scene.checks)]
    spread = [(max(column) - min(column)) / check.tolerance for column, check in zip(zip(*values), scene.checks)]
    worst = max(spread)
    if worst <= 1.0:
        for here in folder.glob(f"{family}_{seed}_*"):
            shutil.rmtree(here)
        return Outcome(family, seed, worst)
    check = scene.checks[spread.index(worst)]
    words = f"{check.name} differs by {worst * check.tolerance:.2g} between steps or unknowns"
    return Outcome(family, seed, worst, words)


def compares_steps(family: str) -> bool:
    """Whether the answers of a family are compared between steps."""
    scene = scene_of(family, 0)
    return scene.is_step_free or scene.is_second_order


def campaign(dda: Path, folder: Path, seeds: range, names: list[str], jobs: int, steps: bool) -> Iterator[Outcome]:
    """Judge the scenes of families in turn, of one seed after the other."""
    task = ask_steps if steps else ask
    with ProcessPoolExecutor(jobs) as pool:
        waiting = [pool.submit(task, dda, folder, name, seed) for seed in seeds for name in names]
        for future in waiting:
            yield future.result()


def table(outcomes: list[Outcome]) -> str:
    """One line per family."""
    lines = [f"{'family':32s} {'scenes':>6s} {'wrong':>6s} {'slow':>6s} {'undecided':>9s} {'error/tolerance':>15s}"]
    for name in dict.fromkeys(outcome.family for outcome in outcomes):
        mine = [outcome for outcome in outcomes if outcome.family == name]
        counts = (sum(bool(one.wrong) for one in mine), sum(one.is_slow for one in mine),
                  sum(one.is_undecided for one in mine))
        worst = max(one.worst for one in mine)
        lines.append(f"{name:32s} {len(mine):6d} {counts[0]:6d} {counts[1]:6d} {counts[2]:9d} {worst:15.3g}")
    return "\n".join(lines)


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dda", type=Path, default=Path("build/bin/dda"), help="program under test")
    parser.add_argument("--seed", type=int, default=0, help="first seed")
    parser.add_argument("--count", type=int, default=20, help="scenes in all, shared out over the families")
    parser.add_argument("--family", action="append", choices=sorted(families()), help="this family only; repeatable")
    parser.add_argument("--steps", action="store_true", help="compare steps and unknowns")
    parser.add_argument("--jobs", type=int, default=1, help="scenes at the same time")
    parser.add_argument("--keep", type=Path, help="folder of wrong and slow scenes")
    given = parser.parse_args()
    known = families()
    names = given.family or [name for name in known]
    names = [name for name in names if not given.steps or compares_steps(name)]
    folder = given.keep or Path(tempfile.mkdtemp(prefix="motion_"))
    seeds = range(given.seed, given.seed + -(-given.count // len(names)))
    outcomes = []
    for outcome in campaign(given.dda.resolve(), folder, seeds, names, given.jobs, given.steps):
        outcomes.append(outcome)
        if outcome.wrong or outcome.is_slow:
            print(f"{outcome.family} {outcome.seed}: {outcome.wrong or 'slow'}", flush=True)
    print(table(outcomes))
    bad = sum(bool(one.wrong) or one.is_slow for one in outcomes)
    print(f"{len(outcomes)} scenes, {bad} wrong or slow" + (f", kept in {folder}" if bad else ""))
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
