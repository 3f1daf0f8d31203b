"""A deck run from Python: `voussoir.run`, and decks made of Python values."""

from __future__ import annotations

import re
import shutil
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

from voussoir import results
from voussoir.dda_program import LEAVE_RESULTS, call, find_dda, path_word, set_options
from voussoir.deck.text import Groups, checked, deck_text, groups_of, merged, value_text
from voussoir.files import write_text

#: What the text of a deck has and the name of a file has not
_GROUP = re.compile(r"^\s*&\w+", re.MULTILINE)


@dataclass
class Deck:
    """A deck made of Python values, and the files beside it."""

    groups: dict[str, Any] = field(default_factory=dict)  #: Keys and values by group, as in a deck
    files: dict[str, str] = field(default_factory=dict)  #: Texts of the files that the deck names, by their names

    def text(self) -> str:
        """The deck as text."""
        return deck_text(self.groups)

    def write(self, file: Union[str, Path]) -> Path:
        """Write the deck, whose folder is made if missing, and its files beside it."""
        file = Path(file)
        file.parent.mkdir(parents=True, exist_ok=True)
        for name, text in self.files.items():
            if not isinstance(name, str) or not isinstance(text, str):
                raise ValueError(f"expected files of a deck as texts by their names, got {name!r}: {text!r}")
            write_text(file.parent / name, text)
        write_text(file, self.text())
        return file

    def run(self, out: Union[str, Path, None] = None, jobs: int = 1, **set: Any) -> results.Results:
        """Run it: see `voussoir.run`."""
        return run(self, out, jobs, **set)


class Arch(Deck):
    """An arch, by the keys of a deck.

    Parameters
    ----------
    **keys
        Keys of &arch and of any other group, with the names and defaults of decks:
        Arch(half_angle_deg=75, voussoirs=21, friction_deg=35).

    Raises
    ------
    ValueError
        If no group has such a key, or several do.

    Examples
    --------
    >>> run = Arch(voussoirs=12).run(search="thickness_ratio")
    >>> round(float(run.cases["critical"][0]), 6)
    0.104857
    """

    def __init__(self, **keys: Any) -> None:
        groups = groups_of(find_dda(), keys)
        super().__init__({"arch": groups.pop("arch", {}), **groups})


#: What `run` takes: a file, the text of a deck, its groups, or a Deck
Runnable = Union[str, Path, Groups, Deck]


def run(deck: Runnable, out: Union[str, Path, None] = None, jobs: int = 1, **set: Any) -> results.Results:
    """Run a deck and read its results.

    Parameters
    ----------
    deck : str, Path, mapping or Deck
        A file or the text of a deck; its groups, such as {"arch": {"voussoirs": 36},
        "search": {"parameter": "thickness_ratio"}}; or an Arch or Blocks.
    out : str or Path, optional
        Folder of the results; without it the folder is removed with the returned object. A deck
        that is no file is also written there, as deck.nml.
    jobs : int, optional
        Cases computed at the same time.
    **set
        Keys as in decks, by their names (friction_deg=40), with the group where several have one (**{"arch%radius":
        5.0}), or whole groups: search={"parameter": "friction_deg"}, or search="friction_deg" for short. sweep is a
        dict or a list of dicts, for a deck that is no file.

    Returns
    -------
    Results
        The results as `voussoir.results.read` returns them. A case may be undecided.

    Raises
    ------
    DdaError
        If the program refuses the deck: its message, with file and line.
    ValueError
        If a key is not known, the deck is neither a file nor text, or an argument is of another kind.
    TypeError
        If a value is no number, flag or text, and no list of them.
    """
    if out is not None and not isinstance(out, (str, Path)):
        raise ValueError(f"expected out as the name of a folder, got {out!r}")
    if not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1:
        raise ValueError(f"expected jobs as a whole number, 1 or more, got {jobs!r}")
    dda = find_dda()
    changes = groups_of(dda, set)
    place = Path(tempfile.mkdtemp(prefix="voussoir-")) if out is None else Path(out)
    try:
        file, settings = _as_file(deck, place, changes)
        call("run", path_word(file), "--out", path_word(place), "--quiet", "--jobs", jobs, *set_options(settings),
             dda=dda, accepted=LEAVE_RESULTS)
        found = results.read(place)
    except BaseException:
        if out is None:
            shutil.rmtree(place, ignore_errors=True)
        raise
    if out is None:
        weakref.finalize(found, shutil.rmtree, place, ignore_errors=True)
    return found


def _as_file(deck: Runnable, place: Path, changes: Groups) -> tuple[Path, list[str]]:
    """The deck's file, and what is left to set."""
    if isinstance(deck, Mapping):
        deck = Deck(dict(checked(deck)))
    if isinstance(deck, Deck):
        return Deck(merged(deck.groups, changes), deck.files).write(place / "deck.nml"), []
    if isinstance(deck, str) and _GROUP.search(deck):
        sweeps = {name: keys for name, keys in changes.items() if name == "sweep"}
        place.mkdir(parents=True, exist_ok=True)
        file = place / "deck.nml"
        write_text(file, deck + "\n" + deck_text(sweeps))
        return file, settings_of({name: changes[name] for name in changes if name != "sweep"})
    if not isinstance(deck, (str, Path)):
        raise ValueError(f"expected a deck's file, text or groups, got {deck!r}")
    if "sweep" in changes:
        raise ValueError(f"expected &sweep in {deck}, got it as an argument; sweep a dict or a text")
    return Path(deck), settings_of(changes)


def settings_of(changes: Groups) -> list[str]:
    """Values of --set."""
    given = []
    for group, keys in changes.items():
        if group == "search" and not keys:  # nothing of a search is set: its first key starts one
            keys = {"parameter": "thickness_ratio"}
        given += [f"{group}%{key}={value_text(value, f'{group}%{key}')}" for key, value in dict(keys).items()]
    return given
