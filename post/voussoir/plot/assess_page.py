"""The page of an assessment: drawings, verdict, safety numbers, load cases and assumptions, printable on two sheets."""

from __future__ import annotations

import io
from collections.abc import Sequence

from matplotlib.figure import Figure

from voussoir.deck.assessment import Assessment, slides
from voussoir.html_page import cell, document, escape, table
from voussoir.plot.assess_drawing import draw_scheme
from voussoir.plot.assess_text import assumptions_of, cases_of, factor_rows, numbers_of, verdict_of
from voussoir.plot.case_picture import draw_case
from voussoir.plot.case_title import thrust_of
from voussoir.plot.figure_style import box_of, house_style
from voussoir.plot.position_chart import draw_positions
from voussoir.plot.sheet import Sheet
from voussoir.plot.units import force_unit

#: Width of the figures [inch] and size of their type [points]: two stand side by side on a sheet of A4
WIDTH, FONT = 88.0 / 25.4, 8.0
STYLE = """
body{font:16px/1.45 Georgia,serif;color:#222;max-width:64rem;margin:1.5rem auto;padding:0 1rem}
h1{font-size:1.6rem;margin:0 0 .3rem}h2{font-size:1.15rem;margin:1.4rem 0 .4rem;border-bottom:1px solid #bbb}
h3{font-size:1rem;margin:.6rem 0 .2rem}
.verdict{font-size:1.15rem;padding:.6rem .9rem;border-left:5px solid #1b5e8c;background:#eef3f7}
.falls{border-color:#a3262a;background:#f8eeee}
.scroll{overflow-x:auto}table{border-collapse:collapse;width:100%}
td,th{text-align:left;padding:.2rem .6rem .2rem 0;vertical-align:top}thead th{border-bottom:2px solid #bbb}
tr{border-bottom:1px solid #ddd}td{overflow-wrap:anywhere}.number{white-space:nowrap}.meaning{color:#555}
.pair{display:grid;grid-template-columns:1fr 1fr;gap:1.2rem;align-items:start}
ul{margin:.2rem 0;padding-left:1.2rem;columns:2;column-gap:2rem}li{break-inside:avoid}
figure{margin:0;break-inside:avoid}svg{width:100%;height:auto}figcaption{font-size:.9rem;color:#555}
pre{white-space:pre-wrap;overflow-wrap:anywhere;background:#f5f5f2;padding:.7rem;font-size:.8rem;margin:.3rem 0}
.origin td,.origin th{font-size:.8rem;color:#555}
@media screen and (max-width:40rem){.pair{grid-template-columns:1fr}ul{columns:1}
.numbers td,.numbers th{display:block;padding-bottom:0}.cases{min-width:38rem}}
@page{size:A4;margin:12mm}
@media print{body{margin:0;padding:0;font-size:9pt;line-height:1.3;max-width:none}h1{font-size:14pt}
h2{font-size:10.5pt;break-after:avoid;margin:.5rem 0 .2rem}.verdict{margin:.3rem 0;padding:.3rem .6rem;font-size:10pt}
h3{font-size:9.5pt;margin:.2rem 0}figcaption{font-size:8pt}.pair{gap:6mm}
table,ul{font-size:8.5pt}td,th{padding:.1rem .5rem .1rem 0}pre{font-size:7pt;padding:.3rem}
.origin td,.origin th{font-size:7pt}section{break-inside:avoid}
svg{max-height:78mm}*{print-color-adjust:exact}}
"""
#: Captions of the diagram of positions, of arches and of arches in rings
_POSITIONS = (
    "Load factor at collapse against the position of the leftmost axle.",
    "Load factor by limit analysis, an upper bound where rings slide on one another; the worst position is where it is "
    "least.",
)


def figure_of(figure: Figure, title: str, caption: str = "") -> str:
    """A figure as SVG with its title and caption, for a page."""
    text = io.StringIO()
    figure.savefig(text, format="svg", bbox_inches=box_of(figure), metadata={"Date": None})
    drawn = text.getvalue().partition("<svg")[2]
    below = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    return f"<figure><h3>{escape(title)}</h3><svg{drawn}{below}</figure>"


def table_of(rows: Sequence[Sequence[str]], kind: str = "", heads: bool = False) -> str:
    """A table; the first cell of a row is its head, and the first row the head of all with `heads`."""
    names = ("", "", "") if kind == "origin" else ("", "number", "meaning" if kind == "numbers" else "number")
    head = [cell(escape(word), tag="th") for word in rows[0]] if heads else []
    body = [[cell(escape(word), names[min(place, 2)], "td" if place else "th") for place, word in enumerate(row)]
            for row in rows[bool(heads):]]
    return f'<div class="scroll">{table(head, body, kind)}</div>'


