"""Every command and code block of the documentation, run as it stands there.

A page is one test: its blocks run in their order in one folder. A deck whose name stands in the
line before it is written to that file. Commands that install packages, build the project or run
the whole paper are those that CI, the README, tests/post/test_install.py and test_paper_page.py
run; here they only are known ones.

Decimal numbers in the words of a section whose blocks run must be among what these blocks say, print
and write, rounded as the page has them. `ELSEWHERE` lists the pages with other numbers, and why.
"""

from __future__ import annotations

import bisect
import importlib.util
import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import page_pictures
import pytest
from dda_command import run_dda

ROOT = Path(__file__).resolve().parents[2]

PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])
INSTALL = re.compile(r"sudo apt-get |cmake -|python3 -m venv |env/bin/|xargs -d |ctest |build/bin/voussoir paper ")
COMMAND = re.compile(r"(\$ |dda |voussoir |build/bin/|&[a-z]+\b.*/|python3 |pip |PYTHONPATH=)")
#: A decimal number of prose, not part of a name, a version or a path
DECIMAL = re.compile(r"(?<![\w./#%])-?\d+\.\d+(?:e-?\d+)?(?!\w|\.\w)")
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w]|\.\d)")
#: Numbers of sections that run something, which no block writes: why
NOT_WRITTEN = {
    "getting-started.md": {"24.04": "a version of Ubuntu"},
    "input.md": {"6.5": "the mean of 4 and 9"},
}
#: Pages with decimal numbers in sections that run nothing: what compares them, or why nothing can
ELSEWHERE = {
    "CONTRIBUTING.md": "a version of Ubuntu, and the share of lines that CI measures",
    "README.md": "a version of Ubuntu",
    "gallery.md": "sentences of the decks; test_gallery.py compares them",
    "howto_bridges.md": "axle loads of vehicles",
    "howto_fortran.md": "a program of Fortran; test_install.py builds it and compares what it prints",
    "input.md": "ranges and defaults; test_input_doc.py compares them",
    "joint_map.md": "ranges and defaults; test_input_doc.py compares them",
    "installation.md": "versions",
    "limerick.md": "the original program, which is not here; test_limerick.py runs what needs it not",
    "limits.md": "scenes of tests/physics and tests/cli, which the page names",
    "method.md": "constants of the source",
    "performance.md": "times of one machine; test_work_precision.py and test_stability.py run the fast scenes",
    "testing.md": "examples of faults, and times of one machine",
    "theory.md": "test_theory.py, test_theory_paper.py and test_theory_accuracy.py compare the solutions",
    "validation.md": "written by voussoir validation; test_validation.py compares its fast scenes",
}
#: Packages of blocks with a label of their own: where one is missing the block is left to test_import.py
PACKAGES = {"sh geometry": "shapely", "python geometry": "shapely"}
LABELS = {"", "text", "sh", *PACKAGES, "sh install", "console", "f90", "fortran", "python", "message", "blocks"}
#: Records that files of blocks on pages name
RECORDS = {"quake.csv": "0 0\n1 0.1\n", "pier 2.txt": "time ux uy\n0 0 0\n1 5 0\n"}


@dataclass
class Block:
    """A fenced block: its label, its text, its line, and the line of words before it."""

    label: str
    text: str
    line: int
    before: str


def blocks_of(page: Path) -> list[Block]:
    """Fenced blocks of a page."""
    found, before = [], ""
    lines = iter(enumerate(page.read_text(encoding="utf-8").splitlines(), 1))
    for number, line in lines:
        if line.lstrip().startswith("```"):
            indent, label = len(line) - len(line.lstrip()), line.strip().strip("`").strip()
            text = []
            for _, inner in lines:
                if inner.strip() == "```":
                    break
                text.append(inner[indent:])
            found.append(Block(label, "\n".join(text) + "\n", number, before))
            before = ""
        elif line.strip():
            before = line
    return found


def installs(block: Block) -> bool:
    """Whether all commands of a block install packages or build."""
    return all(INSTALL.match(line) for line in block.text.replace("\\\n", "").splitlines() if line.strip())


def prepare(folder: Path) -> dict[str, str]:
    """Lay the programs into a folder: environment in which dda, voussoir and python3 are those of the build."""
    build = Path(os.environ["DDA"]).parents[1]
    (folder / "build").symlink_to(build)
    (folder / "input").symlink_to(ROOT / "input")
    programs = folder / ".programs"
    programs.mkdir()
    (programs / "python3").write_text(f"#!/bin/sh\nexec '{sys.executable}' \"$@\"\n")
    (programs / "python3").chmod(0o755)
    path = f"{programs}:{build / 'bin'}:{os.environ['PATH']}"
    packages = os.pathsep.join(filter(None, [str(build / "python"), os.environ.get("PYTHONPATH")]))
    return os.environ | {"PATH": path, "PYTHONPATH": packages}


@pytest.fixture
def shell(tmp_path: Path) -> dict[str, str]:
    """Environment in which dda, voussoir and python3 are those of the build."""
    return prepare(tmp_path)


