"""Text in another coding, links, pipes and foreign tables: one line and a status, and nothing of others is harmed."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest
from dda_command import run_dda

ARCH = "&arch shape = 'segmental', span = 6, rise = 1.5, thickness = 0.5, voussoirs = 7 /\n"
BLOCKS = "block fixed\n-1 -1\n4 -1\n4 0\n-1 0\nblock\n0 0\n1 0\n1 1\n0 1\nmeasure 0.5 1\n"
MOTION = """&scene kind = 'blocks', geometry = 'x.blocks' /
&analysis mode = 'dynamic', geometry = 'current', time_step = 0.01, steps = 4 /
&output frames = 2, energy = .true., restart = .true. /
"""
MAP = """&lines seed = 3 /
&outline left = -10, right = 10, bottom = -8, top = 10, fixed = 'left', 'right', 'bottom' /
&joint_set dip_deg = 0, spacing = 3 /
&joint_set dip_deg = 70, spacing = 3 /
"""
#: Texts that are no UTF-8: Latin-1, half a character, an overlong slash, half of UTF-16, beyond the last character
CODINGS = [b"caf\xe9", b"\xc3", b"\xc0\xaf", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"\x80", b"\xf0\x9f\x98"]
#: Characters of one to four bytes at both ends of their ranges
CHARACTERS = "a~\u0080\u07ff\u0800\ud7ff\ue000\uffff\U00010000\U0010ffff"


def write(folder: Path, **files: bytes | str) -> None:
    """Write files; a double underscore in a name is a point."""
    for name, content in files.items():
        path = folder / name.replace("__", ".")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())


def text_beside(kind: str, text: bytes) -> tuple[dict[str, bytes], str, int]:
    """Files of a scene with a text in line 2 of one of them, as a comment or a title; that file, and its line."""
    blocks, motion = BLOCKS.encode(), MOTION.encode()
    if kind == "title":
        return {"deck.nml": ARCH.encode() + b"&scene title = '" + text + b"' /\n"}, "deck.nml", 2
    if kind == "comment":
        return {"deck.nml": ARCH.encode() + b"! " + text + b"\n"}, "deck.nml", 2
    if kind == "file name":
        return {"deck.nml": b"&scene kind = 'blocks',\ngeometry = '" + text + b"' /\n"}, "deck.nml", 2
    if kind == "blocks":
        return {"deck.nml": motion, "x.blocks": blocks.replace(b"\n", b" # " + text + b"\n", 2)}, "x.blocks", 1
    if kind == "record":
        record = b"time,x\n# " + text + b"\n0,0\n1,1\n"
        return {"deck.nml": motion + b"&ground record = 'r.csv' /\n", "x.blocks": blocks, "r.csv": record}, "r.csv", 2
    map_ = b"&lines seed = 3 /\n! " + text + b"\n"
    return {"deck.nml": map_}, "deck.nml", 2


@pytest.mark.parametrize("text", CODINGS, ids=lambda text: text.hex())
@pytest.mark.parametrize("kind", ["title", "comment", "file name", "blocks", "record", "map"])
def test_text_in_another_coding_is_refused_with_its_line(tmp_path: Path, kind: str, text: bytes) -> None:
    files, name, line = text_beside(kind, text)
    for path, content in files.items():
        (tmp_path / path).write_bytes(content)
    done = run_dda("lines" if kind == "map" else "check", "deck.nml", cwd=tmp_path)
    bad = f"0x{text[3] if text.startswith(b'caf') else text[0]:02X}"
    assert done.returncode == 2
    assert done.stderr == (
        f"{name}:{line}: error: expected text in UTF-8, got the byte {bad}; save the file as UTF-8\n")


def test_every_character_of_utf_8_is_taken(tmp_path: Path) -> None:
    write(tmp_path, deck__nml=f"&scene title = '{CHARACTERS.replace(chr(128), '')}' /\n" + ARCH)
    done = run_dda("check", "deck.nml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("place", [2, 4])
def test_argument_in_another_coding_is_refused(tmp_path: Path, place: int) -> None:
    words = [b"run", b"deck.nml", b"--out", b"out"]
    words[place - 1] = b"caf\xe9"
    write(tmp_path, deck__nml=ARCH)
    (tmp_path / os.fsdecode(b"caf\xe9")).write_text(ARCH)
    done = subprocess.run([os.environ["DDA"].encode(), *words], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == f"dda:{place}: error: expected text in UTF-8, got the byte 0xE9; rename the file or folder\n"
    assert len(list(tmp_path.iterdir())) == 2


def pipe_in_place_of(kind: str, folder: Path) -> tuple[list[str], str]:
    """Words of a command one of whose files is a pipe into which nobody writes, and that file."""
    write(folder, deck__nml=MOTION, x__blocks=BLOCKS)
    words, name = ["check", "deck.nml"], {
        "deck": "deck.nml", "blocks": "x.blocks", "record": "r.csv", "geometry": "a.geo", "start": "s.bin",
        "cut": "c.geo", "map": "m.nml"}[kind]
    if kind == "record":
        write(folder, deck__nml=MOTION + "&ground record = 'r.csv' /\n")
    elif kind == "geometry":
        write(folder, deck__nml="&scene kind = 'lines', geometry = 'a.geo' /\n")
    elif kind == "start":
        write(folder, deck__nml=MOTION.replace("steps = 4", "steps = 4, restart = 's.bin'"))
        words = ["run", "deck.nml"]
    elif kind in ("cut", "map"):
        words = ["cut" if kind == "cut" else "lines", name]
    (folder / name).unlink(missing_ok=True)
    os.mkfifo(folder / name)
    return words, name


@pytest.mark.parametrize("kind", ["deck", "blocks", "record", "geometry", "start", "cut", "map"])
def test_pipe_without_a_writer_is_refused(tmp_path: Path, kind: str) -> None:
    words, name = pipe_in_place_of(kind, tmp_path)
    done = run_dda(*words, cwd=tmp_path, timeout=20)
    assert done.returncode == 2
    assert re.match(rf"({name}|deck.nml|x.blocks):\d+: error: ", done.stderr) and done.stderr.count("\n") == 1
    assert "pipe" in done.stderr or kind == "start", done.stderr


@pytest.mark.parametrize("device", ["null", "zero", "full", "random", "urandom", "ptmx"])
def test_device_is_refused(tmp_path: Path, device: str) -> None:
    (tmp_path / "deck.nml").symlink_to(f"/dev/{device}")
    done = run_dda("check", "deck.nml", cwd=tmp_path, timeout=20)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert done.stderr.startswith("deck.nml:1: error: ")


def results_of(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the motion with everything that can be written."""
    write(folder, deck__nml=MOTION, x__blocks=BLOCKS)
    return run_dda("run", "deck.nml", "--out", "out", *words, cwd=folder, timeout=60)


