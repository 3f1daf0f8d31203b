"""`voussoir verify` of damaged folders: one line and a status, whatever is cut, swapped or in another coding."""

from __future__ import annotations

import os
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from test_campaign_safety import damage
from test_verify import DECKS, HEAD, SCENES, run_scene

from voussoir.command.main import main

MUTANTS = int(os.environ.get("MUTANTS", "12"))  #: Mutants of each folder; the target fuzz asks for more
#: Folders whose tables have rows of every kind
FOLDERS = ("sweeps", "fill", "vehicle", "a weak tie", "live", "thickness")
TABLES = ("results", "joints", "blocks", "proof_forces", "proof_motion")


def cells_of(change: Callable[[list[str], int], None]) -> Callable[[Path], None]:
    """A change of the cells of the second row of a table, by its names."""
    def of_table(table: Path) -> None:
        lines = table.read_text().split("\n")
        cells = lines[2 if lines[2] else 1].split(",")
        change(cells, lines[0].split(",").index("case"))
        lines[2 if lines[2] else 1] = ",".join(cells)
        table.write_text("\n".join(lines))
    return of_table


def _put(cells: list[str], place: int, text: str) -> None:
    cells[place] = text


#: What becomes of a table
DAMAGE: dict[str, Callable[[Path], None]] = {
    "a row cut in half": lambda table: table.write_bytes(table.read_bytes()[:-len(table.read_bytes()) // 5]),
    "an empty row": lambda table: table.write_text(table.read_text() + "\n"),
    "another cell": cells_of(lambda cells, case: cells.append("7")),
    "no number of a case": cells_of(lambda cells, case: _put(cells, case, "")),
    "a case beyond all": cells_of(lambda cells, case: _put(cells, case, "99999999999999999999")),
    "a negative case": cells_of(lambda cells, case: _put(cells, case, "-1")),
    "no header": lambda table: table.write_text(table.read_text().partition("\n")[2]),
    "nothing": lambda table: table.write_bytes(b""),
    "a byte of zero": lambda table: table.write_bytes(table.read_bytes()[:-9] + b"\0" + table.read_bytes()[-8:]),
    "Latin-1": lambda table: table.write_bytes(table.read_bytes()[:-9] + b"\xe9" + table.read_bytes()[-8:]),
    "UTF-16": lambda table: table.write_bytes(table.read_text().encode("utf-16")),
    "an open quote": lambda table: table.write_bytes(table.read_bytes()[:-9] + b'"' + table.read_bytes()[-8:]),
    "a folder": lambda table: (table.unlink(), table.mkdir()),
    "gone": lambda table: table.unlink(),
}


def refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What verify says of a folder that it refuses: a line of standard error, or a case that fails."""
    capsys.readouterr()
    status = main(["verify", str(folder), "--quiet"])
    said = capsys.readouterr()
    assert status in (1, 2)
    if status == 2:
        assert said.out == "" and len(said.err.splitlines()) == 1 and ": error: " in said.err, said.err
        return said.err
    assert said.err == "" and "FAILS" in said.out
    return said.out


@pytest.mark.parametrize("name", TABLES)
def test_a_damaged_table_is_refused_in_a_line(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    whole = run_scene(tmp_path, DECKS["fill"])
    for what, change in DAMAGE.items():
        folder = tmp_path / "damaged"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(whole, folder)
        change(folder / f"{name}.csv")
        said = refused(folder, capsys)
        if what in ("no number of a case", "another cell", "a negative case", "Latin-1"):
            assert f"{name}.csv:" in said, what


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("text", ["", "nan", "inf", "1e999", "1,5", "0x10", "x", "1_0"])
def test_a_cell_that_is_no_number_is_named(
    tmp_path: Path, name: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = run_scene(tmp_path, DECKS["fill"])
    column = {"results": "critical", "joints": "force_x", "blocks": "x", "proof_forces": "x_1", "proof_motion": "spin"}
    table = folder / f"{name}.csv"
    head, first, *rest = table.read_text().split("\n")
    cells = first.split(",")
    cells[head.split(",").index(column[name])] = text
    table.write_text("\n".join([head, ",".join(cells), *rest]))
    said = refused(folder, capsys)
    if text not in ("1_0", "") and name != "results":
        assert f"{name}.csv:2: error: expected" in said


@pytest.mark.parametrize(("one", "other"), [("joints", "blocks"), ("proof_forces", "proof_motion"),
                                            ("results", "joints"), ("blocks", "proof_motion")])
def test_swapped_tables_are_refused(
    tmp_path: Path, one: str, other: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = run_scene(tmp_path, DECKS["fill"])
    texts = [(folder / f"{name}.csv").read_bytes() for name in (one, other)]
    (folder / f"{one}.csv").write_bytes(texts[1])
    (folder / f"{other}.csv").write_bytes(texts[0])
    assert "csv:1: error: expected one column" in refused(folder, capsys)


@pytest.mark.parametrize("name", TABLES)
def test_tables_of_another_run_are_refused(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path / "one", DECKS["fill"])
    other = run_scene(tmp_path / "two", DECKS["an arch that is not"])
    (folder / f"{name}.csv").write_bytes((other / f"{name}.csv").read_bytes())
    refused(folder, capsys)


@pytest.mark.parametrize("line", ["arch%voussoirs\n", "arch%voussoirs\n  1e300\n", "arch%voussoirs\n  x\n", "&sweep\n",
                                  "&sweep friction_deg linked\n  3\n", "arch%rings\n  0\n",
                                  "fill%height\n  nan\n", "arch%spans\n  1e-400\n", "search%parameter\n", "\xff\n"])
def test_a_damaged_record_is_refused_in_a_line(tmp_path: Path, line: str, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path, DECKS["fill"])
    record = folder / "deck.record"
    record.write_bytes(record.read_bytes() + line.encode("latin-1"))
    refused(folder, capsys)
    record.write_bytes(b"")
    assert "deck.record:1: error: " in refused(folder, capsys)


@pytest.mark.parametrize("name", FOLDERS)
def test_mutants_of_a_folder_are_refused_or_whole(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = run_scene(tmp_path, DECKS[name])
    dice = random.Random(name)
    for _ in range(MUTANTS):
        folder = tmp_path / "mutant"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(whole, folder)
        files = [path for path in sorted(folder.iterdir()) if path.suffix in (".csv", ".record")
                 and path.name != "reactions.csv"]
        file = dice.choice(files)
        before = file.read_bytes()
        damage(file, dice)
        capsys.readouterr()
        status = main(["verify", str(folder), "--quiet"])
        said = capsys.readouterr().err
        assert status in (0, 1, 2) and len(said.splitlines()) <= 1
        if file.suffix == ".csv" and file.name != "results.csv" and file.read_bytes().rstrip() != before.rstrip():
            assert status != 0, (file, before[:9])


def test_a_block_without_area_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = SCENES["bolts"]
    folder = run_scene(tmp_path, HEAD + scene[1], scene[0])
    table = folder / "blocks.csv"
    rows = [line.split(",") for line in table.read_text().split("\n")]
    for row in rows:
        if row[1:2] == ["2"]:
            row[4:6] = ["0.5", "0.5"]
    table.write_text("\n".join(map(",".join, rows)))
    assert "block 2 has no area" in refused(folder, capsys)
