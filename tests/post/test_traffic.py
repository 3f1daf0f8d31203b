"""Vehicles of a list on an arch: widths by hand, convoys and directions by trying every position."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from dda_command import rows_of

pytest.importorskip("matplotlib", reason="figures want matplotlib")

import voussoir  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.deck.traffic import Vehicle, pass_over, read_vehicles, sample_list, worst_convoy  # noqa: E402

ARCH = (
    "&arch shape = 'segmental', span = 5, rise = 1.4, thickness = 0.4, voussoirs = 14 /\n"
    "&joint friction_deg = 35 /\n&material unit_weight = 20e3 /\n"
)
FILL = "&fill height = 0.4, unit_weight = 18e3 /\n"
LORRY = Vehicle("lorry", (40e3, 90e3), (2.1,), 1.8, 0.3, 0.3)


def deck_of(folder: Path, text: str, name: str = "bridge.nml") -> Path:
    """A deck."""
    file = folder / name
    file.write_text(text)
    return file


def test_the_strip_of_the_standard_is_its_formula(tmp_path: Path) -> None:
    decks = [deck_of(tmp_path, ARCH), deck_of(tmp_path, ARCH + FILL, "filled.nml")]
    assert [pass_over(deck, LORRY, "cs454").width for deck in decks] == pytest.approx([1.5, 1.9])


@pytest.mark.parametrize(("barrel", "width"), [(1.0, 1.0), (1.4, 1.4), (2.0, 1.4)])
def test_the_barrel_limits_the_width_of_the_rule(tmp_path: Path, barrel: float, width: float) -> None:
    """Two strips of 0.3 + 2 0.5 0.4 m carry the wheels; both rules are limited."""
    deck = deck_of(tmp_path, ARCH + FILL)
    assert pass_over(deck, LORRY, barrel=barrel, both=False).width == pytest.approx(width, rel=1e-12)
    assert pass_over(deck, LORRY, "cs454", barrel=barrel, both=False).width == pytest.approx(min(1.9, barrel))


def test_a_convoy_is_named_and_weighs_what_its_vehicles_do(tmp_path: Path) -> None:
    three = pass_over(deck_of(tmp_path, ARCH), LORRY, both=False, count=3, gap=5.0)
    assert three.name == "3 x lorry, 5 m apart" and three.weight == 390e3


def test_load_factors_are_proportional_to_the_width(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, ARCH)
    one, two = (pass_over(deck, LORRY, width=width) for width in (1.0, 2.5))
    assert two.factor == pytest.approx(2.5 * one.factor, rel=1e-7)
    assert pass_over(deck, LORRY).width == pytest.approx(0.6)
    assert pass_over(deck_of(tmp_path, ARCH + FILL), LORRY).width == pytest.approx(1.4)


def brute_force(axles: tuple[float, ...], spacings: tuple[float, ...], width: float, near: float) -> float:
    """The least load factor over positions of a vehicle that drives one way: a grid, and a finer one about a place."""
    places = np.concatenate((np.linspace(-2.4 - sum(spacings), 2.4, 150), near + np.linspace(-0.02, 0.02, 41)))
    weights = ", ".join(repr(axle / width) for axle in axles)
    gaps = f", spacings = {', '.join(map(repr, spacings))}" if spacings else ""
    run = voussoir.run(
        ARCH + FILL + f"&vehicle axles = {weights}{gaps} /\n&search parameter = 'load_factor' /\n"
        f"&sweep parameter = 'position', values = {', '.join(map(repr, places.tolist()))} /\n"
        "&output joints = .false., blocks = .false. /\n")
    assert set(run.cases["verdict"]) <= {"found", "stable"}
    return float(np.nanmin(np.where(run.cases["verdict"] == "found", run.cases["critical"], np.nan)))


@pytest.mark.parametrize("count", [1, 2])
def test_no_position_in_either_direction_is_worse_than_the_worst(tmp_path: Path, count: int) -> None:
    """Equal to the least of all positions both ways to 1e-6."""
    deck = deck_of(tmp_path, ARCH + FILL + "&vehicle axles = 1, position = 0 /\n&search parameter = 'load_factor' /\n")
    worst, _ = worst_convoy(deck, LORRY, count, (1.5,))
    axles, spacings, place = LORRY.axles * count, (2.1, 1.5, 2.1)[:2 * count - 1], worst.found.place
    mirrored = -place - sum(spacings)
    ways = [
        brute_force(*way, worst.width, near) for way in ((axles, spacings), (axles[::-1], spacings[::-1]))
        for near in (place, mirrored)]
    assert worst.factor == pytest.approx(min(ways), rel=1e-6)
    turned = Vehicle("turned", LORRY.axles[::-1], LORRY.spacings[::-1], 1.8, 0.3, 0.3)
    one_way = [pass_over(deck, each, both=False, count=count, gap=1.5).factor for each in (LORRY, turned)]
    assert (worst.factor, worst.opposite) == pytest.approx(tuple(sorted(one_way)), rel=1e-8)
    # the bridge is symmetric
    assert worst.opposite_place == pytest.approx(mirrored, abs=1e-5)


def test_a_second_vehicle_near_by_changes_the_factor_and_the_worst_gap_counts(tmp_path: Path) -> None:
    deck = deck_of(tmp_path, ARCH)
    worst, tried = worst_convoy(deck, Vehicle("axle", (90e3,), (), 1.8, 0.3, 0.3), 2, (0.4, 30.0))
    assert len(tried) == 2 and worst.factor == min(one.factor for one in tried)
    alone = pass_over(deck, Vehicle("axle", (90e3,), (), 1.8, 0.3, 0.3))
    assert tried[0].factor < 0.9 * alone.factor
    # 30 m apart only one of them is on the arch
    assert tried[1].factor == pytest.approx(alone.factor, rel=1e-7)


def test_every_vehicle_of_the_sample_list_has_its_source() -> None:
    vehicles = read_vehicles(sample_list())
    assert len(vehicles) >= 8 and all(vehicle.source for vehicle in vehicles.values())
    model = vehicles["EN_LM1_lane1"]
    assert model.axles == (300e3, 300e3) and model.spacings == (1.2,) and (model.track, model.wheel) == (2.0, 0.4)
    assert sum(vehicles["EN_FLM3"].axles) == 480e3 and sum(vehicles["AASHTO_truck"].axles) == 325e3


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("name,axles\na,1\n", 1, "expected the columns name, axles_kN, spacings_m, got none named axles_kN"),
        ("name,axles_kN,spacings_m\na,1 2,\n", 2, "expected one spacing fewer than axles, got 2 axles and 0 spacings"),
        ("name,axles_kN,spacings_m\na,1,\na,2,\n", 3, "expected a name of its own, got 'a'"),
        ("name,axles_kN,spacings_m\na,heavy,\n", 2, "expected numbers above 0 as axles_kN, got 'heavy'"),
        ("name,axles_kN,spacings_m,track_m\na,1,,1 2\n", 2, "expected one number as track_m, got 2"),
        ("name,axles_kN,spacings_m\n", 1, "expected a list of vehicles, got one without rows"),
    ],
)
def test_what_is_no_list_is_refused_with_its_line(tmp_path: Path, text: str, line: int, words: str, capsys) -> None:
    file = tmp_path / "list.csv"
    file.write_text(text)
    deck = deck_of(tmp_path, ARCH)
    assert main(["traffic", str(deck), "--list", str(file), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.startswith(f"{file}:{line}: error: {words}")


def test_command_prints_the_rule_and_writes_decks_that_give_the_same(tmp_path: Path, capsys) -> None:
    deck, out = deck_of(tmp_path, ARCH + FILL), tmp_path / "out"
    words = ["traffic", str(deck), "--vehicle", "single_axle_11.5t", "--rule", "cs454", "--barrel-width", "1.7",
             "--convoy", "2", "--gap", "1.3", "4", "--one-direction", "--out", str(out), "--format", "png", "--width",
             "80mm", "--font", "8", "--min-font", "6", "--no-title", "--no-legend"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "effective width: w = 1.5 m + h" in printed and "load [kN/m]" in printed
    rows = rows_of(out / "traffic.csv")
    assert [row["effective_width_m"] for row in rows] == ["1.7", "1.7"]
    assert float(rows[0]["load_kN_per_m"]) == pytest.approx(2 * 112.8 / 1.7, rel=1e-12)
    factor = min(float(row["load_factor"]) for row in rows)
    again = voussoir.run(out / "single_axle_11.5t.nml", search="load_factor").cases["critical"][0]
    assert again == pytest.approx(factor, rel=1e-9)
    assert (out / "single_axle_11.5t.png").exists()


def test_given_widths_and_lists_are_used(tmp_path: Path, capsys) -> None:
    deck = deck_of(tmp_path, ARCH)
    (tmp_path / "own.csv").write_text("name,axles_kN,spacings_m\ncart,12 8,1.5\n")
    words = ["traffic", str(deck), "--list", str(tmp_path / "own.csv"), "--effective-width", "2", "--out",
             str(tmp_path / "out")]
    assert main(words) == 0
    assert "effective width: 2 m, given" in capsys.readouterr().out
    written = (tmp_path / "out" / "cart.nml").read_text()
    assert "axles = 12000.0, 8000.0" in written and "effective_width = 2.0" in written
    assert main([*words, "--vehicle", "waggon"]) == 2
    assert "expected a vehicle of" in capsys.readouterr().err


@pytest.mark.parametrize(("name", "count"), [("DIN_SLW60", 1), ("EN_LM2", 1), ("AASHTO_truck", 2)])
def test_keys_of_a_deck_are_what_the_command_computes(tmp_path: Path, name: str, count: int, capsys) -> None:
    """&vehicle list, name and convoy, in another language; with a proof that verify accepts, and on a page."""
    passage = worst_convoy(deck_of(tmp_path, ARCH + FILL), read_vehicles(sample_list())[name], count, (3.0,))[0]
    (tmp_path / "list.csv").write_text(sample_list().read_text())
    keys = f"list = 'list.csv', name = '{name}', convoy = {count}, convoy_gap = 3, worst = T"
    deck = deck_of(tmp_path, ARCH + FILL + f"&vehicle {keys} /\n&search parameter = 'load_factor' /\n")
    run = voussoir.run(deck, out=tmp_path / "out")
    assert run.cases["critical"][0] == pytest.approx(passage.factor, rel=1e-7)
    assert float(run.setting("vehicle%effective_width")) == pytest.approx(passage.width, rel=1e-12)
    assert main(["verify", str(tmp_path / "out")]) == 0
    assert main(["assess", str(deck)]) == 0
    page = deck.with_suffix(".html").read_text()
    assert f"{name} weighs" in page and f"an effective width of {passage.width:.3g} m carries it" in page
    assert f"{passage.factor:.3g}" in page
