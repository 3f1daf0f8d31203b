"""The tables of docs/input.md and docs/joint_map.md are the keys of the program: a new key is one row."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from dda_command import run_dda

ROOT = Path(__file__).resolve().parents[2]
GROUPS = {group["name"]: {key["name"]: key for key in group["keys"]}
          for group in json.loads(run_dda("help", "keys", "--json").stdout)["groups"]}


def rows(page: str) -> list[list[str]]:
    """Group, key, unit, range, default, requirement (of tables that have it) and meaning of each row of a page."""
    found = []
    text = (ROOT / "docs" / page).read_text(encoding="utf-8").split("## Groups and keys\n")[1].split("\n## ")[0]
    for section in re.split(r"^### ", text, flags=re.M)[1:]:
        table = [line.strip("| ").replace("`", "") for line in section.splitlines() if line.startswith("| `")]
        found += [[section.split()[0], *map(str.strip, re.sub(r"\[([^][]*)\]\([^)]*\)", r"\1", line).split("|"))]
                  for line in table]
    return found


@pytest.mark.parametrize("row", rows("input.md"), ids=lambda row: f"{row[0]}%{row[1]}")
def test_row_is_what_the_program_says(row: list[str]) -> None:
    group, name, unit, range_, default, *needs, meaning = row
    key = GROUPS[group][name]
    assert (key.get("unit", ""), key["meaning"], key.get("needs", "")) == (unit, meaning, "".join(needs))
    assert default in (key.get("default"), f"({key.get('without')})")
    range_, *marks = re.split(r", (?=search|not swept|swept as)", range_)
    assert key["sweep"] == (group not in ("scene", "sweep", "output") and "not swept" not in marks and range_ != "name")
    lists = {"numbers": "list of numbers", "words": "list of words", "flag": "flag", "text": "text"}
    if "from" not in key:
        assert range_ in ("name", lists.get(str(key["kind"])), ", ".join(f"'{word}'" for word in key.get("words", [])))
        return
    numbers = [float(end) for end in re.findall(r"-?[\d.]+(?:e-?\d+)?", range_)]
    assert numbers == [key["from"], key["to"]]
    assert (range_.strip("list n")[0], range_.split("whole")[0].strip(", ")[-1]) == (
        "(" if "above" in key else "[", ")" if "below" in key else "]")
    assert key["kind"] == ("numbers" if "list" in range_ else "whole" if "whole" in range_ else "number")


def test_meanings_are_short() -> None:
    long = [(group, name) for group, keys in GROUPS.items() for name, key in keys.items()
            if len(key["meaning"].split()) > 15]
    assert long == []


def test_program_has_no_other_keys() -> None:
    assert [row[:2] for row in rows("input.md")] == [[group, key] for group, keys in GROUPS.items() for key in keys]
    printed = run_dda("help", "lines").stdout
    for group, name, unit, _, default, meaning in rows("joint_map.md"):
        about = printed.split(f"\n&{group} ")[1].split("\n&")[0]
        without = default if default == "(required)" else f"(without it: {default[1:-1]})"
        known = f" = {default}" if default[0] != "(" else f"   {without}"
        assert f"\n   {name}{known}\n      {meaning}\n" in about and f"[{unit}]" in about + "[]"
    assert len(re.findall(r"^   \w+ .*\n      \S", printed.split("\n&lines ")[1], re.M)) == len(rows("joint_map.md"))


def registry(folder: Path, row: str) -> subprocess.CompletedProcess[str]:
    """Make the registry in a folder from a copy of the page in which a row follows that of the radius."""
    page = (ROOT / "docs" / "input.md").read_text(encoding="utf-8")
    (folder / "input.md").write_text(re.sub(r"(?m)^(\| `radius` .*\n)", rf"\1{row}\n", page), encoding="utf-8")
    words = {"PAGE": folder / "input.md", "NAMES": "dda_key_names", "KEYS": "dda_deck_keys", "PREFIX": "deck",
             "FIXED": "scene|sweep|output", "OUT": folder / "keys.f90"}
    return subprocess.run(
        ["cmake", *(f"-D{name}={value}" for name, value in words.items()), "-P", ROOT / "cmake" / "key_table.cmake"],
        capture_output=True, text=True, check=False)


@pytest.mark.skipif(shutil.which("cmake") is None, reason="no CMake")
def test_new_key_is_one_row(tmp_path: Path) -> None:
    row = "| `tilt` | deg | (-90, 90], whole, search from 0 to 45 | `0` | `mode = 'static'` | [Tilt](#arch). |"
    assert registry(tmp_path, row).returncode == 0
    text = (tmp_path / "keys.f90").read_text(encoding="utf-8")
    assert re.search(r"& arch_radius, &\n\s+& arch_tilt, &\n\s+& arch_thickness_ratio", text)
    entry = " ".join(text.split('key_t("arch", "tilt"')[1].split("), &\n")[0].split())
    assert entry == (', unit="deg", default="0", & kind=key_kind%whole, search_low=0.0_wp, search_high=45.0_wp, '
                     'within=[-90.0_wp, 90.0_wp], above=-90.0_wp, & needs="mode = \'static\'", & meaning="Tilt."')


@pytest.mark.skipif(shutil.which("cmake") is None, reason="no CMake")
@pytest.mark.parametrize(("row", "problem"), [
    ("| `tilt` | deg | [0, 90] | Tilt. |", "a row | `KEY` |"),
    ("| `tilt` | deg | 0 to 90 | `0` | Tilt. |", "a range such as"),
    ("| `tilt` | deg | [0, 90] | 0 | Tilt. |", "`DEFAULT` or")])
def test_bad_row_is_refused_with_its_line(tmp_path: Path, row: str, problem: str) -> None:
    done = registry(tmp_path, row)
    lines = (tmp_path / "input.md").read_text(encoding="utf-8").splitlines()
    assert done.returncode != 0 and not (tmp_path / "keys.f90").exists()
    assert re.sub(r"\s+", " ", done.stderr).find(f"input.md:{lines.index(row) + 1}: expected {problem}") > 0
