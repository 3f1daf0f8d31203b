"""How thick an arch is over the least thickness with which it stands."""

from __future__ import annotations

import math
from typing import Any

from voussoir.deck.run import run as run_deck
from voussoir.deck.supports import FACTOR
from voussoir.deck.text import groups_of, merged, value_of
from voussoir.dda_program import DdaError, find_dda
from voussoir.results import Results

#: How far the search for the critical thickness goes below the thickness
THINNEST = 1e-3
#: Thickness over radius of a deck that gives none
DEFAULT_RATIO = 0.15
#: Shares of both thicknesses of a tapered arch that are decided at once, and how often between the last two
SHARES, ROUNDS = 20, 6
#: Groups that say nothing of an arch under its dead load
_OTHERS = ("scene", "output", "search", "live", "vehicle", "support")


def thickness_safety(run: Results, number: int = 1) -> tuple[float, str]:
    """Thickness over the least with which an arch stands under its dead load, and what that is, or why it is not known.

    It is infinite where no smaller thickness falls, NaN where it is not known.
    """
    row = run.case(number)
    factor = float(row.get("safety_thickness", math.nan))
    if not math.isnan(factor):
        return factor, "thickness over the exact critical thickness of the same voussoirs"
    groups = dead_groups(run, row)
    arch = groups.get("arch", {})
    if "crown_thickness" in arch:
        return tapered_safety(groups)
    name = "thickness" if "thickness" in arch else "thickness_ratio"
    value = float(arch.get(name, DEFAULT_RATIO))
    search = {"parameter": name, "low": value * THINNEST, "high": value}
    try:
        found = run_deck(merged(groups, {"search": search})).case(1)
    except DdaError as error:
        return math.nan, f"not found: {str(error).rpartition('error: ')[2]}"
    if found["verdict"] == "found":
        between = ends_of(found["critical_low"], found["critical_high"])
        return value / found["critical"], f"under dead load; the critical {name} lies between {between}"
    if found["verdict"] == "stable":
        return math.inf, f"stable under dead load at any smaller {name} down to a thousandth"
    return math.nan, f"not found: the search for the critical {name} under dead load is {found['verdict']}"


def tapered_safety(groups: dict[str, Any]) -> tuple[float, str]:
    """The same of an arch of two thicknesses, both of which change in proportion."""
    names = ("crown_thickness", "springing_thickness")
    ends = (THINNEST, 1.0)
    for _ in range(ROUNDS):
        shares = [ends[0] * (ends[1] / ends[0]) ** (k / (SHARES - 1)) for k in range(SHARES)]
        sweeps = [{"parameter": f"arch%{name}", "values": [share * float(groups["arch"][name]) for share in shares],
                   "linked": name == names[1]} for name in names]
        try:
            verdicts = list(run_deck(merged(groups, {"sweep": sweeps})).cases["verdict"])
        except DdaError as error:
            return math.nan, f"not found: {str(error).rpartition('error: ')[2]}"
        if all(verdict == "stable" for verdict in verdicts):
            return math.inf, "stable under dead load at any proportionally smaller thickness down to a thousandth"
        last = max(k for k, verdict in enumerate(verdicts) if verdict != "stable")
        if last == SHARES - 1 or verdicts[last] == "undecided":
            return math.nan, "not found: a decision at smaller thicknesses in proportion is undecided"
        ends = (shares[last], shares[last + 1])
    between = ends_of(1.0 / ends[1], 1.0 / ends[0])
    return 1.0 / ends[1], f"under dead load, both thicknesses in proportion; it lies between {between}"


def given_groups(run: Results) -> dict[str, Any]:
    """Groups of a deck with the keys that it gives."""
    groups: dict[str, Any] = {}
    for name in run.given:
        group, _, key = name.partition("%")
        values = [value_of(word) for word in run.settings(name)]
        groups.setdefault(group, {})[key] = values[0] if len(values) == 1 else values
    return groups


def dead_groups(run: Results, row: dict[str, Any]) -> dict[str, Any]:
    """Groups of a deck for one of its cases, with swept values, without live loads and moved supports."""
    groups = given_groups(run)
    swept = {name: row[name.rpartition("%")[2]] for name in run.swept if name.rpartition("%")[2] in row}
    if swept:
        groups = merged(groups, groups_of(find_dda(), swept))
    groups.get("load", {}).pop(FACTOR, None)
    return {group: keys for group, keys in groups.items() if group not in _OTHERS}


def ends_of(low: float, high: float) -> str:
    """The ends of an interval with as many digits as distinguish them.

    Examples
    --------
    >>> ends_of(0.25, 0.2500001)
    '0.25 and 0.2500001'
    """
    digits = next((n for n in range(6, 17) if f"{low:.{n}g}" != f"{high:.{n}g}"), 17)
    return f"{low:.{digits}g} and {high:.{digits}g}"
