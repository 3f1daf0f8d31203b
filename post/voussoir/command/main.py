"""The command `voussoir`: one subcommand a module."""

from __future__ import annotations

import argparse
import importlib
import os
import re
import sys
from collections.abc import Sequence

from voussoir import __version__
from voussoir.dda_program import DdaError
from voussoir.extras import MissingPackage, advice

#: Subcommand: its module, which has add_arguments(parser) and run(arguments) -> exit status, and one line of help
COMMANDS = {
    "animate": ("voussoir.command.animate", "the motion of cases as a GIF"),
    "assess": ("voussoir.command.assess", "one page for a client: does the arch stand, and how safely"),
    "campaign": ("voussoir.command.campaign", "the cases of one deck on many processes or machines"),
    "lines": ("voussoir.command.lines", "a picture of what dda lines has drawn"),
    "examples": ("voussoir.command.examples", "the decks that came with the program"),
    "export": ("voussoir.command.export_file", "the blocks of a case as a drawing, GeoJSON, WKT or a mesh"),
    "import": ("voussoir.command.import_file", "a drawing, GeoJSON, WKT or a mesh as a deck of blocks"),
    "paper": ("voussoir.command.paper", "every table and figure of the paper, and the report"),
    "plot": ("voussoir.command.plot", "pictures and charts of a folder of results"),
    "theory": ("voussoir.command.theory", "the three analytic solutions at given half angles"),
    "work-precision": ("voussoir.command.work_precision", "error against run time"),
    "view": ("voussoir.command.view", "the blocks of a case in a window that turns"),
    "verify": ("voussoir.verify.command", "the proofs of a folder of results, recomputed"),
    "stability": ("voussoir.command.stability", "stiff and extreme scenes, judged by exact answers"),
    "study": ("voussoir.command.study", "a deck with one key halved again and again: order of convergence"),
    "traffic": ("voussoir.command.traffic", "vehicles of a list on an arch: load factors and worst positions"),
    "validation": ("voussoir.command.validation", "scenes with exact answers beside what the program computes"),
}


EXIT_STATUS = (
    "Exit status: 0 done; 1 a value of validation or stability is wrong; 2 bad input; 4 a result could not be written."
)


class Formatter(argparse.RawDescriptionHelpFormatter):
    """Help that shows every default, unless the text says what holds without the option."""

    def _get_help_string(self, action: argparse.Action) -> str:
        text = action.help or ""
        silent = isinstance(action, (argparse._HelpAction, argparse._VersionAction))
        if not action.option_strings or action.required or silent or "default" in text:
            return text
        return text + (" (default: no)" if action.default is False else " (default: %(default)s)")


def build_parser(chosen: str | None = None) -> argparse.ArgumentParser:
    """The parser of the command line, with the options of the chosen subcommand; other modules are not loaded."""
    parser = argparse.ArgumentParser(
        prog="voussoir", description="Masonry arches: theory, tables and figures.",
        epilog="'voussoir help COMMAND' lists the options of one. " + EXIT_STATUS)
    parser.add_argument("--version", action="version", version=f"voussoir {__version__}")
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, (module, summary) in COMMANDS.items():
        subparser = subparsers.add_parser(
            name, help=summary, description=summary[0].upper() + summary[1:] + ".", epilog=EXIT_STATUS,
            formatter_class=Formatter)
        if name == chosen:
            importlib.import_module(module).add_arguments(subparser)
    subparsers.add_parser("help", help="this page, or the options of a subcommand")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a subcommand, by default that of the process: its exit status, see `EXIT_STATUS`."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    if words[:1] in ([], ["help"]):
        words = [*words[1:2], "--help"] if words[1:2] != ["help"] else ["--help"]
    os.environ["MPLBACKEND"] = "Agg"  # pictures are files: no display is wanted
    for word in words:
        if any("\ud800" <= letter <= "\udfff" for letter in word):  # what Python makes of other bytes
            sys.stderr.write(f"voussoir: error: expected text in UTF-8, got {word!a}; rename the file or folder\n")
            return 2
    chosen = build_parser(words[0] if words else None).parse_args(words)
    try:
        return int(importlib.import_module(COMMANDS[chosen.command][0]).run(chosen))
    except BrokenPipeError:  # who reads the output, such as head, has enough of it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (DdaError, ImportError, KeyError, OSError, ValueError) as problem:
        return fail(problem, chosen)


def fail(problem: Exception, chosen: argparse.Namespace) -> int:
    """Say why a subcommand has failed: FILE:LINE, that of what it reads where nothing better is known; its status."""
    inputs = (getattr(chosen, name, None) for name in ("folder", "table", "deck", "file"))
    place, status = next(filter(None, inputs), None), getattr(problem, "status", 2)
    if place is None and isinstance(problem, (KeyError, ValueError)):
        raise problem  # of nothing that was read: a fault of ours
    words = str(problem.args[0] if isinstance(problem, KeyError) else problem)
    if isinstance(problem, ImportError) and not isinstance(problem, MissingPackage):
        package = (problem.name or "matplotlib").partition(".")[0]
        if package == "voussoir":
            raise problem
        place, words = None, f"expected {package}, got none ({problem}); {advice(package)}"
    elif isinstance(problem, OSError) and not isinstance(problem, FileNotFoundError) and problem.filename != str(place):
        place, status = problem.filename or getattr(chosen, "out", None) or place, 4
        words = f"the file cannot be written: {problem.strerror}; choose another with --out"
    told = re.search(r":\d+: error: ", words)  # the program's own messages name file and line
    bare = place is None or isinstance(problem, DdaError)
    head = "" if told else "voussoir: error: " if bare else f"{place}:1: error: "
    sys.stderr.write(f"{head}{words}\n")
    return status
