"""A stiff or extreme scene: its deck, its files, what it must answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from voussoir.bench.stability_judge import Expectation

#: Corners of a polygon [m]
Corners = Sequence[tuple[float, float]]
#: Name of the file of blocks beside a deck
BLOCKS = "scene.blocks"


@dataclass(frozen=True)
class Scene:
    """One scene."""

    group: str  #: What is extreme about it
    name: str  #: Its place in the group
    deck: dict[str, dict[str, Any]] | bytes  #: Groups of the deck: keys and values; or the deck as it is written
    expectation: Expectation  #: What it must answer
    guard: str  #: What keeps the answer right
    files: Mapping[str, str] = field(default_factory=dict)  #: Names and texts of the files beside the deck

    @property
    def has_lean_plan(self) -> bool:
        """Whether the scene needs less of the method where fewer tables are wanted: an arch does."""
        return isinstance(self.deck, dict) and not {"scene", "output"} & set(self.deck)

    def text(self, lean: bool = False) -> bytes:
        """The deck as it is written: with all that can be told, or lean with a row a case alone."""
        if isinstance(self.deck, bytes):
            return self.deck
        told = {"joints": False, "blocks": False} if lean else {"condition": True}
        output = {"vtu": False, **told, **self.deck.get("output", {})}
        lines = []
        for group, keys in {**self.deck, "output": output}.items():
            values = ", ".join(f"{key} = {_written(value)}" for key, value in keys.items())
            lines.append(f"&{group.split('#')[0]} {values} /")
        return ("\n".join(lines) + "\n").encode()


class Bare:
    """A word written without quotes."""

    def __init__(self, word: str) -> None:
        self.word = word

    def __repr__(self) -> str:
        return self.word


def _written(value: Any) -> str:
    """A value as a deck writes it."""
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, str):
        return f"'{value}'"
    if isinstance(value, (list, tuple, np.ndarray)):
        return ", ".join(_written(item) for item in value)
    return repr(value)


def rectangle(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    """Corners of an upright rectangle, from its lower left one on."""
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def written_block(corners: Corners, words: str = "") -> str:
    """A block as its file writes it: the words after `block`, the corners."""
    return f"block {words}\n" + "".join(f"{x!r} {y!r}\n" for x, y in corners)


def block_scene(
    group: str, name: str, guard: str, blocks: str, expectation: Expectation, **groups: dict[str, Any]
) -> Scene:
    """A scene of a file of blocks."""
    deck = {"scene": {"kind": "blocks", "geometry": BLOCKS}, **groups}
    return Scene(group, name, deck, expectation, guard, {BLOCKS: blocks})
