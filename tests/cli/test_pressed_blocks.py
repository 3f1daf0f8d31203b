"""A block under even pressure is strained as Hooke's law has it, whatever it weighs and however it is held.

The pressure is that of forces at the corners, half of what each side next to them carries; then the stress is even
to the last digit. A weight that hangs from a point above the centre adds its moment about the centre to that.
"""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import pytest
from block_scene import run_scene
from dda_command import rows_of

Point = tuple[float, float]
Tensor = tuple[float, float, float]

YOUNG, POISSON, DENSITY = 3.7e9, 0.27, 2310.0
PRESSED = (0.0, -1.9e6, 0.0)


def turned_polygon(corners: int, radius: float) -> list[Point]:
    """A regular polygon, askew."""
    turn = [0.3 + 2.0 * math.pi * k / corners for k in range(corners)]
    return [(radius * math.cos(t), radius * math.sin(t)) for t in turn]


SHAPES = {
    "rectangle": [(0.0, 0.0), (1.7, 0.0), (1.7, 1.1), (0.0, 1.1)],
    "triangle": [(0.0, 0.0), (2.0, 0.3), (0.7, 1.9)],
    "pentagon": turned_polygon(5, 0.4),
    "hexagon": turned_polygon(6, 12.0),
    "far away": [(1000.0, 500.0), (1001.7, 500.0), (1001.7, 501.1), (1000.0, 501.1)],
}


def centre_of(shape: list[Point]) -> tuple[float, float, float]:
    """Area and centre of a polygon, rounded once."""
    exact = [(Fraction(x), Fraction(y)) for x, y in shape]
    area = x = y = Fraction(0)
    for (x1, y1), (x2, y2) in zip(exact, exact[1:] + exact[:1]):
        twice = x1 * y2 - x2 * y1
        area, x, y = area + twice / 2, x + (x1 + x2) * twice / 6, y + (y1 + y2) * twice / 6
    return float(area), float(x / area), float(y / area)


def corner_forces(shape: list[Point], stress: Tensor) -> list[list[float]]:
    """Forces at the corners that bring an even stress."""
    forces = [[0.0, 0.0] for _ in shape]
    for first, (x1, y1) in enumerate(shape):
        second = (first + 1) % len(shape)
        x2, y2 = shape[second]
        outwards = (y2 - y1, x1 - x2)
        for corner in (first, second):
            forces[corner][0] += (stress[0] * outwards[0] + stress[2] * outwards[1]) / 2.0
            forces[corner][1] += (stress[2] * outwards[0] + stress[1] * outwards[1]) / 2.0
    return forces


def hooke(stress: Tensor, plane: str) -> Tensor:
    """Strain ex, ey, gxy of a stress."""
    young, poisson = YOUNG, POISSON
    if plane == "strain":
        young, poisson = YOUNG / (1.0 - POISSON**2), POISSON / (1.0 - POISSON)
    return (
        (stress[0] - poisson * stress[1]) / young, (stress[1] - poisson * stress[0]) / young,
        2.0 * (1.0 + POISSON) / YOUNG * stress[2])


def strain_of(folder: Path) -> Tensor:
    """Strain by the displacements of three corners of the only block."""
    corners = [[float(row[name]) for name in "xyuv"] for row in rows_of(folder / "blocks.csv")]
    (x0, y0, u0, v0), (x1, y1, u1, v1), (x2, y2, u2, v2) = corners[:3]
    a, b, c, d = x1 - x0, y1 - y0, x2 - x0, y2 - y0
    area = a * d - b * c
    du, dv = (u1 - u0, u2 - u0), (v1 - v0, v2 - v0)
    return (
        (du[0] * d - du[1] * b) / area, (dv[1] * a - dv[0] * c) / area,
        (du[1] * a - du[0] * c + dv[0] * d - dv[1] * b) / area)


def strain(
    folder: Path, shape: list[Point], stress: Tensor, gravity: float, plane: str = "stress",
    above: float = 0.0, time_step: str = "",
) -> Tensor:
    """Strain of a block at rest, held above its centre, and of no other block."""
    _, x, y = centre_of(shape)
    lines = ["block", *(f"{px!r} {py!r}" for px, py in shape), f"fix {x!r} {y + above!r}"]
    lines += [f"load {px!r} {py!r} {fx!r} {fy!r}" for (px, py), (fx, fy) in zip(shape, corner_forces(shape, stress))]
    out = run_scene(
        folder, "\n".join(lines) + "\n",
        f"&material density = {DENSITY}, young = {YOUNG}, poisson = {POISSON}, plane = '{plane}' /\n"
        f"&load gravity = {gravity!r} /\n&analysis {time_step} /\n&joint friction_deg = 0.0 /\n")
    (row,) = rows_of(out / "results.csv")
    assert row["verdict"] == "stable"
    return strain_of(out)


GRAVITIES = [0.0, 1e-9, 9.81, 1e6]


@pytest.mark.parametrize("gravity", GRAVITIES)
@pytest.mark.parametrize("shape", list(SHAPES))
def test_a_pressed_block_is_strained_as_hooke_has_it(tmp_path: Path, shape: str, gravity: float) -> None:
    found = strain(tmp_path, SHAPES[shape], PRESSED, gravity)
    exact = (POISSON * 1.9e6 / YOUNG, -1.9e6 / YOUNG, 0.0)
    assert found == pytest.approx(exact, rel=1e-9, abs=1e-9 * max(map(abs, exact)))


@pytest.mark.parametrize("gravity", GRAVITIES)
@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("time_step", ["", "time_step = 1e-5", "time_step = 1.0", "time_step = 1e4"])
def test_neither_plane_nor_time_step_nor_shear_change_that(
    tmp_path: Path, gravity: float, plane: str, time_step: str
) -> None:
    stress = (1.1e6, -2.3e6, 0.7e6)
    found = strain(tmp_path, SHAPES["pentagon"], stress, gravity, plane, time_step=time_step)
    exact = hooke(stress, plane)
    assert found == pytest.approx(exact, rel=1e-9, abs=1e-9 * max(map(abs, exact)))


@pytest.mark.parametrize("gravity", GRAVITIES)
@pytest.mark.parametrize("shape", ["rectangle", "triangle", "hexagon"])
def test_a_block_that_hangs_is_strained_by_its_weight_too(tmp_path: Path, shape: str, gravity: float) -> None:
    above = 0.2
    found = strain(tmp_path, SHAPES[shape], PRESSED, gravity, above=above)
    exact = hooke((0.0, PRESSED[1] + DENSITY * gravity * above, 0.0), "stress")
    assert found == pytest.approx(exact, rel=1e-9, abs=1e-9 * max(map(abs, exact)))
