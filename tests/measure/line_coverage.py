#!/usr/bin/env python3
"""Which lines of the Fortran sources the tests have run, counted by gcov.

usage: line_coverage.py SOURCE BUILD [--least PERCENT] [--missed]

BUILD was configured with the preset `coverage`, and its tests have run. Prints a line a folder and
the total; with --missed also the lines that no test has run. Ends with status 1 below PERCENT.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

Counts = dict[Path, dict[int, int]]  #: How often each line of a source was run


def count_lines(source: Path, build: Path) -> Counts:
    """Sum the counts of all objects that hold a line, by source and number; lines without code are left out."""
    counts: Counts = defaultdict(lambda: defaultdict(int))
    notes = sorted(path for path in build.rglob("*.gcno") if ".pf" not in str(path))
    for start in range(0, len(notes), 50):
        words = ["gcov", "--json-format", "--stdout", *map(str, notes[start : start + 50])]
        done = subprocess.run(words, cwd=build, capture_output=True, text=True, check=True)
        for text in done.stdout.splitlines():
            for file in json.loads(text)["files"] if text.startswith("{") else ():
                path = (build / file["file"]).resolve()
                if path.is_relative_to(source) and path.suffix in (".f90", ".inc"):
                    for line in file["lines"]:
                        counts[path][line["line_number"]] += line["count"]
    return counts


def ranges(numbers: list[int]) -> Iterator[str]:
    """Rising numbers in short: 3-5, 9."""
    first = last = numbers[0] if numbers else 0
    for number in [*numbers[1:], None]:
        if number is not None and number == last + 1:
            last = number
            continue
        if numbers:
            yield str(first) if first == last else f"{first}-{last}"
        first = last = number or 0


def main() -> int:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path)
    parser.add_argument("build", type=Path)
    parser.add_argument("--least", type=float, default=0.0, help="percent (default: 0)")
    parser.add_argument("--missed", action="store_true", help="list the lines that were not run")
    options = parser.parse_args()
    source = options.source.resolve()
    counts = count_lines(source, options.build.resolve())
    if not counts:
        print(f"no counts in {options.build}: configure with --preset coverage and run its tests")
        return 1
    folders: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for path, lines in sorted(counts.items()):
        missed = sorted(number for number, count in lines.items() if count == 0)
        for name in (path.parent.name, "all of it"):
            folders[name][0] += len(lines) - len(missed)
            folders[name][1] += len(lines)
        if options.missed and missed:
            print(f"{path.relative_to(source)}: {len(missed)} of {len(lines)}: " f"{', '.join(ranges(missed))}")
    for name in [*(name for name in folders if name != "all of it"), "all of it"]:
        run, of = folders[name]
        print(f"{name:12} {run:6} of {of:6} lines  {100 * run / of:6.2f} %")
    run, of = folders["all of it"]
    return 0 if 100 * run >= options.least * of else 1


if __name__ == "__main__":
    sys.exit(main())
