"""`voussoir view`: which block a point belongs to, what is told of it, and what is said without pyvista."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")

import voussoir  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.command.view import block_at, pictures_of_case, words_of  # noqa: E402

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
#: An L about the square's right and upper sides
CORNER = np.array([(1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 1.0), (1.0, 1.0)])


def test_a_point_belongs_to_the_block_that_it_lies_in_else_to_the_nearest() -> None:
    shapes = [SQUARE, CORNER]
    assert [block_at(shapes, np.array(point)) for point in ((0.5, 0.5), (0.5, 1.5), (1.5, 0.5))] == [1, 2, 2]
    assert block_at(shapes, np.array((-0.1, 0.5))) == 1
    assert block_at(shapes, np.array((2.1, 2.1))) == 2


def test_what_is_said_of_a_block_is_how_far_it_goes_in_the_picture(tmp_path: Path) -> None:
    (tmp_path / "a.nml").write_text(
        "&arch voussoirs = 12 /\n&joint friction_deg = 60.0 /\n&search parameter = 'thickness_ratio' /\n"
    )
    run = voussoir.run(tmp_path / "a.nml")
    pictures = pictures_of_case(run, 1)
    assert len(pictures) > 1
    told = [words_of(run, 1, pictures, pictures[-1], block.number) for block in run.blocks_of(1)]
    assert told.count(f"block {len(told)}: does not move") == 1
    ways = [float(text.split(" is ")[1].split(" m ")[0]) for text in told if " is " in text]
    assert len(ways) == 12 and min(ways) > 0.0
    assert words_of(run, 1, pictures, pictures[0], 3) == "block 3: a corner is 0 m from its initial position"


def test_without_pyvista_it_says_how_to_get_it(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    deck = tmp_path / "a.nml"
    deck.write_text("&arch voussoirs = 12, thickness_ratio = 0.2 /\n&joint friction_deg = 60.0 /\n")
    folder = voussoir.run(deck, out=tmp_path / "a").folder
    picture = tmp_path / "a.png"
    assert main(["view", str(folder), "--case", "1", "--out", str(picture)]) == 2
    assert "a window that turns needs pyvista, got none" in capsys.readouterr().err
    assert main(["view", str(folder), "--case", "7"]) == 2
    assert "case 7" in capsys.readouterr().err
    assert not picture.exists()
