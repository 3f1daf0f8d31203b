"""Every test has a time limit. Skipped ones are told with their reasons; where VOUSSOIR_CI is set, one that is not on
the list fails the run."""

from __future__ import annotations

import os
import signal
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import pytest

#: What may be missing where the README's command has put everything in place, and why
MAY_SKIP = (
    "the deck has no current geometry",  # a column of the paper that has no such run
    "below 5 degrees no answer is promised",  # random lines that cross too flatly
    "VTK is not installed",
    "could not import 'vtk'",
    "could not import 'meshio'",
    "could not import 'shapely'",
    "could not import 'pandas'",
    "could not import 'PIL.Image'",
    "Dask is not installed",
    "pyarrow is not installed",
    "the site wants",
    "no Chromium was found",
    "mypy with numpy",
    "ffmpeg is",  # one test for either case
    "no terminal is to be had here",
    "root writes into every folder",
    "is not here",  # files of the original program, which are not ours to publish
)
TESTS = Path(__file__).parent
#: Folders whose modules tests of several folders use
SHARED = ("bench", "cli", "framework", "lint", "mutants", "../docs/site")
sys.path += [str((TESTS / name).resolve()) for name in SHARED]
MOST_SECONDS = 300  #: Seconds that a test may take; the slowest takes a tenth on an idle machine
skipped: Counter[str] = Counter()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """End a test that hangs; what it has started ends with it, as subprocess.run sees to."""

    def end(number: int, frame: FrameType | None) -> None:
        pytest.fail(f"{item.nodeid} has taken more than {MOST_SECONDS} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(MOST_SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Count the reasons of skipped tests."""
    if report.skipped and not hasattr(report, "wasxfail"):
        _count(report.longrepr)


def pytest_collectreport(report: pytest.CollectReport) -> None:
    """Count the reasons of skipped files."""
    if report.skipped:
        _count(report.longrepr)


def _count(longrepr: object) -> None:
    """Count a reason."""
    text = longrepr[2] if isinstance(longrepr, tuple) else str(longrepr)
    skipped[text.removeprefix("Skipped: ")] += 1


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the list, and fail where it has what it should not have."""
    build = os.environ.get("VOUSSOIR_BUILD")
    if build and (Path(build) / "tests").is_dir():
        name = Path(session.config.option.basetemp or str(session.config.args[0]).split("::")[0]).stem
        lines = [f"{count} skipped: {reason}\n" for reason, count in sorted(skipped.items())]
        (Path(build) / "tests" / f"skipped_{name}.txt").write_text("".join(lines), encoding="utf-8")
    if os.environ.get("VOUSSOIR_CI") and unexpected():
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def unexpected() -> list[str]:
    """Reasons that are not on the list."""
    return [reason for reason in skipped if not any(known in reason for known in MAY_SKIP)]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Tell the reasons."""
    if not skipped:
        return
    terminalreporter.section("skipped")
    for reason, count in sorted(skipped.items()):
        wrong = os.environ.get("VOUSSOIR_CI") and reason in unexpected()
        terminalreporter.line(f"{count}: {reason}" + (" <- not on the list of tests/conftest.py" if wrong else ""))
