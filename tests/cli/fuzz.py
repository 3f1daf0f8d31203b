"""Common code of the fuzzers: seeded changes of valid files, runs of the program, and checks of its answers.

Every file must either be accepted or give one line FILE:LINE: error: ... with a line that it has; the exit status must
be 0 (all accepted) or 2 (some refused); nothing may crash or hang. The same seed makes the same mutants. A fuzzer ends
with status 1 and keeps the files that failed.
"""

from __future__ import annotations

import argparse
import random
import re
import resource
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

ERROR = re.compile(r"^(?P<file>.+?):(?P<line>\d+): error: [ -~]+$")
#: Exit status of a run, None for a hang, and its lines of output
Outcome = tuple[Any, list[str]]


def cut(rng: random.Random, text: bytes) -> tuple[int, int]:
    """Two places in a text, the first not after the second, mostly near each other."""
    first = rng.randrange(len(text) + 1)
    length = rng.choice([1, 1, 2, 5, 20, len(text)])
    return first, min(len(text), first + rng.randint(0, length))


def mutate_once(
    rng: random.Random, text: bytes, seeds: Sequence[bytes], words: Sequence[bytes], numbers: Sequence[bytes]
) -> bytes:
    """One change of a text: of its bytes, its lines, its words or, mostly, its numbers."""
    first, last = cut(rng, text)
    kind = rng.randrange(22)
    if kind == 0:
        return text[:first] + text[last:]
    if kind == 1:
        return text[:last] + text[first:]
    if kind == 2:
        return text[:first] + bytes([rng.randrange(256)]) + text[first + 1:]
    if kind in (3, 4):
        return text[:first] + rng.choice(words) + text[last if kind == 4 else first:]
    if kind == 5:
        other = rng.choice(seeds)
        begin, end = cut(rng, other)
        return text[:first] + other[begin:end] + text[last:]
    if kind == 6:
        return text[:first]
    if kind in (7, 8):
        lines = text.split(b"\n")
        if kind == 7:
            rng.shuffle(lines)
        else:
            lines.insert(rng.randrange(len(lines)), rng.choice(lines))
        return b"\n".join(lines)
    pattern, new = rb"[-+0-9.e]*[0-9]", rng.choice(numbers)
    if kind < 13:
        pattern, new = rng.choice((rb"[a-z_]+ *=|'[^']*'", rb"\S+")), rng.choice(words)
    places = list(re.finditer(pattern, text))
    if not places:
        return text
    place = rng.choice(places)
    if kind > 17:
        # a number near that of another place, so that lines still meet, or nearly
        near = rng.choice((0.0, 0.0, 1e-12, -1e-9, 1e-6, 1e-3, 0.01, -0.1, 1.0))
        try:
            new = repr(float(rng.choice(places)[0]) + near).encode()
        except ValueError:
            pass
    return text[:place.start()] + new + text[place.end():]


def mutant(
    rng: random.Random, seeds: Sequence[bytes], words: Sequence[bytes], numbers: Sequence[bytes],
    changes: Sequence[int] = (1, 1, 1, 2, 3, 6)
) -> bytes:
    """Make a text from a good one by one of these numbers of changes."""
    text = rng.choice(seeds)
    for _ in range(rng.choice(changes)):
        text = mutate_once(rng, text, seeds, words, numbers)
    return text


def run(command: Sequence[object], files: Sequence[Path], seconds: float) -> Outcome:
    """Run a command on files for so many seconds of the processor."""
    limit = int(seconds) + 1
    try:
        done = subprocess.run(
            [*map(str, command), *map(str, files)], timeout=60 * limit, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
    except subprocess.TimeoutExpired:
        return None, []
    hangs = done.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
    return None if hangs else done.returncode, done.stdout.decode("utf-8", "replace").splitlines()


def complaint(
    status: int | None, lines: list[str], files: Sequence[Path], others: bool = False, accepted: Sequence[int] = (0, 2)
) -> tuple[str, int]:
    """Rules that the outcome of a run breaks, as text; empty if none. Also the number refused.

    With `others` a message may be about another file than these.
    """
    if status not in accepted:
        return "hang" if status is None else f"status {status}: " + " | ".join(lines[-5:]), 0
    refused, names = set(), {str(file) for file in files}
    for line in lines:
        match = ERROR.match(line)
        if not match:
            if "error" in line.lower() or "NaN" in line or "Infinity" in line:
                return f"no file and line: {line}", 0
            continue
        name = match["file"]
        if name in refused or name not in names and not others:
            return f"not one line a file: {line}", 0
        refused.add(name if name in names else line)
        text = Path(name).read_bytes() if Path(name).is_file() and Path(name).suffix != ".restart" else b"\n" * 10**4
        ends = text.count(b"\n") + text.count(b"\r") - text.count(b"\r\n")
        if not 1 <= int(match["line"]) <= ends + 1:
            return f"no such line: {line}", 0
    return f"status {status} with {len(refused)} files refused" if (status == 2) != bool(refused) else "", len(refused)


def report(file: Path, words: str, keep: str) -> None:
    """Keep a file that failed with those of its name, and print why."""
    Path(keep).mkdir(parents=True, exist_ok=True)
    for path in [*file.parent.glob(file.name.split(".")[0] + ".*"), *file.parent.glob("record.csv")]:
        shutil.copy(path, keep)
    print(f"{file.name}: {words}", flush=True)


def parser_of(doc: str, mutants: int = 20000) -> argparse.ArgumentParser:
    """Options that fuzzers share."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dda", required=True, type=lambda name: str(Path(name).resolve()), help="the program")
    parser.add_argument("--mutants", type=int, default=mutants)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", type=int, default=0, help="accepted decks to compute at most")
    parser.add_argument("--keep", default="fuzz_failed", help="folder for files that failed")
    return parser


def fuzz(
    options: argparse.Namespace, batch: int, write: Callable[[random.Random, Path, range], list[Path]],
    attempt: Callable[[list[Path]], tuple[str, int]], compute: Callable[[Path], str | None] = lambda file: None
) -> int:
    """Try mutants, many a call, and report; those of a call that breaks a rule are tried one by one.

    `write` makes files by their numbers in a folder, `attempt` gives the `complaint` of a run on some of them, and
    `compute` what computing an accepted one breaks, None for one that is not computed.
    """
    rng = random.Random(options.seed)
    refused = failed = computed = 0
    for start in range(0, options.mutants, batch):
        with tempfile.TemporaryDirectory() as folder:
            files = write(rng, Path(folder), range(start, min(start + batch, options.mutants)))
            trouble, count = attempt(files)
            found = [(file, *attempt([file])) for file in files] if trouble else []
            broken = [(file, words) for file, words, _ in found if words]
            if trouble and not broken:
                print(f"only together, from {files[0].name}: {trouble}", flush=True)
            refused += sum(one for _, _, one in found) if trouble else count
            for file in files if not trouble and computed < options.runs else ():
                words = compute(file)
                computed += words is not None
                broken += [(file, words)] if words else []
            for file, words in broken:
                report(file, words, options.keep)
            failed += max(len(broken), bool(trouble))
    print(f"{options.mutants} mutants, seed {options.seed}: {refused} refused, "
          f"{options.mutants - refused - failed} accepted, {failed} failed, {computed} computed")
    return 1 if failed else 0
