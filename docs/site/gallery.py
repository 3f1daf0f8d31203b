#!/usr/bin/env python3
"""The gallery: every deck of input/gallery run and drawn, its picture, its sentence and its text on one page.

`cmake --build build --target gallery`, or `voussoir`'s Python with the package on its path:
`python3 docs/site/gallery.py`, writes docs/images/gallery/*.svg and docs/gallery.md.
"""

from __future__ import annotations

import subprocess
import tempfile
import textwrap
from pathlib import Path

from voussoir import results
from voussoir.dda_program import find_dda
from voussoir.plot.case_picture import draw_case
from voussoir.plot.figure_style import house_style, save

ROOT = Path(__file__).resolve().parents[2]
DECKS = ROOT / "input" / "gallery"
PICTURES = ROOT / "docs" / "images" / "gallery"
HEAD = """# Gallery

Twelve scenes from a semicircle to a tunnel: a question, the picture of `voussoir plot`, and the deck. The decks are in
`input/gallery`. An installed program copies them by `voussoir examples --copy .`; the first one runs by

```sh
dda run input/gallery/01_semicircle.nml
voussoir plot 01_semicircle
```

## Every shape

The shapes of `&arch shape` on abutments, a pier or buttresses, each with its thrust line under dead load.
`docs/site/shape_gallery.py` has their keys.

![Arches of every shape with their thrust lines](images/shapes.svg)
"""


def decks() -> list[Path]:
    """Decks in their order; their names begin with numbers."""
    return sorted(DECKS.glob("[0-9]*.nml"))


def sentence_of(deck: Path) -> str:
    """What a deck shows: its comment at the top."""
    lines = deck.read_text(encoding="utf-8").splitlines()
    return " ".join(line[1:].strip() for line in lines if line.startswith("!"))


def page() -> str:
    """The page."""
    text = [HEAD]
    for deck in decks():
        title = deck.read_text(encoding="utf-8").split("title = '")[1].split("'")[0]
        listing = "\n".join(line for line in deck.read_text(encoding="utf-8").splitlines() if line[:1] != "!")
        sentence = textwrap.fill(sentence_of(deck), 118)
        text.append(
            f"## {title}\n\n{sentence}\n\n![{title}](images/gallery/{deck.stem[3:]}.svg)\n\n"
            f"`input/gallery/{deck.name}`:\n\n```fortran\n{listing}\n```\n"
        )
    return "\n".join(text)


def draw(deck: Path, folder: Path) -> None:
    """Run a deck and draw its case."""
    subprocess.run([find_dda(), "run", deck, "--out", folder / deck.stem, "--quiet"], check=True)
    for file in DECKS.iterdir():  # what acts on the blocks is read beside the results
        if file.suffix in (".blocks", ".geo"):
            (folder / file.name).write_bytes(file.read_bytes())
    name = deck.stem[3:]
    with house_style():
        figure = draw_case(results.read(folder / deck.stem), 1)
        save(figure, PICTURES, name, ("svg",))


def main() -> None:
    """Draw all and write the page."""
    with tempfile.TemporaryDirectory() as folder:
        for deck in decks():
            draw(deck, Path(folder))
    (ROOT / "docs" / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
