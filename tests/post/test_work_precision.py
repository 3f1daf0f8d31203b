"""`voussoir work-precision`: the linear programs against exact values, and a small run."""

import math

import numpy as np
import pytest
from dda_command import rows_of

import voussoir
from voussoir import theory
from voussoir.command.main import main
from voussoir.deck.run import Deck
from voussoir_benches import limit_lp
from voussoir_benches.limit_lp_blocks import assembly_of, limit_factor
from voussoir_benches.work_precision_fronts import Panel, Point, front
from voussoir_benches.work_precision_motion import MotionPoint, order, pendulum_quarter
from voussoir_benches.work_precision_page import answer_words, draw, front_table, motion_table, race_table
from voussoir_benches.work_precision_runs import Arch, Race
from voussoir_benches.work_precision_scenes import ORIGINAL, RIGID, three_rings, wall

needs_scipy = pytest.mark.skipif(limit_lp.scipy_version() is None, reason="scipy is missing")


@needs_scipy
@pytest.mark.parametrize("program", [limit_lp.stands_by_general, limit_lp.stands_by_compact])
@pytest.mark.parametrize(
    ("half_angle", "voussoirs", "friction"),
    [(45, 18, 60), (90, 4, 60), (90, 36, 60), (90, 36, 20), (120, 48, 50), (145, 58, 65)],
)
def test_linear_programs_know_the_critical_thickness(program, half_angle, voussoirs, friction):
    alpha, angle = math.radians(half_angle), math.radians(friction)
    exact = float(theory.discrete_critical(voussoirs, alpha, friction=angle))
    for distance in (-1e-2, -1e-3, 1e-3, 1e-2):
        stands = program(alpha, voussoirs, exact * (1.0 + distance), math.tan(angle))
        assert stands == (distance > 0.0)


@needs_scipy
def test_general_program_takes_an_odd_number_of_voussoirs():
    exact = float(theory.discrete_critical(35, math.pi / 2.0, friction=math.radians(60.0)))
    for factor in (0.999, 1.001):
        answer = limit_lp.stands_by_general(math.pi / 2.0, 35, factor * exact, math.tan(1.0))
        assert answer == (factor > 1.0)
    with pytest.raises(ValueError, match="even number"):
        limit_lp.stands_by_compact(math.pi / 2.0, 35, exact, 1.0)


def point(error, seconds):
    """A point of one method."""
    return Point("arch", RIGID, "", error, seconds, None)


def test_front_never_runs_backwards_and_nothing_beats_it():
    points = [point(1e-5, 1.0), point(1e-3, 0.5), point(1e-2, 0.7), point(None, 0.1), point(1e-9, 4.0),
              point(1e-9, 3.0)]
    best = front(points)
    assert [(one.error, one.seconds) for one in best] == [(1e-3, 0.5), (1e-5, 1.0), (1e-9, 3.0)]
    assert front([point(None, 1.0)]) == []
    row = front_table([Panel("", tuple(points))])[-1]
    assert row == f"| arch | {RIGID} | 1e-09 | 500 ms | 500 ms | 3e+03 ms | 3e+03 ms |"


def test_legend_says_the_best_answer_and_when_it_is_first_had():
    assert answer_words("a", [point(1e-3, 0.01), point(2e-15, 0.02), point(1e-16, 3.0)]) == "a: all digits in 20 ms"
    assert answer_words("a", [point(0.0732, 2.34), point(0.1, 1e-3)]) == "a: 7.3 % in 2.3 s"
    assert answer_words("a", [point(2e-8, 4.2e-5)]) == "a: $2\\cdot10^{-8}$ in 0.042 ms"
    assert answer_words("a", [point(None, 1.0)]) == "a: no answer"


def test_methods_without_an_answer_are_drawn_beside_those_with_one(tmp_path):
    pytest.importorskip("matplotlib")
    silent = Point("three rings", ORIGINAL, "", None, 1.0, None)
    one = Point("three rings", RIGID, "", 1e-3, 0.5, None)
    paths = draw([Panel("three", (one, silent), 0.3)], tmp_path)
    assert [path.name for path in paths] == ["work_precision_three_rings.svg", "work_precision_three_rings.png"]
    assert draw([Panel("none", (silent,))], tmp_path) == []


@needs_scipy
@pytest.mark.parametrize("scene", [wall(3, 3), wall(8, 5), three_rings(2, 12)])
@pytest.mark.parametrize("solver", ["highs-ds", "highs-ipm"])
def test_program_of_blocks_knows_the_associated_limit(scene, solver):
    groups = {**scene.groups, "output": {}}
    run = voussoir.run(Deck(groups, scene.files))
    push = None
    if scene.live_block is not None:
        push = scene.live_block, np.array(scene.live_point), np.array([0.0, -1000.0 / (2240 * 9.81)])
    friction = math.tan(math.radians(scene.friction_deg))
    found = limit_factor(assembly_of(run, push), friction, solver, 1e-9)
    row = run.case(1)
    assert row["exact_low"] * (1 - 1e-8) < found < row["exact_high"] * (1 + 1e-8)
    assert row["critical"] < found * (1 + 1e-7)  # Coulomb friction carries no more


