"""`voussoir work-precision`: error against run time, all in one run on one machine."""

from __future__ import annotations

import argparse
import platform
import sys
from pathlib import Path

from voussoir.command.options import whole_number
from voussoir.dda_program import find_dda
from voussoir.files import write_text
from voussoir_benches import limit_lp
from voussoir_benches.work_precision_fronts import CLASSES, Panel, panels
from voussoir_benches.work_precision_motion import MotionPoint, motion_points
from voussoir_benches.work_precision_page import draw, front_table, motion_table, race_table, write_motion, write_points
from voussoir_benches.work_precision_plan import cost_table, plan_costs
from voussoir_benches.work_precision_runs import Arch, Race, race


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.add_argument("--out", type=Path, default=Path("work_precision"), help="folder of tables and figure")
    parser.add_argument(
        "--angles", type=float, nargs="+", default=[45.0, 90.0, 140.0], metavar="DEG",
        help="half angles of embrace [deg]")
    parser.add_argument(
        "--voussoirs", type=whole_number(2), nargs="+", default=[36, 1000], metavar="N",
        help="even numbers of voussoirs")
    parser.add_argument("--repeats", type=whole_number(1), default=5, help="runs per setting")
    parser.add_argument(
        "--scenes", nargs="+", choices=CLASSES, default=list(CLASSES), metavar="CLASS",
        help="classes of scenes in the diagram: " + ", ".join(CLASSES))
    part = parser.add_mutually_exclusive_group()
    part.add_argument("--race", action="store_true", help="times of one decision only")
    part.add_argument("--motion", action="store_true", help="blocks in motion only")
    part.add_argument("--plan", action="store_true", help="costs of forced parts of the scene plan only")


def run(arguments: argparse.Namespace) -> int:
    """Measure, write tables and figure, print the table of ratios."""
    find_dda()
    arches = [Arch(angle, count) for count in arguments.voussoirs for angle in arguments.angles]
    arguments.out.mkdir(parents=True, exist_ok=True)
    runs = arguments.out / "runs"
    if arguments.plan:
        costs = plan_costs(arguments.voussoirs, runs, arguments.repeats)
        table = "\n".join(cost_table(list(costs))) + "\n"
        write_text(arguments.out / "plan_costs.md", table)
        sys.stdout.write(table)
        return 0
    races: list[Race] = []
    drawn: list[Panel] = []
    motion: list[MotionPoint] = []
    if not arguments.motion:
        races = [race(arch, runs, arguments.repeats) for arch in arches]
    if not arguments.motion and not arguments.race:
        drawn = list(panels(runs, arguments.repeats, arguments.scenes))
        write_points(drawn, arguments.out / "work_precision.csv")
        draw(drawn, arguments.out)
    if not arguments.race and "motion" in arguments.scenes:
        motion = list(motion_points(runs, arguments.repeats))
        write_motion(motion, arguments.out / "work_precision_motion.csv")
    text = "\n".join(_report(races, drawn, motion)) + "\n"
    write_text(arguments.out / "work_precision.md", text)
    sys.stdout.write(text)
    return 0


def _report(races: list[Race], drawn: list[Panel], motion: list[MotionPoint]) -> list[str]:
    """Lines of the report."""
    version = limit_lp.scipy_version()
    peer = f"HiGHS of scipy {version}" if version else "scipy is missing: no linear programs"
    lines = [
        "# Error against run time",
        "",
        f"Python {platform.python_version()}; {peer}. Only ratios of times mean "
        "anything. dda: the column seconds, wall time in the process, or the processor time of runs "
        "that take longer than 20 ms a case. Linear programs: processor time (building, solving).",
    ]
    if drawn:
        lines += ["", "Least time in which the best setting of a method reaches an error:", ""]
        lines += front_table(drawn)
    if races:
        lines += ["", "One decision, and one search to 1e-8 (least times):", "", *race_table(races)]
    if motion:
        lines += ["", "Blocks that move in time:", "", *motion_table(motion)]
    return lines
