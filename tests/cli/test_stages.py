"""Blocks that are built and taken away in stages: statics to its end state, dynamics with exact motions."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import block, box, run_scene
from dda_command import rows_of


BASE = box(-2, -1, 10, 1, "fixed")


def wall(courses: int = 4, skip: tuple[int, ...] = ()) -> str:
    """A wall in running bond on a base; its bricks have the numbers from 2."""
    text, number = BASE, 1
    for course in range(courses):
        joints = range(7) if course % 2 == 0 else (0, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6)
        for left, right in zip(joints, list(joints)[1:]):
            number += 1
            if number not in skip:
                text += box(left, course / 2, right - left, 0.5)
    return text


def run(folder: Path, blocks: str, keys: str = "") -> tuple[dict[str, str], dict[tuple[float, ...], dict[str, str]]]:
    """The row of results.csv, and the joints by their ends."""
    out = run_scene(folder, blocks, keys)
    (row,) = rows_of(out / "results.csv")
    ends = ("x_intrados", "y_intrados", "x_extrados", "y_extrados")
    joints = rows_of(out / "joints.csv")
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
