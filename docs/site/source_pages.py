#!/usr/bin/env python3
"""Write the pages on modules and tolerances from the sources: `python3 docs/site/source_pages.py DIR`."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Packages from the lowest layer up, and the purpose of each
PACKAGES = {
    "base": "Numbers, texts, errors as values",
    "theory": "Analytic solutions and exact arches, also compiled by f2py",
    "files": "Text and binary files, tables, tokens",
    "geometry": "Vectors, polygons, search of neighbours",
    "linalg": "The block matrix and its factor",
    "model": "Materials, blocks, joints, supports, settings",
    "mesh": "Lines to blocks (Shi: dc)",
    "joint_lines": "Joint sets, slopes and openings to lines (Shi: dl)",
    "formats": "Limerick files, plain and DDAML",
    "input": "Decks, files of blocks, records, joint maps",
    "output": "Tables and frames of results",
    "arch": "Arches as polygons and as chains",
    "submatrix": "Submatrices of one block (Shi: df11 to df16)",
    "contact": "Contact detection (Shi: df04 to df07), and the friction cone",
    "solver": "Joints on a graph: limit analysis, Coulomb's law, loading path, certificates",
    "statics": "Equilibrium without steps: joint graphs, chains, time histories",
    "step": "Steps and runs (Shi: df)",
    "limerick": "Shi's scheme",
    "search": "One decision, critical values, mechanisms",
    "scene": "The scene of a deck",
    "case": "One case of a deck: its computation and its rows",
    "app": "The command dda",
}
MODULES = """# Modules

Every module of `src/` by package, from the lowest layer up, with the first sentence of its source.
[architecture.md](architecture.md) describes the layers.
"""
TOLERANCES = """# Tolerances

Every threshold and limit of `src/` by package, with its module, constant, value and purpose. Relative thresholds name
their reference quantity. The module has further reasons.
"""
#: A named number at the beginning of a module, with the comment before it
CONSTANT = re.compile(r"((?: *!> ?.*\n)+) {3}(?:real\(wp\)|integer), parameter :: (\w+) = (\S.*)\n")
#: Constants that are no thresholds: numbers of mathematics and of tables
NO_THRESHOLD = re.compile(r"^(n_\w+|pi|degree|quarter|wp|unit_angle\w*|heyman_limit)$")


def main() -> None:
    """Write the pages into a folder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the pages")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages().items():
        (folder / name).write_text(text, encoding="utf-8")


def pages() -> dict[str, str]:
    """Pages by their names."""
    return {"modules.md": modules(), "tolerances.md": tolerances()}


def modules() -> str:
    """Table of the modules."""
    parts = [MODULES]
    for package, purpose in PACKAGES.items():
        parts.append(f"\n## {package}\n\n{purpose}.\n\n| module | purpose |\n| --- | --- |\n")
        for file in sorted((ROOT / "src" / package).glob("*.f90")):
            parts.append(f"| `{file.stem}` | {first_sentence(file)} |\n")
    return "".join(parts)


def tolerances() -> str:
    """Table of the thresholds."""
    parts = [TOLERANCES]
    for package in PACKAGES:
        rows = [row for file in sorted((ROOT / "src" / package).glob("*.f90")) for row in constants(file)]
        if rows:
            parts.append(f"\n## {package}\n\n| module: constant | value | purpose |\n| --- | --- | --- |\n")
            parts += rows
    return "".join(parts)


def constants(file: Path) -> list[str]:
    """Rows of the named numbers at the start of a module."""
    text = file.read_text(encoding="utf-8").split("\ncontains\n")[0]
    rows = []
    for comment, name, value in CONSTANT.findall(text):
        comment = " ".join(line.strip()[2:].strip() for line in comment.splitlines())
        reason = re.split(r"[.:;] ", comment)[0]
        if not NO_THRESHOLD.match(name):
            rows.append(f"| `{file.stem}`: `{name}` | {number(value)} | {reason} |\n".replace("\\|", "|"))
    return rows


def number(value: str) -> str:
    """Fortran number without its kind."""
    return re.sub(r"_wp\b", "", value).replace(".0e", "e").replace("e-0", "e-").replace("*", "\\*")


def first_sentence(file: Path) -> str:
    """First sentence of the head of a source, up to an empty line or a full stop."""
    head = []
    for line in file.read_text(encoding="utf-8").splitlines():
        if not line.startswith("!>") or not line[2:].strip():
            break
        head.append(line[2:].strip())
    text = re.split(r"(?<=[a-z0-9)])\. (?=[A-Z])", " ".join(head))[0].rstrip(".:")
    return text.replace("|", "\\|")


if __name__ == "__main__":
    main()
