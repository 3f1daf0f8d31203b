"""One style for all figures: readable in print, in greyscale too, the same bytes at every run."""

from __future__ import annotations

import io
from contextlib import contextmanager
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

#: Dark to light in greyscale as well: black, blue, vermilion, grey
INK = ("#000000", "#1f5fa8", "#d1632a", "#9a9a9a")
#: Line styles that tell the curves apart without colour
DASHES = ("-", (0, (6, 2)), (0, (5, 1.5, 1, 1.5)), (0, (1.2, 1.2)))
#: Fill of masonry
STONE = "#ececec"

_SETTINGS = {
    "figure.dpi": 100,
    "savefig.dpi": 200,
    "font.size": 10,
    "axes.labelsize": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "mathtext.fontset": "stix",
    "font.family": "STIXGeneral",
    "svg.hashsalt": "voussoir",
    "svg.fonttype": "path",
}


class Picture(Figure):
    """A figure that notebooks show whatever backend is chosen."""

    def _repr_png_(self) -> bytes:
        stream = io.BytesIO()
        self.savefig(stream, format="png", dpi=110, bbox_inches="tight")
        return stream.getvalue()


@contextmanager
def house_style():
    """Draw within this context."""
    with plt.rc_context(_SETTINGS):
        yield


#: What files say of their making, left out for equal bytes at every run
_METADATA = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {"Software": None}}


def save(
    figure: Figure, folder: Path, name: str, formats: tuple[str, ...] = ("svg", "png")
) -> list[Path]:
    """Write a figure and close it.

    Parameters
    ----------
    figure : Figure
        What to write.
    folder : Path
        Where; made if missing.
    name : str
        File name without ending.
    formats : tuple of str, optional
        Endings without the dot, of svg, pdf and png.

    Returns
    -------
    list of Path
        The files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{name}.{ending}" for ending in formats]
    for path in paths:
        figure.savefig(path, bbox_inches="tight", metadata=_METADATA[path.suffix])
    plt.close(figure)
    return paths
