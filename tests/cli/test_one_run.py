"""What the tables tell of the motion of blocks is told of one and the same run, and ends with it."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

BASE = "block fixed\n-5 -1\n5 -1\n5 0\n-5 0\n"
BLOCK = "block\n0 0\n1 0\n1 2\n0 2\n"
UPPER = "block\n0.2 2\n0.8 2\n0.8 2.5\n0.2 2.5\n"
MEASURE = "measure 1 2\nmeasure 0 2\n"
#: The lower block is led to the right by 0.3 m, and back by half of it
LED = "".join(f"displacement {x} {y}\n0 0 0\n1 0 0\n5 0.3 0\n9 0.15 0\n" for x, y in ((0.5, 0.5), (0.5, 1.5)))

SCENES = {
    "led": (BLOCK + UPPER + LED, "&analysis geometry = 'current', time_step = 0.05, steps = 4000 /"),
    "rests": (BLOCK + UPPER, "&analysis geometry = 'current' /"),
    "rests, small": (BLOCK + UPPER, ""),
    "slips and rests": (
        BLOCK + "load 0 2\n0 4000 0\n1 4000 0\n", "&analysis geometry = 'current' /\n&joint friction_deg = 5.8 /"),
    "tips": (BLOCK, "&analysis geometry = 'current' /\n&load horizontal_coefficient = 0.6 /"),
    "tips over 0.5 m": (
        BLOCK,
        "&analysis geometry = 'current', collapse_displacement = 0.5 /\n" "&load horizontal_coefficient = 0.6 /"),
    "slides": (
        BLOCK, "&analysis geometry = 'current' /\n&load horizontal_coefficient = 0.4 /\n" "&joint friction_deg = 20 /"),
    "step limit": (
        BLOCK,
        "&analysis geometry = 'current', steps = 3, collapse_displacement = 9 /\n"
        "&load horizontal_coefficient = 0.6 /",
    ),
    "in time": (
        BLOCK,
        "&analysis mode = 'dynamic', geometry = 'current', duration = 0.3 /\n" "&load horizontal_coefficient = 0.6 /"),
    "in time, steps": (
        BLOCK,
        "&analysis mode = 'dynamic', geometry = 'current', time_step = 0.01, steps = 17 /\n"
        "&load horizontal_coefficient = 0.6 /",
    ),
    "in time, small": (BLOCK, "&analysis mode = 'dynamic', duration = 0.05 /"),
}


def run(folder: Path, blocks: str, groups: str, name: str = "out") -> Path:
    """Folder of the results of a run."""
    (folder / "x.blocks").write_text(BASE + blocks + MEASURE)
    (folder / "x.nml").write_text(f"&scene kind = 'blocks', geometry = 'x.blocks' /\n{groups}\n")
    done = run_dda("run", "x.nml", "--out", folder / name, "--quiet", cwd=folder)
    assert done.returncode in (0, 3), done.stderr
    return folder / name


def last_points(folder: Path) -> list[tuple[float, float, float, float]]:
    """Place and displacement of the measured points in the last step of points.csv."""
    rows = rows_of(folder / "points.csv")
    last = [row for row in rows if row["step"] == rows[-1]["step"]]
    return [tuple(float(row[name]) for name in "xyuv") for row in last]


def corner(folder: Path, vertex: int) -> tuple[float, float]:
    """Displacement in blocks.csv of a corner of the second block."""
    for row in rows_of(folder / "blocks.csv"):
        if (row["block"], row["vertex"]) == ("2", str(vertex)):
            return float(row["u"]), float(row["v"])
    raise AssertionError(vertex)


@pytest.mark.parametrize("scene", list(SCENES))
@pytest.mark.parametrize("frames", [0, 7])
def test_points_frames_and_blocks_end_together(tmp_path: Path, scene: str, frames: int) -> None:
    blocks, groups = SCENES[scene]
    if frames and "current" not in groups:
        return
    out = run(tmp_path, blocks, f"{groups}\n&output frames = {frames}, vtu = .false. /")
    points = last_points(out)
    for point, vertex in zip(points, (3, 4)):
        assert point[2:] == pytest.approx(corner(out, vertex), abs=1e-14, rel=1e-12)
    if not frames:
        return
    rows = rows_of(out / "frames.csv")
    last = [row for row in rows if row["frame"] == rows[-1]["frame"] and row["block"] == "2"]
    for point, vertex in zip(points, (3, 4)):
        place = [float(last[vertex - 1][name]) for name in "xy"]
        assert place == pytest.approx(point[:2], abs=1e-14, rel=1e-12)
    assert rows[-1]["step"] == rows_of(out / "points.csv")[-1]["step"]


def test_what_is_led_has_gone_its_way_in_every_table(tmp_path: Path) -> None:
    """The run that is told is the one that decided, whatever a collapse may mean elsewhere."""
    out = run(tmp_path, *SCENES["led"])
    for point in last_points(out):
        assert 0.0 < math.hypot(*point[2:]) <= 0.3 * (1.0 + 1e-6)
    way = [float(row["u"]) for row in rows_of(out / "points.csv") if row["point"] == "1"]
    assert max(way) == pytest.approx(0.3, abs=0.01)


def test_pictures_of_a_collapse_change_nothing_but_how_far_it_is_followed(tmp_path: Path) -> None:
    """The mechanism is that of the step that decides; then a tenth of the block's size is gone."""
    blocks, groups = SCENES["tips"]
    plain = run(tmp_path, blocks, groups, "plain")
    seen = run(tmp_path, blocks, groups + "\n&output frames = 9, vtu = .false. /", "seen")
    (row,), (other,) = (rows_of(folder / "results.csv") for folder in (plain, seen))
    for name in ("verdict", "collapse_mode", "sliding_share"):
        assert row[name] == other[name]
    assert row["verdict"] == "collapsed"
    roles = [[joint["mechanism"] for joint in rows_of(folder / "joints.csv")] for folder in (plain, seen)]
    assert roles[0] == roles[1]
    tenth = 0.1 * math.sqrt(2.0)
    assert math.hypot(*corner(plain, 3)) < tenth < math.hypot(*corner(seen, 3)) < 2.0 * tenth
    before = {(r["step"], r["point"]): r for r in rows_of(plain / "points.csv")}
    after = {(r["step"], r["point"]): r for r in rows_of(seen / "points.csv")}
    assert before.items() <= after.items()
