"""Damaged tables are told with file and line by every command that reads them; nothing breaks off."""

from __future__ import annotations

import os
import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from test_campaign_safety import damage

pytest.importorskip("matplotlib", reason="matplotlib is not installed: skipped")

from voussoir.command.main import main  # noqa: E402

DDA = os.environ["DDA"]
MUTANTS = int(os.environ.get("MUTANTS", "8"))  #: Mutants of tables; the target fuzz asks for more
DECKS = {
    "moves": "&arch voussoirs = 6, thickness_ratio = 0.09 /\n&analysis geometry = 'current' /\n"
    "&output frames = 3, blocks = .true., joints = .true. /\n"
    "&sweep parameter = 'friction_deg', values = 30, 50 /\n",
    "search": "&arch voussoirs = 6 /\n&search /\n&output blocks = .true., joints = .true. /\n"
    "&sweep parameter = 'half_angle_deg', values = 60, 75, 90 /\n",
}


def run(folder: Path, name: str) -> Path:
    """Results of one of the decks."""
    (folder / f"{name}.nml").write_text(DECKS[name])
    words = [DDA, "run", folder / f"{name}.nml", "--out", folder / name, "--quiet"]
    subprocess.run(words, check=True)
    return folder / name


def spoil(table: Path, line: int, old: str, new: str) -> None:
    """Change a line of a table; the first is 1."""
    lines = table.read_bytes().decode().split("\n")
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new, 1)
    table.write_bytes("\n".join(lines).encode("latin-1"))


@pytest.mark.parametrize(
    ("table", "line", "old", "new", "words"),
    [
        ("results.csv", 1, "verdict", "verdikt", "expected one column verdict, got 0"),
        ("results.csv", 3, ",2,", ",two,", "expected case as dda writes it, got 'two'"),
        ("results.csv", 2, "found", "fo\xffnd", "expected a table, got: 'utf-8' codec"),
        ("joints.csv", 5, ",", "", "expected 23 cells, got 22"),
        ("blocks.csv", 4, "free", "free,", "expected 8 cells, got 9"),
    ],
)
def test_damaged_table_is_reported_with_file_and_line(
    tmp_path: Path, table: str, line: int, old: str, new: str, words: str, capsys
) -> None:
    folder = run(tmp_path, "search")
    spoil(folder / table, line, old, new)
    for command in (["plot"], ["plot", "--chart"], ["animate"]):
        assert main([*command[:1], str(folder), *command[1:]]) == 2
        assert capsys.readouterr().err.startswith(f"{folder / table}:{line}: error: {words}")


def test_empty_table_is_reported(tmp_path: Path, capsys) -> None:
    folder = run(tmp_path, "search")
    (folder / "results.csv").write_text("")
    assert main(["plot", str(folder)]) == 2
    assert f"{folder / 'results.csv'}:1: error: expected one column" in capsys.readouterr().err


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", sorted(DECKS))
def test_mutants_of_tables_end_in_a_picture_or_a_message(tmp_path: Path, name: str, capsys) -> None:
    whole, folder = run(tmp_path, name), tmp_path / "mutant"
    dice = random.Random(name)
    for mutant in range(MUTANTS):
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(whole, folder)
        files = [path for path in folder.iterdir() if path.suffix in (".csv", ".record")]
        file = dice.choice(sorted(files))
        damage(file, dice)
        for words in (
            ["plot", str(folder), "--case", "1"],
            ["animate", str(folder), "--case", "1", "--out", str(tmp_path / "a.png")],
            ["plot", str(folder), "--chart"],
        ):
            status = main(words)
            told = capsys.readouterr().err
            assert status in (0, 2), (mutant, file)
            if status == 2:
                assert re.match(rf"{re.escape(str(folder))}[^:]*:\d+: error: .", told), told
