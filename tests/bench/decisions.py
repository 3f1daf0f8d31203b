"""Decisions and limits of random assemblies by the command dda, beside the linear programmes of HiGHS (needs SciPy).

    python tests/bench/decisions.py build/bin/dda 0 200

Each assembly is pushed sideways: its associated limit and its Coulomb value are searched, then decided at shares of
the limit under both rules. The last lines tell the worst of all.
"""

from __future__ import annotations

import argparse
import csv
import io
import resource
import subprocess
import tempfile
from pathlib import Path

from assembly import block_text
from highs import judge, read_graphs
from random_assemblies import make_pushed

SHARES = (0.5, 0.9, 0.99, 1.01, 1.1, 1.5, 5.0)
FLOWS = ("associated", "coulomb")
PATIENCE = 100  #: Seconds that a deck may take


def run(dda: Path, folder: Path, flow: str, task: str) -> tuple[list[dict[str, str]], float]:
    """Rows of a deck, and seconds of processor time for each."""
    start = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    (folder / "deck.nml").write_text(
        f"&scene kind = 'blocks', geometry = 'x.blocks' /\n&analysis flow = '{flow}' /\n"
        f"&output joints = .false., blocks = .false. /\n{task}\n")
    try:
        done = subprocess.run([dda, "run", "deck.nml", "--quiet"], cwd=folder, capture_output=True, check=False,
                              timeout=PATIENCE)
    except subprocess.TimeoutExpired as slow:
        raise RuntimeError(f"SLOW: {flow}, {task}: expected an answer in {PATIENCE} s, got none") from slow
    if done.returncode not in (0, 3):  # 3: a case is undecided
        raise RuntimeError(done.stderr.decode())
    with (folder / "deck" / "results.csv").open(newline="") as table:
        rows = sorted(csv.DictReader(table), key=lambda row: int(row["case"]))
    return rows, (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - start) / len(rows)


def study(dda: Path, folder: Path, seed: int, worst: dict[str, float]) -> str:
    """Search and decide one assembly; what is worst is kept."""
    assembly, ground = make_pushed(seed)
    (folder / "x.blocks").write_text(block_text(assembly, ground))
    state, factor = judge(next(read_graphs(io.StringIO(assembly.text()))))
    search = "&search parameter = 'horizontal_coefficient', high = 1e4 /"
    searches = {flow: run(dda, folder, flow, search) for flow in FLOWS}
    found = {flow: rows[0] for flow, (rows, _) in searches.items()}
    words = [f"{assembly.name:14s} {len(assembly.blocks):3d} HiGHS {state}"]
    limit = found["associated"]
    slowest = max(seconds for _, seconds in searches.values())
    worst["undecided"] += sum(row["verdict"] == "undecided" for row in found.values())
    if limit["verdict"] != "found" or state != "found":
        worst["seconds"] = max(worst["seconds"], slowest)
        return " ".join([*words, limit["verdict"], found["coulomb"]["verdict"], f"{slowest:.2f} s"])
    value = float(limit["critical"])
    error = abs(value - factor) / max(abs(factor), 1e-3)
    worst["error"] = max(worst["error"], error)
    sweep = ", ".join(repr(value * share) for share in SHARES)
    for flow in FLOWS:
        rows, seconds = run(dda, folder, flow, f"&sweep parameter = 'horizontal_coefficient', values = {sweep} /")
        slowest = max(slowest, seconds)
        falls_at = float(found[flow]["critical"] or 0.0)
        for share, row in zip(SHARES, rows):
            expected = "stable" if share * value < falls_at else "collapsed"
            if row["verdict"] != expected:
                worst["wrong"] += 1
                words.append(f"WRONG {flow} at {share}: {row['verdict']}")
            if flow == "associated" or share > 1.0:
                worst["factorisations"] = max(worst["factorisations"], int(row["factorisations"]))
        words.append(f"{flow} {found[flow]['verdict']} {falls_at:.9f}"
                     f" [{' '.join(row['factorisations'] for row in rows)}]")
    worst["seconds"] = max(worst["seconds"], slowest)
    return " ".join([*words, f"error {error:.1e} {slowest:.2f} s"])


def main() -> None:
    """Study assemblies and tell the worst."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dda", type=Path, help="the command")
    parser.add_argument("first", type=int, help="first seed")
    parser.add_argument("count", type=int, help="how many")
    given = parser.parse_args()
    worst = {"error": 0.0, "wrong": 0.0, "undecided": 0.0, "factorisations": 0.0, "seconds": 0.0}
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(given.first, given.first + given.count):
            try:
                print(study(given.dda.resolve(), Path(folder), seed, worst), flush=True)
            except RuntimeError as refusal:
                print(f"{seed}: {refusal}".strip(), flush=True)
    print(" ".join(f"{name} {number:.3g}" for name, number in worst.items()))


if __name__ == "__main__":
    main()
