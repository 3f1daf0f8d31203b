#!/usr/bin/env python3
"""Seeded mutation fuzzer of restart files.

usage: fuzz_restart.py --dda build/bin/dda [--mutants N] [--seed N] [--keep FOLDER]

Runs that go on are given files that were spoilt: one in seven has bytes changed, cut off or put in
and is refused with status 2; the others have made-up counts, indices and numbers under a true check
sum. These are refused with one line FILE:LINE: error: ..., or computed: status 0 or 3, no NaN and
no Inf in any table, no crash, no hang. The same seed makes the same mutants. Ends with status 1 and
keeps the files that failed, each with its deck.
"""

from __future__ import annotations

import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from collections import Counter
from pathlib import Path

from fuzz import complaint, parser_of, run
from fuzz_blocks import BLOCKS, RECORDS

TITLE = b"voussoir restart 6"  #: First bytes of a restart file
JOINT = (12, 24)  #: Whole numbers and numbers of each joint, at the end of the whole numbers and of the numbers
#: Scenes whose runs go on: blocks that were found to touch, as they move and as they were at the
#: beginning, and arches, whose joints are given
SCENES = [
    ("&scene kind = 'blocks', geometry = 'a.blocks' /", "geometry = 'current', time_step = 0.001"),
    ("&scene kind = 'blocks', geometry = 'b.blocks' /",
     "geometry = 'current', time_step = 0.01, restitution = 0.5"),
    ("&scene kind = 'blocks', geometry = 'a.blocks' /", "geometry = 'reference', time_step = 0.001"),
    ("&arch voussoirs = 5, thickness_ratio = 0.08 /",
     "geometry = 'current', time_step = 0.01, duration = 1.0"),
    ("&arch voussoirs = 4, thickness_ratio = 0.2 / &joint cohesion = 1e3, tension = 1e2 /",
     "geometry = 'reference', time_step = 0.01"),
    ("&scene kind = 'blocks', geometry = 'b.blocks' /",
     "geometry = 'current', time_step = 0.02, unknowns = 3"),
]
STEPS = (5, 8)  #: Steps of a run before its file is written, and of the one that goes on
WHOLES = [-(2**31), -1, 0, 1, 2, 3, 7, 100, 10**6, 2**31 - 1]
NUMBERS = [float(word) for word in "0 -0 1 -1 nan inf -inf 1e308 -1e308 1e100 1e30 -1e15 1e8 1e-8 "
           "1e-30 5e-324 3.14159265358979 -0.99 100 -1e3".split()]
NOT_A_NUMBER = re.compile(rb"(?:^|,)[-+]?(?:nan|inf)\w*(?:,|$)", re.IGNORECASE | re.MULTILINE)


def spoil(rng: random.Random, good: bytes) -> bytes:
    """A file with bytes changed, cut off, put in or exchanged."""
    place, kind = rng.randrange(len(good)), rng.randrange(4)
    if kind == 0:
        return good[:place] + bytes([good[place] ^ (1 << rng.randrange(8))]) + good[place + 1:]
    if kind == 1:
        return good[:place]
    if kind == 2:
        return good[:place] + rng.randbytes(rng.choice([1, 4, 8, 64])) + good[place:]
    number = rng.choice([b"\xff" * 8, b"\0" * 8, b"\xff\xff\xff\x7f", rng.randbytes(8)])
    spoilt = good[:place] + number + good[place + len(number):]
    return spoilt if spoilt != good else good[:-1]


def file_of(whole: list[int], number: list[float]) -> bytes:
    """A file of numbers with a true check sum."""
    body = struct.pack(f"<2i{len(whole)}i{len(number)}d", len(whole), len(number), *whole, *number)
    return TITLE + struct.pack("<q", zlib.crc32(body)) + body


SIGNALLING = struct.pack("<Q", 0x7FF0000000000001)  #: A NaN that a processor told to trap does not even compare


def numbers_of(content: bytes) -> tuple[list[int], list[float]]:
    """Whole numbers and numbers of a file."""
    start = len(TITLE) + 16
    n_whole, n_number = struct.unpack("<2i", content[start - 8:start])
    whole = struct.unpack_from(f"<{n_whole}i", content, start)
    return list(whole), list(struct.unpack_from(f"<{n_number}d", content, start + 4 * n_whole))


