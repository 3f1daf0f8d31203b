"""The Fortran program and its decks: where they are, and running it."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Container, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any


#: Exit status of `dda run` that leaves results: all decided, or a case undecided
LEAVE_RESULTS = (0, 3)


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


def call(
    *words: Any, dda: Path | None = None, accepted: Container[int] | None = (0,), **options: Any
) -> subprocess.CompletedProcess[str]:
    """Run `dda` with one thread of BLAS; DdaError with its message if its exit status is not accepted (None: all are).

    Options are those of `subprocess.run`, which captures the output unless they say otherwise.
    """
    settings = {"capture_output": True, "env": {**os.environ, "OPENBLAS_NUM_THREADS": "1"}, **options}
    command = [str(dda or find_dda()), *map(str, words)]
    done = subprocess.run(command, text=True, errors="surrogateescape", **settings)
    if accepted is not None and done.returncode not in accepted:
        raise DdaError((done.stderr or "").strip() or f"dda {words[0]} ended with status {done.returncode}",
                       done.returncode)
    return done


def version_of(dda: Path) -> str:
    """What `dda --version` prints, such as "dda 0.2.0"."""
    return call("--version", dda=dda).stdout.strip()


@lru_cache(maxsize=4)
def keys_of(dda: Path) -> dict[str, dict[str, Any]]:
    """Groups of all keys, and in each the properties of its keys, as `dda help keys --json` lists them."""
    groups = json.loads(call("help", "keys", "--json", dda=dda).stdout)["groups"]
    return {group["name"]: {key["name"]: key for key in group["keys"]} for group in groups}


def defaults(dda: Path) -> dict[str, str]:
    """Defaults of all keys that have one, by their names with groups."""
    return {f"{group}%{name}": str(key["default"]).strip("'")
            for group, keys in keys_of(dda).items() for name, key in keys.items() if "default" in key}


@dataclass(frozen=True)
class Asked:
    """What a deck asks for, as the program says it."""

    cases: int  #: Number of cases
    record: str  #: Text of deck.record: keys, values, check sums of the files named, build of the program
    headers: dict[str, str]  #: First line of every table that a run writes, by its name


def ask(dda: Path, deck: Path, settings: list[str]) -> Asked:
    """Check a deck; DdaError has the program's own message if it is bad input."""
    done = call("check", path_word(deck), "--record", *set_options(settings), dda=dda)
    plan, _, rest = done.stdout.partition("\ntables:\n")
    tables, _, record = rest.partition("\ndeck.record:\n")
    cases = re.search(r"^ +cases +(\d+)$", plan, flags=re.MULTILINE)
    if not cases:
        raise DdaError("dda check printed no number of cases")
    lines = [line.strip().partition(" ") for line in tables.splitlines()]
    return Asked(int(cases[1]), record, {name: header for name, _, header in lines})


def path_word(path: Path) -> str:
    """A path as a word of a command line that no program takes for an option: "./" before a dash."""
    word = str(path)
    return os.path.join(os.curdir, word) if word.startswith("-") else word


def set_options(settings: Sequence[str]) -> list[str]:
    """Values of --set, such as "arch%radius=5.0", as words of a command line."""
    return [word for setting in settings for word in ("--set", setting)]