def files_below(folder: Path) -> list[str]:
    """Names of all files below a folder."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir())


@pytest.mark.parametrize("hard", [False, True], ids=["symbolic", "hard"])
@pytest.mark.parametrize("words", [(), ("--resume",), ("--force",)], ids=" ".join)
def test_links_are_replaced_and_never_followed(tmp_path: Path, words: tuple[str, ...], hard: bool) -> None:
    (tmp_path / "first").mkdir()
    assert results_of(tmp_path / "first").returncode == 0
    names = files_below(tmp_path / "first" / "out")
    assert {"results.csv", "joints.csv", "frames/case_1_0.vtu", "frames/case_1.pvd"} <= set(names)
    names += [f"{name}.part" for name in names]
    (tmp_path / "kept").mkdir()
    for number, name in enumerate(names):
        link, kept = tmp_path / "out" / name, tmp_path / "kept" / str(number)
        link.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text("case,verdict\n" if hard else "kept")
        if name in ("results.csv", "run.lock") and hard:
            continue
        link.hardlink_to(kept) if hard else link.symlink_to(kept)
    before = [path.read_text() for path in sorted((tmp_path / "kept").iterdir())]
    done = results_of(tmp_path, *words, *(["--force"] if hard and "--force" not in words else []))
    assert done.returncode == 0, done.stderr
    assert [path.read_text() for path in sorted((tmp_path / "kept").iterdir())] == before
    assert not any(path.is_symlink() for path in (tmp_path / "out").rglob("*") if not path.name.endswith(".part"))
    assert (tmp_path / "out" / "points.csv").read_bytes() == (tmp_path / "first" / "out" / "points.csv").read_bytes()


def test_link_in_place_of_the_folder_of_pictures_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "frames").symlink_to(tmp_path / "kept")
    assert results_of(tmp_path).returncode == 0
    assert list((tmp_path / "kept").iterdir()) == []
    assert (tmp_path / "out" / "frames" / "case_1.pvd").is_file()


@pytest.mark.parametrize("words", [("cut", "x.geo", "--out", "o.csv"), ("cut", "x.geo", "--out", "o.vtu"),
                                   ("lines", "m.nml", "--out", "o.geo"), ("export", "a.nml")], ids=" ".join)
def test_files_of_other_commands_replace_links(tmp_path: Path, words: tuple[str, ...]) -> None:
    root = Path(__file__).resolve().parents[2] / "input"
    write(tmp_path, a__nml="&arch /\n", x__geo=(root / "limerick" / "terrace.geo").read_bytes())
    write(tmp_path, m__nml=MAP)
    (tmp_path / "plain").mkdir()
    before = set(tmp_path.iterdir())
    done = run_dda(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    written = set(tmp_path.iterdir()) - before
    assert written
    for path in written:
        content = path.read_bytes()
        path.rename(tmp_path / "plain" / path.name)
        (tmp_path / "kept").write_text("kept")
        path.symlink_to(tmp_path / "kept")
        assert run_dda(*words, cwd=tmp_path).returncode == 0
        assert (tmp_path / "kept").read_text() == "kept"
        assert path.read_bytes() == content and not path.is_symlink()


@pytest.mark.parametrize("device", ["full", "null"])
def test_devices_are_never_removed(tmp_path: Path, device: str) -> None:
    """A table that leads to a device is replaced; the device stays, also for a program that may remove it."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "joints.csv").symlink_to(f"/dev/{device}")
    assert results_of(tmp_path).returncode == 0
    assert Path(f"/dev/{device}").is_char_device()
    assert run_dda("help", cwd=tmp_path).returncode == 0
    subprocess.run(f"'{os.environ['DDA']}' help >&- 2>&-", shell=True, cwd=tmp_path, check=False)
    assert Path("/dev/null").is_char_device()


