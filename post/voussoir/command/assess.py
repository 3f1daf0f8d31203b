"""`voussoir assess`: one printable page that says whether an arch stands, with what safety, under which axle."""

from __future__ import annotations

import argparse
import hashlib
import html
import math
import platform
import re
from pathlib import Path
from typing import Any

import numpy as np

from voussoir import __version__
from voussoir.dda_program import DdaError, find_dda
from voussoir.deck.run import run as run_deck
from voussoir.deck.thickness import ends_of, thickness_safety
from voussoir.files import read_text, write_text
from voussoir.results import Results, Table

#: Positions of the first axle in the diagram
POSITIONS = 41
#: Share of the least factor by which that of a fixed position may be smaller
SMALLER = 1e-6
#: Columns of a row that tell its load factor
_OF_FACTOR = ("verdict", "critical", "critical_low", "critical_high", "collapses_at", "exact_low", "exact_high")
#: The file that a deck is computed from
_COPY = re.compile(rf"\S*voussoir-[^/\s]+/[^:\s]+(?=:\d)|\bdeck\.nml(?=:\d)")
#: What the diagram of positions shows, of arches and of arches in rings
_POSITIONS = (
    "Factor of the live loads that brings it down.",
    "Factor of the live loads by limit analysis, an upper bound where rings slide on one another; the worst position "
    "is where it is least.",
)
_TRUE = re.compile(r"\bworst\s*=\s*\.?t\w*\.?", re.IGNORECASE)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Assess an arch: does it stand, how thick is it against the critical thickness, which load factor does it "
        "carry, where is the worst position of its vehicle. Writes one HTML page that prints."
    )
    parser.add_argument("deck", metavar="DECK", type=Path, help="deck of an arch, static, one case")
    parser.add_argument("--out", metavar="FILE", type=Path, help="the page (default: DECK with the ending .html)")


def run(arguments: argparse.Namespace) -> int:
    """Write the page."""
    out = arguments.out or arguments.deck.with_suffix(".html")
    try:
        text = read_text(arguments.deck)
        check(text, arguments.deck)
        written = assess(text, arguments.deck)
    except DdaError as error:
        raise DdaError(_COPY.sub(lambda _: str(arguments.deck), str(error))) from error
    except OSError as error:
        raise ValueError(f"expected a deck that can be read: {error.strerror}") from error
    try:
        write_text(out, written)
    except OSError as error:
        raise DdaError(f"{out}:1: error: expected a file that can be written: {error.strerror}", 4) from error
    print(out)
    return 0


def check(text: str, deck: Path) -> None:
    """Refuse decks of many cases and of other things than arches."""
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.split("!")[0].lower()
        if "&sweep" in bare:
            raise ValueError(f"{deck}:{number}: error: expected one case, got &sweep; remove it")
        if re.search(r"kind\s*=\s*['\"](lines|blocks)", bare):
            raise ValueError(f"{deck}:{number}: error: expected an arch, got another kind; assess a deck with &arch")


def without(text: str, *groups: str) -> str:
    """A deck without some of its groups, whose texts have no slashes."""
    for group in groups:
        text = re.sub(rf"&{group}\b[^/]*/", lambda match: "\n" * match[0].count("\n"), text, flags=re.IGNORECASE)
    return text


def load_search(text: str) -> tuple[Results | None, dict[str, Any] | None]:
    """Search the load factor of a deck with live loads: the run and its row; neither without live loads."""
    if not re.search(r"^\s*&(live|vehicle)\b", text, re.IGNORECASE | re.MULTILINE):
        return None, None
    found = run_deck(text + "\n&search parameter = 'load_factor' /\n")
    return found, found.case(1)


