"""The catalogue of stiff and extreme scenes."""

from __future__ import annotations

from collections.abc import Iterator

from voussoir_benches.scene import Scene
from voussoir_benches.stability_arches import arches, random_arches
from voussoir_benches.stability_blocks import block_scenes
from voussoir_benches.stability_input import input_scenes
from voussoir_benches.stability_motion import motion_scenes
from voussoir_benches.stability_random import random_blocks


def catalogue() -> Iterator[Scene]:
    """All scenes but the random ones."""
    yield from arches()
    yield from block_scenes()
    yield from motion_scenes()
    yield from input_scenes()


def random_scenes(count: int, seed: int) -> Iterator[Scene]:
    """Scenes that nobody has listed, two thirds of them arches; the same seed makes the same ones."""
    blocks = count // 3
    yield from random_arches(count - blocks, seed)
    yield from random_blocks(blocks, seed)
