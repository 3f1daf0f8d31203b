#!/usr/bin/env python3
"""Seeded mutation fuzzer of the readers of Limerick files, and of block cutting.

usage: fuzz_limerick.py --dda build/bin/dda [--mutants N] [--seed N]

Mutates good files of all four forms: geometry and analysis, plain and DDAML.
Geometries go through `dda cut`, analyses through `dda check` with a deck that
names them, many files a call. Every file must either be accepted or give one
line FILE:LINE: error: ... with a line that the file has; the exit status must
be 0 or 2; nothing may crash or take 10 seconds. The same seed makes the same
mutants. Ends with status 1 and keeps the files that failed.
"""

from __future__ import annotations

import random
import re
import shutil
import sys
import tempfile
from pathlib import Path

from fuzz_deck import complaint, cut, parser_of, run, try_batch

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


def mutate_once(rng: random.Random, text: bytes, seeds: list[bytes]) -> bytes:
    """Change a file once."""
    first, last = cut(rng, text)
    kind = rng.randrange(22)
    if kind == 0:
        return text[:first] + text[last:]
    if kind == 1:
        return text[:last] + text[first:]
    if kind == 2:
        return text[:first] + bytes([rng.randrange(256)]) + text[first + 1:]
    if kind == 3:
        return text[:first] + rng.choice(WORDS) + text[rng.choice((first, last)):]
    if kind == 4:
        lines = text.split(b"\n")
        rng.shuffle(lines)
        return b"\n".join(lines)
    if kind == 5:
        other = rng.choice(seeds)
        begin, end = cut(rng, other)
        return text[:first] + other[begin:end] + text[last:]
    if kind == 6:
        return text[:first]
    if kind == 7:
        lines = text.split(b"\n")
        lines.insert(rng.randrange(len(lines)), rng.choice(lines))
        return b"\n".join(lines)
    places = list(re.finditer(rb"[-+0-9.e]*[0-9]", text))
    if not places:
        return text
    place = rng.choice(places)
    new = rng.choice(NUMBERS)
    if kind > 12:
        # a number near that of another place, so that lines still meet, or nearly
        near = rng.choice((0.0, 0.0, 1e-12, -1e-9, 1e-6, 1e-3, 0.01, -0.1, 1.0))
        try:
            new = repr(float(rng.choice(places)[0]) + near).encode()
        except ValueError:
            pass
    return text[:place.start()] + new + text[place.end():]


def mutant(rng: random.Random, seeds: list[bytes]) -> bytes:
    """Make a file from a good one by one change or more."""
    text = rng.choice(seeds)
    for _ in range(rng.choice([1, 1, 2, 3, 6, 12])):
        text = mutate_once(rng, text, seeds)
    return text


def try_files(dda: str, form: str, files: list[Path], timeout: float) -> tuple[str, int]:
    """Run the program on mutants of a form of SEEDS for so many seconds a call: as `complaint`."""
    if form.endswith(".geo"):
        return complaint(*run([dda, "cut"], files, timeout), files, others=True)
    decks = [path.with_suffix(".nml") for path in files]
    for path, deck in zip(files, decks):
        deck.write_text(f"&scene kind='lines', geometry='terrace.geo', analysis='{path.name}' /\n")
    # a complaint of the geometry about its analysis counts for the analysis
    return complaint(*run([dda, "check"], decks, timeout), files, others=True)


def main() -> int:
    """Fuzz and report."""
    parser = parser_of(__doc__, 25)
    parser.add_argument("--dda", required=True, help="the program")
    options = parser.parse_args()
    rng = random.Random(options.seed)
    refused = failed = made = 0
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(INPUT / "terrace.geo", folder)
        while made < options.mutants:
            form = list(SEEDS)[made // options.batch % len(SEEDS)]
            files = [Path(folder) / f"mutant{made + i}.{form}"
                     for i in range(min(options.batch, options.mutants - made))]
            made += len(files)
            for path in files:
                path.write_bytes(mutant(rng, SEEDS[form]))
            count, broken = try_batch(
                files, lambda tried, form=form: try_files(options.dda, form, tried, options.timeout), options.keep)
            refused, failed = refused + count, failed + broken
            for path in files:
                path.unlink()
    print(f"{made} mutants, seed {options.seed}: {refused} refused, "
          f"{made - refused - failed} accepted, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
