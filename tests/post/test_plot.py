"""Pictures of results: what is drawn lies where mechanics puts it; every option; every refusal."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from dda_command import run_dda

pytest.importorskip("matplotlib", reason="figures want matplotlib")

from matplotlib.colors import to_hex  # noqa: E402
from matplotlib.text import Text  # noqa: E402

import voussoir  # noqa: E402
from voussoir import results  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.plot.case_joints import roles_of, thrust_points  # noqa: E402
from voussoir.plot.case_marks import LIVE  # noqa: E402
from voussoir.plot.case_picture import draw_case, row_with_safety  # noqa: E402
from voussoir.plot.case_scene import scene_of  # noqa: E402
from voussoir.plot.case_title import title_of  # noqa: E402
from voussoir.plot.collapse_animation import FFMpegWriter  # noqa: E402
from voussoir.plot.collapse_picture import contacts_of, limits, pictures_of, shapes_of  # noqa: E402
from voussoir.plot.design_chart import ChartError, draw_chart, swept_columns  # noqa: E402
from voussoir.plot.figure_style import house_style, save  # noqa: E402
from voussoir.plot.sheet import Sheet, renderer_of  # noqa: E402
from voussoir.plot.sweep_chart import draw_map  # noqa: E402
from voussoir.plot.units import axis_label, length_text, quantity, rounded  # noqa: E402

#: Three axles close to one another, two of one weight
BRIDGE = (
    "&arch shape = 'segmental', span = 8, rise = 2, thickness = 0.5, voussoirs = 15 /\n"
    "&vehicle axles = 12e3, 12e3, 20e3, spacings = 0.4, 0.4, position = -2 /\n&search parameter = 'load_factor' /\n"
)
BENCHMARKS = Path(__file__).resolve().parents[2] / "input" / "benchmarks"


def compute(folder: Path, text: str) -> results.Results:
    """Results of a deck."""
    return voussoir.run(text, out=folder)


@pytest.fixture(scope="module")
def arches(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """One arch that falls and one that stands."""
    return compute(
        tmp_path_factory.mktemp("arches"),
        "&arch voussoirs = 36 /\n&sweep parameter = 'thickness_ratio', values = 0.10, 0.15 /\n",
    )


@pytest.fixture(scope="module")
def searches(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """Critical thicknesses of six arches, two of which fall by sliding too."""
    return compute(
        tmp_path_factory.mktemp("searches"),
        "&search /\n&sweep parameter = 'friction_deg', values = 20, 21, 50 /\n"
        "&sweep parameter = 'half_angle_deg', values = 80, 90 /\n",
    )


@pytest.fixture(scope="module")
def motion(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """An arch whose blocks move, with pictures."""
    return compute(
        tmp_path_factory.mktemp("motion"),
        "&arch voussoirs = 8, thickness_ratio = 0.09 /\n&analysis geometry = 'current' /\n"
        "&output frames = 4, vtu = .false. /\n",
    )


@pytest.fixture(scope="module")
def rocking(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """Three blocks that rock on a base, in time, with pictures."""
    return benchmark(
        tmp_path_factory.mktemp("rocking"), "rocking_tall",
        "output%frames=5", "output%joints=.true.", "analysis%duration=0.5",
    )


def benchmark(folder: Path, deck: str, *settings: str) -> results.Results:
    """Results of a deck of input/benchmarks."""
    options = [word for setting in settings for word in ("--set", setting)]
    out = folder / deck
    assert run_dda("run", BENCHMARKS / f"{deck}.nml", "--quiet", "--out", out, *options).returncode in (0, 3)
    return results.read(out)


def legend_of(figure) -> str:
    """What the legend of a figure says."""
    return " | ".join(text.get_text().replace("\n", " ") for text in figure.legends[0].get_texts())


@pytest.mark.parametrize("case", [1, 2])
def test_line_of_thrust_lies_inside_the_joints(arches: results.Results, case: int) -> None:
    joints = arches.joints_of(case)
    ends = [np.column_stack((joints[f"x_{side}"], joints[f"y_{side}"])) for side in ("intrados", "extrados")]
    along = ends[1] - ends[0]
    reach = np.einsum("ij,ij->i", thrust_points(joints) - ends[0], along)
    share = reach / np.einsum("ij,ij->i", along, along)
    assert np.all(share >= -1e-7) and np.all(share <= 1.0 + 1e-7)
    # and on them
    assert thrust_points(joints) == pytest.approx(ends[0] + share[:, None] * along, abs=1e-9)


def test_mechanism_is_drawn_with_the_displacement_that_the_legend_states(arches) -> None:
    with house_style():
        figure = draw_case(arches, 1, magnify=0.4)
    assert "largest displacement drawn 400 mm" in legend_of(figure)
    scene = scene_of(arches, 1)
    moves = [np.hypot(*(after - before).T).max() for before, after in zip(scene.shapes(0.0), scene.shapes(0.4))]
    assert max(moves) == pytest.approx(0.4, abs=1e-12)
    drawn = figure.axes[0].collections[2].get_paths()  # over the supports and the blocks before the collapse
    for path, shape in zip(drawn, scene.shapes(0.4)):
        assert path.vertices[: len(shape)] == pytest.approx(shape, abs=1e-12)


def test_supports_of_an_arch_are_cut_off_below_its_springings(arches) -> None:
    scene = scene_of(arches, 2)
    assert [len(scene.blocks), len(scene.supports)] == [36, 2]
    for support in scene.supports:
        assert support.corners[:, 1].max() == pytest.approx(0.0, abs=1e-12)
        assert support.corners[:, 1].min() == pytest.approx(-0.3 * 1.5, abs=1e-12)


def test_joints_that_slide_in_the_collapse_are_marked(searches: results.Results) -> None:
    marked = {}
    for row in searches.cases.rows():
        slides = np.flatnonzero(roles_of(searches.joints_of(row["case"])) == "sliding")
        marked[row["half_angle_deg"], row["friction_deg"]] = set(slides)
        assert bool(len(slides)) == (row["collapse_mode"] == "mixed")
    # at 90 degrees friction of 21.2 degrees and less lets the springings slide outwards
    assert marked[90, 20] == marked[90, 21] == {0, 36}
    assert marked[90, 50] == set()


@pytest.mark.parametrize(
    ("deck", "settings", "words"),
    [
        ("post_and_lintel", (), ("fixed", "collapse mechanism", "hinge", "thrust line")),
        ("dry_wall_2x4", (), ("hinge", "open joint", "contact forces")),
        ("slope", (), ("sliding joint: directions of its sides",)),
        ("four_corners", (), ("touches at this corner only",)),
        ("momentum", (), ("at the beginning; true scale", "monitoring points, trajectories")),
        ("projectile", (), ("monitoring points, trajectories",)),
    ],
)
def test_any_scene_of_blocks_is_drawn(tmp_path: Path, deck: str, settings, words) -> None:
    run = benchmark(tmp_path, deck, *settings)
    with house_style():
        figure = draw_case(run, 1)
    legend = legend_of(figure)
    assert all(word in legend for word in words), legend
    low, high = (np.array(end) for end in zip(figure.axes[0].get_xlim(), figure.axes[0].get_ylim()))
    scene = scene_of(run, 1)
    points = np.vstack(scene.shapes(1.0 if scene.moves else 0.0))
    assert np.all(points >= low) and np.all(points <= high)


def test_search_along_a_path_is_drawn_where_the_blocks_come_to_rest(tmp_path: Path) -> None:
    """A lintel whose right support is led away until it falls: support, lintel and restraints are drawn there."""
    boxes = ((-1.0, -1.0, 0.0, 0.0, "fixed"), (1.0, -1.0, 2.0, 0.0, ""), (-0.2, 0.0, 1.2, 0.3, ""))
    (tmp_path / "x.blocks").write_text("".join(
        f"block {words}\n{a} {b}\n{c} {b}\n{c} {d}\n{a} {d}\n" for a, b, c, d, words in boxes)
        + "displacement 1.2 -0.5 1 0\ndisplacement 1.8 -0.5 1 0\n")
    run = compute(tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&analysis geometry = 'current' /\n"
                            "&search parameter = 'displacement_factor', low = 0, high = 1, tolerance = 1e-3 /\n")
    row = run.case(1)
    assert row["verdict"] == "found"
    with house_style():
        axes = draw_case(run, 1).axes[0]
    marks = sorted(line.get_xydata()[0][0] for line in axes.lines if line.get_marker() == "^")
    assert marks == pytest.approx([1.2 + row["critical_low"], 1.8 + row["critical_low"]], abs=0.01)
    drawn = np.vstack(scene_of(run, 1).shapes(1.0))
    assert drawn[:, 0].max() == pytest.approx(2.0 + row["critical_low"], abs=0.01)


def test_an_arch_that_has_spread_to_its_collapse_shows_four_hinges(tmp_path: Path) -> None:
    """Three of them bear the arch in its last equilibrium, one at the extrados; the fourth makes it a mechanism."""
    deck = ("&arch voussoirs = 9, half_angle_deg = 75, thickness_ratio = 0.16 /\n"
            "&support right_dx = 1 /\n&joint friction_deg = 60 /\n&analysis geometry = 'current' /\n")
    search = "&search parameter = 'displacement_factor', low = 0, high = 4, tolerance = 1e-2 /\n"
    for number, text, mode, count in ((1, deck, "none", 3), (2, deck + search, "rotational", 4)):
        (folder := tmp_path / str(number)).mkdir()
        run = compute(folder, text)
        with house_style():
            axes = draw_case(run, 1).axes[0]
        hinges = {mark: sum(len(line.get_xdata()) for line in axes.lines if line.get_marker() == mark) for mark in "os"}
        assert (run.case(1)["collapse_mode"], hinges) == (mode, {"o": count - 1, "s": 1})


def test_ways_of_measured_points_end_where_the_points_are(rocking: results.Results) -> None:
    with house_style():
        axes = draw_case(rocking, 1, magnify=1.0).axes[0]
    ends = [line.get_xydata()[-1] for line in axes.lines if line.get_marker() == "D"]
    ways = rocking.points_of(1)
    assert len(ends) == len(ways) == 6
    for end, way in zip(ends, ways):
        assert end == pytest.approx([way["x"][-1], way["y"][-1]], abs=1e-12)


def test_scenes_of_lines_and_of_the_original_scheme_are_drawn(tmp_path: Path) -> None:
    for mode in ("static", "limerick"):
        deck = BENCHMARKS.parent / "limerick" / "terrace.nml"
        out = voussoir.run(deck, out=tmp_path / mode, **{"analysis%mode": mode}).folder
        assert main(["plot", str(out)]) == 0
        assert (out / "plots" / "case_1.svg").stat().st_size > 5000


@pytest.mark.parametrize(
    ("groups", "words"),
    [
        ("&search low = 0.2, high = 0.5 /", "thrust line"),  # stands at both ends
        ("&search low = 0.02, high = 0.05 /", "collapse mechanism"),  # falls at both
        ("&analysis geometry = 'current', steps = 1 /", "thrust line"),  # is undecided
        ("&analysis geometry = 'current' /\n&search /", "collapse mechanism"),
        ("&analysis mode = 'limerick' /\n&search /", "collapse mechanism"),
    ],
)
def test_cases_of_any_end_are_drawn(tmp_path: Path, groups: str, words: str) -> None:
    run = voussoir.run(f"&arch voussoirs = 8 /\n{groups}\n", out=tmp_path)
    with house_style():
        assert words in legend_of(draw_case(run, 1))


SPREAD = (
    "&arch half_angle_deg = 60, radius = 1, thickness_ratio = 0.15, voussoirs = 15 /\n&support right_dx = 0.25 /\n"
    "&joint friction_deg = 40 /\n&analysis geometry = 'current' /\n"
)


def test_a_falling_arch_has_hinges_where_it_gapes_and_no_thrust_line(tmp_path: Path) -> None:
    run = compute(tmp_path, SPREAD)
    row, joints = run.case(1), run.joints_of(1)
    assert row["verdict"] == "collapsed"
    with house_style():
        figure = draw_case(run, 1)
    legend = legend_of(figure)
    assert "hinge" in legend and "thrust line" not in legend and "support that moves" in legend
    assert f"{100 * (1 + row['path_time']):.1f} % of the displacement of the supports" in title_of(row, run)
    # a joint that gapes keeps one corner: it has no length in the table
    ends = [np.column_stack((joints[f"x_{side}"], joints[f"y_{side}"])) for side in ("intrados", "extrados")]
    gaping = ends[0][np.all(ends[0] == ends[1], axis=1)]
    assert len(gaping) >= 3
    discs = np.vstack([line.get_xydata() for line in figure.axes[0].lines if line.get_marker() == "o"])
    for corner in gaping:
        assert np.hypot(*(discs - corner).T).min() < 1e-6
    gaps = np.fmax(joints["opening_intrados"], joints["opening_extrados"])
    closed = (gaps < 1e-4) & ~np.all(ends[0] == ends[1], axis=1)
    for end in ends:
        assert np.hypot(*(discs[:, None] - end[closed]).transpose(2, 0, 1)).min() > 1e-3


def test_title_of_a_spread_has_the_displacement_at_collapse(tmp_path: Path) -> None:
    search = "&search parameter = 'displacement_factor', low = 0, high = 1, tolerance = 1e-2 /\n"
    run = compute(tmp_path, SPREAD + search)
    row = run.case(1)
    lines = title_of(row, run).splitlines()
    assert lines[-2].startswith(f"Collapse with the right support {250 * row['critical']:.3g} mm to the right (±")
    assert lines[-1] == "Drawn: last equilibrium before it"


def test_what_is_not_reported_is_not_drawn(tmp_path: Path, capsys) -> None:
    run = benchmark(tmp_path, "stack", "output%joints=.false.")
    with house_style():
        assert "contact forces" not in legend_of(draw_case(run, 1))
    bare = benchmark(tmp_path / "bare", "stack", "output%blocks=.false.")
    assert main(["plot", str(bare.folder)]) == 2
    wanted = "--set output%blocks=.true. --set output%joints=.true. --cases 1"
    assert wanted in capsys.readouterr().err


def test_numbers_have_units_that_suit_them() -> None:
    assert [length_text(value) for value in (2e-9, 3.5e-6, 0.0123, 0.5, 2.0, 4200.0)] == [
        "2 nm", "3.5 µm", "12.3 mm", "500 mm", "2 m", "4.2 km"
    ]
    assert [quantity(value, "N/m") for value in (12.0, 368.46e3, 2e6)] == ["12 N/m", "368 kN/m", "2 MN/m"]


def test_magnification_is_a_round_number() -> None:
    assert [rounded(value) for value in (1.0, 7.0, 350.0, 0.03, 20.0)] == [1, 5, 200, 0.02, 20]


@pytest.mark.parametrize("ending", ["svg", "pdf", "png"])
def test_pictures_are_the_same_bytes_at_every_run(arches, tmp_path: Path, ending: str) -> None:
    folders = [tmp_path / "a", tmp_path / "b"]
    for out in folders:
        words = ["plot", str(arches.folder), "--case", "1", "--format", ending, "--out", str(out)]
        assert main(words) == 0
    first, second = ((out / f"case_1.{ending}").read_bytes() for out in folders)
    assert first == second and len(first) > 5000


def test_all_cases_are_drawn_beside_the_results(arches, capsys) -> None:
    assert main(["plot", str(arches.folder)]) == 0
    names = [Path(line).name for line in capsys.readouterr().out.splitlines()]
    assert names == ["case_1.svg", "case_2.svg"]
    assert (arches.folder / "plots" / "case_2.svg").exists()


def test_magnification_is_stated_and_forces_may_be_left_out(arches, tmp_path: Path) -> None:
    with house_style():
        texts = {
            magnify: legend_of(draw_case(arches, 2, magnify, with_forces))
            for magnify, with_forces in ((None, True), ("auto", True), (30.0, False), (0.0, False))
        }
    assert "contact forces on the upper block, longest 548 kN/m" in texts[None]
    assert "displaced" not in texts[None]  # what stands is drawn as it stands
    assert "displacements × 500 (largest 1.09 mm)" in texts["auto"]
    assert "displacements × 30 (" in texts[30.0] and "forces" not in texts[30.0]
    assert "displaced" not in texts[0.0]
    words = ["plot", str(arches.folder), "--out", str(tmp_path), "--magnify", "2", "--no-forces"]
    assert main(words) == 0
    assert main(["plot", str(arches.folder), "--out", str(tmp_path), "--numbers", "--coordinates", "--magnify"]) == 0


def test_title_has_the_deck_s_own_and_the_swept_values_in_words(tmp_path: Path) -> None:
    run = compute(
        tmp_path,
        "&scene title = 'Costs $5' /\n&search /\n"
        "&sweep parameter = 'radius', values = 5 /\n&sweep parameter = 'half_angle_deg', values = 60, 90 /\n",
    )
    lines = title_of(run.case(2), run).splitlines()
    assert lines[:2] == ["Costs \\$5", "Case 2 of 2: radius 5 m, half angle 90°, friction angle 50°, 36 blocks"]
    assert lines[2].startswith("Critical thickness over radius: 0.1074, exact 0.1074")
    assert axis_label("analysis%time_step") == "time step [s]" and axis_label("young") == "Young's modulus [Pa]"


LOADED = """block fixed
-1 -1
2 -1
2 0
-1 0
block material 2
0 0
1 0
1 1
0 1
block
0 1
1 1
1 2
0 2
material 2 density 2500
load block 3 0.5 2 300 -400   ! 500 N/m, its tip at the top
live 0.5 2 0 -250
fix block 2 0 0 x
measure 1 2
"""


def test_loads_held_points_materials_and_numbers_are_drawn_where_they_are(tmp_path: Path) -> None:
    (tmp_path / "two.blocks").write_text(LOADED)
    run = compute(tmp_path, "&scene kind = 'blocks', geometry = 'two.blocks' /\n")
    with house_style():
        figure = draw_case(run, 1, numbers=True, coordinates=True)
    axes, legend = figure.axes[0], legend_of(figure)
    for words in ("load | ", "live load, before its factor", "restraint along x",
                  "blocks of material 2 with restraints"):
        assert words in legend
    texts = {text.get_text(): text for text in axes.texts}
    assert {"500 N/m", "250 N/m", "1", "2", "3"} <= set(texts)
    assert texts["3"].get_position() == pytest.approx((0.5, 1.5))
    arrows = [text for text in axes.texts if getattr(text, "arrow_patch", None) and not text.get_text()]
    assert [arrow.xy for arrow in arrows] == [pytest.approx((0.5, 2.0))] * 2
    first, second = (np.subtract(arrow.xy, arrow.get_position()) for arrow in arrows)
    assert first[0] / first[1] == pytest.approx(300 / -400)  # along the force,
    assert np.hypot(*second) == pytest.approx(np.hypot(*first) / 2)  # as long as it is large
    assert axes.get_xlabel() == "x [m]" and axes.axison
    tints = {tuple(part.get_facecolor()[0]) for part in axes.collections[1:3]}
    assert len(tints) == 2


def test_water_is_drawn_at_the_end_of_its_rise(tmp_path: Path) -> None:
    (tmp_path / "two.blocks").write_text(
        LOADED + "water -30 0.25 0 0.25 90 0 factor 0\n0 0\n1 0.5\nabsorb -1 -1 2 -1 x\n"
    )
    head = "&scene kind = 'blocks', geometry = 'two.blocks' /\n"
    with house_style():
        figure = draw_case(compute(tmp_path, head + "&load water_rise = 0.125 /\n"), 1)
        (heads,) = [line for line in figure.axes[0].lines if line.get_linestyle() == "-."]
        assert heads.get_xydata().tolist() == [[-30, 0.875], [0, 0.875], [90, 0.625]]
        assert figure.axes[0].get_xlim()[1] < 20  # what is beside the blocks is not shown
        assert "piezometric line" in legend_of(figure) and "face that lets waves out" in legend_of(figure)
        swept = compute(tmp_path, head + "&sweep parameter = 'water_rise', values = 0, 0.1 /\n")
        assert "not drawn: the rise of the water, which varies" in legend_of(draw_case(swept, 2))


def test_live_loads_of_an_arch_are_drawn_unless_they_are_swept(tmp_path: Path) -> None:
    deck = "&arch radius = 5 /\n&live x = 0.3, y = 4.7, fy = -1000 /\n"
    with house_style():
        legend = legend_of(draw_case(compute(tmp_path, deck), 1))
        assert "live load, before its factor" in legend and "not drawn" not in legend
        swept = compute(tmp_path, deck + "&sweep parameter = 'live%x(1)', values = 0.3 /\n")
        legend = legend_of(draw_case(swept, 1))
        assert "not drawn: &live, which is swept" in legend and "live load" not in legend


def test_file_of_blocks_that_is_not_there_is_reported(tmp_path: Path) -> None:
    (tmp_path / "two.blocks").write_text(LOADED)
    run = compute(tmp_path, "&scene kind = 'blocks', geometry = 'two.blocks' /\n")
    (tmp_path / "two.blocks").unlink()
    with house_style():
        assert "not drawn: loads and restraints of two.blocks" in legend_of(draw_case(run, 1))


def test_chart_shows_critical_and_exact_values(searches, tmp_path: Path) -> None:
    assert swept_columns(searches.cases) == ["half_angle_deg", "friction_deg"]
    with house_style():
        axes = draw_chart(searches, "friction_deg").axes[0]
    drawn = [line for line in axes.lines if len(line.get_xdata())]
    assert {line.get_linestyle() for line in drawn} == {"None"}  # nothing is computed between them
    assert [list(line.get_xdata()) for line in drawn] == 4 * [[20, 21, 50]]
    for found, exact in zip(drawn[::2], drawn[1::2]):
        assert exact.get_marker() == "+"
        assert found.get_ydata() == pytest.approx(exact.get_ydata(), abs=1e-8)
    assert axes.get_xlabel().startswith("friction angle")
    assert axes.get_ylabel().startswith("critical thickness")
    assert main(["plot", str(searches.folder), "--chart", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "chart.svg").exists()


def test_positions_of_a_vehicle_are_charted_above_the_bridge(tmp_path: Path) -> None:
    run = compute(
        tmp_path,
        "&arch shape = 'segmental', span = 6, rise = 1.5, thickness = 0.4, voussoirs = 11 /\n"
        "&vehicle axles = 6e4, 1e5, spacings = 2.5 /\n&search parameter = 'load_factor' /\n"
        "&sweep parameter = 'position', values = 2, -3, 1.5, -2.7 /\n",
    )
    with house_style():
        diagram, bridge = draw_chart(run).axes
    factors, place = diagram.lines[0], float(run.cases["position"][np.argmin(run.cases["critical"])])
    assert list(factors.get_xdata()) == [-3, -2.7, 1.5, 2]
    assert sorted(factors.get_ydata()) == sorted(run.cases["critical"])
    assert [line.get_xdata()[0] for line in (diagram.lines[1], bridge.lines[0])] == [place, place]
    assert f"at {place:.3g} m" in diagram.texts[0].get_text()
    assert sum(len(drawn.get_paths()) for drawn in bridge.collections) >= 11
    assert main(["plot", str(run.folder), "--chart", "position", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "chart_position.svg").exists()


def test_chart_over_blocks_of_a_linked_sweep(tmp_path: Path) -> None:
    run = compute(
        tmp_path,
        "&search /\n&sweep parameter = 'half_angle_deg', values = 60, 75, 90 /\n"
        "&sweep parameter = 'voussoirs', values = 24, 30, 36, linked = .true. /\n",
    )
    with house_style():
        assert len(draw_chart(run, "voussoirs").axes[0].get_legend().get_texts()) == 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--case", "99"], "no case 99"),
        (["--chart", "radius"], "expected one of"),
        (["--chart"], "give the deck &search"),
    ],
)
def test_what_cannot_be_drawn_is_reported(arches, words, message, capsys) -> None:
    assert main(["plot", str(arches.folder), *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{arches.folder}:1: error: ") and message in error


def test_folder_without_results_is_reported(tmp_path: Path, capsys) -> None:
    for command in ("plot", "animate"):
        assert main([command, str(tmp_path)]) == 2
        assert "no results.csv" in capsys.readouterr().err


def test_folder_that_cannot_be_written_is_status_4(arches, tmp_path: Path, capsys) -> None:
    (tmp_path / "taken").write_text("a file")
    assert main(["plot", str(arches.folder), "--out", str(tmp_path / "taken")]) == 4
    assert "taken" in capsys.readouterr().err


def test_many_curves_of_one_number_are_distinguished_by_colour(tmp_path: Path) -> None:
    run = compute(
        tmp_path,
        "&search /\n&arch voussoirs = 12 /\n&output joints = .false. /\n"
        "&sweep parameter = 'half_angle_deg', first = 60, last = 90, count = 10 /\n"
        "&sweep parameter = 'friction_deg', first = 25, last = 50, count = 9 /\n",
    )
    with house_style():
        for column, other, curves in (("friction_deg", "half_angle_deg", 10), ("half_angle_deg", "friction_deg", 9)):
            axes, bar = draw_chart(run, column).axes
            assert len(axes.lines) == curves
            low, high = min(run.cases[other]), max(run.cases[other])
            assert bar.get_ylim() == pytest.approx((low, high))
            for line in axes.lines:
                assert len(line.get_xdata()) == 19 - curves


def test_three_swept_numbers_are_maps_of_computed_cells(tmp_path: Path) -> None:
    run = compute(
        tmp_path,
        "&search /\n&arch voussoirs = 8 /\n&output joints = .false. /\n"
        "&sweep parameter = 'half_angle_deg', first = 60, last = 90, count = 7 /\n"
        "&sweep parameter = 'friction_deg', values = 10, 40, 50 /\n"
        "&sweep parameter = 'horizontal_coefficient', first = 0, last = 0.2, count = 11 /\n",
    )
    missing = int((run.cases["verdict"] != "found").sum())
    assert missing > 0  # 10 degrees are too few
    with house_style():
        figure = draw_chart(run, "horizontal_coefficient")
    *panels, bar = figure.axes
    assert len(panels) == 3
    found = run.cases.take(run.cases["verdict"] == "found")
    assert bar.get_ylim() == pytest.approx((found["critical"].min(), found["critical"].max()))
    for axes, friction in zip(panels, (10.0, 40.0, 50.0)):
        assert axes.get_title() == f"friction angle {friction:g}°"
        field = np.ma.filled(axes.collections[0].get_array(), np.nan).reshape(7, 11)
        rows = found.where(friction_deg=friction)
        assert np.isfinite(field).sum() == len(rows)
        last = rows.where(half_angle_deg=90.0, horizontal_coefficient=0.2)["critical"].tolist()
        assert field[6, 10] == last[0] if last else np.isnan(field[6, 10])
    assert f"{missing} of {len(run.cases)} cases have no critical value" in figure._suptitle.get_text()
    assert main(["plot", str(run.folder), "--chart", "--out", str(tmp_path / "out"), "--format", "png"]) == 0


def test_too_many_curves_are_refused(tmp_path: Path) -> None:
    run = compute(
        tmp_path,
        "&search /\n&arch voussoirs = 8 /\n&output joints = .false. /\n"
        "&sweep parameter = 'half_angle_deg', first = 60, last = 90, count = 5 /\n"
        "&sweep parameter = 'springing', texts = 'frictional', 'no-slip' /\n"
        "&sweep parameter = 'friction_deg', values = 40, 50, 60 /\n",
    )
    with pytest.raises(ChartError, match="got 10 curves of .*; sweep fewer values"):
        draw_chart(run, "friction_deg")


def test_cases_without_a_critical_value_are_reported(tmp_path: Path) -> None:
    run = compute(
        tmp_path, "&search /\n&arch voussoirs = 8 /\n&sweep parameter = 'friction_deg', values = 5, 40, 50 /\n")
    with house_style():
        title = draw_chart(run).axes[0].get_title()
    assert title == "1 of 3 cases have no critical value"


def test_motion_is_animated(motion: results.Results, tmp_path: Path, capsys) -> None:
    file = tmp_path / "fall.gif"
    assert main(["animate", str(motion.folder), "--case", "1", "--out", str(file)]) == 0
    assert file.read_bytes()[:6] == b"GIF89a"
    assert capsys.readouterr().out.strip() == str(file)


def test_blocks_in_time_are_animated(rocking: results.Results, tmp_path: Path, capsys) -> None:
    frames = rocking.frames_of(1)
    assert [frame.time for frame in frames] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5], abs=1e-3)
    words = ["animate", str(rocking.folder), "--magnify", "2", "--out", str(tmp_path / "rock.png")]
    assert main(words) == 0
    names = [f"rock_{number:03d}.png" for number in range(1, 7)]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    assert capsys.readouterr().out.strip() == str(tmp_path / names[0])
    scene = scene_of(rocking, 1)
    assert [block.number for block in scene.supports] == [1]
    now, twice = (shapes_of(scene, frames[0], frames[3], factor) for factor in (1.0, 2.0))
    assert twice[0] - scene.blocks[0].corners == pytest.approx(2 * (now[0] - scene.blocks[0].corners))
    low, high = limits(rocking, [1], 2.0)
    assert np.all(np.vstack(twice) >= low) and np.all(np.vstack(twice) <= high)
    # each block rocks on a corner
    assert all(points.shape[1] <= 6 for points in contacts_of(frames[1]).values())


@pytest.mark.skipif(FFMpegWriter.isAvailable(), reason="ffmpeg is there: skipped")
def test_missing_ffmpeg_is_reported(motion: results.Results, tmp_path: Path, capsys) -> None:
    assert main(["animate", str(motion.folder), "--out", str(tmp_path / "fall.mp4")]) == 2
    assert "expected the program ffmpeg" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="ffmpeg is not there: skipped")
def test_motion_is_a_film(motion: results.Results, tmp_path: Path) -> None:
    assert main(["animate", str(motion.folder), "--out", str(tmp_path / "fall.mp4")]) == 0
    assert (tmp_path / "fall.mp4").read_bytes()[4:8] == b"ftyp"


def test_unknown_ending_of_an_animation_is_reported(motion, tmp_path: Path, capsys) -> None:
    assert main(["animate", str(motion.folder), "--out", str(tmp_path / "fall.avi")]) == 2
    assert "expected a file .gif, .mp4 or .png, got 'fall.avi'" in capsys.readouterr().err


def test_mechanism_of_a_collapse_without_frames_is_animated(arches, tmp_path: Path, capsys) -> None:
    pictures = pictures_of(arches, 1)
    blocks = arches.blocks_of(1)
    assert len(pictures) == 11
    first, last = pictures[0].blocks, pictures[-1].blocks
    moves = [np.hypot(*(after - before).T).max() for before, after in zip(first, last)]
    assert max(moves) == pytest.approx(0.08 * 2 * 10.5, rel=0.13)  # of the width, and its margins
    assert all(np.array_equal(shape, block.corners) for shape, block in zip(first, blocks))
    assert main(["animate", str(arches.folder), "--out", str(tmp_path / "fall.png")]) == 0
    assert len(list(tmp_path.iterdir())) == 11
    capsys.readouterr()


def test_results_that_do_not_move_are_not_animated(arches, capsys) -> None:
    assert main(["animate", str(arches.folder), "--case", "2"]) == 2
    assert "expected frames of case 2, got none; give the deck" in capsys.readouterr().err


@pytest.mark.parametrize(
    "keys", ["shape = 'pointed', span = 6, rise = 4, thickness", "half_angle_deg = 80, thickness_ratio"]
)
def test_titles_of_arches_that_stand_say_thickness_over_critical(tmp_path: Path, keys: str) -> None:
    """Pushed a little, so that no table of exact values has the critical thickness."""
    name, push = keys.rpartition(" ")[2], "&load horizontal_coefficient = 0.02 /\n"
    text = f"&arch {keys} = 0.5, voussoirs = 15 /\n&joint friction_deg = 40 /\n" + push
    for folder in ("stands", "critical"):
        (tmp_path / folder).mkdir()
    stands = compute(tmp_path / "stands", text)
    search = f"&search parameter = '{name}', low = 0.01, high = 0.5 /\n"
    critical = compute(tmp_path / "critical", text + search).case(1)["critical"]
    row = row_with_safety(stands, 1)
    assert row["safety_thickness"] == pytest.approx(0.5 / critical, rel=1e-7)
    assert f"thickness {0.5 / critical:.3g} × critical" in title_of(row, stands)
    assert draw_case(stands, 1)._suptitle.get_text().split() == title_of(row, stands).split()


def test_titles_say_where_no_thickness_falls_and_thrust_has_no_end(tmp_path: Path) -> None:
    """A flat arch between skewbacks within the friction angle stands at any thickness, under any thrust."""
    flat = "&arch shape = 'flat', span = 9, half_angle_deg = 25, thickness = 1.2, voussoirs = 21 /\n"
    run = compute(tmp_path, flat + "&joint friction_deg = 40 /\n")
    title = title_of(row_with_safety(run, 1), run)
    assert "at any smaller thickness, too" in title and "thrust of at least" in title


def test_titles_do_without_a_program(arches: results.Results, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    run = compute(tmp_path, "&arch shape = 'pointed', span = 6, rise = 4, thickness = 0.5, voussoirs = 15 /\n")
    monkeypatch.setenv("VOUSSOIR_DDA", str(tmp_path / "none"))
    title = title_of(row_with_safety(run, 1), run)
    assert "Stable, thrust" in title


def test_two_thicknesses_that_are_equal_have_the_safety_of_one(tmp_path: Path) -> None:
    safety = []
    for number, keys in enumerate(("thickness = 0.7", "crown_thickness = 0.7, springing_thickness = 0.7")):
        (tmp_path / str(number)).mkdir()
        text = f"&arch shape = 'basket', span = 8, rise = 2.6, {keys}, voussoirs = 29 /\n&joint friction_deg = 60 /\n"
        safety.append(row_with_safety(compute(tmp_path / str(number), text), 1)["safety_thickness"])
    assert 1.0 < safety[0] < 2.0
    assert safety[1] == pytest.approx(safety[0], rel=1e-6)


@pytest.mark.parametrize(("fill", "surface"), [("", None), ("&fill height = 0.5, unit_weight = 18e3 /\n", 2.05)])
def test_axles_are_drawn_where_the_vehicle_stands_worst(tmp_path: Path, fill: str, surface: float | None) -> None:
    """On the extrados, or on the surface of the fill; the crown's extrados is 1.55 m high."""
    run = compute(tmp_path, "&arch shape = 'segmental', span = 5, rise = 1.2, thickness = 0.35, voussoirs = 26 /\n"
                  + fill + "&vehicle axles = 20e3, 30e3, spacings = 2.0, worst = .true. /\n"
                  "&search parameter = 'load_factor' /\n")
    with house_style():
        axes = draw_case(run, 1, magnify=0.0).axes[0]
    row = run.case(1)
    tips = {round(text.xy[0], 9): text.xy[1] for text in axes.texts if getattr(text, "arrow_patch", None)}
    said = {text.get_text() for text in axes.texts}
    assert {"20 kN/m", "30 kN/m"} <= said
    start = row["worst_position"]
    if surface is not None:
        assert tips == {round(x, 9): pytest.approx(surface) for x in (start, start + 2.0)}
        return
    radius = (2.5**2 + 1.2**2) / 2.4 + 0.35
    above = {x: y for x, y in tips.items() if abs(x) < 2.4}
    assert above
    for x, y in above.items():  # the chords of the voussoirs are at most 3 mm below the circle
        assert y == pytest.approx(1.55 - radius + np.sqrt(radius**2 - x**2), abs=3e-3)


