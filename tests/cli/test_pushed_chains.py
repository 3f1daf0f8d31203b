"""Arches that tilt or are pushed are decided as chains as the joint graph of their blocks decides them."""

import random
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

#: One deck for many arches at once: all sweeps advance together
DECK = """&scene title = 'Random arches' /
&arch voussoirs = {voussoirs} /
&sweep parameter = 'thickness_ratio', values = {thickness} /
&sweep parameter = 'half_angle_deg', values = {angle}, linked = .true. /
&sweep parameter = 'friction_deg', values = {friction}, linked = .true. /
&sweep parameter = 'horizontal_coefficient', values = {push}, linked = .true. /
&sweep parameter = 'gravity_direction_deg', values = {gravity}, linked = .true. /
&output joints = .false., blocks = .false. {more} /
"""
AS_GRAPH = ", condition = .true."  #: What makes the program build the joint graph of an arch


def random_arches(voussoirs: int, seed: int, more: str) -> str:
    """A deck of 60 arches near and far from critical."""
    draw = random.Random(seed)
    angle = [draw.uniform(15.0, 150.0) for _ in range(60)]
    values = {
        "thickness": [min(1.9, draw.uniform(0.6, 3.0) * 0.107 * (a / 90.0) ** 4) for a in angle],
        "angle": angle,
        "friction": [draw.uniform(15.0, 70.0) for _ in angle],
        "push": [draw.choice([0.0, draw.uniform(-0.4, 0.4)]) for _ in angle],
        "gravity": [-90.0 + draw.choice([0.0, draw.uniform(-12.0, 12.0)]) for _ in angle],
    }
    lists = {name: ", ".join(map(repr, numbers)) for name, numbers in values.items()}
    return DECK.format(voussoirs=voussoirs, more=more, **lists)


def cases_of(folder: Path, name: str, text: str) -> list[dict[str, str]]:
    """Rows of a deck, in the order of its cases."""
    (folder / f"{name}.nml").write_text(text)
    done = run_dda("run", f"{name}.nml", "--quiet", cwd=folder)
    assert done.returncode in (0, 3), done.stderr
    return sorted(rows_of(folder / name / "results.csv"), key=lambda row: int(row["case"]))


@pytest.mark.parametrize("voussoirs", [5, 18, 37])
def test_arches_stand_and_fall_as_their_joint_graphs_do(tmp_path: Path, voussoirs: int) -> None:
    chains = cases_of(tmp_path, "chain", random_arches(voussoirs, voussoirs, ""))
    graphs = cases_of(tmp_path, "graph", random_arches(voussoirs, voussoirs, AS_GRAPH))
    assert [row["verdict"] for row in chains] == [row["verdict"] for row in graphs]
    assert {row["verdict"] for row in chains} >= {"stable", "collapsed"}
    pushed = [row for row in chains if row["verdict"] == "stable" and float(row["horizontal_coefficient"]) != 0.0]
    # no factorisation: decided by three unknowns
    assert sum(row["factorisations"] == "0" for row in pushed) > len(pushed) / 2
    assert all(row["factorisations"] != "0" for row in graphs if row["verdict"] == "stable")


def test_critical_thickness_of_pushed_arches_is_that_of_their_joint_graphs(tmp_path: Path) -> None:
    deck = """&arch voussoirs = 36 /
&search parameter = 'thickness_ratio' /
&sweep parameter = 'half_angle_deg', values = 60, 80, 100 /
&sweep parameter = 'friction_deg', values = 25, 33, 55 /
&sweep parameter = 'horizontal_coefficient', values = -0.1, 0.15 /
&output joints = .false., blocks = .false. {more} /
"""
    chains = cases_of(tmp_path, "chain", deck.format(more=""))
    graphs = cases_of(tmp_path, "graph", deck.format(more=AS_GRAPH))
    assert [row["verdict"] for row in chains] == [row["verdict"] for row in graphs]
    for chain, graph in zip(chains, graphs):
        if chain["verdict"] == "found":
            assert float(chain["critical"]) == pytest.approx(float(graph["critical"]), rel=2e-9)


def test_a_search_of_an_arch_takes_the_two_decisions_that_prove_its_bracket(tmp_path: Path) -> None:
    deck = """&arch voussoirs = 36 /
&search parameter = 'thickness_ratio' /
&sweep parameter = 'half_angle_deg', first = 40, last = 120, count = 5 /
&sweep parameter = 'horizontal_coefficient', first = -0.2, last = 0.3, count = 6 /
&joint friction_deg = 75 /
"""
    rows = cases_of(tmp_path, "sweep", deck)
    assert {row["verdict"] for row in rows} == {"found"}
    assert {row["steps"] for row in rows} == {"2"}
    for row in rows:
        low, high = float(row["critical_low"]), float(row["critical_high"])
        assert 0 < high - low <= 1.0001e-8 * float(row["critical"])
        mirrored = [
            float(other["critical"])
            for other in rows
            if other["half_angle_deg"] == row["half_angle_deg"]
            and float(other["horizontal_coefficient"]) == -float(row["horizontal_coefficient"])
        ]
        assert all(value == pytest.approx(float(row["critical"]), rel=1e-12) for value in mirrored)


@pytest.mark.parametrize("tolerance", [1e-7, 1e-8, 1e-9, 1e-10])
def test_sliding_arches_are_as_exact_and_brackets_as_narrow_as_asked(tmp_path: Path, tolerance: float) -> None:
    deck = f"""&arch voussoirs = 36 /
&search parameter = 'thickness_ratio', tolerance = {tolerance} /
&sweep parameter = 'half_angle_deg', values = 90, 121.36363636363636, 122.27272727272727, 132.27272727272725 /
&sweep parameter = 'friction_deg', linked = .true., values = 50, 37.92929292929293, 39.949494949, 46.414141414 /
&output joints = .false., blocks = .false. /
"""
    for row in cases_of(tmp_path, "exact", deck):
        assert abs(float(row["relative_error"])) < 1e-10
        assert float(row["critical_high"]) - float(row["critical_low"]) <= 1.0001 * tolerance * float(row["critical"])
