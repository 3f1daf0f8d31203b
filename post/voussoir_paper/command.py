"""`voussoir paper`: every table and figure of the paper, and the report."""

from __future__ import annotations

import argparse
import importlib.util
import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from voussoir.command.options import add_decks, add_quiet, whole_number
from voussoir.dda_program import find_dda, find_input
from voussoir.extras import advice
from voussoir.files import write_text
from voussoir_paper import tables
from voussoir_paper.campaign import DRAWING, FIGURES, TOGETHER, Campaign, Clock, Timing, weights


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.add_argument(
        "--out", metavar="DIR", type=Path, default=Path("paper"),
        help="folder for results, tables, figures and index.html (default: paper)")
    parser.add_argument(
        "--jobs", metavar="N", type=whole_number(1), default=os.cpu_count() or 1,
        help="number of decks and figures at the same time (default: one per processor)")
    parser.add_argument("--resume", action="store_true", help="keep the finished decks of an earlier run")
    parser.add_argument(
        "--limerick", action="store_true", help="run the decks of Shi's scheme as well, which takes much longer")
    add_decks(parser)
    parser.add_argument("--dda", metavar="FILE", type=Path, help="the program dda (default: beside `voussoir`)")
    add_quiet(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the decks, draw the figures, write tables and report; the exit status is that of dda."""
    campaign = Campaign(arguments.decks or find_input("paper"), arguments.out)
    dda = find_dda(arguments.dda)
    decks = campaign.deck_files(arguments.limerick)
    parts = [DRAWING + name for name in _drawings()]
    return _make(campaign, arguments, dda, Clock(_teller(arguments), weights(decks, parts)))


def _teller(arguments: argparse.Namespace) -> Callable[[str], None]:
    """Receiver of progress reports."""
    if arguments.quiet:
        return lambda line: None
    return lambda line: print(line, file=sys.stderr, flush=True)


def _make(campaign: Campaign, arguments: argparse.Namespace, dda: Path, clock: Clock) -> int:
    """The whole campaign."""
    arguments.out.mkdir(parents=True, exist_ok=True)
    status = campaign.run(dda, clock, arguments.jobs, slow=arguments.limerick, resume=arguments.resume)
    clock.timings.append(Timing(TOGETHER, clock.elapsed, sum(t.computing for t in clock.timings)))
    if status in (2, 4) or status not in (0, 3):
        return status
    folder = arguments.out
    _draw(campaign, folder / "figures", clock, arguments.jobs)
    start = time.monotonic()
    tables.write_tables(list(campaign.tables.values()), folder / "tables")
    from voussoir_paper import report

    page = report.build(campaign, folder / "figures", clock.timings, dda)
    took = f"{time.monotonic() - start:.2f}"
    index = folder / "index.html"
    write_text(index, page.replace(report.PAGE_TIME, took))
    if not arguments.quiet:
        for table in campaign.tables.values():
            print(f"\n{table.title}\n{tables.as_text(table)}")
        print(f"\nTables as CSV and Markdown: {folder / 'tables'}")
        print(f"Report: {index.resolve().as_uri()} (open it in a browser)")
    return status


def _drawings() -> list[str]:
    """Names of what is drawn; none without matplotlib."""
    if not importlib.util.find_spec("matplotlib"):
        return []
    from voussoir_paper import figures

    return figures.names()


def _draw(campaign: Campaign, folder: Path, clock: Clock, jobs: int) -> None:
    """Draw all figures and animations, so many at the same time."""
    names = _drawings()
    if not names:
        clock.report(f"figures are left out: matplotlib is missing; {advice('matplotlib')}")
        return
    start = time.monotonic()
    plain = Campaign(campaign.decks, campaign.out)
    # A forked process would wait forever for threads of BLAS that it has not got
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, len(names)), mp_context=fresh) as workers:
        running = {workers.submit(_draw_one, plain, folder, name): name for name in names}
        for done in as_completed(running):
            seconds = done.result()
            clock.record(Timing(DRAWING + running[done], seconds, 0.0))
    drawn = [timing for timing in clock.timings if timing.part.startswith(DRAWING)]
    clock.timings[:] = [timing for timing in clock.timings if timing not in drawn]
    clock.timings.append(Timing(FIGURES, time.monotonic() - start, 0.0))


def _draw_one(campaign: Campaign, folder: Path, name: str) -> float:
    """Draw one figure in a process of its own; gives its time [s]."""
    from voussoir_paper import figures

    start = time.monotonic()
    figures.make(campaign, folder, name)
    return time.monotonic() - start
