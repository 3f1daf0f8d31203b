#!/usr/bin/env python3
"""Seeded mutation fuzzer of the deck reader.

usage: fuzz_deck.py --command 'build/bin/dda check' [--mutants N] [--seed N] [--run PROGRAM]

Mutates good decks and runs COMMAND on them, many decks a call. Every deck must
either be accepted or give one line FILE:LINE: error: ...; the exit status must
be 0 (all accepted) or 2 (some refused); nothing may crash or hang. The same
seed makes the same mutants. With --run, the first case of each small deck that is accepted is
computed as well: status 0 or 3, one row, no message. Ends with status 1 and keeps the decks that
failed.
"""
import argparse
import random
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

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

ERROR = re.compile(r"^(?P<file>.+?):(?P<line>\d+): error: [ -~]+$")


def cut(rng, text):
    """Two places in a text, the first not after the second, mostly near each other."""
    first = rng.randrange(len(text) + 1)
    length = rng.choice([1, 1, 2, 5, 20, len(text)])
    return first, min(len(text), first + rng.randint(0, length))


def mutate_once(rng, text):
    """One change of a text."""
    first, last = cut(rng, text)
    kind = rng.randrange(14)
    if kind == 0:
        return text[:first] + text[last:]
    if kind == 1:
        return text[:last] + text[first:]
    if kind == 2:
        return text[:first] + bytes([rng.randrange(256)]) + text[first + 1:]
    if kind in (3, 4):
        return text[:first] + rng.choice(WORDS) + text[last if kind == 4 else first:]
    if kind == 5:
        lines = text.split(b"\n")
        rng.shuffle(lines)
        return b"\n".join(lines)
    if kind == 6:
        other = rng.choice(SEEDS)
        begin, end = cut(rng, other)
        return text[:first] + other[begin:end] + text[last:]
    if kind == 7:
        return text[:first]
    pattern, choices = (rb"[0-9.]+", NUMBERS) if kind < 11 else (rb"[a-z_]+ *=|'[^']*'", WORDS)
    places = list(re.finditer(pattern, text))
    if not places:
        return text
    place = rng.choice(places)
    return text[:place.start()] + rng.choice(choices) + text[place.end():]


def mutant(rng):
    """A deck made from a seed by one change or more."""
    text = rng.choice(SEEDS)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 6])):
        text = mutate_once(rng, text)
    return text


def bounded(words, seconds):
    """Run a program for so many seconds of the processor: what was done; None for a hang."""
    limit = int(seconds) + 1
    try:
        done = subprocess.run(words, timeout=60 * limit, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
    except subprocess.TimeoutExpired:
        return None
    return None if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else done


def run(command, decks, timeout):
    """Run the command on decks: exit status (None for a hang) and lines of output."""
    done = bounded(command + [str(deck) for deck in decks], timeout)
    if done is None:
        return None, []
    return done.returncode, done.stdout.decode("utf-8", "replace").splitlines()


def complaint(status, lines, files, others=False):
    """Rules that the outcome of a run breaks, as text; empty if none. Also the number refused.

    With `others` a message may be about another file than these.
    """
    if status is None:
        return "hang", 0
    if status not in (0, 2):
        return f"status {status}: " + " | ".join(lines[-5:]), 0
    refused = set()
    names = {str(file): file for file in files}
    for line in lines:
        match = ERROR.match(line)
        if not match:
            if "error:" in line.lower() or "NaN" in line or "Infinity" in line:
                return f"no file and line: {line}", 0
            continue
        if match["file"] in refused or match["file"] not in names and not others:
            return f"not one line a file: {line}", 0
        text = names[match["file"]].read_bytes() if match["file"] in names else b"\n" * 10**4
        refused.add(match["file"] if match["file"] in names else line)
        ends = text.count(b"\n") + text.count(b"\r") - text.count(b"\r\n")
        if not 1 <= int(match["line"]) <= ends + 1:
            return f"no such line: {line}", 0
    if (status == 2) != bool(refused):
        return f"status {status} with {len(refused)} files refused", 0
    return "", len(refused)


def report(file, words, keep):
    """Keep a file that failed, and print why."""
    Path(keep).mkdir(parents=True, exist_ok=True)
    shutil.copy(file, keep)
    print(f"{file.name}: {words}", flush=True)


def try_batch(files, attempt, keep):
    """Numbers of files refused and failed: all are tried together, and each alone where that breaks a rule.

    `attempt` is `complaint` of a run on some files.
    """
    trouble, refused = attempt(files)
    if not trouble:
        return refused, 0
    refused = failed = 0
    for file in files:
        here, one = attempt([file])
        refused += one
        if here:
            failed += 1
            report(file, here, keep)
    if not failed:
        failed = 1
        print(f"only together, from {files[0].name}: {trouble}", flush=True)
    return refused, failed


def parser_of(doc, batch):
    """Options that fuzzers share."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mutants", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--batch", type=int, default=batch, help="files a call")
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds of the processor a call")
    parser.add_argument("--keep", default="fuzz_failed", help="folder for files that failed")
    return parser


def small(program, deck):
    """Whether the first case of a deck is computed in no time: few blocks, few steps."""
    text = deck.read_bytes().lower()
    plan = subprocess.run([program, "check", deck], stdout=subprocess.PIPE, check=False).stdout
    blocks = re.search(rb"blocks +(\d+) free", plan)
    numbers = [float(word) for word in re.findall(rb"(?:steps|frames|limit) *= *(\d+)", text)]
    return blocks is not None and int(blocks[1]) <= 60 and max(numbers, default=0) <= 1000


def run_first_case(program, deck, timeout):
    """What computing the first case of a good deck breaks; empty if all is well."""
    with tempfile.TemporaryDirectory() as folder:
        words = [program, "run", deck, "--cases", "1", "--out", folder, "--quiet"]
        done = bounded(words, timeout)
        if done is None:
            return "hang of its first case"
        if done.returncode not in (0, 3) or done.stdout:
            return f"status {done.returncode} of its first case: {done.stdout[-300:]}"
        rows = (Path(folder) / "results.csv").read_bytes().count(b"\n") - 1
        return "" if rows == 1 else f"{rows} rows of its first case"


def main():
    """Fuzz and report."""
    parser = parser_of(__doc__, 50)
    parser.add_argument("--command", required=True, help="what to run, before the names of decks")
    parser.add_argument("--run", metavar="PROGRAM", help="dda, to compute good decks with")
    options = parser.parse_args()
    command = shlex.split(options.command)
    rng = random.Random(options.seed)
    refused = failed = computed = 0
    with tempfile.TemporaryDirectory() as folder:
        for start in range(0, options.mutants, options.batch):
            decks = [Path(folder) / f"mutant{i}.nml" for i in range(start, min(start + options.batch, options.mutants))]
            for deck in decks:
                deck.write_bytes(mutant(rng))
            count, broken = try_batch(
                decks, lambda files: complaint(*run(command, files, options.timeout), files), options.keep)
            refused, failed = refused + count, failed + broken
            for deck in decks if options.run and not broken else ():
                if run(command, [deck], options.timeout)[0] == 0 and small(options.run, deck):
                    computed += 1
                    words = run_first_case(options.run, deck, 60.0)
                    if words:
                        failed += 1
                        report(deck, words, options.keep)
            for deck in decks:
                deck.unlink()
    print(f"{options.mutants} mutants, seed {options.seed}: {refused} refused, "
          f"{options.mutants - refused - failed} accepted, {failed} failed, "
          f"{computed} computed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
