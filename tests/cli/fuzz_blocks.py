#!/usr/bin/env python3
"""Seeded mutation fuzzer of files of blocks, and of decks that run them.

usage: fuzz_blocks.py --dda build/bin/dda [--mutants N] [--runs N] [--seed N]

Mutates good files of blocks and decks of mode dynamic and limerick, and has `dda check` read them,
many a call. Every deck must either be accepted or give lines FILE:LINE: error: ... with lines that
the file has; the exit status must be 0 or 2; nothing may crash or hang. Of those that are accepted
some are computed, a few steps long: status 0 or 3. The same seed makes the same mutants. Ends with
status 1 and keeps the files that failed.
"""

from __future__ import annotations

import argparse
import random
import re
import shutil
import sys
import tempfile
from pathlib import Path

from fuzz_deck import ERROR, run
from fuzz_limerick import mutate_once

BLOCKS = [
    b"""! a block on a base
block fixed
  -1 -1
   2 -1
   2  0
  -1  0
block material 2 velocity 0.1 0 0 stress -1e4 0 0
   0  0
   1  0
   1  2
   0  2
material 2 density 2500 young 1e10 poisson 0.25
joint 1 2 friction_deg 35 cohesion 1e3 tension 0 residual_deg 20 slip_length 0.01
measure 1 2
load 0.5 1.5
  0 0 0
  0.01 100 0
fix 1.5 -0.5 x
base_acceleration
  0 0 0
  0.02 1 0
""",
    b"""block fixed
0 0
4 0
4 -1
0 -1
block
1 0
2 0
2 1
1 1
measure 1.5 0.5
base_acceleration file 'record.csv' columns time 2 up scale 9.81
load 1.5 0.5 file "record.csv" columns 1 2
""",
    b"block fixed\n0 0\n4 0\n4 -1\n0 -1\nblock\n1 0\n2 0\n2 1\n1 1\nblock\n1 1\n2 1\n1.5 2\n"
    b"block velocity 0 -1 0.5\n2.5 0.5\n3.5 0.5\n3 1.5\ndisplacement 1.5 0.5 0 0.001\n",
    b"block fixed\n0 0\n4 0\n4 -1\n0 -1\nblock\n1 0\n2 0\n2 1\n1 1\nblock\n1 1\n2 1\n1.5 2\nblock fixed\n"
    b"2 0\n3 0\n3 1\n2 1\nremove block 2 4 at 0.002\nadd block 2 at 0.004\nremove polygon at 0.006\n1 1\n2 1\n2 2\n"
    b"load 1.5 0.5\n0 0 0\n0.01 1e3 0\nbar 3 0.5 4.5 -0.5 stiffness 1e6\nremove block 4 at 0\nadd block 4 at 1\n",
    b"block fixed\n0 0\n4 0\n4 -1\n0 -1\nblock\n1 0\n2 0\n2 1\n1 1\nblock\n1 1\n2 1\n2 2\n1 2\n"
    b"add block 3 at 0.003\nremove block 3 at 0.006\nmeasure 1.5 0.5\n",
]
GROUPS = [
    b"&analysis mode = 'dynamic', geometry = 'current', time_step = 0.001, steps = 9 /\n",
    b"&analysis mode = 'dynamic', geometry = 'current', duration = 0.01, restitution = 0.5 /\n"
    b"&output restart = .true., energy = .true., frames = 2 /\n",
    b"&analysis mode = 'limerick', steps = 5, collapse_displacement = 0.5 /\n"
    b"&limerick penetration_ratio = 1e-4, open_ratio = 0 /\n",
    b"&analysis mode = 'limerick', steps = 4 / &joint friction_deg = 20 /\n",
    b"&analysis geometry = 'current', steps = 5 / &search parameter = 'friction_deg' /\n",
    b"&load horizontal_coefficient = 0.1 / &joint cohesion = 1e3, tension = 1e2 /\n",
    b"&ground record = 'record.csv', columns = '1 east', quantity = 'velocity', unit = 9.81, amplitude = 2 /\n"
    b"&analysis mode = 'dynamic', geometry = 'current', duration = 0.01 /\n",
    b"&ground pulse = 'sine', amplitude = 2, frequency = 5 /\n&search parameter = 'ground%scale', low = 0, high = 2 /\n"
    b"&analysis mode = 'dynamic', geometry = 'current', duration = 0.01, collapse_displacement = 1e-4 /\n",
]
RECORDS = [b"Station 1\ntime,east,up\n0.0,0.1,0\n\n0.005, -0.2,0.1\n0.01,0,0\n", b"0 1 2\n0.1\t2 3\n! end\n0.2 0 0\n"]
WORDS = b"""block fixed material joint measure load fix displacement base_acceleration velocity stress
density young x y friction_deg remove add polygon at
file columns scale 'record.csv' time 0 -1 1e300 1e-300 nan 2147483648 99999999999 1e15 0.5 ! & /""".split()
SHORT = ["--cases", "1", "--quiet", "--set", "analysis%steps=6"]  #: Words of a run that keep it short


