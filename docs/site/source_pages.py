#!/usr/bin/env python3
"""Write docs/modules.md and docs/tolerances.md from the sources: `python3 docs/site/source_pages.py`."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Rooms from the lowest floor up, and what each is for
ROOMS = {
    "base": "Numbers, texts, errors as values",
    "theory": "Analytic solutions and exact arches; stands alone, compiled by f2py too",
    "files": "Text and binary files, tables, tokens",
    "geometry": "Vectors, polygons, search of neighbours; knows no block",
    "linalg": "The matrix of blocks and its factor; knows no DDA",
    "model": "Materials, blocks, joints, supports, settings",
    "mesh": "Lines to blocks (Shi: dc)",
    "joint_lines": "Sets of joints, slopes and openings to lines (Shi: dl)",
    "formats": "Limerick files, plain and DDAML, and what VTU and XML files are made of",
    "input": "Decks, files of blocks, records, maps of joints",
    "output": "Tables and pictures of results",
    "arch": "Arches as polygons and as chains",
    "submatrix": "Submatrices of one block (Shi: df11 to df16)",
    "contact": "What touches (Shi: df04 to df07), and the friction cone",
    "solver": "Joints on a graph: interior springs, Coulomb's law, loading path, proofs",
    "statics": "Equilibrium without steps: the joint graph of a scene, chains, histories of loads",
    "step": "Steps and runs (Shi: df)",
    "limerick": "Shi's scheme",
    "search": "One decision, critical values, mechanisms; knows no deck",
    "scene": "The scene of a deck",
    "case": "One case of a deck: what it computes, and the rows that it writes",
    "app": "The command dda",
}
MODULES = """# Modules

Every module of `src/`, room by room from the lowest floor up, with the first sentence of its own head.
The page is written by `python3 docs/site/source_pages.py`.
[architecture.md](architecture.md) says what a room may import.
"""
TOLERANCES = """# Tolerances

Every threshold and limit of `src/`, room by room, with its reason. Each stands as a named constant in the module that
uses it, so that reason and use are read together; this page is the overview.
It is written by `python3 docs/site/source_pages.py`.
"""
#: A named number at the beginning of a module, with the comment before it
CONSTANT = re.compile(r"((?: *!> ?.*\n)+) {3}(?:real\(wp\)|integer), parameter :: (\w+) = (\S.*)\n")
#: Constants that are no thresholds: numbers of mathematics and of tables
NO_THRESHOLD = re.compile(r"^(n_\w+|pi|degree|quarter|wp|unit_angle\w*|heyman_limit)$")


def main() -> None:
    """Write the pages."""
    for name, text in pages().items():
        (ROOT / "docs" / name).write_text(text, encoding="utf-8")


def pages() -> dict[str, str]:
    """The pages as they should be, by their names."""
    return {"modules.md": modules(), "tolerances.md": tolerances()}


def modules() -> str:
    """Every module with what it is."""
    parts = [MODULES]
    for room, purpose in ROOMS.items():
        parts.append(f"\n## {room}\n\n{purpose}.\n\n| module | what it is |\n| --- | --- |\n")
        for file in sorted((ROOT / "src" / room).glob("*.f90")):
            parts.append(f"| `{file.stem}` | {first_sentence(file)} |\n")
    return "".join(parts)


def tolerances() -> str:
    """Every threshold with its reason."""
    parts = [TOLERANCES]
    for room in ROOMS:
        rows = [row for file in sorted((ROOT / "src" / room).glob("*.f90")) for row in constants(file)]
        if rows:
            parts.append(f"\n## {room}\n\n| module | name | value | reason |\n| --- | --- | --- | --- |\n")
            parts += rows
    return "".join(parts)


def constants(file: Path) -> list[str]:
    """Rows of the numbers that a module names at its beginning."""
    text = file.read_text(encoding="utf-8").split("\ncontains\n")[0]
    rows = []
    for comment, name, value in CONSTANT.findall(text):
        reason = " ".join(line.strip()[2:].strip() for line in comment.splitlines())
        if not NO_THRESHOLD.match(name):
            rows.append(f"| `{file.stem}` | `{name}` | {number(value)} | {reason} |\n".replace("\\|", "|"))
    return rows


def number(value: str) -> str:
    """A Fortran number without its kind."""
    return re.sub(r"_wp\b", "", value).replace(".0e", "e").replace("e-0", "e-").replace("*", "\\*")


def first_sentence(file: Path) -> str:
    """What a source says of itself first: its head up to an empty line, or to a stop."""
    head = []
    for line in file.read_text(encoding="utf-8").splitlines():
        if not line.startswith("!>") or not line[2:].strip():
            break
        head.append(line[2:].strip())
    text = re.split(r"(?<=[a-z0-9)])\. (?=[A-Z])", " ".join(head))[0].rstrip(".:")
    return text.replace("|", "\\|")


if __name__ == "__main__":
    main()
