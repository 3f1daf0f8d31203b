"""blocks.csv, and what joints.csv tells of any scene: blocks, forces, mechanism, way of sliding."""

from __future__ import annotations

import math
from collections import defaultdict
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda, run_deck

ROOT = Path(__file__).resolve().parents[2]
BENCHMARKS = ROOT / "input" / "benchmarks"
Row = dict[str, str]


def run(folder: Path, text: str, *options: str) -> Path:
    """Folder of the results of a deck."""
    run_deck(folder, text, "--quiet", *options, name="deck")
    return folder / "deck"


def corners_of(rows: list[Row]) -> dict[int, list[tuple[float, ...]]]:
    """Place and displacement of the corners of each block."""
    corners = defaultdict(list)
    for row in rows:
        corners[int(row["block"])].append(tuple(float(row[name]) for name in "xyuv"))
    return corners


def area_of(corners: list[tuple[float, ...]]) -> float:
    """Area of a block, positive where its corners run anticlockwise."""
    ends = corners[1:] + corners[:1]
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, ends)) / 2


@pytest.mark.parametrize("deck", ["stack", "goodman_bray", "dry_wall_2x4"])
def test_forces_of_the_joints_carry_every_block(tmp_path: Path, deck: str) -> None:
    options = ["--out", str(tmp_path / "out"), "--quiet", "--set", "output%joints=.true."]
    assert run_dda("run", BENCHMARKS / f"{deck}.nml", *options).returncode in (0, 3)
    corners = corners_of([row for row in rows_of(tmp_path / "out/blocks.csv") if row["case"] == "1"])
    fixed = {row["block"] for row in rows_of(tmp_path / "out/blocks.csv") if row["state"] == "fixed"}
    result = rows_of(tmp_path / "out/results.csv")[0]
    push = float(result["critical"]) if result["critical"] else 0.0
    weight = 2240 * 9.81 if deck == "dry_wall_2x4" else 25e3
    total = defaultdict(lambda: [0.0, 0.0])
    for row in rows_of(tmp_path / "out/joints.csv"):
        if row["case"] != "1":
            continue
        for block, sign in ((row["block_1"], -1.0), (row["block_2"], 1.0)):
            for i, part in enumerate(("force_x", "force_y")):
                total[block][i] += sign * float(row[part])
    largest = weight * max(area_of(corners[int(block)]) for block in total if block not in fixed)
    for block in set(total) - fixed:
        load = weight * area_of(corners[int(block)])
        assert total[block][1] == pytest.approx(load, abs=1e-4 * largest)
        assert total[block][0] == pytest.approx(-push * load, abs=1e-4 * largest)


def test_sliding_springings_are_reported_with_their_way(tmp_path: Path) -> None:
    text = "&arch voussoirs = 36 /\n&joint friction_deg = 20 /\n&search /\n"
    joints = rows_of(run(tmp_path, text) / "joints.csv")
    slides = [row for row in joints if row["mechanism"] == "sliding"]
    assert [row["joint"] for row in slides] == ["1", "37"]
    for row in slides:
        assert abs(float(row["shear_force"])) == pytest.approx(
            math.tan(math.radians(20)) * float(row["normal_force"]), rel=1e-8)
    for row, (first, second) in zip(slides, (("37", "1"), ("36", "38"))):
        assert (row["block_1"], row["block_2"]) == (first, second)
        # the arch goes outwards: its left end, the second block, to the left; its right end, the
        # first block, to the right, so that the springing slides to the left past it
        assert float(row["slides_x"]) == pytest.approx(-1.0, abs=1e-12)
        assert float(row["slides_y"]) == pytest.approx(0.0, abs=1e-12)
    assert all(row["slides_x"] == "" for row in joints if row not in slides)


def test_far_blocks_are_reported_in_the_coordinates_of_the_user(tmp_path: Path) -> None:
    (tmp_path / "x.blocks").write_text(
        "block fixed\n1e6 0\n1000001 0\n1000001 1\n1e6 1\n" "block\n1e6 1\n1000001 1\n1000001 2\n1e6 2\n")
    folder = run(tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n")
    assert [row["x"] for row in rows_of(folder / "blocks.csv")] == ["1000000", "1000001", "1000001", "1000000"] * 2
    (joint,) = rows_of(folder / "joints.csv")
    assert float(joint["x"]) == pytest.approx(1000000.5, abs=1e-6)
    assert float(joint["force_y"]) == pytest.approx(2240 * 9.81, rel=1e-6)


def test_the_original_scheme_reports_how_far_its_blocks_have_moved(tmp_path: Path) -> None:
    done = run_dda("run", ROOT / "input/limerick/both_sides.nml", "--out", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    rows = rows_of(tmp_path / "blocks.csv")
    largest = {
        case: max(math.hypot(float(row["u"]), float(row["v"]))
                  for row in rows if row["case"] == case)
        for case in ("1", "2")
    }
    # the first arch falls, that is by a twentieth of its radius; the second comes to rest
    assert largest["1"] >= 0.5 > 0.1 > largest["2"] > 0.0


@pytest.mark.parametrize("kind", ["static", "limerick"])
@pytest.mark.parametrize("name", ["joints", "blocks"])
@pytest.mark.parametrize(
    ("cases", "setting", "written"),
    [(3, "", True), (100, "", True), (101, "", False), (101, ".true.", True), (101, ".false.", False),
     (2, ".false.", False)],
)
def test_joints_and_blocks_of_many_cases_are_written_on_demand(
    tmp_path: Path, name: str, cases: int, setting: str, written: bool, kind: str
) -> None:
    """Where they are not for the number of cases, check, screen and log say so."""
    options = ["--set", f"output%{name}={setting}"] if setting else []
    text = (
        "&arch voussoirs = 2, thickness_ratio = 0.5 /\n"
        f"&analysis mode = '{kind}', steps = 9 /\n"
        f"&sweep parameter = 'radius', first = 1, last = 2, count = {cases} /\n"
    )
    (tmp_path / "deck.nml").write_text(text)
    done = run_dda("run", "deck.nml", *options, cwd=tmp_path)
    assert (tmp_path / f"deck/{name}.csv").exists() == written
    plan = run_dda("check", "deck.nml", *options, cwd=tmp_path).stdout
    log = (tmp_path / "deck/log.txt").read_text().splitlines()
    for said in (done.stdout, plan, log[0]):
        words = [f"no {name}.csv", f"and {name}.csv"]
        silent = written or setting != ""
        assert any(word in said for word in words) != silent, said
        assert (f"output%{name} = .true." in said) != silent, said
    assert len(log) == cases + 1
