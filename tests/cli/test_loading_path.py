"""Static verdicts under Coulomb friction are those of the loading path: searches and decisions."""

import math
import re
from pathlib import Path

import pytest
from block_scene import wall
from dda_command import rows_of, run_dda, run_deck

BLOCK = "block\n{0} {1}\n{2} {1}\n{2} {3}\n{0} {3}\n"


def run_wall(folder: Path, units: int, courses: int, friction: float, more: str) -> list[dict]:
    """Rows of a deck of a wall with a coefficient of friction."""
    (folder / "wall.blocks").write_text(wall(courses, units, 2.0, 1.0, 1.0))
    run_deck(
        folder, "&scene kind = 'blocks', geometry = 'wall.blocks' /\n"
        f"&joint friction_deg = {math.degrees(math.atan(friction))!r} /\n{more}", "--quiet", name="deck")
    return sorted(rows_of(folder / "deck" / "results.csv"), key=lambda row: int(row["case"]))


@pytest.mark.parametrize("high", [0.8, 1.0, 3.0])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-8])
def test_the_range_of_a_search_does_not_matter(tmp_path: Path, high: float, tolerance: float) -> None:
    search = f"&search parameter = 'horizontal_coefficient', high = {high}, tolerance = {tolerance} /"
    (row,) = run_wall(tmp_path, 4, 8, 0.75, search + "\n")
    assert float(row["critical"]) == pytest.approx(5 / 9, abs=1e-6)


def test_single_decisions_are_monotone_and_agree_with_the_search(tmp_path: Path) -> None:
    """The wall falls from 5/9 on, up to twice the associated limit of 0.6078."""
    sweep = "&sweep parameter = 'horizontal_coefficient', first = 0, last = 1.2156, count = 61 /\n"
    rows = run_wall(tmp_path, 4, 8, 0.75, sweep)
    for row in rows:
        expected = "stable" if float(row["horizontal_coefficient"]) < 5 / 9 else "collapsed"
        assert row["verdict"] == expected, row["horizontal_coefficient"]


@pytest.mark.parametrize("flow", ["associated", "coulomb"])
def test_gravity_that_tilts_keeps_its_size(tmp_path: Path, flow: str) -> None:
    """A block on a joint of 30 degrees slides at that tilt, with W cos 30 across and W sin 30 along it."""
    (tmp_path / "x.blocks").write_text("block fixed\n-3 -1\n3 -1\n3 0\n-3 0\nblock\n-1 0\n1 0\n1 1\n-1 1\n")
    (tmp_path / "x.nml").write_text(
        f"&scene kind = 'blocks', geometry = 'x.blocks' /\n&analysis flow = '{flow}' /\n"
        "&material density = 1000 /\n&load gravity = 10 /\n&joint friction_deg = 30 /\n"
        "&search parameter = 'gravity_direction_deg', low = -90, high = -45 /\n&output joints = .true. /\n")
    assert run_dda("run", "x.nml", "--quiet", cwd=tmp_path).returncode == 0
    (joint,) = rows_of(tmp_path / "x" / "joints.csv")
    assert float(joint["normal_force"]) == pytest.approx(2e4 * math.cos(math.radians(30)), rel=1e-7)
    assert abs(float(joint["shear_force"])) == pytest.approx(2e4 * math.sin(math.radians(30)), rel=1e-7)


def test_a_load_that_no_forces_balance_is_proven_so_in_a_few_factorisations(tmp_path: Path) -> None:
    more = (
        "&analysis flow = 'associated' /\n&output joints = .false., blocks = .false. /\n"
        "&sweep parameter = 'horizontal_coefficient', values = 0.283, 0.51, 0.62, 0.85, 2.83 /\n"
    )
    rows = run_wall(tmp_path, 4, 8, 0.65, more)
    assert [row["verdict"] for row in rows] == ["stable"] * 2 + ["collapsed"] * 3


