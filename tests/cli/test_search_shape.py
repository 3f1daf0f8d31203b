"""What a search reports of the shape in which blocks stand and fall, and what runs without shape cannot show."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, rows_of, run_blocks
from dda_command import run_dda


def spreading_arch(thickness: float) -> str:
    """A semicircular arch of 12 voussoirs of mean radius 1, whose springings go apart by 1 each."""
    low, high, n = 1.0 - thickness / 2.0, 1.0 + thickness / 2.0, 12
    rays = [(math.cos(math.pi * i / n), math.sin(math.pi * i / n)) for i in range(n + 1)]
    text = "".join(block([(low * c, low * s), (high * c, high * s), (high * d, high * t), (low * d, low * t)])
                   for (c, s), (d, t) in zip(rays, rays[1:]))
    for left, way in ((-high, -1.0), (low, 1.0)):
        text += block([(left, -0.2), (left + thickness, -0.2), (left + thickness, 0.0), (left, 0.0)])
        for share in (0.25, 0.75):
            text += f"displacement {left + share * thickness!r} -0.1 {way} 0\n"
    return text


@pytest.mark.parametrize("thickness", [0.2, 0.25])
def test_search_for_a_spread_reports_the_displaced_shape_and_how_it_falls(tmp_path: Path, thickness: float) -> None:
    row = run_blocks(tmp_path, spreading_arch(thickness), (
        "&joint friction_deg = 50 /\n&analysis geometry = 'current' /\n"
        "&search parameter = 'displacement_factor', low = 0, high = 1, tolerance = 1e-3 /\n"))
    assert row["verdict"] == "found"
    assert row["collapse_mode"] == "rotational"
    assert float(row["path_time"]) == 0.0
    spread = float(row["critical_low"])
    corners = rows_of(tmp_path / "out" / "blocks.csv")
    held = [float(corner["u"]) for corner in corners if corner["state"] == "held"]
    # corners go with the held points but for the turn of the springing
    assert max(held) == pytest.approx(spread, rel=0.05)
    assert min(held) == pytest.approx(-spread, rel=0.05)
    places = [(float(one["x"]) + float(one["u"]), float(one["y"]) + float(one["v"])) for one in corners]
    joints = rows_of(tmp_path / "out" / "joints.csv")
    assert sum(joint["mechanism"].startswith("hinge") for joint in joints) >= 2
    for joint in joints:
        x, y = float(joint["x_intrados"]), float(joint["y_intrados"])
        assert min(math.hypot(x - a, y - b) for a, b in places) < 1e-4


@pytest.mark.parametrize("ratio, moves", [(0.09, True), (0.12, False)])
def test_run_in_time_without_moving_blocks_says_that_it_shows_no_collapse(
        tmp_path: Path, ratio: float, moves: bool) -> None:
    (tmp_path / "x.nml").write_text(
        f"&arch thickness_ratio = {ratio} /\n"
        "&analysis mode = 'dynamic', duration = 1, time_step = 0.01, steps = 1000 /\n")
    done = run_dda("run", "x.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0
    log = (tmp_path / "out" / "log.txt").read_text()
    assert "geometry = 'reference' shows no collapse" in log
    assert "geometry = 'reference' shows no collapse" in done.stdout
    way = float(log.split("displacement is ")[1].split(" m")[0])
    assert (way > 0.1) == moves


@pytest.mark.parametrize("rotation", ["", "collapse_rotation_deg = 45"])
def test_a_block_that_lies_down_is_reported(tmp_path: Path, rotation: str) -> None:
    """A slender block that leans beyond its toe falls on its side."""
    (tmp_path / "x.blocks").write_text(
        "block fixed\n-5 -1\n5 -1\n5 0\n-5 0\nblock\n0 0\n0.5 0\n1.2 2\n0.7 2\n")
    (tmp_path / "x.nml").write_text(
        "&scene kind = 'blocks', geometry = 'x.blocks' /\n&joint friction_deg = 60 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', unknowns = 3, time_step = 2e-3, duration = 3,\n"
        f"  steps = 100000, {rotation} /\n")
    done = run_dda("run", "x.nml", "--out", "out", cwd=tmp_path)
    (row,) = rows_of(tmp_path / "out" / "results.csv")
    assert row["verdict"] == ("collapsed" if rotation else "completed")
    assert ("set collapse_rotation_deg" in done.stdout) == (not rotation)
    if not rotation:
        angle = float(done.stdout.split("block 2 turned by ")[1].split(" degrees")[0])
        assert angle == pytest.approx(90.0 - math.degrees(math.atan2(0.7, 2.0)), abs=1e-3)


def test_displacements_that_cannot_cause_a_collapse_are_reported(tmp_path: Path) -> None:
    """In reference geometry no spread of the supports brings an arch down; in current geometry one does."""
    deck = ("&arch shape = 'segmental', span = 8, rise = 2, thickness = 0.5, voussoirs = 11 /\n"
            "&support right_dx = 0.01 /\n&joint friction_deg = 40 /\n"
            "&search parameter = 'displacement_factor', low = 0, high = 100 /\n")
    (tmp_path / "x.nml").write_text(deck)
    for geometry, verdict in (("reference", "stable"), ("current", "found")):
        done = run_dda("run", "x.nml", "--out", geometry, "--set", f"analysis%geometry={geometry}", cwd=tmp_path)
        (row,) = rows_of(tmp_path / geometry / "results.csv")
        assert row["verdict"] == verdict
        assert ("geometry = 'reference' keeps the shape" in done.stdout) == (verdict == "stable")


def test_search_in_vain_reports_the_mechanism_of_the_thickest_arch(tmp_path: Path) -> None:
    """A semicircle with friction of 15 degrees slides at any thickness; a thin one would rotate as well."""
    (tmp_path / "arch.nml").write_text("&arch voussoirs = 16 /\n&joint friction_deg = 15 /\n&search /\n")
    assert run_dda("run", "arch.nml", "--quiet", cwd=tmp_path).returncode == 0
    (row,) = rows_of(tmp_path / "arch" / "results.csv")
    assert (row["verdict"], row["collapse_mode"], row["sliding_share"]) == ("collapsed", "sliding", "1")
