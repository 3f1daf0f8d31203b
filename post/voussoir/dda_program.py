"""The Fortran program: where it is, and running it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path


class DdaError(Exception):
    """The program refused something: its message, and its exit status in `status`."""

    def __init__(self, message: str, status: int = 2) -> None:
        super().__init__(message)
        self.status = status


def find_dda() -> Path:
    """Find the program `dda`.

    Returns
    -------
    Path
        What the environment variable VOUSSOIR_DDA names (the command `voussoir` of a build or an
        installation sets it), else the `dda` beside the interpreter, else the first on the path.

    Raises
    ------
    DdaError
        If there is none.
    """
    named = os.environ.get("VOUSSOIR_DDA", "")
    beside = shutil.which("dda", path=str(Path(sys.executable).parent))
    found = shutil.which(named) if named else beside or shutil.which("dda")
    if not found:
        wanted = f"VOUSSOIR_DDA names '{named}', which is no program" if named else "none was found"
        raise DdaError(f"wanted the program dda, {wanted}; put it on the path or set VOUSSOIR_DDA")
    return Path(found).resolve()


def version_of(dda: Path) -> str:
    """What `dda --version` prints.

    Parameters
    ----------
    dda : Path
        The program.

    Returns
    -------
    str
        Such as "dda 0.1.0".
    """
    return subprocess.run([dda, "--version"], capture_output=True, text=True).stdout.strip()


def count_cases(dda: Path, deck: Path, settings: list[str]) -> int:
    """Check a deck and count its cases.

    Parameters
    ----------
    dda : Path
        The program.
    deck : Path
        The deck.
    settings : list of str
        Values of --set.

    Returns
    -------
    int
        Number of cases.

    Raises
    ------
    DdaError
        If the deck is bad input: with the program's own message.
    """
    words = [str(dda), "check", str(deck)]
    done = subprocess.run(words + set_options(settings), capture_output=True, text=True)
    cases = re.search(r"^ +cases +(\d+)$", done.stdout, flags=re.MULTILINE)
    if done.returncode != 0 or not cases:
        raise DdaError(done.stderr.strip() or f"dda check ended with status {done.returncode}")
    return int(cases[1])


def set_options(settings: list[str]) -> list[str]:
    """Values of --set as words of a command line.

    Parameters
    ----------
    settings : list of str
        Such as "arch%radius=5.0".

    Returns
    -------
    list of str
        Each with "--set" before it.
    """
    return [word for setting in settings for word in ("--set", setting)]
