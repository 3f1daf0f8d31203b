"""Stiff and extreme scenes of blocks that move in time, with exact answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from voussoir_benches.checks import DENSITY, GRAVITY, Check, Outcome, end, verdict
from voussoir_benches.expectations import Measured
from voussoir_benches.scene import Scene, block_scene, rectangle, written_block
from voussoir_benches.validation_impact import largest_rise

#: Steps of every length from the shortest on [s]
STEPS = tuple(10.0**k for k in range(-7, 1))
_BASE = written_block(rectangle(-10.0, -1.0, 60.0, 1.0), "fixed")
_FINE = verdict("completed", "verdict")


def motion_scenes() -> Iterator[Scene]:
    """All scenes of blocks that move in time but the random ones."""
    yield from _steps()
    yield from _flights()
    yield from _projectiles()
    yield from _bounces()
    yield from _rests()
    yield from _stiff_motion()


def moving(
    name: str, guard: str, blocks: str, checks: tuple[Check, ...], step: float, duration: float, group: str = "motion",
    **groups: dict[str, Any]
) -> Scene:
    """A scene of blocks that move in time, with its energies."""
    analysis = {
        "mode": "dynamic", "geometry": "current", "time_step": step, "duration": duration, "steps": 1000000,
        **groups.pop("analysis", {})}
    output = {"joints": False, "condition": False, "energy": True}
    rise = Check("rise of energy over the speed's", 0.0, _rise, 1e-6, scale=1.0)
    expectation = Measured((_FINE, *checks, rise))
    return block_scene(group, name, guard, blocks, expectation, analysis=analysis, output=output, **groups)


def _rise(outcome: Outcome) -> float:
    """Largest rise of energy in a step over the largest energy of speed, or over a joule."""
    return largest_rise(outcome) / max(1.0, float(outcome.energy("kinetic").max()))


def _steps() -> Iterator[Scene]:
    """Free fall and a slope, ten or fewer steps of 1e-7 to 1 s, and a block at rest."""
    guard = "constant acceleration is exact in any step"
    block = written_block(rectangle(0.0, 0.0, 2.0, 0.5))
    rub = math.cos(math.pi / 6.0) * math.tan(math.radians(20.0))
    slide = GRAVITY * (math.sin(math.pi / 6.0) - rub)
    for step in STEPS:
        time = 10.0 * step if step < 1.0 else 2.0
        drop = GRAVITY * time**2 / 2.0
        # places are rounded to 1e-16
        fall = Check("fall [m]", -drop, end(1), 1e-9, scale=drop + 1e-6)
        text = written_block(rectangle(0.0, 0.0, 1.0, 1.0)) + "measure 0.5 0.5\n"
        yield moving(f"free fall in steps of {step:g} s", guard, text, (fall,), step, time)
        # the block's strain when its weight comes on is a millionth of a metre
        way = slide * time**2 / 2.0
        yield moving(
            f"slope in steps of {step:g} s", "friction settles within the step", _BASE + block + "measure 1.0 0.25\n",
            (Check("way down 30 deg [m]", way, end(0), 1e-3, scale=way + 1e-3),), step, time,
            joint={"friction_deg": 20.0}, load={"gravity_direction_deg": -60.0},
            analysis={"max_displacement_ratio": 1.0}
        )
        still = Check("way [m]", 0.0, _farthest, 2e-6, scale=1.0)
        yield moving(
            f"a block at rest, 100 steps of {step:g} s", "an impact takes all speed",
            _BASE + block + "measure 2.0 0.5\n", (still,), step, 100.0 * step)


def _farthest(outcome: Outcome) -> float:
    """Farthest that point 1 ever was from its place [m]."""
    return float(np.hypot(*outcome.track(1)[3:]).max())


def _flights() -> Iterator[Scene]:
    """Blocks that fly and spin fast."""
    square = rectangle(-0.5, -0.5, 1.0, 1.0)
    corners = "".join(f"measure {x!r} {y!r}\n" for x, y in square)
    for speed in (1e-6, 1.0, 1e3, 1e6):
        text = written_block(square, f"velocity {speed!r} 0 0") + "measure 0 0\n"
        time = min(1.0, 1e3 / speed)
        way = Check("way [m]", speed * time, end(0), 1e-10)
        yield moving(
            f"flight at {speed:g} m/s", "", text, (way,), 0.01, time, load={"gravity": 0.0},
            analysis={"max_displacement_ratio": 1.0}, material={"young": 1e12})
    for spin in (1e-3, 1.0, 1e2, 1e3):
        text = written_block(square, f"velocity 0 0 {spin!r}") + corners
        # rho w^2 L^2/E is the strain that the spin really makes
        real = DENSITY * spin**2 / 1e15
        turns = Check("growth of area", 0.0, _growth, 1e-10 + real, scale=1.0)
        yield moving(
            f"spin of {spin:g} rad/s, a hundred turns", "exact rotation", text, (turns,), 0.02 * math.pi / spin,
            200.0 * math.pi / spin, load={"gravity": 0.0}, analysis={"max_displacement_ratio": 1.0},
            material={"young": 1e15})


def _growth(outcome: Outcome) -> float:
    """Largest change of the area of a unit square between points 1 to 4."""
    x, y = (np.array([outcome.track(point)[i] for point in range(1, 5)]) for i in (1, 2))
    twice = (x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0)).sum(axis=0)
    return float(np.abs(twice / 2.0 - 1.0).max())


def _projectiles() -> Iterator[Scene]:
    """Bullets that meet a wall: held walls stop them, free ones take their momentum."""
    guard = "a step in which a corner moves farther than was searched is made again"
    for speed in (10.0, 1e3, 1e4):
        for step in (1e-4, 1e-2):
            for held in (True, False):
                wall = written_block(rectangle(5.0, -2.0, 0.1, 4.0), "fixed" if held else "")
                bullet = rectangle(-0.05, -0.05, 0.1, 0.1)
                text = wall + written_block(bullet, f"velocity {speed!r} 0 0")
                text += "measure 0.05 0\nmeasure 0.05 0.05\n"
                share = 0.01 / (0.01 + 0.4)
                # flight of 4.95 m, then at rest, or with the wall's speed
                time = 10.0 / speed
                last = 4.95 if held else 4.95 + share * (10.0 - 4.95)
                name = f"{speed:g} m/s at a {'held' if held else 'free'} wall, steps of {step:g} s"
                yield moving(
                    name, guard, text, (Check("way [m]", last, end(0), 1e-3),), step, time, group="projectile",
                    load={"gravity": 0.0}, material={"young": 1e13})


def _bounces() -> Iterator[Scene]:
    """A cube dropped from a metre with every restitution, in steps of every length."""
    guard = "a step ends where blocks meet"
    for restitution in (0.0, 0.01, 0.5, 0.9, 0.99, 1.0):
        for step in (1e-3, 1e-1):
            text = _BASE + written_block(rectangle(0.0, 1.0, 1.0, 1.0)) + "measure 0.5 1.5\n"
            fall = math.sqrt(2.0 / GRAVITY)
            time = fall * (1.0 + restitution) if restitution else 1.0
            height = restitution**2
            top = Check("height [m]", height, lambda outcome: 1.0 + float(outcome.end(1)[1]), 1e-5, scale=1.0)
            yield moving(
                f"restitution {restitution:g}, steps of {step:g} s", guard, text, (top,), step, time, group="impact",
                material={"young": 1e12}, analysis={"restitution": restitution})
    for ratio in (1.0, 1e3, 1e6, 1e9):
        for restitution in (0.0, 1.0):
            text = written_block(rectangle(0.0, 0.0, 1.0, 1.0), "velocity 1 0 0")
            text += written_block(rectangle(1.5, 0.0, 1.0, 1.0), "material 2")
            text += f"material 2 density {ratio * DENSITY!r}\nmeasure 0.5 0.5\nmeasure 2.0 0.5\n"
            first = 1.0 - (1.0 + restitution) * ratio / (1.0 + ratio)
            other = (1.0 + restitution) / (1.0 + ratio)
            checks = tuple(
                Check(f"speed of block {point} [m/s]", exact, _speed(point), 1e-5, scale=1.0)
                for point, exact in ((1, first), (2, other)))
            yield moving(
                f"collision, mass ratio {ratio:g}, restitution {restitution:g}", "impulses in the metric of mass", text,
                checks, 0.01, 1.0, group="impact", load={"gravity": 0.0}, material={"young": 1e12},
                analysis={"restitution": restitution})


def _speed(point: int) -> Callable[[Outcome], float]:
    """Measure of the mean speed along x in the last tenth of a second [m/s]."""

    def measure(outcome: Outcome) -> float:
        time, _, _, u, _ = outcome.track(point)
        k = np.searchsorted(time, time[-1] - 0.1)
        return float((u[-1] - u[k]) / (time[-1] - time[k]))

    return measure


def _rests() -> Iterator[Scene]:
    """Long rest, dominoes, blocks that nothing holds."""
    four = [rectangle(x, y, 1.0, 1.0) for y in (0.0, 1.0) for x in (-1.0, 0.0)]
    still = Check("farthest way [m]", 0.0, _farthest, 1e-5, scale=1.0)
    yield moving(
        "four cubes at one point, 10000 steps", "entrances stay what they were",
        _BASE + "".join(map(written_block, four)) + "measure 1.0 2.0\n", (still,), 0.01, 100.0, group="rest")
    for friction in (0.0, 89.9):
        yield moving(
            f"a flat table, friction {friction:g} deg, 10000 steps", "no force, no motion",
            _BASE + written_block(rectangle(0.0, 0.0, 2.0, 0.5)) + "measure 1.0 0.25\n",
            (Check("drift [m]", 0.0, end(0), 1e-9, scale=1.0),), 0.01, 100.0, group="rest",
            joint={"friction_deg": friction}
        )
    dominoes = [written_block(rectangle(0.4 * i, 0.0, 0.15, 1.0)) for i in range(1, 12)]
    dominoes.append(written_block(rectangle(0.0, 0.0, 0.15, 1.0), "velocity 0.5 0 -1.0"))
    yield moving(
        "a row of 12 dominoes", "what meets is found before it meets",
        _BASE + "".join(dominoes) + "measure 4.475 0.1\nmeasure 4.475 0.9\n",
        (Check("last domino", "fallen", _fallen, 0.0),), 0.005, 5.0, group="rest", joint={"friction_deg": 20.0})


def _fallen(outcome: Outcome) -> str:
    """Whether the line from point 1 to 2 has turned by more than a right angle's half."""
    angle = outcome.direction(1, 2)
    return "fallen" if abs(angle[-1] - angle[0]) > math.pi / 4.0 else "stands"


