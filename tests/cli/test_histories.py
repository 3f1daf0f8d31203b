"""Histories in static runs are paths from their beginning to their end: led supports, loads, a moving ground."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from block_scene import block, run_blocks
from dda_command import rows_of

DATA = Path(__file__).resolve().parents[1] / "data"

RADIUS = 10.0
#: How the left and the right support go for each metre that they are led, as in make_led_supports.py
WAYS = {
    "apart": ((-0.5, 0.0), (0.5, 0.0)),
    "one": ((0.0, 0.0), (1.0, 0.0)),
    "together": ((0.5, 0.0), (-0.5, 0.0)),
    "down": ((0.0, 0.0), (0.0, -1.0)),
    "up": ((0.0, 0.0), (0.0, 1.0)),
    "oblique": ((0.0, 0.0), (0.8, -0.6)),
}
BLOCK = "block fixed\n-5 -1\n5 -1\n5 0\n-5 0\nblock\n0 0\n1 0\n1 2\n0 2\n"

Row = dict[str, str]
Point = tuple[float, float]


def rows(folder: Path, table: str) -> list[Row]:
    """Rows of a table."""
    return rows_of(folder / "out" / f"{table}.csv")


def run(folder: Path, blocks: str, groups: str) -> Row:
    """The row of a scene of moving blocks."""
    folder.mkdir(exist_ok=True)
    return run_blocks(folder, blocks, groups)


def arch_on_led_supports(count: int, ratio: float, half_angle_deg: float, way: str, led: float, ramp: str) -> str:
    """An arch whose two supports are blocks that are led; `ramp` is the times of the path, none for at once."""
    inner, outer, half = RADIUS * (1 - ratio / 2), RADIUS * (1 + ratio / 2), math.radians(half_angle_deg)

    def place(radius: float, joint: int) -> Point:
        angle = -half + 2 * half * joint / count
        return radius * math.sin(angle), radius * math.cos(angle)

    text = [block([place(inner, i), place(outer, i), place(outer, i + 1), place(inner, i + 1)]) for i in range(count)]
    for side, (x, y) in zip((0, count), WAYS[way], strict=True):
        lower, upper = place(inner, side), place(outer, side)
        down = math.copysign(3.0, side - 0.5) * math.cos(half), -3.0 * math.sin(half)
        far = [(point[0] + down[0], point[1] + down[1]) for point in (upper, lower)]
        text.append(block([lower, upper, *far]))
        for share in (0.2, 0.8):
            held = [lower[k] + share * (upper[k] - lower[k]) + 0.5 * down[k] for k in (0, 1)]
            if ramp:
                start, end = ramp.split()
                path = f"\n{start} 0 0\n{end} {x * led!r} {y * led!r}\n"
            else:
                path = f" {x * led!r} {y * led!r}\n"
            text.append(f"displacement {held[0]!r} {held[1]!r}{path}")
    text.append(f"measure {held[0]!r} {held[1]!r}\n")
    return "".join(text)


def led_way(folder: Path, way: str) -> float:
    """How far the right support has gone at the end of a run, over the metres that both are led."""
    last = rows(folder, "points")[-1]
    return math.hypot(float(last["u"]), float(last["v"])) / math.hypot(*WAYS[way][1])


@pytest.mark.parametrize(
    ("young", "ramp"),
    [(5e9, "0.0 1e4"), (5e10, ""), (5e11, "1.0 21.0"), (5e12, "0.0 1e4"), (5e13, ""), (5e9, "1.0 21.0")],
)
def test_an_arch_led_apart_falls_at_one_spread_whatever_its_stiffness(tmp_path: Path, young: float, ramp: str) -> None:
    """Kinematics of three hinges: 0.0588 of the span."""
    groups = f"&material young = {young!r} /\n&joint friction_deg = 80 /\n&analysis geometry = 'current' /"
    row = run(tmp_path, arch_on_led_supports(16, 0.15, 90.0, "apart", 1.4, ramp), groups)
    assert row["verdict"] == "collapsed"
    assert led_way(tmp_path, "apart") / 20.0 == pytest.approx(0.0588, abs=1e-4)
    # the row says when
    start, end = map(float, ramp.split()) if ramp else (-1.0, 0.0)
    share = (float(row["path_time"]) - start) / (end - start)
    assert share * 1.4 == pytest.approx(led_way(tmp_path, "apart"), rel=1e-9)


LED = [tuple(row.values()) for row in rows_of(DATA / "led_supports.csv")]


@pytest.mark.parametrize(("count", "ratio", "half_angle", "way", "longest"), LED)
def test_supports_go_as_far_as_linear_programmes_let_them(
    tmp_path: Path, count: str, ratio: str, half_angle: str, way: str, longest: str
) -> None:
    arch = int(count), float(ratio), float(half_angle), way
    groups = "&material young = 5e11 /\n&joint friction_deg = 85 /\n&analysis geometry = 'current' /"
    beyond = run(tmp_path, arch_on_led_supports(*arch, 1.3 * float(longest), ""), groups)
    assert beyond["verdict"] == "collapsed"
    assert led_way(tmp_path, way) == pytest.approx(float(longest), rel=1e-3)
    before = run(tmp_path, arch_on_led_supports(*arch, 0.99 * float(longest), "0 5"), groups)
    assert before["verdict"] == "stable"
    assert led_way(tmp_path, way) == pytest.approx(0.99 * float(longest), rel=1e-9)


def test_the_crown_of_a_spread_arch_sinks_by_the_kinematics_of_three_hinges(tmp_path: Path) -> None:
    groups = """&material young = 5e13 /\n&joint friction_deg = 80 /\n&analysis geometry = 'current' /
