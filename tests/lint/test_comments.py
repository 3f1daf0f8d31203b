"""Doc comments and commits begin with a verb or a noun phrase, and the rules find what does not."""

from __future__ import annotations

from pathlib import Path

import comment_rules
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
#: Doc comments of each folder that begin with a clause: these numbers may only become smaller
CEILINGS = {"src": 752, "post": 103, "tests": 306}
#: Newest commits whose subjects are checked
COMMITS = 8


@pytest.mark.parametrize("folder", CEILINGS)
def test_doc_comments_that_begin_with_a_clause_become_fewer(folder: str) -> None:
    found = list(comment_rules.openings(REPOSITORY / folder))
    assert len(found) <= CEILINGS[folder], "\n".join(found[-20:])


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
