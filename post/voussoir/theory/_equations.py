"""Eqs. (6) to (12): functions of `voussoir.theory`."""

from __future__ import annotations

import numpy.typing as npt

from voussoir._theory import theory_equations_api
from voussoir.theory._columns import HALF_ANGLE, JOINT, THICKNESS, Value, evaluate, theory_number


def eccentricity(beta: npt.ArrayLike, alpha: npt.ArrayLike, eta: npt.ArrayLike, h: npt.ArrayLike, theory: str) -> Value:
    """Eccentricity ratio 2e/t at beta of a thrust h > 0 that passes the extrados at the crown: eq. (10).

    The ratio is -1 at the extrados and 1 at the intrados; alpha, in (0, pi), does not change it.
    """
    arguments = {"beta": beta, "alpha": alpha, "eta": eta, "h": h}
    ranges = [JOINT, HALF_ANGLE, THICKNESS, "a positive thrust"]
    return evaluate(theory_equations_api.joint_eccentricity, arguments, ranges, theory_number(theory))[0]


def embrace(alpha: npt.ArrayLike) -> Value:
    """The group A = alpha cot(alpha/2) of an angle in (0, pi) [rad], from 2 down to 0: eq. (9)."""
    arguments = {"alpha": alpha}
    return evaluate(theory_equations_api.group_a, arguments, [HALF_ANGLE])[0]


def thrust_through(beta: npt.ArrayLike, ratio: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h through the extrados of the crown and a point of the joint at beta: eq. (6).

    The point has an eccentricity ratio 2e/t in [-1, 1]; h is negative where no thrust can pass.
    """
    arguments = {"beta": beta, "ratio": ratio, "eta": eta}
    ranges = [HALF_ANGLE, "a ratio in [-1, 1]", THICKNESS]
    return evaluate(theory_equations_api.thrust_at_joint, arguments, ranges, theory_number(theory))[0]


def lower_thrust(beta: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Lower thrust h1, through the crown's extrados and the intrados at beta: eq. (7); negative where none can pass."""
    return thrust_through(beta, 1.0, eta, theory)


def springing_thrust(alpha: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h2 through the extrados of crown and springing: eq. (8); negative where no thrust can pass."""
    arguments = {"alpha": alpha, "eta": eta}
    ranges = [HALF_ANGLE, THICKNESS]
    return evaluate(theory_equations_api.thrust_at_springing, arguments, ranges, theory_number(theory))[0]


def tangent_thrust(beta: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h_e that touches the intrados at beta: eq. (12), for Heyman eq. (3); negative where none can touch."""
    arguments = {"beta": beta, "eta": eta}
    ranges = [HALF_ANGLE, THICKNESS]
    return evaluate(theory_equations_api.thrust_at_tangent, arguments, ranges, theory_number(theory))[0]
