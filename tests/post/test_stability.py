"""`voussoir stability`: the judgement itself, on answers made up, and a few scenes run."""

from dataclasses import replace

import numpy as np
import pytest
from dda_command import rows_of

from voussoir_benches import stability
from voussoir.command.main import main
from voussoir_benches.checks import Check
from voussoir_benches.deck_runs import Finished
from voussoir_benches.expectations import (
    Critical,
    Measured,
    Refused,
    Same,
    Verdict,
    Warned,
    judge,
)
from voussoir_benches.scene import Scene
from voussoir_benches.stability_random import tower_push
from voussoir_benches.stability_scenes import catalogue, random_scenes


def row(verdict="found", critical="0.1", low="0.0999", high="0.1001", case="1"):
    """A row of results.csv."""
    names = ("case", "verdict", "critical", "critical_low", "critical_high")
    return dict(zip(names, (case, verdict, critical, low, high)))


def colour(expectation, *rows, status=0, **others):
    """Colour of a run that left these rows."""
    return judge(expectation, Finished(status, list(rows), **others)).colour


@pytest.mark.parametrize(
    ("expectation", "answer", "wanted"),
    [
        (Critical(0.10005), row(), "right"),
        (Critical(0.1002), row(), "WRONG"),
        (Critical(0.1), row("collapsed"), "WRONG"),
        (Critical(None), row("collapsed"), "right"),
        (Critical(None), row(), "WRONG"),
        (Critical(0.0), row("stable"), "right"),
        (Critical(0.0), row("collapsed"), "WRONG"),
        (Critical(0.1002, 2e-4), row(), "right"),
        (Critical(0.1002, 2e-5), row(), "WRONG"),
        (Critical(None, 1.0), row("collapsed"), "right"),
        (Verdict("stable"), row("stable"), "right"),
        (Verdict("stable"), row("collapsed"), "WRONG"),
        (Verdict("stable"), row("completed"), "WRONG"),
        (Refused("young"), row("stable"), "WRONG"),
    ],
)
def test_answers_are_judged_by_the_exact_one(expectation, answer, wanted):
    assert colour(expectation, answer) == wanted


def test_cases_that_must_agree_are_compared():
    pair = row(), row(critical="0.1000001")
    assert colour(Same(1e-5), *pair) == "right"
    assert colour(Same(1e-7), *pair) == "WRONG"


def test_undecided_gives_its_reason():
    left = Finished(3, [row("undecided")], {"1": "step limit reached"})
    judgement = judge(Critical(0.1), left)
    assert (judgement.colour, judgement.reason) == ("undecided", "step limit reached")


@pytest.mark.parametrize(
    "left",
    [
        Finished(1, [row()]), Finished(-11, [row()]), Finished(0, [row()], not_a_number=("joints.csv",)),
        Finished(0, []), Finished(2, [], message="deck.nml:1: error: young must be a number")],
)
def test_crashes_and_nan_and_lost_rows_are_wrong_whatever_they_say(left):
    assert judge(Critical(0.1), left).colour == "WRONG"


def test_refusal_must_name_the_key():
    left = Finished(2, [], message="deck.nml:1: error: young must be a number")
    assert judge(Refused("young"), left).colour == "right"
    assert judge(Refused("poisson"), left).colour == "WRONG"


def test_a_warning_must_be_there_and_the_answer_right():
    doubt = "x.blocks:6: warning: block 2 is doubtful"
    wanted = Warned("block 2", Verdict("stable"))
    assert colour(wanted, row("stable"), message=doubt) == "right"
    assert colour(wanted, row("stable"), message="") == "WRONG"
    assert colour(wanted, row("collapsed"), message=doubt) == "WRONG"


@pytest.mark.parametrize(
    ("measured", "wanted"),
    [(1.0, "right"), (1.0 + 1e-7, "right"), (1.1, "WRONG"), (float("nan"), "WRONG")],
)
def test_what_is_measured_must_be_near_the_exact_value(measured, wanted):
    check = Check("x", 1.0, lambda outcome: measured, 1e-6)
    assert colour(Measured((check,)), row("stable")) == wanted


