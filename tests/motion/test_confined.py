"""Proofs that the verdicts of the confined and the falling scenes are right, by linear programmes."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import pytest
from assembly import Assembly, area_and_centre, find_joints
from confined import CONFINED, FALLING, Layout, turned

SEEDS = range(20)


def has_equilibrium(layout: Layout, friction: float) -> bool:
    """Whether forces within the friction cones balance weight and push."""
    optimize = pytest.importorskip("scipy.optimize", reason="the linear programme wants scipy")
    blocks, ground = ([turned(polygon, layout.tilt) for polygon in some] for some in (layout.blocks, layout.ground))
    assembly = Assembly("", blocks, find_joints(blocks, ground))
    columns, areas = [], [area_and_centre(block)[0] for block in blocks]
    for joint, _, sides in assembly.rows():
        for ray in ((1.0, 0.0, friction), (1.0, 0.0, -friction), (0.0, 1.0, friction), (0.0, 1.0, -friction)):
            column = [0.0] * (3 * len(blocks))
            for block, side in zip(joint.blocks, sides):
                for i in range(3 if block else 0):
                    column[3 * block - 3 + i] += sum(force * row[i] for force, row in zip(ray, side))
            columns.append(column)
    load = [number * area / max(areas) for area in areas for number in (layout.push, -1.0, 0.0)]
    found = optimize.linprog([0.0] * len(columns), A_eq=[list(row) for row in zip(*columns)],
                             b_eq=[-number for number in load])
    assert found.status in (0, 2), found.message
    return bool(found.status == 0)


@pytest.mark.parametrize("family", list(CONFINED))
def test_confined_blocks_carry_their_loads_without_friction(family: str) -> None:
    for seed in SEEDS:
        layout = CONFINED[family](random.Random(f"{family} {seed}"))
        assert has_equilibrium(layout, 0.0), seed
        # no block is free to slide without work
        for push in (-0.01, 0.01):
            pushed = replace(layout, push=layout.push + push)
            assert has_equilibrium(pushed, 0.9 * math.tan(math.radians(layout.friction))), seed


@pytest.mark.parametrize("family", list(FALLING))
def test_falling_blocks_have_no_balance_with_one_percent_more_friction(family: str) -> None:
    for seed in SEEDS:
        layout = FALLING[family](random.Random(f"{family} {seed}"))
        assert not has_equilibrium(layout, 1.01 * math.tan(math.radians(layout.friction))), seed
