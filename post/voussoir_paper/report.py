"""The report of the paper's section 3: one page with every table and every figure beside ours."""

from __future__ import annotations

import math
import platform
from html import escape
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

import voussoir
from voussoir import theory
from voussoir.dda_program import version_of
from voussoir.files import read_text
from voussoir_paper import findings, tables
from voussoir_paper.campaign import FIGURES, TOGETHER, Campaign, Timing
from voussoir_paper.contents import ANIMATIONS, CAPTIONS, SECTIONS, THEORY_CAPTIONS, caption
from voussoir_paper.page import Page
from voussoir_paper.tables import THEORIES, PaperTable, Row, percent, thickness

#: Stands where the time goes that making the page itself has taken
PAGE_TIME = "@@page@@"


#: Decimal places of the errors in percent, one notation a column; others have 2
_PLACES = {"ours, rigid": 4, "ours, elastic": 4}


def build(campaign: Campaign, figures: Path, timings: list[Timing], dda: Path) -> str:
    """The page as HTML, with the figures that are there; `PAGE_TIME` stands for the time that making it takes."""
    page = Page("Masonry arches by DDA: section 3 of the paper, side by side")
    page.text(
        "Every numerical experiment of section 3 of Rizzi, Rusconi and Cocchetti's paper on the Couplet-Heyman "
        "problem, repeated. Beside the paper's own DDA values stand ours, for rigid blocks (small displacements) and "
        "for elastic blocks that move; the exact values of limit analysis of the same polygons; and the analytic "
        "solutions of Milankovitch, CCR and Heyman. Each error is the deviation from the exact polygon value.",
        "&eta; is thickness over radius, &beta; the angle of the intrados hinge from the crown, &alpha; the half angle "
        "of embrace. Radius 10 m, unit weight 22 kN/m<sup>3</sup>, Young's modulus 5e6 kN/m<sup>2</sup>, Poisson's "
        "ratio 0.2, plane stress, friction 50 degrees where nothing else is said.",
    )
    top = figures / "figure18.png"
    if top.is_file():
        page.picture(top, "Arches at their critical thickness, collapsing: Fig. 18 below.", "top")
    _glance(page, campaign)
    page.section("What the comparison shows", "findings")
    for number, finding in enumerate(findings.find_all(campaign), 1):
        page.section(finding.claim, f"finding-{number}", level=3)
        page.text(finding.support)
    for number, (title, parts) in enumerate(SECTIONS, 1):
        page.section(title, f"section3-{number}")
        for part in parts:
            _add(page, campaign, figures, part)
    _theory(page, figures)
    _decks(page, campaign)
    _run(page, timings, dda)
    return page.render()


def _glance(page: Page, campaign: Campaign) -> None:
    """The main figures in one small table."""
    rows = []
    for name, table in campaign.tables.items():
        cells = [f'<a href="#{name}">Table {name[-1]}</a>', str(len(table.rows))]
        for column in ("paper DDA", "ours, rigid", "ours, elastic", *THEORIES.values()):
            errors = [row.values[column].error for row in table.rows]
            cells.append(percent(max((e for e in errors if e is not None), key=abs, default=None)))
        rows.append(cells)
    page.table(
        "Largest deviation from the exact polygon value [%]",
        ["", "arches", "paper DDA", "ours, rigid", "ours, elastic", *THEORIES.values()], rows, anchor="glance")


def _add(page: Page, campaign: Campaign, figures: Path, part: str) -> None:
    """Add one table or figure, with its animation."""
    if part in tables.TITLES:
        _thicknesses(page, campaign.tables[part])
    elif part in CAPTIONS:
        svg = figures / f"{part}.svg"
        name, words = ANIMATIONS.get(part, ("", ""))
        gif = figures / f"{name}.gif"
        moves = bool(name) and gif.is_file()
        if moves:
            page.begin_pair()
        if svg.is_file():
            page.figure(svg, caption(part, campaign), part)
        else:
            page.text(f'<span id="{part}">{CAPTIONS[part]} (left out: matplotlib is missing)</span>')
        if moves:
            page.picture(gif, words, name)
            page.end_pair()
    else:
        {
            "figure8_modes": _modes,
            "thresholds": _thresholds,
            "hinges9": _hinges_of_figure_10,
            "hinges4": _hinges_of_table_4,
        }[part](page, campaign)


