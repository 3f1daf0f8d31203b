"""The wrapper of the theory: shapes, broadcasting, refusals."""

import math
import os
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from voussoir import theory

THEORIES = ("heyman", "ccr", "milankovitch")
QUARTER = math.pi / 2

#: Each function with a value in the place of each of its arguments
CALLS = {
    "critical alpha": lambda x: theory.critical(x, "ccr"),
    "critical_as_printed alpha": lambda x: theory.critical_as_printed(x, "ccr"),
    "critical_small alpha": lambda x: theory.critical_small(x, "ccr"),
    "critical_near_limit distance": lambda x: theory.critical_near_limit(x, "ccr"),
    "embrace alpha": lambda x: theory.embrace(x),
    "initial_thickness alpha": lambda x: theory.initial_thickness(x, "ccr"),
    "equilibrium_thickness beta": lambda x: theory.equilibrium_thickness(x, 1.0, "ccr"),
    "equilibrium_thickness alpha": lambda x: theory.equilibrium_thickness(0.5, x, "ccr"),
    "curve_slope beta": lambda x: theory.curve_slope(x, 1.0, "ccr"),
    "curve_slope alpha": lambda x: theory.curve_slope(0.5, x, "ccr"),
    "thrust_line beta": lambda x: theory.thrust_line(x, 1.0, 0.5, "ccr"),
    "thrust_line alpha": lambda x: theory.thrust_line(0.5, x, 0.5, "ccr"),
    "thrust_line eta": lambda x: theory.thrust_line(0.5, 1.0, x, "ccr"),
    "eccentricity beta": lambda x: theory.eccentricity(x, 1.0, 0.5, 0.5, "ccr"),
    "eccentricity alpha": lambda x: theory.eccentricity(0.5, x, 0.5, 0.5, "ccr"),
    "eccentricity eta": lambda x: theory.eccentricity(0.5, 1.0, x, 0.5, "ccr"),
    "eccentricity h": lambda x: theory.eccentricity(0.5, 1.0, 0.5, x, "ccr"),
    "thrust_through beta": lambda x: theory.thrust_through(x, 0.5, 0.5, "ccr"),
    "thrust_through ratio": lambda x: theory.thrust_through(0.5, x, 0.5, "ccr"),
    "thrust_through eta": lambda x: theory.thrust_through(0.5, 0.5, x, "ccr"),
    "lower_thrust beta": lambda x: theory.lower_thrust(x, 0.5, "ccr"),
    "springing_thrust alpha": lambda x: theory.springing_thrust(x, 0.5, "ccr"),
    "springing_thrust eta": lambda x: theory.springing_thrust(0.5, x, "ccr"),
    "tangent_thrust beta": lambda x: theory.tangent_thrust(x, 0.5, "ccr"),
    "tangent_thrust eta": lambda x: theory.tangent_thrust(0.5, x, "ccr"),
    "friction alpha": lambda x: theory.friction("ccr", alpha=x),
    "friction_thickness mu": lambda x: theory.friction_thickness(x, "ccr"),
    "friction_thickness alpha": lambda x: theory.friction_thickness(0.5, "ccr", alpha=x),
    "discrete_critical count": lambda x: theory.discrete_critical(x, alpha=1.0),
    "discrete_critical alpha": lambda x: theory.discrete_critical(5, alpha=x),
    "discrete_critical facet": lambda x: theory.discrete_critical(5, alpha=1.0, facet=x),
    "discrete_critical friction": lambda x: theory.discrete_critical(5, alpha=1.0, friction=x),
    "discrete_critical angle": lambda x: theory.discrete_critical([0.0, 0.5, x]),
    "discrete_critical angles": lambda x: theory.discrete_critical(x),
    "discrete_critical facets": lambda x: theory.discrete_critical([0.0, 0.5, 1.0], facet=x),
    "discrete_critical frictions": lambda x: theory.discrete_critical([0.0, 0.5, 1.0], friction=x),
}
#: Arguments that may be None
OPTIONAL = {name for name in CALLS if name.startswith("discrete_critical f")} | {"discrete_critical alpha"}
#: Arguments that may be infinite
UNLIMITED = {"friction_thickness mu", "discrete_critical friction", "discrete_critical frictions"}
NONSENSE = [math.nan, -math.inf, -1.5, "abc", "1.0", None, 1j, b"x", object(), [[None]]]


