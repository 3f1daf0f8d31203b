"""A picture of given width: title above, legend below or beside, all text in one small type."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from voussoir.plot.figure_style import EXACT_DPI, SMALL, Picture, type_of

#: Width of a picture for which none is given [inch], and points per inch
WIDTH, POINTS = 5.2, 72.0
#: Height of a drawing over its width above which its legend stands beside it
TALL = 1.15
#: Largest height of a drawing over the width of its picture, below a title and beside a legend
MOST_HEIGHT = 1.1
#: Share of the width for a drawing with its legend beside it
BESIDE = 0.58
#: Least width of a legend beside a drawing over the size of the type
LEAST_COLUMN = 11.0
#: Least height of a drawing over the width of its picture
LEAST_HEIGHT = 0.16
#: Room at the edges, and between drawing and texts [points]
EDGE, GAP = 3.0, 6.0
#: Thinnest pen
THINNEST = 0.35


@dataclass(frozen=True)
class Sheet:
    """Sheet of a picture."""

    width: float = WIDTH  #: Width of the whole picture [inch]
    #: Whether it has them
    title: bool = True
    legend: bool = True

    def pen(self, blocks: int = 1) -> float:
        """Width of lines over that of a picture of `WIDTH` with few blocks."""
        crowd: float = min(1.0, (60.0 / max(blocks, 1)) ** 0.3)
        return float(max(THINNEST, (self.width / WIDTH) ** 0.5 * crowd))

    def scale(self, low: np.ndarray, high: np.ndarray) -> float:
        """Points per metre of a drawing of this piece of plane, close to what `finish` makes of it."""
        return self.drawing_width(low, high) / float(high[0] - low[0])

    def drawing_width(self, low: np.ndarray, high: np.ndarray) -> float:
        """Width of the drawing of a piece of plane [points]."""
        wide, tall = high - low
        share: float = BESIDE if self.legend and tall > TALL * wide else 1.0
        inner = POINTS * self.width - 2.0 * EDGE
        return float(min(share * inner, MOST_HEIGHT * inner * wide / tall))

    def start(self, low: np.ndarray, high: np.ndarray) -> tuple[Figure, Axes]:
        """A figure for a piece of plane and its bare axes."""
        width = self.drawing_width(low, high)
        figure = Picture(figsize=(self.width, self.width), dpi=EXACT_DPI)
        figure.exact_size = True
        FigureCanvasAgg(figure)
        height = max(width * (high[1] - low[1]) / (high[0] - low[0]), LEAST_HEIGHT * POINTS * self.width)
        full = POINTS * self.width
        axes = figure.add_axes((0.0, 0.0, width / full, height / full))
        axes.set_axis_off()
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        return figure, axes

    def resized(self, figure: Figure) -> Figure:
        """A chart in the width of the sheet, in the shape that it has, without its titles where none are asked for."""
        wide, tall = figure.get_size_inches()
        # narrow charts are higher in proportion: their type is not smaller
        figure.set_size_inches(self.width, self.width * tall / wide * (WIDTH / self.width) ** 0.2)
        if isinstance(figure, Picture):
            figure.exact_size = True
        if not self.title:
            if getattr(figure, "_suptitle", None) is not None:
                figure.suptitle("")
            for axes in figure.axes:
                axes.set_title("")
        if not self.legend:
            for axes in figure.axes:
                if (legend := axes.get_legend()) is not None:
                    legend.remove()
        return figure

    def finish(self, figure: Figure, axes: Axes, title: str = "", entries: Sequence[Artist] = ()) -> Figure:
        """Place the drawing, its title and its legend; the height follows from them."""
        full, type_size = POINTS * self.width, float(mpl.rcParams["font.size"])
        low, high = (np.array(ends) for ends in zip(axes.get_xlim(), axes.get_ylim()))
        left, below, right, above = overhang(figure, axes)
        wide = self.drawing_width(low, high)
        inner = full - 2.0 * EDGE
        beside = self.legend and bool(entries) and high[1] - low[1] > TALL * (high[0] - low[0])
        beside = beside and inner - wide - left - right - 2.0 * GAP >= LEAST_COLUMN * type_size
        if not beside:
            wide = min(inner, MOST_HEIGHT * inner * float((high[0] - low[0]) / (high[1] - low[1])))
        wide = min(wide, (BESIDE if beside else 1.0) * inner - left - right)
        tall = max(wide * float((high[1] - low[1]) / (high[0] - low[0])), LEAST_HEIGHT * full)
        column = inner - (wide + left + right + 2.0 * GAP if beside else 0.0)
        legend, legend_size = None, (0.0, 0.0)
        if self.legend and entries:
            most = tall + above + below
            legend, legend_size = make_legend(figure, entries, column, most, 1 if beside else 3)
        words, title_height = "", 0.0
        if self.title and title:
            words = "\n".join(wrapped(figure, line, full - 4.0 * EDGE, type_size) for line in title.split("\n"))
            title_height = text_size(figure, words, type_size)[1] + GAP
        drawn = tall + above + below
        body = max(drawn, legend_size[1]) if beside else drawn + (legend_size[1] + GAP if legend else 0.0)
        height = body + title_height + 2.0 * EDGE
        figure.set_size_inches(self.width, height / POINTS)
        top = height - EDGE - title_height
        across = EDGE + left + (0.0 if beside else 0.5 * (inner - left - right - wide))
        sink = 0.5 * (body - drawn) if beside else 0.0
        axes.set_position((across / full, (top - sink - above - tall) / height, wide / full, tall / height))
        if words:
            figure.suptitle(words, x=0.5, y=1.0 - EDGE / height, va="top", fontsize=type_size, linespacing=1.15)
        if legend:
            place = (1.0 - (EDGE + legend_size[0]) / full, (top - 0.5 * (body + legend_size[1])) / height)
            if not beside:
                place = (0.5 * (1.0 - legend_size[0] / full), EDGE / height)
            legend.set_bbox_to_anchor(place, transform=figure.transFigure)
        return figure


def renderer_of(figure: Figure) -> RendererBase:
    """Renderer that measures the texts of a figure."""
    canvas: Any = figure.canvas if isinstance(figure.canvas, FigureCanvasAgg) else FigureCanvasAgg(figure)
    renderer: RendererBase = canvas.get_renderer()
    return renderer


def overhang(figure: Figure, axes: Axes) -> tuple[float, float, float, float]:
    """Reach of marks and texts beyond their axes: left, below, right and above [points]."""
    renderer = renderer_of(figure)
    axes.apply_aspect()
    box, whole = axes.get_position().transformed(figure.transFigure), axes.get_tightbbox(renderer)
    if whole is None:
        return 0.0, 0.0, 0.0, 0.0
    to_points = POINTS / figure.dpi
    gaps = (box.x0 - whole.x0, box.y0 - whole.y0, whole.x1 - box.x1, whole.y1 - box.y1)
    left, below, right, above = (max(0.0, gap) * to_points + 1.0 for gap in gaps)
    return left, below, right, above


def text_size(figure: Figure, words: str, type_size: float) -> tuple[float, float]:
    """Width and height of a text [points]."""
    text = figure.text(0.0, 0.0, words, fontsize=type_size, linespacing=1.15)
    box = text.get_window_extent(renderer_of(figure))
    text.remove()
    return box.width * POINTS / figure.dpi, box.height * POINTS / figure.dpi


def wrapped(figure: Figure, line: str, width: float, type_size: float) -> str:
    """A line broken so that it fits a width [points]; a number stays with its unit."""
    lines: list[str] = []
    for word in re.split(r"(?<!\d) ", line):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_size(figure, longer, type_size)[0] <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return "\n".join(lines)


def make_legend(
    figure: Figure, entries: Sequence[Artist], width: float, height: float, most_columns: int
) -> tuple[Legend, tuple[float, float]]:
    """The legend in that number of columns which makes it lowest, and its size [points].

    Its type is smaller than that of the picture, and becomes smaller still where it would be higher than the drawing.
    """
    labels = [str(entry.get_label()) for entry in entries]
    style: dict[str, Any] = {
        "handles": entries, "loc": "lower left", "borderpad": 0.0, "borderaxespad": 0.0, "labelspacing": 0.35,
        "handlelength": 2.0, "handletextpad": 0.6, "columnspacing": 1.2}
    size, smallest = type_of(SMALL), type_of(0.0)
    while True:
        best = None
        for columns in range(1, min(most_columns, len(entries)) + 1):
            names = [wrapped(figure, label, width / columns - 4.6 * size, size) for label in labels]
            legend = figure.legend(labels=names, ncols=columns, fontsize=size, bbox_to_anchor=(0.0, 0.0), **style)
            box = legend.get_window_extent(renderer_of(figure))
            found = (box.height * POINTS / figure.dpi, columns, names, box.width * POINTS / figure.dpi)
            legend.remove()
            if found[3] <= 1.001 * width and (best is None or found[0] < 0.95 * best[0]):
                best = found
            if best is None and columns == 1:
                best = found
        if best is None or best[0] <= height or size <= smallest:
            break
        size = max(smallest, 0.9 * size)
    assert best is not None
    return figure.legend(labels=best[2], ncols=best[1], fontsize=size, **style), (best[3], best[0])
