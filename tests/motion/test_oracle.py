"""The event-driven integrator beside closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracle import Ambiguous, World
from stacks import Stack
from states import rectangle, turned
from trains import Train

G = 9.81
FLOOR = rectangle(-30.0, -1.0, 60.0, 1.0)


def floor(restitution: float = 0.0, friction: float = 0.0, gravity: tuple[float, float] = (0.0, -G)) -> World:
    """A world with a level floor."""
    world = World(gravity, restitution, friction)
    world.add(FLOOR, density=0.0)
    return world


def test_bounces_are_parabolas() -> None:
    world = floor(0.5)
    world.add(rectangle(0.0, 1.0, 1.0, 1.0))
    world.run(1.0)
    fall = math.sqrt(2.0 / G)
    after = 1.0 - 2.0 * fall  # the second impact is one fall later than the first
    assert [time for time, _ in world.impacts] == pytest.approx([fall, 2.0 * fall], abs=1e-9)
    assert world.state(1).vy == pytest.approx(0.25 * G * fall - G * after, abs=1e-8)


@pytest.mark.parametrize("friction", [0.0, 0.1, 2.0])
def test_corner_that_hits_a_floor_has_the_impulses_of_newton_and_coulomb(friction: float) -> None:
    """A square turned by 0.3 with vx, vy, spin = 0.2, -1, 0.5 hits a floor with restitution 0.6, without gravity."""
    square = turned(rectangle(-0.5, -0.5, 1.0, 1.0), 0.3)
    x, y = min(square, key=lambda p: p[1])
    world = floor(0.6, friction, (0.0, 0.0))
    world.add([(px, py - y) for px, py in square], (0.2, -1.0, 0.5), 1.0)
    world.run(1e-9)
    inertia = 1.0 / 6.0
    along, down = 0.2 - 0.5 * y, -1.0 + 0.5 * x
    nn, nt, tt = 1.0 + x * x / inertia, -x * y / inertia, 1.0 + y * y / inertia
    normal = -1.6 * down / nn
    if friction > 0.0:
        # sticking impulses, or sliding ones if these are outside the cone
        det = nn * tt - nt * nt
        normal, shear = (-1.6 * down * tt + along * nt) / det, (-along * nn + 1.6 * down * nt) / det
        if abs(shear) > friction * normal:
            sign = math.copysign(1.0, shear)
            normal = -1.6 * down / (nn + sign * friction * nt)
            shear = sign * friction * normal
    else:
        shear = 0.0
    state = world.state(1)
    assert state.vx == pytest.approx(0.2 + shear, abs=1e-8)
    assert state.vy == pytest.approx(-1.0 + normal, abs=1e-8)
    assert state.spin == pytest.approx(0.5 + (x * normal - y * shear) / inertia, abs=1e-7)


def test_elastic_polygon_keeps_its_energy() -> None:
    world = floor(1.0)
    world.add([(x, y + 1.5) for x, y in turned(rectangle(-0.4, -0.3, 0.8, 0.6), 0.7)], (0.3, 0.0, 2.0))
    before = world.energy()
    world.run(2.0)
    assert len(world.impacts) > 2
    assert world.energy() == pytest.approx(before, rel=1e-9)


def test_train_on_a_floor_meets_as_in_one_dimension() -> None:
    left, width, density = [0.0, 1.02, 1.93], [0.8, 0.3, 0.9], [8541.6667, 3333.3333, 9814.8148]
    world = floor(1.0)
    for k in range(3):
        world.add(rectangle(left[k], 0.0, width[k], 0.6), (1.9 * (k == 0), 0.0, 0.0), density[k])
    world.run(1.25)
    train = Train(left, width, [0.6 * w * d for w, d in zip(width, density)], [1.9, 0.0, 0.0], 1.0)
    train.run(1.25)
    speeds = [world.state(k).vx for k in (1, 2, 3)]
    assert speeds == pytest.approx(train.speed, abs=1e-8)
    assert speeds == pytest.approx([-0.310212, 0.680940, 1.632699], abs=1e-6)


def test_plastic_train_shares_its_momentum() -> None:
    """Two blocks that stick meet a third: all go on together, after impacts that have no time between them."""
    train = Train([0.0, 1.5, 3.0], [1.0] * 3, [2.0, 1.0, 3.0], [3.0, 0.0, -1.0], 0.0)
    train.run(3.0)
    assert train.speed == pytest.approx([0.5] * 3, abs=1e-9)
    assert train.apart < 1e-9


def test_block_on_a_resting_block_rises_again() -> None:
    world = floor(1.0)
    world.add(rectangle(-0.5, 0.0, 1.0, 1.0))
    world.add(rectangle(-0.5, 2.0, 1.0, 1.0))
    world.run(2.0 * math.sqrt(2.0 / G))
    assert world.state(2).y == pytest.approx(2.5, abs=1e-8)
    assert world.state(1).y == pytest.approx(0.5, abs=1e-12)


def test_slide_reverses_as_in_closed_form() -> None:
    angle, mu = math.radians(20.0), math.tan(math.radians(5.0))
    world = floor(0.0, mu, (G * math.sin(angle), -G * math.cos(angle)))
    world.add(rectangle(0.0, 0.0, 1.5, 0.3), (-0.4, 0.0, 0.0))
    world.run(0.9)
    up, down = (G * (math.sin(angle) + sign * mu * math.cos(angle)) for sign in (1.0, -1.0))
    rest = 0.9 - 0.4 / up
    assert world.state(1).x - 0.75 == pytest.approx(down * rest**2 / 2.0 - 0.08 / up, abs=1e-8)
    assert world.state(1).vx == pytest.approx(down * rest, abs=1e-7)


def test_rocking_block_loses_what_housner_says() -> None:
    """The spin after an impact over that before it is 1 - 3/2 sin2 of the angle of the diagonal."""
    half, height, lean = 0.2, 2.0, 0.05
    world = floor(0.0, 2.0)
    world.add([(x + half, y) for x, y in turned(rectangle(-2.0 * half, 0.0, 2.0 * half, height), -lean)])
    world.run(1.0)
    speeds = [speed for _, speed in world.impacts]
    assert len(speeds) == 2
    assert speeds[1] / speeds[0] == pytest.approx(1.0 - 1.5 * half**2 / (half**2 + (height / 2.0) ** 2), rel=1e-7)


def test_block_that_rolls_over_a_corner_keeps_its_energy() -> None:
    world = floor(0.0, 5.0)
    ((x, y),) = turned([(0.25, 0.5)], 0.1)
    world.add(turned(rectangle(0.0, 0.0, 0.5, 1.0), 0.1), (-1.1 * y, 1.1 * x, 1.1))
    before = world.energy()
    world.run(0.3)
    assert world.energy() == pytest.approx(before, rel=1e-8)


def test_corner_that_rolls_begins_to_slip_where_friction_is_used_up() -> None:
    """A block falls over its corner; the answer does not depend on how often states are found anew."""
    states = []
    for pieces in (1, 500):
        world = floor(0.0, 0.3)
        world.add(turned(rectangle(0.0, 0.0, 0.5, 1.0), 0.6))
        for _ in range(pieces):
            world.run(0.5 / pieces)
        states.append(world.state(1))
    assert abs(states[0].vx) > 0.1
    assert [states[0].x, states[0].vx, states[0].spin] == pytest.approx(
        [states[1].x, states[1].vx, states[1].spin], abs=1e-7)


def corner_on_an_edge(turn: float, along: float) -> World:
    """A bar that turns towards a free square and has met its lowest corner, without friction and gravity."""
    world = World((0.0, 0.0))
    world.add(rectangle(-1.0, -0.2, 2.0, 0.4), (0.0, 0.0, 1.0))
    world.add(turned(rectangle(-0.3, -0.3, 0.6, 0.6), turn), (0.0, 0.0, 0.0))
    world.place[1, :2] = along, 0.2 - min(y for _, y in world.corners(np.zeros((2, 3)))[1])
    world.run(1e-3)
    return world


def test_corner_on_a_turning_edge_does_no_work_without_friction() -> None:
    """Two free blocks turn towards one another: a corner slides along an edge that turns, and off its end."""
    world = corner_on_an_edge(0.7, 0.5)
    (contact,), kept = world.touching(), world.energy()
    for _ in range(20):
        world.run(0.02)
        if world.lost:
            break
        assert world.touching() == [contact]
        assert world.energy() == pytest.approx(kept, rel=1e-7)
    assert world.energy() == pytest.approx(kept, rel=1e-7) and world.rolled > 0.5


def test_corner_of_an_edge_that_a_block_has_left_pushes_it_no_more() -> None:
    """A corner slides off its edge: the end of the edge is near the block then, and separates from it."""
    world = corner_on_an_edge(1.02, 0.9)
    kept = world.energy()
    world.run(0.8)
    assert world.lost > 0.0 and world.energy() == pytest.approx(kept, rel=1e-7)


def test_impact_of_two_answers_is_refused() -> None:
    """A rod at 45 degrees that slips along a floor of friction 3 jams, or flies off (Painleve)."""
    world = floor(0.0, 3.0)
    world.add(turned(rectangle(0.0, 0.0, 0.01, 2.0), -math.radians(20.0)), (-3.0, 0.0, 0.0))
    with pytest.raises(Ambiguous):
        world.run(0.1)


def test_slab_slips_on_ground_that_moves_off_as_in_closed_form() -> None:
    shake, friction, duration = 4.0, 0.2, 0.3
    slab = Stack(np.array([700.0]), np.array([friction]), np.zeros(1), np.zeros(1))
    assert slab.follow([(0.0, shake), (duration, shake)]) == 0
    assert slab.follow([(0.0, 0.0), (1.0, 0.0)]) == 1
    hold = friction * G
    assert slab.place[0] == pytest.approx(-(shake - hold) * duration**2 / 2.0 * shake / hold, rel=1e-12)
    assert slab.speed[0] == 0.0


def test_slab_on_a_smooth_one_stays_where_it_is() -> None:
    """The lower one goes with the ground, the upper one keeps its place in space."""
    slabs = Stack(np.array([700.0, 500.0]), np.array([0.9, 0.0]), np.zeros(2), np.zeros(2))
    slabs.follow([(0.0, 0.0), (0.5, 3.0)])
    assert slabs.place == pytest.approx(np.array([0.0, -3.0 / 0.5 * 0.5**3 / 6.0]), abs=1e-12)


def test_corners_that_clip_one_another_within_a_step_meet() -> None:
    """A diamond at 10 m/s overlaps the corners of a narrow block for 2.2 ms from 8.5 ms on, 1 mm deep."""
    world = World((0.0, 0.0), restitution=1.0)
    world.add([(0.0, -1.0), (0.02, -1.0), (0.02, 0.0), (0.0, 0.0)], density=0.0)
    diamond = [(x - 0.086, y + 0.499) for x, y in ((0.0, -0.5), (0.5, 0.0), (0.0, 0.5), (-0.5, 0.0))]
    world.add(diamond, (10.0, 0.0, 0.0))
    world.run(0.02)
    assert world.impacts[0] == pytest.approx((0.0085, 10.0 / math.sqrt(2.0)), rel=1e-6)
