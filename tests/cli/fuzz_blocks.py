#!/usr/bin/env python3
"""Seeded mutation fuzzer of files of blocks, and of decks that run them.

usage: fuzz_blocks.py --dda build/bin/dda [--mutants N] [--runs N] [--seed N]

Mutates good files of blocks and decks of mode dynamic and limerick, and has `dda check` read them, many a call. Of
those that are accepted some are computed, a few steps long: status 0 or 3. Rules and options are those of fuzz.py.
"""

from __future__ import annotations

import random
import re
import sys
from pathlib import Path

from fuzz import complaint, fuzz, mutant, parser_of, run
from fuzz_limerick import NUMBERS

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


def write(rng: random.Random, folder: Path, numbers: range) -> list[Path]:
    """Write files of blocks and their decks, one or both of them changed, and one record for all of them."""
    def changed(seeds: list[bytes]) -> bytes:
        return mutant(rng, seeds, WORDS, NUMBERS, (0, 1, 1, 1, 2, 4))

    (folder / "record.csv").write_bytes(rng.choice(RECORDS) if rng.random() < 0.5 else changed(RECORDS))
    decks = []
    for number in numbers:
        which = rng.randrange(3)
        (folder / f"m{number}.blocks").write_bytes(rng.choice(BLOCKS) if which == 1 else changed(BLOCKS))
        decks.append(folder / f"m{number}.nml")
        head = f"&scene kind = 'blocks', geometry = 'm{number}.blocks' /\n".encode()
        decks[-1].write_bytes(head + (rng.choice(GROUPS) if which == 0 else changed(GROUPS)))
    return decks


def is_small(text: bytes) -> bool:
    """Whether a deck that was accepted takes no time: no number asks for many steps or pictures."""
    numbers = [float(word) for word in re.findall(rb"(?:frames|limit|count) *= *(\d+)", text)]
    return b"sweep" not in text.lower() and max(numbers, default=0.0) <= 100.0


def compute(dda: str, deck: Path) -> str | None:
    """Run a deck; return the error found, an empty text if there is none, None if the deck is refused or large."""
    if not is_small(deck.read_bytes()) or run([dda, "check"], [deck], 20.0)[0] != 0:
        return None
    out = deck.with_suffix(".out")
    status, lines = run([dda, "run", *SHORT, "--out", out], [deck], 60.0)
    broken, _ = complaint(status, lines, [deck], others=True, accepted=(0, 2, 3))
    if not broken and status in (0, 3):
        rows = (out / "results.csv").read_bytes()
        if rows.count(b"\n") != 2 or b"nan" in rows.lower().split(b"\n")[1]:
            return "not one row of numbers"
    return broken


def main() -> int:
    """Fuzz and report."""
    options = parser_of(__doc__).parse_args()
    return fuzz(options, 40, write,
                lambda decks: complaint(*run([options.dda, "check"], decks, 20.0), decks, others=True),
                lambda deck: compute(options.dda, deck))


if __name__ == "__main__":
    sys.exit(main())