FOREIGN = ["time,load\n0,1\n", "no line end", "deck;case\n", "\ufeffdeck,case\n", "case,deck\n", "\n", "x" * 100000]


@pytest.mark.parametrize("content", FOREIGN, ids=range(len(FOREIGN)))
@pytest.mark.parametrize("words", [(), ("--resume",)], ids=" ".join)
def test_table_of_others_is_not_overwritten(tmp_path: Path, content: str, words: tuple[str, ...]) -> None:
    (tmp_path / "out").mkdir()
    table = tmp_path / "out" / "results.csv"
    table.write_text(content, encoding="utf-8")
    done = results_of(tmp_path, *words)
    assert done.returncode == 4
    assert done.stderr == (
        "out/results.csv:1: error: expected a table that begins with deck,case, got a file that dda has not written; "
        "choose another folder with --out, or overwrite it with --force\n")
    assert table.read_text(encoding="utf-8") == content
    assert files_below(tmp_path / "out") == ["results.csv", "run.lock"]
    assert results_of(tmp_path, *words, "--force").returncode == 0
    assert table.read_text().startswith("deck,case,")


@pytest.mark.parametrize("name", ["joints.csv", "blocks.csv", "log.txt", "bars.csv"])
def test_other_tables_of_others_are_neither_overwritten_nor_removed(tmp_path: Path, name: str) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_text("time,load\n0,1\n")
    done = results_of(tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (4, 1)
    assert (tmp_path / "out" / name).read_text() == "time,load\n0,1\n"
    assert results_of(tmp_path, "--force").returncode == 0


@pytest.mark.parametrize("content", ["", "deck,c", "deck,case,other\n"])
def test_table_of_an_earlier_run_is_overwritten(tmp_path: Path, content: str) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "results.csv").write_text(content)
    assert results_of(tmp_path).returncode == 0
    assert results_of(tmp_path).returncode == 0
