"""What stands above the picture of a case: the deck's title, what was swept, how it ended."""

from __future__ import annotations

import math
from typing import Any

from voussoir.deck.supports import FACTOR, critical_movement, displacements, uncertainty
from voussoir.plot.units import force_unit, name_of, quantity, value_label
from voussoir.results import Results

Row = dict[str, Any]


def title_of(row: Row, run: Results | None = None) -> str:
    """The deck's title if it has one, the distinction of the case, its verdict: a line each."""
    title = run.setting("scene%title") if run is not None else None
    given = ", ".join(_given(row, run))
    if run is not None and len(run.cases) > 1:
        given = f"Case {row['case']} of {len(run.cases)}: {given}"
    lines = [title, given, *_ending(row, run).split("\n")]
    plain = [line.replace("$", r"\$") for line in lines if line]  # dollars are no formulas
    return "\n".join(line[0].upper() + line[1:] for line in plain)


def _given(row: Row, run: Results | None) -> list[str]:
    """What the case is made of, swept values first."""
    names = list(row)
    own = names[names.index("case") + 1 : names.index("blocks")]
    swept = [name.rpartition("%")[2] for name in run.swept] if run is not None else []
    first = [name for name in (*swept, *own) if name in row]
    given = {name: value_label(name, row[name]) for name in first}
    for name in ("half_angle_deg", "thickness_ratio", "friction_deg"):
        if not math.isnan(row[name]):
            given.setdefault(name, value_label(name, row[name]))
    if not {"voussoirs", "blocks"} & set(given):
        given["blocks"] = f"{row['blocks']} block" + ("" if row["blocks"] == 1 else "s")
    return list(given.values())


def _ending(row: Row, run: Results | None) -> str:
    """The verdict and its numbers."""
    end = str(row["verdict"])
    if end == "found":
        end = _critical(row, run)
    if end == "collapsed" and run is not None and displacements(run) and -1.0 < row.get("path_time", math.nan) < 0.0:
        end += f" at {1.0 + row['path_time']:.1%} of the displacement of the supports".replace("%", " %")
    if end == "stable":
        end += safety_of(row, run)
    if row["collapse_mode"] != "none":
        end += f", {row['collapse_mode']} collapse"
    moves = run is not None and (run.searched == FACTOR or bool(displacements(run)))
    if row["verdict"] == "found" and moves and not math.isnan(row["path_time"]):
        end += "\nDrawn: last equilibrium before it"
    return end


def _critical(row: Row, run: Results | None) -> str:
    """The critical value; of a search for displacements of supports, these displacements."""
    if run is not None and (moved := critical_movement(run, row["critical"])):
        known = uncertainty(row["critical_low"], row["critical_high"])
        return f"collapse with the {' and the '.join(moved)}{f' ({known})' if known else ''}"
    words, unit = name_of(run.searched if run is not None and run.searched else "value")
    space = "" if unit == "°" else " "
    text = f"critical {words}: {row['critical']:.4g}{space if unit else ''}{unit}"
    return text if math.isnan(row["exact"]) else f"{text}, exact {row['exact']:.4g}"


def safety_of(row: Row, run: Results | None) -> str:
    """The known safety numbers of a stable case."""
    words = ""
    names = ("safety_thickness", "critical", "exact_low")
    safety, factor, limit = (row.get(name, math.nan) for name in names)
    if math.isinf(safety):
        words += ", at any smaller thickness, too"
    elif not math.isnan(safety):
        words += f", thickness {safety:.3g} × critical"
    if not math.isnan(factor):
        words += f", load factor {factor:.3g}"
    elif not math.isnan(limit):  # of limit analysis: joints that slide may fall before
        words += f", load factor at most {limit:.3g}"
    thrust = thrust_of(row, force_unit(run))
    return f"{words}, thrust {thrust}" if thrust else words


def thrust_of(row: Row, unit: str) -> str:
    """The range of thrust in words, empty where neither end is known.

    Examples
    --------
    >>> thrust_of({"thrust_min": 1200.0, "thrust_max": math.nan}, "N/m")
    'of at least 1.2 kN/m'
    """
    least, most = (row.get(name, math.nan) for name in ("thrust_min", "thrust_max"))
    if math.isnan(least) and math.isnan(most):
        return ""
    if math.isnan(most):
        return f"of at least {quantity(least, unit)}"
    if math.isnan(least):
        return f"of at most {quantity(most, unit)}"
    return f"{quantity(least, unit)} to {quantity(most, unit)}"
