#!/usr/bin/env python3
"""Put single faults into src/, one after the other, and tell which test finds each.

The tree is copied and built once, with lines counted: a program that never runs the faulty statement cannot find
it and is left out. Each fault is built incrementally in the copy. The unit tests of the fault's room run first,
then those of the other rooms, then the physics, at both levels with the tests of the command that are marked so,
then, if asked, the other tests of the command and of Python, those first that are about the room. The table has
a row for each fault as soon as it is known.
"""

from __future__ import annotations

import argparse
import csv
import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "measure"))
from faults import Fault, draw_faults  # noqa: E402
from line_coverage import count_lines  # noqa: E402

PARTS = ("CMakeLists.txt", "CMakePresets.json", "cmake", "src", "tests", "post", "input", "docs", "pyproject.toml",
         "README.md", "CITATION.cff", "LICENSE", "CHANGELOG.md")
COLUMNS = ("number", "room", "file", "line", "kind", "before", "after", "result", "level", "found_by", "seconds")
LEVELS = ("room", "unit", "physics", "suite")
#: Tests of the command and of Python that ctest counts as unit tests or physics
COMMAND = "command_"
#: Files of tests/cli that are about a room, by the beginning of their names after test_
ABOUT = {
    "arch": "arch mechanism_roles paper_tables bad_input",
    "base": "screen_table results check",
    "case": "reactions joint_map told_blocks restart resume run results large_limerick limerick scene_columns",
    "contact": "block fallen wedges pressed ties jointed_slopes",
    "formats": "limerick cut lines fuzz_limerick large_limerick",
    "geometry": "cut block wedges tiny_blocks extreme_blocks",
    "input": "block_files bad_input messages check models joint_map histories bars stages water vehicle",
    "joint_lines": "joint_map lines jointed_slopes",
    "limerick": "limerick large_limerick",
    "linalg": "large_blocks block",
    "mesh": "cut lines joint_map limerick",
    "model": "water ground block_files histories held",
    "output": "results run cut restart",
    "scene": "fill water vehicle live_loads arch_shapes lines line_export ties limerick_blocks",
    "search": "stages search_in_time vehicle loading_path path_start live_loads models",
    "solver": "loading_path residual_friction crushing proofs wedges jointed_slopes live_loads",
    "statics": "histories pressed_blocks live_loads bars arch_exact",
    "step": "energy ramp static_start ground absorbing reactions fallen stages displacement_factor",
    "submatrix": "bars ties water ground energy absorbing",
}


