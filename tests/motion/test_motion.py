"""Random scenes with known answers, of one seed per family; the target voussoir-motion runs others."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import run

#: Families with wrong answers, and why; a cure removes its line
WRONG: dict[str, str] = {}
SEEDS = range(3)


@pytest.mark.parametrize("family", [
    pytest.param(name, marks=pytest.mark.xfail(reason=WRONG[name], strict=True)) if name in WRONG else name
    for name in run.families()])
def test_answers_are_exact(family: str, tmp_path: Path) -> None:
    found = [run.ask(Path(os.environ["DDA"]), tmp_path, family, seed) for seed in SEEDS]
    assert [one for one in found if one.wrong or one.is_slow] == []


@pytest.mark.parametrize("family", [name for name in run.families() if run.scene_of(name, 0).is_step_free])
def test_answers_are_the_same_at_every_step(family: str, tmp_path: Path) -> None:
    found = run.ask_steps(Path(os.environ["DDA"]), tmp_path, family, 0)
    assert not found.wrong and not found.is_slow, found.wrong
