"""Assumptions of an assessment and meanings of its numbers, in sentences."""

from __future__ import annotations

import math

from voussoir.deck.assessment import Assessment
from voussoir.deck.supports import critical_movement, uncertainty
from voussoir.plot.case_title import thrust_of
from voussoir.plot.units import digits, force_unit, quantity
from voussoir.results import Results

#: The passive pressure and the spread of fill are named where they are not 0
_NONE = ("0", "0.0")


def assumptions_of(found: Assessment) -> list[str]:
    """Assumptions of a deck, each in a sentence."""
    value = found.value
    lune = value("arch%lune_deg")
    lines = [
        "The section is a lune of the dome; hoop forces are left out." if lune else
        "The section is plane: loads and forces are per metre of depth."]
    if value("analysis%geometry") == "current":
        young = quantity(float(value("material%young") or 0.0), "Pa")
        lines.append(f"Blocks move and strain: Young's modulus {young}.")
    else:
        lines.append("Blocks are rigid and displacements small"
                     + ("." if found.movements else "; supports do not move."))
        if found.movements:
            lines.append("The arch keeps its shape while its supports move: their displacements select the forces.")
    if found.movements:
        words = "" if found.spread is None else "; they grow in proportion until the collapse"
        lines.append(f"Prescribed displacements: {', '.join(found.movements)}{words}.")
    tension, cohesion = (float(value(f"joint%{name}") or 0.0) for name in ("tension", "cohesion"))
    joints = "no tension" if tension == 0.0 else f"tension up to {quantity(tension, 'Pa')}"
    joints += f"; friction angle {quantity(float(value('joint%friction_deg') or 0.0), '°')}"
    joints += f"; cohesion {quantity(cohesion, 'Pa')}" if cohesion else ""
    lines.append(f"Joints carry {joints}.")
    rule = "associated: joints open as they slide, an upper bound" if value("analysis%flow") == "associated" else (
        "Coulomb: joints slide without opening, on the loading path dead loads first, then live loads")
    lines.append(f"Flow rule: {rule}.")
    strength = value("material%compressive_strength")
    lines.append(
        f"Joints crush at {quantity(float(strength), 'Pa')}." if strength else
        "Compressive strength is unlimited: crushing is not checked.")
    weight = value("material%unit_weight")
    unit = float(weight) if weight else float(value("material%density") or 0.0) * float(value("load%gravity") or 0.0)
    lines.append(f"Unit weight of the masonry {quantity(unit, 'N/m³')}.")
    if found.found is not None and (width := found.found.setting("vehicle%effective_width")):
        load = sum(float(word) for word in found.found.settings("vehicle%axles"))
        name = found.found.setting("vehicle%name") or "The vehicle"
        lines.append(
            f"{name} weighs {quantity(load * float(width), 'N')}; an effective width of {quantity(float(width), 'm')} "
            "carries it.")
    return lines + fill_of(found)


def fill_of(found: Assessment) -> list[str]:
    """Assumptions about the fill."""
    value = found.value
    height = found.own.setting("fill%height")
    if height is None:
        return ["There is no fill: live loads act on the blocks below them."]
    weight = quantity(float(value("fill%unit_weight") or 0.0), "N/m³")
    lines = [f"Fill to {quantity(float(height), 'm')} above the extrados, unit weight {weight}, is dead weight."]
    spread = float(value("fill%spread") or 0.0)
    lines.append(
        f"Axles spread through the fill to either side by {spread:.3g} of the depth." if spread else
        "Axles do not spread through the fill.")
    passive, share = (found.own.setting(f"fill%passive_{name}") for name in ("coefficient", "share"))
    if share not in (None, *_NONE):
        lines.append(f"The fill resists with up to {float(share or 0.0):.3g} of Rankine's passive pressure.")
    elif passive not in (None, *_NONE):
        lines.append(f"The fill resists with up to {float(passive or 0.0):.3g} times the pressure of its own weight.")
    else:
        lines.append("The fill gives no horizontal resistance.")
    if found.own.setting("fill%backing_height"):
        height = quantity(float(found.own.setting("fill%backing_height") or 0.0), "m")
        lines.append(f"Backing up to {height} above the left springing is rigid masonry.")
    return lines