def run_script(text: str, folder: Path, shell: dict[str, str]) -> str:
    """What a shell script prints; it must succeed."""
    done = subprocess.run(["sh", "-e", "-c", text], cwd=folder, env=shell, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def plain(text: str) -> str:
    """Text without what differs from machine to machine: rounding errors and blanks."""
    return " ".join(re.sub(r"-?\d\.\dE[-+]\d\d", "ERROR", text).split())


def run_console(block: Block, folder: Path, shell: dict[str, str]) -> str:
    """Run a transcript: each command prints what stands under it, if anything does; what was printed."""
    all_printed = ""
    for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
        command, _, expected = part.partition("\n")
        while command.count('"') % 2 or command.endswith("\\"):  # several lines
            line, _, expected = expected.partition("\n")
            command += "\n" + line
        printed = run_script(command, folder, shell)
        assert not expected.strip() or plain(expected) == plain(printed), f"{command}\n{printed}"
        all_printed += printed
    return all_printed


def check_messages(block: Block, folder: Path) -> None:
    """A deck and the message about it, which may go on in indented lines; a comment stands for no deck."""
    *deck, message = re.sub("\n {4}", " ", block.text.rstrip("\n")).split("\n")
    name = message.split(":")[0]
    if not deck[0].startswith("!"):
        (folder / name).write_text("\n".join(deck) + "\n")
    done = run_dda("check", name, cwd=folder)
    assert (done.returncode, done.stderr) == (2, message + "\n")


def check_file_of_blocks(block: Block, folder: Path) -> None:
    """A file of blocks, or lines that follow the first file of its page; static where it has no ground motion."""
    page = folder / "page.blocks"
    if not page.exists():
        page.write_text(block.text)
    whole = block.text if "block fixed" in block.text else page.read_text() + block.text
    (folder / "line.blocks").write_text(whole)
    for name, text in RECORDS.items():
        (folder / name).write_text(text)
    mode = "mode = 'dynamic', geometry = 'current', duration = 1" if "base_" in whole else "mode = 'static'"
    (folder / "line.nml").write_text(f"&scene kind = 'blocks', geometry = 'line.blocks' /\n&analysis {mode} /\n")
    done = run_dda("check", "line.nml", cwd=folder)
    assert done.returncode == 0, done.stderr


def run_block(block: Block, folder: Path, shell: dict[str, str]) -> str:
    """Run a block as its label wants it: what it prints."""
    if block.label == "fortran":
        named = re.search(r"`([\w./-]+\.nml)`:?$", block.before)
        name = named[1] if named else f"line{block.line}.nml"
        if name.startswith("input/"):  # a deck that is there already, with the files that it names
            assert (ROOT / name).read_text(encoding="utf-8").endswith(block.text)
        else:
            (folder / name).write_text(block.text)
        done = run_dda("check", name, cwd=folder)
        assert done.returncode == 0, done.stderr
    elif block.label == "python":
        (folder / "block.py").write_text(block.text)
        return run_script("python3 block.py", folder, shell)
    elif block.label == "message":
        check_messages(block, folder)
    elif block.label == "blocks":
        check_file_of_blocks(block, folder)
    elif block.text.startswith("$ "):
        return run_console(block, folder, shell)
    elif block.label == "sh":
        return run_script(block.text, folder, shell)
    elif block.label in PACKAGES:
        if importlib.util.find_spec(PACKAGES[block.label]):
            return run_block(replace(block, label=block.label.split()[0]), folder, shell)
    elif not installs(block):
        looks_run = [line for line in block.text.splitlines() if COMMAND.match(line)]
        assert block.label != "sh install" and not looks_run, "give the block its label"
    return ""


def runs(block: Block) -> bool:
    """Whether a block computes something."""
    return block.label in ("sh", "python") or block.text.startswith("$ ")


def sections_of(page: Path) -> list[tuple[str, bool]]:
    """Words of the parts of a page between its second headings, without blocks, and whether a block of each runs."""
    parts = re.split(r"^(?=## )", page.read_text(encoding="utf-8"), flags=re.M)
    fence = re.compile(r"^[ ]*```([^\n]*)\n(.*?)^[ ]*```", flags=re.M | re.S)
    return [
        (fence.sub("", part), any(runs(Block(label.strip(), text, 0, "")) for label, text in fence.findall(part)))
        for part in parts
    ]


def written(folder: Path) -> str:
    """What the blocks of a page have written: decks, tables but the longest, logs."""
    endings = (".csv", ".txt", ".nml", ".blocks", ".geo")
    files = [path for path in folder.rglob("*") if path.suffix in endings and path.is_file()]
    mine = [path for path in files if not {"build", "input"} & {*path.relative_to(folder).parts}]
    return "\n".join(path.read_text() for path in mine if path.stat().st_size < 100_000)


def unknown_numbers(words: str, known: str) -> list[str]:
    """Decimal numbers of words that no known number gives when it is rounded to as many decimals."""
    values = sorted(abs(float(number)) for number in NUMBER.findall(known))
    lost = []
    for text in DECIMAL.findall(words):
        digits, _, power = text.partition("e")
        half = 0.5000001 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
        at = bisect.bisect_left(values, abs(float(text)) - half)
        if at == len(values) or values[at] > abs(float(text)) + half:
            lost.append(text)
    return lost


def ready() -> bool:
    """Whether the package of this build and matplotlib can be loaded."""
    words = "import voussoir.theory, matplotlib"
    return subprocess.run([sys.executable, "-c", words], capture_output=True).returncode == 0


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_blocks_of_a_page_run(page: Path, tmp_path: Path, shell: dict[str, str]) -> None:
    blocks = blocks_of(page)
    python = any(block.label in ("sh", "python") or "$ " in block.text for block in blocks)
    if python and not ready():
        pytest.skip("the package voussoir of this build or matplotlib cannot be loaded here")
    said = ""
    for block in blocks:
        assert block.label in LABELS, f"{page.name}:{block.line}: unknown label {block.label}"
        said += run_block(block, tmp_path, shell) + block.text
    for source, picture in page_pictures.pictures_of(page):
        assert (tmp_path / source).exists(), f"no block of {page.name} writes {source}"
        assert picture.exists(), f"docs/site/page_pictures.py {page.name} makes {picture.name}"
    said += written(tmp_path)
    words = "".join(part for part, is_run in sections_of(page) if is_run)
    assert [number for number in unknown_numbers(words, said) if number not in NOT_WRITTEN.get(page.name, {})] == []


def test_every_number_that_nothing_here_computes_is_accounted_for() -> None:
    """A page whose sections run nothing and have decimal numbers says who compares them; no other page is listed."""
    pages = {page.name for page in PAGES for words, is_run in sections_of(page) if not is_run and DECIMAL.search(words)}
    assert pages == set(ELSEWHERE)
    for page, numbers in NOT_WRITTEN.items():
        words = "".join(part for one in PAGES if one.name == page for part, _ in sections_of(one))
        assert [number for number in numbers if number not in DECIMAL.findall(words)] == []
    tests = {path.name for path in (ROOT / "tests").rglob("test_*.py")}
    assert [name for reason in ELSEWHERE.values() for name in re.findall(r"test_\w+\.py", reason)
            if name not in tests] == []


@pytest.mark.parametrize(
    ("words", "lost"), [("0.163 of it", []), ("0.164 of it", ["0.164"]), ("-0.1 m", ["-0.1"]), ("1.6e-1", []),
                        ("version 3.11.2, `a.5`, 5 and #1.2", []), ("2.50 m", []),
                        ("2.51 m", ["2.51"])])
def test_numbers_are_compared_as_they_are_rounded(words: str, lost: list[str]) -> None:
    assert unknown_numbers(words, "x = 0.16302, 2.5049, n=3") == lost


def test_tables_begin_with_their_head() -> None:
    """A row after a blank line is no table: pages show its bars."""
    loose = []
    for page in PAGES:
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        for table in re.findall(r"(?:^\|.*\n)+", text, flags=re.M):
            if not re.match(r"\|.*\n\|[ :|-]+\n", table):
                loose.append(f"{page.name}: {table[:60]}")
    assert loose == []


def test_links_between_pages_lead_somewhere() -> None:
    broken = []
    for page in PAGES:
        if page.parent.name == "site":  # links of the built site: tests/post/test_site.py
            continue
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        for target in re.findall(r"\]\(([^)#:\s]+\.\w+)(?:#[^)]*)?\)", text):
            if not (page.parent / target).exists():
                broken.append(f"{page.name}: {target}")
    assert broken == []


def test_known_flaws_name_modules_and_tests_that_exist() -> None:
    page = (ROOT / "docs" / "limits.md").read_text(encoding="utf-8")
    table = page.partition("| flaw | remedy | test |\n")[2].partition("\n\n")[0]
    rows = table.splitlines()[1:]
    names = re.findall(r"`(test_[a-z0-9_]+)`", page)
    assert len(rows) >= 15 and all("`test_" in row for row in rows)
    suites = [*(ROOT / "tests").rglob("*.pf"), *(ROOT / "tests").rglob("*.py")]
    whole = "\n".join(path.read_text(encoding="utf-8") for path in suites)
    for name in names:
        assert re.search(rf"(subroutine|def) {name}\(", whole), name
    for name in re.findall(r"`(dda_[a-z_]+)`", page):
        assert list((ROOT / "src").rglob(f"{name}.f90")), name


def test_pages_name_presets_that_are_there() -> None:
    presets = json.loads((ROOT / "CMakePresets.json").read_text())
    known = {kind: {preset["name"] for preset in presets[f"{kind}Presets"]} for kind in ("workflow", "configure")}
    pages = PAGES
    named = [pair for page in pages for pair in re.findall(r"cmake (--workflow )?--preset (\w+)", page.read_text())]
    assert {"paper", "program", "test"} <= {name for _, name in named}
    assert [name for flow, name in named if name not in known["workflow" if flow else "configure"]] == []
