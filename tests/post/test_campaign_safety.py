"""Campaigns in a folder that others use, with parts that are damaged or of other files."""

from __future__ import annotations

import fcntl
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from voussoir.command.main import main

DDA = os.environ["DDA"]

MUTANTS = int(os.environ.get("MUTANTS", "12"))  #: Mutants of parts; the target fuzz asks for more
SWEEP = """&arch voussoirs = 8 /
&search /
&sweep parameter = 'half_angle_deg', first = 60, last = 90, count = 12 /
"""
BLOCKS = "block fixed\n-1 -1\n1 -1\n1 0\n-1 0\nblock\n-0.5 0\n0.5 0\n{x} 1\n-0.5 1\n"


def tables(folder: Path) -> dict[str, bytes]:
    """Tables as they are, seconds left out."""
    found = {
        path.name: path.read_bytes()
        for path in folder.iterdir()
        if path.suffix in (".csv", ".txt") or path.name in ("sizes.record", "deck.record")
    }
    rows = [row.split(b",") for row in found["results.csv"].split(b"\n")]
    place = rows[0].index(b"seconds")
    found["results.csv"] = b"\n".join(b",".join(row[:place] + row[place + 1 :]) for row in rows)
    return found


def undisturbed(deck: Path) -> dict[str, bytes]:
    """Tables of one run that nobody disturbed."""
    folder = deck.parent / "undisturbed"
    subprocess.run([DDA, "run", deck, "--out", folder, "--quiet"], check=True)
    return tables(folder)


def sweep(folder: Path) -> Path:
    """A deck of 12 cases."""
    deck = folder / "sweep.nml"
    deck.write_text(SWEEP)
    return deck


def test_deck_whose_name_begins_with_a_dash_is_a_deck(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    sweep(tmp_path).rename(tmp_path / "-dash.nml")
    assert main(["campaign", "./-dash.nml", "--quiet"]) == 0
    assert (tmp_path / "-dash" / "results.csv").read_text().count("\n") == 13


def test_decks_of_the_paper_in_a_folder_with_a_dash_are_decks(tmp_path: Path, monkeypatch) -> None:
    paper = pytest.importorskip("voussoir_paper.campaign", reason="the theory is not built: skipped")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "-decks").mkdir()
    sweep(tmp_path / "-decks")
    campaign = paper.Campaign(Path("-decks"), tmp_path / "out")
    status = campaign.run(Path(DDA), paper.Clock(lambda line: None, {}), 1, slow=False, resume=False)
    assert status == 0


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        ("geometry = 'a.blocks'", ["scene%geometry='it''s.blocks'"]),
        ("geometry = 'it''s.blocks'", []),
    ],
    ids=["--set", "doubled quote"],
)
def test_changed_file_makes_another_campaign(tmp_path: Path, scene, settings, capsys) -> None:
    for name in ("a.blocks", "it's.blocks"):
        (tmp_path / name).write_text(BLOCKS.format(x=0.5))
    deck = tmp_path / "deck.nml"
    deck.write_text(
        f"&scene kind = 'blocks', {scene} /\n" "&sweep parameter = 'horizontal_coefficient', values = 0.1, 0.9 /\n")
    words = ["campaign", str(deck), "--out", str(tmp_path / "out"), "--quiet"]
    words += [word for setting in settings for word in ("--set", setting)]
    assert main(words) == 0
    old = tables(tmp_path / "out")
    assert main(words) == 0
    (tmp_path / "it's.blocks").write_text(BLOCKS.format(x=2.5))
    assert main(words) == 2
    assert "(other files)" in capsys.readouterr().err
    assert main([*words, "--discard"]) == 0
    new = tables(tmp_path / "out")
    assert new["blocks.csv"] != old["blocks.csv"]


