"""Error and time of every setting of every method, and the front of the best."""

from __future__ import annotations

import contextlib
import functools
import math
import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from voussoir import results
from voussoir.deck.text import deck_text, merged
from voussoir_benches import limit_lp, work_precision_scenes as scenes
from voussoir_benches.deck_runs import Finished, run_deck, timed
from voussoir_benches.limit_lp_blocks import Assembly, assembly_of, limit_factor
from voussoir_benches.work_precision_motion import MOTION_METHODS, rocking
from voussoir_benches.work_precision_runs import Arch, decide

UNIT_WEIGHT = 2240.0 * 9.81  #: Weight per area of a deck's own material [N/m3]


@dataclass(frozen=True)
class Point:
    """One run of one setting."""

    scene: str  #: What was run, and how
    method: str
    setting: str
    error: float | None  #: Relative error; None where no answer was given
    seconds: float  #: Median time
    answer: float | None  #: What was found

    @property
    def known_error(self) -> float:
        """Relative error; infinite where no answer was given."""
        return math.inf if self.error is None else self.error


@dataclass(frozen=True)
class Panel:
    """One class of scene."""

    title: str  #: What was run
    points: tuple[Point, ...]  #: All settings of all methods
    gap: float | None = None  #: Associated limit over the Coulomb answer, less one; None where they are one


def front(points: list[Point]) -> list[Point]:
    """The points that no other one beats in time and error: time grows and error falls along it."""
    best: list[Point] = []
    known = [point for point in points if point.error is not None]
    for point in sorted(known, key=lambda point: (point.seconds, point.known_error)):
        if not best or point.known_error < best[-1].known_error:
            best.append(point)
    return best


CLASSES = ("arch", "wall", "three rings", "moving arch", "motion")  #: Classes of scenes, in the order of their panels


def panels(folder: Path, repeats: int, classes: Sequence[str] = CLASSES) -> Iterator[Panel]:
    """Run classes of scenes, each setting so many times; the median counts."""
    made = {
        "arch": lambda: _arch_panel(scenes.arch(), folder, repeats),
        "wall": lambda: _block_panel(scenes.wall(), folder, repeats),
        "three rings": lambda: _block_panel(scenes.three_rings(), folder, repeats),
        "moving arch": lambda: _arch_panel(scenes.moving_arch(), folder, repeats),
        "motion": lambda: Panel("Motion in time: quarter period of a rocking block", tuple(_motion(folder, repeats))),
    }
    for name in classes:
        yield made[name]()


def _arch_panel(scene: scenes.SceneClass, folder: Path, repeats: int) -> Panel:
    """A panel of arches; linear programs where blocks do not move."""
    arch = Arch(90.0, 36)
    points = list(_dda_points(scene, lambda method: arch.exact(), folder, repeats))
    if scene.name == "arch" and limit_lp.scipy_version() is not None:
        points += _bisected(scene, arch, repeats)
    return Panel(scene.title, tuple(points))


def _block_panel(scene: scenes.SceneClass, folder: Path, repeats: int) -> Panel:
    """A panel of blocks of a file: both answers, by the finest run and by its proven bounds."""
    finest = _run(scene, {"search": {"tolerance": 1e-12}}, folder, 1)
    row = finest.rows[0]
    coulomb = float(row["critical"])
    associated = (float(row["exact_low"]) + float(row["exact_high"])) / 2.0
    of_flow = {scenes.ASSOCIATED: associated}
    points = list(_dda_points(scene, lambda method: of_flow.get(method, coulomb), folder, repeats))
    if limit_lp.scipy_version() is not None:
        tables = {"output": {"joints": True, "blocks": True}}
        full_run = results.read(_run(scene, tables, folder, 1).folder)
        push = None
        if scene.live_block is not None:
            force = np.array([0.0, -1000.0 / UNIT_WEIGHT])
            push = scene.live_block, np.array(scene.live_point), force
        assembly = assembly_of(full_run, push)
        points += _programs(scene, assembly, associated, repeats)
    return Panel(scene.title, tuple(points), associated / coulomb - 1.0)


