"""`voussoir assess`: one page that holds verdict, safety numbers, worst position, inputs and check sums."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
from voussoir.deck import assessment
from voussoir.deck.run import run as run_deck
from voussoir.plot.assess_drawing import axle_groups, draw_scheme
from voussoir.plot.assess_text import assumptions_of, cases_of, numbers_of
from voussoir.plot.case_scene import scene_of
from voussoir.plot.position_chart import draw_positions
from voussoir.command.main import main

BRIDGE = (
    "&scene title = 'A bridge & its <axle>' /\n"
    "&arch shape = 'segmental', span = 6.55, rise = 1.428, thickness = 0.44, voussoirs = 20 /\n"
    "&joint friction_deg = 31 /\n&material unit_weight = 20e3 /\n"
    "&fill height = 0.165, unit_weight = 20e3 /\n&vehicle axles = 40e3, worst = .true. /\n"
)
SAFETY = r'Geometric safety factor</th><td class="number">([\d.]+)<'  #: Where the page has the geometric safety factor


def test_equal_axles_that_are_close_share_a_label() -> None:
    axles = [(0.0, 60e3), (4.0, 45e3), (5.3, 45e3), (6.6, 45e3), (9.0, 45e3)]
    assert axle_groups(axles, 1.5) == [([0.0], 60e3), ([4.0, 5.3, 6.6], 45e3), ([9.0], 45e3)]
    assert [len(places) for places, _ in axle_groups(axles, 0.1)] == [1] * 5


def test_the_page_holds_what_a_client_asks(tmp_path: Path) -> None:
    deck = tmp_path / "bridge.nml"
    deck.write_text(BRIDGE)
    assert main(["assess", str(deck)]) == 0
    page = (tmp_path / "bridge.html").read_text()
    assert "The structure is stable under the given loads. It collapses when the live loads are multiplied by" in page
    for words in ("Geometric safety factor", "Load factor", "Thrust at the crown", "Worst position", "Load cases",
                  "Position of the vehicle", "Assumptions", "friction angle 31°", "unit weight 20 kN/m³"):
        assert words in page
    assert page.count("<svg") == 4
    assert "A bridge &amp; its &lt;axle&gt;" in page
    assert hashlib.sha256(deck.read_bytes()).hexdigest() in page
    assert float(re.search(SAFETY, page)[1]) > 1.0


@pytest.mark.parametrize(
    ("vehicle", "words"),
    [
        ("axles = 40e3", r"with the leftmost axle here, in either direction\."),
        ("axles = 40e3, 60e3, spacings = 1.8",
         r"leftmost axle here, driving (\w+); it is the same at (\S+) m, driving (\w+)\."),
        ("axles = 40e3, 60e3, spacings = 1.8, both_directions = .false.", r"leftmost axle here, driving forward\."),
    ],
)
def test_directions_of_equal_load_factor_are_both_on_the_page(tmp_path: Path, vehicle: str, words: str) -> None:
    deck = tmp_path / "bridge.nml"
    deck.write_text(BRIDGE.replace("axles = 40e3", vehicle))
    found = re.search(words, " ".join(assess_numbers(deck)))
    assert found
    if found.groups():
        own = assessment.assess(deck.read_text(), deck)
        assert {found[1], found[3]} == {"forward", "backward"}
        assert float(found[2]) == pytest.approx(-own.place - 1.8, abs=6e-3)


def assess_numbers(deck: Path) -> list[str]:
    """Meanings of the numbers of a deck."""
    return [meaning for _, _, meaning in numbers_of(assessment.assess(deck.read_text(), deck))]


def test_an_arch_that_falls_is_said_to(tmp_path: Path) -> None:
    deck = tmp_path / "thin.nml"
    deck.write_text("&arch thickness_ratio = 0.05 /\n")
    assert main(["assess", str(deck), "--out", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text()
    assert "The structure collapses under the given loads." in page
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
    assert "No multiple of the live loads makes it collapse." in page
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
    from voussoir.plot import assess_page

    seen = {}

    def keep(run: object, cases: object, worst: float | None = None, *others: object) -> object:
        seen.update(cases=cases, worst=worst)
        return drawn(run, cases, worst, *others)

    drawn = assess_page.draw_positions
    monkeypatch.setattr(assess_page, "draw_positions", keep)
    deck = tmp_path / "bridge.nml"
    deck.write_text(BRIDGE.replace("20e3 /\n&vehicle", "20e3, passive_coefficient = 1 /\n&vehicle"))
    assert main(["assess", str(deck)]) == 0
    factors = dict(zip(seen["cases"]["position"], seen["cases"]["critical"]))
    assert factors[seen["worst"]] == min(factors.values())


def test_groups_are_left_out_with_their_lines() -> None:
    text = "&arch /\n&search\n parameter = 'x' /\n&joint /\n"
    assert assessment.without(text, "search") == "&arch /\n\n\n&joint /\n"


def test_the_geometric_safety_factor_is_thickness_over_critical_thickness(tmp_path: Path) -> None:
    deck = tmp_path / "pointed.nml"
    deck.write_text("&arch shape = 'pointed', span = 6, rise = 4, thickness = 0.6, voussoirs = 12 /\n")
    assert main(["assess", str(deck)]) == 0
    page = (tmp_path / "pointed.html").read_text()
    found = run_deck(deck.read_text() + "&search parameter = 'thickness', low = 0.01, high = 0.6 /\n")
    critical = found.cases["critical"][0]
    safety = float(re.search(SAFETY, page)[1])
    assert f"collapses when it is {safety:.3g} times thinner" in page
    assert safety == pytest.approx(0.6 / critical, rel=5e-3)


def test_forces_of_a_lune_are_no_forces_per_metre(tmp_path: Path) -> None:
    deck = tmp_path / "dome.nml"
    deck.write_text("&arch half_angle_deg = 80, radius = 6, thickness_ratio = 0.08, voussoirs = 12, lune_deg = 6 /\n")
    assert main(["assess", str(deck)]) == 0
    assert re.search(r"[\d.]+ k?N to [\d.]+ k?N</td>", (tmp_path / "dome.html").read_text())


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
    assert f'<th>Load factor</th><td class="number">{told}</td>' in page
    assert "Clear span 6 m, rise 1.6 m, crown thickness 0.5 m." in page
    assert "by limit analysis, an upper bound where rings slide" in page


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        # (R - t/2) 2 sin a, (R - t/2) (1 - cos a), t
        ("radius = 5, thickness_ratio = 0.2, half_angle_deg = 60, voussoirs = 12",
         "Clear span 7.79 m, rise 2.25 m, crown thickness 1 m."),
        ("shape = 'pointed', span = 6, rise = 4, thickness = 0.6, voussoirs = 12",
         "Clear span 6 m, rise 4 m, crown thickness"),
        ("shape = 'flat', span = 3, half_angle_deg = 25, thickness = 0.5, voussoirs = 9",
         "Clear span 3 m, crown thickness 0.5 m."),
        ("shape = 'segmental', span = 4, rise = 1, thickness = 0.4, spans = 2, pier_width = 1, pier_height = 2",
         "Overall width 9.64 m, overall height"),
    ],
)
def test_dimensions_of_the_drawing_are_those_of_its_caption(tmp_path: Path, keys: str, words: str) -> None:
    deck = tmp_path / "arch.nml"
    deck.write_text(f"&arch {keys} /\n&joint friction_deg = 40 /\n")
    found = assessment.assess(deck.read_text(), deck)
    figure, caption = draw_scheme(found)
    assert caption.startswith(words)
    drawn = {text.get_text() for text in figure.axes[0].texts if text.get_text()}
    assert {part.split(" ", len(part.split()) - 2)[-1] for part in caption.rstrip(".").split(", ")} <= drawn


def test_load_cases_have_live_loads_of_given_and_critical_size(tmp_path: Path) -> None:
    deck = tmp_path / "bridge.nml"
    deck.write_text(BRIDGE.replace("worst = .true.", "position = -1.5"))
    found = assessment.assess(deck.read_text(), deck)
    heads, dead, given, critical = cases_of(found)
    assert heads[1] == "Live load [kN/m]" and dead[:3] == ("Dead load of masonry and fill", "0", "stable")
    factor = found.factor["critical"]
    assert given[1:4] == ("40", "stable", "1") and critical[1] == f"{40 * factor:.3g}"
    # the thrust grows with the load
    assert float(given[4].split()[0]) > float(dead[4].split()[0])


def test_page_says_what_is_assumed(tmp_path: Path) -> None:
    deck = tmp_path / "bridge.nml"
    deck.write_text(
        BRIDGE.replace("unit_weight = 20e3 /\n&fill", "unit_weight = 21.5e3, compressive_strength = 4e6 /\n&fill")
        .replace("&vehicle", "&analysis flow = 'associated' /\n&vehicle"))
    lines = " ".join(assumptions_of(assessment.assess(deck.read_text(), deck)))
    for words in ("Joints carry no tension; friction angle 31°.", "Flow rule: associated", "crush at 4 MPa",
                  "Unit weight of the masonry 21.5 kN/m³.", "Fill to 0.165 m above the extrados",
                  "to either side by 0.5 of the depth", "no horizontal resistance"):
        assert words in lines


def test_several_decks_are_compared_on_one_page(tmp_path: Path, capsys) -> None:
    for name, thickness in (("thin", 0.35), ("thick", 0.6)):
        (tmp_path / f"{name}.nml").write_text(
            BRIDGE.replace("A bridge & its <axle>", name).replace("thickness = 0.44", f"thickness = {thickness}"))
    decks = [str(tmp_path / f"{name}.nml") for name in ("thin", "thick")]
    assert main(["assess", *decks, "--out", str(tmp_path / "both.html")]) == 0
    page = (tmp_path / "both.html").read_text()
    assert page.count('class="verdict"') == 2 and page.count("<svg") == 4
    rows = re.findall(r"<tr><th>(thin|thick)</th>(.*?)</tr>", page)
    factors = [float(re.findall(r">([^<]*)</td>", row)[2]) for _, row in rows]
    assert [name for name, _ in rows] == ["thin", "thick"] and factors[0] < factors[1]
    (tmp_path / "wrong.nml").write_text("&sweep parameter = 'radius', values = 1, 2 /\n")
    assert main(["assess", decks[0], str(tmp_path / "wrong.nml"), "--out", str(tmp_path / "x.html")]) == 2
    assert capsys.readouterr().err.startswith(f"{tmp_path / 'wrong.nml'}:1: error: expected one case")


def test_positions_without_a_factor_have_a_mark_that_says_why(tmp_path: Path) -> None:
    run = run_deck(
        "&arch shape = 'segmental', span = 6, rise = 1.5, thickness = 0.4, voussoirs = 21 /\n"
        "&fill height = 0.3, unit_weight = 20e3, passive_coefficient = 1.0 /\n"
        "&vehicle axles = 40e3, 60e3, spacings = 1.8 /\n&search parameter = 'load_factor' /\n"
        "&sweep parameter = 'position', values = -3.4, -2, -1, -0.5, 2 /\n")
    axes, below = draw_positions(run, run.cases).axes
    ends = np.array([x for block in scene_of(run, 1).supports for x, _ in block.corners])
    assert below.get_xlim() == (ends.min(), ends.max())
    marked = {line.get_label(): list(line.get_xdata()) for line in axes.lines if not line.get_label().startswith("_")}
    still = [row["position"] for row in run.cases.rows() if row["verdict"] == "stable"]
    assert still and marked["no multiple collapses it"] == still


def test_the_chart_of_positions_has_axles_and_the_other_direction() -> None:
    deck = (
        "&arch shape = 'segmental', span = 6, rise = 1.5, thickness = 0.4, voussoirs = 21 /\n"
        "&fill height = 0.3, unit_weight = 20e3 /\n&vehicle axles = 40e3, 60e3, spacings = 1.8 /\n"
        "&search parameter = 'load_factor' /\n&sweep parameter = 'position', values = -3.4, 1.6 /\n")
    run = run_deck(deck)
    axes, below = draw_positions(run, run.cases, -3.4, axles=[(-3.4, 40e3), (-1.6, 60e3)], other=(2.9, 1.6)).axes
    assert "other direction: 2.9 at 1.6 m" in [text.get_text() for text in axes.texts]
    top = max(y for shape in scene_of(run, 1).shapes(0.0) for _, y in shape)
    assert [text.xy for text in below.texts] == [(-3.4, pytest.approx(top + 0.3)), (-1.6, pytest.approx(top + 0.3))]


#: An arch whose right support moves
SPREAD = (
    "&arch half_angle_deg = 60, radius = 10, thickness_ratio = 0.15, voussoirs = 15 /\n&support right_dx = 2.5 /\n"
    "&joint friction_deg = 40 /\n&analysis geometry = 'current' /\n"
)


def page_of(folder: Path, text: str) -> str:
    """Page of a deck."""
    (folder / "deck.nml").write_text(text)
    assert main(["assess", str(folder / "deck.nml")]) == 0
    return (folder / "deck.html").read_text()


def test_displacements_of_supports_are_a_load_case(tmp_path: Path) -> None:
    page = page_of(tmp_path, SPREAD)
    moved = "right support 2.5 m to the right"
    assert f"The structure collapses with the {moved}; it falls at 9" in page
    rows = dict(re.findall(r"<tr><th>(Dead load[^<]*)</th><td[^>]*>0</td><td[^>]*>(\w+)</td>", page))
    assert rows == {"Dead load of masonry": "stable", f"Dead load of masonry, {moved}": "collapsed"}
    assert f"Prescribed displacements: {moved}." in page
    assert "rigid" not in page and "Thrust at the crown</th>" not in page.split("Load cases")[0]


def test_a_search_for_displacements_has_them_at_collapse(tmp_path: Path) -> None:
    search = "&search parameter = 'displacement_factor', low = 0, high = 4, tolerance = 1e-2 /\n"
    text = SPREAD.replace("2.5", "0.63") + search
    page = page_of(tmp_path, text)
    critical = run_deck(text).case(1)["critical"]
    assert f"It collapses when the supports move: right support {0.63 * critical:.3g} m to the right (±" in page
    assert "Displacement at collapse</th>" in page and "last equilibrium before the collapse" in page
