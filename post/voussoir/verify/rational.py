"""Rational numbers: decimals as they are written, sines to forty digits, sparse systems of equations."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import isqrt

#: Pi, cut after fifty decimals
PI = Fraction("3.14159265358979323846264338327950288419716939937510")
#: Sines are known to so many parts of one
PARTS = 10**40
#: They are added up in so many
FINE = 10**50
Column = dict[int, Fraction]


@lru_cache(maxsize=4096)
def sine_cosine(degrees: Fraction) -> tuple[Fraction, Fraction]:
    """Sine and cosine of an angle in degrees, rounded to forty decimals."""
    quarters = round(degrees / 90)
    angle = round((degrees - 90 * quarters) * PI / 180 * FINE)
    sums, term = [0, 0], FINE
    for k in range(44):
        sums[k % 2] += term if k % 4 < 2 else -term
        term = term * angle // ((k + 1) * FINE)
    cosine, sine = (Fraction(round(Fraction(value * PARTS, FINE)), PARTS) for value in sums)
    turns = [(sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine)]
    return turns[quarters % 4]


def square_root(value: Fraction) -> Fraction:
    """Square root of a number that is not negative, to forty digits."""
    # digits of the root are counted from its first one on
    scale = 10 ** (40 + max(0, len(str(value.denominator)) - len(str(value.numerator))))
    return Fraction(isqrt(value.numerator * value.denominator * scale**2), value.denominator * scale)


class Factor:
    """A square sparse matrix of columns, taken apart exactly."""

    def __init__(self, columns: list[Column]) -> None:
        rows: dict[int, Column] = {k: {} for k in range(len(columns))}
        users: dict[int, set[int]] = {j: set(column) for j, column in enumerate(columns)}
        for j, entries in enumerate(columns):
            for i, value in entries.items():
                rows[i][j] = value
        self.steps: list[tuple[int, int, Fraction, Column, Column]] = []
        while rows:
            row = min(rows, key=lambda i: (len(rows[i]), i))
            if not rows[row]:
                raise ZeroDivisionError("the matrix is singular")
            entries = rows.pop(row)
            _, column = min((len(users[j]), j) for j in entries)
            pivot = entries.pop(column)
            for j in entries:
                users[j].discard(row)
            multipliers: Column = {}
            for i in users.pop(column):
                if i == row:
                    continue
                share = multipliers[i] = rows[i].pop(column) / pivot
                for j, value in entries.items():
                    new = rows[i].get(j, 0) - share * value
                    if new:
                        rows[i][j] = new
                        users[j].add(i)
                    elif j in rows[i]:
                        del rows[i][j]
                        users[j].discard(i)
            self.steps.append((row, column, pivot, entries, multipliers))

    def solve(self, right: list[Fraction]) -> list[Fraction]:
        """Solve with the matrix."""
        left, found = list(right), [Fraction(0)] * len(right)
        for row, _, _, _, multipliers in self.steps:
            if left[row]:
                for i, share in multipliers.items():
                    left[i] -= share * left[row]
        for row, column, pivot, entries, _ in reversed(self.steps):
            found[column] = (left[row] - sum(value * found[j] for j, value in entries.items() if found[j])) / pivot
        return found

    def solve_transposed(self, right: list[Fraction]) -> list[Fraction]:
        """Solve with the transpose."""
        left, found = list(right), [Fraction(0)] * len(right)
        for row, column, pivot, entries, _ in self.steps:
            share = found[row] = left[column] / pivot
            if share:
                for j, value in entries.items():
                    left[j] -= share * value
        for row, _, _, _, multipliers in reversed(self.steps):
            found[row] -= sum(share * found[i] for i, share in multipliers.items() if found[i])
        return found
