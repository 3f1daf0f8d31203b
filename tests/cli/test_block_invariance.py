"""The same scene mirrored, renumbered, turned, scaled and moved far away: the same answer."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Callable

import pytest
from block_scene import run_scene
from dda_command import rows_of

Point = tuple[float, float]
Polygon = list[Point]

# a post, a taller one, a crooked lintel with a corner cut off, and a block leaning on its end
BASE = [(-3.0, -1.0), (9.0, -1.0), (9.0, 0.0), (-3.0, 0.0)]
BLOCKS = [
    [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0), (0.0, 3.0)],
    [(4.0, 0.0), (5.25, 0.0), (5.25, 3.0), (4.0, 3.0)],
    [(-0.5, 3.0), (6.0, 3.0), (6.0, 3.5), (5.5, 3.8), (-0.5, 3.8)],
]


def scene(move: Callable[[Point], Point], order: tuple[int, ...] = (0, 1, 2), first: int = 0) -> str:
    """Text of the file of blocks with all corners moved."""
    text = []
    polygons = [("block fixed", BASE)] + [("block", BLOCKS[i]) for i in order]
    if first:
        polygons = polygons[1:] + polygons[:1]
    for head, polygon in polygons:
        corners = polygon[first:] + polygon[:first]
        text += [head, *(f"{x!r} {y!r}" for x, y in map(move, corners))]
    return "\n".join(text) + "\n"


def run(folder: Path, blocks: str, deck: str, geometry: str) -> Path:
    """Run a deck on these blocks."""
    folder.mkdir()
    return run_scene(folder, blocks, f"&analysis geometry = '{geometry}' /\n{deck}")


def critical(folder: Path, blocks: str, deck: str, geometry: str) -> float:
    """The critical value."""
    (row,) = rows_of(run(folder, blocks, deck, geometry) / "results.csv")
    assert row["verdict"] == "found"
    return float(row["critical"])


def joints(folder: Path, blocks: str, deck: str, geometry: str) -> list[dict[str, str]]:
    """Rows of joints.csv."""
    return rows_of(run(folder, blocks, deck, geometry) / "joints.csv")


def same(point: Point) -> Point:
    return point


def search(young: float = 5e9, low: float = 0.0, high: float = 1.0) -> str:
    """Deck that searches the push at which the scene falls."""
    return (
        f"&joint friction_deg = 35.0 /\n&material young = {young!r}, unit_weight = 25000.0 /\n"
        f"&search parameter = 'horizontal_coefficient', low = {low!r}, high = {high!r} /\n"
    )


@pytest.fixture(params=["reference", "current"])
def geometry(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def plain(tmp_path: Path, geometry: str) -> float:
    """Critical push of the scene as it is."""
    return critical(tmp_path / "plain", scene(same), search(), geometry)


def test_critical_push_is_that_of_two_posts(plain: float) -> None:
    """Tipping about the toes: weights times half widths, the lintel's on the posts' tops."""
    assert 0.3 < plain < 0.5


def test_renumbered(tmp_path: Path, geometry: str, plain: float) -> None:
    blocks = scene(same, order=(2, 0, 1), first=2)
    assert critical(tmp_path / "other", blocks, search(), geometry) == pytest.approx(plain, rel=1e-8)


def test_mirrored(tmp_path: Path, geometry: str, plain: float) -> None:
    blocks = scene(lambda p: (-p[0], p[1]))
    other = critical(tmp_path / "other", blocks, search(low=-1.0, high=0.0), geometry)
    assert -other == pytest.approx(plain, rel=1e-8)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_scaled_with_the_weight_over_the_stiffness_held(
    tmp_path: Path, geometry: str, plain: float, scale: float
) -> None:
    blocks = scene(lambda p: (p[0] * scale, p[1] * scale))
    other = critical(tmp_path / "other", blocks, search(young=5e9 * scale), geometry)
    assert other == pytest.approx(plain, rel=1e-8)


def test_moved_by_ten_thousand_kilometres(tmp_path: Path, geometry: str, plain: float) -> None:
    blocks = scene(lambda p: (p[0] + 1e7, p[1] + 1e7))
    assert critical(tmp_path / "other", blocks, search(), geometry) == pytest.approx(plain, rel=1e-8)


def test_places_move_with_the_scene_to_four_spacings(tmp_path: Path, geometry: str) -> None:
    """Blocks a tenth of a metre wide, coordinates of 1e7 m."""
    deck = "&joint friction_deg = 35.0 /\n&load horizontal_coefficient = 0.1 /\n"
    rows = joints(tmp_path / "a", scene(lambda p: (p[0] / 10, p[1] / 10)), deck, geometry)
    far = joints(tmp_path / "b", scene(lambda p: (p[0] / 10 + 1e7, p[1] / 10 + 1e7)), deck, geometry)
    assert len(rows) == len(far) == 4
    for row, other in zip(rows, far):
        for name in ("x_intrados", "y_intrados", "x_extrados", "y_extrados"):
            assert float(other[name]) - 1e7 == pytest.approx(float(row[name]), abs=8e-9)


def test_turned_by_17_3_degrees(tmp_path: Path, geometry: str) -> None:
    """Forces of the joints under gravity that turns with the scene."""
    angle = math.radians(17.3)
    c, s = math.cos(angle), math.sin(angle)
    deck = "&joint friction_deg = 35.0 /\n&load gravity_direction_deg = {} /\n"
    rows = joints(tmp_path / "a", scene(same), deck.format(-80.0), geometry)
    turned = scene(lambda p: (c * p[0] - s * p[1], s * p[0] + c * p[1]))
    other = joints(tmp_path / "b", turned, deck.format(-62.7), geometry)
    total = sum(float(row["normal_force"]) for row in rows)
    assert len(rows) == len(other) == 4
    for row, again in zip(rows, other):
        for name in ("normal_force", "shear_force"):
            assert float(again[name]) == pytest.approx(float(row[name]), abs=1e-8 * total)
