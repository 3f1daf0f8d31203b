"""`voussoir paper`: every table and figure of the paper, and the report."""

from __future__ import annotations

import argparse
import importlib.util
import os
import sys
import time
from pathlib import Path

from voussoir import paper_tables
from voussoir.dda_program import DdaError, find_dda, find_input
from voussoir.paper_campaign import TOGETHER, Campaign, Clock, Timing, weights

_PARTS = ["figures", "animations"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the subcommand.
    """
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        default=Path("paper"),
        help="folder for results, tables, figures and index.html (default: paper)",
    )
    parser.add_argument(
        "--jobs",
        metavar="N",
        type=_at_least_one,
        default=os.cpu_count() or 1,
        help="decks computed at the same time (default: one a processor)",
    )
    parser.add_argument(
        "--resume", action="store_true", help="keep what an earlier run has finished"
    )
    parser.add_argument(
        "--limerick",
        action="store_true",
        help="also run the decks of the original program's scheme, which take much longer",
    )
    parser.add_argument(
        "--decks",
        metavar="DIR",
        type=Path,
        help="folder of the decks (default: those that came with the program)",
    )
    parser.add_argument(
        "--dda", metavar="FILE", type=Path, help="the program dda (default: the one beside `voussoir`)"
    )
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def _at_least_one(word: str) -> int:
    number = int(word)
    if number < 1:
        raise argparse.ArgumentTypeError(f"a number from 1 is wanted, {word} was found")
    return number


def run(arguments: argparse.Namespace) -> int:
    """Run the decks, draw the figures, write tables and report.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed options.

    Returns
    -------
    int
        Exit status: that of dda, or 2 if it or the decks are missing, 4 if nothing can be written.
    """
    try:
        campaign = Campaign(arguments.decks or find_input("paper"), arguments.out)
        dda = find_dda(arguments.dda)
        decks = campaign.deck_files(arguments.limerick)
    except (DdaError, FileNotFoundError) as problem:
        print(f"voussoir: error: {problem}", file=sys.stderr)
        return 2
    try:
        return _make(campaign, arguments, dda, Clock(_teller(arguments), weights(decks, _PARTS)))
    except OSError as problem:
        print(f"voussoir: error: {problem}", file=sys.stderr)
        return 4


def _teller(arguments: argparse.Namespace):
    """What progress is told to."""
    if arguments.quiet:
        return lambda line: None
    return lambda line: print(line, file=sys.stderr, flush=True)


def _make(campaign: Campaign, arguments: argparse.Namespace, dda: Path, clock: Clock) -> int:
    """The whole campaign."""
    arguments.out.mkdir(parents=True, exist_ok=True)
    status = campaign.run(
        dda, clock, arguments.jobs, slow=arguments.limerick, resume=arguments.resume
    )
    clock.timings.append(Timing(TOGETHER, clock.elapsed, sum(t.computing for t in clock.timings)))
    if status in (2, 4) or status not in (0, 3):
        return status
    folder = arguments.out
    if importlib.util.find_spec("matplotlib"):
        from voussoir import paper_figures

        with clock.part("figures"):
            paper_figures.draw_all(campaign, folder / "figures")
        with clock.part("animations"):
            paper_figures.animate_all(campaign, folder / "figures")
    else:
        clock.tell("figures are left out: matplotlib was not found")
    start = time.monotonic()
    paper_tables.write_tables(list(campaign.tables.values()), folder / "tables")
    from voussoir import paper_report

    page = paper_report.build(campaign, folder / "figures", clock.timings, dda)
    took = f"{time.monotonic() - start:.2f}"
    report = folder / "index.html"
    report.write_text(page.replace(paper_report.PAGE_TIME, took), encoding="utf-8")
    if not arguments.quiet:
        for table in campaign.tables.values():
            print(f"\n{table.title}\n{paper_tables.as_text(table)}")
        print(f"\nReport: {report}\nTables as CSV and Markdown: {folder / 'tables'}")
    return status
