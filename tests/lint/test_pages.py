"""Pages are plain technical English, and the rules find what is not.

`pages_to_rewrite.txt` lists the pages that break the rules, one per line. A page that keeps them is taken off.
"""

from __future__ import annotations

import re
from pathlib import Path

import page_rules
import pytest
import word_rules

REPOSITORY = page_rules.REPOSITORY
EXCEPTIONS = REPOSITORY / "tests" / "lint" / "pages_to_rewrite.txt"
PAGES = sorted([*REPOSITORY.glob("*.md"), *(REPOSITORY / "docs").glob("*.md"), *(REPOSITORY / "docs").glob("*.ipynb")])

#: Beginnings of the names of the guide's pages; howto.md is their index
GUIDE = ("getting-started", "tutorial", "howto_", "modelling")


def exceptions() -> list[str]:
    """Pages that may break the rules."""
    return [line for line in EXCEPTIONS.read_text(encoding="utf-8").splitlines() if line]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_page_keeps_the_rules_or_stands_on_the_list(page: Path) -> None:
    name = str(page.relative_to(REPOSITORY))
    found = page_rules.offences(page)
    if name in exceptions():
        assert found != [], f"{name} keeps the rules: take it off {EXCEPTIONS.name}"
    else:
        assert found == []


@pytest.mark.parametrize("page", [page for page in PAGES if page.name.startswith(GUIDE)], ids=lambda page: page.name)
def test_guide_links_terms_to_the_glossary(page: Path) -> None:
    assert page_rules.unlinked_terms(page.read_text(encoding="utf-8")) == []


def test_glossary_has_the_terms_that_pages_link() -> None:
    heads = re.findall(r"^### (.*)$", (REPOSITORY / "docs/glossary.md").read_text(encoding="utf-8"), re.M)
    assert set(page_rules.TERMS) <= {head if head.startswith("Coulomb") else head.lower() for head in heads}
    assert page_rules.unlinked_terms("A horizontal load factor.\n\n[Hinges](glossary.md#hinge), hinges.") == [
        "horizontal load factor"]
    assert page_rules.unlinked_terms("The load\nfactor.") == ["load factor"]


def test_readme_fits_a_screen_and_the_list_of_changes_is_for_users() -> None:
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    assert len(readme.splitlines()) <= 70 and len(readme.split()) <= 500
    assert len((REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8").split()) <= 3000


def test_list_of_exceptions_names_pages_that_exist() -> None:
    assert [name for name in exceptions() if not (REPOSITORY / name).exists()] == []
    assert exceptions() == sorted(set(exceptions()))


def test_help_and_messages_have_no_phrase_that_pages_avoid() -> None:
    texts = [
        (file.name, line, text)
        for file in sorted((REPOSITORY / "src").rglob("*"))
        if file.suffix in (".f90", ".inc")
        for line, text in word_rules.messages(file.read_text(encoding="utf-8"))
    ]
    found = [(name, line, word.new) for name, line, text in texts for word in page_rules.PHRASES for _ in
             word.places(text)]
    assert len(texts) > 1000 and found == []


def test_texts_of_the_package_have_no_phrase_that_pages_avoid() -> None:
    files = sorted((REPOSITORY / "post").rglob("*.py"))
    known = [(file.name, line, text) for file in files for line, text in word_rules.texts(file.read_text("utf-8"))]
    words = [word for word in (*word_rules.WORDS, *page_rules.PHRASES) if not word.messages_only]
    found = [(name, line, word.new) for name, line, text in known for word in words for _ in word.places(text)]
    assert len(known) > 3000
    assert found == []
    made = 'def f():\n    """Told."""\n    raise ValueError(f"wanted {x} anew")\n'
    assert list(word_rules.texts(made)) == [(3, "wanted \N{HORIZONTAL ELLIPSIS} anew")]


WORDS = " ".join(["word"] * 19)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (f"Every {WORDS} here.", "words per sentence"),
        ("x" * 121, "121 characters"),
        ("| a | b | c |\n|---|---|\n| 1 | 2 | 3 |", "3 cells over 2 dashes"),
        ("The line of\nthrust touches.", "write thrust line"),
        ("The file has a row a case.", "write per"),
        ("`dda check` says what it computes.", "write computes"),
        ("What is unusual is listed.", "begin with the thing"),
        ("The length is 427.07752 m.", "427.07752"),
        ("Measured on 2026-11-23.", "history"),
        ("As `tests/cli/test_nothing.py` shows.", "there is no tests/cli"),
        ("As `test_nothing.py` shows.", "there is no test_nothing"),
    ],
)
def test_faults_are_found_with_their_line(tmp_path: Path, text: str, found: str) -> None:
    (tmp_path / "a.md").write_text(f"# A page\n\n{text}\n")
    (offence,) = page_rules.offences(tmp_path / "a.md")
    assert re.search(r"\ba\.md:[13]: ", offence) and found in offence


@pytest.mark.parametrize(
    "text",
    [
        "| " + "a table may be wide " * 10 + "|\n| --- |",
        "```\n" + "code may be wide " * 10 + "\n```",
        "[a link may be long](" + "a_long_name_" * 12 + ".md)",
        "What is a deck? A file.",
        "The value `0.1074241383` is code, 100 000 and 1000000 have one digit, and 0.107424 has six.",
        "The tests are `tests/lint/test_pages.py` and `src/*/*.f90`.",
        "See [10.1016/j.engstruct.2013.12.006](https://doi.org/10.1016/j.engstruct.2013.12.006).",
        "- " + "item\n- " * 50 + "last",
    ],
)
def test_good_pages_are_left_in_peace(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.md").write_text(f"# A page\n\n{text}\n")
    assert page_rules.offences(tmp_path / "a.md") == []


def test_sentences_are_counted_as_a_reader_counts_them() -> None:
    text = (
        "# Not this\n\nOne two [three four](a.md). Five `a b c` six $x + y$, e.g. Seven!\n\n"
        "* short item\n* an item of five words\n\n```\ncode. More.\n```\n| a | table. |\n"
    )
    assert [(s.line, s.length) for s in page_rules.sentences(text)] == [(3, 4), (3, 6), (6, 5)]