def test_ratios_are_those_of_the_times():
    times = Race(Arch(90.0, 36), 1e-4, 4, 1e-3, 1e-2, 4, 2e-3, 3)
    assert race_table([times])[-1].endswith("| 3 of 4 | 100 | 20.0 | 0.50 |")
    without = Race(Arch(90.0, 36), 1e-4, 4, 1e-3, None, 0, None, 0)
    assert race_table([without])[-1].count("-") == 7


def test_order_is_the_slope_of_errors_that_are_more_than_rounding():
    points = [MotionPoint("x", 2.0**-k, 3.0 * 4.0**-k, 1.0, 1) for k in range(5)]
    assert order(points) == pytest.approx(2.0, abs=1e-12)
    assert order([MotionPoint("x", 1.0, 1e-10, 1.0, 1)] * 3) is None
    row = motion_table(points)[-1]
    assert row.startswith("| x | 2.0 | 3.0e+00 |") and row.endswith("| none | none | none | none |")


def test_small_pendulum_swings_as_huygens_has_it():
    assert pendulum_quarter(1e-4, 2.0) == pytest.approx(math.pi / 4.0, rel=1e-8)
    # K(sin 45 deg) of Legendre's tables
    assert pendulum_quarter(math.pi / 2.0, 1.0) == pytest.approx(1.854074677301372, rel=1e-14)


def test_motion_alone_converges_as_it_should(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    words = ["work-precision", "--motion", "--repeats", "1", "--out", str(tmp_path)]
    assert main(words) == 0
    assert "| pendulum: quarter period | 2.0 |" in capsys.readouterr().out
    rows = rows_of(tmp_path / "work_precision_motion.csv")
    worst = {row["scene"]: float(row["error"]) for row in reversed(rows)}
    least = {row["scene"]: float(row["error"]) for row in rows}
    assert worst["incline: way"] < 1e-8 and worst["bounce: second top"] < 1e-8
    assert least["rocking: quarter period"] < 5e-4 and least["rocking: next tilt"] < 1e-2
    assert least["pendulum: next amplitude"] < 1e-7
    assert not (tmp_path / "work_precision.csv").exists()


def test_small_run_writes_tables_and_figures(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    words = ["work-precision", "--angles", "90", "--voussoirs", "6", "--repeats", "1", "--scenes", "arch"]
    assert main([*words, "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert printed == (tmp_path / "work_precision.md").read_text()
    assert "| 90 | 6 |" in printed and f"| arch | {RIGID} |" in printed
    rows = rows_of(tmp_path / "work_precision.csv")
    fine = [row for row in rows if row["method"] == RIGID and "tolerance = 1e-08" in row["setting"]]
    assert float(fine[0]["error"]) < 1e-8
    original = [float(row["error"]) for row in rows if row["method"] == "Shi's scheme"]
    assert original and all(0.01 < error < 0.5 for error in original)
    assert {row["on_front"] for row in rows} == {"0", "1"}
    for ending in ("svg", "png"):
        assert (tmp_path / f"work_precision_arch.{ending}").stat().st_size > 5000


def test_race_alone_writes_no_diagram(tmp_path, capsys):
    words = ["work-precision", "--race", "--repeats", "1", "--angles", "60", "--voussoirs"]
    assert main([*words, "4", "8", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "| 60 | 4 |" in printed and "| 60 | 8 |" in printed
    assert not (tmp_path / "work_precision.csv").exists()


def test_what_the_plan_saves_is_reported_and_the_answer_stays(tmp_path, capsys):
    words = ["work-precision", "--plan", "--voussoirs", "12", "--repeats", "2", "--out"]
    assert main([*words, str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert printed == (tmp_path / "plan_costs.md").read_text()
    rows = [line.strip("| ").split(" | ") for line in printed.splitlines()[2:]]
    answers = {row[1]: row[-1] for row in rows}
    assert answers["joints searched among polygons"] == "stable"
    for part in ("strain: 6 unknowns a block", "condition"):
        assert float(answers[part]) < 1e-10
    # joints that break have no limit analysis, whose mechanisms are traced: the bracket is halved to its tolerance
    assert float(answers["strength that can break"]) < 1e-8
    # moving blocks differ by what elasticity makes of them
    assert 1e-5 < float(answers["blocks that move, contacts that follow"]) < 1e-2
    assert all(float(row[2]) > 0.0 for row in rows)
