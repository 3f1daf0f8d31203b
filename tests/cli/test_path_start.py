"""Where joints that are loaded at once find no state under the dead loads, a rest in which nothing slides is one."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from assembly import area_and_centre, block_text
from block_scene import block, run_blocks, run_scene
from dda_command import rows_of, run_dda
from random_assemblies import make_pushed

BETWEEN_WALLS = """block fixed
0 0
1 0
1 1
0 1
block fixed
2 0
3 0
3 1
2 1
block
1 0
2 0
2 1
1 1
"""


def rows(folder: Path, blocks: str, task: str) -> list[dict[str, str]]:
    """Rows of a deck in the order of its cases."""
    return sorted(rows_of(run_scene(folder, blocks, task) / "results.csv"), key=lambda row: int(row["case"]))


@pytest.mark.parametrize(("flow", "verdict"), [("coulomb", "collapsed"), ("associated", "stable")])
def test_a_block_between_two_walls_falls_unless_sliding_presses_it(tmp_path: Path, flow: str, verdict: str) -> None:
    """Nothing presses it before its weight moves it; where sliding opens joints the walls clamp it."""
    sweep = "&sweep parameter = 'horizontal_coefficient', values = -0.3, 0, 0.01, 0.9 /"
    found = rows(tmp_path, BETWEEN_WALLS, f"&analysis flow = '{flow}' /\n&joint friction_deg = 45.0 /\n{sweep}")
    assert [row["verdict"] for row in found] == 4 * [verdict]


@pytest.mark.parametrize(("ends", "verdict"), [("1.5 0.5 1.5 -2", "collapsed"), ("1.5 0.5 1.5 3", "stable")])
def test_a_bar_holds_what_lies_between_two_walls_if_it_hangs_from_it(tmp_path: Path, ends: str, verdict: str) -> None:
    """One that would have to push is slack."""
    sweep = "&sweep parameter = 'load_factor', values = 0, 0.1, 1 /"
    scene = BETWEEN_WALLS + f"live 1.5 0.5 0 -100\nbar {ends} stiffness 1e9 slack\n"
    found = rows(tmp_path, scene, f"&joint friction_deg = 20.0 /\n{sweep}")
    assert [row["verdict"] for row in found] == 3 * [verdict]


def wedge_on_slope() -> str:
    """A wedge on a slope of 30 degrees; a push of its weight times tan(30) balances it without friction."""
    rise = math.tan(math.radians(30))
    slope = f"block fixed\n0 0\n6 0\n6 {6 * rise!r}\nblock\n2 {2 * rise!r}\n4 {4 * rise!r}\n2 {4 * rise!r}\n"
    # it is 2 wide and 2*rise high, its area 2*rise
    return slope + f"live {8 / 3!r} {10 / 3 * rise!r} {2e4 * 2 * rise * rise!r} 0\n"


@pytest.mark.parametrize(("flow", "verdict"), [("coulomb", "collapsed"), ("associated", "stable")])
def test_what_slides_by_its_weight_is_not_held_by_a_push_that_comes_later(
    tmp_path: Path, flow: str, verdict: str
) -> None:
    scene = wedge_on_slope()
    deck = f"&material unit_weight = 2e4 /\n&analysis flow = '{flow}' /\n&load load_factor = 1 /\n"
    sweep = "&sweep parameter = 'friction_deg', values = 5, 15, 25 /"
    assert [row["verdict"] for row in rows(tmp_path, scene, deck + sweep)] == 3 * [verdict]
    if flow == "coulomb":
        (row,) = rows(tmp_path, scene, deck + "&search parameter = 'friction_deg', low = 1, high = 60 /")
        assert float(row["critical"]) == pytest.approx(30.0, rel=1e-6)


@pytest.mark.parametrize(("low", "high"), [(0, 50), (0.5, 2), (-3, 1e9), (0, 1), (1, 50), (0, 0.6), (1.5, 9)])
def test_a_push_holds_a_wedge_between_two_factors(tmp_path: Path, low: float, high: float) -> None:
    """It stands while the push over the weight lies between tan(30 - 10) and tan(30 + 10)."""
    least, most = (math.tan(math.radians(angle)) / math.tan(math.radians(30)) for angle in (20, 40))
    task = f"&material unit_weight = 2e4 /\n&joint friction_deg = 10 /\n&analysis flow = 'associated' /\n"
    task += f"&search parameter = 'load_factor', low = {low!r}, high = {high!r} /"
    (row,) = rows(tmp_path, wedge_on_slope(), task)
    falls = [(end, value) for end, value in (("high", most), ("low", least)) if low < value < high]
    if falls:
        assert (row["verdict"], row["collapses_at"]) == ("found", falls[0][0])
        assert float(row["critical"]) == pytest.approx(falls[0][1], rel=1e-9)
        assert ("it also collapses at" in (tmp_path / "out" / "log.txt").read_text()) == (len(falls) == 2)
    else:
        assert row["verdict"] == "collapsed"


def test_a_search_says_what_falls_by_its_dead_loads(tmp_path: Path) -> None:
    search = "&search parameter = 'horizontal_coefficient', high = 0.9 /"
    (row,) = rows(tmp_path, BETWEEN_WALLS, f"&joint friction_deg = 45.0 /\n{search}")
    assert row["verdict"] == "collapsed"


def test_a_corbel_of_rough_blocks_is_decided_as_its_search_says(tmp_path: Path) -> None:
    """Friction of 88.8 degrees: springs that are loaded at once find no state, elastic blocks do."""
    assembly, ground = make_pushed(41155)
    blocks = ""
    for words, polygons in (("block fixed", ground), ("block", assembly.blocks)):
        for polygon in polygons:
            blocks += words + "\n" + "".join(f"{x!r} {y!r}\n" for x, y in polygon)
    assert len(assembly.blocks) == 12 and all(area_and_centre(block)[0] > 0.0 for block in assembly.blocks)
    rough = "&joint friction_deg = 88.7800220058748 /\n"
    (row,) = rows(tmp_path, blocks, rough + "&search parameter = 'horizontal_coefficient', high = 5 /")
    critical, limit = float(row["critical"]), float(row["exact_high"])
    # the limit by HiGHS
    assert limit == pytest.approx(0.247448380, abs=1e-8)
    assert critical <= limit * (1.0 + 1e-9)
    values = [share * critical for share in (0.5, 0.9, 0.99, 1.01, 1.5, 5.0)]
    sweep = f"&sweep parameter = 'horizontal_coefficient', values = {', '.join(map(repr, values))} /"
    found = rows(tmp_path, blocks, rough + sweep)
    assert [row["verdict"] for row in found] == 3 * ["stable"] + 3 * ["collapsed"]


def test_a_corbel_without_a_start_is_no_collapse_where_its_push_has_a_history(tmp_path: Path) -> None:
    """The same corbel under 0.4 of its limit, where no rest under the dead loads alone may stand for a start."""
    assembly, ground = make_pushed(41155)
    blocks = "".join(block(polygon, "fixed") for polygon in ground) + "".join(map(block, assembly.blocks))
    for number, polygon in enumerate(assembly.blocks, len(ground) + 1):
        area, (x, y) = area_and_centre(polygon)
        blocks += f"load block {number} {x!r} {y!r}\n0 0 0\n1 {0.1 * 2e4 * area!r} 0\n"
    row = run_blocks(tmp_path, blocks, "&material unit_weight = 2e4 /\n&joint friction_deg = 88.7800220058748 /\n")
    assert row["verdict"] in ("undecided", "stable")


def test_what_holds_only_as_sliding_opens_joints_falls(tmp_path: Path) -> None:
    """A ring some joints of which are very rough: dead loads at once fall, at once said."""
    (row,) = rows(tmp_path, block_text(*make_pushed(45014)), "&search parameter = 'horizontal_coefficient', high = 5 /")
    assert row["verdict"] == "collapsed"
    assert int(row["factorisations"]) < 2000


def test_a_slow_fall_between_sliding_joints_is_followed_to_its_end(tmp_path: Path) -> None:
    """A slope that falls while two joints stick and slide in turn: it falls below the limit of HiGHS, 0.255267937."""
    search = "&search parameter = 'horizontal_coefficient', high = 1e4 /"
    (row,) = rows(tmp_path, block_text(*make_pushed(7469)), search)
    assert row["verdict"] == "found"
    assert float(row["critical"]) < 0.255267937


def test_a_fall_of_very_rough_piers_takes_few_factorisations(tmp_path: Path) -> None:
    """Friction of 89.9 degrees beside 47: from the limit of HiGHS on, 0.0778216766, everything falls."""
    loads = ", ".join(repr(0.0778216766 * share) for share in (0.99, 1.01, 1.1, 1.5, 5.0))
    text = block_text(*make_pushed(46023))
    found = rows(tmp_path, text, f"&analysis flow = 'associated' /\n"
                 f"&sweep parameter = 'horizontal_coefficient', values = {loads} /")
    assert [row["verdict"] for row in found] == ["stable", *4 * ["collapsed"]]
    assert max(int(row["factorisations"]) for row in found) <= 40


@pytest.mark.parametrize(("seed", "limit"), [(94252, 0.660545399), (96428, 3.719716430), (96680, 6.202530221),
                                             (96682, 0.473189627), (96718, 0.815632907)])
def test_the_first_mechanism_of_a_fall_takes_few_factorisations(tmp_path: Path, seed: int, limit: float) -> None:
    """Rings and Voronoi cuts beside their limits by HiGHS: iterations begin well inside the cones."""
    loads = ", ".join(repr(limit * share) for share in (0.5, 0.99, 1.003, 1.01, 1.03, 1.1, 5.0))
    found = rows(tmp_path, block_text(*make_pushed(seed)), f"&analysis flow = 'associated' /\n"
                 f"&sweep parameter = 'horizontal_coefficient', values = {loads} /")
    assert [row["verdict"] for row in found] == [*2 * ["stable"], *5 * ["collapsed"]]
    assert max(int(row["factorisations"]) for row in found) <= 30


def test_a_path_of_many_jumps_is_one_way_to_all_its_loads(tmp_path: Path) -> None:
    """Piers that jump 58 times on their way: decisions beside the collapse agree with the search."""
    text = block_text(*make_pushed(45045))
    (found,) = rows(tmp_path, text, "&search parameter = 'horizontal_coefficient', high = 5 /")
    critical = float(found["critical"])
    shares = [1.0 + far * side for side in (-1.0, 1.0) for far in (3e-3, 6e-4, 1e-4, 2e-5)]
    loads = ", ".join(repr(critical * share) for share in shares)
    decided = rows(tmp_path, text, f"&sweep parameter = 'horizontal_coefficient', values = {loads} /")
    assert [row["verdict"] for row in decided] == [*4 * ["stable"], *4 * ["collapsed"]]


@pytest.mark.parametrize(("seed", "value"), [(94436, 0.6152328), (96362, 0.5623422)])
def test_rings_that_creep_on_by_sticking_and_slipping_fall(tmp_path: Path, seed: int, value: float) -> None:
    """Each slip is followed by another one, equally far: thousands of them lead to what counts as far.

    Jumps choose between branches there: with other thresholds of a jump the first falls at 0.6150628.
    """
    text = block_text(*make_pushed(seed))
    (found,) = rows(tmp_path, text, "&search parameter = 'horizontal_coefficient', high = 1e4 /")
    assert found["verdict"] == "found"
    assert float(found["critical"]) == pytest.approx(value, rel=1e-6)
    loads = ", ".join(repr(value * share) for share in (0.999, 1.001))
    decided = rows(tmp_path, text, f"&sweep parameter = 'horizontal_coefficient', values = {loads} /")
    assert [row["verdict"] for row in decided] == ["stable", "collapsed"]


def test_a_jump_that_settles_by_no_small_push_is_a_fall(tmp_path: Path) -> None:
    """A slope of 21 blocks, friction 43.8 degrees: a push of 1e-6 never settles, one of 2.5e-6 falls without end."""
    text = block_text(*make_pushed(94067))
    (found,) = rows(tmp_path, text, "&search parameter = 'horizontal_coefficient', high = 1e4 /")
    critical = float(found["critical"])
    assert 0.0 < critical < 1.0 and int(found["factorisations"]) < 1000
    loads = ", ".join(repr(critical * share) for share in (0.9, 0.999, 1.001, 1.1, 5.0))
    decided = rows(tmp_path, text, f"&sweep parameter = 'horizontal_coefficient', values = {loads} /")
    assert [row["verdict"] for row in decided] == [*2 * ["stable"], *3 * ["collapsed"]]


RAMP = "block fixed\n-4 -6\n4 -6\n4 -4\n-4 4\nblock\n-1 1\n1 -1\n2 0\n0 2\n"


@pytest.mark.parametrize("flow", ["coulomb", "associated"])
@pytest.mark.parametrize(("low", "high"), [(-169, -91), (-160, -20), (-130, -20)])
def test_gravity_that_tilts_is_searched_where_nothing_stands_upright(
    tmp_path: Path, flow: str, low: float, high: float
) -> None:
    """A block on a slope of 45 degrees, friction 30: it stands for gravity 30 degrees about the slope's normal."""
    search = f"&search parameter = 'gravity_direction_deg', low = {low}, high = {high} /"
    (row,) = rows(tmp_path, RAMP, f"&analysis flow = '{flow}' /\n&joint friction_deg = 30 /\n{search}")
    assert row["verdict"] == "found" and float(row["critical"]) == pytest.approx(-105.0, abs=1e-6)
    run = run_dda("run", "x.nml", cwd=tmp_path)
    assert ("it also collapses at -16" in run.stdout) == (low < -165)


