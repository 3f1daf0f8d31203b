"""Live loads: dead loads stay, the load factor multiplies what is live, and a search finds the first collapse."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from bridges import rings, spans
from dda_command import rows_of, run_deck

DATA = Path(__file__).parents[1] / "data"
GROUND = "block fixed\n-5 -1\n5 -1\n5 0\n-5 0\n"
BLOCK = "block\n0 0\n1 0\n1 2\n0 2\n"
WEIGHT = 2.0 * 2240.0 * 9.81  #: Weight of the block with the default density
#: It turns about a corner, half a metre from its centre of gravity, under a push of 1000 N at 2 m
TURNS = 0.5 * WEIGHT / 2.0 / 1000.0
PUSHED = GROUND + BLOCK + "live 0 2 1000 0\n"
SEARCH = "&search parameter = 'load_factor' /\n"


def table(file: str) -> list[dict[str, str]]:
    """Rows of a table of tests/data."""
    return rows_of(DATA / file)


def rows(folder: Path, groups: str, blocks: str = PUSHED, head: str | None = None) -> list[dict[str, str]]:
    """Rows of a deck, by default of a file of blocks."""
    (folder / "x.blocks").write_text(blocks)
    if head is None:
        head = "&scene kind = 'blocks', geometry = 'x.blocks' /\n"
    run_deck(folder, head + groups, "--quiet")
    return sorted(rows_of(folder / "x" / "results.csv"), key=lambda row: int(row["case"]))


def friction_of(word: str) -> str:
    """A deck's friction angle."""
    return "90" if word == "rough" else repr(math.degrees(math.atan(float(word))))


def assert_proven(row: dict[str, str], factor: float) -> None:
    """The proven bounds enclose a factor, which other programmes give to 1e-12."""
    low, high = float(row["exact_low"]), float(row["exact_high"])
    assert low * (1.0 - 1e-12) <= factor <= high * (1.0 + 1e-12)
    assert high - low <= 1e-8 * factor


@pytest.mark.parametrize("force", [1.0, 1e-3, 1e-5])
def test_a_small_live_load_keeps_its_digits_beside_weight(tmp_path: Path, force: float) -> None:
    """It is the factor that grows: nothing of the push is lost in the weight."""
    search = "&search parameter = 'load_factor', high = 1e12, tolerance = 1e-10 /\n"
    (row,) = rows(tmp_path, search, GROUND + BLOCK + f"live 0 2 {force!r} {-force / 3.0!r}\n")
    factor = 0.5 * WEIGHT / (2.0 * force - force / 3.0)
    assert float(row["exact_low"]) <= factor * (1.0 + 1e-15) and factor * (1.0 - 1e-15) <= float(row["exact_high"])
    assert float(row["exact_high"]) - float(row["exact_low"]) < 1e-12 * factor


def test_decisions_flip_where_the_search_says(tmp_path: Path) -> None:
    values = [-TURNS * 1.001, -TURNS * 0.999, 0.0, TURNS * 0.999999, TURNS * 1.000001, 1e6]
    sweep = f"&sweep parameter = 'load_factor', values = {', '.join(map(repr, values))} /\n"
    verdicts = [row["verdict"] for row in rows(tmp_path, sweep)]
    assert verdicts == ["collapsed", "stable", "stable", "stable", "collapsed", "collapsed"]


@pytest.mark.parametrize("row", table("practice_multi_span.csv"), ids=lambda row: "-".join(list(row.values())[:8]))
def test_spans_on_piers_carry_what_the_linear_programme_says(tmp_path: Path, row: dict[str, str]) -> None:
    deck = f"&material unit_weight = 1.0 /\n&joint friction_deg = {friction_of(row['friction'])} /\n" + SEARCH
    (found,) = rows(tmp_path, deck, spans(row))
    factor = float(row["P_over_weight_of_one_arch"])
    assert float(found["critical"]) == pytest.approx(factor, rel=1e-8)
    assert_proven(found, factor)


