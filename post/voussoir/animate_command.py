"""`voussoir animate`: the motion of cases as a GIF."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from voussoir import results

#: Most cases that move side by side without being named
MOST_CASES = 6


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the subcommand.
    """
    parser.description = (
        "Animate cases of a folder that dda run has written with geometry = 'current' and "
        "output frames, side by side."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results")
    parser.add_argument(
        "--case",
        metavar="N",
        type=int,
        nargs="+",
        help=f"cases to animate (default: the first {MOST_CASES} that have frames)",
    )
    parser.add_argument(
        "--out", metavar="FILE", type=Path, help="the GIF (default: DIR/plots/motion.gif)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Animate.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed options.

    Returns
    -------
    int
        Exit status: 0, 2 for results that cannot be animated, 4 for a file that cannot be written.
    """
    try:
        return _run(arguments)
    except (FileNotFoundError, KeyError, ValueError) as error:
        words = error.args[0] if isinstance(error, KeyError) else error
        sys.stderr.write(f"{arguments.folder}:1: error: {words}\n")
        return 2
    except ImportError as error:
        sys.stderr.write(
            f"voussoir:1: error: wanted matplotlib, found none ({error}); install "
            "python3-matplotlib\n"
        )
        return 2
    except OSError as error:
        sys.stderr.write(
            f"{error.filename or arguments.out}:1: error: wanted a file that can be written, "
            f"found: {error.strerror}; choose another one with --out\n"
        )
        return 4


def _run(arguments: argparse.Namespace) -> int:
    """Animate; failures are exceptions."""
    read = results.read(arguments.folder)
    cases = arguments.case or [int(number) for number in read.cases["case"]]
    for number in cases:
        read.case(number)
    moving = [number for number in cases if len(read.frames_of(number)) > 1]
    if not moving or arguments.case and len(moving) < len(cases):
        still = next(number for number in cases if number not in moving)
        raise ValueError(
            f"wanted frames of case {still}, found none; give the deck &analysis geometry = "
            "'current' / and &output frames = 20 /"
        )
    from voussoir.case_picture import title_of
    from voussoir.collapse_animation import animate
    from voussoir.figure_style import house_style

    file = arguments.out or arguments.folder / "plots" / "motion.gif"
    file.parent.mkdir(parents=True, exist_ok=True)
    shown = moving if arguments.case else moving[:MOST_CASES]
    with house_style():
        print(animate(read, shown, title_of, file, width=5.6 if len(shown) > 1 else 6.4))
    return 0
