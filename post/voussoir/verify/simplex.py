"""Linear programmes in rational numbers: the best vertex, found in floating point and proven exactly.

The programme is: most (or least) of the last variable, with columns * x = right and x >= 0. A vertex is a
set of columns; the self-dual simplex method leads from any of them to the best one.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Union

import numpy as np

from voussoir.verify.rational import Column, Factor

#: What rounding leaves of zero, and columns that count as dependent
ROUNDING, DEPENDENT = 1e-10, 1e-7
#: Most exchanges of a column, in floating point for each row and exactly
MOST_FLOAT, MOST_EXACT = 20, 300

#: Numbers in floating point or exact ones
_Numbers = Union[np.ndarray, Sequence[Fraction]]


@dataclass
class Programme:
    """A linear programme: entries of each column by their row, the right-hand side, 1 for most and -1 for least."""

    columns: list[Column]
    right: list[Fraction]
    way: int


@dataclass
class Vertex:
    """The best vertex: value of the last variable, all variables, and what each row is worth."""

    value: Fraction
    x: list[Fraction]
    y: list[Fraction]


class _Floats:
    """A basis in floating point."""

    def __init__(self, columns: np.ndarray, basis: list[int]) -> None:
        self.inverse = np.linalg.inv(columns[:, basis])

    def solve(self, right: np.ndarray) -> np.ndarray:
        return np.asarray(self.inverse @ right)

    def solve_transposed(self, right: np.ndarray) -> np.ndarray:
        return np.asarray(self.inverse.T @ right)


def find_best(programme: Programme) -> Vertex | None:
    """The best vertex; None if there is none, or none was found."""
    rows, count = len(programme.right), len(programme.columns)
    dense = np.zeros((rows, count))
    for j, column in enumerate(programme.columns):
        for i, value in column.items():
            dense[i, j] = float(value)
    right = np.array([float(value) for value in programme.right])
    height = np.abs(dense[:, :-1]).max(axis=1)
    height[height == 0.0] = 1.0
    dense, right = dense / height[:, None], right / height
    size = np.linalg.norm(dense, axis=0)
    basis = _first_basis(dense / size)
    if len(basis) < rows:
        return None
    basis = _improve_floats(dense / size, right, basis, programme.way)
    return _improve_exactly(programme, basis)


def _first_basis(unit: np.ndarray) -> list[int]:
    """Independent columns."""
    left, basis = unit.copy(), []
    for j in range(unit.shape[1]):
        length = float(np.linalg.norm(left[:, j]))
        if length > DEPENDENT:
            basis.append(int(j))
            along = left[:, j] / length
            left -= np.outer(along, along @ left)
            if len(basis) == len(unit):
                break
    return basis


def _improve_floats(columns: np.ndarray, right: np.ndarray, basis: list[int], way: int) -> list[int]:
    """Exchange columns in floating point as long as that helps."""
    rows, count = columns.shape
    source = np.random.default_rng(1)
    right = right / max(np.abs(right).max(), 1e-300)
    shift = columns[:, basis] @ source.uniform(1.0, 2.0, rows)
    cost, extra = np.zeros(count), -source.uniform(np.full(count, 1.0), 2.0)
    cost[-1], extra[basis] = way, 0.0
    for _ in range(MOST_FLOAT * rows):
        solver = _Floats(columns, basis)
        x, more_x = solver.solve(right), solver.solve(shift)
        z, more_z = (columns.T @ solver.solve_transposed(c[basis]) - c for c in (cost, extra))
        z[basis] = more_z[basis] = 0.0
        step = _leaving(x, more_x, z, more_z, ROUNDING)
        if step is None:
            break
        level, entering, leaving = step
        if entering >= 0:
            change = solver.solve(columns[:, entering])
            ratio = np.where(change > ROUNDING, change / np.maximum(x + level * more_x, 1e-300), 0.0)
            leaving = int(ratio.argmax())
            if not ratio[leaving] > 0.0:
                break
        else:
            pull = np.zeros(rows)
            pull[leaving] = 1.0
            change = -(columns.T @ solver.solve_transposed(pull))
            change[basis] = 0.0
            ratio = np.where(change > ROUNDING, change / np.maximum(z + level * more_z, 1e-300), 0.0)
            entering = int(ratio.argmax())
            if not ratio[entering] > 0.0:
                break
        basis = [*basis[:leaving], entering, *basis[leaving + 1:]]
    return basis


def _leaving(x: _Numbers, more_x: _Numbers, z: _Numbers, more_z: _Numbers, zero: float) -> tuple[Any, int, int] | None:
    """Up to where a vertex is the best one of a disturbed programme, and the column or row that ends it."""
    rows = [(-value / more, -1, i) for i, (value, more) in enumerate(zip(x, more_x)) if value < -zero and more > 0]
    columns = [(-value / more, j, -1) for j, (value, more) in enumerate(zip(z, more_z)) if value < -zero and more > 0]
    found = max(rows + columns, default=None)
    return found if found is not None and found[0] > zero else None


def _times(columns: list[Column], y: list[Fraction]) -> list[Fraction]:
    """Products of all columns with a vector."""
    return [sum((value * y[i] for i, value in column.items()), Fraction(0)) for column in columns]


def _improve_exactly(programme: Programme, basis: list[int]) -> Vertex | None:
    """Exchange columns exactly, until a vertex is proven to be the best."""
    rows, count = len(programme.right), len(programme.columns)
    source = random.Random(1)
    cost, extra = [Fraction(0)] * count, [Fraction(source.randint(-200, -100)) for _ in range(count)]
    cost[-1] = Fraction(programme.way)
    for j in basis:
        extra[j] = Fraction(0)
    shift = [Fraction(0)] * rows
    for j in basis:
        weight = source.randint(100, 200)
        for i, value in programme.columns[j].items():
            shift[i] += weight * value
    for _ in range(MOST_EXACT):
        factor = Factor([programme.columns[j] for j in basis])
        x, y = factor.solve(programme.right), factor.solve_transposed([cost[j] for j in basis])
        z = [value - c for value, c in zip(_times(programme.columns, y), cost)]
        if min(x) >= 0 and min(z) >= 0:
            found = [Fraction(0)] * count
            for j, value in zip(basis, x):
                found[j] = value
            return Vertex(found[-1], found, y)
        more_x = factor.solve(shift)
        more_z = [value - c for value, c in
                  zip(_times(programme.columns, factor.solve_transposed([extra[j] for j in basis])), extra)]
        step = _leaving(x, more_x, z, more_z, 0)
        if step is None:
            return None
        level, entering, leaving = step
        if entering >= 0:
            right = [programme.columns[entering].get(i, Fraction(0)) for i in range(rows)]
            change = factor.solve(right)
            ends = [(x[i] + level * more_x[i]) / change[i] if change[i] > 0 else None for i in range(rows)]
            leaving = _least(ends)
        else:
            pull = [Fraction(int(i == leaving)) for i in range(rows)]
            change = [-value for value in _times(programme.columns, factor.solve_transposed(pull))]
            used = set(basis)
            ends = [(z[j] + level * more_z[j]) / change[j] if change[j] > 0 and j not in used else None
                    for j in range(count)]
            entering = _least(ends)
        if entering < 0 or leaving < 0:
            return None
        basis = [*basis[:leaving], entering, *basis[leaving + 1:]]
    return None


def _least(values: list[Fraction | None]) -> int:
    """Place of the least value, -1 if there is none."""
    known = [(value, k) for k, value in enumerate(values) if value is not None]
    return min(known)[1] if known else -1
