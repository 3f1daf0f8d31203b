"""Convergence studies: orders of sequences made by formula, and of scenes whose orders theory gives."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from dda_command import rows_of

pytest.importorskip("matplotlib", reason="figures want matplotlib")

from voussoir import theory  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.deck.study import SAME, Series, Study, StudyError, study  # noqa: E402
from voussoir.plot.study_chart import draw_study  # noqa: E402

BENCHMARKS = Path(__file__).resolve().parents[2] / "input" / "benchmarks"


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 3.0])
def test_orders_of_power_laws_are_their_exponents(order: float) -> None:
    values = 3.0 + 0.7 * 0.5 ** (order * np.arange(6))
    free, against = Series("x", "", values), Series("x", "", values, exact=3.0)
    for series in (free, against):
        found, words = series.verdict()
        assert found == pytest.approx(order, abs=1e-6) and words == f"observed order {order:.2f}"
    limit, rest = free.limit()
    assert limit == pytest.approx(3.0, abs=1e-6) and rest == pytest.approx(values[-1] - 3.0, rel=1e-6)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ([1.0, 1.0 + 1e-13, 1.0, 1.0], SAME),
        ([1.0, 2.0], "no order: three runs or more are needed"),
        ([1.0, 1.5, 1.2, 1.35, 1.275], "no order: the values go up and down"),
        ([1.0, 1.1, 1.3, 1.7], "no order: the differences do not shrink steadily"),
        ([1.0, 1.4, 1.5, 1.501], "no order: the last two estimates, 2.00 and 6.64, disagree"),
        ([1.0, math.nan, 1.5, 1.501], "no order: a run has no value"),
        ([1.0, 1.5, 1.75, 1.75], "no order: the last runs agree to rounding"),
    ],
)
def test_it_is_said_when_there_is_no_order(values: list[float], words: str) -> None:
    found, said = Series("x", "", np.array(values)).verdict()
    assert math.isnan(found) and said == words


def test_differences_small_beside_the_way_of_a_point_are_rounding() -> None:
    values = np.array([0.0, 1e-11, 3e-11, 7e-11])
    assert Series("v", "m", values, scale=9.8).verdict()[1] == SAME
    assert Series("v", "m", values).verdict()[1] != SAME


def test_a_slide_is_exact_at_any_step() -> None:
    """g (sin a - cos a tan phi) t^2/2: parabolas of time, which the step follows exactly."""
    found = study(BENCHMARKS / "incline.nml", "time_step", 3)
    assert found.values == [0.005, 0.0025, 0.00125, 0.000625]
    assert list(found.steps) == [1600, 3200, 6400, 12800]
    assert {series.verdict()[1] for series in found.series} == {SAME}
    ways = [series.values[-1] for series in found.series if series.name.startswith("u")]
    for way, (slope, friction) in zip(ways, ((30, 0), (30, 20), (20, 10), (28, 22))):
        a, phi = math.radians(slope), math.radians(friction)
        assert way == pytest.approx(2.0 * 9.81 * (math.sin(a) - math.cos(a) * math.tan(phi)), rel=1e-6)


def test_a_bounce_is_exact_at_any_step() -> None:
    found = study(BENCHMARKS / "bounce.nml", "time_step", 2, columns=["v"])
    assert len(found.series) == 4
    assert {series.verdict()[1] for series in found.series} == {SAME}


def test_rocking_is_of_second_order() -> None:
    found = study(
        BENCHMARKS / "rocking_tall.nml", "analysis%time_step", 4,
        **{"analysis%duration": 0.25, "max_displacement_ratio": 1.0, "time_step": 0.008})
    for series in found.series:
        assert series.verdict()[0] == pytest.approx(2.0, abs=0.12), series.name
    assert not found.notes()


def test_limits_of_the_step_are_noted() -> None:
    """With small displacements a step allowed, halving the longest step halves none."""
    found = study(
        BENCHMARKS / "incline.nml", "time_step", 2,
        **{"analysis%duration": 0.5, "max_displacement_ratio": 0.002})
    assert "max_displacement_ratio limits the steps" in "".join(found.notes())


ELASTIC = "&arch voussoirs = 8 /\n&analysis geometry = 'current' /\n&search /\n"


def test_elastic_shift_vanishes_with_the_first_power_of_compliance(tmp_path: Path) -> None:
    """Blocks that are twice as stiff are half as far from the rigid polygon, whose thickness theory gives."""
    (tmp_path / "arch.nml").write_text(ELASTIC)
    (series,) = study(tmp_path / "arch.nml", "young", 3, double=True).series
    assert series.verdict()[0] == pytest.approx(1.0, abs=0.01)
    assert series.limit()[0] == pytest.approx(theory.discrete_critical(8, math.pi / 2), abs=1e-7)


def test_curves_of_a_study_have_the_unit_of_their_result() -> None:
    values = np.array([1.0, 0.5, 0.25, 0.125])
    series = [Series("u of point 1", "m", values**2), Series("ratio", "", values)]
    axes = draw_study(Study("analysis%time_step", list(values), np.array([1, 2, 4, 8]), series)).axes[0]
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert names == ["u of point 1 [m]: order 2.00", "ratio: order 1.00"]


def test_command_prints_writes_and_draws(tmp_path: Path, capsys, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arch.nml").write_text(ELASTIC)
    exact = theory.discrete_critical(8, math.pi / 2)
    words = [
        "study", "arch.nml", "--double", "young", "2", "--y", "critical", "--exact", repr(float(exact)), "--set",
        "poisson=0.1", "--jobs", "1", "--width", "80mm", "--font", "8", "--min-font", "6", "--no-legend", "--no-title",
        "--format", "png", "--out", "out"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "observed order 1.00" in printed and "error" in printed
    rows = rows_of(tmp_path / "out" / "study.csv")
    assert [float(row["value_of_key"]) for row in rows] == [5e9, 1e10, 2e10]
    assert [float(row["error"]) for row in rows] == [abs(float(row["value"]) - exact) for row in rows]
    assert (tmp_path / "out" / "study.png").exists()
    words = ["study", str(BENCHMARKS / "incline.nml"), "--halve", "time_step", "2", "--at", "1"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "u of point 1, case 1: 2.4525 m" in printed and SAME in printed
    assert (tmp_path / "incline_study" / "study.svg").exists()


@pytest.mark.parametrize(
    ("text", "key", "times", "message"),
    [
        ("&search /\n", "time_step", 2, "time_step has no default; put analysis%time_step into the deck"),
        ("&search /\n", "shape", 2, "expected a key with one number, got arch%shape"),
        ("&search /\n", "voussoirs", 3, "expected a number that can be halved 3 times, got voussoirs = 36"),
        ("&sweep parameter = 'radius', values = 1, 2 /\n", "radius", 1, "got a &sweep of it"),
        ("&search /\n", "yuong", 1, "did you mean 'young'?"),
    ],
)
def test_keys_that_cannot_be_halved_are_reported(tmp_path: Path, text, key, times, message) -> None:
    (tmp_path / "deck.nml").write_text(text)
    with pytest.raises(ValueError, match="(?s).*") as problem:
        study(tmp_path / "deck.nml", key, times)
    assert message in str(problem.value)


def test_voussoirs_are_finer_the_more_they_are_and_penalty_is_a_name(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text("&arch voussoirs = 16 /\n&search /\n")
    found = study(tmp_path / "deck.nml", "voussoirs", 1)
    assert found.values == [8.0, 16.0] and found.key == "arch%voussoirs"
    assert study(tmp_path / "deck.nml", "penalty", 1).values == [50.0, 100.0]


def test_a_result_to_follow_is_needed(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text("&search /\n")
    with pytest.raises(StudyError, match="expected a column of numbers of results.csv, u or v, got 'verdict'"):
        study(tmp_path / "deck.nml", "young", 1, columns=["verdict"])
