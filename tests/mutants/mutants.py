#!/usr/bin/env python3
"""Put single faults into src/, one after the other, and tell which test finds each.

The tree is copied and built once, each package as a shared library. A fault seldom changes what a module offers: then
one object is compiled and its package linked again, and every program meets the fault without being linked itself;
else the build sees to it. The unit tests of the fault's package run first, then those of the others, those whose
tests name the module first. What survives these is judged several at a time: with all of them put in,
the physics and what ctest counts as such run, then, if asked, all other tests; what fails is asked of each fault
alone, until nothing fails of those that are left. A test that fails without a fault finds none, and the next one is
asked. A process may take five times the processor time that it takes without a fault. The table is written whenever
a fault is judged.
"""

from __future__ import annotations

import argparse
import csv
import filecmp
import json
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Iterable, Iterator

from faults import Fault, draw_faults

PARTS = ("CMakeLists.txt", "CMakePresets.json", "cmake", "src", "tests", "post", "input", "docs", "pyproject.toml",
         "README.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "CHANGELOG.md")
COLUMNS = ("number", "package", "file", "line", "kind", "before", "after", "result", "level", "found_by", "seconds")
LEVELS = ("package", "unit", "physics", "suite")
#: What ctest runs at the levels that are asked of several faults at once
PROGRAMS = {"physics": ("command_unit", "physics", "command_physics"),
            "suite": ("every_model", "cli", "motion", "post", "fuzz_blocks", "fuzz_restart", "fuzz")}
MOST_SECONDS = 60  #: A run of `dda` may take so many seconds of processor


@dataclass
class Copy:
    """A copy of the tree, what its test programs are, and what they take without a fault."""

    root: Path
    jobs: int
    units: dict[str, str] = field(default_factory=dict)  #: Unit programs, and the text of their tests
    objects: dict[str, list[dict[str, str]]] = field(default_factory=dict)  #: How each object is compiled, by source
    usual: dict[str, tuple[float, float]] = field(default_factory=dict)  #: Seconds of processor and of the clock
    commands: dict[str, list[str]] = field(default_factory=dict)  #: What ctest runs, by name

    @property
    def build(self) -> Path:
        """Its build folder."""
        return self.root / "build"

    @property
    def limited(self) -> Path:
        """The program in its build folder, for so many seconds of processor."""
        return self.build / "limited" / "dda"

    def prepare(self, source: Path, flags: str) -> None:
        """Copy what differs from the source, and build it without a fault."""
        for part in PARTS:
            if (source / part).exists():
                copy_changed(source / part, self.root / part)
        if not (self.build / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", self.root, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                            f"-DCMAKE_Fortran_FLAGS_RELEASE={flags}", "-DVOUSSOIR_ROOMS=SHARED",
                            "-DCMAKE_LINK_DEPENDS_NO_SHARED=ON", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"],
                           check=True, stdout=subprocess.DEVNULL)
        listed = (self.root / "tests" / "CMakeLists.txt").read_text()
        for name, files in re.findall(r"add_pfunit_ctest\((unit_\w+)\s+TEST_SOURCES([^)]*?)LINK", listed):
            self.units[name] = "".join((self.root / "tests" / file).read_text() for file in files.split())
        if not self.make():
            raise SystemExit(f"{self.build}: does not build without a fault")
        for entry in json.loads((self.build / "compile_commands.json").read_text()):
            if "/voussoir.dir/" not in entry["command"]:
                self.objects.setdefault(entry["file"], []).append(entry)
        listed = subprocess.check_output(["ctest", "--test-dir", self.build, "--show-only=json-v1"], text=True)
        self.commands = {test["name"]: test["command"] for test in json.loads(listed)["tests"] if "command" in test}
        self.limited.parent.mkdir(exist_ok=True)
        self.limited.write_text(f'#!/bin/sh\nulimit -t {MOST_SECONDS}\nexec "{self.build}/bin/dda" "$@"\n')
        self.limited.chmod(0o755)

    def make(self) -> bool:
        """Build all that tests run; whether it compiles."""
        command = ["cmake", "--build", str(self.build), "-j", str(self.jobs), "--target", *self.units, "physics", "dda",
                   "_theory"]
        return subprocess.run(command, capture_output=True).returncode == 0

    @contextmanager
    def faulty(self, faults: list[Fault]) -> Iterator[bool]:
        """Have every program meet faults of different lines; whether they compile."""
        sound = {path: (path.read_text(), path.stat().st_mtime_ns) for path in {self.root / f.path for f in faults}}
        for path, (text, _) in sound.items():
            lines = text.splitlines(keepends=True)
            for fault in faults:
                if self.root / fault.path == path:
                    lines[fault.line - 1] = fault.after + "\n"
            path.write_text("".join(lines))
        objects = {path: self.compile_alone(path) for path in sound}
        compiles = () not in objects.values()
        others_depend = compiles and None in objects.values()
        packages: list[Path] = []
        if not others_depend:  # the build may not see that anything was changed
            for path, (text, at) in sound.items():
                path.write_text(text)
                os.utime(path, ns=(at, at))
        try:
            if others_depend:
                compiles = self.make()
            elif compiles:
                for name in {path.parent.name for path in sound}:
                    package = self.build / f"src/libvoussoir_{name}.so"
                    package.rename(package.with_suffix(".sound"))
                    packages.append(package)
                    self.link_package(package.name, [objects[path] for path in sound if path.parent.name == name])
            yield compiles
        finally:
            for package in packages:
                package.with_suffix(".sound").replace(package)
            if others_depend:
                for path, (text, _) in sound.items():
                    path.write_text(text)
                self.make()

    def compile_alone(self, path: Path) -> tuple[str, Path] | None | tuple[()]:
        """The sound object's name and the faulty object; none where others depend on the change, () on an error."""
        entries = self.objects[str(path)]
        if len(entries) != 1:
            return None
        words = shlex.split(entries[0]["command"])
        scratch = self.root / "scratch" / path.stem
        shutil.rmtree(scratch, ignore_errors=True)
        scratch.mkdir(parents=True)
        modules = Path(next(word[2:] for word in words if word.startswith("-J")))
        output = words[words.index("-o") + 1]
        words = [f"-J{scratch}" if word.startswith("-J") else word for word in words] + ["-I", str(modules), "-w"]
        words[words.index("-o") + 1] = str(scratch / "faulty.o")
        if subprocess.run(words, cwd=entries[0]["directory"], capture_output=True).returncode != 0:
            return ()
        same = all(filecmp.cmp(new, self.build / modules / new.name, shallow=False) for new in scratch.glob("*.*mod"))
        return (output, scratch / "faulty.o") if same else None

    def link_package(self, name: str, objects: list[tuple[str, Path]]) -> None:
        """Link a package with faulty objects in the place of the sound ones."""
        steps = subprocess.run(["ninja", "-C", self.build, "-t", "commands", "-s", f"src/{name}"], check=True,
                               capture_output=True, text=True).stdout
        command = next(line for line in steps.splitlines() if f"-o src/{name}" in line)
        for output, faulty in objects:
            command = command.replace(f" {output} ", f" {faulty} ")
        subprocess.run(command, shell=True, cwd=self.build, check=True, capture_output=True)

    def programs(self, level: str, fault: Fault) -> list[str]:
        """The unit programs of a level that hold the faulty package, the likely and the short ones first."""
        own = f"unit_{fault.path.parts[1]}"
        if level == "package":
            return [own] if own in self.units else []
        others = [name for name in self.units if name != own and self.holds(name, fault.path.parts[1])]
        return sorted(others, key=lambda name: (f"use {fault.path.stem}," not in self.units[name], self.usual[name]))

    def holds(self, program: str, package: str) -> bool:
        """Return true if a program is linked with a package."""
        linked = subprocess.run(["ldd", self.build / "tests" / "bin" / program], capture_output=True, text=True).stdout
        return f"libvoussoir_{package}.so" in linked

    def run(self, program: str, tests: Iterable[str] = ()) -> list[str]:
        """Run a program, or tests of it that failed before: the tests that fail."""
        command = self.commands.get(program) or [str(self.build / "tests" / "bin" / program)]
        tests = [test for test in tests if not test.startswith(f"{program} (")]
        if "pytest" in command:
            head = command[:command.index("--basetemp") + 2]
            words = command[len(head):]
            if "--maxfail" in words:
                words = words[words.index("--maxfail") + 2:]
            command = [*head, "--maxfail", "1" if tests else "40", *(tests or words)]
        elif tests and program == "physics":
            command = [*command, "-f", tests[0].split()[0]]
        return self.finish(command, program)

    def finish(self, command: list[str], name: str) -> list[str]:
        """Wait for a command, each of its processes for a time; the tests that failed."""
        by_runner = name in self.units or name == "physics"
        usual = self.usual.get(name, (600.0, 3600.0))
        limit = int(max(10.0, 5.0*usual[0])) if by_runner else 1500
        environment = {**os.environ, "DDA": str(self.limited), "OMP_NUM_THREADS": "1",
                       "VOUSSOIR_BUILD": str(self.build), "PYTHONPATH": str(self.build / "python")}
        start, used = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        process = subprocess.Popen(command, cwd=self.root / "tests", env=environment, text=True,
                                   start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   errors="replace",
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
        try:
            printed, _ = process.communicate(timeout=max(60.0, 10.0*usual[1]))
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return [f"{name} (time limit)"]
        taken = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.usual.setdefault(name, (taken.ru_utime + taken.ru_stime - used.ru_utime - used.ru_stime,
                                     time.monotonic() - start))
        if process.returncode == 0:
            return []
        failed = re.findall(r"\w+_suite\.(\w+) FAILED|^(?:FAILED|ERROR) (\S+\.py.*?)(?: - |$)", printed, re.MULTILINE)
        if failed:
            return list(dict.fromkeys(one or other for one, other in failed))
        end = "time limit" if process.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else "crash"
        begun = re.findall(r"_suite\.(\w+)", printed)
        return [f"{begun[-1] if begun else name} ({end})"]

    def failing(self, level: str) -> list[tuple[str, str]]:
        """Programs and tests of a level that fail."""
        failed = []
        for program in (program for program in PROGRAMS[level] if program in self.commands):
            tests = self.run(program)
            print(f"     {program}: {len(tests)} of its tests fail", flush=True)
            failed += [(program, test) for test in tests]
        return failed

    def first_failing(self, checks: list[tuple[str, str]]) -> tuple[str, str] | None:
        """The first of several tests that fails."""
        for program in dict.fromkeys(program for program, _ in checks):
            tests = [test for name, test in checks if name == program]
            for some in [tests] if "pytest" in self.commands[program] else [[test] for test in tests]:
                failed = self.run(program, some)
                if failed:
                    return program, failed[0]
        return None


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


def judge(fault: Fault, copy: Copy, levels: list[str]) -> dict[str, object]:
    """What becomes of one fault by unit programs."""
    with copy.faulty([fault]) as compiles:
        if not compiles:
            return {"result": "does not compile"}
        start = time.monotonic()
        for level in levels:
            for program in copy.programs(level, fault):
                test = copy.run(program)
                if test:
                    return {"result": "found", "level": level, "found_by": f"{program}: {test[0]}",
                            "seconds": round(time.monotonic() - start, 1)}
        return {"result": "survived", "seconds": round(time.monotonic() - start, 1)}


def judge_together(faults: list[Fault], copy: Copy, level: str) -> Iterator[tuple[Fault, str]]:
    """Which test of a level finds each of several faults, as soon as it is known."""
    excused: set[tuple[str, str]] = set()
    sound: set[tuple[str, str]] = set()
    left = faults
    while left:
        with copy.faulty(left) as compiles:
            failing = [check for check in copy.failing(level) if check not in excused] if compiles else []
        found, known = [], len(excused)
        for fault in left if failing else []:
            check = None
            for _ in failing:
                with copy.faulty([fault]):
                    check = copy.first_failing([check for check in failing if check not in excused])
                if check is None or check in sound or not copy.first_failing([check]):
                    break
                excused.add(check)
                check = None
            if check:
                sound.add(check)
                found.append(fault)
                yield fault, ": ".join(check)
        if not found and len(excused) == known:  # nothing fails, or only with several faults together
            return
        left = [fault for fault in left if fault not in found]


def read_faults(path: Path, root: Path) -> list[Fault]:
    """Faults of a table that was written before, those left out that were found or whose line is gone."""
    faults = []
    with path.open(newline="") as lines:
        for row in csv.DictReader(lines):
            places = [(other.relative_to(root), number)
                      for other in sorted((root / "src" / row["package"]).glob("*.f90"))
                      for number, line in enumerate(other.read_text().splitlines(), 1) if line.strip() == row["before"]]
            # lines move, and modules are joined
            places = [place for place in places if place == (Path(row["file"]), int(row["line"]))] or places
            if row["result"] in ("", "survived") and len(places) == 1:
                faults.append(Fault(*places[0], row["kind"], row["before"], row["after"]))
    return faults


def report(rows: list[dict[str, object]]) -> str:
    """One line a package: how many faults, found where."""
    lines = ["package       faults  package   unit  physics suite  survived"]
    for package in [*sorted({str(row["package"]) for row in rows}), "all"]:
        mine = [row for row in rows if package in ("all", row["package"]) and row["result"] != "does not compile"]
        count = [sum(row.get("level") == level for row in mine) for level in LEVELS]
        survived = sum(row["result"] == "survived" for row in mine)
        lines.append(f"{package:12}{len(mine):8}{count[0]:9}{count[1]:7}{count[2]:9}{count[3]:6}{survived:10}")
    return "\n".join(lines)


def arguments() -> argparse.Namespace:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    root = Path(__file__).resolve().parents[2]
    parser.add_argument("--source", type=Path, default=root, help="folder of the project")
    parser.add_argument("--work", type=Path, required=True, help="folder of the copy and of the table")
    parser.add_argument("--count", type=int, default=400, help="number of faults [400]")
    parser.add_argument("--seed", type=int, default=1, help="where the random numbers begin [1]")
    parser.add_argument("--packages", nargs="*", help="folders of src/ [all but app and files]")
    parser.add_argument("--again", type=Path, help="a table: judge those of its faults that survived")
    parser.add_argument("--levels", nargs="*", default=LEVELS[:3], choices=LEVELS, help="what runs [all but suite]")
    parser.add_argument("--table", type=Path, help="the table [mutants.csv in the folder of the copy]")
    parser.add_argument("--together", type=int, default=8, help="faults at a time by physics and suite [8]")
    parser.add_argument("--list", action="store_true", help="write the table of faults and stop")
    parser.add_argument("--jobs", type=int, default=2, help="compilers at a time [2]")
    parser.add_argument("--flags", default="-O1", help="flags of the compiler [-O1]")
    return parser.parse_args()


def run_without_faults(copy: Copy, levels: list[str]) -> None:
    """Run once what judges, and keep the time that it takes."""
    units = copy.units if "package" in levels or "unit" in levels else []
    for name in [*units, *(["physics"] if "physics" in levels else [])]:
        test = copy.run(name)
        if test:
            raise SystemExit(f"{name} fails without a fault: {test}")


def main() -> int:
    """Put in, build, test, take out; write the table."""
    asked = arguments()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # what is faulty is put back
    packages = asked.packages or sorted(path.name for path in (asked.source / "src").iterdir()
                                        if path.is_dir() and path.name not in ("app", "files"))
    faults = (read_faults(asked.again, asked.source) if asked.again
              else draw_faults(asked.source, packages, asked.count, asked.seed))
    asked.work.mkdir(parents=True, exist_ok=True)
    copy = Copy((asked.work / "tree").resolve(), asked.jobs)
    rows: list[dict[str, object]] = [
        {"number": number, "package": fault.path.parts[1], "file": fault.path.as_posix(), "line": fault.line,
         "kind": fault.kind, "before": fault.before.strip(), "after": fault.after.strip()}
        for number, fault in enumerate(faults, 1)]
    table = asked.table or asked.work / "mutants.csv"
    if not asked.list:
        copy.prepare(asked.source, asked.flags)
        run_without_faults(copy, asked.levels)
        judge_all(faults, rows, copy, asked, table)
        print(report(rows))
    write_table(table, rows)
    return 0


def judge_all(faults: list[Fault], rows: list[dict[str, object]], copy: Copy, asked: argparse.Namespace,
              table: Path) -> None:
    """Fill the rows, first by unit programs, then by what takes longer."""
    units = [level for level in asked.levels if level not in PROGRAMS]
    for fault, row in zip(faults, rows):
        row.update(judge(fault, copy, units) if units else {"result": "survived"})
        tell(fault, row)
        write_table(table, rows)
    for level in (level for level in PROGRAMS if level in asked.levels):
        left = [number for number, row in enumerate(rows) if row["result"] == "survived"]
        while left:
            lines = {(faults[number].path, faults[number].line): number for number in reversed(left)}
            group = list(lines.values())[::-1][:asked.together]
            left = [number for number in left if number not in group]
            start = time.monotonic()
            count = 0
            for fault, test in judge_together([faults[number] for number in group], copy, level):
                number = faults.index(fault)
                rows[number].update(result="found", level=level, found_by=test,
                                    seconds=round(time.monotonic() - start, 1))
                tell(fault, rows[number])
                write_table(table, rows)
                count += 1
            print(f"{level}: {count} of {len(group)}, {time.monotonic() - start:.0f} s", flush=True)


def tell(fault: Fault, row: dict[str, object]) -> None:
    """Print a line of what became of a fault."""
    what = row.get("found_by", row["after"])
    print(f"{row['number']:4} {row['result']:9} {fault.path}:{fault.line} {what}", flush=True)


def write_table(path: Path, rows: list[dict[str, object]]) -> None:
    """Write what is known."""
    with path.open("w", newline="") as lines:
        writer = csv.DictWriter(lines, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    sys.exit(main())
