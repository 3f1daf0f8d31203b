"""Remarks of a reader."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field


@dataclass
class Notes:
    """What a reader has left out or changed, for the user to read."""

    dropped: list[str] = field(default_factory=list)  #: Pieces that make no block
    left_out: list[str] = field(default_factory=list)  #: What is no piece: text, points, a constant coordinate
    repaired: list[str] = field(default_factory=list)
    snapped: list[float] = field(default_factory=list)  #: Distances in units of the file
    short: list[tuple[str, complex, float]] = field(default_factory=list)  #: Layer, end that stops short, its gap

    def lines(self, scale: float) -> list[str]:
        """Remarks, equal ones once; a unit of the file is so many metres."""
        rows = [(f"{kind}: {words}", count) for kind, remarks in (
            ("dropped", self.dropped), ("left out", self.left_out), ("repaired", self.repaired))
            for words, count in Counter(remarks).items()]
        text = [words + (f" ({count} times)" if count > 1 else "") for words, count in rows]
        if self.snapped:
            text.append(f"snapped: {len(self.snapped)} points, by at most {max(self.snapped) * scale:.3g} m")
        return text
