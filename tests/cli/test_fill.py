"""Fill on arches: mirrored axles, backing, the worst position, fill that yields."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import rows_of
from test_live_loads import SEARCH, rows

#: Prestwood; what it carries is in tests/unit/test_dda_compute_case.pf
BRIDGE = (
    "&arch shape = 'segmental', span = 6.55, rise = 1.428, thickness = 0.22, voussoirs = 40 /\n"
    f"&joint friction_deg = {math.degrees(math.atan(0.6))!r} /\n&material unit_weight = 20e3 /\n"
    "&vehicle axles = 1000, position = {}, length = 0.3 /\n" + SEARCH
)
FILL = "&fill height = 0.165, unit_weight = 20e3{} /\n"
KP = (1.0 + math.sin(math.radians(37.0))) / (1.0 - math.sin(math.radians(37.0)))


def test_a_mirrored_axle_is_carried_alike(tmp_path: Path) -> None:
    deck = BRIDGE + FILL.format(", passive_coefficient = 1")
    found = [float(rows(tmp_path, deck.format(x), head="")[0]["critical"]) for x in (-1.6375, 1.6375)]
    assert found[0] == pytest.approx(found[1], rel=1e-7)


def test_a_share_of_kp_is_its_coefficient(tmp_path: Path) -> None:
    deck = BRIDGE.format(-1.6375)
    (share,) = rows(tmp_path, deck + FILL.format(", friction_deg = 37, passive_share = 0.5"), head="")
    (plain,) = rows(tmp_path, deck + FILL.format(f", passive_coefficient = {0.5 * KP!r}"), head="")
    assert float(share["critical"]) == pytest.approx(float(plain["critical"]), rel=1e-9)


def test_backing_carries_more_the_higher_it_is(tmp_path: Path) -> None:
    deck = BRIDGE.format(-1.6375) + FILL.format(", backing_height = {}")
    found = [float(rows(tmp_path, deck.format(h), head="")[0]["critical"]) for h in (0.0, 0.4, 0.8)]
    bare = float(rows(tmp_path, BRIDGE.format(-1.6375) + FILL.format(""), head="")[0]["critical"])
    assert found[0] == pytest.approx(bare, rel=1e-9)
    assert found[0] < found[1] < found[2]


def test_the_worst_position_is_no_better_than_any(tmp_path: Path) -> None:
    fill = FILL.format(", passive_coefficient = 1")
    flow = "&analysis flow = 'associated' /\n"
    (worst,) = rows(tmp_path, BRIDGE.format("1").replace("position = 1", "worst = T") + fill + flow, head="")
    sweep = "&sweep parameter = 'position', first = -3.2, last = 0, count = 17 /\n"
    other = [float(row["critical"]) for row in rows(tmp_path, BRIDGE.format(0) + fill + flow + sweep, head="")]
    assert float(worst["critical"]) <= min(other) * (1.0 + 1e-9)
    assert float(worst["critical"]) == pytest.approx(min(other), rel=0.05)


#: Rungs of the ladder by what the arch leans against
LEANING = [(1.0, 43.61840212216162), (1.3409333333333333, 46.489156198504915), (4.0228, 62.994869861242684)]


@pytest.mark.parametrize(("coefficient", "factor"), LEANING)
def test_fill_that_yields_gives_the_ladder_step_by_step(tmp_path: Path, coefficient: float, factor: float) -> None:
    """Where a displacement is collapse, steps decide, and the fill is springs that yield."""
    fill = FILL.format(f", passive_coefficient = {coefficient}, passive_stiffness = 1e10")
    deck = BRIDGE.format(-1.6375).replace(SEARCH, "&search parameter = 'load_factor', low = 25, high = 70 /\n") + fill
    (row,) = rows(tmp_path, deck + "&analysis collapse_displacement = 0.1 /\n", head="")
    assert float(row["critical"]) == pytest.approx(factor, rel=1e-6)


@pytest.mark.parametrize(("coefficient", "factor"), LEANING[1:])
def test_fill_yields_where_blocks_move_in_time(tmp_path: Path, coefficient: float, factor: float) -> None:
    """Below its rung an arch comes to rest; above it the fill on one side yields, and it moves on."""
    fill = FILL.format(f", passive_coefficient = {coefficient}, passive_stiffness = 1e9")
    farthest = {}
    for share in (0.99, 1.01):
        for duration in (1.0, 2.0):
            rows(
                tmp_path,
                BRIDGE.format(-1.6375).replace(SEARCH, f"&load load_factor = {share * factor!r} /\n") + fill
                + f"&analysis mode = 'dynamic', time_step = 2e-3, damping = 20, duration = {duration} /\n",
                head="",
            )
            moved = [max(abs(float(row["u"])), abs(float(row["v"]))) for row in rows_of(tmp_path / "x/blocks.csv")]
            farthest[share, duration] = max(moved)
    assert farthest[0.99, 2.0] == pytest.approx(farthest[0.99, 1.0], rel=0.02)
    assert farthest[1.01, 2.0] > 1.5 * farthest[1.01, 1.0]
    forces = [float(row["force"]) for row in rows_of(tmp_path / "x/bars.csv") if row["state"] == "yielding"]
    bounds = pressures(tmp_path / "x/blocks.csv", coefficient)
    assert forces == pytest.approx(bounds[: len(forces)], rel=1e-9)
    assert len(forces) >= 15


def pressures(path: Path, coefficient: float) -> list[float]:
    """Largest forces of the fill right of the crown, from the crown downwards: by the told corners alone."""
    corners = [
        (int(row["block"]), float(row["x"]), float(row["y"]))
        for row in rows_of(path)
        if row["state"] == "free"
    ]
    radius = (0.25 * 6.55**2 + 1.428**2) / (2.0 * 1.428)
    found = []
    tops = {
        block: sorted((x, y) for b, x, y in corners if b == block and math.hypot(x, y - 1.428 + radius) > radius + 0.11)
        for block in {b for b, _, _ in corners}
    }
    surface = 1.428 + 0.22 + 0.165
    for (left, low), (right, high) in (top for top in tops.values() if len(top) == 2):
        if left + right > 1e-9:
            found.append(coefficient * 20e3 * (surface - 0.5 * (low + high)) * abs(high - low))
    return sorted(found)
