"""The theory against 50 digits, evaluated at the very doubles that are passed.

The reference solves eqs. (14) and (18) in mpmath, with nothing in common with the Fortran but the
equations.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from dda_command import rows_of

mp = pytest.importorskip("mpmath", reason="the reference wants mpmath")

from voussoir import theory  # noqa: E402

DATA = Path(__file__).resolve().parents[1] / "data"
THEORIES = ("heyman", "ccr", "milankovitch")
ALLOWED = np.array([4e-15, 8e-15, 2e-14])  #: Relative errors allowed in hinge, thickness and thrust
EPSILON = np.finfo(float).eps
GENERATOR = np.random.default_rng(20140901)


def exact_embrace(alpha):
    """A of eq. (9)."""
    return alpha * mp.cot(alpha / 2)


def exact_curve(beta, alpha, flag):
    """eta(beta) of eq. (14), from the root of its quadratic part."""
    sine, cosine, a = mp.sin(beta), mp.cos(beta), exact_embrace(alpha)
    q, d, p = beta * sine - (1 - cosine) * a, cosine - a, beta * sine + (1 + cosine) * a
    eta = 2 * (d + mp.sqrt(d * d + p * q)) / p
    for _ in range(12 if flag else 0):
        value = q + eta * (d - eta * (p / 4 - cosine * eta / 12))
        eta -= value / (d - eta * (p / 2 - cosine * eta / 4))
    return eta


def root(function, low, high):
    """Root between two values of opposite sign, to all digits."""
    return mp.findroot(function, (low, high), solver="anderson", tol=1e-65, maxsteps=400, verify=False)


def exact_critical(alpha, name):
    """Hinge, thickness and thrust by eqs. (1) to (3), or by (14), (18) and (8)."""
    if name == "heyman":

        def mismatch(b):
            common = 2 * b * mp.cos(b) + mp.sin(b) * mp.cos(b) ** 2
            quotient = (common + mp.sin(b)) / (common - mp.sin(b) * mp.cos(b))
            return b * mp.cot(b) * quotient - exact_embrace(alpha)

        beta = root(mismatch, alpha / 2, min(alpha, mp.pi / 2))
        return beta, 2 * (beta - mp.sin(beta)) * mp.tan(beta / 2) ** 2 / beta, beta * mp.cot(beta)
    flag = 1 if name == "milankovitch" else 0

    def slope(b):
        eta, arm = exact_curve(b, alpha, flag), mp.sin(b) + b * mp.cos(b) - mp.sin(b) * exact_embrace(alpha)
        return -flag * mp.sin(b) * eta**3 - 3 * arm * eta**2 - 12 * mp.sin(b) * eta + 12 * arm

    low = alpha * mp.mpf("1e-9") if alpha > 2 else alpha * mp.mpf("0.3")
    beta = root(slope, low, min(alpha * mp.mpf("0.75"), mp.mpf("1.2")))
    eta = exact_curve(beta, alpha, flag)
    return beta, eta, exact_embrace(alpha) - 2 * (1 + flag * eta**2 / 12) / (2 + eta)


def relative_error(found, exact) -> float:
    """Relative error of a double, as a double."""
    return float(abs(mp.mpf(float(found)) / exact - 1))


@pytest.fixture(autouse=True)
def fifty_digits():
    """Work with enough digits that the reference keeps 50 of a shallow arch's thickness."""
    with mp.workdps(75):
        yield


def half_angles() -> np.ndarray:
    """Half angles from 0.001 to 147.5 degrees: random and round ones [rad]."""
    shallow = 10.0 ** GENERATOR.uniform(-3.0, math.log10(147.5), 20)
    return np.radians(np.concatenate([shallow, GENERATOR.uniform(1.0, 147.5, 30), [0.001, 45, 90, 126, 140, 147.5]]))


@pytest.mark.parametrize("name", THEORIES)
def test_critical_solution_has_all_its_digits(name):
    angles = half_angles()
    limit = theory.limits(name)["alpha_limit"]
    found = np.array(theory.critical(angles, name))
    for i, angle in enumerate(angles):
        errors = [relative_error(x, y) for x, y in zip(found[:, i], exact_critical(mp.mpf(float(angle)), name))]
        assert np.all(errors <= ALLOWED), (name, angle, errors)
        assert limit > angle


@pytest.mark.parametrize("name", THEORIES)
def test_digits_last_up_to_the_limit(name):
    limit = theory.limits(name)["alpha_limit"]
    for distance in (1e-2, 1e-4, 1e-6, 1e-8):
        angle = limit - distance
        errors = [
            relative_error(x, y)
            for x, y in zip(theory.critical(angle, name), exact_critical(mp.mpf(angle), name))
        ]
        assert np.all(errors <= ALLOWED + EPSILON / distance), (name, distance, errors)
        assert np.all(errors <= ALLOWED), (name, distance, errors)


@pytest.mark.parametrize("name", ("ccr", "milankovitch"))
def test_curve_has_all_its_digits(name):
    unit = theory.limits(name)["alpha_unit_A"]
    shares = np.concatenate([10.0 ** GENERATOR.uniform(-6, 0, 15), 1 - 10.0 ** GENERATOR.uniform(-9, 0, 15)])
    angles = np.concatenate([half_angles()[::4], unit + np.array([-1e-2, -1e-6, 0.0, 1e-9, 1e-5, 1e-3])])
    for angle in angles:
        for beta in shares * angle:
            found = theory.equilibrium_thickness(beta, angle, name)
            exact = exact_curve(mp.mpf(float(beta)), mp.mpf(float(angle)), 1 if name == "milankovitch" else 0)
            assert relative_error(found, exact) <= 1e-14, (name, angle, beta)


@pytest.mark.parametrize(
    "row", rows_of(DATA / "theory_golden.csv"), ids=lambda row: f"{row['alpha_deg']}-{row['theory']}")
def test_golden_values(row):
    angle = math.radians(float(row["alpha_deg"]))
    limit = theory.limits(row["theory"])["alpha_limit"]
    if not row["beta_rad"]:
        assert angle > limit
        return
    exact = [float(row[column]) for column in ("beta_rad", "eta", "h")]
    errors = np.abs(np.array(theory.critical(angle, row["theory"])) / exact - 1.0)
    # The rounding of the angle to radians alone moves eta by four units in the last place.
    assert np.all(errors <= ALLOWED + EPSILON / (limit - angle)), errors


def test_discrete_arches_are_exact():
    rows = rows_of(DATA / "arch_exact.csv")
    assert len(rows) > 300
    status = {"none_stable": "none_admissible", "always_stable": "stands_always", "found": "found"}
    for row in rows:
        friction = math.radians(float(row["friction_deg"]))
        options = {"friction": friction, "springing_no_slip": row["springing"] == "no-slip"}
        if row["facet_deg"]:
            options["facet"] = math.radians(float(row["facet_deg"]))
        if row["voussoirs"]:
            joints = int(row["voussoirs"])
            options["alpha"] = math.radians(float(row["half_angle_deg"]))
        else:
            joints = np.radians([float(angle) for angle in row["joints_deg"].split()])
        solution = theory.discrete_solution(joints, **options)
        assert solution.status == status[row["status"]], row["case"]
        if solution.status == "found":
            assert abs(solution.eta / float(row["eta_exact"]) - 1.0) <= 1e-13, row["case"]