@pytest.mark.parametrize("seed", [97000, 97060, 97100])
def test_what_no_direction_of_gravity_lets_stand_falls_by_a_few_factorisations(tmp_path: Path, seed: int) -> None:
    """Walls and slopes of 41 to 53 blocks: each mechanism rules out half a turn of gravity."""
    search = "&search parameter = 'gravity_direction_deg', low = -90, high = -20 /"
    (row,) = rows(tmp_path, block_text(*make_pushed(seed)), search)
    assert row["verdict"] == "collapsed"
    assert int(row["factorisations"]) <= 100 and int(row["open_close_iterations"]) == 0


def test_gravity_that_tilts_goes_one_way_to_all_angles(tmp_path: Path) -> None:
    """Blocks that jump 21 times as gravity tilts: decisions beside the collapse agree with the search."""
    text = block_text(*make_pushed(99164))
    (found,) = rows(tmp_path, text, "&search parameter = 'gravity_direction_deg', low = -90, high = -20 /")
    critical = float(found["critical"])
    values = [critical + far * side for side in (-1.0, 1.0) for far in (1e-2, 6e-4, 4e-4, 1e-4)]
    angles = ", ".join(map(repr, values))
    decided = rows(tmp_path, text, f"&sweep parameter = 'gravity_direction_deg', values = {angles} /")
    assert [row["verdict"] for row in decided] == [*4 * ["stable"], *4 * ["collapsed"]]


