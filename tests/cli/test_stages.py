"""Blocks that are built and taken away in stages: statics to its end state, dynamics with exact motions."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import block
from dda_command import rows_of, run_deck

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
