"""`dda lines`: sets of joints, slopes, openings and bolts become lines that `dda cut` takes."""

from __future__ import annotations

import math
import random
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

TUNNEL = """&lines seed=3 form='{form}' /
&outline left=-20 right=20 bottom=-15 top=15 fixed='left','right','bottom' /
&opening shape='horseshoe' width=5 wall=2 y=-2 sides=20 /
&joint_set dip_deg=20 spacing=1.0 spacing_law='uniform' spacing_randomness=0.3 trace=8 bridge=1
   trace_law='exponential' material=2 /
&joint_set dip_deg=75 spacing=0.9 material=2 /
&bolts number=7 from_deg=20 to_deg=160 length=3 stiffness=2e8 strength=1e5 prestress=1e4 /
&point role='measure' x=0 y=4 /
&line role='material' x=-20, 20 y=10, 10 material=2 /
"""


def draw(text: str, folder: Path, name: str = "map") -> Path:
    """Draw a map and return the file of lines."""
    deck = folder / f"{name}.nml"
    deck.write_text(text)
    done = run_dda("lines", deck, "--out", folder / f"{name}.geo")
    assert done.returncode == 0, done.stderr
    return folder / f"{name}.geo"


def blocks_of(lines: Path) -> list[dict[str, str]]:
    """Cut a file of lines and return the rows of its table."""
    table = lines.with_suffix(".csv")
    done = run_dda("cut", lines, "--out", table)
    assert done.returncode == 0, done.stderr
    return rows_of(table)


def test_two_regular_sets_cut_blocks_of_one_area(tmp_path: Path) -> None:
    rows = blocks_of(
        draw(
            "&outline left=-30 right=30 bottom=-30 top=30 /\n"
            "&joint_set dip_deg=20 spacing=2 /\n&joint_set dip_deg=75 spacing=1.5 /\n",
            tmp_path,
        )
    )
    inside = [
        float(row["area"])
        for row in rows
        if max(abs(float(row["centroid_x"])), abs(float(row["centroid_y"]))) < 26.0
    ]
    assert len(inside) > 500
    assert max(abs(area - 3.662323766284368) for area in inside) < 1e-9
    assert sum(float(row["area"]) for row in rows) == pytest.approx(3600.0, rel=1e-12)


def test_blocks_fill_the_outline_but_for_the_opening(tmp_path: Path) -> None:
    rows = blocks_of(draw(TUNNEL.format(form="plain"), tmp_path))
    band = 2.0 * (math.sqrt(21.0) + 12.5 * math.asin(0.4) - 5.0)
    opening = 0.5 * math.pi * 2.5**2 + band
    total = sum(float(row["area"]) for row in rows)
    assert total == pytest.approx(1200.0 - opening, abs=0.12)
    assert all(float(row["area"]) > 0.0 for row in rows)


def test_the_same_seed_gives_the_same_bytes(tmp_path: Path) -> None:
    text = TUNNEL.format(form="plain")
    one, same = draw(text, tmp_path, "one"), draw(text, tmp_path, "same")
    other = draw(text.replace("seed=3", "seed=4"), tmp_path, "other")
    assert one.read_bytes() == same.read_bytes()
    assert one.read_bytes() != other.read_bytes()


def test_both_forms_hold_the_same_blocks(tmp_path: Path) -> None:
    plain = blocks_of(draw(TUNNEL.format(form="plain"), tmp_path, "plain"))
    ddaml = blocks_of(draw(TUNNEL.format(form="ddaml"), tmp_path, "ddaml"))
    assert plain == ddaml


def test_a_set_outside_the_outline_changes_nothing(tmp_path: Path) -> None:
    text = TUNNEL.format(form="plain")
    far = "&joint_set dip_deg=5 spacing=1 region_x=100,110,110 region_y=0,0,9 seed=9 /\n"
    one, other = draw(text, tmp_path, "one"), draw(text + far, tmp_path, "other")
    assert one.read_bytes() == other.read_bytes()


def test_a_slope_in_benches_has_its_area(tmp_path: Path) -> None:
    rows = blocks_of(
        draw(
            "&outline left=-10 right=50 bottom=-10 /\n"
            "&slope foot_x=0 foot_y=0 face_deg=45 bench_height=10 bench_width=5 benches=2 /\n"
            "&joint_set dip_deg=30 spacing=3 /\n&joint_set dip_deg=-60 spacing=4 /\n",
            tmp_path,
        )
    )
    assert sum(float(row["area"]) for row in rows) == pytest.approx(600.0 + 750.0, rel=1e-12)