&output frames = 10, vtu = .false. /"""
    for spread, sinks in ((0.02, 0.2849), (0.05, 0.7590)):
        row = run(tmp_path, arch_on_led_supports(16, 0.15, 90.0, "apart", 20.0 * spread, "0 3"), groups)
        assert row["verdict"] == "stable"
        corners = rows(tmp_path, "blocks")
        crown = [-float(corner["v"]) for corner in corners if abs(float(corner["x"])) < 1e-9]
        assert max(crown) == pytest.approx(sinks, abs=1e-4)
        # all tables end together
        frames = rows(tmp_path, "frames")
        last = [frame for frame in frames if frame["frame"] == frames[-1]["frame"]]
        for corner, frame in zip(corners, last, strict=True):
            assert float(frame["x"]) == pytest.approx(float(corner["x"]) + float(corner["u"]), abs=1e-12)
        assert frames[-1]["time"] == rows(tmp_path, "points")[-1]["time"] == "3"
        assert row["steps"] == frames[-1]["step"] == rows(tmp_path, "points")[-1]["step"]


@pytest.mark.parametrize("geometry", ["reference", "current"])
@pytest.mark.parametrize("young", [1e6, 1e8, 1e10, 1e12, 1e15])
def test_a_load_that_comes_late_overturns_a_block_however_stiff(tmp_path: Path, geometry: str, young: float) -> None:
    groups = f"&material young = {young!r} /\n&joint friction_deg = 60 /\n&analysis geometry = '{geometry}' /"
    row = run(tmp_path, BLOCK + "load 0 2\n0 0 0\n100 0 0\n200 100000 0\n", groups)
    assert row["verdict"] == "collapsed"
    if geometry == "current":
        # its weight over four; a soft block leans before
        overturns = 100.0 + 100.0 * 2240.0 * 9.81 * 2.0 / 4.0 / 1e5
        assert float(row["path_time"]) == pytest.approx(overturns, abs=0.01 if young > 1e6 else 0.5)


@pytest.mark.parametrize("most, verdict", [(1.05, "collapsed"), (0.95, "stable")])
@pytest.mark.parametrize("words", ["load 0 2", "base_acceleration"])
def test_a_push_that_comes_and_goes_is_felt_at_its_height(
    tmp_path: Path, most: float, verdict: str, words: str
) -> None:
    """The block overturns under a quarter of its weight at its top, or half of it at its centre."""
    top = most * (2240.0 * 9.81 * 2.0 / 4.0 if words.startswith("load") else 9.81 / 2.0)
    text = BLOCK + f"{words}\n0 0 0\n3 {top!r} 0\n4 0 0\n90 0 0\n"
    for geometry in ("reference", "current"):
        row = run(tmp_path, text, f"&joint friction_deg = 60 /\n&analysis geometry = '{geometry}' /")
        assert row["verdict"] == verdict, geometry
        if geometry == "current":
            assert float(row["path_time"]) == pytest.approx(90.0 if verdict == "stable" else 3.0 / most, rel=1e-3)


def test_a_load_on_a_block_without_weight_is_followed(tmp_path: Path) -> None:
    """Without a weight it is its own friction that holds a block down: pushed down at 50 degrees it slides below 40."""
    groups = "&load gravity = 0 /\n&joint friction_deg = {} /\n&analysis geometry = 'current' /"
    force = 1000.0 * math.cos(math.radians(50)), -1000.0 * math.sin(math.radians(50))
    text = BLOCK + f"load 0.2 0.1\n0 0 0\n7 {force[0]!r} {force[1]!r}\n"
    assert run(tmp_path, text, groups.format(39))["verdict"] == "collapsed"
    assert run(tmp_path, text, groups.format(41))["verdict"] == "stable"


def test_the_strength_of_a_joint_gives_way_when_the_load_is_there(tmp_path: Path) -> None:
    """Moment about the other foot: half the weight and half the strength of the joint hold against it."""
    tension = 2e4
    glued = f"&joint friction_deg = 60, cohesion = 1e6, tension = {tension!r} /"
    weight = 2240.0 * 9.81 * 2.0
    lets_go = (weight / 2.0 + tension / 2.0) / 2.0
    for geometry in ("reference", "current"):
        groups = f"&material young = 1e12 /\n{glued}\n&analysis geometry = '{geometry}' /"
        for share, verdict in ((0.97, "stable"), (1.03, "collapsed")):
            text = BLOCK + f"load 0 2\n0 0 0\n10 {share * lets_go!r} 0\n"
            row = run(tmp_path, text, groups)
            assert row["verdict"] == verdict, (geometry, share)


def test_the_log_says_when_the_blocks_fall(tmp_path: Path) -> None:
    run(tmp_path, BLOCK + "load 0 2\n0 0 0\n8 22000 0\n", "&analysis geometry = 'current' /")
    text = (tmp_path / "out" / "log.txt").read_text()
    assert re.search(r"1 collapsed the blocks collapse at time 3\.99", text)
    run(tmp_path, arch_on_led_supports(16, 0.15, 90.0, "apart", 2.0, ""), "&analysis geometry = 'current' /")
    text = (tmp_path / "out" / "log.txt").read_text()
    assert re.search(r"1 collapsed the blocks collapse at 0\.58\d* of the prescribed displacement", text)
