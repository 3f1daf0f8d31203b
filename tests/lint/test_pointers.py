"""Modules and procedures that the pages for developers name exist where the pages say."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: A module with its folder, then the procedures that follow it: `folder/module`: `procedure`, `procedure`
POINTER = re.compile(r"`((?:[a-z_]+/)?(?:dda|couplet)_\w+)`(?:(?:: | \()((?:`\w+`(?:, | and )?)+)\)?)?")
#: A procedure, type or parameter that a source declares
DECLARED = re.compile(
    r"^ *(?:(?:pure|elemental|recursive|module|integer|logical|real\(wp\)|type\(\w+\)) +)*"
    r"(?:subroutine|function|procedure|type(?:, \w+)? ::|program) +(\w+)", re.MULTILINE)


@cache
def sources() -> dict[str, Path]:
    """Sources by the name of their module; tables of keys become modules when the program is built."""
    made = re.findall(r"^voussoir_keys\((\S+) (\w+) (\w+)", (ROOT / "src" / "CMakeLists.txt").read_text(), re.MULTILINE)
    return ({path.stem: path for path in (ROOT / "src").rglob("*.f90")}
            | {name: ROOT / "docs" / page for page, *names in made for name in names})


@cache
def declared(module: str) -> frozenset[str]:
    """Names that a module and its submodules declare."""
    texts = [path.read_text() for name, path in sources().items()
             if name == module or re.search(rf"^submodule \((?:\w+:)?{module}\)", path.read_text(), re.MULTILINE)]
    return frozenset(name for text in texts for name in DECLARED.findall(text))


def faults(text: str) -> list[str]:
    """Pointers of a page that lead nowhere."""
    found = []
    for module, names in POINTER.findall(text):
        folder, _, name = module.rpartition("/")
        if name not in sources() or folder and sources()[name].parent.name != folder:
            found.append(module)
            continue
        found += [f"{module}: {other}" for other in re.findall(r"\w+", names) if other not in declared(name)]
    return found


@pytest.mark.parametrize("page", ["shi.md", "architecture.md", "limits.md", "method.md"])
def test_each_pointer_of_a_page_leads_to_its_place(page: str) -> None:
    """A reader finds each module in its folder and each procedure in its module."""
    assert faults((ROOT / "docs" / page).read_text()) == []


@pytest.mark.parametrize("text", ["`dda_unknown`", "`solver/dda_step`", "`dda_step`: `dance`"])
def test_pointers_that_lead_nowhere_are_found(text: str) -> None:
    """A module that is not there, one in another folder, and a procedure of another module."""
    assert len(faults(text)) == 1
