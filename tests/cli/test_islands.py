"""Blocks around other blocks, cut from lines: pieces without holes that a bond holds together."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda, run_deck

Ring = list[tuple[float, float]]


def box(x: float, y: float, width: float, height: float) -> Ring:
    """Corners of a rectangle."""
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def file_of(folder: Path, rings: list[Ring], points: str = "", kinds: str = "0 0 0 0") -> str:
    """Write rings as a file of lines: its name."""
    rows = [f"{a!r} {b!r} {c!r} {d!r} 1" for ring in rings for (a, b), (c, d) in zip(ring, ring[1:] + ring[:1])]
    head = f"0\n{len(rows)} 0\n0\n0\n{kinds}\n"
    (folder / "a.geo").write_text(head + "\n".join(rows) + "\n" + points)
    return "a.geo"


def areas_of(folder: Path, rings: list[Ring]) -> list[float]:
    """Areas of the blocks that rings are cut into."""
    done = run_dda("cut", file_of(folder, rings), "--out", "a.csv", cwd=folder)
    assert done.returncode == 0, done.stderr
    return [float(row["area"]) for row in rows_of(folder / "a.csv")]


def test_concentric_rings_keep_their_areas(tmp_path: Path) -> None:
    rings = [box(-r, -r, 2 * r, 2 * r) for r in (5.0, 4.0, 3.0, 1.0)]
    areas = sorted(areas_of(tmp_path, rings))
    assert sum(areas) == pytest.approx(100.0, rel=1e-12)
    assert len(areas) == 7  # two pieces of each ring, and the core
    assert areas[0] == pytest.approx(4.0, rel=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_random_islands_are_cut_free(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    rings, solid = [box(0.0, 0.0, 40.0, 40.0)], 0
    for column in range(4):
        for row in range(4):
            if rng.random() < 0.3:
                continue
            x, y = 10.0 * column + rng.uniform(0.5, 2.0), 10.0 * row + rng.uniform(0.5, 2.0)
            width, height = rng.uniform(2.0, 7.0), rng.uniform(2.0, 7.0)
            corners = [(x, y), (x + width, y + rng.uniform(0.0, 0.5)), (x + width / 2.0, y + height)]
            if rng.random() < 0.5:
                corners.append((x + rng.uniform(-0.4, 0.4), y + height / 2.0))
            rings.append(corners)
            solid += 1
            if rng.random() < 0.5:  # an island in the island
                middle = (sum(p[0] for p in corners) / len(corners), sum(p[1] for p in corners) / len(corners))
                rings.append([(middle[0] + 0.2 * (p[0] - middle[0]), middle[1] + 0.2 * (p[1] - middle[1]))
                              for p in corners])
                solid += 1
    areas = areas_of(tmp_path, rings)
    assert sum(areas) == pytest.approx(1600.0, rel=1e-12)
    assert len(areas) > solid


@pytest.mark.parametrize("mode", ["static", "limerick"])
def test_a_block_with_an_island_turns_about_its_foot_as_one(tmp_path: Path, mode: str) -> None:
    rings = [box(-1.0, -1.0, 3.0, 1.0), box(0.0, 0.0, 1.0, 2.0), box(0.25, 0.5, 0.5, 0.75)]
    name = file_of(tmp_path, rings, "-0.9 -0.5 -0.9 -0.5\n1.9 -0.5 1.9 -0.5\n", "2 0 0 0")
    deck = f"&scene kind = 'lines', geometry = '{name}' /\n&joint friction_deg = 80 /\n"
    if mode == "static":
        (tmp_path / "a.nml").write_text(deck + "&search parameter = 'horizontal_coefficient' /\n")
    else:
        (tmp_path / "a.nml").write_text(
            deck + "&load horizontal_coefficient = 0.45 /\n&analysis mode = 'limerick', steps = 60 /\n"
            "&material young = 1e8 /\n")
    done = run_dda("run", "a.nml", cwd=tmp_path)
    assert done.returncode in (0, 3), done.stderr
    row = rows_of(tmp_path / "a" / "results.csv")[0]
    if mode == "static":  # width over height: what lies inside goes with it
        assert float(row["critical"]) == pytest.approx(0.5, rel=1e-7)
    else:
        assert row["verdict"] == "stable"


def test_material_lines_and_holds_reach_all_pieces(tmp_path: Path) -> None:
    rings = [box(0.0, 0.0, 4.0, 4.0), box(1.0, 1.0, 1.0, 1.0), box(0.0, 4.0, 4.0, 1.0)]
    rows = [f"{a!r} {b!r} {c!r} {d!r} 1" for ring in rings for (a, b), (c, d) in zip(ring, ring[1:] + ring[:1])]
    (tmp_path / "a.geo").write_text(
        f"0\n{len(rows)} 0\n1\n0\n2 0 0 0\n" + "\n".join(rows) + "\n0.2 0.2 0.3 0.3 2\n"
        "0.5 3.5 0.5 3.5\n3.5 3.5 3.5 3.5\n")
    done = run_dda("cut", "a.geo", "--out", "a.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    blocks = rows_of(tmp_path / "a.csv")
    assert [row["material"] for row in blocks].count("2") == 2  # both pieces of the block around the island
    run_deck(tmp_path, "&scene kind = 'lines', geometry = 'a.geo' /\n&load horizontal_coefficient = 0.3 /\n", name="a")
    assert rows_of(tmp_path / "a" / "results.csv")[0]["verdict"] == "stable"  # held: one point in each piece