@pytest.mark.parametrize(
    "name, value", [(name, value) for name in CALLS for value in NONSENSE if value is not None or name not in OPTIONAL])
def test_nonsense_is_a_value_error(name, value):
    with pytest.raises(ValueError):
        CALLS[name](value)


@pytest.mark.parametrize("name", CALLS)
def test_infinity_is_refused_or_means_no_limit(name):
    if name in UNLIMITED:
        assert np.isfinite(CALLS[name](math.inf))
    else:
        with pytest.raises(ValueError, match="inf"):
            CALLS[name](math.inf)


#: Limit of CCR; arguments by what they are called in CALLS: values next to the ends of the range, within it and beyond
LIMIT = theory.limits("ccr")["alpha_limit"]
TINY, BELOW_PI, BELOW_2 = 1e-30, math.nextafter(math.pi, 0.0), math.nextafter(2.0, 0.0)
ENDS = {
    "critical alpha": ((0.01, LIMIT), (0.0, math.nextafter(LIMIT, 4.0))),
    "critical_as_printed alpha": ((0.1, LIMIT - 1e-9), (0.0, LIMIT + 1e-9)),
    "critical_small alpha": ((0.01, LIMIT), (0.0, LIMIT + 1e-9)),
    "critical_near_limit distance": ((0.0, LIMIT - 1e-9), (-1e-9, LIMIT)),
    "embrace alpha": ((TINY, BELOW_PI), (0.0, math.pi)),
    "initial_thickness alpha": ((0.01, LIMIT), (0.0, LIMIT + 1e-9)),
    "equilibrium_thickness beta": ((0.0, 1.0), (-TINY, math.nextafter(1.0, 2.0))),
    "equilibrium_thickness alpha": ((0.5, LIMIT), (0.499, LIMIT + 1e-9)),
    "curve_slope beta": ((0.0, 1.0), (-TINY, math.nextafter(1.0, 2.0))),
    "thrust_line beta": ((0.0, 1.0), (-TINY, math.nextafter(1.0, 2.0))),
    "thrust_line eta": ((0.01, BELOW_2), (0.0, 2.0)),
    "eccentricity alpha": ((0.5, BELOW_PI), (0.499, math.pi)),
    "eccentricity h": ((0.1, 1e100), (0.0, -0.1)),
    "thrust_through beta": ((0.1, 3.0), (0.0, math.pi)),
    "thrust_through ratio": ((-1.0, 1.0), (-1.0001, 1.0001)),
    "springing_thrust alpha": ((0.1, 3.0), (0.0, math.pi)),
    "springing_thrust eta": ((0.1, BELOW_2), (0.0, 2.0)),
    "tangent_thrust beta": ((0.1, 3.0), (0.0, math.pi)),
    "friction alpha": ((0.5, LIMIT), (0.0, LIMIT + 1e-9)),
    "friction_thickness mu": ((0.3093, 10.0), (0.3092, 0.0)),
    "friction_thickness alpha": ((0.5, 1.5), (0.0, LIMIT + 1e-9)),
    "discrete_critical count": ((1, 12), (0, 10**7 + 1)),
    "discrete_critical alpha": ((0.5, 2.0), (0.0, math.pi)),
    "discrete_critical facet": ((1e-7, 1.0), (0.9e-7, 0.0)),
    "discrete_critical friction": ((1.0, math.pi), (-1e-9, -1.0)),
    "discrete_critical angle": ((math.nextafter(0.5, 1.0), 2.0), (0.5, math.pi)),
}


@pytest.mark.parametrize("name", ENDS)
def test_ranges_have_their_ends(name):
    within, beyond = ENDS[name]
    for value in within:
        CALLS[name](value)
    for value in beyond:
        with pytest.raises(ValueError, match="must be .*, got"):
            CALLS[name](value)


@pytest.mark.parametrize("name", THEORIES)
@pytest.mark.parametrize("shape", [(), (1,), (7,), (2, 3), (2, 1, 3), (0,), (0, 4)])
def test_results_have_the_shape_of_the_angles(name, shape):
    angles = np.full(shape, 1.5)
    for values in theory.critical(angles, name):
        assert np.shape(values) == shape
    assert np.shape(theory.embrace(angles)) == shape


