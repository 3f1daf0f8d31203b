"""Ties of arches made from shapes: the forces with which an arch on buttresses stands, against linear programmes."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import run_dda, run_deck
from test_live_loads import rows

#: Thickness, voussoirs, height and width of the buttresses over the radius; least and greatest force of a tie 0.1 below
#: the springings over the weight of the arch, by the static theorem
TIED = [
    (0.15, 20, 1.0, 0.25, 0.03178338931350643, 0.4103399619645495),
    (0.15, 20, 1.0, 0.30, 0.0, 0.4428941218888534),
    (0.15, 20, 2.0, 0.30, 0.028449679742944968, 0.3801102207368091),
    (0.15, 20, 3.0, 0.20, 0.11848751969324166, 0.305518206400832),
    (0.20, 16, 1.0, 0.25, 0.018429490923649643, 0.451140414778422),
    (0.20, 16, 3.0, 0.25, 0.07737128986975664, 0.3510617654833585),
]
DECK = (
    "&arch shape = 'circular', radius = 1, thickness = {t}, voussoirs = {n}, buttress_width = {w}, "
    "buttress_height = {h} /\n&joint friction_deg = 90 /\n&material unit_weight = 1 /\n"
)
TIE = "&tie x1 = {a!r}, y1 = -0.1, x2 = {b!r}, y2 = -0.1, ea = 1e3{more} /\n"


def deck_of(t: float, n: int, h: float, w: float, more: str = "") -> str:
    """The deck of a tied arch."""
    return DECK.format(t=t, n=n, h=h, w=w) + TIE.format(a=t / 2 - 1, b=1 - t / 2, more=more)


def weight_of(t: float, n: int) -> float:
    """Weight of the voussoirs, whose faces are chords."""
    return t * n * math.sin(math.pi / n)


@pytest.mark.parametrize(("t", "n", "h", "w", "least", "greatest"), TIED)
def test_an_arch_stands_from_the_least_force_of_its_tie_to_the_greatest(
    tmp_path: Path, t: float, n: int, h: float, w: float, least: float, greatest: float
) -> None:
    (row,) = rows(tmp_path, deck_of(t, n, h, w) + "&output thrust_bar = 1 /\n", head="")
    assert row["verdict"] == "stable"
    assert float(row["thrust_min"]) / weight_of(t, n) == pytest.approx(least, abs=1e-9)
    assert float(row["thrust_max"]) / weight_of(t, n) == pytest.approx(greatest, rel=1e-9)


@pytest.mark.parametrize(("t", "n", "h", "w", "least"), [case[:5] for case in TIED if case[4] > 0.0])
def test_it_falls_with_a_weaker_tie(tmp_path: Path, t: float, n: int, h: float, w: float, least: float) -> None:
    for share, verdict in ((1 - 1e-6, "collapsed"), (1 + 1e-6, "stable")):
        more = f", strength = {share * least * weight_of(t, n)!r}"
        (row,) = rows(tmp_path, deck_of(t, n, h, w, more), head="")
        assert row["verdict"] == verdict
    search = "&search parameter = 'tie%strength(1)', low = 0, high = 1 /\n"
    (row,) = rows(tmp_path, deck_of(t, n, h, w, ", strength = 1") + search, head="")
    assert float(row["critical"]) / weight_of(t, n) == pytest.approx(least, rel=1e-6)


def test_the_written_blocks_stand_by_the_same_bar(tmp_path: Path) -> None:
    (tmp_path / "x.nml").write_text(deck_of(0.15, 20, 2.0, 0.3, ", strength = 0.2"))
    assert run_dda("export", "x.nml", "--out", "files", cwd=tmp_path).returncode == 0
    deck = "&joint friction_deg = 90 /\n&material unit_weight = 1 /\n&output thrust_bar = 1 /\n"
    run_deck(tmp_path, "&scene kind = 'blocks', geometry = 'files/x.blocks' /\n" + deck, "--quiet", name="y")
    values = (tmp_path / "y" / "results.csv").read_text().splitlines()
    row = dict(zip(values[0].split(","), values[1].split(",")))
    weight = weight_of(0.15, 20)
    assert float(row["thrust_min"]) == pytest.approx(TIED[2][4] * weight, rel=1e-7)
    assert float(row["thrust_max"]) == pytest.approx(min(0.2, TIED[2][5] * weight), rel=1e-7)


@pytest.mark.parametrize(
    ("tie", "message"),
    [
        ("x1 = 0, y1 = 0, x2 = 1, y2 = 0", "tie%ea needs as many numbers as tie%x1, 1, got 0; give one per tie"),
        ("ea = 1", "&tie needs x1, y1, x2 and y2, the ends of each tie, got none; give them"),
        ("x1 = -0.925, y1 = -0.1, x2 = 0.5, y2 = -0.1, ea = 1",
         "&tie needs ends in blocks, got (0.5, -0.1) of tie 1, which lies in none; move it"),
        ("x1 = -0.925, y1 = -0.1, x2 = -0.95, y2 = -0.2, ea = 1",
         "&tie needs ends in two blocks, got both of tie 1 in block 21; move one"),
        ("x1 = 1, y1 = 0.1, x2 = 1, y2 = 0.1, ea = 1",
         "&tie needs ends that are apart, got tie 1 between equal points; move one"),
        ("x1 = -0.925, y1 = -0.1, x2 = 0.925, y2 = -0.1, ea = 1, strength = 1, prestress = 2",
         "tie%prestress must be at most tie%strength, got 2 for tie 1; lower it"),
        ("x1 = -0.925, y1 = -0.1, x2 = 0.925, y2 = -0.1, ea = 1, 2",
         "tie%ea needs as many numbers as tie%x1, 1, got 2; give one per tie"),
    ],
)
def test_ties_that_are_none_are_refused(tmp_path: Path, tie: str, message: str) -> None:
    (tmp_path / "x.nml").write_text(DECK.format(t=0.15, n=20, w=0.25, h=1.0) + f"&tie {tie} /\n")
    done = run_dda("check", "x.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr == f"x.nml:4: error: {message}\n"
