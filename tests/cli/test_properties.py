"""What must hold of every assembly, asked of a few random ones; the target voussoir-properties asks 200 a property."""

from __future__ import annotations

import itertools
import os
from pathlib import Path

import pytest
from properties import PROPERTIES, Bench

SEEDS = (0, 8, 11)  #: Assemblies of three kinds: a wall, a ring, a slope
WEDGED = (23, 122)  #: What falls with forces that hold one another in any size, and with corners that hardly open
PUSHED = (3042, 3058)  #: What is pushed, in time, and comes to rest in its 17th step
PRESSED = (304, 771)  #: What is pressed hard, in time, by forces over gaps that a look leaves
LIFTED = (771018, 771024)  #: What is pushed, in time, by residual gaps of contacts that bear much and hardly move
RESTING = (335, 367, 447, 7020, 7029)  #: What rests, in time, and creeps where sweeps end too soon


@pytest.mark.parametrize(
    ("name", "seed"),
    [*itertools.product(PROPERTIES, SEEDS), *(("proof", s) for s in WEDGED),
     *(("energy", s) for s in PUSHED + PRESSED + LIFTED + RESTING)])
def test_property_holds_of_random_assemblies(tmp_path: Path, name: str, seed: int) -> None:
    if name == "proof":
        pytest.importorskip("voussoir", reason="PYTHONPATH wants the build's python folder")
    PROPERTIES[name](Bench(Path(os.environ["DDA"]), tmp_path), seed)