@pytest.mark.parametrize("row", table("practice_multi_ring.csv"), ids=lambda row: "-".join(list(row.values())[:5]))
def test_rings_carry_what_the_linear_programme_says(tmp_path: Path, row: dict[str, str]) -> None:
    deck = f"&material unit_weight = 1.0 /\n&joint friction_deg = {friction_of(row['friction_all_joints'])} /\n"
    associated = float(row["P_over_weight_associated_upper_bound"])
    (found,) = rows(tmp_path, deck + "&analysis flow = 'associated' /\n" + SEARCH, rings(row))
    assert float(found["critical"]) == pytest.approx(associated, rel=1e-8)
    (found,) = rows(tmp_path, deck + SEARCH, rings(row))
    assert_proven(found, associated)
    assert float(found["critical"]) <= float(found["exact_high"])
    if row["friction_all_joints"] == "rough":
        assert float(found["critical"]) == pytest.approx(associated, rel=1e-8)


def test_a_live_push_is_the_coefficient_times_the_factor(tmp_path: Path) -> None:
    (row,) = rows(tmp_path, "&search parameter = 'horizontal_coefficient' /\n", head="")
    (live,) = rows(tmp_path, "&load horizontal_coefficient = 0.1, live_horizontal = .true. /\n" + SEARCH, head="")
    assert float(live["critical"]) == pytest.approx(10.0 * float(row["critical"]), rel=1e-8)


def test_a_history_of_a_live_load_is_multiplied_too(tmp_path: Path) -> None:
    """It rises to 1000 N; the first factor at which some of it topples the block is that of the whole."""
    history = GROUND + BLOCK + "live 0 2\n0 0 0\n1 1000 0\n2 500 0\n"
    (row,) = rows(tmp_path, "&search parameter = 'load_factor', high = 100.0 /\n", history)
    assert float(row["critical"]) == pytest.approx(TURNS, rel=1e-7)


@pytest.mark.parametrize("mode", ["static", "dynamic"])
def test_moving_blocks_feel_the_factor(tmp_path: Path, mode: str) -> None:
    time = ", duration = 0.5, steps = 4000" if mode == "dynamic" else ""
    deck = f"&analysis mode = '{mode}', geometry = 'current'{time} /\n&output joints = .true. /\n"
    shear = []
    for factor in (0.5, 1.5):
        (row,) = rows(tmp_path, f"&load load_factor = {factor} /\n" + deck)
        assert row["verdict"] in ("stable", "completed")
        shear.append(sum(abs(float(joint["force_x"])) for joint in rows_of(tmp_path / "x" / "joints.csv")))
    if mode == "static":
        assert shear == pytest.approx([500.0, 1500.0], rel=1e-6)
    else:
        assert shear[1] > 2.0 * shear[0]


def test_the_original_scheme_feels_the_factor(tmp_path: Path) -> None:
    sweep = "&sweep parameter = 'load_factor', values = 9.0, 13.0 /\n"
    verdicts = [row["verdict"] for row in rows(tmp_path, "&analysis mode = 'limerick' /\n" + sweep)]
    assert verdicts == ["stable", "collapsed"]


def test_a_load_on_an_arch_is_one_on_its_blocks(tmp_path: Path) -> None:
    """The middle of an extrados chord of 120 degrees, one span of the table."""
    row = table("practice_multi_span.csv")[0]
    x, y = spans(row).splitlines()[-1].split()[3:5]
    weight = spans(row).split()[-1]
    deck = (
        f"&arch radius = 1.0, half_angle_deg = 60.0, voussoirs = 20, thickness_ratio = {row['thickness_ratio']} /\n"
        f"&material unit_weight = 1.0 /\n&live x = {x}, y = {y}, fy = {weight} /\n"
        f"&joint friction_deg = {friction_of(row['friction'])} /\n"
    )
    (found,) = rows(tmp_path, deck + SEARCH, head="")
    assert float(found["critical"]) == pytest.approx(float(row["P_over_weight_of_one_arch"]), rel=1e-8)
    assert found["exact"] == ""


def test_the_place_of_a_load_is_swept(tmp_path: Path) -> None:
    """Two places that mirror one another carry the same, and one nearer to the crown carries more."""
    deck = (
        "&arch radius = 1.0, half_angle_deg = 60.0, voussoirs = 20 /\n&live x = 0.0, y = 1.0, fy = -1e4 /\n"
        "&sweep parameter = 'x(1)', values = -0.4, 0.2, 0.4 /\n"
        "&sweep parameter = 'y(1)', values = 0.9, 0.98, 0.9, linked = .true. /\n"
    )
    left, inner, right = (float(row["critical"]) for row in rows(tmp_path, deck + SEARCH, head=""))
    assert left == pytest.approx(right, rel=1e-9)
    assert inner > 1.2 * left
