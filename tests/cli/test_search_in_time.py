"""Searches with mode = 'dynamic': what makes blocks collapse within a duration."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda, run_deck

FREE = "block fixed\n-9 -1\n9 -1\n9 0\n-9 0\nblock\n0 0\n1 0\n1 2\n0 2\nmeasure 0.5 1\n"
SLENDER = "block fixed\n-3 -1\n5 -1\n5 0\n-3 0\nblock\n0 0\n0.4 0\n0.4 2\n0 2\nmeasure 0.2 2\n"
#: A sine of one period carries a free block by A T^2/2 pi and leaves it at rest there
PERIOD, LIMIT = 0.25, 0.05
EXACT = 2 * math.pi * LIMIT / PERIOD**2


def search(folder: Path, blocks: str, groups: str, *settings: str) -> tuple[dict[str, str], str, int]:
    """Row, log and status of a search in time."""
    (folder / "x.blocks").write_text(blocks)
    (folder / "x.nml").write_text(f"&scene kind = 'blocks', geometry = 'x.blocks' /\n{groups}\n")
    done = run_dda("run", "x.nml", "--out", "out", "--quiet", *settings, cwd=folder)
    assert done.returncode in (0, 3), done.stderr
    (row,) = rows_of(folder / "out" / "results.csv")
    return row, (folder / "out" / "log.txt").read_text().splitlines()[1], done.returncode


def sine(low: float, high: float, parameter: str = "amplitude", collapse: str = "") -> str:
    """A search for what carries a free block farther than LIMIT."""
    return (
        f"&load gravity = 0 /\n&ground pulse = 'sine', amplitude = 1.0, frequency = {1 / PERIOD} /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 0.6, steps = 100000, time_step = 0.002,"
        f" collapse_displacement = {LIMIT}{collapse} /\n"
        f"&search parameter = 'ground%{parameter}', low = {low}, high = {high} /"
    )


@pytest.mark.parametrize("parameter", ["amplitude", "scale"])
def test_a_search_brackets_the_exact_amplitude(tmp_path: Path, parameter: str) -> None:
    row, log, _ = search(tmp_path, FREE, sine(1.0, 20.0, parameter))
    assert row["verdict"] == "found" and row["collapses_at"] == "high"
    assert float(row["critical"]) == pytest.approx(EXACT, rel=3e-4)
    assert 0 < float(row["critical_high"]) - float(row["critical_low"]) <= 1.001e-4 * EXACT
    assert log == "1 found 8 values on both sides agree with it"


def test_the_slowest_sine_carries_farthest(tmp_path: Path) -> None:
    """A/2 pi f^2 > LIMIT falls: the search tells that low collapses."""
    row, _, _ = search(tmp_path, FREE, sine(1.5, 20.0, "frequency"))
    assert row["collapses_at"] == "low"
    assert float(row["critical"]) == pytest.approx(math.sqrt(1.0 / (2 * math.pi * LIMIT)), rel=3e-4)


def test_what_still_moves_away_is_undecided(tmp_path: Path) -> None:
    """A rectangular pulse leaves a free block with a speed: it passes any distance later."""
    groups = sine(0.1, 1.0).replace("'sine'", "'rectangular'").replace(f"frequency = {1 / PERIOD}", "duration = 0.1")
    row, log, status = search(tmp_path, FREE, groups)
    assert row["verdict"] == "undecided" and status == 3
    assert "still move away at the end of the run; give a longer duration" in log


def test_a_block_that_lies_flat_is_not_said_to_survive(tmp_path: Path) -> None:
    """It has turned by 90 degrees and not by more: the remark says that this angle hides its fall."""
    groups = (
        "&joint friction_deg = 78 /\n&ground pulse = 'rectangular', amplitude = -2.943, duration = 0.6 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 4, steps = 100000, time_step = 0.002,"
        " unknowns = 3, collapse_rotation_deg = {} /\n")
    row, log, _ = search(tmp_path, SLENDER, groups.format(95))
    assert row["verdict"] == "completed"
    assert "turned by 9" in log and "less than collapse_rotation_deg = 95: this may be a collapse; set 45" in log
    assert search(tmp_path, SLENDER, groups.format(45))[0]["verdict"] == "collapsed"


def test_a_block_is_overturned_by_the_pulse_of_rigid_rocking(tmp_path: Path) -> None:
    """0.4 x 2 m, 0.3 g: 0.40905 s by integration of the nonlinear equation (docs/validation.md)."""
    row, log, _ = search(
        tmp_path, SLENDER,
        "&joint friction_deg = 78 /\n&ground pulse = 'rectangular', amplitude = -2.943 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 4, steps = 100000, time_step = 0.002,"
        " unknowns = 3 /\n"
        "&search parameter = 'ground%duration', low = 0.3, high = 0.5, tolerance = 2e-3 /")
    assert row["verdict"] == "found", log
    assert float(row["critical"]) == pytest.approx(0.40905, rel=0.005)


def test_the_least_friction_that_holds_a_block_in_a_pulse(tmp_path: Path) -> None:
    """A pulse a, T moves a block with friction r = mu g by a (a - r) T^2/2 r (Newmark 1965)."""
    a, time = 4.0, 0.2
    row, _, _ = search(
        tmp_path, FREE,
        f"&ground pulse = 'rectangular', amplitude = {a}, duration = {time} /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 1, steps = 100000, time_step = 0.002,"
        f" collapse_displacement = {LIMIT}, unknowns = 3 /\n"
        "&search parameter = 'friction_deg', low = 5, high = 40, tolerance = 1e-3 /")
    friction = a**2 * time**2 / (2 * LIMIT + a * time**2)
    assert row["verdict"] == "found" and row["collapses_at"] == "low"
    assert float(row["critical"]) == pytest.approx(math.degrees(math.atan(friction / 9.81)), rel=2e-3)


def test_the_restitution_that_throws_a_block_back_above_its_start(tmp_path: Path) -> None:
    """From 0.1 m above the ground at 3 m/s down, it rises to e^2 (0.1 + 9/2g)."""
    blocks = FREE.replace("block\n0 0\n1 0\n1 2\n0 2", "block velocity 0 -3 0\n0 0.1\n1 0.1\n1 2.1\n0 2.1")
    row, log, _ = search(
        tmp_path, blocks,
        "&analysis mode = 'dynamic', geometry = 'current', duration = 1.5, steps = 100000, time_step = 0.002,"
        " collapse_displacement = 0.2, unknowns = 3 /\n"
        "&search parameter = 'restitution', low = 0.3, high = 1.0, tolerance = 1e-3 /")
    assert row["verdict"] == "found", log
    assert float(row["critical"]) == pytest.approx(math.sqrt(0.3 / (0.1 + 9 / (2 * 9.81))), rel=2e-3)


def test_the_damping_that_stops_a_block_in_time(tmp_path: Path) -> None:
    """A block of 2 m/s goes v/c."""
    blocks = FREE.replace("block\n0 0", "block velocity 2 0 0\n0 0")
    row, log, _ = search(
        tmp_path, blocks,
        "&load gravity = 0 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 2, steps = 100000, time_step = 0.002,"
        " collapse_displacement = 0.2 /\n"
        "&search parameter = 'damping', low = 5, high = 20, tolerance = 1e-3 /")
    assert row["verdict"] == "found" and row["collapses_at"] == "low", log
    assert float(row["critical"]) == pytest.approx(10.0, rel=2e-3)


def test_the_thickness_that_withstands_a_pulse(tmp_path: Path) -> None:
    """An arch of 0.15 bears 1 g for 0.2239 s by an integrator written apart; so 0.2239 s want 0.15."""
    run_deck(
        tmp_path, "&arch half_angle_deg = 78.75, voussoirs = 7 /\n&joint friction_deg = 89.9 /\n"
        "&ground pulse = 'rectangular', amplitude = 9.81, duration = 0.2239 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', unknowns = 3, time_step = 0.01, duration = 5,"
        " steps = 100000, max_displacement_ratio = 0.02 /\n"
        "&search parameter = 'thickness_ratio', low = 0.14, high = 0.16, tolerance = 0.02 /\n", "--quiet", name="a")
    (row,) = rows_of(tmp_path / "a" / "results.csv")
    assert row["verdict"] == "found" and row["collapses_at"] == "low" and row["thickness_ratio"] == ""
    assert float(row["critical"]) == pytest.approx(0.15, rel=0.02)


def test_an_undecided_search_has_the_bracket_of_its_remark(tmp_path: Path) -> None:
    """A slender block that hovers upright at the end of its run has neither fallen nor come back."""
    row, log, status = search(
        tmp_path, SLENDER,
        "&joint friction_deg = 78 /\n&ground pulse = 'rectangular', amplitude = -2.943 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 2, steps = 100000, time_step = 0.004,"
        " unknowns = 3 /\n"
        "&search parameter = 'ground%duration', low = 0.1, high = 1.0, tolerance = 1e-9 /")
    assert status == 3 and row["verdict"] == "undecided"
    ends = [float(word) for word in re.search(r"collapsed at (\S+), stable at (\S+)", log).groups()]
    assert [float(row["critical_low"]), float(row["critical_high"])] == pytest.approx(sorted(ends), rel=1e-5)
    assert row["critical"] == ""