def mutant(rng: random.Random, seeds: list[bytes]) -> bytes:
    """Make a text from a good one by a change or more; sometimes it stays good."""
    text = rng.choice(seeds)
    for _ in range(rng.choice([0, 1, 1, 1, 2, 4])):
        if rng.random() < 0.3:
            places = list(re.finditer(rb"\S+", text)) or [re.search(rb"", text)]
            place = rng.choice(places)
            text = text[: place.start()] + rng.choice(WORDS) + text[place.end():]
        else:
            text = mutate_once(rng, text, seeds)
    return text


def complaint(status: int | None, lines: list[str], folder: Path) -> str:
    """Broken rule of a call, empty if none; a call that hangs has no status."""
    if status not in (0, 2, 3):
        return "hang" if status is None else f"status {status}: " + " | ".join(lines[-5:])
    errors = 0
    for line in lines:
        match = ERROR.match(line)
        if not match and ("error" in line.lower() or "NaN" in line or "Infinity" in line):
            return f"not FILE:LINE: error: {line}"
        if not match:
            continue
        errors += 1
        path = folder / match["file"]
        text = path.read_bytes() if path.suffix != ".restart" else b"\n"
        ends = text.count(b"\n") + text.count(b"\r") - text.count(b"\r\n")
        if not 1 <= int(match["line"]) <= ends + 1:
            return f"no such line: {line}"
    return "" if (status == 2) == (errors > 0) else f"status {status} with {errors} errors"


def write_mutant(rng: random.Random, folder: Path, number: int) -> Path:
    """Write a file of blocks and its deck, one or both of them changed."""
    which = rng.randrange(3)
    blocks = rng.choice(BLOCKS) if which == 1 else mutant(rng, BLOCKS)
    groups = rng.choice(GROUPS) if which == 0 else mutant(rng, GROUPS)
    (folder / f"m{number}.blocks").write_bytes(blocks)
    deck = folder / f"m{number}.nml"
    deck.write_bytes(f"&scene kind = 'blocks', geometry = 'm{number}.blocks' /\n".encode() + groups)
    return deck


def is_small(text: bytes) -> bool:
    """Whether a deck that was accepted takes no time: no number asks for many steps or pictures."""
    numbers = [float(word) for word in re.findall(rb"(?:frames|limit|count) *= *(\d+)", text)]
    return b"sweep" not in text.lower() and max(numbers, default=0.0) <= 100.0


def compute(dda: str, deck: Path, folder: Path) -> str:
    """Compute a deck that was accepted."""
    status, lines = run([dda, "run", *SHORT, "--out", str(folder / "out")], [deck], 60.0)
    broken = complaint(status, lines, folder)
    if not broken and status in (0, 3):
        rows = (folder / "out" / "results.csv").read_bytes()
        if rows.count(b"\n") != 2 or b"nan" in rows.lower().split(b"\n")[1]:
            return "not one row of numbers"
    return broken


def main() -> int:
    """Fuzz and report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dda", required=True, type=lambda name: str(Path(name).resolve()), help="the program")
    parser.add_argument("--mutants", type=int, default=20000)
    parser.add_argument("--runs", type=int, default=2000, help="accepted decks to compute at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--batch", type=int, default=40, help="decks a call")
    parser.add_argument("--keep", default="fuzz_failed", help="folder for files that failed")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    failed: list[str] = []
    accepted = computed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for start in range(0, options.mutants, options.batch):
            numbers = range(start, min(start + options.batch, options.mutants))
            # one record for the whole batch: an error in it is one of every deck that names it
            (folder / "record.csv").write_bytes(rng.choice(RECORDS) if rng.random() < 0.5 else mutant(rng, RECORDS))
            decks = [write_mutant(rng, folder, number) for number in numbers]
            status, lines = run([options.dda, "check"], decks, 20.0)
            together = complaint(status, lines, folder)
            before = len(failed)
            refused = {match["file"] for match in map(ERROR.match, lines) if match}
            for deck in decks:
                broken = ""
                named = {str(deck), str(deck.with_suffix(".blocks"))}
                texts = deck.read_bytes() + deck.with_suffix(".blocks").read_bytes()
                if b"record.csv" in texts:
                    named.add(str(folder / "record.csv"))
                if together:
                    broken = complaint(*run([options.dda, "check"], [deck], 20.0), folder)
                elif not named & refused:
                    accepted += 1
                    text = deck.read_bytes()
                    if computed < options.runs and is_small(text):
                        computed += 1
                        broken = compute(options.dda, deck, folder)
                if broken:
                    failed.append(f"{deck.name}: {broken}")
                    Path(options.keep).mkdir(parents=True, exist_ok=True)
                    for path in (deck, deck.with_suffix(".blocks"), folder / "record.csv"):
                        shutil.copy(path, options.keep)
                deck.unlink()
                deck.with_suffix(".blocks").unlink()
            if together and len(failed) == before:
                failed.append(f"only together, from {decks[0].name}: {together}")
    print("\n".join(failed))
    print(f"{options.mutants} mutants, seed {options.seed}: {accepted} accepted, {computed} "
          f"computed, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
