"""Decks run from Python: text in, rows of results.csv out."""

from __future__ import annotations

import csv
import os
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from voussoir.dda_program import find_dda

#: A row of results.csv: its columns as text
Row = dict[str, str]


@dataclass(frozen=True)
class Finished:
    """What a run of one deck left.

    Attributes
    ----------
    status
        Exit status; negative if a signal ended it, None if it took too long.
    rows
        Rows of results.csv.
    remarks
        Remark of log.txt by number of the case.
    message
        What it printed as error.
    not_a_number
        Names of result files that hold NaN or Inf.
    """

    status: int | None
    rows: list[Row] = field(default_factory=list)
    remarks: dict[str, str] = field(default_factory=dict)
    message: str = ""
    not_a_number: tuple[str, ...] = ()


def run_deck(deck: str, folder: Path, timeout: float = 600.0, jobs: int = 1) -> Finished:
    """Write a deck, run it, read its results.

    Parameters
    ----------
    deck : str
        Text of the deck.
    folder : Path
        Where deck.nml and the folder of its results go; made if missing.
    timeout : float, optional
        Longest time that it may take [s].
    jobs : int, optional
        Cases computed at the same time.

    Returns
    -------
    Finished
        What it left.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.nml").write_text(deck, encoding="utf-8")
    command = [str(find_dda()), "run", "deck.nml", "--quiet", "--out", "out"]
    try:
        done = subprocess.run(
            [*command, "--jobs", str(jobs)],
            cwd=folder,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Finished(None, message=f"stopped after {timeout:g} s")
    out = folder / "out"
    return Finished(
        done.returncode,
        read_rows(out / "results.csv"),
        _remarks(out / "log.txt"),
        done.stderr.strip(),
        tuple(path.name for path in sorted(out.glob("*.csv")) if _holds_no_number(path)),
    )


def read_rows(file: Path) -> list[Row]:
    """Rows of a table; none if there is no such file."""
    if not file.is_file():
        return []
    with file.open(newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def _remarks(file: Path) -> dict[str, str]:
    """Remarks of log.txt by number of the case."""
    if not file.is_file():
        return {}
    remarks = {}
    for line in file.read_text(encoding="utf-8").splitlines()[1:]:
        number, _, remark = (line.split(maxsplit=2) + ["", "", ""])[:3]
        remarks[number] = remark
    return remarks


def _holds_no_number(file: Path) -> bool:
    """Whether a table holds NaN or Inf."""
    words = {word.strip("+-").lower() for row in read_rows(file) for word in row.values() if word}
    return bool(words & {"nan", "inf", "infinity"})