def _stiff_motion() -> Iterator[Scene]:
    """The slope with blocks of every stiffness, weight and penalty."""
    block = written_block(rectangle(0.0, 0.0, 2.0, 0.5)) + "measure 1.0 0.25\n"
    rub = math.cos(math.pi / 6.0) * math.tan(math.radians(20.0))
    slide = GRAVITY * (math.sin(math.pi / 6.0) - rub) / 2.0
    way = (Check("way in a second [m]", slide, end(0), 1e-3),)
    more: dict[str, Any] = {"joint": {"friction_deg": 20.0}, "load": {"gravity_direction_deg": -60.0}}
    for exponent in (8, 10, 12, 14, 16, 18):
        name = f"slope, E = 1e{exponent} Pa"
        material = {"young": 10.0**exponent}
        yield moving(name, "", _BASE + block, way, 0.005, 1.0, material=material, **more)
    for exponent in (-2, 0, 4, 6, 8):
        yield moving(
            f"slope, penalty ratio 1e{exponent}", "forces of contacts are multipliers", _BASE + block, way, 0.005, 1.0,
            analysis={"penalty_ratio": 10.0**exponent}, **more)
    for exponent in (-9, -3, 6, 9):
        yield moving(
            f"slope, density 1e{exponent} kg/m3", "", _BASE + block, way, 0.005, 1.0,
            material={"density": 10.0**exponent, "young": 10.0 ** (exponent + 6)}, **more)
    far = [(x + 1e7, y + 1e7) for x, y in rectangle(0.0, 0.0, 2.0, 0.5)]
    base = [(x + 1e7, y + 1e7) for x, y in rectangle(-10.0, -1.0, 60.0, 1.0)]
    text = written_block(base, "fixed") + written_block(far) + "measure 10000001.0 10000000.25\n"
    yield moving("slope at 1e7 m", "an origin of their own", text, way, 0.005, 1.0, **more)
