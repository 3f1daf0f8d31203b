"""`cmake --install` puts programs, package, decks and documents into a prefix that may be moved."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from voussoir.command.main import COMMANDS

BUILD = os.environ.get("VOUSSOIR_BUILD", "")


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An installation that was moved after it was made."""
    if not BUILD or not shutil.which("cmake"):
        pytest.skip("VOUSSOIR_BUILD wants the folder of a whole build, and cmake the path")
    folder = tmp_path_factory.mktemp("install")
    command = ["cmake", "--install", BUILD, "--prefix", str(folder / "first")]
    subprocess.run(command, check=True, capture_output=True)
    (folder / "first").rename(folder / "moved here")
    return folder / "moved here"


def run(program: Path, *words: str) -> str:
    """What an installed program prints, without help from this test's environment."""
    environment = {"PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([program, *words], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_installed_program_runs_an_installed_deck(prefix: Path, tmp_path: Path) -> None:
    deck = next((prefix / "share/voussoir/input").rglob("table4.nml"))
    out = run(prefix / "bin/dda", "run", str(deck), "--out", str(tmp_path))
    assert "0 undecided" in out


def test_installed_command_finds_its_package_through_a_link(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "vsr").symlink_to(prefix / "bin/voussoir")
    assert "1.059653e-01" in run(tmp_path / "vsr", "theory", "--alpha", "90")


def test_installed_command_finds_program_and_decks(prefix: Path, tmp_path: Path) -> None:
    (deck,) = (prefix / "share/voussoir/input").rglob("table4.nml")
    assert "input/paper/table4.nml" in run(prefix / "bin/voussoir", "examples")
    run(prefix / "bin/voussoir", "campaign", str(deck), "--workers", "1", "--out", str(tmp_path / "out"))
    assert (tmp_path / "out/results.csv").read_text().count("\n") > 1


def test_benches_and_paper_are_not_installed(prefix: Path) -> None:
    assert [path.name for path in (prefix / "lib/voussoir/python").iterdir()] == ["voussoir"]


def test_decks_are_found_where_pip_puts_them(tmp_path: Path) -> None:
    source = Path(__file__).parents[2]
    shutil.copytree(source / "post/voussoir", tmp_path / "site/voussoir")
    shutil.copytree(source / "input", tmp_path / "site/voussoir/input")
    code = "from voussoir.dda_program import find_input; print(find_input('paper'))"
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert done.stdout.strip() == str(tmp_path / "site/voussoir/input/paper")


def flags_of(pc_file: Path) -> list[str]:
    """What pkg-config --static tells a compiler, without pkg-config."""
    entry = dict(line.split(": ", 1) for line in pc_file.read_text().splitlines() if ": " in line)
    words = shlex.split(f"{entry['Cflags']} {entry['Libs']} {entry['Libs.private']}")
    xml = ["-lxml2"] if entry.get("Requires.private", "") == "libxml-2.0" else []
    return [word.replace("${pcfiledir}", str(pc_file.parent)) for word in words] + xml


def test_programs_of_the_page_on_fortran_run(prefix: Path, tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/howto_fortran.md").read_text(encoding="utf-8")
    deck = re.search(r"```fortran\n(.*?)```", page, re.S).group(1)
    (tmp_path / "arch.nml").write_text(deck)
    flags = flags_of(next((prefix / "lib").rglob("voussoir.pc")))
    printed = {}
    for source in re.findall(r"```f90\n(.*?)```", page, re.S):
        name = re.match(r"program (\w+)", source).group(1)
        (tmp_path / f"{name}.f90").write_text(source)
        subprocess.run(["gfortran", f"{name}.f90", *flags, "-o", name], cwd=tmp_path, check=True)
        done = subprocess.run([tmp_path / name], cwd=tmp_path, capture_output=True, text=True, check=True)
        printed[name] = done.stdout
    assert printed == {"critical": "found      0.107424138\n", "slope": " 0.400000000 0.400000000\n"}


def test_documents_are_installed(prefix: Path) -> None:
    folder = prefix / "share/doc/voussoir"
    assert (folder / "README.md").exists() and (folder / "docs/input.md").exists()


def test_manual_pages_name_every_command_and_option(prefix: Path, tmp_path: Path) -> None:
    for program in ("dda", "voussoir"):
        text = (prefix / f"share/man/man1/{program}.1").read_text()
        assert text.startswith(f".TH {program.upper()} 1 ")
        plain = text.replace("\\-", "-")
        for command in ("run", "check", "cut", "export") if program == "dda" else COMMANDS:
            told = run(prefix / "bin" / program, "help", command)
            options = set(re.findall(r"--[a-z-]+", told))
            assert f".SS {program} {command}\n" in plain and options
            assert [option for option in options if option not in plain] == []
        if shutil.which("groff"):
            words = ["groff", "-man", "-Tascii", "-ww", prefix / f"share/man/man1/{program}.1"]
            done = subprocess.run(words, capture_output=True, text=True, check=True)
            assert done.stderr == ""


def test_version_is_the_same_everywhere(prefix: Path) -> None:
    source = Path(__file__).parents[2]
    project = (source / "CMakeLists.txt").read_text()
    version = re.search(r"project\(voussoir VERSION ([\d.]+)", project)[1]
    assert run(prefix / "bin/dda", "--version") == f"dda {version}\n"
    assert run(prefix / "bin/voussoir", "--version") == f"voussoir {version}\n"
    assert f'\nversion = "{version}"\n' in (source / "pyproject.toml").read_text()
    assert f"\nversion: {version}\n" in (source / "CITATION.cff").read_text()
    assert f"\n## {version}" in (source / "CHANGELOG.md").read_text()
    assert f"voussoir {version}" in (prefix / "share/man/man1/dda.1").read_text()


def test_results_say_the_version_that_made_them(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "a.nml").write_text("&arch thickness_ratio = 0.12 /\n")
    run(prefix / "bin/dda", "run", str(tmp_path / "a.nml"), "--out", str(tmp_path / "a"))
    version = run(prefix / "bin/dda", "--version").strip()
    assert version in (tmp_path / "a/deck.record").read_text()


def test_nothing_of_the_machine_is_left_in_the_package(prefix: Path) -> None:
    assert not list(prefix.rglob("__pycache__"))
    assert not list(prefix.rglob("*.f90"))


def test_notes_remove_all_that_was_installed(tmp_path: Path) -> None:
    if not BUILD or not shutil.which("cmake"):
        pytest.skip("VOUSSOIR_BUILD wants the folder of a whole build, and cmake the path")
    text = (Path(__file__).parents[2] / "docs/installation.md").read_text()
    notes = [line for line in text.splitlines() if line.startswith("xargs ")]
    assert len(notes) == 1
    subprocess.run(["cmake", "--install", BUILD, "--prefix", str(tmp_path / "p")], check=True, capture_output=True)
    assert any(path.is_file() for path in tmp_path.rglob("*"))
    command = notes[0].replace("build/", f"{BUILD}/")
    subprocess.run(command, shell=True, check=True)
    assert not any(path.is_file() for path in tmp_path.rglob("*"))
