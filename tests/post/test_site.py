"""The documentation site: one command, every page, every key, every public procedure."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).resolve().parents[2]
DDA = os.environ["DDA"]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built."""
    for package in ("mkdocs", "ford", "latex2mathml"):
        pytest.importorskip(package, reason=f"the site wants {package}: skipped")
    out = tmp_path_factory.mktemp("site")
    script = ROOT / "docs/site/build_site.py"
    done = subprocess.run([sys.executable, script, "--dda", DDA, "--out", out], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


def test_every_page_is_there(site: Path) -> None:
    pages = {path.stem for path in (ROOT / "docs").glob("*.md")} | {"index", "keys", "python", "modules", "tolerances"}
    assert pages <= {path.stem for path in site.glob("*.html")}


def test_formulas_end_no_paragraph(site: Path) -> None:
    text = (site / "theory.html").read_text(encoding="utf-8")
    assert text.count("<math") > 200
    assert re.findall(r"</p>\s*<math|</math>\s*<p>", text) == []


def test_no_list_or_table_is_shown_as_text(site: Path) -> None:
    """A paragraph has no line that begins with the mark of an item or a cell."""
    for page in sorted(site.glob("*.html")):
        paragraphs = re.findall(r"<p>(.*?)</p>", page.read_text(encoding="utf-8"), re.S)
        shown = [words for words in paragraphs if re.search(r"^(\* |- |\|)", words, re.M)]
        assert shown == [], page.name


def test_every_key_is_there(site: Path) -> None:
    text = (site / "keys.html").read_text(encoding="utf-8")
    help_text = subprocess.run([DDA, "help", "keys"], capture_output=True, text=True).stdout
    names = re.findall(r"^   (\w+)", help_text, flags=re.MULTILINE)
    assert len(names) > 40
    assert [name for name in names if f"<code>{name}</code>" not in text] == []


def test_every_public_procedure_is_there(site: Path) -> None:
    folder = site / "fortran"
    found = {path.stem.partition("~")[0] for kind in ("proc", "interface", "type") for path in
             (folder / kind).glob("*.html")}
    missing = []
    for source in sorted((ROOT / "src").rglob("*.f90")):
        text = re.sub(r"&\s*\n\s*&?", "", source.read_text(encoding="utf-8"))
        public = {
            name.strip()
            for names in re.findall(r"^ *public ::(.*)$", text, flags=re.M)
            for name in names.split(",")
        }
        named = re.findall(r"^ *(?:pure |elemental )*(?:subroutine|function) (\w+)", text, re.M)
        missing += [f"{source.name}: {name}" for name in named if name in public - found]
    assert len(found) > 150
    assert missing == []


class Links(HTMLParser):
    """Links of a page, and what can be linked to in it."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.targets: set[str] = set()
        self.links: list[str] = []
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what a tag links to."""
        for name, value in attrs:
            if value and name in ("id", "name"):
                self.targets.add(value)
            elif value and name in ("href", "src"):
                self.links.append(value)


def test_every_link_leads_somewhere(site: Path) -> None:
    pages = {page.resolve(): Links(page) for page in site.rglob("*.html")}
    broken = []
    for page, links in pages.items():
        for link in links.links:
            if re.match(r"[a-z]+:|//", link):
                continue
            place, _, anchor = link.partition("#")
            file = (page.parent / unquote(place.partition("?")[0])).resolve() if place else page
            if file.is_dir():
                file /= "index.html"
            # FORD's own anchors are its affair
            lost = anchor and page.parent == site.resolve() and file in pages and (
                unquote(anchor) not in pages[file].targets
            )
            if not file.exists() or lost:
                broken.append(f"{page.name}: {link}")
    assert len(pages) > 500
    assert broken == []


def test_formulas_are_drawn_and_no_network_is_wanted(site: Path) -> None:
    text = (site / "theory.html").read_text(encoding="utf-8")
    assert text.count("<math") > 250
    assert not re.search(r"\\(frac|alpha|eta|sqrt)", text)
    for page in site.glob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(r'<(?:script|link|img)[^>]+(?:src|href)="(?:https?:)?//', text), page.name


@pytest.mark.parametrize(("words", "page"), [
    ("newmark", "howto_slope.html"), ("friction_deg", "keys.html"), ("to_pandas", "python.html"), ("arch:", "arch"),
])
def test_search_finds_pages_that_are_opened_as_files(site: Path, tmp_path: Path, words: str, page: str) -> None:
    browser = shutil.which("chromium") or pytest.skip("no chromium")
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path}", "--timeout=20000"]
    logged = ["--enable-logging=stderr", "--dump-dom", f"{(site / 'search.html').as_uri()}?q={words}"]
    done = subprocess.run([browser, *options, *logged], capture_output=True, text=True)
    results = done.stdout.partition("mkdocs-search-results")[2].partition("</body>")[0]
    assert any(page in link for link in re.findall(r'<article><h3><a href="([^"]+)"', results)), results[:500]
    assert "CONSOLE" not in done.stderr  # no script fails


def test_missing_packages_are_reported(tmp_path: Path) -> None:
    script = ROOT / "docs/site/build_site.py"
    done = subprocess.run([sys.executable, "-S", "-E", script, "--out", tmp_path], capture_output=True, text=True)
    assert done.returncode == 2
    assert "expected the packages mkdocs, ford, latex2mathml" in done.stderr
