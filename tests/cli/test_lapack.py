"""LAPACK in the program: two threads change no bit, and the kernels of another processor no digit that counts."""

from __future__ import annotations

import os
import platform
import subprocess
from pathlib import Path

import pytest
from block_scene import wall
from dda_command import rows_of, run_dda

#: Cases of walls
CASES = {
    "limit": "&search parameter = 'horizontal_coefficient' /\n&analysis flow = 'associated' /\n",
    "path": "&search parameter = 'horizontal_coefficient' /\n",
    "deformable": "&analysis unknowns = 6 /\n&load horizontal_coefficient = 0.1 /\n",
}


def run(folder: Path, out: str, *options: str) -> dict[str, list[dict[str, str]]]:
    """Rows of results and joints in order of their cases, without the seconds that they took."""
    done = run_dda("run", "wall.nml", "--quiet", "--out", out, *options, cwd=folder)
    assert done.returncode == 0, done.stderr
    tables = {}
    for name in ("results", "joints"):
        tables[name] = sorted(rows_of(folder / out / f"{name}.csv"), key=lambda row: int(row["case"]))
    for row in tables["results"]:
        del row["seconds"]
    return tables


def write(folder: Path, case: str, courses: int) -> None:
    """Write a deck of four frictions and its wall."""
    (folder / "wall.blocks").write_text(wall(courses, courses, 2.0, 1.0))
    (folder / "wall.nml").write_text("&scene kind = 'blocks', geometry = 'wall.blocks' /\n" + CASES[case] +
                                     "&sweep parameter = 'friction_deg', values = 25, 30, 35, 40 /\n")


@pytest.mark.parametrize("case", CASES)
def test_two_threads_change_no_bit_of_a_wall(tmp_path: Path, case: str) -> None:
    write(tmp_path, case, 8)
    assert run(tmp_path, "one") == run(tmp_path, "two", "--jobs", "2")


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="counts threads by Linux's /proc")
def test_one_job_has_one_thread_whatever_openmp_may_take(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # OpenBLAS 0.3.26 with OpenMP takes the number of OpenMP at each call
    monkeypatch.setenv("OMP_NUM_THREADS", "4")
    write(tmp_path, "path", 8)
    command = [os.environ["DDA"], "run", "wall.nml", "--quiet"]
    most = 0
    with subprocess.Popen(command, cwd=tmp_path) as process:
        while process.poll() is None:
            try:
                most = max(most, len(list(Path(f"/proc/{process.pid}/task").iterdir())))
            except OSError:
                break
    assert process.returncode == 0
    assert most == 1


def other_kernels() -> list[str]:
    """OpenBLAS kernels that this processor can run and that differ in the length of their vectors."""
    flags = Path("/proc/cpuinfo").read_text()
    return ["Prescott"] + ["Haswell"] * (" avx2 " in flags) + ["SkylakeX"] * (" avx512vl " in flags)


@pytest.mark.skipif(platform.machine() != "x86_64", reason="kernels of other processors")
@pytest.mark.skipif("VOUSSOIR_BUILD" not in os.environ, reason="needs the program blas_threads of the build")
def test_factorisations_in_two_threads_change_no_bit_with_any_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "1")
    for kernel in other_kernels():
        monkeypatch.setenv("OPENBLAS_CORETYPE", kernel)
        subprocess.run([Path(os.environ["VOUSSOIR_BUILD"], "tests/bin/blas_threads")], check=True)


@pytest.mark.skipif(platform.machine() != "x86_64", reason="kernels of other processors")
@pytest.mark.parametrize(("case", "table", "columns"), [
    ("limit", "results", ["critical", "critical_low", "critical_high"]),
    ("path", "results", ["critical", "critical_low", "critical_high"]),
    ("deformable", "joints", ["normal_force", "shear_force", "opening_intrados", "opening_extrados", "slip"]),
])
def test_kernels_of_another_processor_agree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, case: str, table: str,
                                            columns: list[str]) -> None:
    write(tmp_path, case, 8)
    found = {}
    for kernel in other_kernels():
        monkeypatch.setenv("OPENBLAS_CORETYPE", kernel)
        found[kernel] = run(tmp_path, kernel)
    first, *others = found.values()
    for column in columns:
        values = [float(row[column]) for row in first[table]]
        assert max(map(abs, values)) > 0.0
        for other in others:
            assert [row["verdict"] for row in first["results"]] == [row["verdict"] for row in other["results"]]
            assert [float(row[column]) for row in other[table]] == pytest.approx(
                values, rel=0.0, abs=1e-12 * max(map(abs, values)))
