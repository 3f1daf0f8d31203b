"""`voussoir paper` as a whole: results, tables, figures and the page, in a real browser too."""

from __future__ import annotations

import csv
import html
import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("voussoir", reason="PYTHONPATH wants the build's python folder")
pytest.importorskip("matplotlib", reason="figures want matplotlib")

from voussoir import (  # noqa: E402
    command_line,
    paper_figures,
    paper_report,
    paper_tables,
    results,
    theory,
)
from voussoir.paper_campaign import Campaign, Clock, find_dda, find_decks  # noqa: E402
from voussoir.paper_findings import exact_threshold, least_friction  # noqa: E402

DECKS = find_decks()
PAPER = paper_tables.read_table(DECKS / "paper_tables.csv")
EXACT = paper_tables.read_table(Path(__file__).parents[1] / "data" / "paper_exact.csv")
FIGURES = [f"figure{number}" for number in range(1, 21)]
NUMBERS = [24, 30, 36, 60, 72, 90, 108, 144, 180]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The whole campaign, run once."""
    out = tmp_path_factory.mktemp("paper")
    assert command_line.main(["paper", "--out", str(out), "--quiet"]) == 0
    return out


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    """The report."""
    return (folder / "index.html").read_text(encoding="utf-8")


# section 3.1


def test_modes_change_from_sliding_to_turning(folder: Path) -> None:
    cases = results.read(folder / "figure8").cases
    assert cases["friction_deg"].tolist() == [0.0, 10.0, 20.0, 30.0]
    assert set(cases["verdict"]) == {"collapsed"}
    assert cases["collapse_mode"].tolist() == ["sliding", "mixed", "mixed", "rotational"]
    share = cases["sliding_share"]
    assert share[0] == pytest.approx(1.0, abs=1e-5)
    assert 0.5 < share[1] < 1.0 and 0.0 < share[2] < share[1]
    assert share[3] == 0.0


def test_thresholds_of_friction_are_exact(folder: Path) -> None:
    lower = results.read(folder / "figure8_lower").cases
    for blocks, angle, known in zip(lower["blocks"], lower["critical"], (0.308988, 0.309053, 0.309199)):
        assert np.tan(np.radians(angle)) == pytest.approx(known, abs=1e-6)
        assert angle == pytest.approx(exact_threshold(int(blocks), 0.3), rel=1e-8)
    upper = results.read(folder / "figure8_upper").cases
    assert np.tan(np.radians(upper["critical"][0])) == pytest.approx(0.3956, abs=5e-5)
    assert upper["critical"][0] == pytest.approx(exact_threshold(36, 0.107424139), rel=1e-8)
    assert upper["critical"][0] == pytest.approx(least_friction(36, alpha=np.pi / 2), rel=1e-7)


def test_critical_thickness_follows_friction_exactly(folder: Path) -> None:
    cases = results.read(folder / "figure8_thickness").cases
    exact = theory.discrete_critical(36, np.pi / 2, friction=np.radians(cases["friction_deg"]))
    assert cases["critical"] == pytest.approx(exact, rel=1e-8)
    upper = results.read(folder / "figure8_upper").cases["critical"][0]
    for angle, mode in zip(cases["friction_deg"], cases["collapse_mode"]):
        assert mode == ("rotational" if angle > upper else "mixed")


# section 3.2


def test_rigid_arches_stand_where_statics_says_so(folder: Path) -> None:
    cases = results.read(folder / "figure10").cases
    assert cases["blocks"].tolist() == NUMBERS * 2
    exact = theory.discrete_critical(cases["blocks"], np.pi / 2)
    wanted = np.where(cases["thickness_ratio"] > exact, "stable", "collapsed")
    assert cases["verdict"].tolist() == wanted.tolist()
    assert cases.where(verdict="stable")["blocks"].tolist() == [24, 30, 36]


def test_haunches_turn_at_the_joint_nearest_to_theory_or_the_next(folder: Path) -> None:
    wanted = {24: 52.5, 30: 54, 36: 55, 60: 54, 72: 55, 90: 54, 108: 55, 144: 55}
    cases = results.read(folder / "figure10").cases.where(verdict="collapsed")
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
def test_every_row_has_every_column(folder: Path, name: str) -> None:
    with (folder / "tables" / f"{name}.csv").open(newline="") as lines:
        rows = list(csv.DictReader(lines))
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


def test_hinges_of_table_4_are_the_papers(folder: Path) -> None:
    with (folder / "tables" / "table4.csv").open(newline="") as lines:
        hinges = [float(row["ours_rigid_hinge_deg"]) for row in csv.DictReader(lines)]
    assert hinges == [30, 40, 45, 55, 60, 60, 65, 65, 60, 50]


def test_tables_in_markdown_have_a_line_an_arch(folder: Path) -> None:
    lines = (folder / "tables" / "tables.md").read_text().splitlines()
    assert sum(line.startswith("| ") for line in lines) == 53 + 2 * 4
    assert sum(line.startswith("## Table ") for line in lines) == 4


def test_second_run_changes_no_number(folder: Path, tmp_path: Path) -> None:
    campaign = Campaign(DECKS, tmp_path)
    clock = Clock(lambda line: None, {})
    assert campaign.run(find_dda(), clock, 1, slow=False, resume=False) == 0
    for deck in campaign.deck_files():
        for name in ("results.csv", "joints.csv", "frames.csv", "frame_joints.csv"):
            first, second = (_numbers(out / deck.stem / name) for out in (folder, tmp_path))
            assert first == second, f"{deck.stem}/{name}"


def _numbers(file: Path) -> list[str]:
    """Lines of a table, wall times left out; none where there is no such table."""
    if not file.exists():
        return []
    lines = file.read_text().splitlines()
    if file.name == "results.csv":
        lines = [line.rpartition(",")[0] for line in lines]
    return sorted(lines)


# figures


@pytest.mark.parametrize("name", [*FIGURES, "figure8_friction"])
def test_figure_is_there_in_both_formats(folder: Path, name: str) -> None:
    ET.parse(folder / "figures" / f"{name}.svg")
    assert (folder / "figures" / f"{name}.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize("name", ["animation8", "animation13", "animation16", "animation18"])
def test_animation_moves(folder: Path, name: str) -> None:
    image = pytest.importorskip("PIL.Image")
    with image.open(folder / "figures" / f"{name}.gif") as gif:
        assert gif.n_frames > 10
        first = np.asarray(gif.convert("L"), dtype=int)
        gif.seek(gif.n_frames - 1)
        last = np.asarray(gif.convert("L"), dtype=int)
    assert np.abs(first - last).max() > 100


@pytest.mark.parametrize("deck", ["figure8", "figure9", "figure12", "figure15", "figure18"])
def test_pictures_open_in_paraview(folder: Path, deck: str) -> None:
    run = results.read(folder / deck)
    for number in run.cases["case"]:
        index = run.pvd(number)
        assert index is not None
        for entry in ET.parse(index).iter("DataSet"):
            assert (index.parent / entry.attrib["file"]).is_file()


# the page


def test_page_names_every_table_and_figure(page: str) -> None:
    for number in range(1, 5):
        assert f"Table {number}: " in page
        assert f'id="table{number}"' in page
    for name in FIGURES:
        assert f'id="{name}"' in page
        assert f"Fig. {name[6:]}: " in page
    assert "@@" not in page


def test_page_holds_everything_itself(page: str) -> None:
    sources = re.findall(r'(?:src|href|data)="([^"]*)"', page)
    assert sources
    assert [s[:40] for s in sources if not s.startswith(("#", "data:"))] == []
    assert "url(http" not in page and "@import" not in page


def test_links_of_the_page_lead_somewhere(page: str) -> None:
    names = re.findall(r'\bid="([^"]*)"', page)
    assert len(names) == len(set(names))
    targets = re.findall(r'href="#([^"]*)"', page) + re.findall(r"url\(#([^)]*)\)", page)
    assert set(targets) <= set(names)


def test_page_shows_the_decks_as_they_are(page: str) -> None:
    for deck in Campaign(DECKS, Path()).deck_files():
        assert html.escape(deck.read_text(encoding="utf-8")) in page


def test_page_tells_times_of_all_parts(page: str) -> None:
    for deck in Campaign(DECKS, Path()).deck_files():
        assert re.search(rf"<td>{deck.stem}</td><td>\d+\.\d\d</td><td>\d+\.\d\d</td>", page)


@pytest.mark.parametrize(
    "words",
    [
        "86 need less than the continuous arch",
        "The hinges of Table 4 are the paper&#x27;s in 10 of 10 rows",
        "Rigid arches of 24, 30, 36 blocks and elastic arches of 24 blocks stand there",
        "arch of 140 degrees stands at no thickness",
        "arch of 145 degrees stands at no thickness",
        "by 3.8 % at 12 blocks and by 16.7 % at 90",
        "It matters at 45 degrees (0.77 %)",
    ],
)
def test_findings_hold_their_numbers(page: str, words: str) -> None:
    assert words in page


# a real browser

PROBE = """<script>
window.addEventListener('error', event => { window.failed = (window.failed || 0) + 1; }, true);
window.addEventListener('load', () => {
  const wide = [...document.querySelectorAll('body *')].filter(
    part => !part.closest('.wide') && !part.closest('pre')
      && part.getBoundingClientRect().right > innerWidth + 1);
  const font = part => parseFloat(getComputedStyle(part).fontSize);
  const told = {
    failed: window.failed || 0,
    images: document.images.length,
    missing: [...document.images].filter(image => !(image.complete && image.naturalWidth)).length,
    rows: ['table1', 'table2', 'table3', 'table4'].map(
      name => document.querySelectorAll('#' + name + ' tbody tr').length),
    figures: [...document.querySelectorAll('figure svg')].filter(
      svg => svg.getBoundingClientRect().width > 100 && svg.getBoundingClientRect().height > 100
    ).length,
    width: innerWidth,
    page: document.documentElement.scrollWidth,
    wide: wide.length,
    font: Math.min(...[...document.querySelectorAll('p, td, th, li, figcaption')].map(font)),
  };
  document.body.innerHTML = '<pre id="told">' + JSON.stringify(told) + '</pre>';
});
</script>"""


def browser() -> str | None:
    """The Chromium of this machine."""
    names = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
    return next((path for path in map(shutil.which, names) if path), None)


@pytest.fixture(params=[1280, 390])
def told(request, folder: Path, page: str, tmp_path: Path) -> Iterator[dict]:
    """What a browser says about the page in a window of some width."""
    program = browser()
    if program is None:
        pytest.skip("no Chromium was found: the page was not tried in a browser")
    probe = tmp_path / "probe.html"
    probe.write_text(page.replace("<head>", "<head>" + PROBE), encoding="utf-8")
    # a frame is as narrow as it is told to be, a window is not
    outer = tmp_path / "outer.html"
    outer.write_text(
        f'<iframe src="probe.html" width="{request.param}" height="900" style="border:0"></iframe>'
        "<script>addEventListener('load', () => { document.title = 'x';"
        "document.body.append(document.querySelector('iframe').contentDocument"
        ".getElementById('told')); })</script>"
    )
    command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking"]
    command += ["--allow-file-access-from-files", f"--user-data-dir={tmp_path / 'profile'}"]
    command += ["--window-size=1400,1000", "--dump-dom", outer.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    found = re.search(r'<pre id="told">(.*?)</pre>', done.stdout)
    assert found, done.stderr[-2000:]
    yield {**json.loads(html.unescape(found.group(1))), "asked": request.param}


def test_browser_shows_the_whole_page(told: dict) -> None:
    assert told["failed"] == 0
    assert told["images"] == 4 and told["missing"] == 0
    assert told["rows"] == [8, 20, 15, 10]
    assert told["figures"] == 21


def test_page_fits_its_window(told: dict) -> None:
    assert told["width"] == told["asked"]
    assert told["page"] <= told["width"]
    assert told["wide"] == 0
    assert told["font"] >= 11.0


# what may go wrong, and what joins later


def test_missing_program_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status = command_line.main(["paper", "--out", str(tmp_path), "--dda", str(tmp_path / "dda")])
    assert status == 2
    assert "dda was not found" in capsys.readouterr().err


def test_missing_decks_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status = command_line.main(["paper", "--out", str(tmp_path), "--decks", str(tmp_path)])
    assert status == 2
    assert "no decks" in capsys.readouterr().err


def test_folder_that_cannot_be_written_gives_4(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert command_line.main(["paper", "--out", str(tmp_path / "file"), "--quiet"]) == 4


def test_column_joins_by_a_deck_alone(folder: Path, tmp_path: Path) -> None:
    decks, out = tmp_path / "decks", tmp_path / "out"
    shutil.copytree(DECKS, decks)
    shutil.copytree(folder, out)
    text = (DECKS / "table1.nml").read_text()
    (decks / "table1_limerick.nml").write_text(text)
    (out / "table1_limerick").mkdir()
    with (out / "table1" / "results.csv").open(newline="") as lines:
        rows = [row for row in csv.DictReader(lines) if row["geometry"] == "current"]
    with (out / "table1_limerick" / "results.csv").open("w", newline="") as lines:
        writer = csv.DictWriter(lines, rows[0].keys())
        writer.writeheader()
        for number, row in enumerate(rows, 1):
            found = number > 1
            writer.writerow(
                row
                | {"case": number, "mode": "limerick", "critical": "0.11" if found else "",
                   "relative_error": "", "verdict": "found" if found else "undecided"}
            )
    campaign = Campaign(decks, out)
    table = campaign.tables["table1"]
    assert table.columns[3] == "Limerick mode"
    assert table.rows[0].values["Limerick mode"].eta is None
    assert table.rows[1].values["Limerick mode"].eta == 0.11
    axes = paper_figures.FIGURES["figure11"](campaign).axes[0]
    assert "Limerick mode" in [line.get_label() for line in axes.lines]
    page = paper_report.build(campaign, out / "figures", [], find_dda())
    assert "<th scope=\"col\">Limerick mode</th>" in page
    assert "undecided" in page
    assert "table1_limerick.nml" in page
    assert "7 of 8 arches were found" in page


def test_slow_decks_run_on_demand_only(tmp_path: Path) -> None:
    shutil.copytree(DECKS, tmp_path / "decks")
    (tmp_path / "decks" / "table1_limerick.nml").write_text((DECKS / "table1.nml").read_text())
    campaign = Campaign(tmp_path / "decks", tmp_path)
    quick, all_decks = campaign.deck_files(), campaign.deck_files(slow=True)
    assert len(all_decks) == len(quick) + 1
    assert [file.stem for file in quick][:4] == ["table1", "table2", "table3", "table4"]


def test_progress_tells_the_time_left() -> None:
    told: list[str] = []
    clock = Clock(told.append, {"one": 1.0, "two": 3.0})
    for part in ("one", "two"):
        with clock.part(part):
            pass
    assert re.fullmatch(r"\[1/2\] one: \d+\.\d s, about \d+ s left", told[0])
    assert re.fullmatch(r"\[2/2\] two: \d+\.\d s", told[1])
