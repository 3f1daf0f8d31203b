"""What several tests of the package share."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def paper_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the whole `voussoir paper`, run once."""
    command_line = pytest.importorskip("voussoir.command.main", reason="PYTHONPATH wants python/")
    out = tmp_path_factory.mktemp("paper")
    assert command_line.main(["paper", "--out", str(out), "--quiet"]) == 0
    return out


@pytest.fixture(scope="session")
def paper_page(paper_folder: Path) -> str:
    """Its report."""
    return (paper_folder / "index.html").read_text(encoding="utf-8")


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read files of geometry without the process that limits time and memory: faster, and faults are seen."""
    from voussoir.command import import_file

    monkeypatch.setattr(import_file, "limited", lambda function, *arguments: function(*arguments))
