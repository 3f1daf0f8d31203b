"""What cannot be written is told: status 4 and one line, whatever is full."""

from __future__ import annotations

import os
import resource
import subprocess
from pathlib import Path

import pytest
from limerick_files import INPUT

FULL = Path("/dev/full")
ARCHES = "&arch voussoirs = 8, thickness_ratio = 0.12 /\n&sweep parameter = 'radius', values = 5, 6 /\n"
#: A stone that slides on its base, with everything written that can be
SLIDING = """&scene kind = 'blocks', geometry = 'x.blocks' /
&joint friction_deg = 10 /
&load horizontal_coefficient = 0.5 /
&analysis mode = 'dynamic', geometry = 'current', time_step = 0.01, steps = 12 /
&output frames = 3, energy = .true., restart = .true. /
"""
STONE = "block fixed\n-1 -1\n4 -1\n4 0\n-1 0\nblock\n0 0\n1 0\n1 1\n0 1\nmeasure 0.5 1\n"
#: Words of each subcommand that prints
PRINTING = [
    ["run", "arch.nml"],
    ["run", "arch.nml", "--resume"],
    ["check", "arch.nml"],
    ["export", "arch.nml", "--out", "lines"],
    ["cut", str(INPUT / "terrace.geo")],
    ["help"],
    ["help", "keys"],
    ["run", "--help"],
    ["--version"],
]


def dda(folder: Path, *words: str, most: int | None = None, **streams: object) -> subprocess.CompletedProcess[str]:
    """Run the program; no file may grow beyond `most` bytes."""

    def limit() -> None:
        if most is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    return subprocess.run(
        [os.environ["DDA"], *words], cwd=folder, text=True, timeout=120, check=False,
        preexec_fn=limit, **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams},
    )


def write(folder: Path) -> None:
    """Write the decks."""
    (folder / "arch.nml").write_text(ARCHES)
    (folder / "slide.nml").write_text(SLIDING)
    (folder / "x.blocks").write_text(STONE)


def files_of(folder: Path) -> dict[str, int]:
    """Sizes of all files below a folder."""
    return {
        str(path.relative_to(folder)): path.stat().st_size
        for path in folder.rglob("*")
        if path.is_file() and path.name != "run.lock"
    }


def assert_told(done: subprocess.CompletedProcess[str], name: str) -> None:
    """Check that a call has ended with 4 and one line about a file."""
    assert done.returncode == 4, done.stderr
    errors = [line for line in done.stderr.splitlines() if ": warning: " not in line]
    errors = [line for line in errors if not line.endswith("/results.csv")]
    assert len(errors) == 1, done.stderr
    assert name in errors[0].split(":1: error: cannot write")[0], done.stderr


@pytest.mark.skipif(not FULL.exists(), reason="no /dev/full here")
@pytest.mark.parametrize("words", PRINTING, ids=" ".join)
def test_full_standard_output_gives_4_and_one_line(tmp_path: Path, words: list[str]) -> None:
    write(tmp_path)
    with FULL.open("w") as full:
        assert_told(dda(tmp_path, *words, stdout=full), "standard output")


@pytest.mark.skipif(not FULL.exists(), reason="no /dev/full here")
def test_full_standard_output_spoils_no_table(tmp_path: Path) -> None:
    write(tmp_path)
    with FULL.open("w") as full:
        assert dda(tmp_path, "run", "arch.nml", stdout=full).returncode == 4
    rows = (tmp_path / "arch" / "results.csv").read_text().splitlines()
    assert [row.split(",")[1] for row in rows] == ["case", "1", "2"]
    assert "2 of 2 cases are already computed" in dda(tmp_path, "run", "arch.nml", "--resume").stdout


@pytest.mark.skipif(not FULL.exists(), reason="no /dev/full here")
def test_quiet_run_needs_no_standard_output(tmp_path: Path) -> None:
    write(tmp_path)
    with FULL.open("w") as full:
        assert dda(tmp_path, "run", "arch.nml", "--quiet", stdout=full).returncode == 0


@pytest.mark.parametrize("closed", [[0], [1], [2], [0, 1], [1, 2], [0, 1, 2]], ids=str)
def test_closed_descriptors_spoil_no_table(tmp_path: Path, closed: list[int]) -> None:
    write(tmp_path)
    gaps = "".join(f" {number}>&-" for number in closed)
    command = f"'{os.environ['DDA']}' run arch.nml bad.nml{gaps}"
    done = subprocess.run(command, cwd=tmp_path, shell=True, capture_output=True, check=False)
    assert done.returncode == 2
    for name in ("results.csv", "joints.csv", "log.txt", "deck.record"):
        assert "error: " not in (tmp_path / "arch" / name).read_text()
        assert " decided" not in (tmp_path / "arch" / name).read_text()
    assert (tmp_path / "arch" / "results.csv").read_text().count("\n") == 3


@pytest.mark.parametrize(
    ("words", "files"),
    [
        (["arch.nml"], 5),
        (["slide.nml"], 17),
        (["slide.nml", "--set", "output%frames=0", "--set", "analysis%steps=3"], 8),
    ],
    ids=["arch", "pictures", "restart"],
)
def test_file_that_may_not_grow_gives_4_and_one_line(tmp_path: Path, words: list[str], files: int) -> None:
    """Each file in turn is the smallest one that does not fit, by 1 byte, by 8, and by half."""
    write(tmp_path)
    words = ["run", *words, "--out", "o", "--quiet"]
    assert dda(tmp_path, *words).returncode == 0
    sizes = files_of(tmp_path / "o")
    assert len(sizes) >= files
    assert files != 8 or max(sizes, key=sizes.get) == "case_1.restart"
    for size in sorted(set(sizes.values())):
        for most in {size - 1, size - 8, size // 2}:
            done = dda(tmp_path, *words, most=most)
            too_large = [name for name in sizes if sizes[name] > most]
            assert done.returncode == 4, f"{too_large} of more than {most} bytes"
            assert done.stderr.count("error: ") == 1
            assert done.stderr.count("error: cannot write") == 1
    assert dda(tmp_path, *words, most=max(sizes.values())).returncode == 0


@pytest.mark.parametrize(
    "words", [["export", "arch.nml"], ["cut", "t.geo", "--out", "t.csv"], ["cut", "t.geo", "--out", "t.vtu"]],
    ids=" ".join)
def test_model_that_may_not_grow_gives_4_and_one_line(tmp_path: Path, words: list[str]) -> None:
    write(tmp_path)
    (tmp_path / "t.geo").write_text((INPUT / "terrace.geo").read_text())
    before = files_of(tmp_path)
    assert dda(tmp_path, *words, "--quiet").returncode == 0
    sizes = [size for name, size in files_of(tmp_path).items() if name not in before]
    for most in {size - less for size in sizes for less in (1, size // 2)}:
        assert_told(dda(tmp_path, *words, "--quiet", most=most), "")
