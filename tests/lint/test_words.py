"""Messages and pages are in the words of the field, and the rules find what is not."""

from __future__ import annotations

from pathlib import Path

import pytest
import word_rules

REPOSITORY = Path(__file__).resolve().parents[2]
PAGES = [REPOSITORY / "README.md", REPOSITORY / "CONTRIBUTING.md", *(REPOSITORY / "docs").rglob("*.md")]


def test_messages_of_the_program_are_in_the_words_of_the_field() -> None:
    files = [file for file in sorted((REPOSITORY / "src").rglob("*")) if file.suffix in (".f90", ".inc")]
    assert len(files) > 100
    assert [line for file in files for line in word_rules.offences_of_source(file)] == []


def test_pages_are_in_the_words_of_the_field() -> None:
    assert len(PAGES) > 10
    assert [line for page in sorted(PAGES) for line in word_rules.offences_of_page(page)] == []


@pytest.mark.parametrize(
    "text",
    [
        "arch%radius wants a number, found ten",
        "a coordinate of line 4 is wanted",
        "expected a file, found a folder",
        "&live expects x and y",
        "no edges were expected, none was found",
        "a list is parted by commas",
        "compute all anew",
        "the loop runs for ever",
        "remove it, or leave --out away",
        "all steps are spent",
        "sort them into rising order",
        "the nearest key is told",
        "points that are led",
        "a step without settling",
        "moment of momentum",
        "block 2 rests on nothing",
        "the loads are upright",
        "trailing text behind the last record",
        "the blocks fall at time 1",
    ],
)
def test_words_that_are_replaced_are_found(tmp_path: Path, text: str) -> None:
    half = text.rfind(" ")
    source = f'call fatal_error(error, "{text[:half]}"// & ! why\n   & "{text[half:]}; add it")\n'
    (tmp_path / "a.f90").write_text(source)
    assert len(word_rules.offences_of_source(tmp_path / "a.f90")) >= 1


@pytest.mark.parametrize("text", ["what is wanted here", "parted\nby a line", "to and\n  fro", "leave `sudo`\naway"])
def test_words_of_a_page_are_found_across_its_lines(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.md").write_text(f"# A page\n\nSo {text}.\n")
    (found,) = word_rules.offences_of_page(tmp_path / "a.md")
    assert found.startswith(f"{tmp_path / 'a.md'}:3: ")


@pytest.mark.parametrize(
    "text",
    [
        "arch%radius must be a number [m], got ten; correct it",
        "expected a file, got a folder; name a file in it",
        "there is no such file; check the name and the folder",
        "a part of a line; the parts are joined",
        "a block settles by 1 mm where its supports settle",
        "all of them but one; fortune is not for everyone",
        "nothing to resume, there are no results of this very deck",
        "the last row; stored in the table that led to it",
    ],
)
def test_good_words_are_left_in_peace(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.f90").write_text(f"wanted = told('{text}') ! what is wanted anew\n")
    (tmp_path / "a.md").write_text(text)
    assert word_rules.offences_of_source(tmp_path / "a.f90") == []
    assert word_rules.offences_of_page(tmp_path / "a.md") == []


def test_a_message_of_pieces_is_read_as_one(tmp_path: Path) -> None:
    source = 'x = "its wan"// &\n   & "ted "//name(i)//"; add "//"it" ! "told"\ny = 1 ! "anew"\nz = "a ""b"\n'
    read = list(word_rules.messages(source))
    assert [line for line, _ in read] == [1, 4]
    assert read[0][1].startswith("its wanted ") and read[0][1].endswith("; add it")
