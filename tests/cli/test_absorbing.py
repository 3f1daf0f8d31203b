"""Faces that let waves out: a dashpot stops a block as its impedance says, and a pulse does not come back."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest
from block_scene import block, run_scene

SQUARE = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]


def table(folder: Path, name: str) -> list[dict[str, float]]:
    """Rows of a table of numbers."""
    with (folder / "out" / f"{name}.csv").open(newline="") as lines:
        return [{key: float(value or "nan") for key, value in row.items()} for row in csv.DictReader(lines)]


@pytest.mark.parametrize("geometry", ["reference", "current"])
@pytest.mark.parametrize(("velocity", "rate"), [((0.0, 0.1), 40.0), ((0.1, 0.0), 16.0)])
def test_block_between_dashpots_slows_down_by_its_impedance(
    tmp_path: Path, geometry: str, velocity: tuple[float, float], rate: float
) -> None:
    # two faces of density c L against a mass of density L h: v = v0 exp(-2 c t/h), c across the faces or along them
    words = f"velocity {velocity[0]} {velocity[1]} 0"
    scene = block(SQUARE, words) + "measure 1 0.5\n"
    scene += "".join(f"absorb 0 {y} 2 {y} p_speed 20 s_speed 8\n" for y in (0, 1))
    mode = f"&analysis mode = 'dynamic', geometry = '{geometry}', duration = 0.1, time_step = 5e-4, steps = 1000"
    run_scene(tmp_path, scene, f"&load gravity = 0 /\n{mode}, unknowns = 3 /\n")
    last = table(tmp_path, "points")[-1]
    name, start = ("vy", velocity[1]) if velocity[1] else ("vx", velocity[0])
    assert last[name] == pytest.approx(start * math.exp(-rate * 0.1), rel=1e-3)


def test_direction_that_is_not_absorbed_is_free(tmp_path: Path) -> None:
    scene = block(SQUARE, "velocity 0.1 0.2 0") + "absorb 0 0 2 0 y\nmeasure 1 0.5\n"
    mode = "&analysis mode = 'dynamic', duration = 0.05, time_step = 1e-3, steps = 100, unknowns = 3 /\n"
    run_scene(tmp_path, scene, "&load gravity = 0 /\n" + mode)
    last = table(tmp_path, "points")[-1]
    assert last["u"] == pytest.approx(0.1 * 0.05, rel=1e-12)
    assert abs(last["vy"]) < 1e-6


@pytest.mark.parametrize("geometry", ["reference", "current"])
@pytest.mark.parametrize("base", ["absorb 0 0 1 0\n", "fix_line 0 0 1 0\n"])
def test_pulse_in_a_column_does_not_come_back(tmp_path: Path, geometry: str, base: str) -> None:
    # a pulse of 20 m in a column of 50 m and 1000 m/s: it has left after 0.07 s, or is on its way back
    duration, parts = 0.02, 40
    scene = "".join(block([(0.0, k), (1.0, k), (1.0, k + 1.0), (0.0, k + 1.0)]) for k in range(50)) + base
    for x in (0.25, 0.75):
        scene += f"load {x} 50\n"
        for i in range(parts + 1):
            scene += f"{duration * i / parts!r} 0 {-1e5 * math.sin(math.pi * i / parts) ** 2!r}\n"
    run_scene(
        tmp_path,
        scene,
        "&material density = 2500, young = 2.5e9, poisson = 0 /\n&load gravity = 0 /\n"
        "&joint cohesion = 1e9, tension = 1e9 /\n&output energy = .true. /\n"
        f"&analysis mode = 'dynamic', geometry = '{geometry}', duration = 0.1, time_step = 2e-4, steps = 1000 /\n",
    )
    rows = table(tmp_path, "energy")
    energy = [row["kinetic"] + row["elastic"] + row["contact"] * (geometry == "reference") for row in rows]
    at = [min(range(len(rows)), key=lambda k: abs(rows[k]["time"] - time)) for time in (0.045, 0.09)]
    left = energy[at[1]] / energy[at[0]]
    if base.startswith("absorb"):
        assert left < 1e-4
        assert rows[at[1]]["damping"] > 0.9 * energy[at[0]]
    else:
        assert left > 0.85
    end = rows[-1]
    # what contacts leave of gaps and slips is booked where it acts: 1e-7 of the work
    contacts = end["friction"] + end["impact"]
    assert abs(contacts) < 1e-6 * end["work"]
    assert energy[-1] + end["damping"] + end["numerical"] + contacts == pytest.approx(end["work"], rel=1e-9)
