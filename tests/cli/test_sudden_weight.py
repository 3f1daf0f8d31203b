"""Weight that acts at once on elastic blocks makes them swing, whatever the time step."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, run_scene
from dda_command import rows_of

DENSITY, G = 2240.0, 9.81
HALF_SPAN, COUNT = 10.0, 36


def run(folder: Path, blocks: str, keys: str, young: float) -> Path:
    """Folder of the results of a run without restitution."""
    return run_scene(
        folder, blocks, "&joint friction_deg = 50 /\n"
        f"&material young = {young!r}, poisson = 0 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', unknowns = 6, restitution = 0, steps = 99999, "
        f"{keys} /\n&output energy = .true. /")


@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4])
def test_a_column_sinks_twice_as_deep_as_at_rest(tmp_path: Path, step: float) -> None:
    """An elastic bar whose weight acts at once: its top sinks by rho g L^2/E until 2L/c, c^2 = E/rho."""
    young, height, count = 1e9, 0.5, 20
    length = count * height
    blocks = block([(-1.0, -1.0), (2.0, -1.0), (2.0, 0.0), (-1.0, 0.0)], "fixed")
    for i in range(count):
        low, high = i * height, (i + 1) * height
        blocks += block([(0.0, low), (1.0, low), (1.0, high), (0.0, high)])
    half_swing = 2.0 * length / math.sqrt(young / DENSITY)
    out = run(tmp_path, blocks + f"measure 0.5 {length!r}\n",
              f"time_step = {step!r}, duration = {1.5 * half_swing!r}", young)
    rows = rows_of(out / "points.csv")
    deepest = min(rows, key=lambda row: float(row["v"]))
    assert float(deepest["v"]) == pytest.approx(-DENSITY * G * length**2 / young, rel=50.0 * step)
    assert float(deepest["time"]) == pytest.approx(half_swing, rel=0.05, abs=2.5 * step)


def arch(thickness: float) -> str:
    """A half circle of voussoirs on two fixed blocks; thickness over its radius."""
    outer, inner = HALF_SPAN * (1.0 + thickness / 2.0), HALF_SPAN * (1.0 - thickness / 2.0)
    text = ""
    for a, b in ((-outer - 3.0, 3.0 - inner), (inner - 3.0, outer + 3.0)):
        text += block([(a, -2.0), (b, -2.0), (b, 0.0), (a, 0.0)], "fixed")
    for i in range(COUNT):
        a, b = math.pi * i / COUNT, math.pi * (i + 1) / COUNT
        text += block([(r * math.cos(t), r * math.sin(t)) for r, t in ((inner, a), (outer, a), (outer, b), (inner, b))])
    return text


@pytest.mark.parametrize("step", [5e-3, 2e-3, 1e-3])
@pytest.mark.parametrize(("thickness", "young", "start", "falls"), [
    (0.108, 1e9, "unloaded", True), (0.11, 1e9, "unloaded", True), (0.108, 1e9, "static", False),
    (0.108, 1e10, "unloaded", True), (0.11, 1e10, "unloaded", False), (0.108, 1e12, "unloaded", False)])
def test_an_arch_falls_or_stands_at_every_time_step(tmp_path: Path, step: float, thickness: float, young: float,
                                                    start: str, falls: bool) -> None:
    """At rest 0.1074 is critical. Runs of 0.1 ms resolve the strain for 1e9 and 1e10, and agree; 1e12 is near rigid."""
    out = run(tmp_path, arch(thickness), f"start = '{start}', time_step = {step!r}, duration = 1.5", young)
    last = float(rows_of(out / "energy.csv")[-1]["kinetic"])
    assert last > 1e3 if falls else last < 1.0
