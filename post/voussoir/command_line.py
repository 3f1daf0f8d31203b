"""The command `voussoir`: one subcommand a module."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence

#: Subcommand: its module, which has add_arguments(parser) and run(arguments) -> exit status,
#: and one line of help
COMMANDS = {
    "paper": ("voussoir.paper_command", "every table and figure of the paper, and the report"),
    "theory": ("voussoir.theory_command", "the three analytic solutions at given half angles"),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a subcommand.

    Parameters
    ----------
    arguments : sequence of str, optional
        Command line without the program's name; by default that of the process.

    Returns
    -------
    int
        Exit status: 0, or 2 for bad input.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    parser = argparse.ArgumentParser(
        prog="voussoir", description="Masonry arches: theory, tables and figures."
    )
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, (module, summary) in COMMANDS.items():
        subparser = subparsers.add_parser(
            name, help=summary, description=summary[0].upper() + summary[1:] + "."
        )
        if name in words[:1]:
            importlib.import_module(module).add_arguments(subparser)
    chosen = parser.parse_args(words)
    return importlib.import_module(COMMANDS[chosen.command][0]).run(chosen)
