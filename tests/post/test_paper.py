"""`voussoir paper` as a whole: results, tables, figures, and what may join or go wrong."""

from __future__ import annotations

import csv
import re
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from dda_command import rows_of

pytest.importorskip("matplotlib", reason="figures want matplotlib")

from voussoir import results, theory  # noqa: E402
from voussoir.command import main as command_line  # noqa: E402
from voussoir.dda_program import find_dda, find_input  # noqa: E402
from voussoir_paper import figures as paper_figures, report as paper_report, tables as paper_tables  # noqa: E402
from voussoir_paper.campaign import Campaign, Clock, Timing  # noqa: E402
from voussoir_paper.findings import exact_threshold, least_friction  # noqa: E402

DECKS = find_input("paper")
PAPER = paper_tables.read_table(DECKS / "paper_tables.csv")
EXACT = paper_tables.read_table(Path(__file__).parents[1] / "data" / "paper_exact.csv")
FIGURES = [f"figure{number}" for number in range(1, 21)]
NUMBERS = [24, 30, 36, 60, 72, 90, 108, 144, 180]


# section 3.1


def test_modes_change_from_sliding_to_turning(paper_folder: Path) -> None:
    cases = results.read(paper_folder / "figure8").cases
    assert cases["friction_deg"].tolist() == [0.0, 10.0, 20.0, 30.0]
    assert set(cases["verdict"]) == {"collapsed"}
    assert cases["collapse_mode"].tolist() == ["sliding", "mixed", "mixed", "rotational"]
    share = cases["sliding_share"]
    assert share[0] == pytest.approx(1.0, abs=1e-5)
    assert 0.5 < share[1] < 1.0 and 0.0 < share[2] < share[1]
    assert share[3] == 0.0


def test_thresholds_of_friction_are_exact(paper_folder: Path) -> None:
    lower = results.read(paper_folder / "figure8_lower").cases
    for blocks, angle, known in zip(lower["blocks"], lower["critical"], (0.308988, 0.309053, 0.309199)):
        assert np.tan(np.radians(angle)) == pytest.approx(known, abs=1e-6)
        assert angle == pytest.approx(exact_threshold(int(blocks), 0.3), rel=1e-8)
    upper = results.read(paper_folder / "figure8_upper").cases
    assert np.tan(np.radians(upper["critical"][0])) == pytest.approx(0.3956, abs=5e-5)
    assert upper["critical"][0] == pytest.approx(exact_threshold(36, 0.107424139), rel=1e-8)
    assert upper["critical"][0] == pytest.approx(least_friction(36, alpha=np.pi / 2), rel=1e-7)


def test_critical_thickness_follows_friction_exactly(paper_folder: Path) -> None:
    cases = results.read(paper_folder / "figure8_thickness").cases
    exact = theory.discrete_critical(36, np.pi / 2, friction=np.radians(cases["friction_deg"]))
    assert cases["critical"] == pytest.approx(exact, rel=1e-8)
    upper = results.read(paper_folder / "figure8_upper").cases["critical"][0]
    for angle, mode in zip(cases["friction_deg"], cases["collapse_mode"]):
        assert mode == ("rotational" if angle > upper else "mixed")


# section 3.2


def test_rigid_arches_stand_where_statics_says_so(paper_folder: Path) -> None:
    cases = results.read(paper_folder / "figure10").cases
    assert cases["blocks"].tolist() == NUMBERS * 2
    exact = theory.discrete_critical(cases["blocks"], np.pi / 2)
    wanted = np.where(cases["thickness_ratio"] > exact, "stable", "collapsed")
    assert cases["verdict"].tolist() == wanted.tolist()
    assert cases.where(verdict="stable")["blocks"].tolist() == [24, 30, 36]


