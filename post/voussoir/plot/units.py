"""Numbers with their units as figures print them."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import TYPE_CHECKING

from voussoir.dda_program import DdaError, find_dda, keys_of

if TYPE_CHECKING:
    from voussoir.results import Results

#: Words and unit of numbers that are swept or searched; others are called by their keys
PARAMETERS = {
    "half_angle_deg": ("half angle", "°"),
    "friction_deg": ("friction angle", "°"),
    "blocks": ("number of voussoirs", ""),
    "voussoirs": ("number of voussoirs", ""),
    "thickness_ratio": ("thickness over radius", ""),
    "radius": ("radius", "m"),
    "span": ("span", "m"),
    "rise": ("rise", "m"),
    "right_rise": ("rise on the right", "m"),
    "thickness": ("thickness", "m"),
    "crown_thickness": ("thickness at the crown", "m"),
    "springing_thickness": ("thickness at the springings", "m"),
    "pier_width": ("width of the piers", "m"),
    "pier_height": ("height of the piers", "m"),
    "buttress_width": ("width of the buttresses", "m"),
    "buttress_height": ("height of the buttresses", "m"),
    "rings": ("number of rings", ""),
    "spans": ("number of spans", ""),
    "lune_deg": ("angle of the lune", "°"),
    "density": ("density", "kg/m³"),
    "unit_weight": ("unit weight", "N/m³"),
    "young": ("Young's modulus", "Pa"),
    "poisson": ("Poisson's ratio", ""),
    "cohesion": ("cohesion", "Pa"),
    "tension": ("tensile strength", "Pa"),
    "gravity": ("gravity", "m/s²"),
    "gravity_direction_deg": ("direction of gravity", "°"),
    "horizontal_coefficient": ("horizontal force over weight", ""),
    "load_factor": ("load factor", ""),
    "displacement_factor": ("factor of prescribed displacements", ""),
    "water_rise": ("rise of the water", "m"),
    "position": ("position of the vehicle", "m"),
    "height": ("height of the fill", "m"),
    "depth": ("depth of the fill over the crown", "m"),
    "amplitude": ("peak acceleration of the ground", "m/s²"),
    "scale": ("scale of the ground's motion", ""),
    "duration": ("duration", "s"),
    "time_step": ("time step", "s"),
    "restitution": ("restitution", ""),
    "penetration_ratio": ("penetration over half size", ""),
}


def name_of(parameter: str) -> tuple[str, str]:
    """Words and unit of a parameter such as "arch%radius" or "joints_deg(2)"."""
    key = parameter.rpartition("%")[2]
    known = PARAMETERS.get(key)
    if known:
        return known
    stem = key.partition("(")[0]
    unit = "°" if stem.endswith("_deg") else key_units().get(stem, "")
    return (key.replace("_deg", "").replace("_", " "), unit)


@lru_cache(maxsize=1)
def key_units() -> dict[str, str]:
    """Units of the keys of decks by their names without groups; none where `dda` is missing."""
    try:
        groups = keys_of(find_dda())
    except (FileNotFoundError, DdaError):
        return {}
    powers = {"m2": "m²", "m3": "m³", "s2": "s²"}
    return {name: re.sub("[ms][23]", lambda found: powers[found[0]], key.get("unit", ""))
            for keys in groups.values() for name, key in keys.items()}


def axis_label(parameter: str) -> str:
    """What an axis says of a parameter: words, and the unit in brackets."""
    words, unit = name_of(parameter)
    return f"{words} [{unit}]" if unit else words


def value_label(parameter: str, value: object) -> str:
    """A parameter with its value and unit, such as "half angle 90°"."""
    words, unit = name_of(parameter)
    number = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f"{words} {number}" + (unit if unit == "°" else f" {unit}" if unit else "")


def length_text(metres: float) -> str:
    """A length [m] with the unit that suits it, such as "2 mm"."""
    for unit, size in (("km", 1e3), ("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)):
        if metres >= size * (1.0 - 1e-12) and metres < 1e3 * size:
            return f"{metres / size:.3g} {unit}"
    return f"{metres:.3g} m"


def force_unit(run: Results | None) -> str:
    """The unit of the forces of a run: per metre of depth, but for lunes, which have a depth of their own."""
    lune = run is not None and (run.setting("arch%lune_deg") is not None or "lune_deg" in run.cases.columns)
    return "N" if lune else "N/m"


def digits(value: float) -> str:
    """A number of three digits, without an exponent where it has few zeros.

    Examples
    --------
    >>> digits(1234.0), digits(0.48504), digits(12.0)
    ('1230', '0.485', '12')
    """
    return f"{float(f'{value:.3g}'):g}"


def quantity(value: float, unit: str) -> str:
    """A number of three digits with its unit, in the size that suits it: "12.5 kN/m³", "0.4 m", "50°".

    Examples
    --------
    >>> quantity(21974.4, "N/m³"), quantity(-3.40619, "m"), quantity(31.0, "°"), quantity(5e9, "Pa")
    ('22 kN/m³', '-3.41 m', '31°', '5 GPa')
    """
    if unit == "°":
        return f"{digits(value)}°"
    if unit.startswith(("N", "Pa")):
        for prefix, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
            if abs(value) >= size:
                return f"{digits(value / size)} {prefix}{unit}"
    return f"{digits(value)} {unit}"


def rounded(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that does not exceed a number above 0."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-12))
