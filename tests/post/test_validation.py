"""`voussoir validation`: fast scenes within their tolerances, a true table, a complete page."""

from __future__ import annotations

import dataclasses
import math
import re
from pathlib import Path

import numpy as np
import pytest
from dda_command import rows_of

from voussoir.command.main import main
from voussoir.dda_program import find_input
from voussoir_benches import validation_page
from voussoir_benches.checks import Check
from voussoir_benches.exact import (
    ONSETS, chain_frequency, foot_acceleration, next_amplitude, quarter_period, roof_wedge, snap_load, stick_slip,
)
from voussoir_benches.expectations import Measured
from voussoir_benches.scene import Scene
from voussoir_benches.validation import titles_of
from voussoir_benches.validation_plot import diagonal, has_diagonal, has_history, history
from voussoir_benches.validation_run import Line, all_scenes, run_scene
from voussoir_benches.validation_sketch import Shape, sketch

REPOSITORY = Path(__file__).resolve().parents[2]
DECKS = REPOSITORY / "input" / "benchmarks"
SCENES = all_scenes()
FAST = [scene for scene in SCENES if not scene.slow]


def run_program(scene: Scene, halvings: int = 0) -> list[Line]:
    return run_scene(DECKS, scene, halvings)


@pytest.mark.parametrize("scene", FAST, ids=lambda scene: f"{scene.name}-{scene.group}")
def test_scene_has_its_exact_answer(scene: Scene) -> None:
    for line in run_program(scene):
        assert line.accepted, f"{line.check}: {line.computed}, error {line.errors[0]}"


def test_quarter_periods_are_those_of_the_literature() -> None:
    """Six digits by another integrator; the linear period for a small angle and tilt."""
    found = [quarter_period(0.2, 1.0, share) for share in (0.25, 0.5, 0.75)]
    assert found == pytest.approx([0.296721, 0.490864, 0.768628], abs=5e-7)
    p = math.sqrt(3.0 * 9.81 / (4.0 * math.hypot(1e-3, 1.0)))
    assert quarter_period(1e-3, 1.0, 0.5) == pytest.approx(math.acosh(2.0) / p, rel=1e-6)
    assert next_amplitude(0.25, 0.5, 0.5) == pytest.approx(0.206301, abs=5e-7)


@pytest.mark.parametrize("deck, b, h, slope, limit", ONSETS)
def test_foot_slides_below_the_angle_of_the_literature(
    deck: str, b: float, h: float, slope: float, limit: float
) -> None:
    foot = [
        foot_acceleration(b, h, math.radians(slope), math.tan(math.radians(limit + more)))
        for more in (-1e-3, 1e-3)
    ]
    assert foot[0] > 0.0
    assert foot[1] == 0.0


def test_unit_weight_of_the_passive_wedge_is_that_of_the_literature() -> None:
    """Areas 2 and 8 m2: W1 tan(45 - phi) = W2 tan(phi - 10)."""
    (check,) = next(scene for scene in SCENES if scene.name == "two_wedges").expectation.checks
    assert check.exact * 8.0 / 2000.0 == pytest.approx(0.736184, abs=5e-7)


def test_snap_load_of_a_shallow_truss_is_that_of_its_cubic() -> None:
    """EA z (z0^2 - z^2)/l^3 is most at z0/sqrt(3)."""
    half_span, rise = 100.0, 0.5
    cubic = 2.0 * rise**3 / (3.0 * math.sqrt(3.0)) / half_span**3
    assert snap_load(half_span, rise, 1.0) == pytest.approx(cubic, rel=1e-4)


def test_roof_wedge_holds_by_its_stiffness_and_not_below_its_own_angle() -> None:
    a, phi, spring, swell = 20.0, 40.0, 1e4, 1e-3
    pull = roof_wedge(a, phi, spring, swell)
    assert pull > 0.0
    assert roof_wedge(a, phi, 2.0 * spring, swell) == pytest.approx(2.0 * pull)
    assert roof_wedge(a, a, spring, swell) == pytest.approx(0.0, abs=1e-12)


def test_chain_of_one_is_a_block_and_of_many_a_bar() -> None:
    bar = math.sqrt(5e9 / 2500.0) / 8.0
    assert chain_frequency(1, 2.0) / bar == pytest.approx(1.10266, abs=5e-6)
    assert chain_frequency(1000, 2.0) / bar == pytest.approx(1.0, abs=1e-6)


def test_stick_and_slip_is_smooth_sliding_where_friction_is_small() -> None:
    """Without friction the way is the integral of the force twice."""
    assert stick_slip(0.0, 8.0, 2.0) == pytest.approx(8.0 * (1.0 - math.cos(2.0)), rel=1e-9)
    assert stick_slip(9.0, 8.0, 2.0) == 0.0


