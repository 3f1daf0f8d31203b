"""Arguments of any shape to columns that Fortran takes, and its faults to exceptions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Union

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]
Value = Union[np.float64, Column]

#: What Fortran takes for one element as it is
_FLOATS = (float, np.float64)

#: Numbers of the theories, as in couplet_heyman_theories.f90
THEORIES = {"heyman": 1, "ccr": 2, "milankovitch": 3}

#: What an argument wants, in words, or what makes the words when they are needed
Range = Union[str, Callable[[], str]]

THICKNESS = "a thickness ratio in (0, 2)"
HALF_ANGLE = "an angle in (0, pi) rad"
JOINT = "an angle in [0, alpha] rad"


def theory_number(name: str) -> int:
    """Number of a theory.

    Returns
    -------
    int
        Its number in the Fortran module.

    Raises
    ------
    ValueError
        If there is no such theory.
    """
    if not isinstance(name, str) or name.lower() not in THEORIES:
        raise ValueError(f"theory must be one of {', '.join(map(repr, THEORIES))}, got {name!r}")
    return THEORIES[name.lower()]


def real_array(name: str, value: npt.ArrayLike) -> Column:
    """A numeric argument as an array of doubles.

    Parameters
    ----------
    name : str
        Name of the argument, for the message.

    Returns
    -------
    ndarray
        The same numbers, float64.

    Raises
    ------
    ValueError
        If the argument is no array of real numbers, or some of them are masked.
    """
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ValueError(f"{name} must be real numbers, got masked ones; pass .compressed() instead")
    array = np.asarray(value)
    if array.dtype.kind not in "iuf" and array.size > 0:
        raise ValueError(f"{name} must be real numbers, got {value!r}")
    return array.astype(np.float64)


def columns(**arguments: npt.ArrayLike) -> tuple[tuple[int, ...], list[Column]]:
    """Broadcast arguments against one another and flatten them.

    Returns
    -------
    shape : tuple of int
        Common shape.
    flat : list of ndarray
        Each argument as a contiguous array of one rank.

    Raises
    ------
    ValueError
        If an argument is not numeric or the shapes do not fit.
    """
    arrays = [real_array(name, value) for name, value in arguments.items()]
    shape = np.broadcast_shapes(*(array.shape for array in arrays))
    return shape, [np.ascontiguousarray(np.broadcast_to(array, shape)).ravel() for array in arrays]


def shaped(shape: tuple[int, ...], column: npt.NDArray) -> Value:
    """A result in the shape of the arguments; a number where they were numbers."""
    return column.reshape(shape)[()]


def evaluate(
    routine: Callable, arguments: Mapping[str, npt.ArrayLike], ranges: Sequence[Range], *numbers: int, results: int = 1
) -> tuple[Value, ...]:
    """Call a routine of the Fortran layer for every element of its arguments.

    Parameters
    ----------
    routine : callable
        Takes the arguments as columns, then the numbers; returns columns and its fault.
    arguments : mapping of str to array_like
        The arguments by name, in the order of the call.
    ranges : sequence of str or callable
        What each of them wants, or what says it.

    Returns
    -------
    tuple of ndarray or scalar
        The results in the shape of the arguments.

    Raises
    ------
    ValueError
        If an argument is not numeric, the shapes do not fit, or a value is out of range.
    """
    if all(type(value) in _FLOATS for value in arguments.values()):
        *found, fault = routine(*arguments.values(), *numbers)
        if fault[0] == 0:
            return tuple(column[0] for column in found)
    shape, flat = columns(**arguments)
    if flat[0].size == 0:
        return tuple(np.empty(shape) for _ in range(results))
    *found, fault = routine(*flat, *numbers)
    refuse(fault, list(arguments), flat, ranges)
    return tuple(shaped(shape, column) for column in found)


def refuse(fault: Sequence[int], names: Sequence[str], flat: Sequence[npt.NDArray], ranges: Sequence[Range]) -> None:
    """Raise the exception that a fault of the Fortran layer stands for.

    Parameters
    ----------
    fault : sequence of int
        Place of the argument and of its element, from 1; zeros where all is well.
    names : sequence of str
        Names of the arguments in the order of the Fortran call.
    ranges : sequence of str or callable
        What each of them wants, or what says it.

    Raises
    ------
    ValueError
        With the offending value.
    """
    argument, element = int(fault[0]), int(fault[1])
    if argument == 0:
        return
    value = flat[argument - 1][element - 1].item()
    where = f" at element {element - 1}" if flat[argument - 1].size > 1 else ""
    wanted = ranges[argument - 1]
    words = wanted if isinstance(wanted, str) else wanted()
    raise ValueError(f"{names[argument - 1]} must be {words}, got {value!r}{where}")