def test_numbers_give_numbers():
    assert all(isinstance(value, float) for value in theory.critical(1.5, "ccr"))
    assert isinstance(theory.discrete_critical(12, alpha=1.5), float)


def test_integers_and_single_precision_are_taken():
    assert theory.critical(1, "ccr") == theory.critical(1.0, "ccr")
    assert theory.critical(np.float32(1.5), "ccr") == theory.critical(1.5, "ccr")
    assert theory.critical([1, 2], "ccr")[0].dtype == np.float64


def test_arguments_broadcast():
    beta = np.linspace(0.1, 0.9, 5)
    alpha = np.array([[1.0], [1.5], [2.0]])
    eta = theory.equilibrium_thickness(beta, alpha, "milankovitch")
    assert eta.shape == (3, 5)
    assert eta[1, 2] == theory.equilibrium_thickness(beta[2], 1.5, "milankovitch")
    assert theory.eccentricity(beta, 1.0, 0.5, alpha / 4, "ccr").shape == (3, 5)
    assert theory.discrete_critical([[12], [36]], alpha=[1.0, 1.5, 2.0]).shape == (2, 3)
    with pytest.raises(ValueError):
        theory.equilibrium_thickness(np.ones(2), np.ones(3), "ccr")


def test_views_and_other_orders_give_the_same_numbers():
    angles = np.linspace(0.1, 2.4, 24).reshape(4, 6)
    expected = theory.critical(angles, "milankovitch")[1]
    assert np.array_equal(theory.critical(np.asfortranarray(angles), "milankovitch")[1], expected)
    assert np.array_equal(theory.critical(angles[::-1, ::2], "milankovitch")[1], expected[::-1, ::2])
    assert np.array_equal(theory.critical(angles.T, "milankovitch")[1], expected.T)
    assert np.array_equal(theory.critical(angles.astype(">f8"), "milankovitch")[1], expected)
    assert np.array_equal(theory.critical(angles.tolist(), "milankovitch")[1], expected)


def test_arguments_are_left_as_they_are():
    angles = np.linspace(0.1, 2.4, 5)
    kept = angles.copy()
    theory.critical(angles, "ccr")
    theory.discrete_critical(12, alpha=angles)
    assert np.array_equal(angles, kept)


def test_the_message_names_the_offending_value():
    with pytest.raises(ValueError, match=r"alpha .*got 2\.6 at element 2"):
        theory.critical([1.0, 2.0, 2.6], "heyman")
    with pytest.raises(ValueError, match=r"beta .*got 1\.25"):
        theory.equilibrium_thickness(1.25, 1.0, "ccr")
    with pytest.raises(ValueError, match=r"got -0\.5"):
        theory.eccentricity(0.5, 1.0, 0.25, -0.5, "ccr")
    with pytest.raises(ValueError, match=r"mu .*got 0\.25"):
        theory.friction_thickness([0.5, 0.25], "ccr")
    with pytest.raises(ValueError, match=r"joints .*got 2\.5"):
        theory.discrete_critical(2.5, alpha=1.0)


@pytest.mark.parametrize("name", ["couplet", "", None, 2, ("ccr",)])
def test_unknown_theory_is_refused(name):
    for call in (lambda: theory.critical(1.0, name), lambda: theory.limits(name), lambda: theory.friction(name)):
        with pytest.raises(ValueError, match="theory must be one of"):
            call()


@pytest.mark.parametrize("name", THEORIES)
def test_range_of_a_theory_ends_at_its_limit(name):
    limit = theory.limits(name)["alpha_limit"]
    theory.critical(limit, name)
    theory.critical(1e-60, name)
    for angle in (np.nextafter(limit, 4.0), 0.0, -0.0, math.pi, 1e308):
        with pytest.raises(ValueError):
            theory.critical(angle, name)


def test_limits_are_those_of_theory():
    limits = theory.limits("milankovitch")
    assert limits["A_limit"] == pytest.approx(math.sqrt(3) - 1, rel=1e-15)
    assert limits["eta_limit"] == pytest.approx(4 * math.sqrt(3) - 6, rel=1e-15)
    assert limits["alpha_limit"] == 2.590843443008954904194296
    assert theory.limits("heyman")["alpha_limit"] == 2.589570610685359957177304
    assert theory.limits("ccr")["alpha_limit"] == 2.648388899151005411477459
    assert theory.limits("ccr")["beta_max"] == 1.129085087576186994051896