def test_haunches_turn_at_the_joint_nearest_to_theory_or_the_next(paper_folder: Path) -> None:
    wanted = {24: 52.5, 30: 54, 36: 55, 60: 54, 72: 55, 90: 54, 108: 55, 144: 55}
    cases = results.read(paper_folder / "figure10").cases.where(verdict="collapsed")
    for row in cases.rows():
        (hinge,) = row["intrados_hinge_deg"]
        if row["blocks"] == 180:
            assert hinge in (54.0, 55.0)
        else:
            assert hinge == wanted[row["blocks"]]
    heyman = cases.where(blocks=180, thickness_ratio=0.105965)
    assert heyman["intrados_hinge_deg"][0] == (55.0,)


# sections 3.3 to 3.5


@pytest.mark.parametrize("name", list(paper_tables.TITLES))
def test_every_row_has_every_column(paper_folder: Path, name: str) -> None:
    rows = rows_of(paper_folder / "tables" / f"{name}.csv")
    exact = [row for row in EXACT if row["table"] == name]
    printed = [row for row in PAPER if row["table"] == name]
    assert len(rows) == len(exact) == len(printed)
    for row, known, paper in zip(rows, exact, printed):
        eta = float(known["eta_exact"])
        assert float(row["half_angle_deg"]) == float(known["alpha_deg"])
        assert float(row["paper_dda"]) == float(paper["eta_dda"])
        assert float(row["exact"]) == pytest.approx(eta, rel=1e-12)
        assert float(row["ours_rigid"]) == pytest.approx(eta, rel=1e-8)
        assert abs(float(row["ours_rigid_error"])) <= 1e-8
        assert 0.0 < float(row["ours_elastic_error"]) < 0.05
        assert [float(row[f"ours_{kind}_hinge_deg"]) for kind in ("rigid", "elastic")] == [
            float(known["intrados_hinge_deg"])
        ] * 2
        for column in ("paper_dda", "milankovitch", "ccr", "heyman"):
            assert float(row[f"{column}_error"]) == pytest.approx(float(row[column]) / eta - 1.0)


def test_hinges_of_table_4_are_the_papers(paper_folder: Path) -> None:
    hinges = [float(row["ours_rigid_hinge_deg"]) for row in rows_of(paper_folder / "tables" / "table4.csv")]
    assert hinges == [30, 40, 45, 55, 60, 60, 65, 65, 60, 50]


def test_tables_in_markdown_have_a_line_an_arch(paper_folder: Path) -> None:
    lines = (paper_folder / "tables" / "tables.md").read_text().splitlines()
    assert sum(line.startswith("| ") for line in lines) == 53 + 2 * 4
    assert sum(line.startswith("## Table ") for line in lines) == 4


def test_second_run_changes_no_number(paper_folder: Path, tmp_path: Path) -> None:
    campaign = Campaign(DECKS, tmp_path)
    clock = Clock(lambda line: None, {})
    assert campaign.run(find_dda(), clock, 1, slow=False, resume=False) == 0
    for deck in campaign.deck_files():
        for name in ("results.csv", "joints.csv", "frames.csv", "frame_joints.csv"):
            first, second = (_numbers(out / deck.stem / name) for out in (paper_folder, tmp_path))
            assert first == second, f"{deck.stem}/{name}"


def _numbers(file: Path) -> list[str]:
    """Lines of a table, wall times left out; none where there is no such table."""
    if not file.exists():
        return []
    lines = file.read_text().splitlines()
    if file.name == "results.csv":
        place = lines[0].split(",").index("seconds")
        lines = [line.split(",")[:place] + line.split(",")[place + 1 :] for line in lines]
    return sorted(lines)


# figures


