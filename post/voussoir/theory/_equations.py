"""Eqs. (6) to (12): functions of `voussoir.theory`."""

from __future__ import annotations

import numpy.typing as npt

from voussoir._theory import theory_equations_api
from voussoir.theory._columns import HALF_ANGLE, JOINT, THICKNESS, Value, evaluate, theory_number


def eccentricity(beta: npt.ArrayLike, alpha: npt.ArrayLike, eta: npt.ArrayLike, h: npt.ArrayLike, theory: str) -> Value:
    """Eccentricity of a thrust h that passes the extrados at the crown: eq. (10).

    Parameters
    ----------
    beta : array_like
        Angle of the joint, in [0, alpha] [rad].
    alpha : array_like
        Half angle of embrace, in (0, pi); eq. (10) does not depend on it [rad].
    eta : array_like
        Thickness ratio, in (0, 2).
    h : array_like
        Horizontal thrust H/(w r), positive.
    theory : str
        Name of the theory.

    Returns
    -------
    array or float
        Eccentricity ratio 2e/t, -1 at the extrados, 1 at the intrados.
    """
    arguments = {"beta": beta, "alpha": alpha, "eta": eta, "h": h}
    ranges = [JOINT, HALF_ANGLE, THICKNESS, "a positive thrust"]
    return evaluate(theory_equations_api.joint_eccentricity, arguments, ranges, theory_number(theory))[0]


def embrace(alpha: npt.ArrayLike) -> Value:
    """The group A = alpha cot(alpha/2): eq. (9).

    Parameters
    ----------
    alpha : array_like
        Half angle of embrace, in (0, pi) [rad].

    Returns
    -------
    array or float
        A, from 2 down to 0.
    """
    arguments = {"alpha": alpha}
    return evaluate(theory_equations_api.group_a, arguments, [HALF_ANGLE])[0]


def thrust_through(beta: npt.ArrayLike, ratio: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust through the extrados of the crown and a point of a joint: eq. (6).

    Parameters
    ----------
    beta : array_like
        Angle of the joint, in (0, pi) [rad].
    ratio : array_like
        Eccentricity ratio 2e/t of the point, in [-1, 1].
    eta : array_like
        Thickness ratio, in (0, 2).
    theory : str
        Name of the theory.

    Returns
    -------
    array or float
        h; negative where no thrust can pass.
    """
    arguments = {"beta": beta, "ratio": ratio, "eta": eta}
    ranges = [HALF_ANGLE, "a ratio in [-1, 1]", THICKNESS]
    return evaluate(theory_equations_api.thrust_at_joint, arguments, ranges, theory_number(theory))[0]


def lower_thrust(beta: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Lower thrust h1, through the extrados of the crown and the intrados at beta: eq. (7).

    Parameters
    ----------
    beta : array_like
        Inner hinge, in (0, pi) [rad].
    eta : array_like
        Thickness ratio, in (0, 2).
    theory : str
        Name of the theory.

    Returns
    -------
    array or float
        h1; negative where no thrust can pass.
    """
    return thrust_through(beta, 1.0, eta, theory)


def springing_thrust(alpha: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h2 through the extrados of crown and springing: eq. (8).

    Parameters
    ----------
    alpha : array_like
        Half angle of embrace, in (0, pi) [rad].
    eta : array_like
        Thickness ratio, in (0, 2).
    theory : str
        Name of the theory.

    Returns
    -------
    array or float
        h2; negative where no thrust can pass.
    """
    arguments = {"alpha": alpha, "eta": eta}
    ranges = [HALF_ANGLE, THICKNESS]
    return evaluate(theory_equations_api.thrust_at_springing, arguments, ranges, theory_number(theory))[0]


def tangent_thrust(beta: npt.ArrayLike, eta: npt.ArrayLike, theory: str) -> Value:
    """Thrust h_e that touches the intrados at beta: eq. (12), for Heyman eq. (3).

    Parameters
    ----------
    beta : array_like
        Inner hinge, in (0, pi) [rad].
    eta : array_like
        Thickness ratio, in (0, 2).
    theory : str
        Name of the theory.

    Returns
    -------
    array or float
        h_e; negative where no thrust can touch.
    """
    arguments = {"beta": beta, "eta": eta}
    ranges = [HALF_ANGLE, THICKNESS]
    return evaluate(theory_equations_api.thrust_at_tangent, arguments, ranges, theory_number(theory))[0]
