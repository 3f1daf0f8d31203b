"""The gallery: every deck answers what its sentence says, by laws that are not the program's; the page is theirs."""

from __future__ import annotations

import math
from pathlib import Path

import gallery
import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="figures want matplotlib")

import voussoir  # noqa: E402
from voussoir import theory  # noqa: E402
from voussoir_benches.limit_lp_blocks import assembly_of, limit_factor  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
DECKS = ROOT / "input" / "gallery"


def run(name: str, **keys: object) -> voussoir.results.Results:
    """Results of a deck of the gallery."""
    return voussoir.run(DECKS / f"{name}.nml", **keys)


def test_page_is_what_the_target_writes() -> None:
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    assert page == gallery.page(), "expected what `python3 docs/site/gallery.py` writes, got another page"
    assert len(gallery.decks()) == 12
    for deck in gallery.decks():
        assert (gallery.PICTURES / f"{deck.stem[3:]}.svg").stat().st_size > 10_000
        assert gallery.sentence_of(deck).endswith(".") or "?" in gallery.sentence_of(deck)


def test_semicircle_needs_what_limit_analysis_says() -> None:
    exact = theory.discrete_critical(36, math.pi / 2)
    assert run("01_semicircle").cases["critical"][0] == pytest.approx(exact, abs=1e-10)


def test_pointed_arch_stands_between_two_thrusts_and_falls_when_thinner() -> None:
    (row,) = run("02_pointed").cases.rows()
    assert row["verdict"] == "stable" and 0.0 < row["thrust_min"] < row["thrust_max"]
    assert run("02_pointed", thickness=0.05).cases["verdict"][0] == "collapsed"


def test_axles_twice_as_heavy_are_carried_half_as_often() -> None:
    once, twice = (run("03_bridge", axles=axles).cases["critical"][0] for axles in ((40e3, 60e3), (80e3, 120e3)))
    assert twice == pytest.approx(once / 2.0, rel=1e-7)


def test_viaduct_and_rings_carry_what_a_linear_program_says() -> None:
    pytest.importorskip("scipy", reason="linear programs want scipy")
    pushed = run("04_viaduct", flow="associated")
    exact = limit_factor(assembly_of(pushed), math.tan(math.radians(50.0)), "highs-ds", 1e-9)
    assert pushed.cases["critical"][0] == pytest.approx(exact, rel=1e-6)
    # under Coulomb's rule at most that
    assert run("04_viaduct").cases["critical"][0] <= exact * (1.0 + 1e-7)


def test_one_ring_carries_more_than_three() -> None:
    three, one = (run("05_rings", rings=rings).cases["critical"][0] for rings in (3, 1))
    assert 0.0 < three < one


def test_dome_needs_about_what_heyman_found() -> None:
    # Heyman 1967: a hemispherical dome of lunes needs t/R = 0.042
    assert run("06_dome").cases["critical"][0] == pytest.approx(0.042, rel=0.03)


def test_wall_turns_off_along_a_stair_of_joints() -> None:
    """The bricks right of a stair turn about the corner (5, 0.5): area, arm and height above it, course by course."""
    piece = [(0.25 * n, 0.25 * n, 0.25 + 0.5 * (n - 1)) for n in range(1, 6)]
    weight, push = (sum(brick[0] * brick[k] for brick in piece) for k in (1, 2))
    assert weight / push == pytest.approx(11.0 / 19.0)
    assert run("07_wall").cases["critical"][0] == pytest.approx(weight / push, rel=1e-8)


def test_supports_that_spread_further_bring_the_arch_down() -> None:
    # linear programmes of rigid voussoirs in the displaced shape: 0.05886 of the span of 20 m, 1.1772 m
    verdicts = [run("08_spread", displacement_factor=factor).cases["verdict"][0] for factor in (1.0, 1.06, 1.09)]
    assert verdicts == ["stable", "stable", "collapsed"]


def test_dominoes_fall_one_after_the_other() -> None:
    frames = run("09_dominoes").frames_of(1)
    heads = np.array([[block[:, 1].max() for block in frame.blocks[1:]] for frame in frames])
    fallen = [int(np.argmax(column < 0.28)) or len(frames) for column in heads.T]
    assert fallen == sorted(fallen) and fallen[0] < fallen[4] < len(frames)


def test_portal_rocks_from_a_fifth_of_gravity_on() -> None:
    # work of a mechanism of two legs and a lintel: 0.2; below that nothing moves
    drift = [np.abs(run("10_portal", amplitude=amplitude).points_of(1)[0]["u"]).max() for amplitude in (1.9, 6.0)]
    assert drift[0] < 1e-4 and drift[1] > 0.02


def test_tunnel_falls_without_its_bolts(tmp_path: Path) -> None:
    assert run("11_tunnel").cases["verdict"][0] == "stable"
    lines = (DECKS / "tunnel.geo").read_text().splitlines()
    bare = [line for line in lines if len(line.split()) != 7]
    assert bare[3] == "9"
    bare[3] = "0"
    (tmp_path / "tunnel.geo").write_text("\n".join(bare) + "\n")
    (tmp_path / "bare.nml").write_text((DECKS / "11_tunnel.nml").read_text())
    assert voussoir.run(tmp_path / "bare.nml").cases["verdict"][0] == "collapsed"


def test_wedge_with_water_in_its_crack_needs_the_friction_of_its_closed_form() -> None:
    """Weight, water in the crack, and along the plane what falls from its head in the crack to nothing at the toe."""
    water, length, depth = 9810.0, math.hypot(65.7, 46.0), 7.238
    weight = 2650.0 * 9.81 * 0.5 * abs(65.7 * 60.0 - 65.7 * 46.0 + 65.7 * 60.0 - 50.35 * 60.0)
    sine, cosine = 46.0 / length, 65.7 / length
    push, uplift = 0.5 * water * depth**2, 0.5 * water * depth * length
    friction = (weight * sine + push * cosine) / (weight * cosine - uplift - push * sine)
    row = run("12_slope").case(1)
    assert row["critical"] == pytest.approx(math.degrees(math.atan(friction)), rel=1e-9)
    assert (round(row["critical"], 3), row["collapse_mode"]) == (40.0, "sliding")