def verdict_of(own: dict[str, Any], factor: dict[str, Any] | None) -> tuple[str, bool]:
    """The verdict in a sentence, from the row of the search for the load factor, and whether it is a bad one."""
    words = {
        "stable": "The structure stands under the loads given.",
        "collapsed": "The structure does not stand under the loads given.",
    }
    text = words.get(own["verdict"], f"The calculation is {own['verdict']}: no answer is given.")
    if factor is not None and factor["verdict"] == "found":
        text += f" It falls when the live loads are multiplied by {factor['critical']:.4g}."
    elif factor is not None and factor["verdict"] == "stable":
        text += " No multiple of the live loads brings it down."
    elif factor is not None and factor["verdict"] == "collapsed" and not math.isnan(factor["worst_position"]):
        text += f" Its dead loads alone collapse it with the vehicle at {factor['worst_position']:.4g} m."
    elif factor is not None:
        text += f" The search for the load factor is {factor['verdict']}."
    return text, own["verdict"] != "stable" or factor is not None and factor["verdict"] == "collapsed"


def least_of(factor: dict[str, Any] | None, cases: Table | None) -> dict[str, Any] | None:
    """The row of the search for the load factor, or what a fixed position says against it."""
    if factor is None or cases is None or math.isnan(factor["worst_position"]):
        return factor
    for row in cases.rows():
        falls = row["verdict"] == "collapsed" or row["verdict"] == "found" and row["collapses_at"] == "low"
        value = 0.0 if falls else row["critical"]
        if not value < (1.0 - SMALLER) * {"stable": math.inf, "collapsed": 0.0}.get(
                factor["verdict"], factor["critical"]):
            continue
        factor = {**factor, **{name: row[name] for name in _OF_FACTOR}, "worst_position": row["position"]}
        if falls:
            factor["verdict"] = "collapsed"
    return factor


def assess(text: str, deck: Path) -> str:
    """Compute what the page tells, and write it."""
    from voussoir.plot.assess_page import dimensions_of, draw_scheme, figure_of, page, table_of
    from voussoir.plot.case_picture import draw_case
    from voussoir.plot.figure_style import house_style
    from voussoir.plot.position_chart import draw_positions
    from voussoir.plot.units import force_unit

    bare = without(text, "search")
    found, factor = load_search(bare)
    place = math.nan if factor is None else factor.get("worst_position", math.nan)
    fixed, way = _at_position(bare, place), _turned(found)
    own_run = run_deck(fixed, **way)
    own = own_run.case(1)
    steps = [float(word) for word in own_run.settings("vehicle%spacings")]
    start = float(own_run.setting("vehicle%position") or "nan")
    placed = [(start + sum(steps[:k]), float(weight)) for k, weight in enumerate(own_run.settings("vehicle%axles"))]
    safety = thickness_safety(own_run)
    own_run.cases["safety_thickness"][0] = safety[0]
    free = np.vstack([block.corners for block in own_run.blocks_of(1) if block.state != "fixed"])
    height = own_run.setting("fill%height")
    surface = None if height is None else float(free[:, 1].max()) + float(height)
    flow = {"analysis%flow": "associated"} if _slides(own_run) else {}
    cases = _positions(fixed, free[:, 0], steps, place, {**way, **flow}) if placed else None
    factor = least_of(factor, cases)
    if factor is not None:  # the title has the factor of the page
        own_run.cases["critical"][0] = factor["critical"]
    with house_style():
        scheme = draw_scheme(own_run, placed, surface)
        parts = [
            ("Drawing", figure_of(scheme, f"Blocks, supports (hatched), axles in place. {dimensions_of(own_run)}")),
            ("Safety", table_of(_numbers(own, factor, safety, force_unit(own_run)))),
        ]
        if cases is not None and "found" in cases["verdict"]:
            chart = draw_positions(own_run, cases, None if math.isnan(place) else place)
            parts.append(("Position of the vehicle", figure_of(chart, _POSITIONS[_slides(own_run)])))
        parts.append(("Thrust under the loads given", figure_of(draw_case(own_run, 1))))
        if found is not None and factor is not None and factor["verdict"] == "found":
            parts.append(("Collapse under the live loads multiplied", figure_of(draw_case(found, 1))))
    parts.append(("Input", f"<pre>{html.escape(text)}</pre>"))
    parts.append(("Origin", table_of(_origin(deck))))
    sentence, falls = verdict_of(own, factor)
    return page(own_run.setting("scene%title") or deck.stem, sentence, falls, parts)


