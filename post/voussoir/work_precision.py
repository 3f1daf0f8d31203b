"""`voussoir work-precision`: error against run time, all in one run on one machine."""

from __future__ import annotations

import argparse
import platform
import sys
from pathlib import Path

from voussoir import limit_lp
from voussoir.dda_program import DdaError, find_dda
from voussoir.work_precision_page import best_table, draw, race_table, write_csv
from voussoir.work_precision_runs import Arch, Point, Race, bisected, dda_points, race


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the subcommand.
    """
    parser.add_argument(
        "--out", type=Path, default=Path("work_precision"), help="folder of tables and figure"
    )
    parser.add_argument(
        "--angles",
        type=float,
        nargs="+",
        default=[45.0, 90.0, 140.0],
        metavar="DEG",
        help="half angles of embrace, in degrees",
    )
    parser.add_argument(
        "--voussoirs",
        type=int,
        nargs="+",
        default=[36, 1000],
        metavar="N",
        help="numbers of voussoirs, even ones",
    )
    parser.add_argument("--repeats", type=int, default=5, help="runs of each setting")
    parser.add_argument(
        "--race", action="store_true", help="only the times of one decision, no diagram"
    )


def run(arguments: argparse.Namespace) -> int:
    """Measure, write tables and figure, print the table of ratios.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed options.

    Returns
    -------
    int
        Exit status: 2 without the program, else 0.
    """
    try:
        find_dda()
    except DdaError as missing:
        sys.stderr.write(f"voussoir: error: {missing}\n")
        return missing.status
    arches = [Arch(angle, count) for count in arguments.voussoirs for angle in arguments.angles]
    arguments.out.mkdir(parents=True, exist_ok=True)
    runs = arguments.out / "runs"
    races = [race(arch, runs, arguments.repeats) for arch in arches]
    points: list[Point] = []
    if not arguments.race:
        points = [point for arch in arches for point in _points(arch, runs, arguments.repeats)]
        write_csv(points, arguments.out / "work_precision.csv")
        draw(points, arguments.out)
    text = "\n".join(_report(races, points)) + "\n"
    (arguments.out / "work_precision.md").write_text(text, encoding="utf-8")
    sys.stdout.write(text)
    return 0


def _points(arch: Arch, runs: Path, repeats: int) -> list[Point]:
    """All points of one arch."""
    points = list(dda_points(arch, runs, repeats))
    if limit_lp.scipy_version() is not None:
        points += bisected(arch, limit_lp.stands_by_compact, "compact LP, bisected")
        points += bisected(arch, limit_lp.stands_by_general, "general LP, bisected")
    return points


def _report(races: list[Race], points: list[Point]) -> list[str]:
    """Lines of the report."""
    version = limit_lp.scipy_version()
    peer = f"HiGHS of scipy {version}" if version else "scipy is missing: no linear programs"
    lines = [
        "# Error against run time",
        "",
        f"Python {platform.python_version()}; {peer}. Times are the least of this run; only "
        "their ratios mean anything. dda: the column seconds, wall time (arch, decision). Linear "
        "programs: processor time (building, solving).",
        "",
        *race_table(races),
    ]
    if points:
        lines += ["", "Fastest setting that reaches an accuracy:", "", *best_table(points)]
    return lines