@pytest.mark.parametrize("name", [*FIGURES, "figure8_friction"])
def test_figure_is_there_in_both_formats(paper_folder: Path, name: str) -> None:
    ET.parse(paper_folder / "figures" / f"{name}.svg")
    assert (paper_folder / "figures" / f"{name}.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize("name", ["animation8", "animation13", "animation16", "animation18"])
def test_animation_moves(paper_folder: Path, name: str) -> None:
    image = pytest.importorskip("PIL.Image")
    with image.open(paper_folder / "figures" / f"{name}.gif") as gif:
        assert gif.n_frames > 10
        first = np.asarray(gif.convert("L"), dtype=int)
        gif.seek(gif.n_frames - 1)
        last = np.asarray(gif.convert("L"), dtype=int)
    assert np.abs(first - last).max() > 100


@pytest.mark.parametrize("deck", ["figure8", "figure9", "figure12", "figure15", "figure18"])
def test_pictures_open_in_paraview(paper_folder: Path, deck: str) -> None:
    run = results.read(paper_folder / deck)
    for number in run.cases["case"]:
        index = run.pvd(number)
        assert index is not None
        for entry in ET.parse(index).iter("DataSet"):
            assert (index.parent / entry.attrib["file"]).is_file()


# what may go wrong, and what joins later


def test_missing_program_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status = command_line.main(["paper", "--out", str(tmp_path), "--dda", str(tmp_path / "dda")])
    assert status == 2
    assert "expected the program dda" in capsys.readouterr().err


def test_missing_decks_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status = command_line.main(["paper", "--out", str(tmp_path), "--decks", str(tmp_path)])
    assert status == 2
    assert "no decks" in capsys.readouterr().err


def test_folder_that_cannot_be_written_gives_4(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert command_line.main(["paper", "--out", str(tmp_path / "file"), "--quiet"]) == 4


def test_column_joins_by_a_deck_alone(paper_folder: Path, tmp_path: Path) -> None:
    decks, out = tmp_path / "decks", tmp_path / "out"
    shutil.copytree(DECKS, decks)
    shutil.copytree(paper_folder, out)
    text = (DECKS / "table1.nml").read_text()
    (decks / "table1_limerick.nml").write_text(text)
    (out / "table1_limerick").mkdir()
    rows = [row for row in rows_of(out / "table1" / "results.csv") if row["geometry"] == "current"]
    with (out / "table1_limerick" / "results.csv").open("w", newline="") as lines:
        writer = csv.DictWriter(lines, rows[0].keys())
        writer.writeheader()
        for number, row in enumerate(rows, 1):
            found = number > 1
            writer.writerow(
                row
                | {
                    "case": number,
                    "mode": "limerick",
                    "critical": "0.11" if found else "",
                    "relative_error": "",
                    "verdict": "found" if found else "undecided",
                }
            )
    campaign = Campaign(decks, out)
    table = campaign.tables["table1"]
    assert table.columns[3] == "Limerick mode"
    assert table.rows[0].values["Limerick mode"].eta is None
    assert table.rows[1].values["Limerick mode"].eta == 0.11
    axes = paper_figures.FIGURES["figure11"](campaign).axes[0]
    assert "Limerick mode" in [line.get_label() for line in axes.lines]
    page = paper_report.build(campaign, out / "figures", [], find_dda())
    assert '<th scope="col">Limerick mode</th>' in page
    assert "undecided" in page
    assert "table1_limerick.nml" in page
    assert "7 of 8 arches were found" in page


def test_slow_decks_run_on_demand_only(tmp_path: Path) -> None:
    shutil.copytree(DECKS, tmp_path / "decks")
    (tmp_path / "decks" / "table1_limerick.nml").write_text((DECKS / "table1.nml").read_text())
    campaign = Campaign(tmp_path / "decks", tmp_path)
    quick, all_decks = campaign.deck_files(), campaign.deck_files(slow=True)
    assert set(quick) < set(all_decks)
    slow = {path.name for path in set(all_decks) - set(quick)}
    assert slow == {path.name for path in (tmp_path / "decks").glob("*_limerick.nml")}
    assert [file.stem for file in quick][:4] == ["table1", "table2", "table3", "table4"]


def test_progress_says_the_time_left() -> None:
    told: list[str] = []
    clock = Clock(told.append, {"one": 1.0, "two": 3.0})
    for part in ("one", "two"):
        clock.record(Timing(part, 0.0, 0.0))
    assert re.fullmatch(r"\[1/2\] one: \d+\.\d s, about \d+ s left", told[0])
    assert re.fullmatch(r"\[2/2\] two: \d+\.\d s", told[1])
