#!/usr/bin/env python3
"""Manual pages from the help of the programs: make_man.py DDA OUT [PACKAGE].

Writes OUT/dda.1 and, where the folder PACKAGE of the Python package is named, OUT/voussoir.1. So a
page is never behind the program.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

#: Topics of `dda help` in the order of the page
TOPICS = ("run", "check", "cut", "lines", "export", "keys", "blocks", "models")
#: Titles of topics that are no commands
TITLES = {"keys": "KEYS OF A DECK", "blocks": "FILES OF BLOCKS", "models": "MODELS"}


def roff(text: str) -> str:
    """Text as it stands, in roff.

    Parameters
    ----------
    text : str
        Lines.

    Returns
    -------
    str
        The same, unfilled.
    """
    lines = text.rstrip("\n").replace("\\", "\\e").replace("-", "\\-").split("\n")
    return "\n".join([".nf", *("\\&" + line if line[:1] in (".", "'") else line for line in lines), ".fi"])


def page(name: str, version: str, summary: str, parts: list[tuple[str, str]], other: str) -> str:
    """A manual page.

    Parameters
    ----------
    name : str
        Name of the program.
    version : str
        Its version.
    summary : str
        What it is, in a line.
    parts : list of tuple
        Titles and texts of its sections; a title in small letters is one of the commands.
    other : str
        Name of the program to see as well.

    Returns
    -------
    str
        The page in roff.
    """
    lines = [f'.TH {name.upper()} 1 "" "voussoir {version}" "User Commands"', ".SH NAME", f"{name} \\- {summary}"]
    for title, text in parts:
        lines += [f".SS {name} {title}" if title.islower() else f".SH {title}", roff(text)]
    return "\n".join([*lines, ".SH SEE ALSO", f".BR {other} (1)", ""])


def of_dda(dda: str) -> str:
    """The page of dda.

    Parameters
    ----------
    dda : str
        The program.

    Returns
    -------
    str
        The page.
    """
    def printed(*words: str) -> str:
        return subprocess.run([dda, *words], capture_output=True, text=True, check=True).stdout

    first, _, rest = printed("help").partition("\n")
    parts = [("DESCRIPTION", rest.strip("\n")), ("COMMANDS", "")]
    parts += [(TITLES.get(topic, topic), printed("help", topic)) for topic in TOPICS]
    return page("dda", printed("--version").split()[1], first.partition(": ")[2], parts, "voussoir")


def of_voussoir(package: str) -> str:
    """The page of voussoir.

    Parameters
    ----------
    package : str
        Folder that holds the Python package.

    Returns
    -------
    str
        The page.
    """
    os.environ["COLUMNS"] = "90"
    sys.path.insert(0, package)
    sys.dont_write_bytecode = True
    from voussoir import __version__
    from voussoir.command.main import COMMANDS, build_parser

    parts = [("DESCRIPTION", build_parser().format_help()), ("COMMANDS", "")]
    for name in COMMANDS:
        choices = build_parser(name)._subparsers._group_actions[0].choices
        parts.append((name, choices[name].format_help()))
    summary = "tables, figures, campaigns and checks of masonry arches by dda"
    return page("voussoir", __version__, summary, parts, "dda")


def main() -> int:
    """Write the pages."""
    dda, out, *package = sys.argv[1:]
    Path(out).mkdir(parents=True, exist_ok=True)
    (Path(out) / "dda.1").write_text(of_dda(dda), encoding="utf-8")
    for folder in package:
        (Path(out) / "voussoir.1").write_text(of_voussoir(folder), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
