"""Arguments of any shape to columns that Fortran takes, and its faults to exceptions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]
Value = Union[np.float64, Column]

#: What Fortran takes for one element as it is
_FLOATS = frozenset({float, np.float64})

#: Numbers of the theories, as in couplet_heyman_theories.f90
THEORIES = {"heyman": 1, "ccr": 2, "milankovitch": 3}

#: What an argument wants, in words, or what makes the words when they are needed
Range = Union[str, Callable[[], str]]

THICKNESS = "a thickness ratio in (0, 2)"
HALF_ANGLE = "an angle in (0, pi) rad"
JOINT = "an angle in [0, alpha] rad"


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
    routine: Callable[..., Any], arguments: Mapping[str, npt.ArrayLike], ranges: Sequence[Range], *numbers: int,
    results: int = 1
) -> tuple[Value, ...]:
    """Call a routine of the Fortran layer for every element of its arguments.

    It takes them as columns, then the numbers, and returns columns and its fault, by the demand of each argument
    (`ranges`). Results have the shape of the arguments. ValueError if they are not numeric, do not fit, or are out of
    range.
    """
    given = arguments.values()
    if _FLOATS.issuperset(map(type, given)):
        *found, fault = routine(*given, *numbers)
        if fault[0] == 0 and all(math.isfinite(column[0]) for column in found):
            return tuple([column[0] for column in found])
    shape, flat = columns(**arguments)
    if flat[0].size == 0:
        return tuple(np.empty(shape) for _ in range(results))
    *found, fault = routine(*flat, *numbers)
    refuse(fault, list(arguments), flat, ranges)
    lost = np.flatnonzero(~np.isfinite(found).all(axis=0))
    if lost.size > 0:
        given_there = ", ".join(f"{name} = {column[lost[0]].item()!r}" for name, column in zip(arguments, flat))
        raise ValueError(f"expected arguments whose results doubles can hold, got {given_there}")
    return tuple(shaped(shape, column) for column in found)


def refuse(
    fault: Sequence[int], names: Sequence[str], flat: Sequence[npt.NDArray[Any]], ranges: Sequence[Range]
) -> None:
    """Raise the ValueError, with the offending value, that a fault of the Fortran layer stands for.

    A fault is the place of the argument and of its element, from 1; zeros where all is well.
    """
    argument, element = int(fault[0]), int(fault[1])
    if argument == 0:
        return
    value = flat[argument - 1][element - 1].item()
    where = f" at element {element - 1}" if flat[argument - 1].size > 1 else ""
    wanted = ranges[argument - 1]
    words = wanted if isinstance(wanted, str) else wanted()
    raise ValueError(f"{names[argument - 1]} must be {words}, got {value!r}{where}")
