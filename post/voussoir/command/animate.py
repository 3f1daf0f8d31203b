"""`voussoir animate`: the motion of cases as a GIF, an MP4 or pictures."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from voussoir import results
from voussoir.command.options import magnification

#: Most cases that move side by side without being named
MOST_CASES = 6


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Animates cases of a folder of results side by side: frames of runs with geometry = 'current', else the "
        "growing collapse mechanism."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results")
    parser.add_argument(
        "--case", metavar="N", type=int, nargs="+", help=f"cases to animate (default: the first {MOST_CASES} that move)"
    )
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=Path,
        help="a .gif, an .mp4 (needs ffmpeg), or a .png for one numbered file per frame "
        "(default: DIR/plots/motion.gif)",
    )
    parser.add_argument(
        "--magnify", metavar="M", type=magnification, default=1.0,
        help="magnification of the displacements, stated in the title (default: 1, true scale)")


def run(arguments: argparse.Namespace) -> int:
    """Animate."""
    read = results.read(arguments.folder)
    cases = arguments.case or [int(number) for number in read.cases["case"]]
    for number in cases:
        read.case(number)
    from voussoir.plot.case_title import title_of
    from voussoir.plot.collapse_animation import animate, check_ending
    from voussoir.plot.collapse_picture import pictures_of
    from voussoir.plot.figure_style import house_style

    moving = [number for number in cases if len(pictures_of(read, number)) > 1]
    if not moving or arguments.case and len(moving) < len(cases):
        still = next(number for number in cases if number not in moving)
        moves = read.case(still)["geometry"] == "current"
        advice = "" if moves else "&analysis geometry = 'current' / and "
        raise ValueError(
            f"expected frames of case {still}, got none; give the deck "
            f"{advice}&output frames = 20 /")
    file = arguments.out or arguments.folder / "plots" / "motion.gif"
    check_ending(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    shown = moving if arguments.case else moving[:MOST_CASES]
    factor = arguments.magnify

    def title(row: dict[str, Any]) -> str:
        return title_of(row, read) + (f"\ndisplacements × {factor:g}" if factor != 1.0 else "")

    with house_style():
        width = 5.6 if len(shown) > 1 else 6.4
        print(animate(read, shown, title, file, width=width, magnify=factor))
    return 0
