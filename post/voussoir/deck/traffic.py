"""Vehicles of a list on an arch: axle loads per metre of depth by an effective width, convoys, the worst position."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from voussoir.deck.assessment import Assessment, Row, assess, without
from voussoir.deck.run import run as run_deck
from voussoir.deck.text import deck_text
from voussoir.dda_program import defaults, find_dda, find_input
from voussoir.files import read_text

#: Columns of a list of vehicles; the others may be missing
NEEDED = ("name", "axles_kN", "spacings_m")
#: Track, width and length of a wheel that a list leaves out [m]
USUAL = {"track_m": 1.8, "wheel_width_m": 0.3, "length_m": 0.3}
#: Rules of the effective width w [m]: t is the track, b the width of a wheel, s the spread, h the depth of fill
RULES = {
    "wheels": "w = b + 2 s h + min(t, b + 2 s h): both wheels spread by s of the depth h of fill to either side",
    "cs454": "w = 1.5 m + h: one strip per axle, UK CS 454 (formerly BD 21)",
}


@dataclass(frozen=True)
class Vehicle:
    """A vehicle of a list.

    Attributes
    ----------
    name, source : str
        Its name, and where its numbers come from.
    axles : tuple of float
        Weight of each axle [N], from the first to the last.
    spacings : tuple of float
        Distances between them [m].
    track, wheel, length : float
        Distance of the middles of the wheels of an axle, width and length of a wheel on the road [m].
    """

    name: str
    axles: tuple[float, ...]
    spacings: tuple[float, ...]
    track: float
    wheel: float
    length: float
    source: str = ""

    def convoy(self, count: int, gap: float) -> Vehicle:
        """So many of these one behind the other, their last and first axles a distance apart [m]."""
        spacings = self.spacings
        for _ in range(count - 1):
            spacings = (*spacings, gap, *self.spacings)
        name = self.name if count == 1 else f"{count} x {self.name}, {gap:g} m apart"
        return Vehicle(name, self.axles * count, spacings, self.track, self.wheel, self.length, self.source)

    def width(self, depth: float, spread: float, rule: str = "wheels", barrel: float = math.inf) -> float:
        """Effective width by a rule, at most that of the barrel [m].

        Examples
        --------
        >>> axle = Vehicle("axle", (1e5,), (), 1.8, 0.3, 0.3)
        >>> round(axle.width(0.5, 0.5), 3), round(axle.width(2.0, 0.5), 3), axle.width(0.5, 0.5, "cs454")
        (1.6, 4.1, 2.0)
        """
        if rule == "cs454":
            return min(1.5 + depth, barrel)
        wheel = self.wheel + 2.0 * spread * depth
        return min(wheel + min(self.track, wheel), barrel)


@dataclass(frozen=True)
class Passage:
    """A vehicle, or a convoy, on an arch.

    Attributes
    ----------
    vehicle : Vehicle
        The vehicle.
    width : float
        Effective width [m].
    text : str
        The deck that was computed.
    found : Assessment
        Its worst position, its factor, and the factors along the road.
    opposite : float
        Least load factor of the better direction of travel, NaN where only one is tried.
    """

    vehicle: Vehicle
    width: float
    text: str
    found: Assessment
    opposite: float = math.nan

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
    lines = read_text(file).splitlines()
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
        for key, usual in USUAL.items():
            given = _numbers(place, key, row.get(key) or "")
            if len(given) > 1:
                raise ValueError(f"{place}expected one number as {key}, got {len(given)}")
            sizes.append(given[0] if given else usual)
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
    both: bool = True
) -> Passage:
    """Search the worst position of a vehicle on the arch of a deck, and its factors along the road.

    Parameters
    ----------
    deck : Path
        A deck with &arch; its own &vehicle and &search are left out.
    vehicle : Vehicle
        The vehicle.
    rule : str, optional
        Name of one of `RULES`.
    width, barrel : float, optional
        The effective width, if no rule gives it, and the width of the barrel that limits that of a rule [m].
    both : bool, optional
        Whether both directions of travel are tried.
    """
    text = without(read_text(deck), "vehicle", "search")
    bare = run_deck(text)
    given, usual = bare.setting("fill%height"), defaults(find_dda())
    depth = float(given) if given else 0.0
    spread = float(bare.setting("fill%spread") or usual.get("fill%spread") or 0.5) if given else 0.0
    effective = width if width is not None else vehicle.width(depth, spread, rule, barrel)
    keys: dict[str, object] = {
        "axles": [weight / effective for weight in vehicle.axles], "length": vehicle.length, "worst": True,
        "both_directions": both}
    if vehicle.spacings:
        keys["spacings"] = list(vehicle.spacings)
    bare_text = f"{text.rstrip()}\n"
    text = f"{bare_text}! {vehicle.name}: loads over an effective width of {effective:.6g} m\n"
    text += deck_text({"vehicle": keys})
    found = assess(text, deck, full=False)
    passage = Passage(vehicle, effective, text, found)
    if not both:
        return passage
    if (vehicle.axles, vehicle.spacings) == (vehicle.axles[::-1], vehicle.spacings[::-1]):
        return replace(passage, opposite=passage.factor)
    backward = (found.factor or {}).get("worst_direction") == "backward"
    other = keys | {"both_directions": False}
    for name in () if backward else ("axles", "spacings"):
        other[name] = other[name][::-1]  # type: ignore[index]
    row = run_deck(bare_text + deck_text({"vehicle": other, "search": {"parameter": "load_factor"}})).case(1)
    return replace(passage, opposite=factor_of(row))


def worst_convoy(
    deck: Path, vehicle: Vehicle, count: int, gaps: Sequence[float], **options: object
) -> tuple[Passage, list[Passage]]:
    """The passage of least factor over some gaps of a convoy, and all of them."""
    tried = [vehicle.convoy(count, gap) for gap in (gaps if count > 1 else gaps[:1])]
    passages = [pass_over(deck, each, **options) for each in tried]  # type: ignore[arg-type]
    return min(passages, key=lambda one: math.inf if math.isnan(one.factor) else one.factor), passages
