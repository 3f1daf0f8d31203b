"""What the joints do in a collapse, against the motion of the blocks that blocks.csv tells."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import box, run_scene
from dda_command import rows_of

BASE = "block fixed\n-2 -1\n6 -1\n6 0\n-2 0\n"

#: Courses of a wall of 4 m by 3.2 m with a window: ends of the blocks of each from the left [m]
WINDOW = [
    [(0.0, 0.8), (0.8, 1.6), (1.6, 2.4), (2.4, 3.2), (3.2, 4.0)],
    [(0.0, 0.4), (0.4, 1.2), (1.2, 2.0), (2.0, 2.8), (2.8, 3.6), (3.6, 4.0)],
    [(0.0, 1.2), (2.8, 3.4), (3.4, 4.0)],
    [(0.0, 0.4), (0.4, 1.2), (2.8, 3.6), (3.6, 4.0)],
    [(0.0, 1.2), (2.8, 3.4), (3.4, 4.0)],
    [(0.0, 0.8), (0.8, 3.2), (3.2, 4.0)],
    [(0.0, 0.8), (0.8, 1.6), (1.6, 2.4), (2.4, 3.2), (3.2, 4.0)],
    [(0.0, 0.4), (0.4, 1.2), (1.2, 2.0), (2.0, 2.8), (2.8, 3.6), (3.6, 4.0)],
]

Point = tuple[float, float]


def window() -> str:
    """Text of the wall with a window."""
    return BASE + "".join(
        box(left, 0.4 * course, right - left, 0.4)
        for course, blocks in enumerate(WINDOW)
        for left, right in blocks
    )


def collapse_of(
    folder: Path, blocks: str, friction: float, search: str
) -> tuple[dict[str, str], list[dict[str, str]], dict[int, list[list[float]]]]:
    """Row, joints and corners of the blocks (x, y, u, v) of a search."""
    out = run_scene(folder, blocks, f"&joint friction_deg = {friction!r} /\n&search parameter = {search} /\n")
    tables = [rows_of(out / f"{name}.csv") for name in ("results", "joints", "blocks")]
    corners: dict[int, list[list[float]]] = {}
    for row in tables[2]:
        corners.setdefault(int(row["block"]), []).append([float(row[name]) for name in "xyuv"])
    return tables[0][0], tables[1], corners


def motion_at(corners: list[list[float]], point: Point) -> Point:
    """Displacement of a point of a rigid block, from those of two of its corners."""
    (x1, y1, u1, v1), _, (x3, y3, u3, v3) = corners[:3]
    dx, dy = x3 - x1, y3 - y1
    turn = (dx * (v3 - v1) - dy * (u3 - u1)) / (dx**2 + dy**2)
    return u1 - turn * (point[1] - y1), v1 + turn * (point[0] - x1)


def relative(joint: dict[str, str], corners: dict[int, list[list[float]]]) -> tuple[float, ...]:
    """Opening at both ends of a joint and slip of its second block, in the collapse."""
    ends = [(float(joint[f"x_{s}"]), float(joint[f"y_{s}"])) for s in ("intrados", "extrados")]
    first, second = (corners[int(joint[f"block_{i}"])] for i in (1, 2))
    (x1, y1), (x2, y2) = ends
    length = math.hypot(x2 - x1, y2 - y1)
    along = ((x2 - x1) / length, (y2 - y1) / length)
    normal = (-along[1], along[0])
    middle = [sum(corner[i] for corner in second) / len(second) for i in (0, 1)]
    if (middle[0] - x1) * normal[0] + (middle[1] - y1) * normal[1] < 0.0:
        normal = (along[1], -along[0])
    parts = []
    for end in ends:
        a, b = motion_at(first, end), motion_at(second, end)
        parts.append((b[0] - a[0], b[1] - a[1]))
    opening = [part[0] * normal[0] + part[1] * normal[1] for part in parts]
    slip = sum(part[0] * along[0] + part[1] * along[1] for part in parts) / 2.0
    return opening[0], opening[1], slip


def check_roles(row: dict[str, str], joints: list[dict[str, str]], corners: dict[int, list[list[float]]]) -> None:
    """Roles, arrows, share and mode are those of the motion of the blocks."""
    slip, opening = 0.0, 0.0
    for joint in joints:
        *ends, way = relative(joint, corners)
        role = joint["mechanism"]
        slides = joint["slides_x"] != ""
        if slides:
            assert min(ends) < 1e-6 < abs(way)
            slip += abs(way)
        if role == "sliding":
            assert slides
        if role.startswith("hinge"):
            assert min(ends) < 1e-6 < max(ends)
            opening += max(ends)
        if role == "open":
            assert max(ends) > 1e-6 and not slides
        if role == "none":
            assert max(map(abs, ends)) < 1e-3
        if max(map(abs, ends)) < 1e-9:
            assert (role == "sliding") == (abs(way) > 1e-6)
    share = slip / (slip + opening)
    assert float(row["sliding_share"]) == pytest.approx(share, abs=1e-6)
    mode = "rotational" if share < 1e-3 else "sliding" if share > 0.999 else "mixed"
    assert row["collapse_mode"] == mode


def test_a_block_that_slides_away_from_a_wall_is_a_sliding_mechanism(tmp_path: Path) -> None:
    """The joint with the wall opens along its whole length: neither hinge nor slip."""
    blocks = BASE + box(-1.0, 0.0, 1.0, 2.0, "fixed") + box(0.0, 0.0, 1.0, 2.0)
    row, joints, corners = collapse_of(tmp_path, blocks, 20.0, "'horizontal_coefficient'")
    assert float(row["critical"]) == pytest.approx(math.tan(math.radians(20.0)), rel=1e-8)
    assert row["collapse_mode"] == "sliding"
    assert float(row["sliding_share"]) == 1.0
    assert [joint["mechanism"] for joint in joints] == ["sliding", "open"]
    assert joints[1]["slides_x"] == ""
    check_roles(row, joints, corners)


def test_no_joint_of_a_tilted_wall_slides_that_rounding_alone_moves(tmp_path: Path) -> None:
    search = "'gravity_direction_deg', low = -90, high = -60"
    row, joints, corners = collapse_of(tmp_path, window(), 35.0, search)
    assert row["collapse_mode"] == "rotational"
    assert float(row["sliding_share"]) == 0.0
    assert all(joint["mechanism"] != "sliding" for joint in joints)
    assert all(joint["slides_x"] == "" for joint in joints)
    check_roles(row, joints, corners)


@pytest.mark.parametrize(
    ("blocks", "friction", "mode"),
    [
        (BASE + box(0.0, 0.0, 1.0, 2.0), 40.0, "rotational"),
        (BASE + box(0.0, 0.0, 1.0, 2.0) + box(1.0, 0.0, 1.0, 0.5), 20.0, "sliding"),
        (BASE + box(0.0, 0.0, 1.0, 3.0) + box(1.0, 0.0, 1.0, 0.5), 30.0, "mixed"),
        (BASE + box(0.0, 0.0, 3.0, 0.5) + box(1.0, 0.5, 1.0, 0.8), 25.0, "sliding"),
        (window(), 20.0, ""),
    ],
    ids=["tips", "slides two", "tips over what slides", "slides on another", "window"],
)
def test_roles_are_those_of_the_motion(tmp_path: Path, blocks: str, friction: float, mode: str) -> None:
    row, joints, corners = collapse_of(tmp_path, blocks, friction, "'horizontal_coefficient'")
    assert row["verdict"] == "found"
    if mode:
        assert row["collapse_mode"] == mode
    check_roles(row, joints, corners)