def test_friction_of_the_semicircle():
    ccr = theory.friction("ccr")
    assert ccr["mu_rotational"] == pytest.approx(0.3958320381380695432, rel=1e-14)
    assert ccr["mu_mixed"] == pytest.approx(0.3092154443302286127, rel=1e-14)
    assert ccr["eta_mixed"] == pytest.approx(0.2006373188417732829, rel=1e-14)
    assert ccr["slides_first"] == "springing"
    assert theory.friction("milankovitch", alpha=math.radians(145))["slides_first"] == "haunch"
    assert theory.friction_thickness(0.35, "ccr") == pytest.approx(0.152919734, abs=1e-9)
    assert theory.friction_thickness(0.5, "ccr") == theory.critical(QUARTER, "ccr")[1]


def test_discrete_arches():
    assert theory.discrete_critical(36, alpha=QUARTER) == pytest.approx(0.10742413832037052, rel=1e-14)
    four_blocks = np.radians([0.0, 54.5, 90.0])
    eta = theory.discrete_critical(four_blocks, facet=math.radians(0.5))
    assert eta == pytest.approx(0.10747767764933158, rel=1e-14)
    odd = math.radians(90) * np.array([1, 3, 5]) / 5
    assert theory.discrete_critical(5, alpha=QUARTER) == pytest.approx(theory.discrete_critical(odd), rel=1e-14)
    assert theory.discrete_critical(3, alpha=QUARTER) == 0.0
    with pytest.raises(ValueError, match="friction .*0.2"):
        theory.discrete_critical(36, alpha=QUARTER, friction=0.2)
    held = theory.discrete_critical(36, alpha=QUARTER, friction=math.radians(21), springing_no_slip=True)
    assert held == pytest.approx(0.10742413832037052, rel=1e-14)


def test_discrete_solution_says_the_hinges():
    solution = theory.discrete_solution(36, alpha=QUARTER)
    assert solution.status == "found"
    assert np.degrees(solution.intrados_hinges) == pytest.approx([55.0])
    assert sorted(np.degrees(solution.extrados_hinges)) == pytest.approx([0.0, 90.0])
    assert solution.sliding_joints == ()
    sliding = theory.discrete_solution(36, alpha=QUARTER, friction=math.radians(20))
    assert np.degrees(sliding.sliding_joints) == pytest.approx([90.0])
    none = theory.discrete_solution(36, alpha=QUARTER, friction=math.radians(10))
    assert none.status == "none_admissible" and math.isnan(none.eta)
    assert theory.discrete_solution(3, alpha=QUARTER).status == "stands_always"
    with pytest.raises(ValueError, match="one arch"):
        theory.discrete_solution([12, 24], alpha=QUARTER)


@pytest.mark.parametrize(
    "joints", [[], [0.0], [1.0, 0.5], [0.5, 0.5], [0.0, 4.0], [-0.1, 0.5], [[0.0, 1.0]], 36, [0.0, math.nan]])
def test_bad_joints_are_refused(joints):
    with pytest.raises(ValueError, match="joints"):
        theory.discrete_critical(joints)


@pytest.mark.parametrize("count", [0, -3, 2.5, 1e12, 10**7 + 1, [4, 0]])
def test_bad_numbers_of_voussoirs_are_refused(count):
    with pytest.raises(ValueError, match="joints"):
        theory.discrete_critical(count, alpha=1.0)


def test_empty_arrays_of_arches_are_empty():
    assert theory.discrete_critical(12, alpha=[]).shape == (0,)
    assert theory.discrete_critical([0.0, 0.5, 1.0], friction=[]).shape == (0,)
    assert theory.friction_thickness([], "ccr").shape == (0,)


@pytest.mark.parametrize("name", [name for name in CALLS if name != "discrete_critical angle"])
def test_masked_elements_are_refused_and_never_computed(name):
    """NumPy would hand over what lies under the mask."""
    masked = np.ma.masked_array([0.5, 0.6], mask=[False, True])
    with pytest.raises(ValueError, match="masked"):
        CALLS[name](masked)


def test_array_that_masks_nothing_is_an_array():
    plain = np.array([0.5, 0.6])
    for found, exact in zip(theory.critical(np.ma.masked_array(plain), "ccr"), theory.critical(plain, "ccr")):
        assert np.array_equal(found, exact)