@pytest.mark.parametrize("flow", ["coulomb", "associated"])
@pytest.mark.parametrize(
    ("units", "courses", "friction", "limit"),
    [(4, 8, 0.65, 0.5663682243), (10, 10, 0.65, 0.5383777695), (4, 8, 0.3, 0.3)],
    ids=["turns", "turns and slides", "slides as a whole"],
)
def test_falls_beyond_the_associated_limit_are_known_by_a_few_factorisations(
    tmp_path: Path, units: int, courses: int, friction: float, limit: float, flow: str
) -> None:
    values = ", ".join(repr(limit * share) for share in (1.01, 1.1, 1.5, 5.0))
    more = (f"&analysis flow = '{flow}' /\n" f"&sweep parameter = 'horizontal_coefficient', values = {values} /\n")
    rows = run_wall(tmp_path, units, courses, friction, more)
    assert [row["verdict"] for row in rows] == ["collapsed"] * 4
    assert all(row["collapse_mode"] != "none" for row in rows)
    assert max(int(row["factorisations"]) for row in rows) <= 30


def test_what_limit_analysis_lets_stand_is_known_by_a_few_factorisations(tmp_path: Path) -> None:
    values = ", ".join(repr(0.5383777695 * share) for share in (0.5, 0.9, 0.99))
    more = ("&analysis flow = 'associated' /\n" f"&sweep parameter = 'horizontal_coefficient', values = {values} /\n")
    rows = run_wall(tmp_path, 10, 10, 0.65, more)
    assert [row["verdict"] for row in rows] == ["stable"] * 3
    assert max(int(row["factorisations"]) for row in rows) <= 15


def test_a_wall_without_ground_under_a_course_falls_by_a_few_factorisations(tmp_path: Path) -> None:
    """Half the wall stands beside the ground: its bricks fall, by friction of 30 degrees or none."""
    text = wall(8, 4, 2.0, 1.0, 1.0).replace("9.0 -1.0\n9.0 0.0", "3.0 -1.0\n3.0 0.0")
    (tmp_path / "half.blocks").write_text(text)
    run_deck(
        tmp_path, "&scene kind = 'blocks', geometry = 'half.blocks' /\n&joint friction_deg = 30 /\n",
        "--quiet", name="half")
    (row,) = rows_of(tmp_path / "half" / "results.csv")
    assert row["verdict"] == "collapsed"
    assert int(row["factorisations"]) <= 40


@pytest.mark.parametrize("units", [50, 200])
def test_the_middle_of_a_long_row_takes_no_part_in_what_its_ends_do(tmp_path: Path, units: int) -> None:
    """Bricks far from both ends move alike under a push: their joints do nothing, however many."""
    (row,) = run_wall(tmp_path, units, 2, 0.65, "&load horizontal_coefficient = 0.4 /\n")
    assert row["verdict"] == "stable"
    assert int(row["factorisations"]) <= 50
    assert int(row["steps"]) <= 5


@pytest.mark.parametrize(("units", "courses", "push"), [(2, 4, 7 / 11), (200, 4, 7 / 11), (120, 5, 0.6)])
def test_a_long_wall_falls_by_the_push_of_a_short_one(
    tmp_path: Path, units: int, courses: int, push: float
) -> None:
    """An end of it falls, however long the rest: joints there that reach their limit together cost little."""
    (row,) = run_wall(tmp_path, units, courses, 0.65, "&search parameter = 'horizontal_coefficient' /\n")
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(push, rel=1e-8)
    assert int(row["factorisations"]) <= 900


