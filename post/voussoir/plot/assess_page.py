"""The page of an assessment: drawings, verdict, safety numbers, inputs, on one printable sheet of HTML."""

from __future__ import annotations

import html
import io
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from voussoir.plot.case_picture import draw_blocks, draw_supports
from voussoir.plot.case_scene import scene_of, view
from voussoir.plot.figure_style import INK
from voussoir.plot.sheet import Sheet
from voussoir.plot.units import force_text, value_label
from voussoir.results import Results

#: Keys that say how large an arch is
DIMENSIONS = (
    "span", "rise", "right_rise", "radius", "half_angle_deg", "thickness", "thickness_ratio", "crown_thickness",
    "springing_thickness", "pier_width", "pier_height", "buttress_width", "buttress_height",
)
STYLE = """
body{font:16px/1.45 Georgia,serif;color:#222;max-width:62rem;margin:1.5rem auto;padding:0 1rem}
h1{font-size:1.6rem;margin:0 0 .3rem}h2{font-size:1.15rem;margin:1.4rem 0 .4rem;border-bottom:1px solid #bbb}
.verdict{font-size:1.15rem;padding:.6rem .9rem;border-left:5px solid #1b5e8c;background:#eef3f7}
.falls{border-color:#a3262a;background:#f8eeee}
table{border-collapse:collapse;width:100%}td,th{text-align:left;padding:.2rem .6rem .2rem 0;vertical-align:top}
tr{border-bottom:1px solid #ddd}td{overflow-wrap:anywhere}th{white-space:nowrap}
@media screen and (max-width:40rem){td,th{display:block;padding-bottom:0}}
figure{margin:.6rem 0;break-inside:avoid}svg{width:100%;max-width:38rem;height:auto}
figcaption{font-size:.9rem;color:#555}
pre{white-space:pre-wrap;overflow-wrap:anywhere;background:#f5f5f2;padding:.7rem;font-size:.85rem}
.note{font-size:.9rem;color:#555}@page{size:A4;margin:14mm}
@media print{body{margin:0;padding:0;font-size:10pt;max-width:none}h2{break-after:avoid;margin:.7rem 0 .2rem}
section{break-inside:avoid}svg{max-height:70mm}.verdict{margin:.4rem 0}*{print-color-adjust:exact}}
"""


def svg_of(figure: Figure) -> str:
    """A figure as SVG that stands in a page."""
    text = io.StringIO()
    figure.savefig(text, format="svg", bbox_inches="tight", metadata={"Date": None})
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]


def figure_of(figure: Figure, caption: str = "") -> str:
    """A figure with its caption, for a page."""
    below = f"<figcaption>{html.escape(caption)}</figcaption>" if caption else ""
    return f"<figure>{svg_of(figure)}{below}</figure>"


def draw_scheme(run: Results, axles: Sequence[tuple[float, float]], surface: float | None) -> Figure:
    """The blocks with dimensions, supports, the surface of the fill [m], and the axles: place and weight [m, N/m]."""
    scene = scene_of(run, 1)
    shapes = scene.shapes(0.0)
    corners = np.vstack(shapes)
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = float((high - low).max())
    road = surface if surface is not None else float(high[1])
    box_low, box_high = view(shapes, [block.corners for block in scene.supports])
    sheet = Sheet()
    figure, axes = sheet.start(
        np.minimum(box_low, low - 0.16 * size), np.maximum(box_high, [high[0] + 0.2 * size, road + 0.2 * size])
    )
    draw_supports(axes, [block.corners for block in scene.supports])
    draw_blocks(axes, scene, shapes)
    if surface is not None:
        axes.plot([low[0], high[0]], [surface, surface], color=INK[3], linewidth=1.0)
        axes.annotate("surface of the fill", (low[0], surface), xytext=(0, 3), textcoords="offset points", fontsize=8)
    line = {"arrowstyle": "<->", "color": INK[0], "linewidth": 0.8}
    below, beside = low[1] - 0.08 * size, high[0] + 0.08 * size
    axes.annotate("", (low[0], below), (high[0], below), arrowprops=line)
    middle = (low + high) / 2
    axes.text(middle[0], below - 0.01 * size, f"{high[0] - low[0]:.3f} m", ha="center", va="top", fontsize=9)
    axes.annotate("", (beside, low[1]), (beside, high[1]), arrowprops=line)
    axes.text(beside + 0.015 * size, middle[1], f"{high[1] - low[1]:.3f} m", va="center", fontsize=9)
    for place, weight in axles:
        tip = {"arrowstyle": "-|>", "color": INK[2], "linewidth": 1.6}
        axes.annotate("", (place, road), (place, road + 0.13 * size), arrowprops=tip)
        axes.text(place, road + 0.14 * size, f"{force_text(weight)}", ha="center", fontsize=8, color=INK[2])
    return sheet.finish(figure, axes)


def dimensions_of(run: Results) -> str:
    """What the deck says of the size of the arch, as a sentence."""
    given = ((name, run.setting(f"arch%{name}")) for name in DIMENSIONS)
    words = [value_label(name, float(value)) for name, value in given if value]
    return f"{', '.join(words).capitalize()}." if words else ""


def table_of(rows: Sequence[tuple[str, str]]) -> str:
    """A table of two columns."""
    cells = (f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>" for name, value in rows)
    return "<table>" + "".join(cells) + "</table>"


def page(title: str, verdict: str, falls: bool, parts: Sequence[tuple[str, str]]) -> str:
    """The whole page; `falls` where the verdict is a bad one."""
    body = "".join(f"<section><h2>{html.escape(name)}</h2>{text}</section>" for name, text in parts)
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f"<title>{html.escape(title)}</title><style>{STYLE}</style></head><body><h1>{html.escape(title)}</h1>"
        f'<p class="verdict{" falls" if falls else ""}">{html.escape(verdict)}</p>{body}</body></html>\n'
    )