def _thicknesses(page: Page, table: PaperTable) -> None:
    """Tables 1 to 4: values, and below each its error."""
    imposed = bool(table.rows[0].joint)
    columns = [name for name in table.columns if not (imposed and name == THEORIES["heyman"])]
    first = "joint [deg]" if imposed else "&alpha; [deg]" if table.name == "table4" else "blocks"
    second = ["blocks"] if table.name == "table4" else []
    head = [first, *map(escape, columns), "exact polygon", *second, "hinge, ours [deg]"]
    rows = []
    for row in table.rows:
        name = row.joint if imposed else row.half_angle if second else row.blocks
        cells = [name, *(_cell(row, column) for column in columns), thickness(row.exact, "exact")]
        rows.append([*cells, *([row.blocks] if second else []), escape(row.values["ours, rigid"].hinge)])
    page.table(
        f"<strong>{escape(table.title)}.</strong> Critical thickness ratio; below it the "
        "deviation from the exact polygon value in percent; in parentheses how far the paper's "
        "DDA lies from that theory." + (" Theories: &eta;(&beta;); Heyman's is that of CCR." if imposed else ""),
        head,
        rows,
        anchor=table.name,
    )


def _cell(row: Row, column: str) -> str:
    """A thickness and its error; nothing where the column has no such arch."""
    value = row.values.get(column)
    if value is None:
        return ""
    places = _PLACES.get(column, 2)
    # plus nothing, so that a rounded -0 is 0
    below = "" if value.error is None else f"{round(100.0 * value.error, places) + 0.0:+.{places}f}"
    paper = row.values["paper DDA"].eta
    if column in THEORIES.values() and value.eta and paper:
        below += f" ({100.0 * (paper / value.eta - 1.0):+.2f})"
    return f"{value.digits(column)}<small>{below}</small>"


def _modes(page: Page, campaign: Campaign) -> None:
    """The modes of figure 8 in words."""
    paper = {0: "purely sliding", 10: "mainly sliding", 20: "mixed", 30: "purely rotational"}
    rows = [
        [
            f"{row['friction_deg']:g}", f"{math.tan(math.radians(row['friction_deg'])):.3f}",
            paper.get(int(row["friction_deg"]), ""), escape(row["collapse_mode"]), f"{row['sliding_share']:.4f}",
            _joined(row["intrados_hinge_deg"]), _joined(row["extrados_hinge_deg"])]
        for row in campaign.results("figure8").cases.rows()
    ]
    page.table(
        "Collapse modes of Fig. 8",
        ["&phi; [deg]", "&mu;", "paper", "ours", "sliding share", "intrados hinges [deg]", "extrados hinges [deg]"],
        rows, anchor="modes")


def _thresholds(page: Page, campaign: Campaign) -> None:
    """The two friction thresholds."""
    limits = theory.friction("ccr")
    rows = []
    for deck, words, cited, continuous in (
        ("figure8_lower", "stands at no thickness below", "0.309, 0.31", limits["mu_mixed"]),
        ("figure8_upper", "no joint slips from", "0.395, 0.396", limits["mu_rotational"]),
    ):
        for row in campaign.results(deck).cases.rows():
            exact = findings.exact_threshold(row["blocks"], row["thickness_ratio"])
            rows.append(
                [
                    words, f"{row['blocks']}", f"{row['critical']:.6f}",
                    f"{math.tan(math.radians(row['critical'])):.7f}", f"{math.tan(math.radians(exact)):.7f}",
                    f"{continuous:.7f}", cited]
            )
    page.table(
        "Friction thresholds of the semicircle",
        [
            "", "blocks", "&phi; [deg]", "&mu;, ours", "&mu;, exact polygon", "&mu;, continuous arch",
            "cited by the paper"],
        rows,
        anchor="thresholds",
    )


