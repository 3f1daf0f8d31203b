"""A scene of validation or stability: its deck, its files, what it must answer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from voussoir.deck.text import deck_text
from voussoir_benches.checks import Check
from voussoir_benches.expectations import Expectation, Measured

Corners = Sequence[tuple[float, float]]  #: Corners of a polygon [m]
BLOCKS = "scene.blocks"  #: Name of the file of blocks beside a deck
MOVED = ("analysis%geometry=current",)  #: Settings of a benchmark with blocks that move
#: Both geometries, with the modulus that makes moving blocks nearly rigid [Pa]
GEOMETRIES = (("reference", 5e9), ("current", 5e12))


@dataclass(frozen=True)
class Scene:
    """A deck and what it must answer."""

    group: str  #: Heading under which it stands
    name: str  #: Its place in the group
    deck: dict[str, dict[str, Any]] | bytes | str  #: Groups of keys and values; as it is written; a benchmark's name
    expectation: Expectation  #: What it must answer
    note: str  #: Where the exact answer comes from, or what keeps the answer right
    files: Mapping[str, str] = field(default_factory=dict)  #: Names and texts of the files beside the deck
    settings: tuple[str, ...] = ()  #: Values of --set
    rate: bool = False  #: Whether it is run again in shorter steps
    slow: bool = False  #: Whether one run takes longer than two seconds
    after: str = ""  #: Benchmark from whose end it continues

    @property
    def has_lean_plan(self) -> bool:
        """Return true if the scene needs less of the method where fewer tables are wanted: an arch does."""
        return isinstance(self.deck, dict) and not {"scene", "output"} & set(self.deck)

    @property
    def benchmark(self) -> str:
        """Name of the deck of a benchmark."""
        return str(self.deck)

    def text(self, lean: bool = False) -> bytes:
        """The deck as written: with all tables, or lean with one row per case."""
        if isinstance(self.deck, bytes):
            return self.deck
        if isinstance(self.deck, str):
            raise TypeError(f"expected groups or bytes of a deck, got the benchmark {self.deck}")
        tables = {"joints": False, "blocks": False} if lean else {"condition": True}
        output = {"vtu": False, **tables, **self.deck.get("output", {})}
        return deck_text({**self.deck, "output": output}).encode()


def benchmark(
    group: str, deck: str, source: str, *checks: Check, settings: tuple[str, ...] = (), **others: Any
) -> Scene:
    """A deck of `input/benchmarks`, named with what is set, and where its exact values come from."""
    name = " ".join([deck, *(setting.partition("=")[2] for setting in settings)])
    return Scene(group, name, deck, Measured(checks), source, settings=settings, **others)


def in_current(scene: Scene, accept: float | None) -> Scene:
    """A benchmark with blocks that move and strain, where errors may be another one."""
    checks = scene.expectation.checks if isinstance(scene.expectation, Measured) else ()
    if accept is not None:
        checks = tuple(replace(check, accept=accept) for check in checks)
    return replace(scene, name=f"{scene.name} current", expectation=Measured(checks), settings=MOVED)


def rectangle(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    """Corners of an upright rectangle, from its lower left one on."""
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def written_block(corners: Corners, words: str = "") -> str:
    """A block as its file writes it: the words after `block`, the corners."""
    return f"block {words}\n" + "".join(f"{x!r} {y!r}\n" for x, y in corners)


def written_blocks(shapes: Iterable[Corners]) -> str:
    """Blocks that can move as their file writes them."""
    return "".join(map(written_block, shapes))


def block_scene(
    group: str, name: str, guard: str, blocks: str, expectation: Expectation, **groups: Any
) -> Scene:
    """A scene of a file of blocks."""
    deck = {"scene": {"kind": "blocks", "geometry": BLOCKS}, **groups}
    return Scene(group, name, deck, expectation, guard, {BLOCKS: blocks})
