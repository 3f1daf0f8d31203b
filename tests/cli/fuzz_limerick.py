#!/usr/bin/env python3
"""Seeded mutation fuzzer of the readers of Limerick files, and of block cutting.

usage: fuzz_limerick.py --dda build/bin/dda [--mutants N] [--seed N]

Mutates good files of all four forms: geometry and analysis, plain and DDAML.
Geometries go through `dda cut`, analyses through `dda check` with a deck that
names them, many files a call. Rules and options are those of fuzz.py.
"""

from __future__ import annotations

import random
import shutil
import sys
from pathlib import Path

from fuzz import complaint, fuzz, mutant, parser_of, run

BATCH = 25  #: Files a call, all of one form
INPUT = Path(__file__).parents[2] / "input" / "limerick"
SMALL = """<?xml version="1.0"?>
<d:DDA xmlns:d="u"><Geometry><Edgenodedist distance="0.01"/>
<Jointlist><Joint type="1">0 0 1 0</Joint><Joint type="1">1 0 1 1</Joint>
<Joint type="1">1 1 0 1</Joint><Joint type="1">0 1 0 0</Joint></Jointlist>
<Fixedpointlist><Line> -0.5 0.5 1.5 0.5 </Line></Fixedpointlist></Geometry></d:DDA>
"""
SQUARES = "0.01\n5 4\n0\n0\n1\n0\n0\n0\n0 0 2 0 1\n2 0 2 1 1\n2 1 0 1 1\n0 1 0 0 1\n1 0 1 1 2\n"
BOLTED = SQUARES.replace("5 4\n0\n0\n", "5 4\n0\n2\n", 1) + (
    "0.5 0.5 1.5 0.5 1e6 1e3 10\n0.2 0.2 1.8 -3 2e6 1e30 0\n0.5 0.5 0.5 0.5\n"
)
BOLTED_XML = SMALL.replace(
    "</Jointlist>",
    '</Jointlist><Boltlist><Bolt type="1"> 0.2 0.2 0.8 3 </Bolt><Bolt stiffness="1e6" '
    'strength="1e3" pretension="5"> 0.2 0.2 0.8 3 </Bolt></Boltlist>',
    1,
)
FAN = "0.001\n12 0 0 0 0 0 0 0\n" + "".join(
    f"{5 - dx} {5 - dy} {5 + dx} {5 + dy} 1\n" for dx, dy in ((5, 0), (5, 1), (5, 1e-4), (0, 5))
) + "".join(f"{a} {b} {c} {d} 1\n" for a, b, c, d in (
    (0, 0, 10, 0), (10, 0, 10, 10), (10, 10, 0, 10), (0, 10, 0, 0),
    (1, 1, 9, 1), (1, 1, 1, 9), (9, 1, 9, 9), (1, 9, 9, 9)))
SEEDS = {
    "plain.geo": [(INPUT / "terrace.geo").read_bytes(), SQUARES.encode() + b"0.5 0.5 0.5 0.5\n",
                  FAN.encode(), BOLTED.encode(), BOLTED.encode()],
    "ddaml.geo": [(INPUT / "terrace_ddaml.geo").read_bytes(), SMALL.encode(),
                  BOLTED_XML.encode()],
    "plain.ana": [(INPUT / "terrace.ana").read_bytes()],
    "ddaml.ana": [
        (INPUT / "terrace_ddaml.ana").read_bytes(),
        (INPUT / "terrace_ddaml.ana").read_bytes().replace(
            b"<Jointproperties", b"<Boltproperties> 1e6 1e3 5 </Boltproperties>\n<Jointproperties", 1
        ),
    ],
}
NUMBERS = b"""0 1 -1 2 3 17 0.5 1e-9 1e-300 1e300 1e308 1e309 -1e15 1e15 2e15 99999999 2147483648 nan
inf -inf 1,5 1d3 0x10 1.2.3 1e 3.9999999 0.4999999 5.0000001 1e-16""".split()
WORDS = b"""< > & / ; " ' <!-- --> <?x?> <![CDATA[ ]]> &amp; &e; &#48; type="1" type="0" type=""
<Joint> </Joint> <Point/> <Line> </Line> <Geometry> </Geometry> <Analysis> </Analysis> <Boltlist>
<Bolt> </Bolt> <Foo/> <Foo> </Foo> <Edgenodedist/>
distance="&e;" <Holepointlist> numpoints="2" flag="yes" flag="" value="nan" <!DOCTYPE]>
<!DOCTYPE\x20a[<!ENTITY\x20e\x20"1">]> #!0xDDA-v1.5 \xc3\xa9 \xff \x00 \xef\xbb\xbf xmlns:q=""".split()
WORDS += [b"\n", b"\r", b"\r\n", b"\t", b" ", b"\n\n"]


def write(rng: random.Random, folder: Path, numbers: range) -> list[Path]:
    """Write mutants of one form, and a geometry for those that are analyses."""
    shutil.copy(INPUT / "terrace.geo", folder)
    form = list(SEEDS)[numbers.start // BATCH % len(SEEDS)]
    files = [folder / f"mutant{number}.{form}" for number in numbers]
    for path in files:
        path.write_bytes(mutant(rng, SEEDS[form], WORDS, NUMBERS, (1, 1, 2, 3, 6, 12)))
    return files


def try_files(dda: str, files: list[Path]) -> tuple[str, int]:
    """Run the program on mutants of a form: as `complaint`."""
    if files[0].suffix == ".geo":
        return complaint(*run([dda, "cut"], files, 10.0), files, others=True)
    decks = [path.with_suffix(".nml") for path in files]
    for path, deck in zip(files, decks):
        deck.write_text(f"&scene kind='lines', geometry='terrace.geo', analysis='{path.name}' /\n")
    # a complaint of the geometry about its analysis counts for the analysis
    return complaint(*run([dda, "check"], decks, 10.0), files, others=True)


def main() -> int:
    """Fuzz and report."""
    options = parser_of(__doc__).parse_args()
    return fuzz(options, BATCH, write, lambda files: try_files(options.dda, files))


if __name__ == "__main__":
    sys.exit(main())