@dataclass
class Copy:
    """A copy of the tree, and what its tests take without a fault."""

    root: Path
    jobs: int
    limit: float
    usual: dict[str, float] = field(default_factory=dict)
    #: Lines that hold code, by file, and whether each program has run them
    ran: dict[str, dict[Path, dict[int, int]]] = field(default_factory=dict)

    @property
    def build(self) -> Path:
        """Its build folder."""
        return self.root / "build"

    def make(self, *targets: str) -> bool:
        """Build some targets; whether they compile."""
        command = ["cmake", "--build", str(self.build), "-j", str(self.jobs), "--target", *targets]
        return subprocess.run(command, capture_output=True).returncode == 0

    def reaches(self, program: str, fault: Fault) -> bool:
        """Whether a test program runs the faulty statement, or something of a file that knows a faulty constant."""
        path = self.root / fault.path
        if "parameter" not in fault.before:
            return runs(self.ran[program].get(path, {}), path, fault.line)
        return any(other.suffix == ".f90" and any(counts.values())
                   and (other == path or f"use {path.stem}," in other.read_text())
                   for other, counts in self.ran[program].items())

    def count(self, program: str) -> None:
        """Keep which lines a program has run in its last run."""
        counted = self.root / "counted"
        for data in counted.rglob("*.gcda"):
            notes = Path("/", *data.relative_to(counted).parts).with_suffix(".gcno")
            shutil.copyfile(notes, data.with_suffix(".gcno"))
        self.ran[program] = count_lines(self.root, counted) if counted.exists() else {}
        shutil.rmtree(counted, ignore_errors=True)

    def make_programs(self, programs: list[str]) -> bool:
        """Build test programs, for tests of the command what they call; whether they compile."""
        called = ["dda", "_theory"] if any(program.startswith(COMMAND) for program in programs) else []
        return self.make(*(program for program in programs if not program.startswith(COMMAND)), *called)

    def run(self, program: str) -> tuple[str, float]:
        """Run a test program: the test that failed, or nothing, and the seconds it took."""
        shutil.rmtree(self.root / "counted", ignore_errors=True)
        if not program.startswith(COMMAND):
            return self.finish([str(self.build / "tests" / "bin" / program)], program, self.build / "tests")
        return self.finish(["ctest", "--test-dir", str(self.build), "--output-on-failure", "-R", f"^{program}$"],
                           program, self.root)

    def run_pytest(self, room: str) -> tuple[str, float]:
        """Run tests of the command and of Python until one fails, first what is about the room."""
        tests = self.root / "tests"
        about = tuple(f"test_{word}" for word in ABOUT.get(room, "").split())
        files = sorted(tests.glob("cli/test_*.py"), key=lambda path: not path.name.startswith(about or "-"))
        if room == "theory":
            files = sorted(tests.glob("post/test_theory*.py")) + files
        else:
            files += [tests / "post" / f"test_{name}.py" for name in ("verify", "validation", "stability", "vtu")]
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *map(str, files)]
        return self.finish(command, "suite", self.root)

    def finish(self, command: list[str], name: str, folder: Path) -> tuple[str, float]:
        """Wait for a command, ten times as long as it takes without a fault at most."""
        limit = max(20.0, 10.0 * self.usual[name]) if name in self.usual else self.limit
        environment = {**os.environ, "DDA": str(self.build / "bin" / "dda"), "OMP_NUM_THREADS": "1",
                       "VOUSSOIR_BUILD": str(self.build), "PYTHONPATH": str(self.build / "python"),
                       "GCOV_PREFIX": str(self.root / "counted")}
        start = time.monotonic()
        try:
            done = subprocess.run(command, cwd=folder, env=environment, timeout=limit, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace")
        except subprocess.TimeoutExpired:
            return f"{name}: time limit", time.monotonic() - start
        taken = time.monotonic() - start
        if done.returncode == 0:
            return "", taken
        failed = re.search(r"\w+_suite\.(\w+) FAILED|^FAILED (\S+)", done.stdout, re.MULTILINE)
        if failed:
            return failed.group(1) or failed.group(2), taken
        begun = re.findall(r"_suite\.(\w+)", done.stdout)
        return f"{begun[-1]} (crash)" if begun else f"{name} (crash)", taken


def runs(counts: dict[int, int], path: Path, line: int) -> bool:
    """Whether the statement of a line was run; one that is not counted, such as a default, where its file was."""
    text = path.read_text().splitlines()
    first = last = line
    while first > 1 and text[first - 2].split("!", 1)[0].rstrip().endswith("&"):
        first -= 1
    while last < len(text) and text[last - 1].split("!", 1)[0].rstrip().endswith("&"):
        last += 1
    here = [counts[number] for number in range(first, last + 1) if number in counts]
    return any(here or counts.values())


def copy_changed(source: Path, target: Path) -> None:
    """Copy what differs; its new time makes the build take it in, even where a fault was taken out."""
    for path in [source, *sorted(source.rglob("*"))] if source.is_dir() else [source]:
        other = target / path.relative_to(source)
        if path.is_dir() or "__pycache__" in path.parts:
            continue
        if not other.exists() or other.read_bytes() != path.read_bytes():
            other.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, other)
            shutil.copymode(path, other)


def prepare(source: Path, copy: Copy, asked: argparse.Namespace) -> list[str]:
    """Copy the tree and build all test programs without a fault; the names of those of units."""
    for part in PARTS if source != copy.root else ():
        if (source / part).exists():
            copy_changed(source / part, copy.root / part)
    if not (copy.build / "CMakeCache.txt").exists():
        subprocess.run(["cmake", "-S", copy.root, "-B", copy.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        f"-DCMAKE_Fortran_FLAGS_RELEASE={asked.flags}", "-DVOUSSOIR_COVERAGE=ON"],
                       check=True, stdout=subprocess.DEVNULL)
    listed = (copy.root / "tests" / "CMakeLists.txt").read_text()
    units = re.findall(r"add_pfunit_ctest\((unit_\w+)", listed)
    if not copy.make(*units, "physics", "dda", "_theory"):
        raise SystemExit(f"{copy.build}: does not build without a fault")
    return units


def programs_of(levels: list[str], units: list[str]) -> list[str]:
    """All that is run once without a fault."""
    programs = [*units, COMMAND + "unit"] if "unit" in levels else units
    return programs + [name for level, names in (("physics", ["physics", COMMAND + "physics"]), ("suite", ["suite"]))
                       if level in levels for name in names]


def judge(fault: Fault, copy: Copy, units: list[str], asked: argparse.Namespace) -> dict[str, object]:
    """What becomes of one fault that is in the copy."""
    own = f"unit_{fault.path.parts[1]}"
    start = time.monotonic()
    levels = [("room", [own] if own in units else []),
              ("unit", [name for name in [*units, COMMAND + "unit"] if name != own]),
              ("physics", [COMMAND + "physics", "physics"])]
    for level, programs in levels:
        if level not in asked.levels:
            continue
        programs = [program for program in programs if copy.reaches(program, fault)]
        if programs and not copy.make_programs(programs):
            return {"result": "does not compile"}
        start = time.monotonic() if level == "room" else start
        for program in programs:
            test, _ = copy.run(program)
            if test:
                return {"result": "found", "level": level, "found_by": f"{program}: {test}",
                        "seconds": round(time.monotonic() - start, 1)}
    if "suite" in asked.levels:
        copy.make_programs([COMMAND])
        test, _ = copy.run_pytest(fault.path.parts[1])
        if test:
            return {"result": "found", "level": "suite", "found_by": test,
                    "seconds": round(time.monotonic() - start, 1)}
    return {"result": "survived", "seconds": round(time.monotonic() - start, 1)}


