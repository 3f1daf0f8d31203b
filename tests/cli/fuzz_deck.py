#!/usr/bin/env python3
"""Seeded mutation fuzzer of the deck reader.

usage: fuzz_deck.py --dda build/bin/dda [--mutants N] [--runs N] [--seed N]

Mutates good decks and has `dda check` read them, many decks a call. With --runs, the first case of small decks that are
accepted is computed as well: status 0 or 3, one row, no message. Rules and options are those of fuzz.py.
"""

from __future__ import annotations

import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from fuzz import complaint, fuzz, mutant, parser_of, run

SEEDS = [
    b"""&scene title='Semicircle of 36 voussoirs' /
&arch radius=10.0, thickness_ratio=0.12, half_angle_deg=90.0, voussoirs=36 /
&material density=2240.0, young=5e9, poisson=0.2, plane='stress' /
&joint friction_deg=50.0 /
""",
    b"""! Table 1: critical thickness against the number of voussoirs
&scene title='Table 1' /
&arch half_angle_deg=90.0 /
&search parameter='thickness_ratio', low=0.05, high=0.2, tolerance=1e-8 /
&sweep parameter='voussoirs', values=12, 18, 24,
       30, 36, 60, 72, 90 /
""",
    b"""&scene
   title = 'Four blocks, l''arche' ! joints imposed
/
&arch
   joints_deg = 0, 54.5, 90
   facet_deg  = 0.5
   springing  = 'no-slip'
/
&sweep parameter='joints_deg(2)', first=10, last=80, count=15 /
&sweep parameter='geometry', texts='reference', 'current' /
&output vtu=.false., joints=T /
""",
    b"""&ARCH Half_Angle_Deg=140 voussoirs=56/ &material unit_weight=22000 /
&joint friction_deg=72, cohesion=0, tension=0.0 /
&load gravity=9.81, gravity_direction_deg=-90, horizontal_coefficient=0.0 /
&analysis mode='static', geometry='current', steps=400, max_displacement_ratio=0.05,
   time_step=1d-3, penalty_ratio=100, collapse_displacement=0.5, open_close_limit=400, flow='associated' &end
""",
    b"""&arch voussoirs=8, thickness_ratio=0.09 / &search parameter='horizontal_coefficient' /
&joint friction_deg=35, cohesion=1e3, tension=5e2 / &material plane='strain' poisson=0.3 /
&analysis geometry='current', steps=50 / &output frames=3, vtu=.true., joints=.true. /
""",
    b"""\xef\xbb\xbf&arch thickness_ratio=0.3\r\n/\r\n&search parameter='friction_deg' /\r
&sweep parameter='half_angle_deg', values=45, 60, 75 /\r
&sweep parameter='voussoirs', values=18, 24, 30, linked=.true. /\r
&sweep parameter='radius', values=2*1.0, 3*1.e1 /\r
&output max_cases=100 /\r
""",
]

WORDS = """& / ! ' " = , , * ( ) % + - . 0 1 -1 2 3.5 1e9 1e308 1e309 1e999 -1e400 1e-400 nan inf
-infinity 0.0 179.999 180 1e-300 99999999999 2147483647 100000*1 99999999*2 0*1 3* .true. .false. t f
&end &arch &scene &material &joint &load &analysis &search &sweep &output &sweeps &arc $arch
parameter= values= texts= first= last= count= linked=.true. radius= thickness_ratio= voussoirs=
joints_deg= joints_deg(2)= joints_deg(9) facet_deg= kind='lines' mode='limerick' mode='dynamic'
geometry='current' 'friction_deg' 'thickness_ratio' 'title' 'joints_deg' 'arch%radius' 'density'
low= high= tolerance= unit_weight=1 gravity=0 max_cases=1 1;2 10,5 '' "" é""".split()
WORDS = [word.encode() for word in WORDS] + [b"\n", b"\r", b"\r\n", b"\t", b"\x00", b"\xff", b" "]

NUMBERS = [word for word in WORDS if re.match(rb"[-0-9ni]", word)] + [
    b"0.1", b"1.0", b"2", b"45", b"89.95", b"91", b"1.5d0", b"1e-12", b"1e30", b"0.0, 30", b"7*1"]


def small(program: str, deck: Path) -> bool:
    """Whether the first case of a deck is computed in no time: few blocks, few steps."""
    text = deck.read_bytes().lower()
    plan = subprocess.run([program, "check", deck], stdout=subprocess.PIPE, check=False).stdout
    blocks = re.search(rb"blocks +(\d+) free", plan)
    numbers = [float(word) for word in re.findall(rb"(?:steps|frames|limit) *= *(\d+)", text)]
    return blocks is not None and int(blocks[1]) <= 60 and max(numbers, default=0) <= 1000


def first_case(program: str, deck: Path) -> str | None:
    """Run the first case of a valid deck; return the error, an empty text if none, None if refused or large."""
    if run([program, "check"], [deck], 10.0)[0] != 0 or not small(program, deck):
        return None
    with tempfile.TemporaryDirectory() as folder:
        status, lines = run([program, "run", "--cases", "1", "--out", folder, "--quiet"], [deck], 60.0)
        if status not in (0, 3) or lines:
            return "hang of its first case" if status is None else f"status {status} of its first case: {lines[-3:]}"
        rows = (Path(folder) / "results.csv").read_bytes().count(b"\n") - 1
        return "" if rows == 1 else f"{rows} rows of its first case"


def write(rng: random.Random, folder: Path, numbers: range) -> list[Path]:
    """Write mutants."""
    decks = [folder / f"mutant{number}.nml" for number in numbers]
    for deck in decks:
        deck.write_bytes(mutant(rng, SEEDS, WORDS, NUMBERS))
    return decks


def main() -> int:
    """Fuzz and report."""
    options = parser_of(__doc__).parse_args()
    return fuzz(options, 50, write, lambda decks: complaint(*run([options.dda, "check"], decks, 10.0), decks),
                lambda deck: first_case(options.dda, deck))


if __name__ == "__main__":
    sys.exit(main())
