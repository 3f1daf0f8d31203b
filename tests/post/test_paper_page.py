"""The report of `voussoir paper`: complete, self-contained, and readable in a real browser."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("matplotlib", reason="figures want matplotlib")

from voussoir.dda_program import find_input  # noqa: E402
from voussoir_paper.campaign import Campaign  # noqa: E402

DECKS = find_input("paper")
FIGURES = [f"figure{number}" for number in range(1, 21)]


# the page


def test_page_names_every_table_and_figure(paper_page: str) -> None:
    for number in range(1, 5):
        assert f"Table {number}: " in paper_page
        assert f'id="table{number}"' in paper_page
    for name in FIGURES:
        assert f'id="{name}"' in paper_page
        assert f"Fig. {name[6:]}: " in paper_page
    assert "@@" not in paper_page


def test_page_holds_everything_itself(paper_page: str) -> None:
    sources = re.findall(r'(?:src|href|data)="([^"]*)"', paper_page)
    assert sources
    assert [s[:40] for s in sources if not s.startswith(("#", "data:"))] == []
    assert "url(http" not in paper_page and "@import" not in paper_page


def test_links_of_the_page_lead_somewhere(paper_page: str) -> None:
    names = re.findall(r'\bid="([^"]*)"', paper_page)
    assert len(names) == len(set(names))
    targets = re.findall(r'href="#([^"]*)"', paper_page) + re.findall(r"url\(#([^)]*)\)", paper_page)
    assert set(targets) <= set(names)


def test_page_shows_the_decks_as_they_are(paper_page: str) -> None:
    for deck in Campaign(DECKS, Path()).deck_files():
        assert html.escape(deck.read_text(encoding="utf-8")) in paper_page


def test_page_says_times_of_all_parts(paper_page: str) -> None:
    for deck in Campaign(DECKS, Path()).deck_files():
        assert re.search(rf"<td>{deck.stem}</td><td>\d+\.\d\d</td><td>\d+\.\d\d</td>", paper_page)


@pytest.mark.parametrize(
    "printed", ["+1.27", "+16.73", "+18.34", "+53.16", "+28.20", "+4.49", "+124.12", "+13.17", "+1.29", "+17.13"])
def test_percentages_are_those_that_the_paper_prints(paper_page: str, printed: str) -> None:
    assert f"({printed})</small>" in paper_page


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
def test_findings_hold_their_numbers(paper_page: str, words: str) -> None:
    assert words in paper_page


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
      svg => svg.getBoundingClientRect().width > 100 && svg.getBoundingClientRect().height > 60
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
def told(request, paper_page: str, tmp_path: Path) -> Iterator[dict]:
    """What a browser says about the page in a window of some width."""
    program = browser()
    if program is None:
        pytest.skip("no Chromium was found: the page was not tried in a browser")
    probe = tmp_path / "probe.html"
    probe.write_text(paper_page.replace("<head>", "<head>" + PROBE), encoding="utf-8")
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
    assert told["images"] == 5 and told["missing"] == 0
    assert told["rows"] == [8, 20, 15, 10]
    assert told["figures"] == 21


def test_page_fits_its_window(told: dict) -> None:
    assert told["width"] == told["asked"]
    assert told["page"] <= told["width"]
    assert told["wide"] == 0
    assert told["font"] >= 11.0


def test_digits_of_the_paper_are_kept_and_columns_that_repeat_are_dropped(paper_page: str) -> None:
    assert "<td>0.12540<small>" in paper_page  # Table 1, 90 blocks
    table2 = paper_page[paper_page.index('id="table2"'):paper_page.index('id="figure12"')]
    heads = re.findall(r'<th scope="col">(.*?)</th>', table2)
    assert heads[:4] == ["joint [deg]", "paper DDA", "ours, rigid", "ours, elastic"]
    assert not {"blocks", "&alpha; [deg]", "Heyman"} & set(heads)
    assert "-0.0000" not in paper_page


def test_a_picture_stands_at_the_top_and_animations_beside_their_figures(paper_page: str) -> None:
    assert 0 < paper_page.index('<figure id="top">') < paper_page.index('id="glance"')
    assert paper_page.count('<div class="pair">') == 4


def test_captions_have_the_paper_s_value_beside_ours(paper_page: str) -> None:
    for words in (
        "12 blocks: 0.10884 (0.10486), 90 blocks: 0.12540 (0.10745)",  # Fig. 11
        "54.5&deg;: 0.1123 (0.1075)",  # Fig. 13
        "59.0&deg;: 0.63585 (0.63487)",  # Fig. 16
        "45&deg;: 0.01680 (0.00749), 60&deg;: 0.03077 (0.02283)",  # Fig. 18
        "120&deg;: 65, 130&deg;: 65",  # Fig. 19
    ):
        assert words in paper_page
    assert paper_page.count('<span class="paper">') == 14
