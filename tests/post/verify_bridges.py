"""Random bridges of all keys, and whether `voussoir verify` accepts the folders that the program leaves.

    PYTHONPATH=build/python python3 tests/post/verify_bridges.py --dda build/bin/dda --count 300 --seed 1

Decks whose keys exclude one another are refused by the program, and others are drawn. Folders that are not accepted
are kept. With `--assemblies` the folders are those of random assemblies of blocks, with corners off by `--off` metres.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))

from live_assemblies import random_assembly  # noqa: E402
from random_bridges import MOST_SECONDS, limit_time, random_study  # noqa: E402

from voussoir.command.main import main as voussoir_main  # noqa: E402


def misplaced(blocks: str, off: float, seed: int) -> str:
    """A file of blocks whose corners are off by so much at most."""
    pick, lines = random.Random(f"corners {seed}"), []
    for line in blocks.splitlines():
        words = line.split()
        if len(words) == 2 and words[0] != "block":
            line = " ".join(repr(float(word) + pick.uniform(-off, off)) for word in words)
        lines.append(line)
    return "\n".join(lines) + "\n"


def write_assembly(folder: Path, off: float, seed: int) -> None:
    """Blocks of a seed, and the deck of a search of either flow rule."""
    blocks, friction = random_assembly(seed)
    flow = random.Random(seed).choice(("coulomb", "associated"))
    (folder / "x.blocks").write_text(misplaced(blocks, off, seed))
    (folder / "x.nml").write_text(
        f"&scene kind = 'blocks', geometry = 'x.blocks' /\n&joint friction_deg = {friction!r} /\n"
        f"&analysis flow = '{flow}' /\n&search parameter = 'load_factor' /\n")


def check(folder: Path, dda: str) -> str:
    """Verdict of verify on the folder of a deck; empty if accepted, 'refused' if the program refuses the deck."""
    done = subprocess.run([dda, "run", "x.nml", "--quiet"], cwd=folder, capture_output=True, text=True,
                          preexec_fn=limit_time)
    if done.returncode == 2:
        return "refused"
    if done.returncode == -signal.SIGXCPU:
        return f"dda takes more than {MOST_SECONDS} s of processor time"
    if done.returncode not in (0, 3):
        return f"dda ended with status {done.returncode}: {done.stderr}"
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        status = voussoir_main(["verify", str(folder / "x"), "--quiet"])
    return "" if status == 0 else f"status {status}: {said.getvalue()[:400]}"


def main() -> int:
    """Check folders until so many were made."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dda", required=True, type=os.path.abspath)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--assemblies", action="store_true", help="assemblies of blocks instead of bridges")
    parser.add_argument("--off", type=float, default=0.0, help="how far corners of assemblies are off [m]")
    arguments = parser.parse_args()
    seed, made, failed = arguments.seed, 0, 0
    while made < arguments.count:
        folder = Path(tempfile.mkdtemp(prefix=f"verify_{seed}_"))
        if arguments.assemblies:
            write_assembly(folder, arguments.off, seed)
        else:
            (folder / "x.nml").write_text(random_study(seed))
        said = check(folder, arguments.dda)
        made += said != "refused"
        if said in ("", "refused"):
            shutil.rmtree(folder)
        else:
            failed += 1
            print(f"seed {seed}, {folder}: {said}", flush=True)
        seed += 1
    print(f"{made - failed} of {made} folders accepted, seeds {arguments.seed} to {seed - 1}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