def _dda_points(scene: scenes.SceneClass, exact: Callable[[str], float], folder: Path, repeats: int) -> Iterator[Point]:
    """All settings of the methods of dda."""
    for method, settings in scene.methods.items():
        for setting in settings:
            finished, seconds = timed(functools.partial(_run, scene, setting, folder), repeats)
            found = [row for row in finished.rows if row["verdict"] == "found"]
            answer = float(found[0]["critical"]) if found else None
            error = abs(answer / exact(method) - 1.0) if answer is not None else None
            yield Point(scene.name, method, _words(setting), error, seconds, answer)


def _words(setting: Mapping[str, Any]) -> str:
    """A setting in a line."""
    return ", ".join(
        f"{key} = {value:g}" if isinstance(value, float) else f"{key} = {value}" for keys in setting.values() for key,
        value in keys.items())


def _run(scene: scenes.SceneClass, setting: Mapping[str, Any], folder: Path, repeats: int) -> Finished:
    """Run one setting so many times within one process."""
    groups = merged(scene.groups, setting)
    penalty = groups.get("analysis", {}).pop("penalty_ratio", None)
    default = 50.0 if groups.get("analysis", {}).get("mode") == "limerick" else 100.0
    again = {"parameter": "penalty_ratio", "values": [penalty or default] * repeats}
    text = deck_text({**groups, "sweep": again})
    return run_deck(text, folder / scene.name.replace(" ", "_"), files=scene.files)


def _median_time(solve: Callable[[], float], repeats: int) -> tuple[float, float]:
    """An answer, and the median of the processor times of so many runs."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        answer = solve()
        times.append(time.process_time() - start)
    return answer, statistics.median(times)


def _bisected(scene: scenes.SceneClass, arch: Arch, repeats: int) -> Iterator[Point]:
    """Critical thicknesses by bisection of linear programs, from 20 % below to 20 % above."""
    exact = arch.exact()
    for method, solver in ((scenes.SIMPLEX, "highs-ds"), (scenes.INTERIOR, "highs-ipm")):
        for goal in (1e-1, 1e-2, 1e-3, 1e-5, 1e-7, 1e-9):
            stands = functools.partial(limit_lp.stands_by_general, method=solver, tolerance=max(1e-10, min(1e-7, goal)))
            solve = functools.partial(_bisect, arch, stands, exact, goal)
            answer, seconds = _median_time(solve, repeats)
            error = abs(answer / exact - 1.0)
            yield Point(scene.name, method, f"tolerance = {goal:g}", error, seconds, answer)


def _bisect(arch: Arch, stands: Callable[..., bool], exact: float, goal: float) -> float:
    """The middle of a bracket of that relative width."""
    low, high = 0.8 * exact, 1.2 * exact
    while high - low > goal * low:
        middle = (low + high) / 2.0
        low, high = (low, middle) if decide(arch, stands, middle) else (middle, high)
    return (low + high) / 2.0


def _programs(scene: scenes.SceneClass, assembly: Assembly, exact: float, repeats: int) -> Iterator[Point]:
    """The associated limit by linear programs."""
    friction = math.tan(math.radians(scene.friction_deg))
    for method, solver in ((scenes.SIMPLEX, "highs-ds"), (scenes.INTERIOR, "highs-ipm")):
        for tolerance in scenes.HIGHS_TOLERANCES:
            solve = functools.partial(limit_factor, assembly, friction, solver, tolerance)
            answer, seconds = _median_time(solve, repeats)
            error = abs(answer / exact - 1.0)
            yield Point(scene.name, method, f"tolerance = {tolerance:g}", error, seconds, answer)


def _motion(folder: Path, repeats: int) -> Iterator[Point]:
    """The quarter period of a rocking block by every method, step halved."""
    motion = rocking()
    _, exact, measure = motion.checks[0]
    for method, groups in MOTION_METHODS.items():
        for step in motion.steps():
            run = functools.partial(motion.run, step, folder, groups)
            finished, seconds = timed(run, repeats)
            answer = error = None
            if finished.rows and finished.rows[0]["verdict"] == "completed":
                with contextlib.suppress(IndexError):  # a block that never comes upright
                    answer = measure(motion.outcome(finished))
                    error = abs(answer / exact - 1.0)
            yield Point("motion", method, f"time_step = {step:g}", error, seconds, answer)
