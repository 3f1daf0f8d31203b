"""`voussoir assess`: one page that holds verdict, safety numbers, worst position, inputs and check sums."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
from voussoir.command import assess as assess_command
from voussoir.command.main import main

BRIDGE = (
    "&scene title = 'A bridge & its <axle>' /\n"
    "&arch shape = 'segmental', span = 6.55, rise = 1.428, thickness = 0.44, voussoirs = 20 /\n"
    "&joint friction_deg = 31 /\n&material unit_weight = 20e3 /\n"
    "&fill height = 0.165, unit_weight = 20e3 /\n&vehicle axles = 40e3, worst = .true. /\n"
)


def test_the_page_holds_what_a_client_asks(tmp_path: Path) -> None:
    deck = tmp_path / "bridge.nml"
    deck.write_text(BRIDGE)
    assert main(["assess", str(deck)]) == 0
    page = (tmp_path / "bridge.html").read_text()
    assert "The structure stands under the loads given. It falls when the live loads are multiplied by" in page
    for words in ("Geometrical safety", "Load factor", "Range of thrust", "Worst position", "Position of the vehicle"):
        assert words in page
    assert page.count("<svg") == 4
    assert "A bridge &amp; its &lt;axle&gt;" in page
    assert hashlib.sha256(deck.read_bytes()).hexdigest() in page
    assert float(re.search(r"Geometrical safety</th><td>([\d.]+):", page)[1]) > 1.0


def test_an_arch_that_falls_is_said_to(tmp_path: Path) -> None:
    deck = tmp_path / "thin.nml"
    deck.write_text("&arch thickness_ratio = 0.05 /\n")
    assert main(["assess", str(deck), "--out", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text()
    assert "The structure does not stand under the loads given." in page
    assert 'class="verdict falls"' in page


@pytest.mark.parametrize("where", ["position = -1.4", "worst = .true."])
def test_level_arches_that_any_axle_leaves_standing_have_a_page(tmp_path: Path, where: str) -> None:
    """No position has a factor then, and none is worst."""
    deck = tmp_path / "level.nml"
    deck.write_text(
        "&arch shape = 'flat', span = 10, voussoirs = 22, half_angle_deg = 30, thickness = 1.07, spans = 2, "
        "pier_width = 2.9, pier_height = 9, pier_courses = 4 /\n&joint friction_deg = 44 /\n"
        "&material unit_weight = 20e3 /\n&fill height = 0.1, unit_weight = 18e3 /\n"
        f"&vehicle axles = 2e4, {where} /\n&analysis flow = 'associated' /\n"
    )
    assert main(["assess", str(deck)]) == 0
    page = (tmp_path / "level.html").read_text()
    assert "No multiple of the live loads brings it down." in page
    assert "Position of the vehicle" not in page


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("&arch /\n&sweep parameter = 'radius', values = 1, 2 /\n", "many.nml:2: error: expected one case"),
        ("&scene kind = 'blocks', geometry = 'x' /\n", "many.nml:1: error: expected an arch"),
        ("&arch shape = 'segmental', span = 1, rise = 0.7, thickness = 0.1 /\n", "many.nml:1: error: arch%rise"),
    ],
)
def test_what_is_no_single_arch_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, words: str
) -> None:
    deck = tmp_path / "many.nml"
    deck.write_text(text)
    assert main(["assess", str(deck)]) == 2
    assert words in capsys.readouterr().err


def test_a_fault_is_reported_with_the_deck_of_the_user(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck = tmp_path / "mine.nml"
    deck.write_text("&arch /\n&tie y = 1 /\n")
    assert main(["assess", str(deck)]) == 2
    assert capsys.readouterr().err.startswith(f"{deck}:2: error: unknown key 'y'")


def test_the_chart_of_positions_has_the_worst_one(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The arch leans against the fill away from the axle: the factor jumps at the crown, to its least there."""
    from voussoir.plot import position_chart

    seen = {}

    def keep(run: object, cases: object, worst: float | None = None) -> object:
        seen.update(cases=cases, worst=worst)
        return drawn(run, cases, worst)

    drawn = position_chart.draw_positions
    monkeypatch.setattr(position_chart, "draw_positions", keep)
    deck = tmp_path / "bridge.nml"
    deck.write_text(BRIDGE.replace("20e3 /\n&vehicle", "20e3, passive_coefficient = 1 /\n&vehicle"))
    assert main(["assess", str(deck)]) == 0
    factors = dict(zip(seen["cases"]["position"], seen["cases"]["critical"]))
    assert factors[seen["worst"]] == min(factors.values())


def test_groups_are_left_out_with_their_lines() -> None:
    text = "&arch /\n&search\n parameter = 'x' /\n&joint /\n"
    assert assess_command.without(text, "search") == "&arch /\n\n\n&joint /\n"


def test_the_picture_of_an_arch_of_any_shape_says_its_geometrical_safety(tmp_path: Path) -> None:
    deck = tmp_path / "pointed.nml"
    deck.write_text("&arch shape = 'pointed', span = 6, rise = 4, thickness = 0.6, voussoirs = 12 /\n")
    assert main(["assess", str(deck)]) == 0
    page = (tmp_path / "pointed.html").read_text()
    safety = float(re.search(r"Geometrical safety</th><td>([\d.]+):", page)[1])
    assert f"thickness {safety:.3g} × critical" in page


def test_forces_of_a_lune_are_no_forces_per_metre(tmp_path: Path) -> None:
    deck = tmp_path / "dome.nml"
    deck.write_text("&arch half_angle_deg = 80, radius = 6, thickness_ratio = 0.08, voussoirs = 12, lune_deg = 6 /\n")
    assert main(["assess", str(deck)]) == 0
    assert re.search(r"[\d.]+ k?N to [\d.]+ k?N at the crown", (tmp_path / "dome.html").read_text())


def test_rings_are_drawn_with_one_factor_and_their_dimensions(tmp_path: Path) -> None:
    """Rings that slide fall before limit analysis says so: the title must not tell its factor."""
    deck = tmp_path / "rings.nml"
    deck.write_text(
        "&arch shape = 'segmental', span = 6, rise = 1.6, thickness = 0.5, voussoirs = 12, rings = 2 /\n"
        "&joint friction_deg = 30 /\n&vehicle axles = 20e3, position = -1.4 /\n"
    )
    assert main(["assess", str(deck)]) == 0
    page = (tmp_path / "rings.html").read_text()
    told = re.search(r"multiplied by ([\d.]+)\.</p>", page)[1]
    assert re.search(rf"load factor {re.escape(told)}", page)
    assert "Span 6 m, rise 1.6 m, thickness 0.5 m." in page
    assert "by limit analysis, an upper bound where rings slide" in page
