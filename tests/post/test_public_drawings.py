"""Public drawings are imported with the areas of formulas, or refused with the entity and its place."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from public_drawings import Drawn, Pen, drawings

pytest.importorskip("shapely")

from voussoir.command.main import main  # noqa: E402

TOLERANCE = 1e-3  #: How far chords may be from their arcs [m]


def polygons(file: Path) -> list[np.ndarray]:
    """Corners of the blocks of a file."""
    blocks: list[list[list[float]]] = []
    for row in file.read_text().splitlines():
        words = row.split()
        if words[0] == "block":
            blocks.append([])
        elif row.startswith("  "):
            blocks[-1].append([float(word) for word in words])
    return [np.array(corners) for corners in blocks]


def area(corners: np.ndarray) -> float:
    """Area of a polygon, from its first corner on, as the origin may be far."""
    x, y = (corners - corners[0]).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(("text", "drawn", "pen"), [pytest.param(*rest, id=name) for name, *rest in drawings()])
def test_public_drawings_are_imported_right_or_refused_with_their_place(
    tmp_path: Path, capfd, text: str, drawn: Drawn, pen: Pen
) -> None:
    (tmp_path / "a.dxf").write_text(text)
    words = ["import", str(tmp_path / "a.dxf"), "--out", str(tmp_path / "a.nml"), "--tolerance", repr(TOLERANCE)]
    status = main([*words, "--run"] if drawn.refused else words)
    printed = "".join(capfd.readouterr())
    if drawn.refused:
        assert status == 2
        said = re.search(drawn.refused + r".*? at \((\S+), (\S+)\)", printed)
        assert said, printed
        for word, value, start in zip(said.groups(), drawn.place, pen.at):
            assert float(word) == pytest.approx((value + start) * pen.metre, abs=0.01 * pen.metre)
        return
    assert status == 0 and "dropped" not in printed, printed
    found = polygons(tmp_path / "a.blocks")
    assert len(found) == len(drawn.areas)
    # an area is off by at most the tolerance along its curves
    for mine, (exact, curved) in zip(sorted(map(area, found)), sorted(drawn.areas)):
        assert mine == pytest.approx(exact, abs=TOLERANCE * curved + 1e-6)
    corners = np.vstack(found)
    low, high = np.array(drawn.box).reshape(2, 2) + np.array(pen.at)
    assert np.abs(corners.min(axis=0) - low).max() < TOLERANCE
    assert np.abs(corners.max(axis=0) - high).max() < TOLERANCE
