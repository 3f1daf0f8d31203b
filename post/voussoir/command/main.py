"""The command `voussoir`: one module per subcommand."""

from __future__ import annotations

import argparse
import importlib.util
import os
import re
import sys
from collections.abc import Sequence

from voussoir import __version__
from voussoir.dda_program import DdaError
from voussoir.extras import MissingPackage, advice

#: Subcommand: its module, which has add_arguments(parser) and run(arguments) -> exit status, and one line of help
COMMANDS = {
    "animate": ("voussoir.command.animate", "animation of the motion of cases"),
    "assess": ("voussoir.command.assess", "assessment of an arch on one page: verdict and safety factors"),
    "campaign": ("voussoir.command.campaign", "cases of one deck by many processes or machines"),
    "lines": ("voussoir.command.lines", "picture of the lines of dda lines"),
    "examples": ("voussoir.command.examples", "decks of the package"),
    "export": ("voussoir.command.export_file", "blocks of a case as a drawing, GeoJSON, WKT or a mesh"),
    "import": ("voussoir.command.import_file", "deck of blocks from a drawing, GeoJSON, WKT or a mesh"),
    "plot": ("voussoir.command.plot", "pictures and charts of a folder of results"),
    "theory": ("voussoir.command.theory", "three analytic solutions at given half angles"),
    "view": ("voussoir.command.view", "blocks of a case in a window"),
    "verify": ("voussoir.verify.command", "check of the proofs in a folder of results"),
    "study": ("voussoir.command.study", "order of convergence of a deck as one key is halved"),
    "traffic": ("voussoir.command.traffic", "load factors and worst positions of vehicles on an arch"),
}
#: Subcommands of a build of the source. Their packages are not installed: they test the program and repeat the paper
SOURCE_COMMANDS = {
    "paper": ("voussoir_paper.command", "tables and figures of the paper, and a report"),
    "stability": ("voussoir_benches.stability", "stiff and extreme scenes with exact answers"),
    "validation": ("voussoir_benches.validation", "verification: results beside exact answers"),
    "work-precision": ("voussoir_benches.work_precision", "error against run time"),
}
#: Verbs of dda that voussoir does not have
DDA_VERBS = ("run", "check", "cut")

EXIT_STATUS = (
    "Exit status: 0 done; 1 a check of verify, validation or stability fails; 2 bad input; 3 a case is undecided; "
    "4 a result could not be written."
)


class Formatter(argparse.HelpFormatter):
    """Help that shows every default, unless the text has it."""

    def _get_help_string(self, action: argparse.Action) -> str:
        text = action.help or ""
        silent = isinstance(action, (argparse._HelpAction, argparse._VersionAction))
        if not action.option_strings or action.required or silent or "default" in text:
            return text
        if action.default in (None, [], ()):
            return text + " (default: none)"
        return text + (" (default: no)" if action.default is False else " (default: %(default)s)")


def build_parser(chosen: str | None = None) -> argparse.ArgumentParser:
    """The parser of the command line, with the options of the chosen subcommand; other modules are not loaded."""
    parser = argparse.ArgumentParser(
        prog="voussoir", description="Pictures, proofs, studies and drawings for results of dda.",
        epilog="'voussoir help COMMAND' lists its options. Decks are computed by 'dda run DECK': see 'dda help'. "
        f"A build of the source has more commands: {', '.join(SOURCE_COMMANDS)}. {EXIT_STATUS}")
    parser.add_argument("--version", action="version", version=f"voussoir {__version__}")
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    named = {**COMMANDS, **{name: home for name, home in SOURCE_COMMANDS.items() if name == chosen}}
    for name, (module, summary) in named.items():
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
    if words[0] in DDA_VERBS:
        sys.stderr.write(f"voussoir: error: expected a command of voussoir, got '{words[0]}', which dda has; write "
                         f"'dda {words[0]}'\n")
        return 2
    module, _ = {**COMMANDS, **SOURCE_COMMANDS}.get(words[0], ("", ""))
    if words[0] in SOURCE_COMMANDS and not importlib.util.find_spec(module.partition(".")[0]):
        sys.stderr.write(f"voussoir: error: expected an installed command, got '{words[0]}', which a build of the "
                         f"source has; write 'build/bin/voussoir {words[0]}' there\n")
        return 2
    chosen = build_parser(words[0]).parse_args(words)
    try:
        return int(importlib.import_module(module).run(chosen))
    except BrokenPipeError:  # who reads the output, such as head, has enough of it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (DdaError, ImportError, KeyError, OSError, ValueError) as problem:
        return fail(problem, chosen)


def fail(problem: Exception, chosen: argparse.Namespace) -> int:
    """Print why a subcommand has failed, with FILE:LINE or else the name of its input; return its status."""
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
    placed = re.search(r":\d+: error: ", words)  # the program's own messages name file and line
    bare = place is None or isinstance(problem, DdaError)
    head = "" if placed else "voussoir: error: " if bare else f"{place}:1: error: "
    sys.stderr.write(f"{head}{words}\n")
    return status