def _at_position(text: str, place: float) -> str:
    """The deck with its vehicle at the worst position, where it asks for that; where none is worst, half way."""
    if not _TRUE.search(re.sub(r"!.*", "", text)):
        return text
    return _TRUE.sub(f"position = {0.0 if math.isnan(place) else float(place)!r}", text)


def _turned(found: Results | None) -> dict[str, list[float]]:
    """Keys of a vehicle that stands worst as it drives the other way; none of one that drives as the deck says."""
    if found is None or found.case(1).get("worst_direction", "") != "backward":
        return {}
    lists = {name: [float(word) for word in found.settings(name)[::-1]] for name in ("vehicle%axles",
                                                                                    "vehicle%spacings")}
    return {name: values for name, values in lists.items() if values}


def _slides(run: Results) -> bool:
    """Whether rings slide on one another, so that a loading path for every position takes too long."""
    return int(run.setting("arch%rings") or 1) > 1


def _positions(text: str, x: np.ndarray, steps: list[float], worst: float, flow: dict[str, str]) -> Table | None:
    """Load factors along the road, and at the worst position if there is one: it may lie where they jump, as the arch
    begins to lean against the fill of its other side. Nothing where no position can be computed.
    """
    low, high = float(x.min()) - sum(steps), float(x.max())
    # axles that only the ground carries are refused: the ends are drawn in until all stand on the arch
    for inset in (0.02, 0.05, 0.1):
        reach = inset * (float(x.max()) - float(x.min()))
        places = np.linspace(low + reach, high - reach, POSITIONS)
        places = np.sort(np.append(places, worst if low + reach < worst < high - reach else []))
        values = ", ".join(repr(float(place)) for place in places)
        try:
            return run_deck(
                f"{text}\n&search parameter = 'load_factor' /\n&sweep parameter = 'position', values = {values} /\n",
                **flow,
            ).cases
        except DdaError:
            continue
    return None


def _numbers(
    own: dict[str, Any], factor: dict[str, Any] | None, geometrical: tuple[float, str], unit: str
) -> list[tuple[str, str]]:
    """The three safety numbers with their bounds."""
    from voussoir.plot.case_title import thrust_of

    safety, note = geometrical
    rows = [("Geometrical safety", f"{safety:.4g}: {note}" if math.isfinite(safety) else note)]
    if factor is None:
        rows.append(("Load factor", "no live loads"))
    else:
        text = str(factor["verdict"])
        if factor["verdict"] == "found":
            text = f"{factor['critical']:.6g}, between {ends_of(factor['critical_low'], factor['critical_high'])}"
        if not math.isnan(factor["exact_high"]):
            text += f"; limit analysis (associated): between {ends_of(factor['exact_low'], factor['exact_high'])}"
        rows.append(("Load factor", text))
    if factor is not None and not math.isnan(factor.get("worst_position", math.nan)):
        way = factor["worst_direction"]
        rows.append(("Worst position", f"leftmost axle at {factor['worst_position']:.4f} m, driving {way}"))
    thrust = thrust_of(own, unit)
    rows.append(("Range of thrust", f"{thrust} at the crown" if thrust else "not told"))
    return rows


def _origin(deck: Path) -> list[tuple[str, str]]:
    """Versions and check sums."""
    program = find_dda()
    return [
        ("Deck", f"{deck.name}, SHA-256 {hashlib.sha256(deck.read_bytes()).hexdigest()}"),
        ("Program", f"voussoir {__version__}, dda SHA-256 {hashlib.sha256(Path(program).read_bytes()).hexdigest()}"),
        ("Python", f"{platform.python_version()} on {platform.system()}"),
        ("Method", "limit analysis and loading path of rigid blocks with no tension; see docs/method.md"),
    ]
