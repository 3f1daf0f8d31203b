"""Check that a test executable reports the failures that its .pf files announce, and no others.

A comment ``! fails: text | text`` announces that the next line is reported, once, with these
texts below it. Read is the report of pFUnit or of the in-tree runner: both write the place as
[file:line] below the name of the test. A comma counts as a blank: pFUnit writes an index as [2,3].
"""

import argparse
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

ANNOUNCEMENT = re.compile(r"\s*! fails:(.*)")
PLACE = re.compile(r"\[(\w+\.pf):(\d+)\]")
CLOSING = (re.compile(r"FAILED  \((?P<failed>\d+) of (?P<run>\d+) tests\)"),
           re.compile(r"Tests run: (?P<run>\d+), Failures: (?P<failed>\d+), Errors: 0"))


def announced(path: Path) -> dict[tuple[str, int], list[str]]:
    """List the failures that a .pf file announces: texts to be found in the report, by file name and line."""
    found = {}
    for number, line in enumerate(path.read_text("utf-8").split("\n"), start=1):
        if match := ANNOUNCEMENT.fullmatch(line):
            texts = [text.strip() for text in match[1].split("|")]
            found[path.name, number + 1] = [text for text in texts if text]
    return found


def reported(output: str) -> list[tuple[tuple[str, int], str]]:
    """List the failures of a report: place and text of each, up to the next one."""
    places = list(PLACE.finditer(output))
    ends = [place.start() for place in places[1:]] + [len(output)]
    return [((place[1], int(place[2])), output[place.end():end].replace(",", " ")) for place, end in zip(places, ends)]


def disagreements(output: str, status: int, sources: list[Path]) -> list[str]:
    """Compare a report with what its .pf files announced: a sentence for each disagreement."""
    wanted = {place: texts for path in sources for place, texts in announced(path).items()}
    found = reported(output)
    tests = sum(line.strip().lower() == "@test" for path in sources for line in path.read_text("utf-8").split("\n"))
    problems = [] if status == 2 else [f"exit status 2 was wanted, found {status}"]
    times = Counter(place for place, _ in found)
    for place in sorted(wanted.keys() | times.keys()):
        if times[place] != (place in wanted):
            problems.append(f"{place[0]}:{place[1]} was announced {int(place in wanted)} times "
                            f"and reported {times[place]} times")
    problems += [f"{place[0]}:{place[1]}: no '{text}' in its report"
                 for place, report in found for text in wanted.get(place, []) if text not in report]
    closing = next(filter(None, (form.search(output) for form in CLOSING)), None)
    counts = {"run": str(tests), "failed": str(len(wanted))}
    if closing is None or closing.groupdict() != counts:
        problems.append(f"the closing line should count {counts}, found "
                        f"{closing.groupdict() if closing else 'none'}")
    return problems


def main() -> None:
    """Run the executable and compare."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("executable", type=Path)
    parser.add_argument("sources", type=Path, nargs="+", help=".pf files it was made of")
    arguments = parser.parse_args()
    run = subprocess.run([arguments.executable.resolve()], capture_output=True, text=True, check=False)
    problems = disagreements(run.stdout, run.returncode, arguments.sources)
    if problems:
        sys.exit("\n".join([run.stdout, run.stderr, *problems]))
    total = sum(len(announced(path)) for path in arguments.sources)
    print(f"{total} failures reported as announced")


if __name__ == "__main__":
    main()
