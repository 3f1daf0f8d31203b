"""One style for all figures: readable in print, in greyscale too, the same bytes at every run."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.transforms import ScaledTranslation

from voussoir.files import fresh

#: Dots per inch of pictures of a given width
EXACT_DPI = 300
#: Dark to light in greyscale as well: black, blue, vermilion, grey
INK = ("#000000", "#1f5fa8", "#d1632a", "#9a9a9a")
#: Marks that distinguish curves
MARKERS = "osD^vP*X"
#: Fill of masonry
STONE = "#ececec"
#: Fill of masonry by its material, that of the deck first
TINTS = (STONE, "#d9c9ac", "#bccfdd", "#dbbfb6", "#c8d8bd", "#b9b9b9")

#: Sizes of small type, as of legends, and of tiny type, as of contours, over that of the picture
SMALL, TINY = 0.83, 0.69
#: Smallest type of the pictures that are drawn [points]
_SMALLEST: ContextVar[float] = ContextVar("smallest", default=5.0)

_SETTINGS: dict[str, Any] = {
    "figure.dpi": 100, "savefig.dpi": 200, "font.size": 10, "axes.labelsize": 11, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.6,
    "legend.frameon": False, "lines.linewidth": 1.6, "mathtext.fontset": "stix", "font.family": "STIXGeneral",
    "hatch.linewidth": 0.4, "svg.hashsalt": "voussoir", "svg.fonttype": "path", "pdf.fonttype": 42}


class Picture(Figure):
    """A figure that notebooks show whatever backend is chosen."""

    #: Whether it is written as large as it is, not cut to what is drawn
    exact_size = False

    def _repr_png_(self) -> bytes:
        stream = io.BytesIO()
        self.savefig(stream, format="png", dpi=110, bbox_inches=box_of(self))
        return stream.getvalue()


def box_of(figure: Figure) -> str | None:
    """Part of a figure that is written: all, or with "tight" the area that has marks."""
    return None if getattr(figure, "exact_size", False) else "tight"


@contextmanager
def house_style(font: float = 10.0, smallest: float = 5.0) -> Iterator[None]:
    """Draw within this context, in type of this size and none below the smallest [points]."""
    settings: Any = {**_SETTINGS, "font.size": max(font, smallest), "axes.labelsize": max(1.1 * font, smallest)}
    token = _SMALLEST.set(smallest)
    try:
        with plt.rc_context(settings):
            yield
    finally:
        _SMALLEST.reset(token)


def type_of(share: float) -> float:
    """Type of a share of that of the picture, at least the smallest one [points]."""
    return float(max(_SMALLEST.get(), share * plt.rcParams["font.size"]))


def legend_below(axes: Axes, columns: int, entries: list[Artist] | None = None, title: str = "") -> None:
    """A legend in small type below the label of the axis."""
    drop = ScaledTranslation(0.0, -4.3 * plt.rcParams["font.size"] / 72.0, axes.figure.dpi_scale_trans)
    chosen = {"handles": entries} if entries else {}
    legend = axes.legend(
        **chosen, loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=axes.transAxes + drop, ncols=columns,
        fontsize=type_of(SMALL), columnspacing=1.2, handlelength=1.6, borderpad=0.0, borderaxespad=0.0)
    if title:
        legend.set_title(title, FontProperties(size=type_of(SMALL)))


#: What files say of their making, left out for equal bytes at every run
_METADATA = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {"Software": None}}


def save(figure: Figure, folder: Path, name: str, formats: tuple[str, ...] = ("svg", "png")) -> list[Path]:
    """Write a figure as svg, pdf or png, and close it; its folder is made if missing."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{name}.{ending}" for ending in formats]
    for path in paths:
        figure.savefig(
            fresh(path), bbox_inches=box_of(figure), metadata=_METADATA[path.suffix],
            dpi=EXACT_DPI if box_of(figure) is None else plt.rcParams["savefig.dpi"])
    plt.close(figure)
    return paths
