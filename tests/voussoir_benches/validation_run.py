"""Run the scenes of the validation suite and compare what they give."""

from __future__ import annotations

import math
import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from voussoir.dda_program import DdaError
from voussoir.files import read_text
from voussoir_benches import exact, measures
from voussoir_benches.checks import Check, Outcome, critical, verdict
from voussoir_benches.deck_runs import run_deck
from voussoir_benches.expectations import Measured
from voussoir_benches.scene import MOVED, Scene, benchmark, in_current
from voussoir_benches.tables import rows
from voussoir_benches.validation_plot import track_of
from voussoir_benches.validation_sketch import Shape, shapes_of

ROUND_OFF = 1e-9  #: Errors below this are round-off: they have no rate


@dataclass(frozen=True)
class Line:
    """One line of the table."""

    scene: Scene  #: What was compared
    check: Check
    computed: float | str  #: What the deck as it stands gave
    errors: tuple[float, ...]  #: Errors with the deck's own step, half of it, and so on
    seconds: float  #: Wall time of the scene's run with the deck's own step
    shapes: tuple[Shape, ...] = ()  #: Blocks of the first case that is compared
    #: Time and displacements of its monitoring point: (3, steps) [s, m]
    track: np.ndarray = field(default_factory=lambda: np.empty((3, 0)), compare=False, repr=False)

    @property
    def accepted(self) -> bool:
        """Return true if the error is accepted; one that is not a number is not."""
        return self.errors[0] <= self.check.accept

    @property
    def rate(self) -> float | None:
        """Mean order of the error in the step, None where it is round-off or no step was halved."""
        first, last = self.errors[0], self.errors[-1]
        if len(self.errors) < 2 or not min(first, last) > ROUND_OFF or math.isinf(first + last):
            return None
        return math.log2(first / last) / (len(self.errors) - 1)


def all_scenes() -> tuple[Scene, ...]:
    """Every scene of validation.json, those of one section together.

    `both` adds the scene in current geometry, where errors may be `moved`.
    """
    names = {**vars(exact), **vars(measures), "Check": Check, "critical": critical, "verdict": verdict, "MOVED": MOVED}
    scenes = []
    for row in rows("validation.json", names):
        both, moved = row.pop("both", False), row.pop("moved", None)
        found = [benchmark(*(row.pop(key) for key in ("group", "deck", "source")), *row.pop("checks"), **row)]
        if both:
            found.append(in_current(found[0], moved))
        scenes += found
    return tuple(scenes)


def run_scene(decks: Path, scene: Scene, halvings: int) -> list[Line]:
    """Run a scene, where it has a rate again in steps halved so often; DdaError has the program's own message."""
    deck = decks / f"{scene.benchmark}.nml"
    checks = scene.expectation.checks if isinstance(scene.expectation, Measured) else ()
    columns, seconds = [], []
    shapes: tuple[Shape, ...] = ()
    track = np.empty((3, 0))
    for k in range(1 + (halvings if scene.rate else 0)):
        with tempfile.TemporaryDirectory() as folder:
            settings = [*scene.settings, *_step(deck, k)]
            if scene.after:
                begun = run_deck(decks / f"{scene.after}.nml", Path(folder) / "begun").folder
                settings.append(f"analysis%restart='{begun.resolve() / 'case_1.restart'}'")
            finished = run_deck(deck, Path(folder), settings=settings)
            if finished.status != 0:
                raise DdaError(finished.message or f"dda run ended with status {finished.status}", finished.status or 3)
            outcomes = {case: Outcome(finished.folder, case) for case in {check.case for check in checks}}
            columns.append([check.measure(outcomes[check.case]) for check in checks])
            seconds.append(finished.seconds)
            if k == 0:
                shapes = shapes_of(finished.folder / "blocks.csv", checks[0].case)
                track = track_of(finished.folder / "points.csv", checks[0].case)
    return [
        Line(scene, check, values[0], tuple(map(check.error, values)), seconds[0], shapes, track)
        for check, values in zip(checks, zip(*columns))
    ]


def _step(deck: Path, halvings: int) -> list[str]:
    """Setting that halves the step of a deck so often, none for the deck as it stands."""
    if halvings == 0:
        return []
    step = re.search(r"time_step = ([-+.\de]+)", read_text(deck))
    if not step:
        raise DdaError(f"{deck}: expected a time_step to halve, got none; give one in &analysis")
    return [f"analysis%time_step={float(step[1]) / 2**halvings!r}"]
