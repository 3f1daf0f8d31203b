#!/usr/bin/env python3
"""Pictures of pages, made by the commands of the pages: `python3 docs/site/page_pictures.py [PAGE ...]`.

A comment before a picture names the file that the page's blocks write, `<!-- picture: bridge/plots/case_1.svg -->`.
The blocks of each page run as `tests/cli/test_docs.py` runs them, and the files are copied to docs/images. A page of
HTML becomes a screenshot by Chromium. DDA names the program, PYTHONPATH the package of the build.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PICTURE = re.compile(r"<!-- picture: (\S+) -->\n!\[[^\]]+\]\((images/[^)]+)\)")
#: Width and height of a screenshot of a page
WINDOW = "1000,1750"


def pictures_of(page: Path) -> list[tuple[str, Path]]:
    """Files that a page's blocks write, and the pictures that they become."""
    found = PICTURE.findall(page.read_text(encoding="utf-8"))
    return [(source, page.parent / target) for source, target in found]


def screenshot(page: Path, target: Path) -> None:
    """Picture of a page of HTML."""
    browser = shutil.which("chromium") or sys.exit("page_pictures.py:1: error: expected chromium, got none; install it")
    with tempfile.TemporaryDirectory() as profile:
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={profile}"]
        shot = [f"--window-size={WINDOW}", f"--screenshot={target}", page.resolve().as_uri()]
        subprocess.run([browser, *options, *shot], check=True, capture_output=True)


def make(page: Path) -> None:
    """Run the blocks of a page and keep its pictures."""
    import test_docs

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shell = test_docs.prepare(folder)
        for block in test_docs.blocks_of(page):
            test_docs.run_block(block, folder, shell)
        for source, target in pictures_of(page):
            target.parent.mkdir(exist_ok=True)
            if source.endswith(".html"):
                screenshot(folder / source, target)
            else:
                shutil.copy(folder / source, target)
            print(target.relative_to(ROOT))


def main() -> None:
    """Make the pictures of the pages named, or of all."""
    if not os.environ.get("DDA"):
        sys.exit("page_pictures.py:1: error: DDA must name the program dda")
    sys.path.insert(0, str(ROOT / "tests" / "cli"))
    pages = [ROOT / "docs" / name for name in sys.argv[1:]] or sorted((ROOT / "docs").glob("*.md"))
    for page in pages:
        if pictures_of(page):
            make(page)


if __name__ == "__main__":
    main()
