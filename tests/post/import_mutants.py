"""Mutated files of every format of `voussoir import`, each read by the command that a user would type.

    PYTHONPATH=build/python python3 tests/post/import_mutants.py --count 200 --seed 1

A file is imported, or refused in one line with status 2, within 10 s of processor time and 1 GB. Files that are not
are kept, and counted in a line per format.
"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from mutated_files import mutated, seeds

#: Processor time [s] and memory [kB] that a command may take
MOST_SECONDS, MOST_MEMORY = 10.0, 10**6
#: Elapsed time after which a command hangs: a loaded machine gets several times the processor time [s]
MOST_ELAPSED = 60


@dataclass(frozen=True)
class Outcome:
    """Outcome of a command on a file."""

    status: int
    error: str
    seconds: float  #: Processor time [s] and largest memory [kB] of the command with its own processes
    memory: int

    def fault(self) -> str:
        """Fault of the outcome; empty if there is none."""
        if (self.status, self.error.count("\n")) not in ((0, 0), (2, 1)) or "Traceback" in self.error:
            return f"status {self.status} and {self.error.count(chr(10))} lines: {self.error[:300]}"
        if "of its kind, got a" in self.error:
            return f"a fault of the reader: {self.error}"
        if self.seconds > MOST_SECONDS or self.memory > MOST_MEMORY:
            return f"{self.seconds:.1f} s and {self.memory} kB"
        return ""


def run_import(file: Path, *options: str) -> Outcome:
    """Import a file by the command; its status is -1 if it hangs."""
    words = [sys.executable, "-m", "voussoir", "import", str(file), "--out", str(file.with_suffix(".nml")), *options]
    before = os.times()
    with (file.parent / "stderr").open("w+b") as errors:
        child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=errors)
        end = time.monotonic() + MOST_ELAPSED
        done, code, usage = os.wait4(child.pid, os.WNOHANG)
        while done == 0 and time.monotonic() < end:
            time.sleep(0.01)
            done, code, usage = os.wait4(child.pid, os.WNOHANG)
        if done == 0:
            child.kill()
            child.wait()
            return Outcome(-1, "", float(MOST_ELAPSED), 0)
        child.returncode = os.waitstatus_to_exitcode(code)
        errors.seek(0)
        text = errors.read().decode(errors="replace")
    after = os.times()
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    return Outcome(child.returncode, text, seconds, usage.ru_maxrss)


def check(ending: str, count: int, seed: int, folder: Path) -> str:
    """Import mutants of a format: its line, with the number of faults; their files stay in the folder."""
    good, rng = seeds(folder)[ending], random.Random(f"{seed} {ending}")
    faults = imported = 0
    slowest, largest = 0.0, 0
    # the files themselves are imported; otherwise a package or the program is missing, and mutants prove nothing
    for number, text in enumerate(good + [mutated(rng, rng.choice(good), good) for _ in range(count)], -len(good)):
        file = folder / f"{ending}_{number}.{ending}"
        file.write_bytes(text)
        outcome = run_import(file)
        if number < 0:
            if outcome.status != 0:
                raise RuntimeError(f"{ending}: {outcome.error}")
            continue
        slowest, largest = max(slowest, outcome.seconds), max(largest, outcome.memory)
        imported += outcome.status == 0
        if outcome.fault():
            faults += 1
            print(f"{file}: {outcome.fault()}", flush=True)
        else:
            file.unlink()
    return (f"{ending}: {faults} faults of {count}, {imported} imported, "
            f"slowest {slowest:.1f} s, largest {largest / 1000:.0f} MB")


def main() -> int:
    """Check all formats."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="mutants of each format")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--endings", nargs="+", default=["dxf", "geojson", "wkt", "json", "vtk", "msh", "vtu"])
    arguments = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="mutated_files_"))
    lines = []
    for ending in arguments.endings:
        lines.append(check(ending, arguments.count, arguments.seed, folder))
        print(lines[-1], flush=True)
    return 1 if any(": 0 faults" not in line for line in lines) else 0


if __name__ == "__main__":
    sys.exit(main())
