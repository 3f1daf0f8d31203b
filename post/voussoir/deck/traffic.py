"""Vehicles of a list on an arch: convoys, effective widths and the worst position, computed by `dda`."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from voussoir.deck.assessment import Assessment, Row, assess, without
from voussoir.deck.run import run as run_deck
from voussoir.deck.text import deck_text
from voussoir.dda_program import defaults, find_dda, find_input
from voussoir.files import read_text

#: Columns of a list of vehicles; the others may be missing
NEEDED = ("name", "axles_kN", "spacings_m")
#: Columns that a list may leave out, and the keys whose defaults hold then [m]
SIZES = {"track_m": "vehicle%track_width", "wheel_width_m": "vehicle%wheel_width", "length_m": "vehicle%length"}
#: Rules of the effective width w [m]: t is the track, b the width of a wheel, s the spread, h the depth of fill
RULES = {
    "wheels": "w = b + 2 s h + min(t, b + 2 s h): both wheels spread by s of the depth h of fill to either side",
    "cs454": "w = 1.5 m + h: one strip per axle, UK CS 454 (formerly BD 21)",
}


@dataclass(frozen=True)
class Vehicle:
    """A vehicle of a list."""

    name: str  #: Its name, and where its numbers come from
    axles: tuple[float, ...]  #: Weight of each axle [N], from the first to the last
    spacings: tuple[float, ...]  #: Distances between them [m]
    #: Distance of the middles of the wheels of an axle, width and length of a wheel on the road [m]
    track: float
    wheel: float
    length: float
    source: str = ""

    def keys(self, count: int, gap: float) -> dict[str, Any]:
        """Keys of &vehicle for some of these one behind the other, their last and first axles a gap apart [m]."""
        keys: dict[str, Any] = {
            "axles": list(self.axles), "length": self.length, "track_width": self.track, "wheel_width": self.wheel}
        if self.spacings:
            keys["spacings"] = list(self.spacings)
        return keys | ({"convoy": count, "convoy_gap": gap} if count > 1 else {})


@dataclass(frozen=True)
class Passage:
    """A vehicle, or a convoy, on an arch."""

    name: str  #: Name of the vehicle, or of the convoy
    weight: float  #: Sum of its axle loads [N]
    width: float  #: Effective width [m]
    text: str  #: The deck that was computed
    found: Assessment  #: Its worst position, its factor, and the factors along the road
    opposite: float = math.nan  #: Least load factor of the better direction of travel, NaN where only one is tried
    opposite_place: float = math.nan  #: The worst position in that direction [m], NaN where there is none

    @property
    def factor(self) -> float:
        """Load factor at the worst position: infinite where none makes it collapse, 0 where the dead loads do."""
        return factor_of(self.found.factor or {})


def factor_of(row: Row) -> float:
    """Load factor of a search: infinite where none makes it collapse, 0 where the dead loads do."""
    verdict = str(row.get("verdict"))
    if verdict == "found":
        return float(row["critical"])
    return {"stable": math.inf, "collapsed": 0.0}.get(verdict, math.nan)


def read_vehicles(file: Path) -> dict[str, Vehicle]:
    """Vehicles of a list by their names; ValueError with file and line where it is none."""
    lines, usual = read_text(file).splitlines(), defaults(find_dda())
    rows = csv.DictReader(lines)
    lost = [name for name in NEEDED if name not in (rows.fieldnames or [])]
    if lost:
        raise ValueError(f"{file}:1: error: expected the columns {', '.join(NEEDED)}, got none named {lost[0]}")
    vehicles: dict[str, Vehicle] = {}
    for row in rows:
        place = f"{file}:{rows.line_num}: error: "
        name = (row["name"] or "").strip()
        axles, spacings = (_numbers(place, key, row[key]) for key in ("axles_kN", "spacings_m"))
        if not name or name in vehicles:
            raise ValueError(f"{place}expected a name of its own, got '{name}'")
        if not axles or len(spacings) != len(axles) - 1:
            raise ValueError(
                f"{place}expected one spacing fewer than axles, got {len(axles)} axles and {len(spacings)} spacings")
        sizes = []
        for key, name_in_deck in SIZES.items():
            given = _numbers(place, key, row.get(key) or "")
            if len(given) > 1:
                raise ValueError(f"{place}expected one number as {key}, got {len(given)}")
            sizes.append(given[0] if given else float(usual[name_in_deck]))
        weights = tuple(1e3 * axle for axle in axles)
        source = (row.get("source") or "").strip()
        vehicles[name] = Vehicle(name, weights, spacings, sizes[0], sizes[1], sizes[2], source)
    if not vehicles:
        raise ValueError(f"{file}:1: error: expected a list of vehicles, got one without rows")
    return vehicles


def sample_list() -> Path:
    """The list that belongs to this package."""
    return find_input("traffic") / "vehicles.csv"


def _numbers(place: str, key: str, words: str | None) -> tuple[float, ...]:
    """Numbers above 0 separated by blanks."""
    found = []
    for word in (words or "").replace(";", " ").split():
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if not 0.0 < number < 1e9:
            raise ValueError(f"{place}expected numbers above 0 as {key}, got '{word[:40]}'")
        found.append(number)
    return tuple(found)


def pass_over(
    deck: Path, vehicle: Vehicle, rule: str = "wheels", width: float | None = None, barrel: float = math.inf,
    both: bool = True, count: int = 1, gap: float = 5.0
) -> Passage:
    """Search the worst position of a vehicle on the arch of a deck, and its factors along the road.

    The deck's own &vehicle and &search are left out. The rule is one of `RULES`; `width` is the effective width if no
    rule gives it, and `barrel` the width of the barrel that limits that of a rule [m]. With `both` both directions of
    travel are tried. A convoy has `count` vehicles, the last and first axles of two of them `gap` apart [m].
    """
    bare = f"{without(read_text(deck), 'vehicle', 'search').rstrip()}\n"
    name = vehicle.name if count == 1 else f"{count} x {vehicle.name}, {gap:g} m apart"
    keys = vehicle.keys(count, gap)
    if width is None:
        width = _limited_width(bare, keys, rule, barrel)
    if width is not None:
        keys["effective_width"] = width
    text = f"{bare}! {name}\n{deck_text({'vehicle': keys | {'worst': True, 'both_directions': both}})}"
    found = assess(text, deck, full=False)
    assert found.found is not None
    effective = float(found.found.setting("vehicle%effective_width") or "nan")
    passage = Passage(name, count * sum(vehicle.axles), effective, text, found)
    if not both:
        return passage
    if (vehicle.axles, vehicle.spacings) == (vehicle.axles[::-1], vehicle.spacings[::-1]):
        return replace(passage, opposite=passage.factor, opposite_place=found.place)
    if (found.factor or {}).get("worst_direction") != "backward":
        keys |= replace(vehicle, axles=vehicle.axles[::-1], spacings=vehicle.spacings[::-1]).keys(count, gap)
    other = {"vehicle": keys | {"worst": True, "both_directions": False}, "search": {"parameter": "load_factor"}}
    row = run_deck(bare + deck_text(other)).case(1)
    return replace(passage, opposite=factor_of(row), opposite_place=float(row["worst_position"]))


def _limited_width(bare: str, keys: dict[str, Any], rule: str, barrel: float) -> float | None:
    """Effective width [m] that a deck has to give: None where that by the rule of `dda` is within the barrel."""
    if rule == "cs454":
        return min(1.5 + float(run_deck(bare).setting("fill%height") or 0.0), barrel)
    if math.isinf(barrel):
        return None
    run = run_deck(bare + deck_text({"vehicle": keys | {"position": 0.0}}))
    return barrel if float(run.setting("vehicle%effective_width") or "nan") > barrel else None


def worst_convoy(
    deck: Path, vehicle: Vehicle, count: int, gaps: Sequence[float], **options: object
) -> tuple[Passage, list[Passage]]:
    """The passage of least factor over some gaps of a convoy, and all of them."""
    tried = gaps if count > 1 else gaps[:1]
    passages = [pass_over(deck, vehicle, count=count, gap=gap, **options) for gap in tried]  # type: ignore[arg-type]
    return min(passages, key=lambda one: math.inf if math.isnan(one.factor) else one.factor), passages
