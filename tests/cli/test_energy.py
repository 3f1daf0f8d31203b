"""Every column of energy.csv and points.csv beside exact answers of one block that moves."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, on_slope, rows_of, run_blocks, turned
from dda_command import run_deck

#: 2240 kg/m3 on 1 m2, and gravity
MASS, G = 2240.0, 9.81
EXACT = 1e-10  #: What rounding leaves of thousands of steps
DYNAMIC = ("&analysis mode = 'dynamic', geometry = 'current', unknowns = 3, steps = 9999, time_step = {},"
           " duration = {}{} /\n")
OUTPUT = "&output energy = .true. /\n"
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


def energies(folder: Path, blocks: str, deck: str) -> list[dict[str, float]]:
    """Rows of energy.csv; what each column says adds up to nothing, all of it being zero before the run."""
    row = run_blocks(folder, blocks, deck + OUTPUT)
    assert row["verdict"] == "completed"
    rows = [{name: float(value) for name, value in line.items()} for line in rows_of(folder / "out" / "energy.csv")]
    return rows


def total(row: dict[str, float]) -> float:
    """What stays the same."""
    held = sum(row[name] for name in ("kinetic", "elastic", "contact", "gravity"))
    return held - row["work"] + sum(row[name] for name in ("friction", "damping", "impact", "numerical"))


def test_a_block_that_slides_turns_height_into_speed_and_friction(tmp_path: Path) -> None:
    """On a slope of 30 degrees with tan(friction) = 0.3, released at rest, for 0.5 s."""
    slope, mu = math.radians(30.0), 0.3
    ((x, y),) = turned([(0.5, 0.5)], 30.0)
    rows = energies(tmp_path, on_slope(30.0) + f"measure {x!r} {y!r}\n",
                    f"&joint friction_deg = {math.degrees(math.atan(mu))!r} /\n" + DYNAMIC.format(0.005, 0.5, ""))
    acceleration = G * (math.sin(slope) - mu * math.cos(slope))
    way = acceleration * 0.5**2 / 2.0
    last = rows[-1]
    assert last["time"] == pytest.approx(0.5)
    assert last["kinetic"] == pytest.approx(MASS * (acceleration * 0.5) ** 2 / 2.0, rel=EXACT)
    assert last["gravity"] == pytest.approx(-MASS * G * way * math.sin(slope), rel=EXACT)
    # gaps that rounding makes ask for no force: 2e-14 m of a block of 1 m
    assert last["friction"] == pytest.approx(mu * MASS * G * math.cos(slope) * way, rel=3.0 * EXACT)
    for name in ("elastic", "contact", "work", "damping"):
        assert last[name] == 0.0
    for name in ("impact", "numerical"):
        assert last[name] == pytest.approx(0.0, abs=3.0 * EXACT * last["kinetic"])
    assert max(abs(total(row)) for row in rows) < 1e-10 * last["kinetic"]
    point = rows_of(tmp_path / "out" / "points.csv")[-1]
    expected = {"u": -way * math.cos(slope), "v": -way * math.sin(slope), "x": x - way * math.cos(slope),
                "y": y - way * math.sin(slope), "vx": -acceleration * 0.5 * math.cos(slope),
                "vy": -acceleration * 0.5 * math.sin(slope)}
    for name, value in expected.items():
        assert float(point[name]) == pytest.approx(value, rel=EXACT)


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_bounce_takes_what_restitution_leaves_out(tmp_path: Path, restitution: float) -> None:
    """From 0.2 m above the ground: the impact takes (1 - e**2) of the fall."""
    ground = block([(-2.0, -1.0), (3.0, -1.0), (3.0, 0.0), (-2.0, 0.0)], "fixed")
    fall = math.sqrt(2.0 * 0.2 / G)
    rows = energies(tmp_path, ground + block([(x, y + 0.2) for x, y in SQUARE]),
                    DYNAMIC.format(0.001, 1.2 * fall, f", restitution = {restitution}"))
    energy = MASS * G * 0.2
    assert rows[-1]["impact"] == pytest.approx((1.0 - restitution**2) * energy, rel=1e-9)
    # a fifth of the time of the fall after it
    speed = restitution * G * fall - (G * 0.2 * fall if restitution else 0.0)
    assert rows[-1]["kinetic"] == pytest.approx(MASS * speed**2 / 2.0, rel=1e-8, abs=EXACT * energy)
    for name in ("friction", "numerical", "work", "damping", "elastic"):
        assert rows[-1][name] == pytest.approx(0.0, abs=1e-9 * energy)
    assert max(abs(total(row)) for row in rows) < EXACT * energy


def test_a_bar_stores_half_its_force_times_its_elongation(tmp_path: Path) -> None:
    """A block flies away from a point of the ground that a bar of 1000 N/m ties its centre to."""
    scene = block(SQUARE, "velocity 1.5 0 0") + "bar 0.5 0.5 -9.5 0.5 stiffness 1000\nmeasure 0.5 0.5\n"
    rows = energies(tmp_path, scene, "&material unit_weight = 1e-12 /\n" + DYNAMIC.format(0.01, 2.0, ""))
    ways = [float(point["u"]) for point in rows_of(tmp_path / "out" / "points.csv")][1:]
    assert max(ways) > 1.0
    start = MASS * 1.5**2 / 2.0
    for row, way in zip(rows, ways):
        assert row["elastic"] == pytest.approx(1000.0 * way**2 / 2.0, rel=1e-9)
        assert row["kinetic"] + row["elastic"] == pytest.approx(start, rel=EXACT)
        for name in ("contact", "work", "friction", "damping", "impact", "numerical"):
            assert row[name] == pytest.approx(0.0, abs=EXACT * start)


def test_a_prestressed_bar_holds_its_energy_from_the_beginning(tmp_path: Path) -> None:
    """A bar of 1e6 N/m and 1000 N presses a block on the ground; 1000**2/(2*1e6) = 0.5 J that no step brings in."""
    ground = block([(-2.0, -1.0), (3.0, -1.0), (3.0, 0.0), (-2.0, 0.0)], "fixed")
    scene = ground + block(SQUARE) + "bar 0.5 0.5 0.5 -0.5 stiffness 1e6 prestress 1000\n"
    rows = energies(tmp_path, scene, DYNAMIC.format(0.01, 0.1, ""))
    for row in rows:
        assert row["elastic"] == pytest.approx(0.5, rel=1e-6)
        assert row["numerical"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("voussoirs", "friction"), [(5, 40.0), (7, 89.9), (11, 40.0), (11, 75.0)])
def test_a_rocking_arch_gains_no_energy_in_any_step(tmp_path: Path, voussoirs: int, friction: float) -> None:
    """After a pulse of the ground, contacts open and close thousands of times: a step adds less than 1e-6 of it."""
    run_deck(
        tmp_path, f"&arch radius = 10, thickness_ratio = 0.15, half_angle_deg = 78.75, voussoirs = {voussoirs} /\n"
        f"&joint friction_deg = {friction!r} /\n&ground pulse = 'rectangular', amplitude = 5.5, duration = 0.41 /\n"
        + DYNAMIC.format(0.002, 4.0, ", collapse_rotation_deg = 45") + OUTPUT, "--quiet")
    rows = [{name: float(value) for name, value in row.items()} for row in rows_of(tmp_path / "x" / "energy.csv")]
    held = [row["kinetic"] + row["elastic"] + row["contact"] + row["gravity"] - row["work"] for row in rows]
    largest = max(row["kinetic"] for row in rows)
    assert max(after - before for before, after in zip(held, held[1:])) < 1e-6 * largest
