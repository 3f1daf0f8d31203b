"""Pictures of results: what is drawn lies where mechanics puts it; every option; every refusal."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

np = pytest.importorskip("numpy")
pytest.importorskip("matplotlib", reason="figures want matplotlib")
pytest.importorskip("voussoir", reason="PYTHONPATH wants the build's python folder")

from voussoir import results  # noqa: E402
from voussoir.case_picture import draw_case, rounded, sliding  # noqa: E402
from voussoir.command_line import main  # noqa: E402
from voussoir.design_chart import ChartError, draw_chart, swept_columns  # noqa: E402
from voussoir.figure_style import house_style  # noqa: E402
from voussoir.joint_chain import (  # noqa: E402
    JointChain,
    chain_of,
    displaced,
    forces,
    outlines,
    thrust_points,
)

DDA = os.environ.get("DDA", "")
pytestmark = pytest.mark.skipif(not DDA, reason="DDA wants the name of the program")


def compute(folder: Path, text: str) -> results.Results:
    """Results of a deck."""
    (folder / "deck.nml").write_text(text)
    subprocess.run([DDA, "run", "deck.nml", "--quiet"], cwd=folder, check=True)
    return results.read(folder / "deck")


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


@pytest.mark.parametrize("case", [1, 2])
def test_line_of_thrust_lies_inside_the_joints(arches: results.Results, case: int) -> None:
    joints = arches.joints_of(case)
    chain = chain_of(joints)
    points = thrust_points(chain, joints)
    depth = np.linalg.norm(chain.extrados - chain.intrados, axis=1)
    height = np.einsum("ij,ij->i", points - chain.intrados, chain.outward) / depth
    assert np.all(height >= -1e-7) and np.all(height <= 1.0 + 1e-7)


def test_forces_drawn_carry_the_weight(arches: results.Results) -> None:
    joints = arches.joints_of(2)
    chain = chain_of(joints)
    blocks = outlines(chain, None)
    area = 0.0
    for x, y in (block.T for block in blocks):
        area += 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    vectors = forces(chain, joints)
    assert vectors[0] - vectors[-1] == pytest.approx([0.0, 2240.0 * 9.81 * area], abs=2e-4 * 1e6)
    assert vectors[0][1] == pytest.approx(-vectors[-1][1], rel=1e-6)
    assert vectors[0][0] > 0.0


def test_faceted_blocks_have_their_corners_on_two_circles(tmp_path: Path) -> None:
    run = compute(tmp_path, "&arch joints_deg = 0, 54.5, 90, facet_deg = 1, thickness_ratio = 0.2 /\n")
    with house_style():
        draw_case(run, 1)
    blocks = outlines(chain_of(run.joints_of(1)), 1.0)
    assert [len(block) for block in blocks] == [2 * (36 + 1), 2 * (55 + 1), 2 * (55 + 1), 2 * (36 + 1)]
    radii = np.linalg.norm(np.vstack(blocks), axis=1)
    assert np.all(np.minimum(abs(radii - 9.0), abs(radii - 11.0)) < 1e-12)


def test_chain_turns_a_block_about_its_hinge_exactly() -> None:
    """A block between two fixed joints turns by w about the intrados of the first."""
    spin = 1e-3
    intrados = np.array([[-1.0, 0.0], [1.0, 0.0]])
    extrados = intrados + [0.0, 0.5]
    up, right = np.array([[0.0, 1.0]] * 2), np.array([[1.0, 0.0]] * 2)
    chain = JointChain(intrados, extrados, up, right)

    def turn(point: np.ndarray) -> np.ndarray:
        x, y = point - intrados[0]
        return spin * np.array([-y, x])

    ends = turn(intrados[1]), turn(extrados[1])
    joints = {
        "opening_intrados": np.array([0.0, -ends[0][0]]),
        "opening_extrados": np.array([-0.5 * spin, -ends[1][0]]),
        "slip": np.array([0.0, -ends[0][1]]),
    }
    block = np.array([[-1.0, 0.0], [1.0, 0.0], [1.0, 0.5], [-1.0, 0.5]])
    moved = displaced(chain, joints, [block])
    assert moved is not None
    assert moved[0] == pytest.approx(np.array([turn(point) for point in block]), abs=1e-15)


def test_mechanism_of_a_fallen_arch_closes_and_its_crown_falls(arches: results.Results) -> None:
    joints = arches.joints_of(1)
    chain = chain_of(joints)
    blocks = outlines(chain, None)
    moved = displaced(chain, joints, blocks)
    assert moved is not None
    largest = max(np.abs(part).max() for part in moved)
    assert moved[17][1][1] < -0.5 * largest  # the crown's corner
    left, right = moved[9].mean(axis=0), moved[26].mean(axis=0)
    assert left == pytest.approx(right * [-1, 1], abs=1e-2 * largest)
    assert left[0] < 0.0  # the haunches go outwards


def test_elastic_motion_is_not_drawn_as_a_mechanism(arches: results.Results) -> None:
    joints = arches.joints_of(2)
    chain = chain_of(joints)
    assert displaced(chain, joints, outlines(chain, None)) is None


def test_joints_at_the_limit_of_friction_are_marked(searches: results.Results) -> None:
    marked = {}
    for row in searches.cases.rows():
        slides = np.flatnonzero(sliding(searches.joints_of(row["case"]), row))
        marked[row["half_angle_deg"], row["friction_deg"]] = set(slides)
        assert bool(len(slides)) == (row["collapse_mode"] == "mixed")
    # at 90 degrees friction of 21.2 degrees and less lets the springings slide outwards
    assert marked[90, 20] == marked[90, 21] == {0, 36}
    assert marked[90, 50] == set()


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
        texts = {}
        for magnify, with_forces in ((None, True), (1e-5, False), (0.0, False)):
            legend = draw_case(arches, 1, magnify, with_forces).legends[0]
            texts[magnify] = " | ".join(text.get_text() for text in legend.get_texts())
    assert "contact forces, longest 368.5 kN/m" in texts[None]
    assert "displacements × 1e-05" in texts[1e-5] and "forces" not in texts[1e-5]
    assert "displaced" not in texts[0.0]
    words = ["plot", str(arches.folder), "--out", str(tmp_path), "--magnify", "2", "--no-forces"]
    assert main(words) == 0


def test_chart_shows_critical_and_exact_values(searches, tmp_path: Path) -> None:
    assert swept_columns(searches.cases) == ["half_angle_deg", "friction_deg"]
    with house_style():
        axes = draw_chart(searches, "friction_deg").axes[0]
    points = [line for line in axes.lines if line.get_marker() != "None" and len(line.get_xdata())]
    assert [list(line.get_xdata()) for line in points] == [[20, 21, 50], [20, 21, 50]]
    lines = [line for line in axes.lines if line.get_marker() == "None" and len(line.get_xdata())]
    for line, marks in zip(lines, points):
        assert line.get_ydata() == pytest.approx(marks.get_ydata(), abs=1e-8)
    assert axes.get_xlabel().startswith("friction angle")
    assert axes.get_ylabel().startswith("critical thickness")
    assert main(["plot", str(searches.folder), "--chart", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "chart.svg").exists()


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
        (["--chart", "radius"], "wanted one of"),
        (["--chart"], "give the deck &search"),
    ],
)
def test_what_cannot_be_drawn_is_told(arches, words, message, capsys) -> None:
    assert main(["plot", str(arches.folder), *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{arches.folder}:1: error: ") and message in error


def test_folder_without_results_is_told(tmp_path: Path, capsys) -> None:
    for command in ("plot", "animate"):
        assert main([command, str(tmp_path)]) == 2
        assert "no results.csv" in capsys.readouterr().err


def test_folder_that_cannot_be_written_is_status_4(arches, tmp_path: Path, capsys) -> None:
    (tmp_path / "taken").write_text("a file")
    assert main(["plot", str(arches.folder), "--out", str(tmp_path / "taken")]) == 4
    assert "taken" in capsys.readouterr().err


def test_too_many_curves_are_refused(tmp_path: Path) -> None:
    run = compute(
        tmp_path,
        "&search /\n&output joints = .false. /\n"
        "&sweep parameter = 'half_angle_deg', first = 60, last = 90, count = 9 /\n"
        "&sweep parameter = 'friction_deg', values = 40, 50 /\n",
    )
    with pytest.raises(ChartError, match="at most 8 curves"):
        draw_chart(run, "friction_deg")


def test_motion_is_animated(motion: results.Results, tmp_path: Path, capsys) -> None:
    file = tmp_path / "fall.gif"
    assert main(["animate", str(motion.folder), "--case", "1", "--out", str(file)]) == 0
    assert file.read_bytes()[:6] == b"GIF89a"
    assert capsys.readouterr().out.strip() == str(file)


def test_results_without_frames_are_not_animated(arches, capsys) -> None:
    assert main(["animate", str(arches.folder)]) == 2
    assert "wanted frames of case 1, found none; give the deck" in capsys.readouterr().err
