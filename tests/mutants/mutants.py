#!/usr/bin/env python3
"""Put single faults into src/, one after the other, and tell which test finds each.

The tree is copied and built once, each room as a shared library. A fault seldom changes what a module offers: then
one object is compiled and its room linked again, and every program meets the fault without being linked itself;
else the build sees to it. The unit tests of the fault's room run first, then those of the other rooms, those whose
tests name the module before the others, then the tests of the command that count as unit tests, the physics and
the tests of the command that count as physics, then, if asked, the other tests of the command and of Python, those
first that are about the room. A process may take five times the processor time that it takes without a fault. The
table has a row for each fault as soon as it is known.
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
from typing import Iterator

from faults import Fault, draw_faults

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
    """A copy of the tree, what its test programs are, and what they take without a fault."""

    root: Path
    jobs: int
    #: Unit programs, and the text of their tests
    units: dict[str, str] = field(default_factory=dict)
    #: How each object is compiled, by source
    objects: dict[str, list[dict[str, str]]] = field(default_factory=dict)
    #: Seconds of processor and of the clock
    usual: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def build(self) -> Path:
        """Its build folder."""
        return self.root / "build"

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

    def make(self) -> bool:
        """Build all that tests run; whether it compiles."""
        command = ["cmake", "--build", str(self.build), "-j", str(self.jobs), "--target", *self.units, "physics", "dda",
                   "_theory"]
        return subprocess.run(command, capture_output=True).returncode == 0

    @contextmanager
    def faulty(self, fault: Fault) -> Iterator[bool]:
        """Have every program meet a fault; whether it compiles."""
        path = self.root / fault.path
        sound, at = path.read_text(), path.stat().st_mtime_ns
        lines = sound.splitlines(keepends=True)
        room = self.build / "src" / f"libvoussoir_{fault.path.parts[1]}.so"
        kept = room.with_suffix(".sound")
        lines[fault.line - 1] = fault.after + "\n"
        path.write_text("".join(lines))
        one = self.compile_alone(path)
        if one is not None:  # the build may not see that anything was changed
            path.write_text(sound)
            os.utime(path, ns=(at, at))
        try:
            if one:
                room.rename(kept)
                self.link_room(room.name, *one)
            yield bool(one) or one is None and self.make()
        finally:
            if one:
                kept.replace(room)
            elif one is None:
                path.write_text(sound)
                self.make()

    def compile_alone(self, path: Path) -> tuple[str, Path] | None | tuple[()]:
        """The sound object's name and the faulty object; none where others depend on the change, () on an error."""
        entries = self.objects[str(path)]
        if len(entries) != 1:
            return None
        words = shlex.split(entries[0]["command"])
        scratch = self.root / "scratch"
        shutil.rmtree(scratch, ignore_errors=True)
        scratch.mkdir()
        modules = Path(next(word[2:] for word in words if word.startswith("-J")))
        output = words[words.index("-o") + 1]
        words = [f"-J{scratch}" if word.startswith("-J") else word for word in words] + ["-I", str(modules), "-w"]
        words[words.index("-o") + 1] = str(scratch / "faulty.o")
        if subprocess.run(words, cwd=entries[0]["directory"], capture_output=True).returncode != 0:
            return ()
        same = all(filecmp.cmp(new, self.build / modules / new.name, shallow=False) for new in scratch.glob("*.*mod"))
        return (output, scratch / "faulty.o") if same else None

    def link_room(self, name: str, output: str, faulty: Path) -> None:
        """Link a room with one object in the place of another."""
        steps = subprocess.run(["ninja", "-C", self.build, "-t", "commands", "-s", f"src/{name}"], check=True,
                               capture_output=True, text=True).stdout
        command = next(line for line in steps.splitlines() if f"-o src/{name}" in line)
        subprocess.run(command.replace(f" {output} ", f" {faulty} "), shell=True, cwd=self.build, check=True,
                       capture_output=True)

    def programs(self, level: str, fault: Fault) -> list[str]:
        """The programs of a level that hold the faulty room, the likely and the short ones first."""
        own = f"unit_{fault.path.parts[1]}"
        if level == "room":
            return [own] if own in self.units else []
        if level == "physics":
            return [COMMAND + "unit", "physics", COMMAND + "physics"]
        others = [name for name in self.units if name != own and self.holds(name, fault.path.parts[1])]
        return sorted(others, key=lambda name: (f"use {fault.path.stem}," not in self.units[name], self.usual[name]))

    def holds(self, program: str, room: str) -> bool:
        """Whether a program is linked with a room."""
        linked = subprocess.run(["ldd", self.build / "tests" / "bin" / program], capture_output=True, text=True).stdout
        return f"libvoussoir_{room}.so" in linked

    def run(self, program: str) -> str:
        """Run a test program: the test that failed, or nothing."""
        if not program.startswith(COMMAND):
            return self.finish([str(self.build / "tests" / "bin" / program)], program, self.build / "tests")
        return self.finish(["ctest", "--test-dir", str(self.build), "--output-on-failure", "-R", f"^{program}$"],
                           program, self.root)

    def run_pytest(self, room: str) -> str:
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

    def finish(self, command: list[str], name: str, folder: Path) -> str:
        """Wait for a command, each of its processes for a time; the test that failed, or nothing."""
        usual = self.usual.get(name, (600.0, 3600.0))
        limit = int(max(10.0, 5.0 * usual[0]) if not name.startswith((COMMAND, "suite")) else 60.0)
        environment = {**os.environ, "DDA": str(self.build / "bin" / "dda"), "OMP_NUM_THREADS": "1",
                       "VOUSSOIR_BUILD": str(self.build), "PYTHONPATH": str(self.build / "python")}
        start, used = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        process = subprocess.Popen(command, cwd=folder, env=environment, text=True, start_new_session=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace",
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
        try:
            printed, _ = process.communicate(timeout=max(60.0, 10.0 * usual[1]))
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return f"{name}: time limit"
        taken = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.usual.setdefault(name, (taken.ru_utime + taken.ru_stime - used.ru_utime - used.ru_stime,
                                     time.monotonic() - start))
        if process.returncode == 0:
            return ""
        failed = re.search(r"\w+_suite\.(\w+) FAILED|^FAILED (\S+)", printed, re.MULTILINE)
        if failed:
            return failed.group(1) or failed.group(2)
        end = "time limit" if process.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else "crash"
        begun = re.findall(r"_suite\.(\w+)", printed)
        return f"{begun[-1]} ({end})" if begun else f"{name} ({end})"


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
    """What becomes of one fault."""
    with copy.faulty(fault) as compiles:
        if not compiles:
            return {"result": "does not compile"}
        start = time.monotonic()
        for level in levels:
            programs = copy.programs(level, fault) if level != "suite" else ["suite"]
            for program in programs:
                test = copy.run(program) if program != "suite" else copy.run_pytest(fault.path.parts[1])
                if test:
                    return {"result": "found", "level": level, "found_by": f"{program}: {test}",
                            "seconds": round(time.monotonic() - start, 1)}
        return {"result": "survived", "seconds": round(time.monotonic() - start, 1)}


def read_faults(path: Path, root: Path) -> list[Fault]:
    """Faults of a table that was written before, those left out that were found or whose line is gone."""
    faults = []
    with path.open(newline="") as lines:
        for row in csv.DictReader(lines):
            places = [(other.relative_to(root), number)
                      for other in sorted((root / "src" / row["room"]).glob("*.f90"))
                      for number, line in enumerate(other.read_text().splitlines(), 1) if line.strip() == row["before"]]
            # lines move, and modules are joined
            places = [place for place in places if place == (Path(row["file"]), int(row["line"]))] or places
            if row["result"] in ("", "survived") and len(places) == 1:
                faults.append(Fault(*places[0], row["kind"], row["before"], row["after"]))
    return faults


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
    parser.add_argument("--table", type=Path, help="the table [mutants.csv in the folder of the copy]")
    parser.add_argument("--list", action="store_true", help="write the table of faults and stop")
    parser.add_argument("--jobs", type=int, default=2, help="compilers at a time [2]")
    parser.add_argument("--flags", default="-O1", help="flags of the compiler [-O1]")
    return parser.parse_args()


def run_without_faults(copy: Copy, levels: list[str]) -> None:
    """Run once what judges, and keep the time that it takes."""
    names = [*copy.units, *([COMMAND + "unit", "physics", COMMAND + "physics"] if "physics" in levels else [])]
    for name in names:
        test = copy.run(name)
        if test:
            raise SystemExit(f"{name} fails without a fault: {test}")


def main() -> int:
    """Put in, build, test, take out; write the table."""
    asked = arguments()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # what is faulty is put back
    rooms = asked.rooms or sorted(path.name for path in (asked.source / "src").iterdir()
                                  if path.is_dir() and path.name not in ("app", "files"))
    faults = (read_faults(asked.again, asked.source) if asked.again
              else draw_faults(asked.source, rooms, asked.count, asked.seed))
    asked.work.mkdir(parents=True, exist_ok=True)
    copy = Copy((asked.work / "tree").resolve(), asked.jobs)
    if not asked.list:
        copy.prepare(asked.source, asked.flags)
        run_without_faults(copy, asked.levels)
    rows: list[dict[str, object]] = []
    with (asked.table or asked.work / "mutants.csv").open("w", newline="") as lines:
        writer = csv.DictWriter(lines, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for number, fault in enumerate(faults, 1):
            row: dict[str, object] = {"number": number, "room": fault.path.parts[1], "file": fault.path.as_posix(),
                                      "line": fault.line, "kind": fault.kind, "before": fault.before.strip(),
                                      "after": fault.after.strip()}
            if not asked.list:
                row.update(judge(fault, copy, asked.levels))
                print(f"{number:4} {row['result']:9} {fault.path}:{fault.line} {row.get('found_by', row['after'])}",
                      flush=True)
            rows.append(row)
            writer.writerow(row)
            lines.flush()
    if not asked.list:
        print(report(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