def test_no_text_is_smaller_than_the_smallest_type(tmp_path: Path) -> None:
    """Legend, values of loads, scale bar, and contours of a map."""
    bridge = compute(tmp_path, BRIDGE)
    (tmp_path / "map").mkdir()
    field = compute(tmp_path / "map", (
        "&arch shape = 'segmental', span = 4, rise = 1, thickness = 0.3, voussoirs = 9 /\n"
        "&fill height = 0.3, unit_weight = 18e3 /\n&vehicle axles = 1e4, position = -1 /\n"
        "&search parameter = 'load_factor' /\n&sweep parameter = 'height', values = 0.2, 0.3, 0.4 /\n"
        "&sweep parameter = 'position', values = -1, -0.5, 0 /\n"))
    with house_style(8.0, 8.0):
        figures = draw_case(bridge, 1, sheet=Sheet(80 / 25.4)), draw_map(field, ("height", "position"))
        sizes = {text.get_fontsize() for figure in figures for text in figure.findobj(Text) if text.get_text()}
    assert min(sizes) >= 8.0
    with house_style(8.0):
        small = draw_case(bridge, 1, sheet=Sheet(80 / 25.4))
        assert min(text.get_fontsize() for text in small.findobj(Text) if text.get_text()) < 8.0
    assert [axes.get_ylabel() for axes in figures[1].axes][0] == "position of the vehicle [m]"
    assert figures[1].axes[0].get_xlabel() == "height of the fill [m]"


