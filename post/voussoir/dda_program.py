"""The Fortran program and its decks: where they are, and running it."""

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


def find_dda(named: Path | None = None) -> Path:
    """Find the program `dda`.

    Parameters
    ----------
    named : Path, optional
        The program that a user has named; no other one will do then.

    Returns
    -------
    Path
        The one named, else what the environment variable VOUSSOIR_DDA names (the command `voussoir`
        of a build or an installation sets it), else the `dda` of the build that this package
        belongs to, else the one beside the interpreter, else the first on the path.

    Raises
    ------
    DdaError
        If there is none.
    """
    wish = str(named or os.environ.get("VOUSSOIR_DDA", ""))
    build = Path(__file__).absolute().parents[2] / "bin"
    places = [str(build), str(Path(sys.executable).parent), None]
    found = [shutil.which(wish)] if wish else [shutil.which("dda", path=path) for path in places]
    if not any(found):
        wanted = f"'{wish}' is no program" if wish else "none was found"
        raise DdaError(
            f"wanted the program dda, {wanted}; put it on the path, or name it with VOUSSOIR_DDA"
        )
    return Path(next(filter(None, found))).resolve()


def find_input(name: str) -> Path:
    """Find a folder of decks that belongs to this package.

    Parameters
    ----------
    name : str
        Its name: "paper" or "benchmarks".

    Returns
    -------
    Path
        The folder in the package (`pip install`), in the prefix (`cmake --install`), or in the
        source (a build's package is made of links to it).

    Raises
    ------
    DdaError
        If it is in none of these.
    """
    here = Path(__file__)
    roots = [here.absolute().parent, *(up / "share/voussoir" for up in here.absolute().parents)]
    for root in [*roots, here.resolve().parents[2]]:
        if (root / "input" / name).is_dir():
            return root / "input" / name
    raise DdaError(f"wanted the decks input/{name}, found none; name their folder with --decks")


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