def test_rate_is_the_order_of_the_error() -> None:
    """The frequency of a bar that oscillates errs by second order in the step."""
    scene = next(scene for scene in SCENES if scene.deck == "bar_swings")
    line = run_program(scene, halvings=2)[0]
    assert len(line.errors) == 3
    assert line.rate == pytest.approx(2.0, abs=0.1)
    check = Check("x", 1.0, lambda outcome: 0.0, 1e-3)
    made = Line(scene, check, 1.16, (0.16, 0.04, 0.01), 0.0)
    assert made.rate == pytest.approx(2.0)
    assert not made.accepted
    assert Line(scene, check, 1.0, (1e-12, 1e-13, 1e-12), 0.0).rate is None
    assert not Line(scene, check, math.nan, (math.nan,), 0.0).accepted


def command(*words: str | Path) -> int:
    return main(["validation", *map(str, words)])


def test_command_writes_table_and_page(tmp_path: Path, capsys) -> None:
    words = ["validation", "--out", str(tmp_path / "out"), "--decks", str(DECKS), "--halvings", "1"]
    assert main([*words, "--scenes", "free_fall", "stack"]) == 0
    assert "ok     free_fall: v after 1 s [m]: -4.905, error" in capsys.readouterr().out
    rows = rows_of(tmp_path / "out" / "validation.csv")
    names = 2 * ["free_fall"] + 3 * ["stack"] + 3 * ["stack current"]
    assert [row["scene"] for row in rows] == names
    assert float(rows[0]["computed"]) == pytest.approx(-4.905, rel=1e-12)
    assert float(rows[0]["error_2"]) < 1e-12
    page = (tmp_path / "out" / "validation.md").read_text()
    assert "2 decks, 8 values, **0 missed**" in page
    assert "### Stack of ten cubes\n\n[`stack`](../input/benchmarks/stack.nml).\nExact: weight above." in page
    assert "| normal force of joint 1 [N/m] | 250000 | 250000 |" in page


def test_miss_is_reported_and_is_the_exit_status(tmp_path: Path, monkeypatch, capsys) -> None:
    (scene,) = [scene for scene in SCENES if scene.name == "column"]
    wrong = dataclasses.replace(scene.expectation.checks[0], exact=0.25)
    false_scene = dataclasses.replace(scene, expectation=Measured((wrong,)))
    monkeypatch.setattr("voussoir_benches.validation.all_scenes", lambda: (false_scene,))
    words = ["validation", "--quiet", "--out", str(tmp_path), "--scenes", "column"]
    assert main(words) == 1
    assert "0.25 | 0.2 | 2.0e-01 **MISSED** |" in (tmp_path / "validation.md").read_text()
    assert capsys.readouterr().out == ""


def test_what_is_no_scene_or_no_deck_is_bad_input(tmp_path: Path, capsys) -> None:
    assert command("--scenes", "colum", "--out", tmp_path) == 2
    assert "expected a scene, got 'colum'" in capsys.readouterr().err
    assert command("--scenes", "column", "--decks", tmp_path, "--out", tmp_path / "out") != 0
    assert "column.nml" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert command("--scenes", "column", "--out", tmp_path / "file", "--quiet") == 4


def test_page_of_the_documents_has_every_scene() -> None:
    page = (REPOSITORY / "docs" / "validation.md").read_text()
    sections = {part.partition("\n")[0]: part for part in page.split("\n## ")}
    titles = titles_of(DECKS)
    for scene in SCENES:
        entries = [part for part in sections[scene.group].split("\n### ") if f"Exact: {scene.note}." in part]
        (entry,) = (part for part in entries if f"[`{scene.deck}`](../input/benchmarks/{scene.deck}.nml)" in part)
        assert titles[scene.deck] in entry
        for check in scene.expectation.checks:
            exact = check.exact if isinstance(check.exact, str) else f"{check.exact:.6g}"
            assert f"| {check.what} | {exact} |" in entry


def test_entries_of_several_decks_have_heads_of_their_own() -> None:
    page = (REPOSITORY / "docs" / "validation.md").read_text()
    found = re.findall(r"^### (.+)\n\n- \[`(\w+)`\]", page, re.M)
    assert {deck: head for head, deck in found} == validation_page.HEADS


def test_entry_has_both_geometries_in_one_row() -> None:
    """A column of five cubes collapses at b/h = 0.2; deformable blocks with large displacements at a little less."""
    lines = [line for scene in SCENES if scene.deck == "column" for line in run_program(scene)]
    written = validation_page.page(lines, titles_of(DECKS), "dda 0")
    assert "1 decks, 2 values, **0 missed**" in written
    assert "Exact: b/h. Accepted: 2e-08, current 0.0001.\n" in written
    assert re.search(r"^\| horizontal force over weight \| 0.2 \| 0.2 \| \S+ \| 0.199996 \| 1.8e-05 \|$", written, re.M)