def test_values_of_loads_do_not_hide_one_another(tmp_path: Path) -> None:
    """Two axles of one weight have one value; of two weights, two that lie apart."""
    run = compute(tmp_path, BRIDGE)
    with house_style(8.0):
        figure = draw_case(run, 1, sheet=Sheet(80 / 25.4))
    values = [text for text in figure.axes[0].texts if text.get_text().endswith("kN/m")]
    assert sorted(text.get_text() for text in values) == ["12 kN/m", "20 kN/m"]
    first, second = (text.get_window_extent(renderer_of(figure)) for text in values)
    assert not first.overlaps(second)


def test_pdf_files_embed_letters_that_can_be_searched(arches, tmp_path: Path) -> None:
    """Type 3 fonts are refused by publishers."""
    with house_style():
        (path,) = save(draw_case(arches, 1), tmp_path, "arch", ("pdf",))
    assert b"/Type3" not in path.read_bytes() and b"/CIDFontType2" in path.read_bytes()


def test_labels_of_close_axles_leave_their_arrows_free(tmp_path: Path) -> None:
    run = compute(tmp_path, BRIDGE.replace("0.4, 0.4", "0.7, 0.7").replace("12e3, 12e3, 20e3", "60e3, 70e3, 90e3"))
    with house_style(8.0, 8.0):
        figure = draw_case(run, 1, sheet=Sheet(80 / 25.4, title=False))
    render = renderer_of(figure)
    axes = figure.axes[0]
    labels = [text for text in axes.texts if "kN/m" in text.get_text()]
    arrows = [text.arrow_patch for text in axes.texts if getattr(text, "arrow_patch", None) is not None]
    assert len(labels) == 3 and len(arrows) == 3
    for label in labels:
        box = label.get_window_extent(render)
        assert not any(box.overlaps(arrow.get_window_extent(render)) for arrow in arrows), label.get_text()


