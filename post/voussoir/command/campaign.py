"""`voussoir campaign`: the cases of one deck on many processes or machines."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from pathlib import Path

import numpy as np

from voussoir.campaign.dask import dask_engine
from voussoir.campaign.merge import count_verdicts, merge, owners
from voussoir.campaign.parquet import write_parquet
from voussoir.campaign.share import (
    Campaign, begun, local_engine, open_campaign, parts_of, run_parts, share, unlock,
)
from voussoir.command.options import add_quiet, whole_number
from voussoir.dda_program import DdaError, find_dda
from voussoir.extras import load

#: Of several exit statuses the first one counts
_WORST_FIRST = (4, 2, 3, 0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Computes the cases of one deck by many processes and merges them into DIR/results.csv, joints.csv and "
        "log.txt, sorted by case. The same command continues a stopped campaign."
    )
    parser.add_argument("deck", metavar="DECK", type=Path, help="deck with &sweep groups")
    parser.add_argument("--out", metavar="DIR", type=Path, help="folder of the results (default: the name of the deck)")
    parser.add_argument(
        "--set", metavar="group%key=value", action="append", default=[],
        help="override the deck; repeatable (default: the deck as written)")
    parser.add_argument(
        "--workers", metavar="N", type=whole_number(1), default=os.cpu_count() or 1,
        help="number of processes on this machine (default: one per processor, here %(default)s)")
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="Dask cluster at this address, such as tcp://10.0.0.1:8786; its workers need access to the deck, "
        "DIR and dda (default: processes on this machine)",
    )
    parser.add_argument(
        "--index", metavar="I", type=whole_number(1),
        help="share I of N of the cases, for job arrays; the last share to end merges (default: all cases)")
    parser.add_argument("--of", metavar="N", type=whole_number(1), help="number of shares (default: 1)")
    parser.add_argument("--merge", action="store_true", help="merge the finished cases without computing")
    parser.add_argument("--discard", action="store_true", help="discard the finished cases of an earlier campaign")
    parser.add_argument("--parquet", action="store_true", help="write results.parquet as well; needs pyarrow")
    add_quiet(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the campaign; exit status as of `dda run`."""
    if arguments.parquet:  # before hours are spent
        load("pyarrow", "Parquet")
    index, of = _share_of(arguments)
    out = (arguments.out or Path(arguments.deck.stem)).resolve()
    shared = arguments.index is not None
    try:
        campaign = open_campaign(find_dda(), arguments.deck, arguments.set, out, arguments.discard, shared)
        cases = share(campaign.total, index, of)
        status, message = (0, "") if arguments.merge else _compute(campaign, arguments, cases)
        if message:
            sys.stderr.write(message + "\n")
        return min((status, _finish(campaign, arguments, cases)), key=_WORST_FIRST.index)
    except OSError as error:
        raise DdaError(
            f"{error.filename or out}:1: error: files cannot be written: {error.strerror}; finished cases are kept "
            "in the folder parts", 4) from error
    finally:
        unlock(out)


def _compute(campaign: Campaign, arguments: argparse.Namespace, cases: range) -> tuple[int, str]:
    """Compute what is not finished: worst status, and its message."""
    done, _ = owners([*begun(campaign).values()], campaign.total)
    found = int(np.count_nonzero(done[cases.start:cases.stop] >= 0))
    if found and not arguments.quiet:
        print(f"{arguments.deck}: {found} of {len(cases)} cases are already finished")
    workers, engine = arguments.workers, local_engine(arguments.workers)
    if arguments.scheduler:
        engine, workers = dask_engine(arguments.scheduler)
    parts = parts_of(campaign, cases, workers)
    if any(part.folder == campaign.out for part in parts):  # the program takes the folder itself
        unlock(campaign.out)
    return run_parts(parts, engine, sys.stderr.isatty() and not arguments.quiet)


def _finish(campaign: Campaign, arguments: argparse.Namespace, share_cases: range) -> int:
    """Merge and print, unless other shares are still to come; return 0 if each case has a verdict, else 3."""
    parts = [folder for _, folder in sorted(begun(campaign).items())]
    if arguments.index is not None:
        done = owners(parts, campaign.total)[0] >= 0
        if not done[1:].all():
            if not arguments.quiet:
                left = campaign.total - int(np.count_nonzero(done))
                print(f"{arguments.deck}: this share has ended, {left} cases of other shares remain")
            return 0 if done[share_cases.start:share_cases.stop].all() else 3
    owner = merge(parts, campaign.total, campaign.out, campaign.asked.record, campaign.asked.headers)
    if (owner[1:] >= 0).all() and arguments.index is None:
        shutil.rmtree(campaign.parts, ignore_errors=True)
    verdicts = count_verdicts(campaign.out)
    cases, undecided = sum(verdicts.values()), verdicts["undecided"]
    missing = campaign.total - cases
    if not arguments.quiet:
        print(
            f"{arguments.deck}: {cases - undecided} decided, {undecided} undecided, {missing} not finished; results in "
            f"{campaign.out / 'results.csv'}")
    if arguments.parquet and cases:
        write_parquet(campaign.out / "results.csv")
    return 3 if undecided or missing else 0


def _share_of(arguments: argparse.Namespace) -> tuple[int, int]:
    """Index and number of shares, checked."""
    if (arguments.index is None) != (arguments.of is None):
        raise DdaError("--index:1: error: expected --index and --of, got one of them; give both")
    if arguments.index is None:
        return 1, 1
    if arguments.discard:
        raise DdaError(
            "--discard:1: error: expected no --discard with --index, got both; remove the folder before the shares "
            "start")
    if arguments.index > arguments.of:
        raise DdaError(
            f"--index:1: error: expected an index from 1 to {arguments.of}, got "
            f"{arguments.index}; number the shares from 1")
    return arguments.index, arguments.of