def numbers_of(found: Assessment) -> list[tuple[str, str, str]]:
    """The safety numbers: name, value with unit, meaning in a sentence."""
    safety, note = found.safety
    rows = []
    if math.isfinite(safety):
        meaning = f"Under dead load the arch collapses when it is {digits(safety)} times thinner."
        rows.append(("Geometric safety factor", digits(safety), meaning))
    else:
        rows.append(("Geometric safety factor", "any" if math.isinf(safety) else "not known", note + "."))
    rows += factor_rows(found)
    rows += spread_rows(found)
    if thrust := thrust_of(found.row, force_unit(found.own)):
        rows.append((
            "Thrust at the crown", thrust,
            "Every horizontal thrust in this range is in equilibrium with the loads given; supports must bear the "
            "least."))
    return rows


def spread_rows(found: Assessment) -> list[tuple[str, str, str]]:
    """The displacement of the supports at the collapse, where the deck searches for it."""
    name = "Displacement at collapse"
    if found.spread is None:
        return []
    row = found.spread.case(1)
    if row["verdict"] == "found":
        low, high = (" and ".join(critical_movement(found.spread, row[f"critical_{end}"])) for end in ("low", "high"))
        return [(name, " and ".join(critical_movement(found.spread, row["critical"])),
                 f"Equilibrium with the {low}; collapse with the {high}.")]
    return [(name, str(row["verdict"]), "The search found no displacement between search%low and search%high.")]


def factor_rows(found: Assessment) -> list[tuple[str, str, str]]:
    """The load factor, its bounds, and the worst position."""
    factor = found.factor
    if factor is None:
        return [("Load factor", "none", "There are no live loads.")]
    words = {"stable": "unlimited", "collapsed": "0", "found": digits(factor["critical"])}
    meaning = {
        "stable": "No multiple of the live loads makes the arch collapse.",
        "collapsed": "The dead loads alone make the arch collapse.",
        "found": "The arch collapses when the live loads are multiplied by this; below 1 it does not carry them.",
    }
    verdict = str(factor["verdict"])
    rows = [("Load factor", words.get(verdict, verdict), meaning.get(verdict, "The search found no factor."))]
    low, high = factor["exact_low"], factor["exact_high"]
    if not math.isnan(high):
        same = math.isnan(low) or digits(low) == digits(high)
        rows.append((
            "Load factor by limit analysis", digits(high) if same else f"{digits(low)} to {digits(high)}",
            "Certified for joints that open as they slide; real joints may collapse below it."))
    if not math.isnan(found.place):
        rows.append(("Worst position", quantity(found.place, "m"), position_of(found, factor["worst_direction"])))
    return rows


def position_of(found: Assessment, way: str) -> str:
    """The meaning of the worst position, and that of the other direction if the load factor is the same there."""
    least, other = "The load factor is least with the leftmost axle here", found.other_place
    if math.isnan(other):
        return f"{least}, driving {way}."
    if other == found.place:
        return f"{least}, in either direction."
    turned = "forward" if way == "backward" else "backward"
    return f"{least}, driving {way}; it is the same at {quantity(other, 'm')}, driving {turned}."


