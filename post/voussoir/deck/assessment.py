"""Assessment of an arch: verdicts, safety numbers, the worst position, load cases, assumptions."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from voussoir.dda_program import DdaError, defaults, find_dda
from voussoir.deck.run import run as run_deck
from voussoir.deck.supports import FACTOR, displacements, movement
from voussoir.deck.text import deck_text, merged
from voussoir.deck.thickness import dead_groups, given_groups, thickness_safety
from voussoir.files import read_text
from voussoir.results import Results, Table

Row = dict[str, Any]
#: Positions of the first axle in the diagram for each length of the arch that the vehicle passes, and most of them
POSITIONS, MOST_POSITIONS = 41, 121
#: Share of the least factor by which that of a fixed position may be smaller
SMALLER = 1e-6
#: Columns of a row that say its load factor
_OF_FACTOR = ("verdict", "critical", "critical_low", "critical_high", "collapses_at", "exact_low", "exact_high")
#: Name of a list of vehicles
_LIST = re.compile(r"(\blist\s*=\s*)('[^']*'|\"[^\"]*\")", re.IGNORECASE)
#: A search for displacements of supports
_SPREAD = re.compile(
    r"&search\b[^/]*?\bparameter\s*=\s*['\"](support%|load%)?(displacement_factor|(left|right)_(dx|dy|rotation_deg))",
    re.IGNORECASE)
#: Remark of a search whose load factor is the same in both directions of travel
_EITHER = re.compile(r"in either direction(?:, with the leftmost axle at \S+ m \(\w+\) or (\S+) m)?")
_TRUE = re.compile(r"\bworst\s*=\s*\.?t\w*\.?", re.IGNORECASE)


@dataclass
class Assessment:
    """All that the page of one deck needs."""

    deck: Path  #: The deck, and `text`, what stands in it
    text: str
    own: Results  #: The run of the loads given
    dead: Row  #: Row of the run without live loads
    #: The search for the load factor, and its row, corrected by fixed positions that are worse
    found: Results | None
    factor: Row | None
    safety: tuple[float, str]  #: Thickness over critical thickness, and how it was found
    axles: list[tuple[float, float]]  #: Places and weights of the axles [m, N/m]
    positions: Table | None  #: Load factors along the road
    spread: Results | None = None  #: The search for displacements of supports of the deck

    @property
    def row(self) -> Row:
        """Row of the run of the loads given."""
        return self.own.case(1)

    @property
    def place(self) -> float:
        """The worst position [m], NaN where none is sought."""
        return math.nan if self.factor is None else float(self.factor.get("worst_position", math.nan))

    @property
    def other_place(self) -> float:
        """The worst position in the other direction [m], NaN where the load factor is larger there."""
        if self.found is None or self.place != self.found.case(1)["worst_position"]:
            return math.nan
        remark = _EITHER.search(read_text(self.found.folder / "log.txt"))
        return math.nan if remark is None else float(remark[1] or self.place)

    @property
    def movements(self) -> list[str]:
        """Displacements of the supports that the deck prescribes, in words."""
        scale = float(self.own.setting(f"load%{FACTOR}") or 1.0)
        return [movement(name, scale * value) for name, value in displacements(self.own).items() if scale]

    @property
    def title(self) -> str:
        """Title of the deck, or its name."""
        return self.own.setting("scene%title") or self.deck.stem

    @property
    def surface(self) -> float | None:
        """Height of the surface of the fill, None without one [m]."""
        height = self.own.setting("fill%height")
        free = np.vstack([block.corners for block in self.own.blocks_of(1) if block.state != "fixed"])
        return None if height is None else float(free[:, 1].max()) + float(height)

    def value(self, name: str) -> str | None:
        """A key as the deck has it, else its default; None where it has none."""
        given = self.own.setting(name)
        return given if given is not None else defaults(find_dda()).get(name)


def assess(text: str, deck: Path, full: bool = True) -> Assessment:
    """Compute what the page of a deck says; without `full` neither the critical thickness nor the dead load alone."""
    whole = _LIST.sub(lambda match: f"{match[1]}'{(deck.parent / match[2][1:-1]).absolute()}'", text)
    bare = without(whole, "search")
    found, factor = load_search(bare)
    if found is not None and any(found.setting(f"vehicle%{name}") for name in ("effective_width", "convoy")):
        bare = axles_alone(bare, found)
    place = math.nan if factor is None else factor.get("worst_position", math.nan)
    fixed, way = _at_position(bare, place), _turned(found)
    own = run_deck(fixed, **way)
    steps = [float(word) for word in own.settings("vehicle%spacings")]
    start = float(own.setting("vehicle%position") or "nan")
    axles = [(start + sum(steps[:k]), float(weight)) for k, weight in enumerate(own.settings("vehicle%axles"))]
    safety = thickness_safety(own) if full else (math.nan, "not sought")
    own.cases["safety_thickness"][0] = safety[0]
    free = np.vstack([block.corners for block in own.blocks_of(1) if block.state != "fixed"])
    flow = {"analysis%flow": "associated"} if slides(own) else {}
    cases = _positions(fixed, free[:, 0], steps, place, {**way, **flow}) if axles else None
    factor = least_of(factor, cases)
    if factor is not None:  # the title has the factor of the page
        own.cases["critical"][0] = factor["critical"]
    dead = own.case(1)
    if full and (factor is not None or displacements(own)):
        dead = run_deck(merged(dead_groups(own, dead), {})).case(1)
    spread = run_deck(whole) if full and displacements(own) and _SPREAD.search(re.sub(r"!.*", "", text)) else None
    return Assessment(deck, text, own, dead, found, factor, safety, axles, cases, spread)


def axles_alone(text: str, run: Results) -> str:
    """A deck whose vehicle is that of its run: axles per metre of depth, without list, convoy and width."""
    kept = ("axles", "spacings", "length", "position", "worst", "both_directions")
    keys = {name: value for name, value in given_groups(run)["vehicle"].items() if name in kept}
    return without(text, "vehicle") + "\n" + deck_text({"vehicle": keys})


def without(text: str, *groups: str) -> str:
    """A deck without some of its groups."""
    for group in groups:
        whole = rf"&{group}\b(?:[^/'\"]|'[^']*'|\"[^\"]*\")*/"
        text = re.sub(whole, lambda match: "\n" * match[0].count("\n"), text, flags=re.IGNORECASE)
    return text


def load_search(text: str) -> tuple[Results | None, Row | None]:
    """Search the load factor of a deck with live loads: the run and its row; neither without live loads."""
    if not re.search(r"^\s*&(live|vehicle)\b", text, re.IGNORECASE | re.MULTILINE):
        return None, None
    found = run_deck(text + "\n&search parameter = 'load_factor' /\n")
    return found, found.case(1)


def least_of(factor: Row | None, cases: Table | None) -> Row | None:
    """The row of the search for the load factor, or what a fixed position says against it."""
    if factor is None or cases is None or math.isnan(factor["worst_position"]):
        return factor
    reached = {"stable": math.inf, "collapsed": 0.0}
    for row in cases.rows():
        falls = row["verdict"] == "collapsed" or row["verdict"] == "found" and row["collapses_at"] == "low"
        value = 0.0 if falls else row["critical"]
        verdict = str(factor["verdict"])
        known = reached[verdict] if verdict in reached else float(factor["critical"])
        if not value < (1.0 - SMALLER) * known:
            continue
        factor = {**factor, **{name: row[name] for name in _OF_FACTOR}, "worst_position": row["position"]}
        if falls:
            factor["verdict"] = "collapsed"
    return factor


def slides(run: Results) -> bool:
    """Return true if rings slide on one another: a loading path for every position would take too long."""
    return int(run.setting("arch%rings") or 1) > 1


def _at_position(text: str, place: float) -> str:
    """The deck with its vehicle at the worst position, where it asks for that; where none is worst, half way."""
    if not _TRUE.search(re.sub(r"!.*", "", text)):
        return text
    return _TRUE.sub(f"position = {0.0 if math.isnan(place) else float(place)!r}", text)


def _turned(found: Results | None) -> dict[str, Any]:
    """Keys of a vehicle that stands worst as it drives the other way; none of one that drives as the deck says."""
    if found is None or found.case(1).get("worst_direction", "") != "backward":
        return {}
    lists = {name: [float(word) for word in found.settings(name)[::-1]] for name in ("vehicle%axles",
                                                                                    "vehicle%spacings")}
    return {name: values for name, values in lists.items() if values}


def _positions(text: str, x: np.ndarray, steps: list[float], worst: float, flow: dict[str, Any]) -> Table | None:
    """Load factors along the road, and at the worst position if there is one: it may lie where they jump, as the arch
    begins to lean against the fill of its other side. Nothing where no position can be computed.
    """
    low, high = float(x.min()) - sum(steps), float(x.max())
    count = min(MOST_POSITIONS, round(POSITIONS * (high - low) / float(np.ptp(x))))
    # axles that only the ground carries are refused: the ends are drawn in until all stand on the arch
    for inset in (0.02, 0.05, 0.1):
        reach = inset * (float(x.max()) - float(x.min()))
        places = np.linspace(low + reach, high - reach, count)
        places = np.sort(np.append(places, worst if low + reach < worst < high - reach else []))
        values = ", ".join(repr(float(place)) for place in places)
        try:
            return run_deck(
                f"{text}\n&search parameter = 'load_factor' /\n&sweep parameter = 'position', values = {values} /\n",
                **flow).cases
        except DdaError:
            continue
    return None
