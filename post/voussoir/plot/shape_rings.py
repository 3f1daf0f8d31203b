"""Arches of any shape among decks, and the rings of their voussoirs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from voussoir.verify.deck import SHAPES, SUPPORTS

#: Groups and keys that make an arch a shape besides those of &arch
OTHERS = ("&fill", "&tie")


def is_shape(record: Sequence[str], searched: str | None) -> bool:
    """Whether a record is of an arch that is more than a circular ring of voussoirs."""
    words = [line.strip() for line in record]
    for number, word in enumerate(words):
        if word in OTHERS or word.startswith(("fill%", "tie%", "support%")):
            return True
        if word in SHAPES and not (word == "arch%shape" and words[number + 1 : number + 2] == ["circular"]):
            return True
    swept = [line.split()[1].split("%")[-1] for line in record if line.startswith("&sweep ")]
    names = [name.split("%")[-1] for name in [*swept, searched or ""]]
    return any(f"arch%{name}" in SHAPES or f"support%{name}" in SUPPORTS for name in names)


def ring_joints(first: np.ndarray, second: np.ndarray, count: int, voussoirs: int) -> list[tuple[int, int]]:
    """Pairs of joints between which thrust goes through a voussoir; these are numbered first, ring by ring."""
    sides: dict[int, list[int]] = {}
    for joint, pair in enumerate(zip(first, second)):
        inside = [int(block) for block in pair if block <= count]
        same_ring = len({(block - 1) // voussoirs for block in inside}) == 1
        if len(inside) == 1 or same_ring:
            for block in inside:
                sides.setdefault(block, []).append(joint)
    return [(pair[0], pair[1]) for pair in sides.values() if len(pair) == 2]