def cases_of(found: Assessment) -> list[tuple[str, ...]]:
    """The load cases: what acts, live load, verdict, load factor, thrust; the heads first."""
    unit = force_unit(found.own)
    heads = ("Load case", f"Live load [k{unit}]", "Verdict", "Load factor [-]", f"Thrust at the crown [k{unit}]")
    dead = "Dead load of masonry" + (" and fill" if found.own.setting("fill%height") else "")
    rows: list[tuple[str, ...]] = [heads, (dead, "0", str(found.dead["verdict"]), "-", thrust_range(found.dead))]
    if found.movements and found.spread is None:
        moved = f"{dead}, {', '.join(found.movements)}"
        rows.append((moved, "0", str(found.row["verdict"]), "-", thrust_range(found.row)))
    if found.spread is not None and found.spread.case(1)["verdict"] == "found":
        row = found.spread.case(1)
        words = f"{dead}, {', '.join(critical_movement(found.spread, row['critical']))}"
        mode = f"collapses, {row['collapse_mode']}" if row["collapse_mode"] != "none" else "collapses"
        rows.append((words, "0", mode, "-", "-"))
    if found.factor is None:
        return rows
    live = sum(weight for _, weight in found.axles)
    live += sum(abs(float(word)) for word in found.own.settings("live%fy"))
    where = f", leftmost axle at {quantity(found.axles[0][0], 'm')}" if found.axles else ""
    rows.append((
        f"Live loads as given{where}", digits(live / 1e3), str(found.row["verdict"]), "1", thrust_range(found.row)))
    if found.factor["verdict"] == "found":
        critical = found.factor["critical"]
        mode = found.found.case(1)["collapse_mode"] if found.found is not None else "none"
        words = f"collapses, {mode}" if mode != "none" else "collapses"
        total = digits(live * critical / 1e3)
        rows.append(("Live loads multiplied to collapse", total, words, digits(critical), "-"))
    return rows


def spread_verdict(found: Assessment, spread: Results) -> tuple[str, bool]:
    """The verdict on supports that move until the structure collapses."""
    row = spread.case(1)
    dead = {"stable": "is stable", "collapsed": "collapses"}.get(found.dead["verdict"], "is undecided")
    text = f"The structure {dead} under its dead load."
    if row["verdict"] == "found":
        known = uncertainty(row["critical_low"], row["critical_high"])
        moved = " and the ".join(critical_movement(spread, row["critical"]))
        text += f" It collapses when the supports move: {moved}{f' ({known})' if known else ''}."
    else:
        text += f" The search for the displacement of the supports is {row['verdict']} in its whole range."
    return text, found.dead["verdict"] != "stable" or row["verdict"] not in ("found", "stable")


def thrust_range(row: dict[str, object]) -> str:
    """Least and greatest thrust in thousands."""
    ends = [row.get(name, math.nan) for name in ("thrust_min", "thrust_max")]
    texts = ["-" if math.isnan(end) else f"{digits(end / 1e3)}" for end in ends if isinstance(end, float)]
    return " to ".join(texts) if set(texts) != {"-"} else "-"


def verdict_of(found: Assessment) -> tuple[str, bool]:
    """The verdict in a sentence, and whether it is a bad one."""
    own, factor = found.row, found.factor
    words = {
        "stable": "The structure is stable under the given loads.",
        "collapsed": "The structure collapses under the given loads.",
    }
    if found.spread is not None:
        return spread_verdict(found, found.spread)
    text = words.get(own["verdict"], f"The calculation is {own['verdict']}: no answer is given.")
    if found.movements:
        text = text.replace("under the given loads", f"with the {' and the '.join(found.movements)}")
        if own["verdict"] == "collapsed" and -1.0 < own["path_time"] < 0.0:
            text = text.removesuffix(".") + f"; it falls at {100.0 * (1.0 + own['path_time']):.3g} % of that."
    if factor is not None and factor["verdict"] == "found":
        text += f" It collapses when the live loads are multiplied by {digits(factor['critical'])}."
    elif factor is not None and factor["verdict"] == "stable":
        text += " No multiple of the live loads makes it collapse."
    elif factor is not None and factor["verdict"] == "collapsed" and not math.isnan(factor["worst_position"]):
        text += f" Its dead loads alone make it collapse with the vehicle at {quantity(factor['worst_position'], 'm')}."
    elif factor is not None:
        text += f" The search for the load factor is {factor['verdict']}."
    return text, own["verdict"] != "stable" or factor is not None and factor["verdict"] == "collapsed"