def test_nothing_to_measure_is_wrong():
    check = Check("x", 1.0, lambda outcome: outcome.end(1)[0], 1e-6)
    assert colour(Measured((check,)), row("stable")) == "WRONG"


def test_push_of_a_tower_is_that_of_its_weakest_joint():
    one = np.ones(3)
    assert tower_push(-one / 2.0, one, one, 10.0) == pytest.approx(1.0 / 3.0)
    assert tower_push(-one / 2.0, one, one, 0.2) == 0.2
    # the upper block hangs over by three quarters of its half width
    pair = np.ones(2)
    assert tower_push(np.array([0.0, 0.375]), pair, pair, 10.0) == pytest.approx(0.25)


def test_catalogue_is_large_and_without_repetition():
    names = [(scene.group, scene.name) for scene in catalogue()]
    assert len(names) > 700 and len(set(names)) == len(names)


def test_same_seed_makes_the_same_arches():
    one, other, third = ([scene.text() for scene in random_scenes(20, seed)] for seed in (7, 7, 8))
    assert one == other != third


def test_an_arch_is_judged_with_its_lean_plan_too(tmp_path, monkeypatch):
    """The worse of the two answers counts; the condition number is that of the full one."""
    scene = Scene("half angle", "90 deg", {"arch": {"voussoirs": 36}}, Critical(0.1), "")

    def run_deck(text, *_, **__):
        told = {**row(low="0.11" if b"blocks = .false." in text else "0.09"), "collapse_mode": ""}
        told |= {name: "1" for name in ("open_close_iterations", "factorisations", "seconds")}
        return Finished(0, [told | ({"condition": "1e9"} if b"condition" in text else {})])

    monkeypatch.setattr(stability, "run_deck", run_deck)
    (line,) = stability.run_scenes([scene], tmp_path, 1, 1.0)
    assert (line.result, line.condition) == ("WRONG", "1.0e+09")
    blocks = replace(scene, deck={"scene": {"kind": "blocks"}})
    assert scene.has_lean_plan and not blocks.has_lean_plan


def test_scenes_are_run_and_reported(tmp_path, capsys):
    only = "large angles: 140 deg, friction 6"
    assert main(["stability", "--out", str(tmp_path), "--only", only, "--random", "0"]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("0 WRONG, 0 undecided (0.0 %), 4 right")
    rows = rows_of(tmp_path / "stability.csv")
    assert {line["result"] for line in rows} == {"right"}
    # what the joint graph proves to fall has no equations of a step
    assert all(not line["condition"] or float(line["condition"]) > 1.0 for line in rows)
    assert any(line["condition"] and int(line["passes"]) > 0 for line in rows)
    assert "0 WRONG" in (tmp_path / "stability.md").read_text()
    page = (tmp_path / "stability.html").read_text()
    assert page.count('<td class="right">') == 4 and '<td class="number">4</td>' in page
    assert "<details><summary>friction, large angles: 4 scenes</summary>" in page
    assert "not right" not in page


@pytest.mark.parametrize("group", ["contrast", "bad input", "corners", "slender"])
def test_extreme_blocks_are_right(tmp_path, group, capsys):
    words = ["stability", "--out", str(tmp_path), "--only", group, "--random", "0"]
    assert main(words) == 0
    assert "0 WRONG, 0 undecided" in capsys.readouterr().out


def test_random_arches_and_blocks_are_right(tmp_path):
    words = ["stability", "--out", str(tmp_path), "--only", "random", "--random", "60"]
    words += ["--seed", "7"]
    assert main([*words, "--jobs", "2", "--timeout", "120"]) == 0


def test_scenes_are_listed(capsys):
    options = ["stability", "--only", "sliver: ", "--random", "0", "--list"]
    assert main(options) == 0
    assert len(capsys.readouterr().out.splitlines()) == 21


def test_scene_that_takes_too_long_is_undecided(tmp_path, capsys):
    words = ["--only", "voussoirs: 10000", "--random", "0"]
    done = main(["stability", "--out", str(tmp_path), "--timeout", "0.01", "--jobs", "1", "--seed", "1"] + words)
    assert done == 0
    assert "0 WRONG, 1 undecided" in capsys.readouterr().out
