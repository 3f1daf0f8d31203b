"""The catalogue of stiff and extreme scenes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from voussoir_benches import checks, exact, expectations, measures, scene as shapes, stability_blocks
from voussoir_benches.checks import Check, verdict
from voussoir_benches.scene import GEOMETRIES, Scene, block_scene, rectangle, written_block
from voussoir_benches.stability_arches import arches, random_arches
from voussoir_benches.stability_blocks import WEIGHT, moving, stable
from voussoir_benches.stability_random import random_blocks
from voussoir_benches.tables import rows

_SQUARE = rectangle(0.0, 0.0, 1.0, 1.0)
#: Names of the tables: formulas, measures, answers, and blocks as their file has them
_NAMES: dict[str, Any] = {
    **vars(exact), **vars(measures), **vars(checks), **vars(expectations), **vars(shapes), **vars(stability_blocks),
    "block": written_block, "free": shapes.written_blocks, "SQUARE": _SQUARE, "BLOCK": written_block(_SQUARE),
    "HIGH": written_block(rectangle(0.0, 1.0, 1.0, 1.0)), "CENTRED": rectangle(-0.5, -0.5, 1.0, 1.0),
    "TABLE": written_block(rectangle(-10.0, -1.0, 60.0, 1.0), "fixed"),
    "SLIDER": written_block(rectangle(0.0, 0.0, 2.0, 0.5)), "SLIDE": exact.slide(30.0, 20.0),
    "STANDS": stable(Check("N [N/m]", WEIGHT, measures.closed_force(1), 1e-6)),
    "COMPLETED": verdict("completed", "verdict"),
    "STEPS": tuple(10.0**k for k in range(-7, 1)), "ARCH": b"&arch voussoirs = 12, thickness_ratio = 0.15 /\n",
    "LINES": ["0 0 1 0 1", "1 0 1 1 1", "1 1 0 1 1", "0 1 0 0 1"], "JOINT": "0 0.3 1 0.3 1"}


def catalogue() -> Iterator[Scene]:
    """All scenes but the random ones."""
    yield from arches()
    for row in rows("stability_blocks.json", _NAMES):
        yield from _in_both(**row)
    for row in rows("stability_motion.json", _NAMES):
        yield moving(**{**row, "blocks": "".join(row["blocks"]), "deck": row.get("deck", {})})
    for row in rows("stability_input.json", _NAMES):
        yield _doubtful(**row)


def random_scenes(count: int, seed: int) -> Iterator[Scene]:
    """Scenes that nobody has listed, two thirds of them arches; the same seed makes the same ones."""
    blocks = count // 3
    yield from random_arches(count - blocks, seed)
    yield from random_blocks(blocks, seed)


def _in_both(
    group: str, name: str, guard: str, blocks: str | list[str], answer: Any = None, moved: Any = None,
    push: float | None = None, geometries: Any = GEOMETRIES, deck: dict[str, Any] | None = None
) -> Iterator[Scene]:
    """A row of stability_blocks.json in its geometries, or as it stands; `push` is a horizontal load to be found."""
    groups, text = deck or {}, "".join(blocks)
    if push is not None:
        answer, moved = expectations.Critical(push), expectations.Critical(push, 1e-4 * push)
        search = {"parameter": "horizontal_coefficient", "low": 0.0, "high": 2.0}
        groups = {"material": {"unit_weight": WEIGHT}, "search": search, **groups}
    if not geometries:
        yield block_scene(group, name, guard, text, answer, **groups)
    for geometry, young in geometries:
        own = {**groups, "material": {"young": young, **groups.get("material", {})}, "analysis": {"geometry": geometry}}
        yield block_scene(
            group, f"{name}, {geometry}", guard, text, answer if geometry == "reference" else moved or answer, **own)


def _doubtful(
    name: str, answer: Any, blocks: str | list[str] | None = None, written: bytes = b"", lines: str = "",
    guard: str = "input is checked before anything is computed", deck: dict[str, Any] | None = None
) -> Scene:
    """A row of stability_input.json: a file of blocks or of lines, or a deck as it is written."""
    if lines:
        groups = {"scene": {"kind": "lines", "geometry": "lines.geo"}}
        return Scene("bad input", name, groups, answer, guard, {"lines.geo": lines})
    if blocks is None:
        return Scene("bad input", name, written, answer, guard)
    own = {"material": {"unit_weight": WEIGHT}, **(deck or {})}
    return block_scene("bad input", name, guard, "".join(blocks), answer, **own)
