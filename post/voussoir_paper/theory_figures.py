"""Figures 1 to 7 of the paper, section 2, as SVG and PNG.

Run as ``python3 -m voussoir_paper.theory_figures --out DIR``. Every number drawn comes from `voussoir.theory`.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from voussoir.plot.figure_style import house_style, save
from voussoir_paper.theory_curves import curve_of_the_semicircle, curves, curves_at_90, curves_at_140
from voussoir_paper.theory_sketches import collapse_mode, lines_of_thrust, notation

#: In the order of the paper
FIGURES = (collapse_mode, notation, lines_of_thrust, curve_of_the_semicircle, curves, curves_at_90, curves_at_140)


def main(arguments: list[str] | None = None) -> int:
    """Draw all seven figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", metavar="DIR", type=Path, default=Path("."), help="folder for the files (default: .)")
    for path in draw_all(parser.parse_args(arguments).out):
        print(path)
    return 0


def draw_all(folder: Path) -> list[Path]:
    """Write figures 1 to 7 as SVG and PNG."""
    paths = []
    with house_style():
        for number, draw in enumerate(FIGURES, 1):
            paths += save(draw(), folder, f"figure{number}")
    return paths


if __name__ == "__main__":
    raise SystemExit(main())
