"""Figures of given width: what is drawn where, in which type, and which marks; charts of sweeps; bare files."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from block_scene import wall
from dda_command import run_dda

pytest.importorskip("matplotlib", reason="figures want matplotlib")

from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402
from matplotlib.colors import to_rgb  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

import voussoir  # noqa: E402
from voussoir import results  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.plot.bare_scene import draw_file  # noqa: E402
from voussoir.plot.case_picture import draw_case  # noqa: E402
from voussoir.plot.case_scene import scene_of  # noqa: E402
from voussoir.plot.design_chart import ChartError  # noqa: E402
from voussoir.plot.figure_style import EXACT_DPI, INK, house_style  # noqa: E402
from voussoir.plot.motion import motion_of  # noqa: E402
from voussoir.plot.sheet import EDGE, Sheet  # noqa: E402
from voussoir.plot.sweep_chart import draw_contours, draw_map, draw_sweep  # noqa: E402
from voussoir.plot.thrust_path import chain_pairs  # noqa: E402
from voussoir.polygon import distance  # noqa: E402
from voussoir.results import Block  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]


def compute(folder: Path, text: str) -> results.Results:
    """Results of a deck."""
    return voussoir.run(text, out=folder)


@pytest.fixture(scope="module")
def pushed(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """A wall of 105 bricks that is pushed over."""
    folder = tmp_path_factory.mktemp("pushed")
    (folder / "wall.blocks").write_text(wall(10, 10, 1.0, 0.5, 1.0))
    return compute(folder, "&scene kind = 'blocks', geometry = 'wall.blocks' /\n&joint friction_deg = 33 /\n"
                           "&search parameter = 'horizontal_coefficient', low = 0, high = 1 /\n")


@pytest.fixture(scope="module")
def arch(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """An arch that falls."""
    return compute(tmp_path_factory.mktemp("arch"), "&arch voussoirs = 36, thickness_ratio = 0.10 /\n")


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """The same arch as blocks, which a drawing could have."""
    folder = tmp_path_factory.mktemp("imported")
    angles, lines = np.radians(np.linspace(180.0, 0.0, 37)), []
    inner, outer = (radius * np.column_stack((np.cos(angles), np.sin(angles))) for radius in (9.5, 10.5))
    for n in range(36):
        lines += ["block", *(f"{x:.17g} {y:.17g}" for x, y in (inner[n + 1], outer[n + 1], outer[n], inner[n]))]
    for left, right in ((-10.5, -9.5), (9.5, 10.5)):
        lines += ["block fixed", f"{left} -1", f"{right} -1", f"{right} 0", f"{left} 0"]
    (folder / "arch.blocks").write_text("\n".join(lines) + "\n")
    return compute(folder, "&scene kind = 'blocks', geometry = 'arch.blocks' /\n&joint friction_deg = 50 /\n")


@pytest.mark.parametrize("width", [80, 160])
def test_pictures_are_as_wide_as_asked(arch, tmp_path: Path, width: int) -> None:
    words = ["plot", str(arch.folder), "--width", f"{width}mm", "--font", "8", "--format", "svg", "pdf", "png"]
    assert main([*words, "--out", str(tmp_path)]) == 0
    points = width / 25.4 * 72.0
    svg = re.search(r'width="([0-9.]+)pt"', (tmp_path / "case_1.svg").read_text())
    assert svg and float(svg[1]) == pytest.approx(points, abs=1e-3)
    box = re.search(rb"/MediaBox \[ 0 0 ([0-9.]+) ", (tmp_path / "case_1.pdf").read_bytes())
    assert box and float(box[1]) == pytest.approx(points, abs=1e-3)
    head = (tmp_path / "case_1.png").read_bytes()[16:20]
    assert int.from_bytes(head, "big") == pytest.approx(width / 25.4 * 300.0, abs=1.0)


@pytest.mark.parametrize("width", [80, 132, 160])
def test_all_stands_on_the_sheet_and_the_legend_is_lower_than_the_drawing(arch, pushed, width: int) -> None:
    for run in (arch, pushed):
        with house_style(8.0):
            figure = draw_case(run, 1, sheet=Sheet(width / 25.4))
        figure.draw_without_rendering()
        renderer = figure.canvas.get_renderer()
        axes, whole = figure.axes[0], figure.bbox
        drawing = axes.get_window_extent(renderer)
        legend = figure.legends[0].get_window_extent(renderer)
        title = figure._suptitle.get_window_extent(renderer)
        assert legend.height < drawing.height and legend.y1 <= drawing.y0 + 1.0
        assert title.y0 >= drawing.y1 - 1.0
        for box in (legend, title, axes.get_tightbbox(renderer)):
            assert box.x0 >= whole.x0 - 1.0 and box.x1 <= whole.x1 + 1.0
            assert box.y0 >= whole.y0 - 1.0 and box.y1 <= whole.y1 + 1.0


@pytest.mark.parametrize(("height", "width"), [(12, 80), (12, 40), (2, 40), (2, 80)])
def test_tall_drawings_have_their_legend_beside_where_there_is_room(tmp_path: Path, height: int, width: int) -> None:
    column = wall(0, 3, 1.0, 0.5, 1.0) + "".join(f"block\n1 {n}\n2 {n}\n2 {n + 1}\n1 {n + 1}\n" for n in range(height))
    (tmp_path / "column.blocks").write_text(column)
    run = compute(tmp_path, "&scene kind = 'blocks', geometry = 'column.blocks' /\n"
                            "&search parameter = 'horizontal_coefficient' /\n")
    with house_style(7.0):
        figure = draw_case(run, 1, sheet=Sheet(width / 25.4))
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    boxes = [figure.axes[0].get_tightbbox(renderer), figure.legends[0].get_window_extent(renderer),
             figure._suptitle.get_window_extent(renderer)]
    for number, box in enumerate(boxes):
        assert box.x0 >= -1.0 and box.x1 <= figure.bbox.x1 + 1.0
        assert box.y0 >= -1.0 and box.y1 <= figure.bbox.y1 + 1.0
        assert not any(box.shrunk(0.98, 0.98).overlaps(other) for other in boxes[:number])


def test_type_has_the_size_asked_for_and_legends_are_smaller(arch) -> None:
    with house_style(7.0):
        figure = draw_case(arch, 1, sheet=Sheet(80 / 25.4))
    assert figure._suptitle.get_fontsize() == 7.0
    assert all(text.get_fontsize() < 7.0 for text in figure.legends[0].get_texts())


def test_titles_and_legends_are_left_out(arch, tmp_path: Path) -> None:
    with house_style():
        figure = draw_case(arch, 1, sheet=Sheet(title=False, legend=False))
    assert figure._suptitle is None and not figure.legends
    words = ["plot", str(arch.folder), "--no-title", "--no-legend", "--forces", "--out", str(tmp_path),
             "--min-font", "6"]
    assert main(words) == 0


@pytest.mark.parametrize("word", ["80", "80 furlongs", "5mm", "4m", "0cm", "nanmm"])
def test_widths_without_a_unit_or_out_of_range_are_refused(arch, word: str, capsys) -> None:
    with pytest.raises(SystemExit):
        main(["plot", str(arch.folder), "--width", word])
    assert "must be a width from 25.4mm to 1016mm with its unit" in capsys.readouterr().err


def names(figure) -> str:
    """The legend of a figure."""
    return " | ".join(text.get_text().replace("\n", " ") for text in figure.legends[0].get_texts())


def test_contact_forces_are_left_out_beside_a_thrust_line_unless_asked_for(arch, imported) -> None:
    for run in (arch, imported):
        with house_style():
            assert "thrust line" in names(draw_case(run, 1)) and "forces" not in names(draw_case(run, 1))
            assert "contact forces" in names(draw_case(run, 1, with_forces=True))


def test_imported_arches_have_the_thrust_line_of_their_own(arch, imported) -> None:
    """Both are one arch: their lines go through the same points, to 3 mm of a ring of 1 m."""
    lines = []
    for run in (arch, imported):
        with house_style():
            axes = draw_case(run, 1).axes[0]
        (found,) = [part for part in axes.collections if isinstance(part, LineCollection)]
        points = np.vstack([path.vertices for path in found.get_paths()])
        lines.append(points[np.lexsort((points[:, 1].round(4), points[:, 0].round(4)))])
    assert len(lines[0]) == len(lines[1]) == 72
    assert lines[1] == pytest.approx(lines[0], abs=3e-3)


def test_hinges_stand_on_corners_of_the_displaced_blocks(arch) -> None:
    """A hinge stays where its two blocks touch: the same corner of both."""
    with house_style():
        axes = draw_case(arch, 1, magnify=0.4).axes[0]
    corners = np.vstack(scene_of(arch, 1).shapes(0.4))
    fixed = np.vstack([block.corners for block in scene_of(arch, 1).supports])
    marks = [line.get_xydata() for line in axes.lines if line.get_marker() in "os" and len(line.get_xydata())]
    assert sum(map(len, marks)) >= 5
    for mark in np.vstack(marks):
        assert np.hypot(*(np.vstack((corners, fixed)) - mark).T).min() < 0.02  # second order in the rotation


def test_points_go_with_their_blocks_exactly() -> None:
    """Displacements linear in place: those of a stretched, turned block, from tables of either place."""
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    law = np.array([[0.1, -0.2], [0.3, 0.05], [0.7, -0.4]])
    block = Block(3, "free", square, np.column_stack((square, np.ones(4))) @ law)
    point = np.array([[1.3, 0.4]])
    u = (np.array([1.3, 0.4, 1.0]) @ law)[None]
    for told in (0.0, 1.0):
        for shown in (0.0, 1.0, 2.5):
            motion = motion_of([block], [], shown, told)
            carried = motion.carried(point + told * u, np.array([3]))
            assert carried == pytest.approx(point + shown * u, abs=1e-12)
    assert motion_of([block], [], 1.0, 0.0).placed((1.3, 0.4)) == pytest.approx(tuple((point + u)[0]))
    assert motion_of([], [block], 1.0, 0.0).placed((1.3, 0.4)) == (1.3, 0.4)


def test_distances_from_polygons_are_those_of_geometry() -> None:
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    assert distance(square, np.array([1.0, 0.4])) == pytest.approx(-0.4)
    assert distance(square, np.array([5.0, 5.0])) == pytest.approx(5.0)
    assert distance(square, np.array([2.0, 0.5])) == pytest.approx(0.0)


def test_chains_go_from_support_to_support() -> None:
    first, second = np.array([9, 1, 2, 3]), np.array([1, 2, 3, 8])
    assert chain_pairs(first, second, {1, 2, 3}) == [(0, 1), (1, 2), (2, 3)]
    assert chain_pairs(first[:3], second[:3], {1, 2, 3}) == []  # a column
    assert chain_pairs(np.append(first, 2), np.append(second, 4), {1, 2, 3, 4}) == []  # a block rests on the middle
    assert chain_pairs(first[[0, 1]], np.array([1, 8]), {1}) == []  # one block between two supports


def test_many_marked_joints_are_told_by_the_colours_of_their_lines(pushed) -> None:
    joints = pushed.joints_of(1)
    slides = np.isfinite(joints["slides_x"])
    opens = np.isin(joints["mechanism"], ("hinge_intrados", "hinge_extrados", "open")) & ~slides
    assert (slides | opens).sum() > 40
    with house_style():
        figure = draw_case(pushed, 1)
    axes = figure.axes[0]
    assert not [line for line in axes.lines if line.get_marker() in "osD"]  # no symbols,
    assert not [text for text in axes.texts if getattr(text, "arrow_patch", None)]  # no arrows
    drawn = {tuple(part.get_color()[0][:3]): len(part.get_paths())
             for part in axes.collections if isinstance(part, LineCollection)}
    assert drawn[to_rgb(INK[2])] == 2 * slides.sum()  # both sides of each joint
    assert drawn[to_rgb(INK[0])] == 2 * opens.sum()
    assert "joint that slides" in names(figure) and "joint that opens" in names(figure)


def test_blocks_of_a_crowded_collapse_are_darker_the_further_they_move(pushed) -> None:
    with house_style():
        axes = draw_case(pushed, 1).axes[0]
    scene = scene_of(pushed, 1)
    far = np.array([np.hypot(*block.displacement.T).max() for block in scene.blocks])
    (shaded,) = [part for part in axes.collections
                 if isinstance(part, PolyCollection) and len(part.get_facecolor()) == len(far)]
    light = shaded.get_facecolor()[:, :3].sum(axis=1)
    order = np.argsort(far, kind="stable")
    assert np.all(np.diff(light[order]) <= 1e-12) and light.max() - light.min() > 0.5


def test_few_marked_joints_have_symbols(arch) -> None:
    with house_style():
        axes = draw_case(arch, 1).axes[0]
    assert [line for line in axes.lines if line.get_marker() in "os"]


def test_supports_and_held_blocks_are_hatched() -> None:
    run_folder = ROOT / "input" / "gallery"
    with house_style():
        figure = draw_file(run_folder / "wall.blocks")
    hatched = [part for part in figure.axes[0].collections if part.get_hatch()]
    assert len(hatched) == 1 and len(hatched[0].get_paths()) == 1


def test_files_of_blocks_are_drawn_without_a_run(tmp_path: Path, capsys) -> None:
    file = tmp_path / "wall.blocks"
    file.write_text(wall(3, 4, 1.0, 0.5, 1.0)
                    + "live 2 1.5 0 -1000\nfix 0.5 0.25 x\nbar 0.5 0.25 3.5 0.25 stiffness 1e6\n")
    with house_style():
        figure = draw_file(file, numbers=True)
    drawn = [path.vertices[:4] for part in figure.axes[0].collections for path in part.get_paths()]
    assert len(drawn) == 1 + 4 + 5 + 4
    areas = sorted(0.5 * abs(np.cross(shape, np.roll(shape, -1, axis=0)).sum()) for shape in drawn)
    assert areas == pytest.approx([0.25] * 2 + [0.5] * 11 + [3.0])
    assert "live load" in names(figure) and "bar" in names(figure) and "restraint along x" in names(figure)
    assert {"1", "14"} <= {text.get_text() for text in figure.axes[0].texts}
    assert main(["plot", str(file), "--out", str(tmp_path / "out"), "--width", "80mm", "--format", "png"]) == 0
    assert capsys.readouterr().out.split() == [str(tmp_path / "out" / "wall.png")]


def test_files_of_lines_are_drawn_as_the_blocks_that_they_cut(tmp_path: Path) -> None:
    text = "0.001\n6 2\n0\n2\n0\n0\n0\n0 0 4 0 1\n4 0 4 2 1\n4 2 0 2 1\n0 2 0 0 1\n2 -1 2 3 1\n0 1 1 1.5 1\n"
    (tmp_path / "x.geo").write_text(text + "0 0 4 0\n")
    geo = ROOT / "input" / "gallery" / "tunnel.geo"
    with house_style():
        figure = draw_file(geo)
    blocks = next(part for part in figure.axes[0].collections if isinstance(part, PolyCollection))
    count = run_dda("cut", geo).stdout
    total = sum(len(part.get_paths()) for part in figure.axes[0].collections if isinstance(part, PolyCollection))
    assert f", {total} blocks" in count and len(blocks.get_paths())
    assert "bar" in names(figure)
    ddaml = ROOT / "input" / "limerick" / "terrace_ddaml.geo"
    assert main(["plot", str(ddaml), "--out", str(tmp_path / "out")]) == 0


@pytest.mark.parametrize(("name", "text"), [("x.blocks", "block\n0 0\n1 0\nnonsense\n"), ("x.geo", "0.001\nno\n")])
def test_files_that_cannot_be_read_are_reported_by_the_program_itself(tmp_path, name, text, capsys) -> None:
    (tmp_path / name).write_text(text)
    assert main(["plot", str(tmp_path / name), "--out", str(tmp_path / "out")]) == 2
    assert re.match(re.escape(str(tmp_path / name)) + r":\d+: error: ", capsys.readouterr().err)
    assert not (tmp_path / "out").exists()


@pytest.fixture(scope="module")
def grid(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """Critical thicknesses over two keys."""
    return compute(
        tmp_path_factory.mktemp("grid"),
        "&search /\n&arch voussoirs = 12 /\n&output joints = .false. /\n"
        "&sweep parameter = 'half_angle_deg', first = 60, last = 90, count = 4 /\n"
        "&sweep parameter = 'load%horizontal_coefficient', first = 0, last = 0.1, count = 3 /\n")


def test_any_column_is_charted_against_any_swept_key(grid, tmp_path: Path) -> None:
    with house_style():
        axes = draw_sweep(grid, "arch%half_angle_deg", "steps").axes[0]
    assert len(axes.lines) == 3 and axes.get_ylabel() == "number of steps"
    for line, push in zip(axes.lines, (0.0, 0.05, 0.1)):
        rows = grid.cases.where(horizontal_coefficient=push)
        assert list(line.get_xdata()) == [60, 70, 80, 90]
        assert list(line.get_ydata()) == list(rows["steps"])
    words = ["plot", str(grid.folder), "--x", "half_angle_deg", "--width", "80mm", "--out", str(tmp_path)]
    assert main(words) == 0
    assert (tmp_path / "sweep_half_angle_deg.svg").exists()


def test_two_keys_are_a_map_with_contours(grid, tmp_path: Path) -> None:
    with house_style():
        axes, bar = draw_map(grid, ("horizontal_coefficient", "half_angle_deg")).axes
    field = axes.collections[0].get_array().reshape(4, 3)
    rows = grid.cases.where(half_angle_deg=80.0)
    assert list(field[2]) == list(rows["critical"])
    assert len(axes.collections) > 2 and bar.get_ylabel().startswith("critical thickness")
    assert main(["plot", str(grid.folder), "--map", "half_angle_deg", "horizontal_coefficient", "--y", "exact",
                 "--out", str(tmp_path), "--format", "png"]) == 0
    assert (tmp_path / "map_half_angle_deg_horizontal_coefficient_exact.png").exists()


def test_legend_beside_a_tower_ends_at_the_margin_of_a_png(tmp_path: Path) -> None:
    (tmp_path / "tower.blocks").write_text(
        "block fixed\n-1 -0.5\n2 -0.5\n2 0\n-1 0\nblock\n0 0\n1 0\n1 1.2\n0 1.2\n"
        "block\n0 1.2\n1 1.2\n0.8 2.2\n0.2 2.2\n")
    run = compute(tmp_path, "&scene kind = 'blocks', geometry = 'tower.blocks' /\n"
                            "&search parameter = 'horizontal_coefficient' /\n")
    with house_style(8):
        figure = draw_case(run, 1, sheet=Sheet(160 / 25.4))
        figure.set_dpi(EXACT_DPI)
        figure.canvas.draw()
        (legend,) = figure.legends
        ends = [text.get_window_extent().x1 for text in legend.get_texts()]
    assert figure.bbox.x1 - max(ends) == pytest.approx(EDGE * EXACT_DPI / 72.0, abs=1.0)


def test_contours_in_a_corner_of_a_map_have_no_overlapping_labels() -> None:
    field = np.add.outer(np.zeros(9), np.linspace(0.02, 0.2, 11))
    field[0, -1] = 1.0
    axes = Figure().subplots()
    draw_contours(axes, np.linspace(60.0, 110.0, 11), np.linspace(20.0, 60.0, 9), field)
    assert [text.get_text() for text in axes.texts] == ["0.15"]


def test_without_a_search_the_map_is_of_verdicts(tmp_path: Path) -> None:
    run = compute(
        tmp_path, "&sweep parameter = 'thickness_ratio', values = 0.08, 0.12 /\n"
                  "&sweep parameter = 'horizontal_coefficient', values = 0, 0.2 /\n")
    with house_style():
        axes = draw_map(run, ("thickness_ratio", "horizontal_coefficient")).axes[0]
    assert {text.get_text() for text in axes.get_legend().get_texts()} == {"stable", "collapsed"}
    with pytest.raises(ChartError, match="name it with --y COLUMN"):
        draw_sweep(run, "thickness_ratio")


def test_what_cannot_be_charted_is_reported(grid, capsys) -> None:
    for words, message in (
        (["--x", "radius"], "expected a swept number, one of horizontal_coefficient, half_angle_deg, got"),
        (["--x", "half_angle_deg", "--y", "verdict"], "expected a column of numbers, one of"),
        (["--map", "half_angle_deg", "half_angle_deg"], "got half_angle_deg twice"),
        (["--y", "steps"], "--y needs --x KEY or --map KEY KEY"),
    ):
        assert main(["plot", str(grid.folder), *words]) == 2
        assert message in capsys.readouterr().err