def test_another_deck_of_the_same_program_is_named_alone(tmp_path: Path, capsys) -> None:
    first, second = tmp_path / "first.nml", tmp_path / "second.nml"
    for deck, value in ((first, 0.1), (second, 0.12)):
        deck.write_text(f"&arch voussoirs = 8 /\n&sweep parameter = 'thickness_ratio', values = {value}, 0.2 /\n")
    assert main(["campaign", str(first), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert main(["campaign", str(second), "--out", str(tmp_path / "out"), "--quiet"]) == 2
    message = capsys.readouterr().err
    assert "name of the deck" in message and "program" not in message


def test_rebuilt_program_makes_another_campaign(tmp_path: Path, monkeypatch, capsys) -> None:
    deck = sweep(tmp_path)
    words = ["campaign", str(deck), "--out", str(tmp_path / "out"), "--quiet"]
    assert main(words) == 0
    rebuilt = tmp_path / "dda"
    rebuilt.write_text(f"#!/bin/sh\n'{DDA}' \"$@\" | sed 's/ build [0-9a-f]* on/ build 0 on/'\n")
    rebuilt.chmod(0o755)
    monkeypatch.setenv("VOUSSOIR_DDA", str(rebuilt))
    assert main(words) == 2
    assert "(other program)" in capsys.readouterr().err


def damage(file: Path, dice: random.Random) -> None:
    """Damage a file: a byte changed, a piece taken out or doubled, an end cut off, emptied."""
    content = bytearray(file.read_bytes())
    start = dice.randrange(len(content) + 1)
    kind = dice.randrange(6)
    if kind == 0 and start < len(content):
        content[start] = dice.choice([0, 44, 34, 10, 48, 57, 120, 195, 255])
    elif kind == 1:
        del content[start : start + dice.randint(1, 40)]
    elif kind == 2:
        content[start:start] = content[start : start + dice.randint(1, 40)]
    elif kind == 3:
        del content[start:]
    elif kind == 4:
        content[:] = b""
    else:
        content[:start] = b""
    file.write_bytes(content)


@pytest.mark.parametrize("where", ["parts", "merged"])
def test_damaged_part_is_computed_again(tmp_path: Path, where: str, capsys) -> None:
    deck = sweep(tmp_path)
    right = undisturbed(deck)
    dice = random.Random(where)
    for mutant in range(MUTANTS):
        out = tmp_path / f"out{mutant}"
        words = ["campaign", str(deck), "--out", str(out), "--workers", "1"]
        share = [] if where == "merged" else ["--index", "1", "--of", "2"]
        assert main([*words, *share, "--quiet"]) == 0
        files = [
            path
            for path in (out if where == "merged" else out / "parts").rglob("*")
            if path.is_file() and path.name not in ("run.lock", "campaign.record")
        ]
        file = dice.choice(sorted(files))
        if dice.random() < 0.2:
            (out / "campaign.record").write_bytes(b"\xff\0 damaged")
        damage(file, dice)
        capsys.readouterr()
        assert main(words) == 0, (mutant, file)
        told = capsys.readouterr().err
        assert all(": warning: expected" in line for line in told.splitlines())
        assert tables(out) == right, (mutant, file)


def test_second_campaign_in_a_folder_gives_4_and_says_why(tmp_path: Path) -> None:
    deck, out = sweep(tmp_path), tmp_path / "out"
    out.mkdir()
    words = [sys.executable, "-m", "voussoir", "campaign", str(deck), "--out", str(out)]
    with (out / "run.lock").open("ab") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        assert done.returncode == 4
        assert "run.lock:1: error: expected a folder that no other run or campaign" in done.stderr
        assert [path.name for path in out.iterdir()] == ["run.lock"]
    assert subprocess.run(words, check=False).returncode == 0


def test_lock_of_a_killed_campaign_holds_up_no_other(tmp_path: Path) -> None:
    deck, out = sweep(tmp_path), tmp_path / "out"
    deck.write_text(SWEEP.replace("count = 12", "count = 3000").replace("= 8", "= 60"))
    words = [sys.executable, "-m", "voussoir", "campaign", str(deck), "--out", str(out)]
    first = subprocess.Popen([*words, "--quiet"], start_new_session=True)
    patience = time.monotonic() + 60
    while not list(out.glob("parts/*/results.csv")) and time.monotonic() < patience:
        time.sleep(0.005)
    os.killpg(first.pid, signal.SIGSTOP)
    assert first.poll() is None
    second = subprocess.run(words, capture_output=True, text=True, check=False)
    assert second.returncode == 4 and "in use" in second.stderr
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    third = subprocess.run(words, capture_output=True, text=True, check=False)
    assert third.returncode == 0, third.stderr
    assert (out / "results.csv").read_text().count("\n") == 3001


def test_shares_work_side_by_side(tmp_path: Path) -> None:
    deck, out = sweep(tmp_path), tmp_path / "out"
    words = [sys.executable, "-m", "voussoir", "campaign", str(deck), "--out", str(out)]
    shares = [subprocess.Popen([*words, "--index", str(i), "--of", "3"]) for i in (1, 2, 3)]
    assert [share.wait() for share in shares] == [0, 0, 0]
    assert tables(out) == undisturbed(deck)


def test_restart_files_of_cases_are_kept_and_known_by_their_content(tmp_path: Path, capsys) -> None:
    (tmp_path / "a.blocks").write_text(BLOCKS.format(x=0.5).replace(" 0\n0.5 0", " 0.1\n0.5 0.1"))
    deck, out = tmp_path / "deck.nml", str(tmp_path / "out")
    deck.write_text(
        "&scene kind = 'blocks', geometry = 'a.blocks' /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 0.02, time_step = 0.01 /\n"
        "&sweep parameter = 'gravity', values = 5, 9 /\n"
    )
    words = ["campaign", str(deck), "--quiet", "--out"]
    assert main([*words, out, "--set", "output%restart=.true."]) == 0
    files = [tmp_path / "out" / f"case_{case}.restart" for case in (1, 2)]
    first, second = (file.read_bytes() for file in files)
    (tmp_path / "on.restart").write_bytes(first)
    go_on = [*words, str(tmp_path / "on"), "--set", "analysis%restart='on.restart'"]
    assert main(go_on) == 0
    (tmp_path / "on.restart").write_bytes(second)
    assert main(go_on) == 2
    assert "(other files)" in capsys.readouterr().err
