#!/usr/bin/env python3
"""The test programs and `dda` on several decks under valgrind: no error, nothing lost.

usage: memory_check.py --dda DDA PROGRAM [PROGRAM ...]

Each PROGRAM is a test program that wants no arguments. Prints a line a run and ends with status 1
where valgrind has found anything. Memory that is still in reach at the end is no loss.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

INPUT = Path(__file__).resolve().parents[2] / "input"
FOUND = 99  #: The status that valgrind ends with; no other one is a finding
VALGRIND = ["valgrind", "-q", f"--error-exitcode={FOUND}", "--leak-check=full",
            "--errors-for-leak-kinds=definite", "--show-leak-kinds=definite"]
#: Decks of this check alone, by name
DECKS = {
    "search": "&arch voussoirs = 12 /\n&search /\n&sweep parameter = 'friction_deg', values = 20, 50 /\n",
    "moving": "&arch voussoirs = 6, thickness_ratio = 0.1 /\n&analysis geometry = 'current' /\n"
              "&output frames = 3 /\n",
    "shaken": "&arch voussoirs = 4, thickness_ratio = 0.15 /\n&analysis mode = 'dynamic', geometry = 'current', "
              "time_step = 0.01, duration = 0.3, steps = 999, unknowns = 3, collapse_displacement = 0.05 /\n"
              "&ground pulse = 'rectangular', duration = 0.2 /\n"
              "&search parameter = 'ground%amplitude', low = 0, high = 40, tolerance = 0.2 /\n",
    "bad": "&arch radius = -1 /\n",
}
#: What `dda` is asked for, in a folder that holds the decks of above
CALLS = (
    "run search.nml", "run search.nml --jobs 2 --out jobs", "run moving.nml", "run shaken.nml",
    "run bad.nml",
    "check search.nml moving.nml bad.nml missing.nml", "export search.nml --out files", "help keys",
    "run INPUT/benchmarks/dry_wall_2x4.nml", "run INPUT/benchmarks/stack.nml",
    "run INPUT/benchmarks/bounce.nml --set analysis%steps=50 --set output%energy=.true.",
    "run INPUT/benchmarks/collision.nml --set analysis%steps=50 --set output%restart=.true.",
    "run INPUT/limerick/terrace.nml --set analysis%steps=3",
    "run INPUT/limerick/both_sides.nml --set analysis%steps=20",
    "cut INPUT/limerick/terrace.geo INPUT/limerick/terrace_ddaml.geo",
    "cut INPUT/limerick/terrace.geo --out blocks.vtu",
)


def check(words: list[str], folder: Path) -> bool:
    """Run a command under valgrind and tell what was found."""
    done = subprocess.run([*VALGRIND, *words], cwd=folder, capture_output=True, text=True)
    told = [line for line in done.stderr.splitlines() if line.startswith(("==", "valgrind:"))]
    name = " ".join([Path(words[0]).name, *(Path(word).name for word in words[1:])])
    good = done.returncode != FOUND and not told and done.returncode >= 0
    print(f"{'ok    ' if good else 'FAILED'} {name}", *([] if good else told), sep="\n   ", flush=True)
    return good


def main() -> int:
    """Check all and report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dda", required=True, help="the program")
    parser.add_argument("--jobs", type=int, default=2, help="runs at the same time (default: 2)")
    parser.add_argument("programs", nargs="*", help="test programs")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(options.jobs) as pool:
        folder = Path(name)
        for deck, text in DECKS.items():
            (folder / f"{deck}.nml").write_text(text)
        # they run in another folder
        dda, *programs = [str(Path(program).resolve()) for program in [options.dda, *options.programs]]
        calls = [[dda, *call.replace("INPUT", str(INPUT)).split()] for call in CALLS]
        commands = calls + [[program] for program in programs]
        good = list(pool.map(lambda words: check(words, folder), commands))
    print(f"{len(good)} runs, {good.count(False)} with findings")
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
