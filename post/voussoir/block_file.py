"""The lines of a file of blocks, as entries with the rows below them."""

from __future__ import annotations

from collections.abc import Iterator

Entry = tuple[list[str], list[list[str]]]


def entries_of(text: str) -> Iterator[Entry]:
    """Words of each entry, in small letters without remarks, and the words of its rows, which begin with a number."""
    words: list[str] = []
    rows: list[list[str]] = []
    for line in [*text.splitlines(), "end"]:
        found = line.partition("!")[0].lower().split()
        if found and found[0][0] in "0123456789+-.":
            rows.append(found)
        elif found:
            if words:
                yield words, rows
            words, rows = found, []
