"""Values of a deck as `dda` writes them (deck.record), and the list of all keys."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from voussoir.files import read_text

#: Keys that make an arch more than a circular ring of voussoirs; an assembly of blocks then
SHAPES = frozenset(f"arch%{name}" for name in (
    "shape span rise right_rise thickness crown_thickness springing_thickness joint_direction rings spans pier_width "
    "pier_height pier_courses buttress_width buttress_height lune_deg").split())
#: Keys of the displacements of the left and the right springing, which make an arch one, too
SUPPORTS = frozenset(f"support%{side}_{name}" for side in ("left", "right") for name in ("dx", "dy", "rotation_deg"))
#: Other keys, and groups, that do
_OTHERS = ("&fill", "fill%", "&tie", "tie%", "support%", "material%compressive_strength")


@dataclass
class Sweep:
    """A parameter and the values that it takes."""

    name: str
    linked: bool = False
    values: list[str] = field(default_factory=list)


@dataclass
class Record:
    """Values by group%key, as texts, with the names of groups such as "&search"; and the sweeps."""

    values: dict[str, list[str]] = field(default_factory=dict)
    sweeps: list[Sweep] = field(default_factory=list)

    def setting(self, name: str) -> str | None:
        """First value of a key; None if the deck leaves it out."""
        return next(iter(self.values.get(name, [])), None)

    @property
    def searched(self) -> str | None:
        """Name of the searched parameter, None if none is."""
        if "&search" not in self.values:
            return None
        return self.setting("search%parameter") or "thickness_ratio"

    def is_shape(self) -> bool:
        """Return true for an arch that is more than a circular ring of voussoirs: it is taken as blocks."""
        names = [name.rpartition("%")[2] for name in [*(sweep.name for sweep in self.sweeps), self.searched or ""]]
        varied = {f"{group}%{name}" for name in names for group in ("arch", "support", "material")}
        shapes = {key for key in SHAPES & self.values.keys()
                  if key != "arch%shape" or (self.setting(key) or "").lower() != "circular"}
        is_arch = (self.setting("scene%kind") or "arch") == "arch"
        return is_arch and bool(
            shapes or varied & (SHAPES | SUPPORTS | {"material%compressive_strength"})
            or any(key.startswith(_OTHERS) for key in self.values))


def record_of(lines: Iterable[str], place: Path) -> Record:
    """The record of some lines; ValueError with the place and the line where they are damaged."""
    record, target = Record(), None
    for number, line in enumerate(lines, 1):
        words = line.split()
        if number == 1 and not line.startswith("dda "):
            raise ValueError(f"{place}:1: error: expected the version of dda, got {line[:40]!r}")
        if line.startswith("&sweep ") and len(words) > 1:
            record.sweeps.append(Sweep(words[1], words[-1] == "linked"))
            target = record.sweeps[-1].values
        elif line.startswith("  ") and target is not None:
            target.append(line.strip())
        elif re.fullmatch(r"&(?!sweep)\w+|\w+%\w+", line):
            record.values[line] = target = []
        elif line and number > 1 and not line.startswith("files"):
            raise ValueError(f"{place}:{number}: error: expected a group, a key or its value, got {line[:40]!r}")
    return record


def read_record(folder: Path) -> Record:
    """The record of a folder of results; an empty one where it has none."""
    path = folder / "deck.record"
    return record_of(read_text(path).split("\n"), path) if path.exists() else Record()
