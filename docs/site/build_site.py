#!/usr/bin/env python3
"""Build the documentation site: `python3 docs/site/build_site.py --dda build/bin/dda --out build/site`.

The pages of docs/, the deck's keys as the program tells them, and the interfaces of every public
Fortran procedure (by FORD) and Python function (from their docstrings), by MkDocs.
"""

from __future__ import annotations

import argparse
import ast
import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Pages in the order of the menu; others of docs/ follow
PAGES = {
    "index.md": "Overview",
    "getting-started.md": "Getting started",
    "installation.md": "Installation",
    "howto.md": "How to",
    "input.md": "The input deck",
    "keys.md": "Every key",
    "messages.md": "Messages",
    "paper.md": "The paper",
    "theory.md": "Theory",
    "method.md": "Method",
    "validation.md": "Validation",
    "performance.md": "Performance",
    "scaling.md": "Scaling",
    "architecture.md": "Architecture",
    "shi.md": "Shi's routines",
    "python.md": "Python interfaces",
}


def main() -> int:
    """Build the site; 0 if that went well, 2 if a package is missing, else MkDocs' or FORD's status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dda", type=Path, default=ROOT / "build/bin/dda", help="the program")
    parser.add_argument("--out", type=Path, default=ROOT / "build/site", help="where the site goes")
    arguments = parser.parse_args()
    missing = [name for name in ("mkdocs", "ford") if not importlib.util.find_spec(name)]
    if missing:
        print(
            f"build_site.py:1: error: wanted the packages mkdocs and ford, found no "
            f"{' and no '.join(missing)}; pip install mkdocs ford",
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
        if status == 0:
            ford = [sys.executable, "-m", "ford", ROOT / "docs/site/ford.md", "-o", out / "fortran"]
            status = subprocess.run([*ford, "--quiet"], cwd=ROOT / "docs/site").returncode
    if status == 0:
        print(out / "index.html")
    return status


def settings(docs: Path) -> dict:
    """Settings of MkDocs (JSON is YAML)."""
    others = {path.name: path.stem for path in sorted(docs.glob("*.md"))}
    pages = {name: title for name, title in PAGES.items() if name in others} | {
        name: stem for name, stem in others.items() if name not in PAGES
    }
    return {
        "site_name": "voussoir",
        "docs_dir": str(docs),
        "use_directory_urls": False,
        "theme": {"name": "readthedocs", "highlightjs": False},
        "markdown_extensions": ["tables", "fenced_code", "toc"],
        "nav": [{title: name} for name, title in pages.items()]
        + [{"Fortran interfaces": "fortran/index.html"}],
        "validation": {"nav": {"not_found": "ignore"}, "links": {"anchors": "ignore"}},
    }


def write_pages(docs: Path, dda: Path) -> None:
    """The pages as MkDocs wants them: those of docs/, the README as the first, and the made ones."""
    shutil.copytree(ROOT / "docs", docs, ignore=shutil.ignore_patterns("site"))
    readme = (ROOT / "README.md").read_text(encoding="utf-8").replace("](docs/", "](")
    for name in ("CONTRIBUTING.md", "LICENSE"):
        readme = re.sub(rf"\[([^\]]*)\]\({name}\)", r"\1", readme)
    (docs / "index.md").write_text(readme, encoding="utf-8")
    for page in docs.glob("*.md"):
        text = page.read_text(encoding="utf-8").replace("](../README.md)", "](index.md)")
        text = re.sub(r"\[([^\]]*)\]\(\.\./[^)]*\)", r"\1", text)
        page.write_text(re.sub(r"^```sh install$|^```message$", "```text", text, flags=re.M))
    done = subprocess.run([dda, "help", "keys"], capture_output=True, text=True, check=True)
    (docs / "keys.md").write_text(keys_page(done.stdout), encoding="utf-8")
    (docs / "python.md").write_text(python_page(), encoding="utf-8")


def keys_page(help_text: str) -> str:
    """Every key of a deck, from what `dda help keys` prints."""
    lines = ["# Every key", "", "As `dda help keys` prints them; [the input deck](input.md) says more.", ""]
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


def python_page() -> str:
    """Public functions and classes of the Python package, with their docstrings."""
    lines = ["# Python interfaces", ""]
    for path in sorted((ROOT / "post/voussoir").glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if path.stem.startswith("_") or not ast.get_docstring(tree):
            continue
        lines += [f"## voussoir.{path.stem}", "", *block(ast.get_docstring(tree))]
        for node in tree.body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_"):
                text = ast.get_docstring(node)
                head = node.name
                if isinstance(node, ast.FunctionDef):
                    head += f"({ast.unparse(node.args)})"
                lines += [f"### `{head}`", "", *block(text or "")]
    return "\n".join(lines)


def block(text: str) -> list[str]:
    """A docstring as it stands."""
    return ["```text", *text.splitlines(), "```", ""]


if __name__ == "__main__":
    sys.exit(main())
