#!/usr/bin/env python3
"""Runs every deck with every mode and geometry that its kind allows: each ends with a verdict or a refusal.

usage: every_model.py --dda DDA [--quick] [--keep DIR] [DECK ...]

DECK is one of input/benchmarks; all are run if none is named. What `dda help models` allows is run with the keys of
the deck that the mode has a use for, with all tables and pictures. A crash, a message that is none of the program's
own, a run without end or a table with numbers that are none is a finding: it is printed, its deck is kept in DIR, and
the status is 1. The debug build checks most: every bound, every number before its first use, every operation that
gives no number. --quick runs one case and few steps of each.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

BENCHMARKS = Path(__file__).resolve().parents[2] / "input" / "benchmarks"
#: Keys that other modes have no use for
USED = {"restitution": ("dynamic",), "damping": ("dynamic",), "unknowns": ("static", "dynamic"), "flow": ("static",)}
CHOSEN = ("mode", "geometry", "steps", "duration", "restart")  #: Keys that this check chooses
GROUP = re.compile(r"&(\w+)((?:'[^']*'|[^'/])*)/")
KEY = re.compile(r"(\w+)\s*=\s*((?:'[^']*'|[^'=])*?)\s*(?=,?\s*\w+\s*=|,?\s*$)")
MESSAGE = re.compile(r".+?:\d+: (error|warning): .")
NO_NUMBER = re.compile(r"(?<![a-z])(nan|inf|infinity)(?![a-z])", re.I)


def allowed_models(dda: str, kind: str) -> list[tuple[str, str]]:
    """Modes and geometries that the program runs scenes of a kind with."""
    rows = [[field.strip(" `") for field in line.split("|")[1:-1]] for line in subprocess.run(
        [dda, "help", "models"], capture_output=True, text=True, check=True).stdout.splitlines()]
    titles = rows[0]
    return [(row[0], row[1]) for row in rows[2:rows.index([])] if row[titles.index(kind)] == "yes"]


def is_used(key: str, mode: str, geometry: str) -> bool:
    """Whether a key of &analysis, or a sweep of it, is kept in a model."""
    if key in CHOSEN or (key == "restitution" and geometry != "current"):
        return False
    return mode in USED.get(key, (mode,))


def variant(text: str, source: Path, mode: str, geometry: str, quick: bool) -> str:
    """A deck with another mode and geometry, and all that it can write."""
    folder = source.resolve().parent
    blocks = source.with_suffix(".blocks")
    has_stages = blocks.exists() and re.search(r"^(remove|add) ", blocks.read_text(), re.M) is not None
    groups = [(name, dict(KEY.findall(body))) for name, body in GROUP.findall(re.sub(r"^!.*$", "", text, flags=re.M))]
    own: dict[str, str] = {}
    kept = []
    for name, keys in groups:
        if name == "analysis":
            own = {key: value for key, value in keys.items() if is_used(key, mode, geometry)}
        elif name == "sweep" and is_used(keys["parameter"].strip("'"), mode, geometry):
            # the sweep before may be gone
            kept.append((name, {key: value for key, value in keys.items() if key != "linked"}))
        elif name == "search" and mode != "dynamic":
            # what is found is right or not in other tests; here the runs count
            kept.append((name, keys | {"tolerance": "1e-2"}))
        elif name == "search":
            # one run, with the low end of what a search would vary
            group, _, parameter = keys.get("parameter", "''").strip("'").partition("%")
            for other, values in kept:
                if other == group and parameter and "low" in keys:
                    values.setdefault(parameter, keys["low"])
        elif name == "scene":
            kept.append((name, {key: value.replace("'", f"'{folder}/", 1) if key in ("geometry", "analysis") else value
                                for key, value in keys.items()}))
        elif name not in ("sweep", "search", "output"):
            kept.append((name, keys))
    steps = {"static": 400, "dynamic": 30 if quick else 100, "limerick": 100 if quick else 500}[mode]
    kept.append(("analysis", own | {"mode": f"'{mode}'", "geometry": f"'{geometry}'", "steps": str(steps)}))
    kept.append(("output", {"blocks": "T"} | ({"condition": "T"} if mode != "limerick" else {})
                 | ({"restart": "T"} if mode == "dynamic" else {})
                 | ({"energy": "T"} if mode == "dynamic" and not has_stages else {})
                 | ({"frames": "3"} if geometry == "current" and mode != "limerick" else {})))
    return "".join(f"&{name} {', '.join(f'{key} = {value}' for key, value in keys.items())} /\n" for name, keys in kept)


def is_own(text: str, mode: str, geometry: str) -> bool:
    """Whether a mode and a geometry are those of a deck."""
    keys = {key: value.strip("'") for name, body in GROUP.findall(text) if name == "analysis"
            for key, value in KEY.findall(body)}
    return (mode, geometry) == (keys.get("mode", "static"), keys.get("geometry", "reference"))


def finding(dda: str, deck: Path, own: bool, quick: bool) -> str:
    """Run a deck and say what is wrong with how it ends; empty if nothing is."""
    out = deck.with_suffix("")
    try:
        done = subprocess.run([dda, "run", deck, "--out", out, "--quiet", *(["--cases", "1"] if quick else [])],
                              capture_output=True, text=True, timeout=300 if quick else 3600, check=False)
    except subprocess.TimeoutExpired:
        return "does not end"
    strange = [line for line in done.stderr.splitlines() if not MESSAGE.match(line)]
    if done.returncode not in (0, 2, 3) or strange:
        return f"status {done.returncode}: {' '.join(strange[:6])}"
    if done.returncode == 2 and (own or not done.stderr):
        return f"is refused: {done.stderr.strip()}"
    for table in sorted(out.rglob("*.csv")):
        if NO_NUMBER.search(table.read_text()):
            return f"{table.name} has a number that is none"
    return ""


def main() -> int:
    """Run the decks and tell: 1 if something was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dda", required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("deck", nargs="*", type=Path)
    args = parser.parse_args()
    found = []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(os.cpu_count()) as pool:
        decks = []
        for source in args.deck or sorted(BENCHMARKS.glob("*.nml")):
            text = source.read_text()
            kind = re.search(r"kind *= *'(\w+)'", text)
            for mode, geometry in allowed_models(args.dda, kind[1] if kind else "arch"):
                deck = Path(folder) / f"{source.stem}_{mode}_{geometry}.nml"
                deck.write_text(variant(text, source, mode, geometry, args.quick))
                decks.append((deck, is_own(text, mode, geometry)))
        for (deck, _), wrong in zip(decks, pool.map(lambda one: finding(args.dda, *one, args.quick), decks)):
            if not wrong:
                continue
            found.append(deck)
            print(f"{deck.stem}: {wrong}", flush=True)
            if args.keep:
                args.keep.mkdir(parents=True, exist_ok=True)
                shutil.copy(deck, args.keep)
    print(f"{len(decks)} runs, {len(found)} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
