"""The faults that voussoir-mutants puts in are what they are called, and the same for the same seed."""

from __future__ import annotations

from pathlib import Path

from faults import draw_faults, faults_of

REPOSITORY = Path(__file__).resolve().parents[2]

SOURCE = """module m
   real(wp), parameter :: share = 0.5_wp
   integer :: n = 1
   !> a + b
   do i = 1, n - 1
   if (a(i) <= b) cycle
   c = max(a, 2.0_wp)*d + f(e - 1)
   call fatal_error(error, "a + b")
   text = "a + b"
"""


def after(folder: Path) -> dict[int, set[tuple[str, str]]]:
    """Kind and text of all faults of the source, by line."""
    path = folder / "m.f90"
    path.write_text(SOURCE)
    found: dict[int, set[tuple[str, str]]] = {}
    for fault in faults_of(path, folder):
        assert fault.before == SOURCE.splitlines()[fault.line - 1] != fault.after
        found.setdefault(fault.line, set()).add((fault.kind, fault.after.strip()))
    return found


def test_every_kind_of_fault_is_put_in_where_something_is_computed(tmp_path: Path) -> None:
    found = after(tmp_path)
    assert sorted(found) == [2, 5, 6, 7]
    assert found[2] == {("ten times", "real(wp), parameter :: share = 5.0_wp")}
    assert {("off by one", "do i = 2, n - 1"), ("off by one", "do i = 1, n - 2"), ("sign", "do i = 1, n + 1"),
            ("dropped", "do i = 1, n")} == found[5]
    assert found[6] == {("comparison", "if (a(i) < b) cycle"), ("comparison", "if (a(i) > b) cycle"),
                        ("negated", "if (.not. (a(i) <= b)) cycle"), ("skipped", "continue")}
    assert {("extreme", "c = min(a, 2.0_wp)*d + f(e - 1)"), ("ten times", "c = max(a, 20.0_wp)*d + f(e - 1)"),
            ("dropped", "c = max(a, 2.0_wp)*d"), ("dropped", "c = max(a, 2.0_wp) + f(e - 1)"),
            ("sign", "c = max(a, 2.0_wp)*d - f(e - 1)")} <= found[7]


def test_same_seed_draws_the_same_faults_from_all_packages() -> None:
    packages = ["geometry", "contact", "step"]
    faults = draw_faults(REPOSITORY, packages, 30, 7)
    assert faults == draw_faults(REPOSITORY, packages, 30, 7) != draw_faults(REPOSITORY, packages, 30, 8)
    assert [sum(fault.path.parts[1] == package for fault in faults) for package in packages] == [10, 10, 10]
    assert len({(fault.path, fault.line, fault.after) for fault in faults}) == 30