def test_every_deck_of_the_benchmarks_is_a_scene() -> None:
    assert {deck.stem for deck in DECKS.glob("*.nml")} == {scene.deck for scene in SCENES}
    assert find_input("benchmarks").name == DECKS.name


def square(x: float, y: float, u: float = 0.0, *, is_fixed: bool = False) -> Shape:
    """A unit square whose upper corners are displaced by u."""
    corners = np.array([(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)])
    return Shape(corners, np.array([(0.0, 0.0), (0.0, 0.0), (u, 0.0), (u, 0.0)]), is_fixed)


@pytest.mark.parametrize(("u", "moved"), [(0.0, 0), (1e-13, 0), (1e-9, 1), (1e-3, 1), (0.5, 0), (1.0, 1)])
def test_sketch_draws_small_displacements_and_mechanisms_in_one_size(u: float, moved: int) -> None:
    """Round-off and large displacements are not drawn; a mechanism has a largest displacement of 1."""
    drawn = sketch([square(0.0, -1.0, is_fixed=True), square(0.0, 0.0, u)])
    polygons = re.findall(r'<polygon points="([^"]*)" ([^/]*)/>', drawn)
    assert len(polygons) == 2 + moved
    assert ["stroke-dasharray" in style for _, style in polygons].count(True) == moved
    if moved:
        shift = [float(polygons[2][0].split()[2].split(",")[0]) - float(polygons[1][0].split()[2].split(",")[0])]
        side = float(polygons[1][0].split()[1].split(",")[0]) - float(polygons[1][0].split()[0].split(",")[0])
        assert shift[0] / side == pytest.approx(0.12, abs=0.002)


def test_sketch_shows_a_support_that_is_far_below() -> None:
    drawn = sketch([square(0.0, -9.0, is_fixed=True), square(0.0, 0.0)])
    height = float(re.search(r'height="(\d+)" viewBox', drawn)[1])
    (support, _), _ = re.findall(r'<polygon points="([^"]*)" ([^/]*)/>', drawn)
    assert min(float(point.split(",")[1]) for point in support.split()) < height


def points_of(drawn: str, curve: int) -> np.ndarray:
    """Points of a curve of a plot, without its axes: (n, 2) [px]."""
    found = re.findall(r'<polyline points="([^"]*)"', drawn)[1 + curve]
    return np.array([[float(number) for number in point.split(",")] for point in found.split()])


def test_history_of_free_fall_is_a_parabola() -> None:
    time = np.linspace(0.0, 1.0, 11)
    drawn = history(np.array([time, 0.0 * time, -4.905 * time**2]))
    u, v = points_of(drawn, 0), points_of(drawn, 1)
    assert np.ptp(u[:, 1]) == 0.0
    fallen = (v[:, 1] - v[0, 1]) / (v[-1, 1] - v[0, 1])
    assert fallen == pytest.approx(((v[:, 0] - v[0, 0]) / (v[-1, 0] - v[0, 0])) ** 2, abs=2e-3)
    assert ">-4.91<" in drawn and ">1<" in drawn
    assert not has_history(np.array([time, 0.0 * time, 1e-15 * time]))


def test_computed_values_are_on_the_diagonal_where_they_are_exact() -> None:
    exact = [1.0, 2.0, 4.0]
    drawn = diagonal(exact, [1.0, 2.5, 4.0], "[m]")
    line = points_of(drawn, 0)
    places = np.array([[float(x), float(y)] for x, y in re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"', drawn)])
    off = np.cross(line[1] - line[0], places - line[0]) / np.hypot(*(line[1] - line[0]))
    assert abs(off[[0, 2]]).max() < 0.1 and abs(off[1]) > 10.0
    assert has_diagonal(exact) and not has_diagonal([1.0, 1.0, 2.0]) and not has_diagonal([1.0, 10.0, 1000.0])


def test_every_entry_of_the_documents_has_its_sketch() -> None:
    page = (REPOSITORY / "docs" / "validation.md").read_text()
    named = re.findall(r"^!\[.+\]\((.*)\)$", page, re.M)
    plots = [name for name in named if name.endswith("_result.svg")]
    assert len(named) - len(plots) == page.count("\n### ") and len(plots) > 30
    assert {path.name for path in (REPOSITORY / "docs" / validation_page.SKETCHES).glob("*.svg")} == {
        Path(name).name for name in named}
