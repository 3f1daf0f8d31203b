"""Arches of polygon voussoirs by limit analysis: functions of `voussoir.theory`."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from voussoir._theory import theory_api
from voussoir.theory._columns import HALF_ANGLE, Value, columns, real_array, refuse, shaped

#: Names of the outcomes, as numbered in couplet_heyman_discrete.f90
STATUS = ("found", "stands_always", "none_admissible", "bad_input", "unsettled")
#: What a joint does, as numbered there
ROLES = {1: "intrados_hinges", 2: "extrados_hinges", 3: "sliding_joints"}

_NO_SLIP = math.pi
#: Most voussoirs, and the shortest chord [rad]: shorter ones change no digit
MOST_VOUSSOIRS, SHORTEST_CHORD = 10_000_000, 1e-7
_WANTS = {
    "joints": "1 to 10 million voussoirs, or joint angles that increase within [0, pi) rad",
    "facet": "an angle of at least 1e-7 rad",
    "friction": "an angle of 0 rad or more",
}


class DiscreteSolution(NamedTuple):
    """Critical state of one arch of voussoirs; angles from the crown [rad]."""

    status: str  #: "found", "stands_always" (eta = 0) or "none_admissible" (eta = nan)
    eta: float  #: Critical thickness ratio
    thrust: float  #: Horizontal thrust there over gamma r^2 eta
    intrados_hinges: tuple[float, ...]  #: Joints that turn about their intrados corner
    extrados_hinges: tuple[float, ...]  #: Joints that turn about their extrados corner
    sliding_joints: tuple[float, ...]  #: Joints whose friction is exhausted


def discrete_critical(
    joints: npt.ArrayLike, alpha: npt.ArrayLike | None = None, facet: npt.ArrayLike | None = None,
    friction: npt.ArrayLike | None = None, springing_no_slip: bool = False
) -> Value:
    """Exact critical thickness ratio of an arch of rigid polygon voussoirs.

    Parameters
    ----------
    joints : array_like
        With alpha: number of equal voussoirs of the whole arch. Without: joint angles of one half from the crown to the
        springing, as in a deck; the first is 0 for a joint at the crown, else a voussoir straddles it [rad].
    alpha : array_like, optional
        Half angle of embrace, in (0, pi) [rad].
    facet : array_like, optional
        Greatest span of a chord; by default one chord a voussoir [rad].
    friction : array_like, optional
        Friction angle of the joints; by default, and from pi/2 on, no joint slides [rad].
    springing_no_slip : bool, optional
        Whether the two springing joints cannot slide.

    Returns
    -------
    array or float
        eta_c, of the shape that joints (when numbers), alpha, facet and friction have together; 0
        for an arch that stands at every thickness.

    Raises
    ------
    ValueError
        If an argument makes no sense, or no thickness ratio below 2 admits equilibrium.
    """
    shape, status, eta, *_, flat = _solve(joints, alpha, facet, friction, springing_no_slip)
    none = np.flatnonzero(status == STATUS.index("none_admissible"))
    if none.size > 0:
        angle = flat[-1][none[0]].item()
        raise ValueError(
            f"friction must be an angle at which some thickness ratio below 2 admits equilibrium, got {angle!r} rad")
    return shaped(shape, eta)


def discrete_solution(
    joints: npt.ArrayLike, alpha: float | None = None, facet: float | None = None, friction: float | None = None,
    springing_no_slip: bool = False
) -> DiscreteSolution:
    """The same for one arch, with its thrust and the joints that bind.

    Parameters
    ----------
    joints, alpha, facet, friction, springing_no_slip
        As for `discrete_critical`, one arch.

    Returns
    -------
    DiscreteSolution
        Status, thickness, thrust, hinges and sliding joints.
    """
    _, status, eta, h, joint, role, _ = _solve(joints, alpha, facet, friction, springing_no_slip)
    if status.size != 1:
        raise ValueError(f"discrete_solution needs one arch, got {status.size}")
    found = STATUS[status[0]] == "found"
    bound = {name: tuple(float(angle) for angle in joint[role[:, 0] == number, 0]) for number, name in ROLES.items()}
    ratio = math.nan if STATUS[status[0]] == "none_admissible" else float(eta[0])
    return DiscreteSolution(STATUS[status[0]], ratio, float(h[0]) if found else math.nan, **bound)


def _solve(
    joints: npt.ArrayLike, alpha: npt.ArrayLike | None, facet: npt.ArrayLike | None, friction: npt.ArrayLike | None,
    springing_no_slip: bool
) -> tuple[Any, ...]:
    """Shape, status, eta, thrust, joints (5, n), roles (5, n), flat facet and friction."""
    facet = 0.0 if facet is None else _positive_facet(facet)
    friction = _NO_SLIP if friction is None else friction
    if alpha is not None:
        return _solve_equal(joints, alpha, facet, friction, springing_no_slip)
    angles = real_array("joints", joints)
    if angles.ndim != 1 or angles.size == 0:
        raise ValueError(f"joints must be the angles of one half arch, or a number together with alpha, got {joints!r}")
    in_range = HALF_ANGLE.holds(angles, {})
    in_range[0] |= angles.size > 1 and angles[0] == 0.0
    in_range[1:] &= np.diff(angles) > 0.0
    refuse("joints", angles, in_range, _WANTS["joints"])
    shape, flat = columns(facet=facet, friction=friction)
    _refuse_others(*flat)
    rows = [theory_api.discrete_joints(angles, chord, angle, int(springing_no_slip)) for chord, angle in zip(*flat)]
    status, eta, h = (np.array([row[i] for row in rows]) for i in range(3))
    joint, role = (np.array([row[i] for row in rows]).reshape(-1, 5).T for i in (3, 4))
    return shape, status.astype(int), eta.astype(float), h.astype(float), joint, role, flat


def _solve_equal(
    joints: npt.ArrayLike, alpha: npt.ArrayLike, facet: npt.ArrayLike, friction: npt.ArrayLike, springing_no_slip: bool
) -> tuple[Any, ...]:
    """The same for arches of equal voussoirs."""
    shape, flat = columns(joints=joints, alpha=alpha, facet=facet, friction=friction)
    count = flat[0]
    whole = np.isfinite(count) & (count == np.floor(count)) & (np.abs(count) < 2.0**31)
    if not whole.all():
        value = count[~whole][0].item()
        raise ValueError(f"joints must be whole numbers of voussoirs together with alpha, got {value!r}")
    counts = count.astype(np.int32)
    if counts.size == 0:
        none = np.empty(0)
        return (shape, none.astype(int), none, none, np.empty((5, 0)), np.empty((5, 0), int), flat[2:])
    refuse("joints", counts, (counts >= 1) & (counts <= MOST_VOUSSOIRS), _WANTS["joints"])
    refuse("alpha", flat[1], HALF_ANGLE.holds(flat[1], {}), HALF_ANGLE.words)
    _refuse_others(*flat[2:])
    return (shape, *theory_api.discrete_equal(counts, *flat[1:], int(springing_no_slip)), flat[2:])


def _positive_facet(facet: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """A facet that the caller gave: 0 means none to Fortran only."""
    array = real_array("facet", facet)
    wrong = array[~(array > 0.0)]
    if wrong.size > 0:
        raise ValueError(f"facet must be {_WANTS['facet']}, got {wrong[0].item()!r}")
    return array


def _refuse_others(facet: npt.NDArray[np.float64], friction: npt.NDArray[np.float64]) -> None:
    """Refuse chords that are too short, and negative friction angles."""
    has_length = (facet == 0.0) | (facet >= SHORTEST_CHORD) & (facet < math.inf)
    refuse("facet", facet, has_length, _WANTS["facet"])
    refuse("friction", friction, friction >= 0.0, _WANTS["friction"])
