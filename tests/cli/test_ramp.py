"""A wall that a slow ground motion pushes lets go where the loading path says."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from block_scene import block
from dda_command import rows_of, run_dda, run_deck

BENCHMARKS = Path(__file__).resolve().parents[2] / "input" / "benchmarks"
LEVEL = (0.0, 0.25011638446681367, 0.6035971503472201, 0.9749743829203876, 1.2410130403590103, 1.517347052446026)
RIGHT = 2.980916829816682
HEAD = (
    (0.0, 0.5089523954134982, 1.2388459559879001, 1.827618849894751, 2.4257714090172513, RIGHT),
    (0.0, 0.6142516297443784, 1.0694881756074128, 1.6225493687385708, 2.3021361816127768, RIGHT),
    (0.0, 0.7044509932098935, 1.3241338304571888, 2.0237411962082708, 2.525284371631284, RIGHT),
    (0.0, 0.562420228449706, 1.0033293198816453, 1.5847961194834055, 2.2154233982001355, RIGHT),
    (0.0, 0.719151459463523, 1.2096433760125158, 1.8923473256720063, 2.3078308962081757, RIGHT),
)
PATH = 0.6601  #: First collapse on the loading path, over the weight: shear of joints that stick is remembered there
#: A law of joints that break as the wall is pushed, some across and some along themselves
WEAK_MORTAR = "friction_deg = 35, cohesion = 4e3, tension = 1e3"


def box(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, float]]:
    """Corners of an upright rectangle."""
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def wall(order: int = 0) -> str:
    """The wall on its ground, as a file of blocks; in random order for other seeds than 0."""
    blocks = [block(box(-2.0, -1.0, RIGHT + 2.0, 0.0), "fixed")]
    for course, heads in enumerate(HEAD):
        blocks += [block(box(left, LEVEL[course], right, LEVEL[course + 1])) for left, right in zip(heads, heads[1:])]
    if order:
        random.Random(order).shuffle(blocks)
    return "".join(blocks)


@pytest.mark.parametrize("geometry", ["reference", "current"])
@pytest.mark.parametrize("law", ["friction_deg = 50", WEAK_MORTAR])
def test_a_wall_on_a_slow_ramp_lets_go_where_its_path_does(tmp_path: Path, law: str, geometry: str) -> None:
    """A push of 1 g in 10 s, damped: the joints remember the shear that they stick with from step to step."""
    path = critical_push(tmp_path, law) if law == WEAK_MORTAR else PATH
    check_ramp(tmp_path, law, geometry, path, wall())


@pytest.mark.parametrize("order", [1, 2, 6, 7])
def test_a_wall_on_a_slow_ramp_lets_go_there_in_any_order_of_its_blocks(tmp_path: Path, order: int) -> None:
    """Of redundant forces those nearest to the last step's count, not those of the first joint in the file."""
    check_ramp(tmp_path, "friction_deg = 50", "current", PATH, wall(order))


def check_ramp(tmp_path: Path, law: str, geometry: str, path: float, blocks: str) -> None:
    """Push a wall by 1 g in 10 s: it rests below 0.98 of the push of its path and moves below 1.02 of it."""
    (tmp_path / "x.blocks").write_text(
        blocks + f"measure {RIGHT - 0.1!r} 1.5\nbase_acceleration\n0 0 0\n10 -9.81 0\n")
    run_deck(
        tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&material density = 2200.0 /\n"
        f"&joint {law} /\n&analysis unknowns = 3, mode = 'dynamic', geometry = '{geometry}',\n"
        "  time_step = 2e-3, duration = 6.8, damping = 50, steps = 200000 /\n", "--quiet")
    moved = [(float(row["time"]) / 10.0, abs(float(row["u"]))) for row in rows_of(tmp_path / "x" / "points.csv")]
    assert max(way for push, way in moved if push < 0.98 * path) < 1e-6
    assert max(way for push, way in moved if push < 1.02 * path) > 1e-5


def critical_push(folder: Path, law: str, blocks: str = wall()) -> float:
    """The push over the weight at which the loading path of the wall ends."""
    (folder / "s.blocks").write_text(blocks)
    (folder / "s.nml").write_text(
        "&scene kind = 'blocks', geometry = 's.blocks' /\n&material density = 2200.0 /\n"
        f"&joint {law} /\n&search parameter = 'horizontal_coefficient', high = 4.0 /\n")
    assert run_dda("run", "s.nml", "--quiet", cwd=folder).returncode == 0
    return float(rows_of(folder / "s" / "results.csv")[0]["critical"])


@pytest.mark.parametrize("bricks", ["3x8", "4x8", "5x10"])
def test_a_trace_of_cohesion_is_none(tmp_path: Path, bricks: str) -> None:
    """What breaks before anything is felt: a wall of bricks falls where the dry one does."""
    blocks = (BENCHMARKS / f"dry_wall_{bricks}.blocks").read_text()
    dry = critical_push(tmp_path, "friction_deg = 33.0", blocks)
    for cohesion in (1e-9, 1e-6, 1e-3, 1.0):
        push = critical_push(tmp_path, f"friction_deg = 33.0, cohesion = {cohesion!r}", blocks)
        assert push == pytest.approx(dry, rel=1e-6)
    assert dry < critical_push(tmp_path, "friction_deg = 33.0, cohesion = 1e5", blocks)


def test_the_joint_of_a_mortared_block_is_told_with_the_push_that_breaks_it(tmp_path: Path) -> None:
    """Just before the joint breaks its shear is the push and its moment that of the push at mid-height."""
    blocks = block(box(-5.0, -1.0, 6.0, 0.0), "fixed") + block(box(0.0, 0.0, 1.0, 2.0))
    push = critical_push(tmp_path, "friction_deg = 30, cohesion = 2e4, tension = 1e4", blocks)
    joint = rows_of(tmp_path / "s" / "joints.csv")[0]
    weight = 2200.0 * 9.81 * 2.0
    assert abs(float(joint["shear_force"])) == pytest.approx(push * weight, rel=1e-6)
    assert float(joint["normal_force"]) == pytest.approx(weight, rel=1e-9)


def test_a_wall_of_one_piece_tips_about_its_toe(tmp_path: Path) -> None:
    """Mortar that never breaks on a dry base: the push over the weight is the width over the height."""
    base = "material 2\njoint 1 2 cohesion 0 tension 0\n"
    push = critical_push(tmp_path, "friction_deg = 80, cohesion = 1e9, tension = 1e8",
                         wall().replace("block fixed", "block fixed material 2") + base)
    assert push == pytest.approx(RIGHT / LEVEL[-1], rel=1e-6)
