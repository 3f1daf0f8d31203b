#!/usr/bin/env python3
"""Build the documentation site: `python3 docs/site/build_site.py --dda build/bin/dda --out build/site`.

The pages of docs/, the deck's keys as the program tells them, and the interfaces of every public
Fortran procedure (by FORD) and Python function (from their docstrings), by MkDocs.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import source_pages
from python_page import python_page

ROOT = Path(__file__).resolve().parents[2]
#: Pages in the order of the menu, by chapter; others of docs/ follow
CHAPTERS = {
    "Start": {
        "index.md": "Overview",
        "getting-started.md": "Getting started",
        "tutorial.md": "Tutorial",
        "gallery.md": "Gallery",
        "installation.md": "Installation",
    },
    "User guide": {
        "howto.md": "All tasks",
        "howto_arches.md": "Arches",
        "howto_bridges.md": "Bridges",
        "howto_blocks.md": "Blocks",
        "howto_drawings.md": "Drawings",
        "howto_motion.md": "Motion and earthquakes",
        "howto_tunnel.md": "Tunnels",
        "howto_slope.md": "Slopes",
        "howto_studies.md": "Studies and campaigns",
        "howto_figures.md": "Figures",
        "howto_python.md": "Python",
        "howto_fortran.md": "Fortran",
        "modelling.md": "Modelling choices",
        "glossary.md": "Glossary",
    },
    "Reference": {
        "input.md": "The input deck",
        "joint_map.md": "The joint map",
        "keys.md": "Every key",
        "tables.md": "Tables and columns",
        "messages.md": "Messages",
        "limerick.md": "Limerick models",
        "python.md": "Python interfaces",
        "fortran/index.html": "Fortran interfaces",
    },
    "Theory": {
        "theory.md": "Analytic solutions", "method.md": "Method", "limits.md": "Limits", "paper.md": "The paper"},
    "Verification": {
        "validation.md": "Verification manual",
        "performance.md": "Performance and accuracy",
    },
    "Developers": {
        "contributing.md": "Contributing",
        "architecture.md": "Architecture",
        "testing.md": "Testing",
        "modules.md": "Modules",
        "tolerances.md": "Tolerances",
        "shi.md": "Shi's routines",
    },
}
#: Formulas in a line that are longer than so many characters of TeX scroll on narrow screens
LONG = 30
#: Packages that build the site
PACKAGES = ("mkdocs", "ford", "latex2mathml")
#: What the theme lacks: room for tables, which wrap, and names that break where they must
STYLE = """.wy-nav-content { max-width: 1060px; }
.wy-table-responsive table td, .wy-table-responsive table th { white-space: normal; }
.wy-table-responsive table { min-width: 100%; }
.wy-table-responsive td code { white-space: normal; overflow-wrap: normal; }
.rst-content h2, .rst-content h3, .rst-content h3 code, .rst-content p code, .rst-content li code
{ white-space: normal; overflow-wrap: anywhere; }
.rst-content img { background: #fff; max-width: 100%; max-height: 44rem; width: auto; height: auto; }
.rst-content p:has(img + img) { display: grid; gap: 1em;
grid-template-columns: repeat(auto-fit, minmax(min(100%, 24rem), 1fr)); }
pre code.language-message { white-space: pre-wrap; }
math { font-size: 1.1em; }
span.formula { display: inline-block; max-width: 100%; overflow-x: auto; vertical-align: middle; }
td span.formula { display: inline; }
.formula.shown { display: block; overflow-x: auto; padding: 0.4em 0; margin-bottom: 1em; }
@media screen and (max-width: 768px) { .wy-table-responsive table:has(th:nth-child(4)) { min-width: 44rem; } }
@media (min-width: 769px), print {
.rst-content .wy-table-responsive table td, .rst-content .wy-table-responsive table th { padding: 6px 8px; }
.wy-table-responsive td:last-child code { overflow-wrap: anywhere; }
pre code { white-space: pre-wrap !important; } }
@media print {
.rst-content .wy-table-responsive, .rst-content pre, .rst-content .formula
{ overflow: visible !important; max-width: none; }
.rst-content span.formula:not(.shown) { display: inline; }
.rst-content .wy-table-responsive table { min-width: 0; width: 100%; font-size: 70%; }
.rst-content .wy-table-responsive table td, .rst-content .wy-table-responsive table th
{ padding: 2px 4px !important; font-size: inherit; }
.rst-content .wy-table-responsive td code { white-space: normal !important; overflow-wrap: anywhere; font-size: 90%; }
.rst-content .wy-table-responsive td:first-child code { overflow-wrap: normal; }
.rst-content p:has(img + img) { grid-template-columns: 1fr 1fr; }
.rst-content p:has(+ p > img) { break-after: avoid; }
.rst-content tr, .rst-content img { break-inside: avoid; } }
"""


def main() -> int:
    """Build the site; 0 if that went well, 2 if a package is missing, else MkDocs' or FORD's status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dda", type=Path, default=ROOT / "build/bin/dda", help="the program")
    parser.add_argument("--out", type=Path, default=ROOT / "build/site", help="where the site goes")
    arguments = parser.parse_args()
    missing = [name for name in PACKAGES if not importlib.util.find_spec(name)]
    if missing:
        print(
            f"build_site.py:1: error: expected the packages {', '.join(PACKAGES)}, got no "
            f"{' and no '.join(missing)}; pip install {' '.join(PACKAGES)}",
            file=sys.stderr,
        )
        return 2
    with tempfile.TemporaryDirectory() as folder:
        stage = Path(folder)
        write_pages(stage / "docs", arguments.dda)
        (stage / "mkdocs.yml").write_text(json.dumps(settings(stage / "docs"), indent=1))
        out = arguments.out.resolve()
        build = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", out]
        status = subprocess.run([*build, "--config-file", stage / "mkdocs.yml"]).returncode
        (out / "404.html").unlink(missing_ok=True)  # for servers: opened as a file it finds no script
        if status == 0:
            search_without_server(out / "search")
            ford = [sys.executable, "-m", "ford", ROOT / "docs/site/ford.md", "-o", out / "fortran"]
            status = subprocess.run([*ford, "--quiet"], cwd=ROOT / "docs/site").returncode
    if status == 0:
        print(out / "index.html")
    return status


def search_without_server(folder: Path) -> None:
    """Put the site's own search in place of that of MkDocs, and its index into a script."""
    index = (folder / "search_index.json").read_text(encoding="utf-8")
    (folder / "search_index.js").write_text(f"const search_data = {index};\n", encoding="utf-8")
    shutil.copy(ROOT / "docs/site/search.js", folder / "main.js")
    for name in ("search_index.json", "worker.js"):
        (folder / name).unlink()


def settings(docs: Path) -> dict:
    """Settings of MkDocs (JSON is YAML)."""
    found = {path.name for path in docs.glob("*.md")} | {"fortran/index.html"}
    nav = [
        {chapter: [{title: name} for name, title in pages.items() if name in found]}
        for chapter, pages in CHAPTERS.items()
    ]
    known = {name for pages in CHAPTERS.values() for name in pages}
    nav[-1]["Developers"] += [{Path(name).stem: name} for name in sorted(found - known)]
    return {
        "site_name": "voussoir",
        "docs_dir": str(docs),
        "use_directory_urls": False,
        "theme": {"name": "readthedocs", "highlightjs": False},
        "markdown_extensions": ["tables", "fenced_code", "toc"],
        "extra_css": ["style.css"],
        "nav": nav,
        "validation": {"nav": {"not_found": "ignore"}, "links": {"anchors": "ignore"}},
    }


def write_pages(docs: Path, dda: Path) -> None:
    """The pages as MkDocs wants them: those of docs/, the README as the first, and the made ones."""
    shutil.copytree(ROOT / "docs", docs, ignore=shutil.ignore_patterns("site"))
    readme = (ROOT / "README.md").read_text(encoding="utf-8").replace("](docs/", "](")
    readme = readme.replace("](CONTRIBUTING.md)", "](contributing.md)")
    for name in ("CITATION.cff", "LICENSE"):
        readme = re.sub(rf"\[([^\]]*)\]\({name}\)", r"\1", readme)
    (docs / "index.md").write_text(readme, encoding="utf-8")
    contributing = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").replace("](docs/", "](")
    contributing = contributing.replace("](README.md)", "](index.md)")
    (docs / "contributing.md").write_text(contributing, encoding="utf-8")
    for name, text in source_pages.pages().items():
        (docs / name).write_text(text, encoding="utf-8")
    for page in docs.glob("*.md"):
        text = page.read_text(encoding="utf-8").replace("](../README.md)", "](index.md)")
        text = re.sub(r"\[([^\]]*)\]\(\.\./[^)]*\)", r"\1", text)
        text = re.sub(r"`((?:modules|tolerances)\.md)`", r"[\1](\1)", text)
        text = re.sub(r"^```sh install$", "```text", text, flags=re.M)
        text = re.sub(r"^```(\w+) geometry$", r"```\1", text, flags=re.M)
        page.write_text(with_formulas(text), encoding="utf-8")
    (docs / "style.css").write_text(STYLE, encoding="utf-8")
    done = subprocess.run([dda, "help", "keys"], capture_output=True, text=True, check=True)
    (docs / "keys.md").write_text(keys_page(done.stdout), encoding="utf-8")
    (docs / "python.md").write_text(python_page(), encoding="utf-8")


def with_formulas(text: str) -> str:
    """A page whose TeX formulas, between dollars, are MathML; code stays as it is."""
    from latex2mathml.converter import convert

    def formula(match: re.Match) -> str:
        if match["code"]:
            return match["code"]
        shown = match["shown"] is not None
        mathml = convert(match["shown"] or match["inline"], display="block" if shown else "inline")
        mathml = mathml.replace("|", "&#124;")  # a bar would part the cells of a table
        if shown:
            # a <div> within a paragraph or a list item would end it
            tag = "div" if text[:match.start()].endswith("\n\n") else "span"
            return f'<{tag} class="formula shown">{mathml}</{tag}>'
        # a bare <math> at the beginning of a line would end the paragraph
        return f'<span class="{"formula" if len(match["inline"]) > LONG else "short"}">{mathml}</span>'

    code = r"(?P<code>^ *```.*?^ *```|`[^`\n]+`)"
    pattern = code + r"|\$\$(?P<shown>[^$]+)\$\$|\$(?P<inline>[^$\n]+(?:\n[^$\n]+)?)\$"
    return re.sub(pattern, formula, text, flags=re.M | re.S)


def keys_page(help_text: str) -> str:
    """Every key of a deck, from what `dda help keys` prints."""
    about = "The list of `dda help keys`. [The input deck](input.md) has the rules between keys."
    lines = ["# Every key", "", about, ""]
    for line in help_text.splitlines():
        if line.startswith("&"):
            name, _, meaning = line.partition("   ")
            lines += [f"## {name}", "", meaning[0].upper() + meaning[1:] + ".", ""]
        elif line.startswith("      "):
            lines += [f"    {line.strip()}", ""]
        elif line.strip():
            name, _, rest = line.strip().partition(" ")
            lines += [f"- `{name}` {rest.strip()}", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
