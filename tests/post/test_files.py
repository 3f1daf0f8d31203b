"""What the package reads is plain text in UTF-8; what it writes replaces links."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import voussoir
from voussoir.campaign.share import open_campaign
from voussoir.command.main import main
from voussoir.dda_program import DdaError, find_dda
from voussoir.files import fresh, plain, read_text, write_text

ARCH = "&arch voussoirs = 9, thickness_ratio = 0.2 /\n"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_byte_that_is_no_text_is_named_with_its_line(tmp_path: Path, end: str) -> None:
    file = tmp_path / "a.nml"
    file.write_bytes(f"one{end}two{end}caf".encode() + b"\xe9")
    with pytest.raises(ValueError, match="^" + str(file) + ":3: error: expected text in UTF-8, got the byte 0xE9; "):
        read_text(file)


def test_text_is_read_without_its_mark_and_with_one_kind_of_line_end(tmp_path: Path) -> None:
    file = tmp_path / "a.nml"
    file.write_bytes("\ufeffä\r\nb\rc\n".encode())
    assert read_text(file) == "ä\nb\nc\n"


@pytest.mark.parametrize("verb", ["assess", "import", "lines", "plot", "verify"])
def test_file_in_another_coding_or_a_pipe_is_one_line(
    tmp_path: Path, verb: str, capfd: pytest.CaptureFixture[str]
) -> None:
    if verb == "import":
        pytest.importorskip("shapely")
    voussoir.run(ARCH, out=tmp_path / "folder")
    name = {"assess": "a.nml", "import": "a.wkt", "lines": "a.csv"}.get(verb, "folder")
    file = tmp_path / {"plot": "folder/results.csv", "verify": "folder/deck.record"}.get(verb, name)
    for pipe in (False, True):
        file.unlink(missing_ok=True)
        os.mkfifo(file) if pipe else file.write_bytes(b"&arch /\n! caf\xe9\n")
        assert main([verb, str(tmp_path / name)]) == 2
        said = capfd.readouterr().err
        assert said.count("\n") == 1 and ": error: " in said, said
        if not (verb == "plot" and pipe):  # a folder without results.csv
            assert f"{file}:{1 if pipe else 2}: error: " in said, said
            assert ("pipe" if pipe else "utf" if verb == "plot" else "UTF-8") in said


def test_argument_in_another_coding_is_one_line(tmp_path: Path) -> None:
    name = os.fsencode(tmp_path) + b"/caf\xe9"
    os.mkdir(name)
    done = subprocess.run([sys.executable.encode(), b"-m", b"voussoir", b"plot", name], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and done.stderr.startswith("voussoir: error: expected text in UTF-8, got ")


def test_links_are_replaced_but_not_those_of_the_system(tmp_path: Path) -> None:
    kept, link = tmp_path / "kept", tmp_path / "link"
    for make in (link.symlink_to, link.hardlink_to):
        kept.write_text("kept")
        make(kept)
        write_text(link, "new")
        assert (kept.read_text(), link.read_text(), link.is_symlink()) == ("kept", "new", False)
        link.unlink()
    assert fresh(Path("/dev/stdout")).exists() and fresh(Path("/dev/null")).exists()
    with pytest.raises(ValueError, match="pipe or a device"):
        plain(Path("/dev/null"))


@pytest.mark.parametrize("words", [("plot", "--format", "svg", "png", "pdf"), ("export",), ("animate",), ("assess",)],
                         ids=lambda words: words[0])
def test_pictures_and_pages_replace_links(tmp_path: Path, words: tuple[str, ...]) -> None:
    deck = tmp_path / "a.nml"
    deck.write_text(ARCH)
    moving = {"output": {"frames": 2}, "analysis": {"geometry": "current"}} if words[0] == "animate" else {}
    voussoir.run(deck, out=tmp_path / "a", **moving)
    (tmp_path / "away").mkdir()
    target = {"export": ["export", str(tmp_path / "a"), str(tmp_path / "away/a.geojson")],
              "animate": ["animate", str(tmp_path / "a"), "--out", str(tmp_path / "away/a.gif")],
              "assess": ["assess", str(deck), "--out", str(tmp_path / "away/a.html")],
              "plot": ["plot", str(tmp_path / "a"), "--out", str(tmp_path / "away"), *words[1:]]}[words[0]]
    assert main(target) == 0
    names = sorted(path.relative_to(tmp_path) for path in (tmp_path / "away").rglob("*") if path.is_file())
    assert names
    for name in names:
        (tmp_path / name).unlink()
        (tmp_path / f"kept-{name.name}").write_text("kept")
        (tmp_path / name).symlink_to(tmp_path / f"kept-{name.name}")
    assert main(target) == 0
    for name in names:
        assert (tmp_path / f"kept-{name.name}").read_text() == "kept"
        assert not (tmp_path / name).is_symlink() and (tmp_path / name).stat().st_size > 4


def test_campaign_leaves_a_table_of_others_alone(tmp_path: Path) -> None:
    deck, out = tmp_path / "a.nml", tmp_path / "out"
    deck.write_text(ARCH)
    out.mkdir()
    (out / "results.csv").write_text("time,load\n")
    with pytest.raises(DdaError, match="results.csv:1: error: expected a table that begins with deck,case") as refusal:
        open_campaign(find_dda(), deck, [], out, discard=False)
    assert refusal.value.status == 4
    assert (out / "results.csv").read_text() == "time,load\n"
