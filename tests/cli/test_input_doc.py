"""docs/input.md has one row per key of the registry, with the texts that `dda help keys` prints."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from dda_command import run_dda

DOC = (Path(__file__).resolve().parents[2] / "docs/input.md").read_text(encoding="utf-8")
#: Ranges that the page has in other words than the registry
OTHER_RANGES = {("analysis", "unknowns"): "3 or 6, whole", ("search", "parameter"): "name",
                ("sweep", "parameter"): "name"}


def keys() -> dict[tuple[str, str], dict]:
    """Keys of the registry by group and name."""
    groups = json.loads(run_dda("help", "keys", "--json").stdout)["groups"]
    return {(group["name"], key["name"]): key for group in groups for key in group["keys"]}


def number(value: float) -> str:
    """A number as people write it: 1e-9 and 1e12."""
    return re.sub(r"e([-+])0*", lambda sign: "e" + sign[1].strip("+"), f"{value:g}")


def range_of(key: dict) -> str:
    """The range of a key as the page writes it."""
    kinds = {"flag": "flag", "text": "text", "words": "list of words"}
    if key["kind"] in kinds:
        return kinds[key["kind"]]
    if key["kind"] == "word":
        return ", ".join(f"'{word}'" for word in key["words"])
    if "from" not in key:
        return "list of numbers"
    text = f"{'(' if 'above' in key else '['}{number(key['from'])}, {number(key['to'])}{')' if 'below' in key else ']'}"
    return {"whole": f"{text}, whole", "numbers": f"list in {text}"}.get(key["kind"], text)


def row_of(place: tuple[str, str], key: dict) -> tuple[str, str, str, str]:
    """Unit, range, default and meaning of a key as the page writes them, without marks."""
    default = key.get("default") or f"({key['without']})"
    return key.get("unit", ""), OTHER_RANGES.get(place, range_of(key)), default, key["meaning"]


def documented() -> dict[tuple[str, str], tuple[str, ...]]:
    """Rows of the tables of keys by group and name, without code marks and links."""
    rows = {}
    for section in re.split(r"^### ", DOC, flags=re.M)[1:]:
        for line in section.split("\n## ")[0].splitlines()[1:]:
            name, *cells = (cell.strip() for cell in line.strip("| ").split("|"))
            if re.fullmatch(r"`\w+`", name):
                plain = (re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", cell).replace("`", "") for cell in cells)
                rows[section.split()[0], name.strip("`")] = tuple(plain)
    return rows


REGISTRY, ROWS = keys(), documented()


@pytest.mark.parametrize("place", REGISTRY, ids="%".join)
def test_row_of_a_key_is_that_of_the_help(place: tuple[str, str]) -> None:
    assert ROWS.get(place) == row_of(place, REGISTRY[place])


def test_page_has_no_other_keys_and_meanings_are_short() -> None:
    assert set(ROWS) == set(REGISTRY) and len(ROWS) > 100
    long = [place for place, key in REGISTRY.items() if len(key["meaning"].split()) > 15]
    assert long == []
