"""Memory that a block of a wall of ten courses takes, by the command dda on Linux.

    python tests/bench/wall_memory.py build/bin/dda --bricks 105 1005 10005

Each line tells the growth of the peak of a whole run over that of the first size, divided by the blocks that are more.
"""

from __future__ import annotations

import argparse
import csv
import math
import subprocess
import tempfile
import time
from pathlib import Path

COURSES = 10
#: What is asked of a wall
TASKS = {
    "decision, associated": "&analysis flow = 'associated' /\n&load horizontal_coefficient = 0.3 /",
    "search, associated": "&analysis flow = 'associated' /\n&search parameter = 'horizontal_coefficient' /",
    "decision, Coulomb": "&load horizontal_coefficient = 0.1 /",
    "search, Coulomb": "&search parameter = 'horizontal_coefficient' /",
}


def wall(bricks: int) -> str:
    """A wall in running bond, 2 x 1 a brick and half a brick at both ends of every second course."""
    n = (2 * bricks - COURSES) // (2 * COURSES)
    lines = ["block fixed", f"-4 -1\n{2 * n + 4} -1\n{2 * n + 4} 0\n-4 0"]
    for c in range(COURSES):
        ends = [2 * i for i in range(n + 1)] if c % 2 == 0 else [0, *range(1, 2 * n, 2), 2 * n]
        lines += [f"block\n{a} {c}\n{b} {c}\n{b} {c + 1}\n{a} {c + 1}" for a, b in zip(ends, ends[1:])]
    return "\n".join(lines) + "\n"


def run(dda: Path, folder: Path, bricks: int, task: str, tables: bool) -> tuple[int, int, str]:
    """Blocks that can move, the peak of the process in kB, and the verdict."""
    text = wall(bricks)
    (folder / "x.blocks").write_text(text)
    output = "" if tables else "&output joints = .false., blocks = .false., proof = .false. /\n"
    (folder / "deck.nml").write_text(f"&scene kind = 'blocks', geometry = 'x.blocks' /\n{output}"
                                     f"&joint friction_deg = {math.degrees(math.atan(0.65))!r} /\n{task}\n")
    peak = 0
    with subprocess.Popen([dda, "run", "deck.nml", "--quiet"], cwd=folder) as process:
        while process.poll() is None:
            status = Path(f"/proc/{process.pid}/status").read_text()
            for line in status.splitlines():
                if line.startswith("VmHWM:"):
                    peak = max(peak, int(line.split()[1]))
            time.sleep(0.0005)
    with (folder / "deck" / "results.csv").open(newline="") as table:
        verdict = next(csv.DictReader(table))["verdict"]
    return text.count("block") - 1, peak, verdict


def main() -> None:
    """Print the memory of a block for each task and size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dda", type=Path)
    parser.add_argument("--bricks", type=int, nargs="+", default=[105, 1005, 10005])
    parser.add_argument("--tables", action="store_true", help="write all tables")
    parser.add_argument("--only", default="", help="tasks with this in their names")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        for task, groups in TASKS.items():
            if options.only not in task:
                continue
            first: tuple[int, int] | None = None
            for bricks in options.bricks:
                n, peak, verdict = run(options.dda.resolve(), Path(name), bricks, groups, options.tables)
                first = first or (n, peak)
                if n > first[0]:
                    grown = (peak - first[1]) / (n - first[0])
                    print(f"{task}: {n} blocks, {verdict}, {grown:.2f} kB a block", flush=True)


if __name__ == "__main__":
    main()
