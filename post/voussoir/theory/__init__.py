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
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from voussoir._theory import theory_api
from voussoir.theory._columns import HALF_ANGLE, JOINT, THEORIES, THICKNESS, Range, Value, evaluate, theory_number
from voussoir.theory._discrete import DiscreteSolution, discrete_critical, discrete_solution

__all__ = [
    "THEORIES", "DiscreteSolution", "critical", "critical_as_printed", "critical_near_limit", "critical_small",
    "curve_slope", "discrete_critical", "discrete_solution", "eccentricity", "embrace", "equilibrium_thickness",
    "friction", "friction_critical", "friction_thickness", "initial_thickness", "limits", "lower_thrust",
    "springing_thrust", "tangent_thrust", "thrust_line", "thrust_through"]

_SEMICIRCLE = 0.5 * math.pi
_ANGLE = "an angle within the range of the theory, see limits()"
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
    return _critical("critical", alpha, theory)


def critical_as_printed(alpha: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """The same as `critical` by eqs. (1), (23), (24) as printed; shallow arches lose their digits."""
    return _critical("critical_as_printed", alpha, theory)


def critical_small(alpha: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """The same as `critical` by power series for small half angles; at 0.1 rad they hold eleven digits."""
    return _critical("critical_small", alpha, theory)


def critical_near_limit(distance: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """Leading terms of `critical` at a distance alpha_limit - alpha from the limit of the theory [rad]."""
    number = theory_number(theory)
    limit = _alpha_limit(number)
    wanted = Range("a distance in [0, alpha_limit) rad", lambda given, _: (given >= 0.0) & (given < limit))
    beta, eta, h = evaluate("critical_near_limit", number, {"distance": distance}, {"distance": wanted}, 3)
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
    return _on_curve("equilibrium_thickness", beta, alpha, theory)


def initial_thickness(alpha: npt.ArrayLike, theory: str) -> Value:
    """Start eta_0 of the equilibrium curve at the crown, zero where A >= 1: eqs. (15), (26)."""
    number = theory_number(theory)
    return evaluate("initial_thickness", number, {"alpha": alpha}, {"alpha": _embraced(theory)})[0]


def curve_slope(beta: npt.ArrayLike, alpha: npt.ArrayLike, theory: str) -> Value:
    """Slope d eta/d beta of the equilibrium curve [1/rad], arguments as of `equilibrium_thickness`: eq. (19)."""
    return _on_curve("curve_slope", beta, alpha, theory)


def thrust_line(beta: npt.ArrayLike, alpha: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust line through the extrados of crown and springing, as the eccentricity ratio 2e/t at beta: eq. (11).

    The ratio is -1 at the extrados and 1 at the intrados; eta in (0, 2) must be thick enough for a thrust h2 > 0.
    """
    number = theory_number(theory)

    def has_thrust(eta: Any, given: Mapping[str, Any]) -> Any:
        places = np.array([given["alpha"], eta]).reshape(2, -1).T
        return THICKNESS.holds(eta, given) & (theory_api.formula(1, "springing_thrust", number, places)[:, 0] > 0.0)

    arguments = {"beta": beta, "alpha": alpha, "eta": eta}
    ranges = {"alpha": HALF_ANGLE, "beta": JOINT, "eta": Range(THICKNESS.words + " with a thrust", has_thrust)}
    return evaluate("thrust_line", number, arguments, ranges)[0]


def eccentricity(beta: npt.ArrayLike, alpha: npt.ArrayLike, eta: npt.ArrayLike, h: npt.ArrayLike, theory: str) -> Value:
    """Eccentricity ratio 2e/t at beta of a thrust h > 0 that passes the extrados at the crown: eq. (10).

    The ratio is -1 at the extrados and 1 at the intrados; alpha, in (0, pi), does not change it.
    """
    arguments = {"beta": beta, "alpha": alpha, "eta": eta, "h": h}
    thrust = Range("a positive thrust", lambda h, _: (h > 0.0) & (h < math.inf))
    ranges = {"alpha": HALF_ANGLE, "beta": JOINT, "eta": THICKNESS, "h": thrust}
    return evaluate("eccentricity", theory_number(theory), arguments, ranges)[0]


def embrace(alpha: npt.ArrayLike) -> Value:
    """The group A = alpha cot(alpha/2) of an angle in (0, pi) [rad], from 2 down to 0: eq. (9)."""
    return evaluate("embrace", 1, {"alpha": alpha}, {"alpha": HALF_ANGLE})[0]


def thrust_through(beta: npt.ArrayLike, ratio: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h through the extrados of the crown and a point of the joint at beta: eq. (6).

    The point has an eccentricity ratio 2e/t in [-1, 1]; h is negative where no thrust can pass.
    """
    within = Range("a ratio in [-1, 1]", lambda ratio, _: abs(ratio) <= 1.0)
    arguments = {"beta": beta, "ratio": ratio, "eta": eta}
    ranges = {"beta": HALF_ANGLE, "ratio": within, "eta": THICKNESS}
    return evaluate("thrust_through", theory_number(theory), arguments, ranges)[0]


def lower_thrust(beta: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Lower thrust h1, through the crown's extrados and the intrados at beta: eq. (7); negative where none can pass."""
    return thrust_through(beta, 1.0, eta, theory)


def springing_thrust(alpha: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h2 through the extrados of crown and springing: eq. (8); negative where no thrust can pass."""
    ranges = {"alpha": HALF_ANGLE, "eta": THICKNESS}
    return evaluate("springing_thrust", theory_number(theory), {"alpha": alpha, "eta": eta}, ranges)[0]


def tangent_thrust(beta: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h_e that touches the intrados at beta: eq. (12), for Heyman eq. (3); negative where none can touch."""
    ranges = {"beta": HALF_ANGLE, "eta": THICKNESS}
    return evaluate("tangent_thrust", theory_number(theory), {"beta": beta, "eta": eta}, ranges)[0]


def friction(theory: str, alpha: float = _SEMICIRCLE) -> dict[str, float | str]:
    """Friction coefficients at which the mode of collapse changes.

    Parameters
    ----------
    theory : str
        Name of the theory.
    alpha : float, optional
        Half angle of embrace, in (0, alpha_limit]; the semicircle by default [rad].

    Returns
    -------
    dict
        ``mu_rotational``: from here on the arch collapses by rotation alone; ``mu_mixed``: below here no thickness
        stands; ``h_mixed``, ``eta_mixed``, ``beta_mixed`` [rad] the thrust, thickness ratio and hinge at mu_mixed;
        ``beta_slip`` [rad] the joint of the haunch that slides there together with the springing; ``slides_first``
        "springing" or "haunch", the joint that limits mu_rotational.
    """
    ranges = {"alpha": _embraced(theory)._replace(words=_ANGLE)}
    found = evaluate("friction", theory_number(theory), {"alpha": alpha}, ranges, 7)
    if found[0].ndim > 0:
        raise ValueError(f"alpha must be one angle, got {alpha!r}")
    rotational, mixed, h, slip, springing, beta, eta = found
    return {
        "mu_rotational": float(rotational),
        "mu_mixed": float(mixed),
        "h_mixed": float(h),
        "eta_mixed": float(eta),
        "beta_mixed": float(beta),
        "beta_slip": float(slip),
        "slides_first": "springing" if springing else "haunch",
    }


def friction_critical(mu: npt.ArrayLike, theory: str, alpha: npt.ArrayLike = _SEMICIRCLE) -> tuple[Value, Value, Value]:
    """Hinge [rad], least thickness and thrust, as of `critical`, at a friction coefficient mu_mixed or more.

    From mu_rotational on the result is that of `critical`; below mu_mixed, see `friction`, no thickness stands.
    """
    ranges = {"alpha": _embraced(theory)._replace(words=_ANGLE)}
    beta, eta, h = evaluate(
        "friction_critical", theory_number(theory), {"mu": mu, "alpha": alpha}, ranges, 3,
        ("mu", "a coefficient of mu_mixed or more, see friction()"))
    return beta, eta, h


def friction_thickness(mu: npt.ArrayLike, theory: str, alpha: npt.ArrayLike = _SEMICIRCLE) -> Value:
    """The least thickness ratio of `friction_critical` alone."""
    return friction_critical(mu, theory, alpha)[1]


@lru_cache(maxsize=None)
def _alpha_limit(number: int) -> float:
    """Greatest half angle of a theory, by its number [rad]."""
    return float(theory_api.limit_values(number)[0])


def _embraced(theory: str) -> Range:
    """Half angles of a theory."""
    limit = _alpha_limit(theory_number(theory))
    words = f"an angle in (0, {limit!r}] rad ({math.degrees(limit):.3f} deg) for {theory}"
    return Range(words, lambda alpha, _: (alpha > 0.0) & (alpha <= limit))


def _critical(formula: str, alpha: npt.ArrayLike, theory: str) -> tuple[Value, Value, Value]:
    """Evaluate a formula of beta, eta and h."""
    beta, eta, h = evaluate(formula, theory_number(theory), {"alpha": alpha}, {"alpha": _embraced(theory)}, 3)
    return beta, eta, h


def _on_curve(formula: str, beta: npt.ArrayLike, alpha: npt.ArrayLike, theory: str) -> Value:
    """Evaluate a formula of the equilibrium curve."""
    ranges = {"alpha": _embraced(theory), "beta": JOINT}
    return evaluate(formula, theory_number(theory), {"beta": beta, "alpha": alpha}, ranges)[0]