BAD = {
    "no outline": ("&lines /\n", "map.nml:1: error: &lines: expected an &outline"),
    "unknown key": (
        "&outline lefd=1 /\n",
        "map.nml:1: error: unknown key 'lefd' in &outline: the nearest known key is left; 'dda help lines' lists all",
    ),
    "unknown group": (
        "&joint_sets /\n",
        "map.nml:1: error: unknown group &joint_sets: the nearest known group is &joint_set;",
    ),
    "no spacing": (
        "&outline left=0 right=1 bottom=0 top=1 /\n&joint_set spacing=0 /\n",
        "map.nml:2: error: joint_set%spacing must be a number",
    ),
    "too dense": (
        "&outline left=0 right=1e6 bottom=0 top=1e6 /\n&joint_set spacing=1e-5 /\n",
        "map.nml:2: error: expected a set of at most",
    ),
    "opening outside": (
        "&outline left=0 right=9 bottom=0 top=9 /\n&opening x=8 y=5 /\n",
        "map.nml:2: error: expected an opening inside the outline",
    ),
    "openings that meet": (
        "&outline left=-9 right=9 bottom=-9 top=9 /\n&opening /\n&opening x=2 /\n",
        "map.nml:3: error: expected openings that lie apart",
    ),
    "crossed outline": (
        "&outline x=0,1,0,1.5 y=0,1,1,0 /\n",
        "map.nml:1: error: &outline: expected an outline",
    ),
    "bolt outside": (
        "&outline left=-4 right=4 bottom=-4 top=4 /\n&opening /\n&bolts length=9 /\n",
        "map.nml:3: error: expected bolts inside the outline",
    ),
    "no such opening": (
        "&outline left=-4 right=4 bottom=-4 top=4 /\n&bolts /\n",
        "map.nml:2: error: &bolts: expected the number of an opening",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_maps_are_refused_with_their_line(case: str, tmp_path: Path) -> None:
    text, message = BAD[case]
    (tmp_path / "map.nml").write_text(text)
    done = run_dda("lines", "map.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert not (tmp_path / "map.geo").exists()


def test_mutated_maps_never_crash(tmp_path: Path) -> None:
    source = random.Random(5)
    words = "0 -1 1e9 1e-9 nan / & = ' , .true. &opening &bolts shape='arch' 'polygon' 3*2".split()
    text = TUNNEL.format(form="plain")
    for _ in range(300):
        parts = text.replace("=", " = ").split(" ")
        for _ in range(source.randint(1, 4)):
            i = source.randrange(len(parts))
            parts[i] = source.choice([source.choice(words), "", parts[source.randrange(len(parts))]])
        (tmp_path / "map.nml").write_text(" ".join(parts))
        done = run_dda("lines", "map.nml", cwd=tmp_path, timeout=60)
        assert done.returncode in (0, 2), " ".join(parts)
        if done.returncode == 2:
            assert ": error: " in done.stderr


@pytest.mark.parametrize("spacing", [1.7, 1.13, 0.83])
def test_blocks_along_held_sides_are_held_however_thin(tmp_path: Path, spacing: float) -> None:
    text = (
        "&lines seed=3 /\n&outline left=-12 right=12 bottom=-12 top=12 fixed='left','right','bottom' /\n"
        f"&joint_set dip_deg=0 spacing=1.5 /\n&joint_set dip_deg=70 spacing={spacing} /\n"
    )
    draw(text, tmp_path)
    (tmp_path / "deck.nml").write_text("&scene kind = 'lines', geometry = 'map.geo' /\n")
    assert run_dda("run", "deck.nml", "--out", "out", "--quiet", cwd=tmp_path).returncode == 0
    corners: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for row in rows_of(tmp_path / "out" / "blocks.csv"):
        corners.setdefault((row["block"], row["state"]), []).append((float(row["x"]), float(row["y"])))
    along = 0
    for (number, state), points in corners.items():
        for axis, side in ((0, -12.0), (0, 12.0), (1, -12.0)):
            if sum(abs(point[axis] - side) < 1e-9 for point in points) > 1:
                along += 1
                assert state == "fixed", f"block {number}"
    assert along > 30


def test_log_names_the_blocks_that_fall_out_of_a_tunnel(tmp_path: Path) -> None:
    text = (
        "&lines seed=3 /\n&outline left=-10 right=10 bottom=-8 top=10 fixed='left','right','bottom' /\n"
        "&opening shape='horseshoe' width=5 wall=2 y=-2 sides=12 /\n"
        "&joint_set dip_deg=0 spacing=1.5 spacing_law='uniform' spacing_randomness=0.2 /\n"
        "&joint_set dip_deg=70 spacing=1.7 /\n"
    )
    draw(text, tmp_path)
    (tmp_path / "deck.nml").write_text("&scene kind='lines', geometry='map.geo' /\n&joint friction_deg=35 /\n")
    assert run_dda("run", "deck.nml", "--out", "out", "--quiet", cwd=tmp_path).returncode == 0
    way: dict[str, float] = {}
    for row in rows_of(tmp_path / "out" / "blocks.csv"):
        way[row["block"]] = max(way.get(row["block"], 0.0), math.hypot(float(row["u"]), float(row["v"])))
    fallen = {block for block, far in way.items() if far > 0.01}
    line = (tmp_path / "out" / "log.txt").read_text().splitlines()[-1]
    assert f"blocks {len(fallen)} move:" in line
    assert set(line.split("move: ")[1].split(", ")) == fallen
