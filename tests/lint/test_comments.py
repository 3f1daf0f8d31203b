"""Comments are in the words of the field, doc comments and commits begin as the rules ask, which find others."""

from __future__ import annotations

from pathlib import Path

import comment_rules
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
#: Doc comments of each folder that begin with a clause: these numbers may only become smaller
CEILINGS = {"src": 2, "post": 96, "tests": 303}
COMMITS = 8  #: Newest commits whose subjects are checked
FOLDERS = sorted(folder.name for folder in (REPOSITORY / "src").iterdir() if folder.is_dir())  #: Folders of sources


@pytest.mark.parametrize("folder", CEILINGS)
def test_doc_comments_that_begin_with_a_clause_become_fewer(folder: str) -> None:
    found = list(comment_rules.openings(REPOSITORY / folder))
    assert len(found) <= CEILINGS[folder], "\n".join(found[-20:])


@pytest.mark.parametrize("folder", FOLDERS)
def test_comments_of_a_folder_are_in_the_words_of_the_field(folder: str) -> None:
    files = sorted((REPOSITORY / "src" / folder).rglob("*.f90"))
    found = [line for file in files for line in comment_rules.offences_of_comments(file)]
    assert files != []
    assert found == []


@pytest.mark.parametrize(
    "comment",
    [
        "What a file says of a material",
        "Whether it could be told without reading the digits back",
        "Which of them moves",
        "The joints. How far they open is measured",
        "Nothing here knows polygons",
        "Springs of all joints, as the solver wants them",
        "Fields, parted by commas",
        "Compute all anew",
        "Corners, seen from the origin",
        "Is told of a task now and then",
        "Hand contacts over; what is handed over is large",
        "Look around for edges",
        "Keep a distance, lest it creeps",
        "Load that a block felt",
        "A value that is left as it is",
        "A row a case",
        "Contacts of the step before",
        "Whether blocks move in time",
    ],
)
def test_words_of_comments_are_found(tmp_path: Path, comment: str) -> None:
    half = comment.find(" ", 3)
    name = tmp_path / "a.f90"
    for source in (f"   !> {comment}\n", f"   integer :: n = 0  !! {comment}\n",
                   f"   x = 'it''s' ! {comment[:half]}\n   ! {comment[half + 1:]}\n"):
        name.write_text(f"print *, 'What it says: anew'\n{source}end\n", encoding="utf-8")
        found = comment_rules.offences_of_comments(name)
        assert found != [] and all(line.startswith(f"{name}:2: ") for line in found), source


def test_good_comments_are_left_alone(tmp_path: Path) -> None:
    source = """   !> Number of joints: what counts is their length. True if whether matters
   !>
   !> Blocks before Newton's method is used; a part by volume
   !$omp What it says
   integer :: n = 0  !! First row, whatever it contains
   print *, "What is told anew", 'it''s !! What'
"""
    (tmp_path / "a.f90").write_text(source, encoding="utf-8")
    assert comment_rules.offences_of_comments(tmp_path / "a.f90") == []


def test_lines_of_a_paragraph_are_one_comment() -> None:
    source = "   !> One\n   !> two\n   !>\n   !> three\nx = '!'  !! four\n         !! five\n   ! six\n"
    assert list(comment_rules.comments(source)) == [(1, "One two"), (4, "three"), (5, "four five"), (7, "six")]


def test_subjects_of_the_newest_commits_have_an_area_and_a_verb() -> None:
    subjects = comment_rules.newest_subjects(REPOSITORY, COMMITS)
    assert [fault for fault in map(comment_rules.offence_of_subject, subjects) if fault] == []


@pytest.mark.parametrize("line", ["   !> Whether it ends", '    """What a motion is told."""', "!> How it falls"])
def test_openings_are_found(tmp_path: Path, line: str) -> None:
    (tmp_path / "a.py").write_text(f"x = 1\n{line}\n!> Normal force of a joint\n")
    (found,) = comment_rules.openings(tmp_path)
    assert found.endswith(f"a.py:2: {line.strip()}")


@pytest.mark.parametrize(
    ("subject", "fault"),
    [
        ("docs: update memory per block", ""),
        ("solver, step: skip factors that repeat", ""),
        ("Say the memory of a block as it is now", "expected"),
        ("docs: Update memory per block", "expected"),
        ("docs: know the memory of a block", "is no verb"),
        ("docs: update " + "x" * 60, "characters"),
    ],
)
def test_subjects_are_judged(subject: str, fault: str) -> None:
    found = comment_rules.offence_of_subject(subject)
    assert fault in found and bool(fault) == bool(found)