@pytest.mark.parametrize("blocks", [20, 200, 1000])
def test_tall_columns_tip_by_their_width_over_their_height(tmp_path: Path, blocks: int) -> None:
    """However far they bend before: 1000 cubes on one another bend ten million times as far as 20."""
    text = BLOCK.replace("block", "block fixed").format(-1, -1, 2, 0)
    (tmp_path / "column.blocks").write_text(text + "".join(BLOCK.format(0, k, 1, k + 1) for k in range(blocks)))
    deck = "&scene kind = 'blocks', geometry = 'column.blocks' /\n"
    (tmp_path / "search.nml").write_text(deck + "&search parameter = 'horizontal_coefficient' /\n")
    (tmp_path / "below.nml").write_text(deck + f"&load horizontal_coefficient = {0.9 / blocks} /\n")
    (tmp_path / "beyond.nml").write_text(deck + f"&load horizontal_coefficient = {1.1 / blocks} /\n")
    rows = []
    for name in ("search", "below", "beyond"):
        done = run_dda("run", f"{name}.nml", "--quiet", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        rows += rows_of(tmp_path / name / "results.csv")
    assert [row["verdict"] for row in rows] == ["found", "stable", "collapsed"]
    assert float(rows[0]["critical"]) == pytest.approx(1.0 / blocks, rel=1e-9)


def test_a_tall_column_that_was_pressed_first_tips_by_the_same_push(tmp_path: Path) -> None:
    """1000 cubes, pressed from above, then pushed at their top: with weight W and press P they tip by (W + P)/2000."""
    weight, press = 2400.0 * 9.81 * 1000.0, 1.0e3
    ground = BLOCK.replace("block", "block fixed").format(-1, -1, 2, 0)
    text = ground + "".join(BLOCK.format(0, k, 1, k + 1) for k in range(1000))
    for share, verdict in ((0.9, "stable"), (1.1, "collapsed")):
        push = share * (weight + press) / 2000.0
        (tmp_path / "wall.blocks").write_text(
            text + f"load block 1001 0.5 1000\n0 0 0\n1 0 {-press!r}\n2 {push!r} {-press!r}\n")
        (tmp_path / "deck.nml").write_text(
            "&scene kind = 'blocks', geometry = 'wall.blocks' /\n&material density = 2400 /\n&load gravity = 9.81 /\n")
        done = run_dda("run", "deck.nml", "--quiet", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert [row["verdict"] for row in rows_of(tmp_path / "deck" / "results.csv")] == [verdict]


def test_a_tall_column_that_sticks_tips_before_it_parts(tmp_path: Path) -> None:
    """1000 cubes with a cohesion that no joint of them uses up tip by their width over their height."""
    text = BLOCK.replace("block", "block fixed").format(-1, -1, 2, 0)
    (tmp_path / "wall.blocks").write_text(text + "".join(BLOCK.format(0, k, 1, k + 1) for k in range(1000)))
    run_deck(
        tmp_path, "&scene kind = 'blocks', geometry = 'wall.blocks' /\n&joint cohesion = 1e4 /\n"
        "&search parameter = 'horizontal_coefficient' /\n", "--quiet", name="deck")
    (row,) = rows_of(tmp_path / "deck" / "results.csv")
    assert float(row["critical"]) == pytest.approx(1.0e-3, rel=1e-6)


def test_a_portal_of_tall_columns_tips_as_each_of_them(tmp_path: Path) -> None:
    """Two columns of 300 cubes under a lintel, which bend more as its ends lift: pushed alike, they tip together."""
    cubes = [BLOCK.format(x, k, x + 1, k + 1) for k in range(300) for x in (0, 10)]
    ground = BLOCK.replace("block", "block fixed").format(-1, -1, 12, 0)
    (tmp_path / "wall.blocks").write_text(ground + "".join(cubes) + BLOCK.format(0, 300, 11, 301))
    (tmp_path / "deck.nml").write_text(
        "&scene kind = 'blocks', geometry = 'wall.blocks' /\n&search parameter = 'horizontal_coefficient' /\n")
    done = run_dda("run", "deck.nml", "--quiet", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (row,) = rows_of(tmp_path / "deck" / "results.csv")
    assert float(row["critical"]) == pytest.approx(1.0 / 300.0, rel=1e-9)


def two_rings(voussoirs: int, stuck: set[tuple[int, int]]) -> str:
    """Two rings of voussoirs over 175.5 degrees on fixed springings; some joints cannot slide."""
    half = math.radians(87.744)
    angles = [half * (2.0 * i / voussoirs - 1.0) for i in range(voussoirs + 1)]
    quads = []
    for inner in (10.0, 10.54374):
        rings = [[(r * math.sin(a), r * math.cos(a)) for a in angles] for r in (inner, inner + 0.54374)]
        quads += [(rings[0][i + 1], rings[1][i + 1], rings[1][i], rings[0][i]) for i in range(voussoirs)]
    text = "".join(f"material {number} density 1000\n" for number in range(2, len(quads) + 2))
    for number, quad in enumerate(quads, start=2):
        text += f"block material {number}\n" + "".join(f"{x!r} {y!r}\n" for x, y in quad)
    for side in (-1.0, 1.0):
        ends = [(side * r * math.sin(half), r * math.cos(half)) for r in (10.0, 11.08748)]
        down = (-side * math.cos(half), -math.sin(half))
        far = [(x + down[0], y + down[1]) for x, y in ends]
        corners = [*ends, far[1], far[0]] if side < 0.0 else [*ends[::-1], far[0], far[1]]
        text += "block fixed\n" + "".join(f"{x!r} {y!r}\n" for x, y in corners)
    return text + "".join(f"joint {a + 1} {b + 1} friction_deg 89.9\n" for a, b in sorted(stuck))


def test_how_rings_fall_whose_joints_slide_here_and_there_needs_no_run(tmp_path: Path) -> None:
    stuck = {(1, 13), (3, 4), (4, 16), (5, 6), (6, 18), (9, 10), (11, 12), (17, 18), (19, 20), (20, 21)}
    stuck |= {(21, 22), (22, 23), (0, 12)}
    (tmp_path / "rings.blocks").write_text(two_rings(12, stuck))
    run_deck(
        tmp_path, "&scene kind = 'blocks', geometry = 'rings.blocks' /\n&joint friction_deg = 36.653 /\n",
        "--quiet", name="rings")
    (row,) = rows_of(tmp_path / "rings" / "results.csv")
    assert row["verdict"] == "collapsed"
    # the joint graph tells how, not a run of steps
    assert int(row["steps"]) == 1


def test_arch_has_one_verdict_with_and_without_tables(tmp_path: Path) -> None:
    """Three voussoirs that fall on the way to tilted gravity and a push, though forces balance both at once."""
    verdicts = []
    for flag in (".true.", ".false."):
        run_deck(
            tmp_path, "&scene kind = 'arch' /\n"
            "&arch voussoirs = 3, half_angle_deg = 54.474975328928494, thickness_ratio = 0.011061216872680255 /\n"
            "&joint friction_deg = 45 /\n"
            "&load horizontal_coefficient = 0.5, gravity_direction_deg = -120 /\n"
            f"&output joints = {flag}, blocks = .false. /\n", "--quiet", name="deck")
        verdicts += [row["verdict"] for row in rows_of(tmp_path / "deck" / "results.csv")]
    assert verdicts == ["collapsed", "collapsed"]


def test_a_decision_says_the_jumps_on_its_way_as_the_search_does(tmp_path: Path) -> None:
    """The wall of 4 by 8 bricks with friction 0.65 jumps to another state before 0.54 of its weight pushes it."""
    (row,) = run_wall(tmp_path, 4, 8, 0.65, "&load horizontal_coefficient = 0.54 /\n")
    assert row["verdict"] == "stable"
    log = (tmp_path / "deck" / "log.txt").read_text()
    told = re.search(r"jumps on the loading path: \d+, the largest (\S+) m", log)
    assert told and 1e-9 < float(told[1]) < 1e-2
    run_wall(tmp_path, 4, 8, 0.65, "&load horizontal_coefficient = 0.1 /\n")
    assert "jumps" not in (tmp_path / "deck" / "log.txt").read_text()