@pytest.mark.parametrize("theory_name", THEORIES)
def test_a_number_is_an_array_of_one(theory_name):
    """Numbers go to Fortran as they are; results and messages are those of arrays."""
    for one, many in zip(theory.critical(0.7, theory_name), theory.critical(np.array([0.7]), theory_name)):
        assert isinstance(one, np.float64) and one == many[0]
    messages = []
    for bad in (9.0, np.float64(9.0), np.array([9.0])):
        with pytest.raises(ValueError) as error:
            theory.critical(bad, theory_name)
        messages.append(str(error.value))
    assert len(set(messages)) == 1 and f"for {theory_name}" in messages[0] and "got 9.0" in messages[0]


def test_thickness_without_a_thrust_is_refused():
    """An arch of half angle 3 rad and 0.1 thick has no thrust through its springing's extrados."""
    assert theory.springing_thrust(3.0, 0.1, "ccr") < 0.0
    with pytest.raises(ValueError, match="eta must be a thickness ratio in .* with a thrust, got 0.1"):
        theory.thrust_line(0.3, 3.0, 0.1, "ccr")


@pytest.mark.parametrize("eta", [0.0, 2.0])
def test_thickness_ratio_leaves_out_both_limits(eta):
    with pytest.raises(ValueError, match="eta must be"):
        theory.eccentricity(0.5, 1.0, eta, 0.5, "ccr")
    assert math.isfinite(theory.eccentricity(0.5, 1.0, abs(eta - 1e-9), 0.5, "ccr"))


def test_calls_in_threads_give_the_same_numbers():
    angles = np.linspace(0.1, 1.5, 20_000)
    alone = theory.friction_critical(0.5, "ccr", angles)
    with ThreadPoolExecutor(4) as pool:
        calls = [pool.submit(theory.friction_critical, 0.5, "ccr", angles) for _ in range(8)]
    for call in calls:
        assert all(np.array_equal(a, b) for a, b in zip(alone, call.result()))


def test_every_routine_lets_python_go_on_while_it_computes():
    """In the wrapper that f2py has written, each call gives back the interpreter's lock."""
    wrapper = Path(os.environ.get("VOUSSOIR_BUILD", "")) / "f2py" / "_theorymodule.c"
    if not wrapper.exists():
        pytest.skip("VOUSSOIR_BUILD names no build folder")
    text = wrapper.read_text()
    routines = len(re.findall(r"^static PyObject \*f2py_rout_", text, re.MULTILINE))
    assert routines == text.count("Py_BEGIN_ALLOW_THREADS") == 4


#: Tiny and huge arguments, and those at the ends of ranges
EXTREMES = (0.0, 5e-324, 1e-310, 1e-160, 1e-100, 1e-60, 1e-17, 1e-8, 0.1, QUARTER, 2.0 - 2e-16, math.pi, 1e8, 1.7e308,
            -1e-160, math.inf, math.nan)


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_extreme_arguments_give_a_number_or_a_refusal(call) -> None:
    for value in EXTREMES:
        for argument in (value, np.array([value])):
            try:
                found = call(argument)
            except ValueError:
                continue
            parts = found.values() if isinstance(found, dict) else np.ravel(found)
            assert all(isinstance(part, str) or np.isfinite(part) for part in parts), (value, found)


@pytest.mark.parametrize("name", THEORIES)
def test_two_tiny_arguments_give_a_number_or_a_refusal(name: str) -> None:
    for first in EXTREMES:
        for second in EXTREMES:
            for function in (theory.equilibrium_thickness, theory.curve_slope, theory.lower_thrust,
                             theory.springing_thrust, theory.tangent_thrust):
                try:
                    found = function(first, second, name)
                except ValueError:
                    continue
                assert math.isfinite(found), (function, first, second)


def test_what_underflows_is_named() -> None:
    with pytest.raises(ValueError, match="expected arguments whose results doubles can hold, got alpha = 1e-160"):
        theory.critical(1e-160, "ccr")
    with pytest.raises(ValueError, match="got alpha = 1e-200"):
        theory.critical([0.5, 1e-200], "ccr")
    beta, eta, h = theory.critical(1e-60, "ccr")
    assert eta > 0.0 and (beta, h) == pytest.approx((beta, 1.0))