def list_of(lines: Sequence[str]) -> str:
    """A list of sentences."""
    return "<ul>" + "".join(f"<li>{escape(line)}</li>" for line in lines) + "</ul>"


def figures_of(found: Assessment) -> list[str]:
    """The figures of a deck: drawing, positions, thrust, collapse."""
    sheet = Sheet(WIDTH, title=False)
    with house_style(FONT):
        figure, words = draw_scheme(found, sheet)
        parts = [figure_of(figure, "Drawing", f"{words} Supports are hatched.")]
        cases = found.positions
        if cases is not None and "found" in cases["verdict"]:
            place = found.place
            chart = draw_positions(found.own, cases, None if place != place else place, sheet, found.axles)
            parts.append(figure_of(chart, "Position of the vehicle", _POSITIONS[slides(found.own)]))
        falls = found.movements and found.row["verdict"] == "collapsed"
        words = "Collapse" if falls else "Thrust under the loads given"
        words += f", {' and '.join(found.movements)}" if found.movements else ""
        parts.append(figure_of(draw_case(found.own, 1, sheet=sheet), words))
        if found.spread is not None and found.spread.case(1)["verdict"] == "found":
            parts.append(figure_of(
                draw_case(found.spread, 1, sheet=sheet), "Supports moved: the last equilibrium before the collapse"))
        if found.found is not None and found.factor is not None and found.factor["verdict"] == "found":
            parts.append(figure_of(draw_case(found.found, 1, sheet=sheet), "Collapse under the live loads multiplied"))
    return parts


def single(found: Assessment, origin: Sequence[tuple[str, str]]) -> str:
    """The page of one deck."""
    sentence, falls = verdict_of(found)
    figures = figures_of(found)
    pairs = [f'<div class="pair">{"".join(figures[n : n + 2])}</div>' for n in range(0, len(figures), 2)]
    sections = [
        ("", pairs[0]),
        ("Safety", table_of(numbers_of(found), "numbers")),
        ("Load cases", table_of(cases_of(found), "cases", True)),
        *(("", pair) for pair in pairs[1:]),
        ("Assumptions", list_of(assumptions_of(found))),
        ("Input", f"<pre>{escape(found.text)}</pre>"),
        ("Origin", table_of(origin, "origin")),
    ]
    return page(found.title, [(sentence, falls)], sections)


def comparison(all_found: Sequence[Assessment], origin: Sequence[tuple[str, str]]) -> str:
    """The page of several decks: one table for all, then their figures side by side."""
    heads = ("Deck", "Verdict", "Geometric safety factor [-]", "Load factor [-]", "Worst position [m]", "Thrust")
    rows: list[Sequence[str]] = [heads]
    for found in all_found:
        factor = {name: value for name, value, _ in factor_rows(found)}
        thickness = next(value for name, value, _ in numbers_of(found) if name == "Geometric safety factor")
        rows.append((
            found.title, str(found.row["verdict"]), thickness, factor["Load factor"],
            factor.get("Worst position", "-").removesuffix(" m"), thrust_of(found.row, force_unit(found.own)) or "-"))
    common = [line for line in assumptions_of(all_found[0])
              if all(line in assumptions_of(other) for other in all_found[1:])]
    sections = [("Comparison", table_of(rows, "cases", True)), ("Assumptions of all", list_of(common))]
    for found in all_found:
        figures = figures_of(found)
        own = [line for line in assumptions_of(found) if line not in common]
        shown = [figures[0], figures[-1]] if len(figures) > 1 else figures
        sections.append((found.title, f'<div class="pair">{"".join(shown)}</div>' + (list_of(own) if own else "")))
    texts = "".join(f"<h3>{escape(found.deck.name)}</h3><pre>{escape(found.text)}</pre>" for found in all_found)
    sections += [("Input", texts), ("Origin", table_of(origin, "origin"))]
    verdicts = [(f"{found.title}: {verdict_of(found)[0]}", verdict_of(found)[1]) for found in all_found]
    return page(f"Comparison of {len(all_found)} arches", verdicts, sections)


def page(title: str, verdicts: Sequence[tuple[str, bool]], parts: Sequence[tuple[str, str]]) -> str:
    """The whole page; a verdict is marked where it is a bad one."""
    body = "".join(f"<section>{f'<h2>{escape(name)}</h2>' if name else ''}{text}</section>" for name, text in parts)
    said = "".join(f'<p class="verdict{" falls" if falls else ""}">{escape(words)}</p>' for words, falls in verdicts)
    return document(title, STYLE, f"<h1>{escape(title)}</h1>{said}{body}")
