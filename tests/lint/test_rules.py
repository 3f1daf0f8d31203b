"""Every source keeps the house rules, and the rules find what breaks them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import fortran_rules
import pytest
import python_rules

REPOSITORY = Path(__file__).resolve().parents[2]
FACADES = {"voussoir"}  #: The module that hands on the names of others: the library's face
GOOD = """!> A module
module good
   use other, only : thing
   implicit none
   private
   integer, parameter :: limit = 3

   !> A type
   type :: pair_t
      integer :: first
   end type pair_t

contains

   !> A procedure
   pure subroutine work(x, &
      & y)
      !> Its argument
      real, intent(inout) :: x
      !> Another one: "go to" is no goto in words, nor is a pointer
      real, intent(in) :: y
      integer :: i

      x = y ! go to
      i = 1
   end subroutine work
end module good
"""
GOOD_PYTHON = '''"""A module."""

from pathlib import Path


def read(path: Path) -> str:
    """Read."""
    return path.read_text()
'''


def test_fortran_sources_keep_the_rules() -> None:
    files = sorted((REPOSITORY / "src").rglob("*.f90"))
    assert len(files) > 100
    assert [line for file in files for line in fortran_rules.offences(file)] == []


def test_no_public_name_is_exported_by_two_modules() -> None:
    files = [file for file in sorted((REPOSITORY / "src").rglob("*.f90")) if file.stem not in FACADES]
    assert fortran_rules.names_twice(files) == {}


def test_names_that_two_modules_export_are_found(tmp_path: Path) -> None:
    (tmp_path / "a.f90").write_text("module a\n public :: one, &\n  & two\nend module a\n")
    (tmp_path / "b.f90").write_text("module b\n public :: Two ! and more\n public :: three\nend module b\n")
    assert fortran_rules.names_twice(sorted(tmp_path.glob("*.f90"))) == {"two": ["a", "b"]}


def test_no_constructor_is_left_to_what_gfortran_gets_wrong() -> None:
    assert fortran_rules.lost_memory(sorted((REPOSITORY / "src").rglob("*.f90"))) == []


@pytest.mark.parametrize(
    ("statement", "rule"),
    [
        ("load = load_t(record(1, :), record(2:3, :))", "load_t(...) of sections"),
        ("held = held_t(7, load_t(record(1, :), record))", "of sections"),
        ("list = [list, load]", "list = [...] loses"),
        ("model%list = [model%list, load]", "list = [...] loses"),
        ("load = load_t(time, force)", ""),
        ("point = point_t(place(:, 1))", ""),
        ("numbers = [numbers, 1]", ""),
    ],
)
def test_constructors_that_gfortran_gets_wrong_are_found(tmp_path: Path, statement: str, rule: str) -> None:
    (tmp_path / "a.f90").write_text(
        "type :: load_t\n real, allocatable :: time(:), force(:, :)\nend type load_t\n"
        "type :: held_t\n integer :: block = 0\n type(load_t) :: path\nend type held_t\n"
        "type :: point_t\n real :: place(2)\nend type point_t\n"
        "type :: model_t\n type(held_t), allocatable :: list(:)\nend type model_t\n"
        f"type(load_t), allocatable :: list(:)\n{statement}\n")
    found = fortran_rules.lost_memory([tmp_path / "a.f90"])
    assert [rule in line for line in found] == [True] * bool(rule), found


@pytest.mark.parametrize(("folder", "strict"), [("post", True), ("tests/voussoir_benches", True),
                                                ("docs", False), ("tests", False)])
def test_python_sources_keep_the_rules(folder: str, strict: bool) -> None:
    files = sorted((REPOSITORY / folder).rglob("*.py"))
    assert files
    assert [line for file in files for line in python_rules.offences(file, strict)] == []


def test_what_keeps_the_rules_is_left_in_peace(tmp_path: Path) -> None:
    (tmp_path / "good.f90").write_text(GOOD)
    (tmp_path / "good.py").write_text(GOOD_PYTHON)
    assert fortran_rules.offences(tmp_path / "good.f90") == []
    assert python_rules.offences(tmp_path / "good.py", strict=True) == []


@pytest.mark.parametrize(("argument", "right"), [
    ("real, intent(in) :: x", True), ("real, intent(in) :: y, x", True), ("real, intent(in) :: z", False),
    ("real, intent(in) :: z  !! Explained behind it", True), ("real, intent(in) :: z  ! Not for FORD", False),
    ("real, intent(in) :: x(:)", False), ("integer, intent(in) :: x", False)])
def test_a_module_explains_an_argument_once(tmp_path: Path, argument: str, right: bool) -> None:
    more = f"   !> Another\n   subroutine more(x)\n      {argument}\n   end subroutine more\nend module good\n"
    (tmp_path / "twice.f90").write_text(GOOD.replace("end module good\n", more))
    found = fortran_rules.offences(tmp_path / "twice.f90")
    assert (found == []) is right and all("has its !> line" in rule for rule in found), found


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("   i = 1", "   go to 10", "no goto"),
        ("integer, parameter :: limit = 3", "integer :: limit = 3", "no module variables"),
        ("integer :: i", "integer, pointer :: i", "no pointers"),
        ("use other, only : thing", "use other", "only"),
        ("   implicit none\n", "", "implicit none"),
        ("   private\n", "", "private"),
        ("   !> A procedure\n", "", "a procedure has its !> line"),
        ("      !> Its argument\n", "", "has its !> line"),
        ("   !> A type\n", "", "a type has its !> line"),
        ("i = 1", "i = 1 ", "no blanks at the end"),
        ("i = 1", "i = 1" + " + 1" * 30, "at most 100 characters"),
        ("      i = 1\n", "      i = 1\n" * 60, "a procedure has at most 60 lines"),
        ("contains\n", "contains\n" + "\n" * 400, "a file has at most 400 lines"),
    ],
)
def test_what_breaks_a_rule_is_found(tmp_path: Path, old: str, new: str, rule: str) -> None:
    assert old in GOOD
    (tmp_path / "bad.f90").write_text(GOOD.replace(old, new, 1))
    found = fortran_rules.offences(tmp_path / "bad.f90")
    assert len(found) == 1 and rule in found[0], found


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("from pathlib", "import os\nfrom pathlib", "os is imported and not used"),
        ("(path: Path) -> str", "(path) -> Path", "has no type of path"),
        ('    """Read."""\n', "", "read says what it does"),
        ('"""A module."""\n', "", "a module says what it is for"),
        ("return", "try:\n        pass\n    except:\n        pass\n    return", "an except names"),
        ("return", "assert (path, 'there')\n    return", "always holds"),
        ("path: Path", "path: Path = []", "shared by all calls"),
        ("    return", "    path = path\n" * 60 + "    return", "a function has at most 60 lines"),
        ("return", "return   " + "0 or " * 30, "at most 120 characters"),
        ("def read", 'def read() -> None:\n    """Read."""\n\n\ndef read', "read hides the first"),
    ],
)
def test_what_breaks_a_rule_of_python_is_found(tmp_path: Path, old: str, new: str, rule: str) -> None:
    assert old in GOOD_PYTHON
    (tmp_path / "bad.py").write_text(GOOD_PYTHON.replace(old, new, 1))
    found = python_rules.offences(tmp_path / "bad.py", strict=True)
    assert len(found) == 1 and rule in found[0], found


def test_pages_of_the_sources_have_every_module_and_threshold(tmp_path: Path) -> None:
    import source_pages

    script = REPOSITORY / "docs" / "site" / "source_pages.py"
    subprocess.run([sys.executable, script, tmp_path], check=True)
    modules, tolerances = (source_pages.pages()[f"{name}.md"] for name in ("modules", "tolerances"))
    assert (tmp_path / "modules.md").read_text(encoding="utf-8") == modules
    assert (tmp_path / "tolerances.md").read_text(encoding="utf-8") == tolerances
    files = [path.stem for path in (REPOSITORY / "src").glob("*/*.f90")]
    assert sorted(re.findall(r"^\| `(\w+)` \|", modules, re.M)) == sorted(files)
    assert re.search(r"^\| `dda_settings`: `contact_tolerance` \| 1e-4 \| .+ \|$", tolerances, re.M)
    empty = [row for row in (modules + tolerances).splitlines() if re.search(r"\|\s*\|$", row)]
    assert empty == []
    assert {folder.name for folder in (REPOSITORY / "src").iterdir() if folder.is_dir()} == set(source_pages.PACKAGES)
