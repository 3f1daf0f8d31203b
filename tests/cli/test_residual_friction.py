"""Joints that lose strength by slip, against closed forms and a motion integrated apart."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, on_slope, rows_of, run_blocks, turned
from dda_command import run_dda

GRAVITY = 9.81
MOTION = (
    "&analysis mode = 'dynamic', geometry = 'current', time_step = {}, duration = 1.0, steps = 100000, unknowns = 3 /\n"
)


def slope(angle: float, speed: float) -> str:
    """A block that begins to slide down a long slope."""
    base = turned([(-60.0, -3.0), (6.0, -3.0), (6.0, 0.0), (-60.0, 0.0)], angle)
    u, v = turned([(-speed, 0.0)], angle)[0]
    middle = turned([(0.5, 0.5)], angle)[0]
    return (
        block(base, "fixed")
        + block(turned([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], angle), f"velocity {u!r} {v!r} 0")
        + f"measure {middle[0]!r} {middle[1]!r}\n"
    )


def way(folder: Path) -> float:
    """How far the measured point has gone."""
    first, *_, last = rows_of(folder / "out" / "points.csv")
    return math.hypot(*(float(last[name]) - float(first[name]) for name in "xy"))


def integrated(angle: float, peak: float, rest: float, length: float, speed: float) -> float:
    """Way of the block in a second, by small steps."""
    sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    peak, rest = math.tan(math.radians(peak)), math.tan(math.radians(rest))
    x, step = 0.0, 1e-5
    for _ in range(100000):
        left = max(0.0, 1.0 - x / length) if length > 0.0 else 0.0
        speed = max(0.0, speed + GRAVITY * (sine - (rest + (peak - rest) * left) * cosine) * step)
        x += speed * step
    return x


@pytest.mark.parametrize(("rest", "length"), [(20.0, 0.0), (20.0, 0.1), (28.0, 0.5), (35.0, 0.0), (10.0, 0.02)])
def test_a_sliding_block_loses_friction_by_its_slip(tmp_path: Path, rest: float, length: float) -> None:
    law = f"&joint friction_deg = 35, residual_deg = {rest}, slip_length = {length} /\n"
    exact = integrated(30.0, 35.0, rest, length, 0.5)
    error = []
    for step in (2e-3, 1e-3):
        row = run_blocks(tmp_path, slope(30.0, 0.5), law + MOTION.format(step))
        assert row["verdict"] == "completed"
        error.append(abs(way(tmp_path) / exact - 1.0))
    assert error[1] < 3e-3
    assert error[1] < 0.7 * error[0] + 1e-5


@pytest.mark.parametrize(("angle", "peak", "rest", "speed"), [(30.0, 35.0, 20.0, 2.0), (25.0, 24.0, 10.0, 0.3)])
def test_slip_that_weakens_is_of_second_order(
    tmp_path: Path, angle: float, peak: float, rest: float, speed: float
) -> None:
    """Strength that falls linearly with slip makes x'' = a + b x: a hyperbolic cosine and sine."""
    law = f"&joint friction_deg = {peak}, residual_deg = {rest}, slip_length = 9 /\n"
    begin, end = math.tan(math.radians(peak)), math.tan(math.radians(rest))
    normal = GRAVITY * math.cos(math.radians(angle))
    drive, growth = GRAVITY * math.sin(math.radians(angle)) - normal * begin, math.sqrt(normal * (begin - end) / 9.0)
    exact = speed / growth * math.sinh(growth) + drive / growth**2 * (math.cosh(growth) - 1.0)
    error = []
    for step in (4e-3, 2e-3):
        run_blocks(tmp_path, slope(angle, speed), law + MOTION.format(step))
        error.append(abs(way(tmp_path) / exact - 1.0))
    assert error[0] < 1e-5
    assert error[1] < error[0] / 3.5 + 1e-9


def test_a_joint_that_slides_back_and_forth_does_not_heal(tmp_path: Path) -> None:
    """A quake to and fro wears the joint; afterwards a slope that held lets go."""
    base = on_slope(25.0) + "base_acceleration\n0 0 0\n0.1 8 0\n0.3 -8 0\n0.4 0 0\n0.5 0 0\nmeasure 0 0.5\n"
    motion = MOTION.replace("duration = 1.0", "duration = 2.0").format(2e-3)
    run_blocks(tmp_path, base, "&joint friction_deg = 35 /\n" + motion)
    held = way(tmp_path)
    row = run_blocks(tmp_path, base, "&joint friction_deg = 35, residual_deg = 20 /\n" + motion)
    assert row["verdict"] in ("completed", "undecided")
    assert way(tmp_path) > held + 0.5


@pytest.mark.parametrize("geometry", ["reference", "current"])
def test_what_holds_a_block_that_has_slid_carries_more(tmp_path: Path, geometry: str) -> None:
    """Two blocks on a slope of 30 degrees; the upper one slides at 20 degrees and leans on the lower one."""
    sine, cosine = 0.5, math.cos(math.radians(30.0))

    def needed(friction: float) -> float:
        """Friction angle of the lower block that carries both."""
        return math.degrees(math.atan(2 * sine / cosine - math.tan(math.radians(friction))))

    def verdict(lower: float, words: str) -> str:
        scene = (
            block(turned([(-9.0, -3.0), (6.0, -3.0), (6.0, 0.0), (-9.0, 0.0)], 30.0), "fixed")
            + block(turned([(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)], 30.0), "material 2")
            + block(turned([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 30.0), "material 3")
            + f"material 2 density 2000\nmaterial 3 density 2000\njoint 1 2 friction_deg 20 {words}\n"
            + f"joint 1 3 friction_deg {lower!r} residual_deg 10\njoint 2 3 friction_deg 0\n"
        )
        return run_blocks(tmp_path, scene, f"&analysis geometry = '{geometry}', steps = 4000 /\n")["verdict"]

    assert needed(20.0) < needed(10.0)
    for words, limit in (("", needed(20.0)), ("residual_deg 10", needed(10.0))):
        assert verdict(limit - 0.05, words) == "collapsed"
        assert verdict(limit + 0.05, words) == "stable"


def test_a_joint_that_has_not_slid_keeps_its_friction(tmp_path: Path) -> None:
    for angle, verdict in ((34.9, "stable"), (35.1, "collapsed")):
        row = run_blocks(tmp_path, on_slope(angle), "&joint friction_deg = 35, residual_deg = 5 /\n")
        assert row["verdict"] == verdict
        assert row["exact_low"] == row["imbalance"] == ""


def test_a_run_goes_on_with_the_strength_that_is_left(tmp_path: Path) -> None:
    keys = "&joint friction_deg = 35, residual_deg = 20, slip_length = 0.3 /\n"
    whole = run_blocks(tmp_path, slope(30.0, 0.5), keys + MOTION.format(1e-3))
    far = way(tmp_path)
    # after a number of steps: at a duration the last step would be another one
    half = MOTION.format(1e-3).replace("steps = 100000", "steps = 400")
    run_blocks(tmp_path, slope(30.0, 0.5), keys + half + "&output restart = .true. /\n")
    (tmp_path / "out" / "case_1.restart").rename(tmp_path / "half.restart")
    rest = MOTION.format(1e-3).replace("unknowns", "restart = 'half.restart', unknowns")
    row = run_blocks(tmp_path, slope(30.0, 0.5), keys + rest)
    assert row["verdict"] == whole["verdict"] == "completed"
    last = rows_of(tmp_path / "out" / "points.csv")[-1]
    middle = turned([(0.5, 0.5)], 30.0)[0]
    assert math.hypot(float(last["x"]) - middle[0], float(last["y"]) - middle[1]) == pytest.approx(far, abs=1e-15)


REFUSED = {
    "file and flow": ("&analysis flow = 'associated' /\n", "joint 1 1 residual_deg 20\n", "analysis%flow needs joints"),
    "limerick": ("&analysis mode = 'limerick' /\n", "joint 1 1 slip_length 1\n", "analysis%mode needs joints"),
    "too much": ("", "joint 1 1 friction_deg 30 residual_deg 40\n", "residual_deg must be at most friction_deg, 30"),
    "below": ("", "joint 1 1 friction_deg 30 residual_deg -4\n", "must be a number [deg] from 0 to 90, got -4"),
    "strength": ("&material compressive_strength = 1e6 /\n&analysis flow = 'associated' /\n",
                 "joint 1 1 residual_deg 20\n", "needs"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_lose_strength_is_refused(tmp_path: Path, case: str) -> None:
    deck, entry, message = REFUSED[case]
    (tmp_path / "scene.blocks").write_text(on_slope(20.0) + entry)
    (tmp_path / "deck.nml").write_text("&scene kind = 'blocks', geometry = 'scene.blocks' /\n" + deck)
    done = run_dda("check", "deck.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr and "error: " in done.stderr
