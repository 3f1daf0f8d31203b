"""Arguments of any shape to columns that Fortran takes, and their ranges of validity."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from voussoir._theory import theory_api

Column = npt.NDArray[np.float64]
Value = Union[np.float64, Column]

#: What Fortran takes for one element as it is
_FLOATS = frozenset({float, np.float64})

#: Numbers of the theories, as in couplet_heyman_theories.f90
THEORIES = {"heyman": 1, "ccr": 2, "milankovitch": 3}


class Range(NamedTuple):
    """Range of validity of an argument."""

    words: str
    #: Whether values, the first argument, lie in it; the second one has all arguments
    holds: Callable[[Any, Mapping[str, Any]], Any]


THICKNESS = Range("a thickness ratio in (0, 2)", lambda eta, _: (eta > 0.0) & (eta < 2.0))
HALF_ANGLE = Range("an angle in (0, pi) rad", lambda angle, _: (angle > 0.0) & (angle < math.pi))
JOINT = Range("an angle in [0, alpha] rad", lambda beta, given: (beta >= 0.0) & (beta <= given["alpha"]))


def theory_number(name: str) -> int:
    """Number of a theory in the Fortran module; ValueError if there is no such theory."""
    try:
        return THEORIES[name.lower()]
    except (AttributeError, KeyError, TypeError):
        raise ValueError(f"theory must be one of {', '.join(map(repr, THEORIES))}, got {name!r}") from None


def real_array(name: str, value: npt.ArrayLike) -> Column:
    """A numeric argument as an array of doubles; ValueError if it has masked or other than real numbers."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ValueError(f"{name} must be real numbers, got masked ones; pass .compressed() instead")
    array = np.asarray(value)
    if array.dtype.kind not in "iuf" and array.size > 0:
        raise ValueError(f"{name} must be real numbers, got {value!r}")
    return array.astype(np.float64)


def columns(**arguments: npt.ArrayLike) -> tuple[tuple[int, ...], list[Column]]:
    """Common shape of arguments, and each broadcast to it as a flat array; ValueError if the shapes do not fit."""
    arrays = [real_array(name, value) for name, value in arguments.items()]
    shape = np.broadcast_shapes(*(array.shape for array in arrays))
    return shape, [np.ascontiguousarray(np.broadcast_to(array, shape)).ravel() for array in arrays]


def shaped(shape: tuple[int, ...], column: Column) -> Value:
    """A result in the shape of the arguments; a number where they were numbers."""
    value: Value = column.reshape(shape)[()]
    return value


def evaluate(
    formula: str, theory: int, arguments: Mapping[str, npt.ArrayLike], ranges: Mapping[str, Range], results: int = 1,
    defined: tuple[str, str] = ("", "")
) -> tuple[Value, ...]:
    """Evaluate a formula of the Fortran layer for every element of its arguments.

    The ranges are checked in their order. `defined` is an argument, and its range in words, outside which results are
    NaN. Results have the shape of the arguments. ValueError if arguments are not numeric, do not fit, or are out of
    range.
    """
    given = list(arguments.values())
    if _FLOATS.issuperset(map(type, given)) and all(
            wanted.holds(arguments[name], arguments) for name, wanted in ranges.items()):
        found = theory_api.formula(results, formula, theory, np.array([given]))[0]
        if all(map(math.isfinite, found)):
            return tuple(found)
    shape, flat = columns(**arguments)
    if flat[0].size == 0:
        return tuple(np.empty(shape) for _ in range(results))
    by_name = dict(zip(arguments, flat))
    for name, wanted in ranges.items():
        refuse(name, by_name[name], wanted.holds(by_name[name], by_name), wanted.words)
    found = theory_api.formula(results, formula, theory, np.array(flat).T)
    if defined[0]:
        refuse(defined[0], by_name[defined[0]], ~np.isnan(found[:, 0]), defined[1])
    lost = np.flatnonzero(~np.isfinite(found).all(axis=1))
    if lost.size > 0:
        given_there = ", ".join(f"{name} = {column[lost[0]].item()!r}" for name, column in by_name.items())
        raise ValueError(f"expected arguments whose results doubles can hold, got {given_there}")
    return tuple(shaped(shape, column) for column in found.T)


def refuse(name: str, column: npt.NDArray[Any], valid: npt.NDArray[Any], words: str) -> None:
    """Raise a ValueError with the first value of an argument that is not valid."""
    if valid.all():
        return
    element = int(np.argmin(valid))
    where = f" at element {element}" if column.size > 1 else ""
    raise ValueError(f"{name} must be {words}, got {column[element].item()!r}{where}")
