"""The program under test, named by the environment variable DDA."""

from __future__ import annotations

import csv
import os
import subprocess
from pathlib import Path


def run_dda(
    *arguments: str | Path, cwd: Path | None = None, timeout: float = 600.0
) -> subprocess.CompletedProcess[str]:
    """Run the program and return its status and what it printed."""
    return subprocess.run(
        [os.environ["DDA"], *map(str, arguments)], cwd=cwd, capture_output=True, text=True, timeout=timeout,
        check=False)


def run_deck(
    folder: Path, deck: str, *arguments: str | Path, name: str = "x", accepted: tuple[int, ...] = (0,)
) -> subprocess.CompletedProcess[str]:
    """Write a deck into a folder and run it there; its exit status must be accepted."""
    (folder / f"{name}.nml").write_text(deck)
    done = run_dda("run", f"{name}.nml", *arguments, cwd=folder)
    assert done.returncode in accepted, done.stderr
    return done


def rows_of(file: Path) -> list[dict[str, str]]:
    """Rows of a table; lines that begin with # are remarks."""
    with file.open(newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))
