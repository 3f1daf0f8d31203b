"""Linear programmes in rational numbers: the best vertex, found in floating point and proven exactly.

The programme is: most (or least) of the last variable, with columns * x = right and x >= 0. A vertex is a
set of columns; the self-dual simplex method leads from any of them to the best one.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Any, Union

import numpy as np

from voussoir.verify.rational import Column, Factor

#: What rounding leaves of zero, and columns that count as dependent
ROUNDING, DEPENDENT = 1e-10, 1e-7
#: Most exchanges of a column, in floating point for each row and exactly
MOST_FLOAT, MOST_EXACT = 20, 300


class _Floats:
    """A basis of dense columns in floating point."""

    def __init__(self, columns: np.ndarray, basis: list[int]) -> None:
        self.columns, self.inverse = columns, np.linalg.inv(columns[:, basis])

    def column(self, j: int) -> np.ndarray:
        """A column."""
        return np.asarray(self.columns[:, j])

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solve with the columns of the basis."""
        return np.asarray(self.inverse @ right)

    def prices(self, cost: np.ndarray) -> np.ndarray:
        """Products of all columns with the solution of the transposed equations."""
        return np.asarray(self.columns.T @ (self.inverse.T @ cost))


class _Fractions:
    """The same of sparse columns in fractions, as arrays of objects."""

    def __init__(self, columns: list[Column], basis: list[int]) -> None:
        self.columns, self.factor = columns, Factor([columns[j] for j in basis])

    def column(self, j: int) -> np.ndarray:
        """A column."""
        return np.array([self.columns[j].get(i, Fraction(0)) for i in range(len(self.factor.steps))], dtype=object)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solve with the columns of the basis."""
        return np.array(self.factor.solve(list(right)), dtype=object)

    def prices(self, cost: np.ndarray) -> np.ndarray:
        """Products of all columns with the solution of the transposed equations."""
        y = self.factor.solve_transposed(list(cost))
        products = (sum((value * y[i] for i, value in column.items()), Fraction(0)) for column in self.columns)
        return np.array(list(products), dtype=object)


def find_best(columns: list[Column], right: list[Fraction], way: int) -> list[Fraction] | None:
    """All variables at the vertex with most (way 1) or least (-1) of the last one; None if none was found."""
    rows, count = len(right), len(columns)
    dense, sides = np.zeros((rows, count)), np.array([float(value) for value in right])
    for j, column in enumerate(columns):
        dense[list(column), j] = [float(value) for value in column.values()]
    height = np.abs(dense[:, :-1]).max(axis=1)
    height[height == 0.0] = 1.0
    dense, sides = dense / height[:, None], sides / height
    dense = dense / np.linalg.norm(dense, axis=0)
    basis = _first_basis(dense)
    if len(basis) < rows:
        return None
    source, cost = np.random.default_rng(1), np.zeros(count)
    cost[-1] = way
    shift, extra = source.uniform(1.0, 2.0, rows), -source.uniform(np.full(count, 1.0), 2.0)
    basis, _, _ = _improve(
        partial(_Floats, dense), sides / max(np.abs(sides).max(), 1e-300), cost, shift, extra, basis, ROUNDING,
        MOST_FLOAT * rows)
    whole = random.Random(1)
    extra = np.array([Fraction(whole.randint(-200, -100)) for _ in range(count)])
    shift = np.array([Fraction(whole.randint(100, 200)) for _ in range(rows)])
    cost = np.full(count, Fraction(0))
    cost[-1] = Fraction(way)
    basis, x, z = _improve(
        partial(_Fractions, columns), np.array(right), cost, shift, extra, basis, 0.0, MOST_EXACT)
    if min(x) < 0 or min(z) < 0:
        return None
    values = dict(zip(basis, x))
    return [values.get(j, Fraction(0)) for j in range(count)]


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


def _improve(
    make: Callable[[list[int]], Union[_Floats, _Fractions]], right: np.ndarray, cost: np.ndarray, weights: np.ndarray,
    extra: np.ndarray, basis: list[int], zero: float, most: int
) -> tuple[list[int], np.ndarray, np.ndarray]:
    """Exchange columns of a basis as long as that helps: the last basis, its variables and its reduced costs.

    The programme is disturbed by a level times what `weights` of the columns of the first basis carry, and times
    `extra` costs of the other columns; the level falls from one exchange to the next.
    """
    solver = make(basis)
    extra[basis] = 0 * extra[0]
    for turn in range(most + 1):
        x, z = solver.solve(right), solver.prices(cost[basis]) - cost
        z[basis] = 0 * z[0]
        if turn == most or min(x) >= -zero and min(z) >= -zero:
            break
        if turn == 0:
            shift = sum(weight * solver.column(j) for weight, j in zip(weights, basis))
        more_x, more_z = solver.solve(shift), solver.prices(extra[basis]) - extra
        more_z[basis] = 0 * z[0]
        level, entering, leaving = _leaving(x, more_x, z, more_z, zero)
        if not level > zero:
            break
        if entering >= 0:
            leaving = _first_to_end(solver.solve(solver.column(entering)), x + level * more_x, zero)
        else:
            pull = 0 * x
            pull[leaving] += 1
            change = -solver.prices(pull)
            change[basis] = 0 * change[0]
            entering = _first_to_end(change, z + level * more_z, zero)
        if entering < 0 or leaving < 0:
            break
        basis = [*basis[:leaving], entering, *basis[leaving + 1:]]
        solver = make(basis)
    return basis, x, z


def _leaving(x: np.ndarray, more_x: np.ndarray, z: np.ndarray, more_z: np.ndarray, zero: float) -> tuple[Any, int, int]:
    """Up to where a vertex is the best one of a disturbed programme, and the column or row that ends it."""
    rows = [(-value / more, -1, i) for i, (value, more) in enumerate(zip(x, more_x)) if value < -zero and more > 0]
    columns = [(-value / more, j, -1) for j, (value, more) in enumerate(zip(z, more_z)) if value < -zero and more > 0]
    return max(rows + columns, default=(0.0, -1, -1))


def _first_to_end(change: np.ndarray, rest: np.ndarray, zero: float) -> int:
    """Place of the value that its change first brings to an end; -1 if none does."""
    ratio = [slope / max(value, 1e-300) if slope > zero else 0.0 for slope, value in zip(change, rest)]
    best = max(range(len(ratio)), key=ratio.__getitem__)
    return best if ratio[best] > 0.0 else -1
