"""`voussoir theory`: the three analytic solutions at the command line."""

from __future__ import annotations

import argparse
import math
import sys
from typing import Any

from voussoir import theory

_COLUMNS = ("alpha_deg", "theory", "beta_deg", "beta_rad", "eta", "h")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.add_argument(
        "--alpha", metavar="DEG", nargs="+", type=_half_angle, required=True, help="half angles of embrace [deg]")
    parser.add_argument(
        "--theory", metavar="NAME", nargs="+", choices=tuple(theory.THEORIES), default=tuple(theory.THEORIES),
        help="theories: " + ", ".join(theory.THEORIES) + " (default: all)")
    parser.add_argument("--csv", action="store_true", help="print CSV with all digits")


def run(arguments: argparse.Namespace) -> int:
    """Print the table.

    Exit status, 0.
    """
    rows = [_row(alpha, name) for alpha in arguments.alpha for name in arguments.theory]
    lines = _csv(rows) if arguments.csv else _table(rows)
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


def _half_angle(word: str) -> float:
    """A half angle in degrees from the command line."""
    try:
        angle = float(word)
    except ValueError:
        angle = math.nan
    if not 0.0 < angle < 180.0:
        raise argparse.ArgumentTypeError(f"must be an angle in (0, 180) degrees, got '{word}'")
    return angle


def _row(alpha_deg: float, name: str) -> tuple[Any, ...]:
    """One line of the table: the solution, or None in its place beyond the limit of the theory."""
    alpha = math.radians(alpha_deg)
    if alpha > theory.limits(name)["alpha_limit"]:
        return (alpha_deg, name, None, None, None, None)
    beta, eta, h = (float(value) for value in theory.critical(alpha, name))
    return (alpha_deg, name, math.degrees(beta), beta, eta, h)


def _csv(rows: list[tuple[Any, ...]]) -> list[str]:
    """Lines with every digit, empty beyond the limits."""
    return [",".join(_COLUMNS)] + [
        ",".join("" if value is None else value if isinstance(value, str) else repr(value) for value in row)
        for row in rows
    ]


def _table(rows: list[tuple[Any, ...]]) -> list[str]:
    """Lines to read."""
    lines = ["{:>10}  {:<12}  {:>11}  {:>11}  {:>12}  {:>11}".format(*_COLUMNS)]
    for alpha_deg, name, *values in rows:
        head = f"{alpha_deg:>10.6g}  {name:<12}  "
        if values[0] is None:
            limit = math.degrees(theory.limits(name)["alpha_limit"])
            lines.append(head + f"no solution: this theory ends at {limit:.3f} degrees")
        else:
            lines.append(head + "{:>11.6f}  {:>11.8f}  {:>12.6e}  {:>11.8f}".format(*values))
    return lines