def _hinges_of_figure_10(page: Page, campaign: Campaign) -> None:
    """The points of figure 10 as numbers."""
    rigid, elastic = (campaign.results(deck).cases for deck in ("figure10", "figure9"))
    rows = [
        [f"{row['blocks']}", f"{row['thickness_ratio']:g}", f"{row['exact']:.7f}", _outcome(row), _outcome(other)]
        for row, other in zip(rigid.rows(), elastic.rows())
    ]
    page.table(
        "Intrados hinges of Figs. 9 and 10 [deg]; critical: exact thickness of the polygons",
        ["blocks", "&eta;", "critical", "rigid", "elastic"], rows, anchor="hinges9")


def _outcome(row: dict[str, Any]) -> str:
    """Hinges of an arch that falls, else its verdict."""
    return _joined(row["intrados_hinge_deg"]) if row["verdict"] == "collapsed" else row["verdict"]


def _joined(angles: tuple[float, ...]) -> str:
    return "; ".join(f"{angle:g}" for angle in angles) or "none"


def _hinges_of_table_4(page: Page, campaign: Campaign) -> None:
    """The hinge columns of table 4."""
    table = campaign.tables["table4"]
    columns = [column for column in table.columns if column not in THEORIES.values()]
    page.table(
        "Table 4, hinge angles &beta; [deg]; below the theories how far the paper's DDA lies from them [%]",
        ["&alpha; [deg]", "exact polygon", *map(escape, columns), *THEORIES.values()],
        [_hinge_row(row, columns) for row in table.rows], anchor="hinges4")


def _hinge_row(row: Row, columns: list[str]) -> list[str]:
    cells = [row.half_angle, _joined(tuple(findings.exact_hinges(row)))]
    cells += [escape(row.values[column].hinge) if column in row.values else "" for column in columns]
    paper = float(row.values["paper DDA"].hinge)
    for heading in THEORIES.values():
        beta = row.values[heading].hinge
        cells.append(f"{beta}<small>{100.0 * (paper / float(beta) - 1.0):+.2f}</small>")
    return cells


def _theory(page: Page, figures: Path) -> None:
    """Figures 1 to 7."""
    page.section("Section 2: the theory", "theory")
    page.text("Figures 1 to 7 of the paper, drawn from the analytic solutions.")
    for number, words in enumerate(THEORY_CAPTIONS, 1):
        svg = figures / f"figure{number}.svg"
        if svg.is_file():
            page.figure(svg, f"Fig. {number}: {words}.", f"figure{number}")


def _decks(page: Page, campaign: Campaign) -> None:
    """The decks as they were run."""
    page.section("Decks", "decks")
    page.text(
        "What was computed, as files for <code>dda run</code>. Each has a folder of results beside this page: "
        "<code>results.csv</code>, <code>joints.csv</code>, and where pictures were asked for <code>frames.csv</code> "
        "and <code>frames/case_N.pvd</code> for ParaView."
    )
    for file in campaign.finished_decks():
        page.listing(file.name, read_text(file))


def _version_of(package: str) -> str:
    """Version of a package that may be missing."""
    try:
        return escape(metadata.version(package))
    except metadata.PackageNotFoundError:
        return "none"


def _run(page: Page, timings: list[Timing], dda: Path) -> None:
    """Versions and times."""
    page.section("Versions and run times", "run")
    page.table(
        "Versions",
        ["program", "version"],
        [
            ["dda", escape(version_of(dda).removeprefix("dda").strip())],
            ["voussoir (Python)", voussoir.__version__],
            ["Python", platform.python_version()],
            ["NumPy", np.__version__],
            ["matplotlib", _version_of("matplotlib")],
            ["machine", escape(f"{platform.system()} {platform.machine()}")],
        ],
        anchor="versions",
        words=True,
    )
    rows = [[escape(t.part), f"{t.wall:.2f}", f"{t.computing:.2f}"] for t in timings]
    rows.append(["page", PAGE_TIME, ""])
    decks = sum(timing.wall for timing in timings if timing.part == TOGETHER)
    drawing = sum(timing.wall for timing in timings if timing.part == FIGURES)
    rows.append(["<strong>all but the page</strong>", f"{decks + drawing:.2f}", ""])
    page.table(
        "How long each part took: wall time, and processor time of the Fortran program [s]. "
        "Several decks run at the same time.",
        ["part", "wall", "processor"],
        rows,
        anchor="times",
    )
