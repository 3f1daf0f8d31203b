"""Mutated files of every format: imported, or one line and status 2; MUTANTS and SEED make more and others."""

from __future__ import annotations

import argparse
import os
import random
import time
from pathlib import Path

import pytest
from mutated_files import mutated, seeds

pytest.importorskip("shapely")

from voussoir.command import import_file  # noqa: E402
from voussoir.command.main import main  # noqa: E402
from voussoir.dda_program import DdaError  # noqa: E402
from voussoir.imports.limits import MOST_ELAPSED  # noqa: E402

MUTANTS, SEED = int(os.environ.get("MUTANTS", "3")), int(os.environ.get("SEED", "1"))
PARTS = range(0, MUTANTS, 20)  #: Tests of so many mutants at most: a test has a time limit
QUICK = 20 if MUTANTS == 3 else 1  #: Mutants read in this process for one read by the command


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("ending", ["dxf", "geojson", "wkt", "json", "vtk", "msh", "vtu"])
def test_mutants_are_imported_or_refused_in_one_line(tmp_path: Path, capsys, ending: str, part: int) -> None:
    if ending in ("vtk", "msh", "vtu"):
        pytest.importorskip("meshio")
    good, rng = seeds(tmp_path)[ending], random.Random(f"{SEED} {ending} {part}")
    file, refused = tmp_path / f"a.{ending}", 0
    count = min(20, MUTANTS - part)
    for number in range(len(good) + count):
        text = good[number] if number < len(good) else mutated(rng, rng.choice(good), good)
        file.write_bytes(text)
        start = time.monotonic()
        status = main(["import", str(file), "--out", str(tmp_path / "a.nml")])
        taken = time.monotonic() - start
        error = capsys.readouterr().err
        assert number >= len(good) or status == 0, error
        assert (status, error.count("\n")) in ((0, 0), (2, 1)), (number, error)
        assert "of its kind, got a" not in error, (number, error)
        assert taken < 1.2 * MOST_ELAPSED, (number, taken)
        refused += status == 2
    assert count < 20 or refused > 0


@pytest.mark.parametrize("ending", ["dxf", "geojson", "wkt", "json"])
def test_mutants_meet_no_fault_of_the_readers(tmp_path: Path, ending: str) -> None:
    good, rng = seeds(tmp_path)[ending], random.Random(f"{SEED + 1} {ending}")
    file = tmp_path / f"a.{ending}"
    parser = argparse.ArgumentParser()
    import_file.add_arguments(parser)
    chosen = parser.parse_args([str(file), "--out", str(tmp_path / "a.nml"), "--snap", "0.001"])
    for number in range(QUICK * MUTANTS):
        file.write_bytes(mutated(rng, rng.choice(good), good))
        try:
            import_file.import_file(chosen)
        except (DdaError, MemoryError, RecursionError, ValueError) as problem:
            assert str(problem), number
