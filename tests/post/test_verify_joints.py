"""`voussoir verify` derives joints and their law from corners alone: notches, and forces near an end of a joint."""

from __future__ import annotations

import math

import numpy as np
import pytest

from voussoir.verify.contacts import Block, find_joints, make_block
from voussoir.verify.proofs import Finding
from voussoir.verify.tables import _check_strip


def springing(number: int, off: float) -> Block:
    """The first voussoir of an arch, whose lower corner is off by so much along its bed [m]."""
    low = (1 + off, off / 5)
    return make_block(number, np.array([low, (1.5, 0.1), (1.2, 2), (0.7, 2)]), False)


def pier(number: int) -> Block:
    """A pier with a level bottom between two inclined beds: two notches."""
    return make_block(number, np.array([(-2, -3), (2, -3), (2, 0.2), (1, 0), (-1, 0), (-2, 0.2)], dtype=float), True)


@pytest.mark.parametrize("off", [-1e-15, 0.0, 1e-15])
@pytest.mark.parametrize("numbers", [(1, 2), (2, 1)])
def test_a_notch_touches_no_edge(numbers: tuple[int, int], off: float) -> None:
    """A springing in a notch of its pier has the joint of its bed, and that of its corner with the level bottom."""
    blocks = sorted([springing(numbers[0], off), pier(numbers[1])], key=lambda block: block.number)
    joints = find_joints(blocks)
    assert sorted(joint.single for joint in joints) == [False, True]
    bed = next(joint for joint in joints if not joint.single)
    side = numbers[0] - 1
    # the end in the notch is the voussoir's corner on the pier's edge
    assert min(bed.contacts, key=lambda contact: np.abs(blocks[1 - side].corners[contact[1]]).sum())[0] == 1 - side
    assert all(contact[0] == 1 - side for joint in joints for contact in joint.contacts)


@pytest.mark.parametrize("force, reach, fails", [
    (1e-3, 0.5, False),  # of no account beside the load, at the very end
    (1e5, 0.5 - 0.05, False),  # its strip is a tenth of the joint, half of it beyond the force
    (1e5, 0.5 - 0.05 + 2e-8, True),
    (1e5, 0.5, True),
    (1e2, 0.5, True),
])
def test_a_force_needs_room_for_its_strip(force: float, reach: float, fails: bool) -> None:
    """Joint of 1 m and 1 MN/m of strength, beside loads of 100 kN/m."""
    blocks = [make_block(number, np.array([(0, y), (1, y), (1, y + 1), (0, y + 1)], dtype=float), number == 1)
              for number, y in ((1, -1.0), (2, 0.0))]
    joint, = find_joints(blocks)
    for way in (-1, 1):
        finding = Finding()
        _check_strip(joint, np.array([0.5 + way * reach, 0.0]), force, 1e6, 1e5, finding)
        assert bool(finding.faults) == fails
        _check_strip(joint, np.array([0.5 + way * reach, 0.0]), force, math.inf, 1e5, finding)
        assert bool(finding.faults) == fails
