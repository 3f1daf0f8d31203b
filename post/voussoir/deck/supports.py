"""Prescribed displacements of the supports of an arch, in words."""

from __future__ import annotations

import math

from voussoir.plot.units import length_text, quantity
from voussoir.results import Results

#: Directions of the keys of &support above 0 and below it
DIRECTIONS = {"dx": ("to the right", "to the left"), "dy": ("upwards", "downwards"),
              "rotation_deg": ("anticlockwise", "clockwise")}
#: Parameter that multiplies all displacements
FACTOR = "displacement_factor"


def displacements(run: Results) -> dict[str, float]:
    """Displacements of supports by their keys, such as "right_dx": those of the deck that are not 0 [m, degrees]."""
    found = {f"{side}_{kind}": float(run.setting(f"support%{side}_{kind}") or 0.0)
             for side in ("left", "right") for kind in DIRECTIONS}
    if run.searched in found:
        found[run.searched] = 1.0
    return {name: value for name, value in found.items() if value}


def movement(name: str, value: float) -> str:
    """A displacement in words.

    Examples
    --------
    >>> movement("right_dx", 2.5), movement("left_rotation_deg", -1.0)
    ('right support 2.5 m to the right', 'left support 1° clockwise')
    """
    side, _, kind = name.partition("_")
    size = quantity(abs(value), "°") if kind == "rotation_deg" else length_text(abs(value))
    return f"{side} support {size} {DIRECTIONS[kind][int(value < 0.0)]}"


def critical_movement(run: Results, critical: float) -> list[str]:
    """Displacements of the supports at the critical value of a search for them, in words; empty for other searches."""
    if run.searched == FACTOR:
        return [movement(name, value * critical) for name, value in displacements(run).items()]
    if run.searched in displacements(run):
        given = displacements(run) | {str(run.searched): critical}
        return [movement(name, value) for name, value in given.items()]
    return []


def uncertainty(low: float, high: float) -> str:
    """Half the bracket of a critical value over its middle, such as "±0.5 %"; empty where it is below 0.1 %.

    Examples
    --------
    >>> uncertainty(220.57, 222.79), uncertainty(1.0, 1.0001)
    ('±0.5 %', '')
    """
    share = 100.0 * abs(high - low) / abs(high + low) if high + low else math.nan
    return f"±{share:.1g} %" if share >= 0.1 else ""
