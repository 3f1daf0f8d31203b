"""`voussoir stability`: stiff and extreme scenes, judged by exact answers."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import chain
from pathlib import Path

from voussoir.command.options import whole_number
from voussoir.dda_program import find_dda
from voussoir_benches.deck_runs import Finished, Row, run_deck
from voussoir_benches.expectations import RIGHT, UNDECIDED, WRONG, judge
from voussoir_benches.scene import Scene
from voussoir_benches.stability_page import Line, headline, write_lines, write_markdown, write_page
from voussoir_benches.stability_scenes import catalogue, random_scenes

_SEVERITY = (RIGHT, UNDECIDED, WRONG)  #: Results from good to bad


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.add_argument("--out", type=Path, default=Path("stability"), help="folder of the tables")
    parser.add_argument("--jobs", type=whole_number(1), default=1, help="number of scenes at the same time")
    parser.add_argument("--random", type=whole_number(0), default=150, metavar="N", help="number of random scenes")
    parser.add_argument("--seed", type=whole_number(0), default=1, help="seed of the random scenes")
    parser.add_argument("--only", metavar="WORD", help="only scenes with WORD in their group or name (default: all)")
    parser.add_argument("--timeout", type=float, default=300.0, help="time limit of a scene [s]")
    parser.add_argument("--list", action="store_true", help="list the scenes without running them")
    parser.epilog = f"{parser.epilog or ''} 1: a scene is WRONG.".strip()


def run(arguments: argparse.Namespace) -> int:
    """Run the scenes and write the tables: 1 if a scene is WRONG."""
    scenes = [
        scene
        for scene in chain(catalogue(), random_scenes(arguments.random, arguments.seed))
        if not arguments.only or arguments.only in f"{scene.group}: {scene.name}"
    ]
    if arguments.list:
        sys.stdout.writelines(f"{scene.group}: {scene.name}\n" for scene in scenes)
        return 0
    find_dda()
    lines = run_scenes(scenes, arguments.out, arguments.jobs, arguments.timeout)
    write_lines(lines, arguments.out / "stability.csv")
    write_markdown(lines, arguments.out / "stability.md")
    write_page(lines, arguments.out / "stability.html")
    sys.stdout.write(f"{headline(lines)}; tables in {arguments.out}/stability.csv, .md, .html\n")
    return int(any(line.result == WRONG for line in lines))


def run_scenes(scenes: Iterable[Scene], folder: Path, jobs: int, timeout: float) -> list[Line]:
    """Run scenes, each in a folder of its own and at most `timeout` seconds; print those that are not right."""

    def run_scene(numbered: tuple[int, Scene]) -> Line:
        number, scene = numbered
        place = folder / "scenes" / f"{number:04d}"
        line = _line(scene, run_deck(scene.text(), place, timeout, files=scene.files))
        if scene.has_lean_plan:
            lean = _line(scene, run_deck(scene.text(lean=True), place / "lean", timeout))
            if _SEVERITY.index(lean.result) > _SEVERITY.index(line.result):
                line = replace(lean, condition=line.condition)
        if line.result != "right":
            sys.stdout.write(
                f"{line.result}: {number:04d} {line.group}: {line.scene}: "
                f"expected {line.expected}, got {line.found}: {line.reason}\n")
            sys.stdout.flush()
        return line

    with ThreadPoolExecutor(max(1, jobs)) as pool:
        return list(pool.map(run_scene, enumerate(scenes, 1)))


def _line(scene: Scene, finished: Finished) -> Line:
    """The line of a finished scene."""
    judgement = judge(scene.expectation, finished)
    rows = finished.rows

    def total(name: str) -> str:
        return str(sum(int(row[name]) for row in rows)) if rows else ""

    conditions = [float(row["condition"]) for row in rows if row.get("condition")]
    return Line(
        scene.group, scene.name, judgement.colour, scene.expectation.expected(), judgement.found, judgement.error,
        total("open_close_iterations"), total("factorisations"), f"{max(conditions):.1e}" if conditions else "",
        f"{sum(float(row['seconds']) for row in rows):.4f}" if rows else "",
        "; ".join(filter(None, [scene.note, _seen_guard(rows)])), judgement.reason
    )


def _seen_guard(rows: list[Row]) -> str:
    """Visible guards of an answer."""
    if len(rows) != 1 or rows[0]["verdict"] != "found":
        return ""
    (row,) = rows
    width = float(row["critical_high"]) / float(row["critical_low"]) - 1.0
    seen = f"bracket {width:.0e} wide" if width > 1.1e-8 else ""
    sliding = row["collapse_mode"] in ("mixed", "sliding")
    return "; ".join(filter(None, [seen, "slides: cone and Coulomb agree" if sliding else ""]))
