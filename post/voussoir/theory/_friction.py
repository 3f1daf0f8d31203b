"""Joints of finite friction: functions of `voussoir.theory`."""

from __future__ import annotations

import math

import numpy.typing as npt

from voussoir._theory import theory_discrete_api
from voussoir.theory._columns import Value, evaluate, theory_number

_SEMICIRCLE = 0.5 * math.pi
_ANGLE = "an angle within the range of the theory, see limits()"


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
    found = evaluate(theory_discrete_api.friction_range, {"alpha": alpha}, [_ANGLE], theory_number(theory), results=7)
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
    ranges = ["a coefficient of mu_mixed or more, see friction()", _ANGLE]
    arguments = {"mu": mu, "alpha": alpha}
    beta, eta, h = evaluate(theory_discrete_api.friction_states, arguments, ranges, theory_number(theory), results=3)
    return beta, eta, h


def friction_thickness(mu: npt.ArrayLike, theory: str, alpha: npt.ArrayLike = _SEMICIRCLE) -> Value:
    """The least thickness ratio of `friction_critical` alone."""
    return friction_critical(mu, theory, alpha)[1]
