"""The Fortran program and its decks: where they are, and running it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


class DdaError(Exception):
    """The program refused something: its message, and its exit status in `status`."""

    def __init__(self, message: str, status: int = 2) -> None:
        super().__init__(message)
        self.status = status


def find_dda(named: Path | None = None) -> Path:
    """Find the program `dda`; DdaError if there is none.

    The one named, else what the environment variable VOUSSOIR_DDA names (the command `voussoir` of a build or an
    installation sets it), else the `dda` of the build that this package belongs to, else the one beside the
    interpreter, else the first on the path.
    """
    wish = str(named or os.environ.get("VOUSSOIR_DDA", ""))
    build = Path(__file__).absolute().parents[2] / "bin"
    places = [str(build), str(Path(sys.executable).parent), None]
    found = [shutil.which(wish)] if wish else [shutil.which("dda", path=path) for path in places]
    if not any(found):
        wanted = f"got '{wish}', which is no program" if wish else "got none"
        raise DdaError(f"expected the program dda, {wanted}; put it on the path, or name it with VOUSSOIR_DDA")
    return Path(next(filter(None, found))).resolve()


def find_input(name: str) -> Path:
    """Find a folder of decks that belongs to this package; DdaError if there is none.

    It is in the package (`pip install`), in the prefix (`cmake --install`), or in the source (a build's package is made
    of links to it).
    """
    here = Path(__file__)
    roots = [here.absolute().parent, *(up / "share/voussoir" for up in here.absolute().parents)]
    for root in [*roots, here.resolve().parents[2]]:
        if (root / "input" / name).is_dir():
            return root / "input" / name
    raise DdaError(f"expected the decks input/{name}, got none; name their folder with --decks")


def version_of(dda: Path) -> str:
    """What `dda --version` prints, such as "dda 0.2.0"."""
    return subprocess.run([dda, "--version"], capture_output=True, text=True).stdout.strip()


@dataclass(frozen=True)
class Asked:
    """What a deck asks for, as the program says it."""

    #: Number of cases
    cases: int
    #: Text of deck.record: keys, values, check sums of the files named, build of the program
    record: str
    #: First line of every table that a run writes, by its name
    headers: dict[str, str]


def ask(dda: Path, deck: Path, settings: list[str]) -> Asked:
    """Check a deck; DdaError has the program's own message if it is bad input."""
    words = [str(dda), "check", path_word(deck), "--record", *set_options(settings)]
    done = subprocess.run(words, capture_output=True, text=True, errors="surrogateescape")
    plan, _, rest = done.stdout.partition("\ntables:\n")
    tables, _, record = rest.partition("\ndeck.record:\n")
    cases = re.search(r"^ +cases +(\d+)$", plan, flags=re.MULTILINE)
    if done.returncode != 0 or not cases:
        raise DdaError(done.stderr.strip() or f"dda check ended with status {done.returncode}")
    lines = [line.strip().partition(" ") for line in tables.splitlines()]
    return Asked(int(cases[1]), record, {name: header for name, _, header in lines})


def path_word(path: Path) -> str:
    """A path as a word of a command line that no program takes for an option: "./" before a dash."""
    word = str(path)
    return os.path.join(os.curdir, word) if word.startswith("-") else word


def set_options(settings: Sequence[str]) -> list[str]:
    """Values of --set, such as "arch%radius=5.0", as words of a command line."""
    return [word for setting in settings for word in ("--set", setting)]
