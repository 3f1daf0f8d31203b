"""`voussoir verify` finds the joints of rounded corners and near misses that the program has found."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from dda_command import run_deck
from live_assemblies import random_assembly
from test_near_misses import TOLERANCE, lintel, rough_arch
from test_verify import change_a_number
from verify_bridges import misplaced

from voussoir.command.main import main

#: A decision, and the push at collapse under either rule
TASKS = {
    "decision": "",
    "coulomb": "&search parameter = 'horizontal_coefficient' /\n",
    "associated": "&search parameter = 'horizontal_coefficient' /\n&analysis flow = 'associated' /\n",
}


def run_blocks(folder: Path, blocks: str, keys: str = "", scene: str = "", friction_deg: float = 40.0) -> Path:
    """Folder of the results of a file of blocks."""
    (folder / "a.blocks").write_text(blocks)
    run_deck(folder, f"&scene kind = 'blocks', geometry = 'a.blocks'{scene} /\n"
                     f"&joint friction_deg = {friction_deg!r} /\n{keys}", "--quiet", name="a")
    return folder / "a"


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("gap", [0.98, 1.02, 9.8, -0.98, -1.98])
def test_a_short_post_is_proven(tmp_path: Path, gap: float, task: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Gaps in multiples of the tolerance; limits by rational arithmetic, too."""
    folder = run_blocks(tmp_path, lintel(gap * TOLERANCE), TASKS[task])
    assert main(["verify", str(folder), "--exact"]) == 0, capsys.readouterr().out
    assert "1 of 1 cases have proofs, 0 fail" in capsys.readouterr().out


@pytest.mark.parametrize("gap, tolerance", [(5.0, 1e-5), (0.9, 1e-5), (20.0, 3e-3), (100.0, 1e-2), (-30.0, 2e-3)])
def test_joints_are_those_of_the_contact_tolerance(
    tmp_path: Path, gap: float, tolerance: float, capsys: pytest.CaptureFixture[str]
) -> None:
    """Gaps in multiples of the default tolerance, wider and narrower than the tolerance of the deck."""
    blocks = lintel(gap * TOLERANCE)
    folder = run_blocks(tmp_path, blocks, TASKS["coulomb"], f", contact_tolerance = {tolerance!r}")
    assert main(["verify", str(folder), "--exact"]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("off, seed", [(4e-5, 0), (6e-5, 0), (6e-5, 3)])
def test_an_arch_with_misplaced_corners_is_proven(
    tmp_path: Path, off: float, seed: int, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each joint has a corner of the one voussoir or of the other at its ends, off the other's edge."""
    folder = run_blocks(tmp_path, rough_arch(seed, off), TASKS["coulomb"])
    assert main(["verify", str(folder), "--exact"]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("seed", [2, 5, 7, 70223])
def test_rough_assemblies_are_proven(tmp_path: Path, seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    """Corners, edges and notches, off by a tenth of the tolerance; two joints between the same corners."""
    blocks, friction = random_assembly(seed)
    folder = run_blocks(tmp_path, misplaced(blocks, 1e-5, seed), "&search parameter = 'load_factor' /\n",
                        friction_deg=friction)
    assert main(["verify", str(folder)]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("seed", range(6))
def test_a_changed_number_of_a_near_miss_is_found(tmp_path: Path, seed: int) -> None:
    """By a share of a millionth and more."""
    folder = run_blocks(tmp_path, rough_arch(seed, 6e-5), TASKS["coulomb"])
    change_a_number(folder, random.Random(seed))
    assert main(["verify", str(folder), "--quiet", "--ignore-sums"]) == 1


def test_forces_across_an_open_gap_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A deck of a smaller tolerance has no such joint."""
    folder = run_blocks(tmp_path, lintel(2 * TOLERANCE), scene=", contact_tolerance = 1e-4")
    record = folder / "deck.record"
    text = record.read_text()
    other = re.sub(r"(contact_tolerance\n +)\S+", r"\g<1>1e-6", text)
    assert other != text
    record.write_text(other)
    assert main(["verify", str(folder), "--quiet", "--ignore-sums"]) == 1
    assert "blocks 3 and 4 have no joint" in capsys.readouterr().out