def make_up(rng: random.Random, good: bytes) -> bytes:
    """A file with other numbers, and a true check sum."""
    whole, number = numbers_of(good)
    for _ in range(rng.choice([1, 1, 1, 2, 5, 30])):
        kind, at, place = rng.randrange(6), rng.randrange(len(whole)), rng.randrange(len(number))
        if kind == 0:
            whole[at] += rng.choice([-2, -1, 1, 2])
        elif kind == 1:
            whole[at] = rng.choice(WHOLES)
        elif kind == 2:
            number[place] = rng.choice(NUMBERS)
        elif kind == 3:
            number[place] *= rng.choice([-1.0, 0.0, 1e3, 1e-3, 1e12, 1e30, 1e150])
        elif kind == 4:
            number[place] = struct.unpack("<d", rng.choice([rng.randbytes(8), SIGNALLING]))[0]
        else:  # what belongs elsewhere
            end = min(len(number), place + rng.choice([1, 6, JOINT[1]]))
            number[place:end] = rng.sample(number, end - place)
    if rng.random() < 0.1 and whole[5] > 0:  # a joint more or less, as the counts say
        if rng.random() < 0.5:
            whole, number = whole[: -JOINT[0]], number[: -JOINT[1]]
            whole[5] -= 1
        else:
            whole, number = whole + whole[-JOINT[0]:], number + number[-JOINT[1]:]
            whole[5] += 1
    return file_of([(value + 2**31) % 2**32 - 2**31 for value in whole], number)


def deck_of(scene: tuple[str, str], steps: int, restart: str = "") -> str:
    """A deck that writes a restart file, or goes on from one."""
    if restart:
        frames = 3 * ("current" in scene[1])
        output = f"&output energy = .true., frames = {frames}, restart = .true. /"
        restart = f", restart = '{restart}'"
    else:
        output = "&output restart = .true. /"
    return f"{scene[0]}\n&analysis mode = 'dynamic', {scene[1]}, steps = {steps}{restart} /\n{output}\n"


def what_is_broken(folder: Path, status: int | None, lines: list[str], kind: str) -> str:
    """What a run on a file of some kind breaks; empty if nothing is."""
    broken, _ = complaint(status, lines, [folder / "s.nml"], others=True, accepted=(0, 2, 3))
    if not broken and (kind == "good" and status == 2 or kind == "spoilt" and status != 2):
        return f"status {status}"
    for table in sorted((folder / "out").glob("*.csv")):
        if not broken and NOT_A_NUMBER.search(table.read_bytes()):
            return f"NaN or Inf in {table.name}"
    return broken


def main() -> int:
    """Fuzz and report."""
    options = parser_of(__doc__, 3000).parse_args()
    rng = random.Random(options.seed)
    failed: list[str] = []
    outcomes: Counter[tuple[str, int | None]] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "record.csv").write_bytes(RECORDS[0])
        for stem, blocks in zip("ab", BLOCKS):
            (folder / f"{stem}.blocks").write_bytes(blocks)
        good = []
        for number, scene in enumerate(SCENES):
            (folder / f"g{number}.nml").write_text(deck_of(scene, STEPS[0]))
            words = [options.dda, "run", f"g{number}.nml", "--quiet"]
            subprocess.run(words, cwd=folder, check=False, capture_output=True)
            good.append((folder / f"g{number}" / "case_1.restart").read_bytes())
        for number in range(options.mutants):
            kind = "made up" if number % 7 else "spoilt"
            content = good[number % len(good)]
            if number < len(good):
                kind = "good"
            else:
                content = (make_up if kind == "made up" else spoil)(rng, content)
            deck, restart = folder / "s.nml", folder / f"s{number}.restart"
            deck.write_text(deck_of(SCENES[number % len(good)], STEPS[1], restart.name))
            restart.write_bytes(content)
            shutil.rmtree(folder / "out", ignore_errors=True)
            words = [options.dda, "run", "--quiet", "--out", str(folder / "out")]
            status, lines = run(words, [deck], 20.0)
            outcomes[kind, status] += 1
            broken = what_is_broken(folder, status, lines, kind)
            if broken:
                failed.append(f"{restart.name}: {broken}")
                Path(options.keep).mkdir(parents=True, exist_ok=True)
                shutil.copy(restart, options.keep)
                shutil.copy(deck, Path(options.keep) / f"s{number}.nml")
            restart.unlink()
    print("\n".join(failed))
    print(f"{options.mutants} restart files, seed {options.seed}: "
          + ", ".join(f"{count} {kind} with status {status}"
                      for (kind, status), count in sorted(outcomes.items(), key=str))
          + f"; {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