def read_faults(path: Path) -> list[Fault]:
    """Faults of a table that was written before, those that were found left out."""
    with path.open(newline="") as lines:
        return [Fault(Path(row["file"]), int(row["line"]), row["kind"], row["before"], row["after"])
                for row in csv.DictReader(lines) if row["result"] in ("", "survived")]


def report(rows: list[dict[str, object]]) -> str:
    """One line a room: how many faults, found where."""
    lines = ["room          faults   room   unit  physics suite  survived"]
    for room in [*sorted({str(row["room"]) for row in rows}), "all"]:
        mine = [row for row in rows if room in ("all", row["room"]) and row["result"] != "does not compile"]
        count = [sum(row.get("level") == level for row in mine) for level in LEVELS]
        survived = sum(row["result"] == "survived" for row in mine)
        lines.append(f"{room:12}{len(mine):8}{count[0]:7}{count[1]:7}{count[2]:9}{count[3]:6}{survived:10}")
    return "\n".join(lines)


def arguments() -> argparse.Namespace:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    root = Path(__file__).resolve().parents[2]
    parser.add_argument("--source", type=Path, default=root, help="folder of the project")
    parser.add_argument("--work", type=Path, required=True, help="folder of the copy and of the table")
    parser.add_argument("--count", type=int, default=400, help="number of faults [400]")
    parser.add_argument("--seed", type=int, default=1, help="where the random numbers begin [1]")
    parser.add_argument("--rooms", nargs="*", help="folders of src/ [all but app and files]")
    parser.add_argument("--again", type=Path, help="a table: judge those of its faults that survived")
    parser.add_argument("--levels", nargs="*", default=LEVELS[:3], choices=LEVELS, help="what runs [all but suite]")
    parser.add_argument("--in-place", action="store_true", help="the source is itself a copy, and built: no other one")
    parser.add_argument("--list", action="store_true", help="write the table of faults and stop")
    parser.add_argument("--jobs", type=int, default=2, help="compilers at a time [2]")
    parser.add_argument("--flags", default="-O1", help="flags of the compiler [-O1]")
    return parser.parse_args()


def main() -> int:
    """Put in, build, test, take out; write the table."""
    asked = arguments()
    rooms = asked.rooms or sorted(path.name for path in (asked.source / "src").iterdir()
                                  if path.is_dir() and path.name not in ("app", "files"))
    faults = read_faults(asked.again) if asked.again else draw_faults(asked.source, rooms, asked.count, asked.seed)
    asked.work.mkdir(parents=True, exist_ok=True)
    table = asked.work / "mutants.csv"
    copy = Copy(asked.source if asked.in_place else (asked.work / "tree").resolve(), asked.jobs, 3600.0)
    units: list[str] = []
    if not asked.list:
        units = prepare(asked.source, copy, asked)
        for program in programs_of(asked.levels, units):
            test, copy.usual[program] = copy.run_pytest("") if program == "suite" else copy.run(program)
            if test:
                print(f"{program} fails without a fault: {test}", file=sys.stderr)
                return 1
            if program != "suite":
                copy.count(program)
    rows: list[dict[str, object]] = []
    with table.open("w", newline="") as lines:
        writer = csv.DictWriter(lines, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for number, fault in enumerate(faults, 1):
            row: dict[str, object] = {"number": number, "room": fault.path.parts[1], "file": fault.path.as_posix(),
                                      "line": fault.line, "kind": fault.kind, "before": fault.before.strip(),
                                      "after": fault.after.strip()}
            if not asked.list:
                row.update(with_fault(fault, copy, units, asked))
                print(f"{number:4} {row['result']:9} {fault.path}:{fault.line} {row.get('found_by', row['after'])}",
                      flush=True)
            rows.append(row)
            writer.writerow(row)
            lines.flush()
    if not asked.list:
        print(report(rows))
    return 0


def with_fault(fault: Fault, copy: Copy, units: list[str], asked: argparse.Namespace) -> dict[str, object]:
    """Put one fault into the copy, judge it, and take it out again."""
    path = copy.root / fault.path
    sound = path.read_text()
    lines = sound.splitlines(keepends=True)
    place = fault.line - 1
    indent = lines[place][:len(lines[place]) - len(lines[place].lstrip())]
    if lines[place].strip() != fault.before.strip():
        return {"result": "does not compile"}
    lines[place] = indent + fault.after.strip() + "\n"
    try:
        path.write_text("".join(lines))
        return judge(fault, copy, units, asked)
    finally:
        path.write_text(sound)


if __name__ == "__main__":
    sys.exit(main())
