"""Blocks that are built and taken away in stages: statics to its end state, dynamics with exact motions."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block
from dda_command import rows_of, run_dda, run_deck

GRAVITY = 9.81


def rectangle(left: float, low: float, right: float, high: float, words: str = "") -> str:
    """A rectangle of a file of blocks."""
    return block([(left, low), (right, low), (right, high), (left, high)], words)


BASE = rectangle(-2, -1, 8, 0, "fixed")


def wall(courses: int = 4, skip: tuple[int, ...] = ()) -> str:
    """A wall in running bond on a base; its bricks have the numbers from 2."""
    text, number = BASE, 1
    for course in range(courses):
        joints = range(7) if course % 2 == 0 else (0, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6)
        for left, right in zip(joints, list(joints)[1:]):
            number += 1
            if number not in skip:
                text += rectangle(left, course / 2, right, course / 2 + 0.5)
    return text


def run(folder: Path, blocks: str, keys: str = "") -> tuple[dict[str, str], dict[tuple[float, ...], dict[str, str]]]:
    """The row of results.csv, and the joints by their ends."""
    (folder / "scene.blocks").write_text(blocks)
    run_deck(
        folder, "&scene kind = 'blocks', geometry = 'scene.blocks' /\n" + keys, "--out", "out", "--quiet", name="deck")
    (row,) = rows_of(folder / "out" / "results.csv")
    ends = ("x_intrados", "y_intrados", "x_extrados", "y_extrados")
    joints = rows_of(folder / "out" / "joints.csv")
    return row, {tuple(round(float(joint[name]), 9) for name in ends): joint for joint in joints}


def forces_apart(one: dict, other: dict) -> float:
    """Largest difference of the forces of the same joints over the largest force."""
    assert one.keys() == other.keys()
    names = ("normal_force", "shear_force")
    apart = max(abs(float(one[key][name]) - float(other[key][name])) for key in one for name in names)
    return apart / max(float(joint["normal_force"]) for joint in one.values())


@pytest.mark.parametrize("skip", [(4, 11), (3,), (23, 24, 25), (10,)])
def test_excavation_leaves_the_forces_of_the_final_shape(tmp_path: Path, skip: tuple[int, ...]) -> None:
    friction = "&joint friction_deg = 80 /\n"
    _, at_once = run(tmp_path, wall(skip=skip), friction)
    change = f"remove block {' '.join(map(str, skip))} at 1\n"
    row, staged = run(tmp_path, wall() + change, friction)
    assert row["verdict"] == "stable"
    assert float(row["path_time"]) == 1.0
    assert forces_apart(staged, at_once) < 1e-8
    assert {int(line["block"]) for line in rows_of(tmp_path / "out" / "blocks.csv")} == set(range(1, 28)) - set(skip)
    reactions = rows_of(tmp_path / "out" / "reactions.csv")
    assert {line["block"] for line in reactions} == {"1"}


def test_polygon_takes_the_blocks_away_whose_centres_it_holds(tmp_path: Path) -> None:
    _, numbered = run(tmp_path, wall() + "remove block 4 11 at 1\n")
    _, inside = run(tmp_path, wall() + "remove polygon at 1\n 2.2 0.1\n 3.1 0.1\n 3.1 0.9\n 2.2 0.9\n")
    assert numbered == inside


def test_forces_that_depend_on_the_order_are_reported(tmp_path: Path) -> None:
    steps = "remove block 4 at 1\nremove block 11 at 2\n"
    run(tmp_path, wall() + "remove block 4 11 at 1\n", "&joint friction_deg = 80 /\n")
    assert "slid" not in (tmp_path / "out" / "log.txt").read_text()
    row, _ = run(tmp_path, wall() + steps, "&joint friction_deg = 20 /\n")
    assert row["verdict"] == "stable"
    assert "forces depend on the order of the stages" in (tmp_path / "out" / "log.txt").read_text()


@pytest.mark.parametrize("friction", [0, 40, 89.9, 90])
def test_a_prop_that_is_built_later_carries_what_comes_after_it(tmp_path: Path, friction: float) -> None:
    columns = "".join(rectangle(left, 0, left + 1, 1) for left in (0, 4, 2))
    beams = rectangle(0, 1, 5, 2) + rectangle(0, 2, 5, 3)
    keys = f"&joint friction_deg = {friction} /\n"
    weight = 2240 * GRAVITY
    _, joints = run(tmp_path, BASE + columns + beams + "add block 4 at 1\n", keys)
    assert "blocks were built between stages; forces depend on" in (tmp_path / "out" / "log.txt").read_text()
    carried = {(joint["block_1"], joint["block_2"]): float(joint["normal_force"]) for joint in joints.values()}
    for pair, share in {("2", "5"): 5, ("3", "5"): 5, ("4", "5"): 0, ("1", "4"): 1}.items():
        assert carried[pair] == pytest.approx(share * weight, abs=1e-8 * weight)
    _, joints = run(tmp_path, BASE + columns + beams + "add block 4 at 1\nadd block 6 at 2\n", keys)
    carried = {(joint["block_1"], joint["block_2"]): float(joint["normal_force"]) for joint in joints.values()}
    assert carried["2", "5"] == pytest.approx(carried["3", "5"], rel=1e-9)
    assert carried["2", "5"] + carried["3", "5"] + carried["4", "5"] == pytest.approx(10 * weight, rel=1e-9)
    # three columns carry what comes, less what the new one has sunk by its own weight: the joints at the feet, half as
    # soft as those at the heads, are a third of what a column gives
    assert carried["4", "5"] == pytest.approx((5 - 2 / 3) / 3 * weight, rel=1e-9)


@pytest.mark.parametrize("lean", [0.25, 0.5, 0.0])
def test_keystone_whose_centring_is_struck_rests_in_its_notch(tmp_path: Path, lean: float) -> None:
    # without friction each face carries half the weight over the sine of its angle from upright
    blocks = (
        block([(-4, 0), (-0.5, 0), (-0.5 - lean, 1), (-4, 1)], "fixed")
        + block([(0.5, 0), (4, 0), (4, 1), (0.5 + lean, 1)], "fixed")
        + block([(-0.5, 0), (0.5, 0), (0.5 + lean, 1), (-0.5 - lean, 1)])
        + rectangle(-0.5, -1, 0.5, 0, "fixed")
        + "remove block 4 at 2\n"
    )
    row, joints = run(tmp_path, blocks, "&joint friction_deg = 0 /\n")
    assert row["verdict"] == ("stable" if lean > 0 else "collapsed")
    if lean > 0:
        weight = 2240 * GRAVITY * (1 + lean)
        for joint in joints.values():
            assert float(joint["normal_force"]) == pytest.approx(weight / 2 * math.hypot(1, lean) / lean, rel=1e-9)


def test_what_loses_its_support_falls_at_that_stage(tmp_path: Path) -> None:
    tower = BASE + rectangle(0, 0, 1, 1) + rectangle(0, 1, 1, 2)
    row, _ = run(tmp_path, tower + "remove block 2 at 3\n")
    assert row["verdict"] == "collapsed"
    assert float(row["path_time"]) == 3.0


def test_block_that_is_built_gets_its_weight(tmp_path: Path) -> None:
    tower = BASE + rectangle(0, 0, 1, 1) + rectangle(0, 1, 1, 2)
    for change in ("", "add block 3 at 1\n", "add block 2 3 at 0\n"):
        row, joints = run(tmp_path, tower + change)
        assert row["verdict"] == "stable"
        (foot,) = [joint for joint in joints.values() if joint["block_1"] == "1"]
        assert float(foot["normal_force"]) == pytest.approx(2 * 2240 * GRAVITY, rel=1e-12)


def test_block_falls_freely_once_its_support_is_gone(tmp_path: Path) -> None:
    tower = BASE + rectangle(0, 0, 1, 1) + rectangle(0, 1, 1, 2) + "measure 0.5 1.5\nremove block 2 at 0.3\n"
    move = "&analysis mode = 'dynamic', geometry = 'current', duration = {}, time_step = 0.005, steps = 10000 /\n"
    row, _ = run(tmp_path, tower, move.format(0.6))
    assert row["verdict"] == "completed"
    last = rows_of(tmp_path / "out" / "points.csv")[-1]
    assert float(last["y"]) == pytest.approx(1.5 - GRAVITY * 0.3**2 / 2, abs=2e-5)
    assert float(last["vy"]) == pytest.approx(-GRAVITY * 0.3, rel=1e-4)
    run(tmp_path, tower, move.format(2.0))
    last = rows_of(tmp_path / "out" / "points.csv")[-1]
    assert float(last["y"]) == pytest.approx(0.5, abs=1e-4)


def test_pictures_show_only_what_is_there(tmp_path: Path) -> None:
    tower = BASE + rectangle(0, 0, 1, 1) + rectangle(0, 1, 1, 2) + "remove block 2 at 0.3\n"
    run(
        tmp_path,
        tower,
        "&analysis mode = 'dynamic', geometry = 'current', duration = 0.6, time_step = 0.005, steps = 10000 /\n"
        "&output frames = 6 /\n",
    )
    shown = {}
    for line in rows_of(tmp_path / "out" / "frames.csv"):
        shown.setdefault(float(line["time"]), set()).add(line["block"])
    assert all("2" in blocks for time, blocks in shown.items() if time < 0.299)
    assert all("2" not in blocks for time, blocks in shown.items() if time > 0.301)
    assert all({"1", "3"} <= blocks for blocks in shown.values())
    assert len(shown) >= 6


@pytest.mark.parametrize(
    "change, keys, message",
    [
        ("remove block 2", "", "expected 'block' and numbers or 'polygon', then 'at' and a time"),
        ("remove block at 1", "", "expected numbers of blocks from 1 to 3 between 'block' and 'at'"),
        ("remove block 9 at 1", "", "expected numbers of blocks from 1 to 3 between 'block' and 'at', got '9'"),
        ("remove block 2 at -1", "", "expected a time from 0"),
        ("remove block 2 at 1 2", "", "unknown word '2'"),
        ("remove polygon at 1\n5 5\n6 5\n6 6", "", "expected a polygon around the centre of a block, got one"),
        ("remove polygon at 1\n5 5\n6 5", "", "expected three corners x y or more below 'polygon', got 2"),
        ("remove block 2 at 1\nremove block 2 at 2", "", "block 2 is already not there at 2 s"),
        ("remove block 2 at 1\nadd block 2 at 1", "", "expected one change of block 2 at a time"),
        ("remove block 2 at 1\nbar 0.5 0.5 0.5 1.5 stiffness 1e6", "", "expected bars on blocks without stages"),
        ("remove block 2 at 1\nwater -5 0 5 0", "", "expected a file with either stages or water"),
        ("remove block 2 at 1", "&search parameter = 'friction_deg', low = 10, high = 60 /",
         "a search needs a model without stages"),
        ("remove block 2 at 1", "&analysis geometry = 'current' /", "stages need mode = 'static' with geometry"),
        ("remove block 2 at 1", "&analysis mode = 'limerick' /", "mode = 'limerick' has no stages"),
    ],
)
def test_bad_stages_are_refused(tmp_path: Path, change: str, keys: str, message: str) -> None:
    tower = BASE + rectangle(0, 0, 1, 1) + rectangle(0, 1, 1, 2)
    (tmp_path / "scene.blocks").write_text(tower + change + "\n")
    (tmp_path / "deck.nml").write_text("&scene kind = 'blocks', geometry = 'scene.blocks' /\n" + keys + "\n")
    done = run_dda("check", "deck.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.startswith("scene.blocks:")


@pytest.mark.parametrize("unknowns", [3, 6])
@pytest.mark.parametrize("keys", ["", ", start = 'static'"])
def test_a_block_that_is_built_while_nothing_can_move_falls_from_then_on(
    tmp_path: Path, unknowns: int, keys: str
) -> None:
    """The only movable block, above the ground: it fell from the beginning."""
    dynamic = (f"&analysis mode = 'dynamic', geometry = 'current', steps = 100000, duration = 0.41, time_step = 0.003,"
               f" unknowns = {unknowns}{keys} /\n")
    run(tmp_path, BASE + rectangle(0, 1, 1, 2) + "add block 2 at 0.3\nmeasure 0.5 1.5\n", dynamic)
    ways = rows_of(tmp_path / "out" / "points.csv")
    assert float(ways[-1]["time"]) == pytest.approx(0.41, abs=1e-12)
    for way in ways:
        time = max(0.0, float(way["time"]) - 0.3)
        assert float(way["v"]) == pytest.approx(-GRAVITY * time**2 / 2.0, abs=1e-12)
        assert float(way["vy"]) == pytest.approx(-GRAVITY * time, abs=1e-12)


def test_time_goes_on_between_a_block_that_goes_and_one_that_comes(tmp_path: Path) -> None:
    """From 0.1 to 0.25 s nothing can move."""
    dynamic = "&analysis mode = 'dynamic', geometry = 'current', steps = 100000, duration = 0.4, time_step = 0.004 /\n"
    run(tmp_path, BASE + rectangle(0, 1, 1, 2) + rectangle(3, 1, 4, 2)
        + "remove block 2 at 0.1\nadd block 3 at 0.25\nmeasure 3.5 1.5\n", dynamic)
    last = rows_of(tmp_path / "out" / "points.csv")[-1]
    assert float(last["time"]) == pytest.approx(0.4, abs=1e-12)
    assert float(last["v"]) == pytest.approx(-GRAVITY * 0.15**2 / 2.0, abs=1e-12)
