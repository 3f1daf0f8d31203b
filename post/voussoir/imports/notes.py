"""Remarks of a reader."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field


@dataclass
class Notes:
    """What a reader has left out or changed, for the user to read."""

    dropped: list[str] = field(default_factory=list)  #: Pieces that make no block
    places: dict[str, str] = field(default_factory=dict)  #: Where the first piece is, by the words of `dropped`
    left_out: list[str] = field(default_factory=list)  #: What is no piece: text, points, a constant coordinate
    repaired: list[str] = field(default_factory=list)
    snapped: list[float] = field(default_factory=list)  #: Distances in units of the file
    warnings: list[str] = field(default_factory=list)  #: What may not be what the user wants
    short: list[tuple[str, complex, float]] = field(default_factory=list)  #: Layer, end that stops short, its gap

    def drop(self, words: str, place: str = "") -> None:
        """Add a piece that makes no block, and where it is."""
        self.dropped.append(words)
        self.places.setdefault(words, place)

    def lines(self, scale: float) -> list[str]:
        """Remarks, equal ones once; a unit of the file is so many metres."""
        text = [f"warning: {words}" for words in self.warnings]
        for kind, remarks in (("dropped", self.dropped), ("left out", self.left_out), ("repaired", self.repaired)):
            for words, count in Counter(remarks).items():
                times = f" ({count} times)" if count > 1 else ""
                place = self.places.get(words, "") if kind == "dropped" else ""
                text.append(f"{kind}: {words}{times}" + (f", {'first ' * (count > 1)}{place}" if place else ""))
        if self.snapped:
            text.append(f"snapped: {len(self.snapped)} points, by at most {max(self.snapped) * scale:.3g} m")
        return text
