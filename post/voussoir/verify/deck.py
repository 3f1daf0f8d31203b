"""What a deck says of loads, joints and shape, from the record that a run leaves, without the program's own reader."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

from voussoir.record import SHAPES, SUPPORTS, Record, read_record
from voussoir.verify.rational import sine_cosine

#: Keys that matter here, and their defaults
DEFAULTS = dict(pair.split("=") for pair in """
scene%kind=arch scene%geometry= scene%contact_tolerance=1e-4 arch%radius=10 arch%thickness_ratio=0.15
arch%half_angle_deg=90 arch%voussoirs=36 arch%facet_deg=0 arch%springing=frictional arch%rings=1 arch%spans=1
material%density=2240 joint%friction_deg=50 joint%cohesion=0 joint%tension=0 load%gravity=9.81
load%gravity_direction_deg=-90 load%horizontal_coefficient=0 load%load_factor=1 load%live_horizontal=.false.
load%water_rise=0 fill%height=0 fill%unit_weight=0 fill%spread=0.5 fill%passive_coefficient=0 vehicle%length=0.3
""".split())
#: Keys without a default
OTHERS = tuple("""
analysis%mode analysis%geometry arch%joints_deg material%unit_weight material%compressive_strength scene%analysis
live%x live%y live%fx live%fy vehicle%axles vehicle%spacings vehicle%position fill%friction_deg fill%passive_share
fill%backing_height fill%backing_unit_weight tie%strength tie%x1 tie%y1 tie%x2 tie%y2 search%parameter
""".split())
#: Lengths of an arch of any shape
LENGTHS = tuple(f"arch%{name}" for name in (
    "span", "rise", "right_rise", "thickness", "crown_thickness", "springing_thickness", "pier_width", "pier_height",
    "buttress_width", "buttress_height",
))


class VerifyError(ValueError):
    """Something that cannot be verified, with the reason."""


@dataclass
class Deck(Record):
    """The record of a deck, and whether numbers are the decimals themselves."""

    exact: bool = False

    def text(self, key: str) -> str:
        """A single value as text."""
        values = self.values.get(key, [DEFAULTS.get(key, "")])
        if not values:
            raise VerifyError(f"deck.record: expected a value of {key}, got none")
        return values[0]

    def read(self, text: str) -> float:
        """A number from its decimal, whose exponent may begin with d, or from a fraction of whole numbers."""
        if re.fullmatch(r"-?\d+/\d+", text):
            return Fraction(text) if self.exact else float(Fraction(text))  # type: ignore[return-value]
        decimal = text.lower().replace("d", "e")
        try:
            number = float(decimal)
        except ValueError:
            number = math.nan
        # what underflows would take a fraction of any length
        if not math.isfinite(number) or number == 0 and re.search("[1-9]", decimal.partition("e")[0]):
            raise VerifyError(f"expected a number in the deck or its files, got {text[:40]!r}")
        return Fraction(decimal) if self.exact else number  # type: ignore[return-value]

    def number(self, key: str) -> float:
        """A single number."""
        return self.read(self.text(key))

    def numbers(self, key: str) -> list[float]:
        """A list of numbers, empty if it is not given."""
        return [self.read(value) for value in self.values.get(key, [])]

    def sine_cosine(self, degrees: float) -> tuple[float, float]:
        """Sine and cosine of an angle."""
        if self.exact:
            return sine_cosine(Fraction(degrees))  # type: ignore[return-value]
        return math.sin(math.radians(degrees)), math.cos(math.radians(degrees))

    def gives(self, key: str) -> bool:
        """Whether a key is given."""
        return key in self.values

    def with_value(self, name: str, value: str) -> Deck:
        """A deck with another value of a parameter, such as friction_deg, arch%radius or x(2)."""
        match = re.fullmatch(r"(?:(\w+)%)?(\w+)(?:\((\d+)\))?", name.strip())
        if match is None:
            raise VerifyError(f"expected the name of a parameter, got {name!r}")
        group, key, item = match.groups()
        # keys of &scene do not vary
        names = [full.split("%") for full in (*DEFAULTS, *OTHERS, *SHAPES, *SUPPORTS) if not full.startswith("scene%")]
        known = ["%".join(name) for name in names if name[1] == key and group in (None, name[0])]
        values = dict(self.values)
        if known:
            full = known[0]
            new = list(values.get(full, [""]))
            place = int(item) - 1 if item else 0
            if not 0 <= place < len(new):
                raise VerifyError(f"deck.record: expected {name} in a list of {len(new)}")
            new[place] = value
            values[full] = new
        return replace(self, values=values)

    def case(self, number: int) -> Deck:
        """The deck of one case; the last sweep runs fastest, a linked one goes with the one before."""
        if not all(sweep.values for sweep in self.sweeps) or any(sweep.linked for sweep in self.sweeps[:1]):
            raise VerifyError("deck.record: expected values of every sweep, and the first one not linked")
        deck, rest, positions = self, number - 1, [0] * len(self.sweeps)
        for s in range(len(self.sweeps) - 1, -1, -1):
            if not self.sweeps[s].linked:
                rest, positions[s] = divmod(rest, len(self.sweeps[s].values))
        for s, sweep in enumerate(self.sweeps):
            if sweep.linked:
                positions[s] = positions[s - 1]
            if positions[s] >= len(sweep.values):
                raise VerifyError(f"deck.record: expected as many values of {sweep.name} as it is linked to")
            deck = deck.with_value(sweep.name, sweep.values[positions[s]])
        return deck

    @property
    def voussoirs(self) -> int:
        """Number of voussoirs of an arch of any shape, which come before its supports."""
        return round(math.prod(float(self.number(f"arch%{name}")) for name in ("voussoirs", "rings", "spans")))

    def direction(self) -> tuple[float, float]:
        """Direction of gravity."""
        angle = self.number("load%gravity_direction_deg")
        if angle == -90:
            return self.read("0"), self.read("-1")
        sine, cosine = self.sine_cosine(angle)
        return cosine, sine

    def push(self) -> float:
        """Horizontal force over the weight."""
        push = self.number("load%horizontal_coefficient")
        if self.text("load%live_horizontal").lower().startswith((".t", "t")):
            push *= self.number("load%load_factor")
        return push

    def unit_weight(self) -> float:
        """Weight per volume where a material has none of its own."""
        if self.gives("material%unit_weight"):
            return self.number("material%unit_weight")
        return self.number("material%density") * self.number("load%gravity")


def read_deck(folder: Path) -> Deck:
    """The deck of a folder of results: its given keys and sweeps."""
    if not (folder / "deck.record").exists():
        raise VerifyError(f"no deck.record in {folder}: expected a folder that dda run has written")
    record = read_record(folder)
    return Deck(record.values, record.sweeps)
