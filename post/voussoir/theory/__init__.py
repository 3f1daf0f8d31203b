"""The three analytic solutions of the Couplet-Heyman problem: Heyman, CCR and Milankovitch.

How thin may a circular masonry arch be, and where does it hinge, under its own weight alone. All
numbers come from the Fortran module (``docs/theory.md``); here arguments are checked and broadcast.

Symbols of all arguments and results: ``alpha`` half angle of embrace, in (0, alpha_limit] of the theory or (0, pi)
[rad]; ``beta`` angle of the intrados hinge or of a joint from the crown, in [0, alpha] or (0, pi) [rad]; ``eta = t/r``
thickness over mean radius, in (0, 2); ``h = H/(w r)`` horizontal thrust; ``A = alpha cot(alpha/2)``; ``mu`` friction
coefficient. A theory is named "heyman", "ccr" or "milankovitch". Every function broadcasts its arguments and raises
ValueError, with the offending value, outside the range of validity.

Examples
--------
>>> beta, eta, h = critical(numpy.radians([45.0, 90.0]), "milankovitch")
>>> equilibrium_thickness(numpy.radians(60.0), numpy.radians(90.0), "ccr")
>>> discrete_critical(36, alpha=numpy.radians(90.0))
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy.typing as npt

from voussoir._theory import theory_api
from voussoir.theory._columns import HALF_ANGLE, JOINT, THEORIES, THICKNESS, Value, evaluate, theory_number
from voussoir.theory._discrete import DiscreteSolution, discrete_critical, discrete_solution
from voussoir.theory._equations import (
    eccentricity, embrace, lower_thrust, springing_thrust, tangent_thrust, thrust_through,
)
from voussoir.theory._friction import friction, friction_critical, friction_thickness

__all__ = [
    "THEORIES", "DiscreteSolution", "critical", "critical_as_printed", "critical_near_limit", "critical_small",
    "curve_slope", "discrete_critical", "discrete_solution", "eccentricity", "embrace", "equilibrium_thickness",
    "friction", "friction_critical", "friction_thickness", "initial_thickness", "limits", "lower_thrust",
    "springing_thrust", "tangent_thrust", "thrust_line", "thrust_through"]

_LIMITS = (
    "alpha_limit", "A_limit", "eta_limit", "beta_limit", "h_limit", "beta_max", "alpha_beta_max", "A_beta_max",
    "eta_beta_max", "h_beta_max", "alpha_unit_A")


def limits(theory: str) -> dict[str, float]:
    """Range of validity of a theory.

    Parameters
    ----------
    theory : str
        Name of the theory.

    Returns
    -------
    dict
        ``alpha_limit`` [rad], the greatest half angle, with ``A_limit``, ``eta_limit``, ``beta_limit`` [rad] and
        ``h_limit`` = 0 there; ``beta_max`` [rad], the farthest hinge of all half angles, with ``alpha_beta_max`` [rad],
        ``A_beta_max``, ``eta_beta_max`` and ``h_beta_max`` there; ``alpha_unit_A`` [rad], where A = 1.
    """
    return dict(zip(_LIMITS, map(float, theory_api.limit_values(theory_number(theory)))))


def critical(alpha: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """Critical hinge, thickness and thrust: eqs. (14) and (18), or (1) to (3) for Heyman.

    Parameters
    ----------
    alpha : array_like
        Half angle of embrace, in (0, alpha_limit] [rad].
    theory : str
        Name of the theory.

    Returns
    -------
    beta : array or float
        Angle of the intrados hinge from the crown [rad].
    eta : array or float
        Critical thickness ratio t/r.
    h : array or float
        Horizontal thrust H/(w r).

    Raises
    ------
    ValueError
        If an angle is outside the range of the theory.
    """
    return _critical(theory_api.critical, alpha, theory)


def critical_as_printed(alpha: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """The same as `critical` by eqs. (1), (23), (24) as printed; shallow arches lose their digits."""
    return _critical(theory_api.critical_as_printed, alpha, theory)


def critical_small(alpha: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """The same as `critical` by power series for small half angles; at 0.1 rad they hold eleven digits."""
    return _critical(theory_api.critical_small, alpha, theory)


def critical_near_limit(distance: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """Leading terms of `critical` at a distance alpha_limit - alpha from the limit of the theory [rad]."""
    wanted = "a distance in [0, alpha_limit) rad"
    routine = theory_api.critical_near_limit
    beta, eta, h = evaluate(routine, {"distance": distance}, [wanted], theory_number(theory), results=3)
    return beta, eta, h


def equilibrium_thickness(beta: npt.ArrayLike, alpha: npt.ArrayLike, theory: str) -> Value:
    """Thickness ratio that equilibrium needs with the inner hinge at beta: eqs. (14) to (16), (26).

    Parameters
    ----------
    beta : array_like
        Inner hinge, in [0, alpha] [rad].
    alpha : array_like
        Half angle of embrace, in (0, alpha_limit] [rad].
    theory : str
        Name of the theory.

    Returns
    -------
    array or float
        eta(beta); its top is the critical thickness of CCR and Milankovitch.
    """
    arguments = {"beta": beta, "alpha": alpha}
    return evaluate(theory_api.curve, arguments, [JOINT, _embraced(theory)], theory_number(theory))[0]


def initial_thickness(alpha: npt.ArrayLike, theory: str) -> Value:
    """Start eta_0 of the equilibrium curve at the crown, zero where A >= 1: eqs. (15), (26)."""
    arguments = {"alpha": alpha}
    return evaluate(theory_api.curve_start, arguments, [_embraced(theory)], theory_number(theory))[0]


def curve_slope(beta: npt.ArrayLike, alpha: npt.ArrayLike, theory: str) -> Value:
    """Slope d eta/d beta of the equilibrium curve [1/rad], arguments as of `equilibrium_thickness`: eq. (19)."""
    arguments = {"beta": beta, "alpha": alpha}
    return evaluate(theory_api.slope, arguments, [JOINT, _embraced(theory)], theory_number(theory))[0]


def thrust_line(beta: npt.ArrayLike, alpha: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust line through the extrados of crown and springing, as the eccentricity ratio 2e/t at beta: eq. (11).

    The ratio is -1 at the extrados and 1 at the intrados; eta in (0, 2) must be thick enough for a thrust h2 > 0.
    """
    arguments = {"beta": beta, "alpha": alpha, "eta": eta}
    ranges = [JOINT, HALF_ANGLE, THICKNESS + " with a thrust"]
    return evaluate(theory_api.line, arguments, ranges, theory_number(theory))[0]


def _embraced(theory: str) -> Callable[[], str]:
    """What says what a theory wants of a half angle: only an error needs the words."""

    def words() -> str:
        limit = limits(theory)["alpha_limit"]
        return f"an angle in (0, {limit!r}] rad ({math.degrees(limit):.3f} deg) for {theory}"

    return words


def _critical(solve: Callable[..., Any], alpha: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """Call one of the Fortran routines that return beta, eta and h."""
    beta, eta, h = evaluate(solve, {"alpha": alpha}, [_embraced(theory)], theory_number(theory), results=3)
    return beta, eta, h