def test_values_of_flat_loads_stand_behind_their_arrows(tmp_path: Path) -> None:
    (tmp_path / "w.blocks").write_text(
        "block fixed\n-2 -1\n3 -1\n3 0\n-2 0\nblock\n0 0\n1 0\n1 2\n0 2\nlive 0 0.5 9e3 0\nlive 1 1.5 -1e3 0\n")
    run = compute(
        tmp_path, "&scene kind = 'blocks', geometry = 'w.blocks' /\n&search parameter = 'load_factor' /\n")
    with house_style(8.0):
        figure = draw_case(run, 1, sheet=Sheet(80 / 25.4))
        figure.draw_without_rendering()
    axes, render = figure.axes[0], renderer_of(figure)
    found = {text.get_text(): text.get_window_extent(render) for text in axes.texts if "kN/m" in text.get_text()}
    drawn = [text.arrow_patch for text in axes.texts if getattr(text, "arrow_patch", None)]
    ends = [patch.get_window_extent(render) for patch in drawn if to_hex(patch.get_edgecolor()) == LIVE]
    left, right = sorted(ends, key=lambda box: box.x0)
    assert found["9 kN/m"].x1 < left.x0 and found["1 kN/m"].x0 > right.x1
    for label, arrow in (("9 kN/m", left), ("1 kN/m", right)):
        assert arrow.y0 < found[label].y1 and found[label].y0 < arrow.y1


def test_a_contour_has_one_label_although_cells_break_it(tmp_path: Path) -> None:
    from matplotlib import pyplot

    from voussoir.plot.sweep_chart import draw_contours

    field = np.add.outer(np.arange(9.0), np.arange(9.0))
    field[4, 4] = field[3, 5] = field[5, 3] = np.nan
    axes = pyplot.figure().subplots()
    draw_contours(axes, np.arange(9.0), np.arange(9.0), field)
    words = [text.get_text() for text in axes.texts]
    assert words and len(words) == len(set(words))