def test_a_fall_between_directions_that_limit_analysis_lets_stand_is_reported_in_seconds(tmp_path: Path) -> None:
    """A wall of 41 blocks that no direction of gravity lets stand under Coulomb friction, told by its joint graph."""
    (tmp_path / "x.blocks").write_text(block_text(*make_pushed(61030)))
    (tmp_path / "deck.nml").write_text("&scene kind = 'blocks', geometry = 'x.blocks' /\n"
                                       "&search parameter = 'gravity_direction_deg', low = -90, high = -20 /\n")
    # in steps it takes minutes
    done = run_dda("run", "deck.nml", cwd=tmp_path, timeout=40)
    assert done.returncode == 0 and "collapsed" in done.stdout, done.stderr


def test_a_block_that_slides_upright_and_holds_on_a_slope_is_found(tmp_path: Path) -> None:
    """A dead push of 0.6 of the weight, friction 25 degrees: gravity turned by a to the left holds the block where
    |0.6 - sin a| is at most tan 25 cos a."""
    weight = 2240.0 * 9.81 * 4.0
    text = ("block fixed\n-20 -1\n20 -1\n20 0\n-20 0\nblock\n0 0\n4 0\n4 1\n0 1\n"
            f"load block 2 2 0.5 {0.6 * weight!r} 0\n")
    (found,) = rows(tmp_path, text, "&joint friction_deg = 25.0 /\n"
                    "&search parameter = 'gravity_direction_deg', low = -160.0, high = -20.0 /")
    turn = math.degrees(math.asin(0.6 * math.cos(math.radians(25.0))))
    assert found["verdict"] == "found"
    assert float(found["critical"]) == pytest.approx(-90.0 - (turn - 25.0), rel=1e-6)
    other = (tmp_path / "out" / "log.txt").read_text().rpartition("it also collapses at ")[2]
    assert other.split()[0] == f"{-90.0 - (turn + 25.0):.6g}"
