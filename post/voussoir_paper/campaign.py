"""The decks of the paper: run one after the other, read, and put beside the paper's values."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from voussoir import results, theory
from voussoir.dda_program import path_word
from voussoir_paper import tables as paper_tables

#: Roughly how long each part takes [s of processor]: decks, then figures that are drawn; a part
#: that is not named here counts 1
_WEIGHTS = {
    "figure12": 3.0, "figure15": 3.0, "figure9": 1.5, "figure18": 1.5, "drawing animation8": 10.0,
    "drawing animation13": 4.0, "drawing animation16": 4.0, "drawing animation18": 11.0, "drawing figure9": 4.0,
    "drawing figure12": 3.0, "drawing figure15": 3.0, "drawing figure18": 2.0}
#: Before the name of a figure or an animation that is drawn
DRAWING = "drawing "
#: Name of the part that all decks are together
TOGETHER = "all decks"
#: Name of the part that all figures and animations are together
FIGURES = "figures and animations"
#: Decks of this ending are run on demand only: the original program's scheme takes long
SLOW_ENDING = "_limerick"


@dataclass(frozen=True)
class Timing:
    """How long one part took: wall time, and processor time of the programs that it ran [s]."""

    part: str
    wall: float
    computing: float


@dataclass
class Clock:
    """Times of the parts, and their progress reports."""

    report: Callable[[str], None]  #: Takes one line of text
    left: dict[str, float]  #: Weight of each part that is still to come
    timings: list[Timing] = field(default_factory=list)  #: Parts that are done
    _done: float = 0.0
    _parts: int = 0
    _start: float = field(default_factory=time.monotonic)

    @property
    def elapsed(self) -> float:
        """Wall time since the beginning [s]."""
        return time.monotonic() - self._start

    def record(self, timing: Timing) -> None:
        """Count one part and report how long the others will take."""
        self.timings.append(timing)
        self._done += self.left.pop(timing.part, 1.0)
        left = self.elapsed / self._done * sum(self.left.values())
        self._parts += 1
        number = self._parts
        line = f"[{number}/{number + len(self.left)}] {timing.part}: {timing.wall:.1f} s"
        self.report(line + (f", about {left:.0f} s left" if self.left else ""))


def run_program(part: str, command: list[str | Path]) -> tuple[int, Timing]:
    """Run a program: its exit status and its times."""
    start = time.monotonic()
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    timing = Timing(part, time.monotonic() - start, usage.ru_utime + usage.ru_stime)
    return process.returncode, timing


@dataclass
class Campaign:
    """Decks, results and the paper's values."""

    decks: Path  #: Folder of the decks and of paper_tables.csv.
    out: Path  #: Folder that receives a folder of results for each deck

    def __post_init__(self) -> None:
        self._read: dict[str, results.Results] = {}

    def deck_files(self, slow: bool = False) -> list[Path]:
        """The decks in their order, slow ones (run on demand only) where asked; FileNotFoundError if there are none."""
        files = sorted(self.decks.glob("*.nml"), key=lambda file: _order(file.stem))
        if not files:
            raise FileNotFoundError(f"no decks in {self.decks}; --decks DIR names their folder")
        return [file for file in files if slow or not file.stem.endswith(SLOW_ENDING)]

    def finished_decks(self) -> list[Path]:
        """The decks that have results."""
        return [file for file in self.deck_files(slow=True) if (self.out / file.stem / "results.csv").is_file()]

    def run(self, dda: Path, clock: Clock, jobs: int, slow: bool, resume: bool) -> int:
        """Run all decks, each by a process of its own: the worst exit status of the program."""
        files = self.deck_files(slow)
        longest_first = sorted(files, key=lambda file: -clock.left.get(file.stem, 1.0))
        options = ["--quiet", *(["--resume"] if resume else [])]
        statuses = [0]
        with ThreadPoolExecutor(jobs) as workers:
            running = [
                workers.submit(
                    run_program, file.stem, [dda, "run", path_word(file), "--out", self.out / file.stem, *options])
                for file in longest_first
            ]
            for done in as_completed(running):
                status, timing = done.result()
                statuses.append(status)
                clock.record(timing)
        order = {file.stem: place for place, file in enumerate(files)}
        clock.timings.sort(key=lambda timing: order.get(timing.part, len(order)))
        return next((status for status in (4, 2, 3) if status in statuses), max(statuses, key=abs))

    def results(self, deck: str) -> results.Results:
        """Results of one deck, read once."""
        if deck not in self._read:
            self._read[deck] = results.read(self.out / deck)
        return self._read[deck]

    @cached_property
    def tables(self) -> dict[str, paper_tables.PaperTable]:
        """Tables 1 to 4."""
        paper = self.decks / "paper_tables.csv"
        return {name: paper_tables.build_table(name, self.out, paper, theory) for name in paper_tables.TITLES}


def weights(decks: list[Path], parts: list[str]) -> dict[str, float]:
    """How long the decks and other parts take beside one another."""
    return {name: _WEIGHTS.get(name, 1.0) for name in [*(file.stem for file in decks), *parts]}


def _order(stem: str) -> tuple[str, int, str]:
    """Tables before figures, by their numbers."""
    word = stem.rstrip("0123456789") if stem[-1:].isdigit() else stem.partition("_")[0]
    digits = "".join(sign for sign in stem.partition("_")[0] if sign.isdigit())
    return ("a" if word.startswith("table") else "b", int(digits or 0), stem)
