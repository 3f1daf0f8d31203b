"""docs/input.md names every key of the registry, in its group, with its unit and default."""
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
REGISTRY = "".join((ROOT / f"src/input/dda_{name}_keys.f90").read_text(encoding="utf-8") for name in ("deck", "arch"))
DOC = (ROOT / "docs/input.md").read_text(encoding="utf-8")


def registry():
    """Entries of the registry: group, name, unit and default as text."""
    for entry in REGISTRY.split("key_t(")[1:]:
        def field(name, text=entry):
            match = re.search(rf'\b{name}="([^"]*)"', text)
            return match[1] if match else ""
        yield *re.match(r'"(\w+)", "(\w+)"', entry).groups(), field("unit"), field("default")


def documented():
    """Rows of the tables: {(group, key): (unit, default)}."""
    rows = {}
    for section in re.split(r"^### ", DOC, flags=re.M)[1:]:
        for line in section.split("\n## ")[0].splitlines()[1:]:
            cells = [cell.strip() for cell in line.split(" | ")]
            name = re.fullmatch(r"\| `(\w+)`", cells[0])
            if name:
                cells = [cell.strip() for cell in line.strip("| ").split("|")]
                rows[section.split()[0], name[1]] = cells[1], cells[3]
    return rows


@pytest.mark.parametrize("group, name, unit, default", list(registry()))
def test_key_is_documented(group, name, unit, default):
    """One row with the unit and, where there is one, the default."""
    assert (group, name) in documented()
    found_unit, found_default = documented()[group, name]
    assert found_unit == unit
    assert found_default.strip("`") == default or not default and "`" not in found_default


def test_no_key_is_invented():
    """The tables hold nothing that the program does not know."""
    assert set(documented()) == {(group, name) for group, name, _, _ in registry()}
    assert len(documented()) > 40
