"""Numbers with their units as figures print them."""

from __future__ import annotations

import math


def length_text(metres: float) -> str:
    """A length with the unit that suits it.

    Parameters
    ----------
    metres : float
        The length [m].

    Returns
    -------
    str
        Such as "2 mm".
    """
    for unit, size in (("km", 1e3), ("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)):
        if metres >= size * (1.0 - 1e-12) and metres < 1e3 * size:
            return f"{metres / size:.3g} {unit}"
    return f"{metres:.3g} m"


def force_text(force: float) -> str:
    """A force per metre of depth with the unit that suits it.

    Parameters
    ----------
    force : float
        The force [N/m].

    Returns
    -------
    str
        Such as "12.5 kN/m".
    """
    for unit, size in (("GN/m", 1e9), ("MN/m", 1e6), ("kN/m", 1e3), ("N/m", 1.0)):
        if size <= force < 1e3 * size:
            return f"{force / size:.4g} {unit}"
    return f"{force:.4g} N/m"


def rounded(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that does not exceed a number.

    Parameters
    ----------
    value : float
        Above 0.

    Returns
    -------
    float
        Such as 200.
    """
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-12))
