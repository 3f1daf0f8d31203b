"""Blocks as Python values: `voussoir.Blocks`."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any, Union

import numpy.typing as npt

from voussoir.dda_program import find_dda
from voussoir.deck.run import Deck
from voussoir.deck.text import groups_of
from voussoir.extras import load

#: Name of the file of blocks beside the deck
BLOCKS_FILE = "deck.blocks"
#: A joint that never opens nor slides: pieces of one polygon with holes
BOND = "friction_deg 89.9 cohesion 1e15 tension 1e15"
#: Keys of a material and of a joint's law in a file of blocks
_MATERIAL = ("density", "unit_weight", "young", "poisson")
_LAW = ("friction_deg", "cohesion", "tension")


@dataclass(frozen=True)
class BlockShape:
    """One polygon as the file of blocks has it: its pieces, if it has holes."""

    #: Corners of the polygon [m], or of the pieces that it was cut into
    pieces: tuple[Sequence[tuple[float, float]], ...]
    fixed: bool  #: Whether it never moves
    material: int  #: Number of its material, from 1


class Blocks(Deck):
    """Polygons, what they are made of, and what acts on them.

    Parameters
    ----------
    **keys
        Keys of any group of a deck, as for `Arch`: Blocks(friction_deg=35, density=2400).

    Examples
    --------
    >>> wall = Blocks(friction_deg=35)
    >>> ground = wall.add([(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True)
    >>> stone = wall.add([(0, 0), (1, 0), (1, 2), (0, 2)])
    >>> run = wall.run(search="horizontal_coefficient")
    >>> round(float(run.cases["critical"][0]), 6)
    0.5
    """

    def __init__(self, **keys: Any) -> None:
        groups = groups_of(find_dda(), keys)
        scene = {**groups.pop("scene", {}), "kind": "blocks", "geometry": BLOCKS_FILE}
        super().__init__({"scene": scene, **groups})
        self.shapes: list[BlockShape] = []
        self.entries: list[str] = []
        self.dropped: list[str] = []
        self._laws: dict[tuple[int, int], str] = {}
        self._materials: dict[int, str] = {}

    @property
    def files(self) -> dict[str, str]:
        """The file of blocks by its name."""
        return {BLOCKS_FILE: self.block_text()}

    @files.setter
    def files(self, given: dict[str, str]) -> None:
        """Files follow from the blocks: none can be given."""

    @classmethod
    def from_shapely(
        cls, polygons: Any, fixed: Any = (), material: Union[int, Sequence[int]] = 1, **keys: Any
    ) -> Blocks:
        """Return blocks from polygons of shapely; shapes without an area are listed in `dropped`, with a warning.

        Parameters
        ----------
        polygons : geometry or iterable of geometries
            Polygons that can move; of collections, their members. A polygon with holes is cut into
            bonded pieces.
        fixed : likewise, optional
            Polygons that never move.
        material : int or sequence of int, optional
            Number of their material, or of each.
        **keys
            As for `Blocks`.

        Raises
        ------
        MissingPackage
            If there is no shapely.
        """
        blocks = cls(**keys)
        for shapes, is_fixed, materials in ((fixed, True, 1), (polygons, False, material)):
            found, dropped = polygons_of(shapes)
            given: Any = materials
            several = isinstance(given, Iterable) and not isinstance(given, str)
            numbers = list(given) if several else [given] * len(found)
            if len(numbers) != len(found):
                raise ValueError(f"expected {len(found)} materials, one a polygon, got {len(numbers)}")
            for polygon, number in zip(found, numbers):
                blocks.add_polygon(polygon, is_fixed, number)
            blocks.dropped += dropped
        if blocks.dropped:
            warnings.warn("dropped: " + "; ".join(blocks.dropped), stacklevel=2)
        return blocks

    def add(self, corners: npt.ArrayLike, fixed: bool = False, material: int = 1) -> int:
        """Add a polygon by its corners (n, 2), in either sense [m]: its number, from 1.

        ValueError if the corners are no pairs of numbers, `fixed` no flag, or `material` no whole number from 1.
        """
        self.shapes.append(BlockShape((_points(corners),), _flag(fixed), _whole(material, 1)))
        return len(self.shapes)

    def add_polygon(self, polygon: Any, fixed: bool = False, material: int = 1) -> int:
        """Add a polygon of shapely; one with holes becomes bonded pieces; ValueError for a polygon in space."""
        heights = {corner[2] for corner in polygon.exterior.coords if len(corner) == 3}
        if len(heights) > 1:
            raise ValueError(f"expected a polygon in the plane, got z from {min(heights):g} to {max(heights):g}")
        rings = (piece.exterior.coords[:-1] for piece in pieces_of(polygon))
        pieces = tuple(_points([corner[:2] for corner in ring]) for ring in rings)
        self.shapes.append(BlockShape(pieces, _flag(fixed), _whole(material, 1)))
        return len(self.shapes)

    def material(self, number: int, **properties: float) -> None:
        """Set density, unit_weight, young or poisson of a material from 2 on; material 1 has the deck's keys."""
        self._materials[_whole(number, 2)] = _words(properties, _MATERIAL)

    def joint(self, first: int, second: int, **law: float) -> None:
        """Set the law between two materials: friction_deg, cohesion, tension."""
        first, second = _whole(first, 1), _whole(second, 1)
        self._laws[min(first, second), max(first, second)] = _words(law, _LAW)

    def entry(self, text: str) -> None:
        """Add a line of the file of blocks, such as "load 1 2 0 -1000" or "measure 1 2"."""
        if not isinstance(text, str) or len(text.splitlines()) > 1:
            raise ValueError(f"expected one line of a file of blocks, got {text!r}")
        self.entries.append(text)

    def block_text(self) -> str:
        """The file of blocks."""
        own = _Materials(max([1, *self._materials, *(shape.material for shape in self.shapes)]))
        lines: list[str] = []
        for shape in self.shapes:
            for piece, number in zip(shape.pieces, own.of(shape)):
                lines.append("block fixed" if shape.fixed else "block")
                lines[-1] += f" material {number}" if number != 1 else ""
                lines += [f"  {float(x)!r} {float(y)!r}" for x, y in piece]
        numbers = {shape.material for shape in self.shapes} | set(self._materials) | set(own.origin)
        for number in sorted(numbers - {1}):
            words = self._materials.get(own.origin.get(number, number), "")
            lines.append(f"material {number} {words}".rstrip())
        for (first, second), law in self._laws.items():
            for one in own.all_of(first):
                lines += [
                    f"joint {one} {two} {law}"
                    for two in own.all_of(second)
                    if (one, two) not in own.bonds and (first != second or one <= two)
                ]
        lines += [f"joint {one} {two} {BOND}" for one, two in own.bonds]
        return "\n".join([*lines, *self.entries]) + "\n"


def polygons_of(shapes: Any) -> tuple[list[Any], list[str]]:
    """Polygons of a geometry or of several, and in words what is none; TypeError if something is no geometry."""
    base = load("shapely.geometry.base", "polygons")
    if not isinstance(shapes, (base.BaseGeometry, Iterable)):
        raise TypeError(f"expected geometries of shapely, got {shapes!r}")
    found: list[Any] = []
    dropped: list[str] = []
    for number, shape in enumerate([shapes] if isinstance(shapes, base.BaseGeometry) else shapes, 1):
        if not isinstance(shape, base.BaseGeometry):
            raise TypeError(f"expected a geometry of shapely, got {shape!r}")
        for part in getattr(shape, "geoms", [shape]):
            if part.geom_type == "Polygon" and part.area > 0.0:
                found.append(part)
            elif hasattr(part, "geoms"):
                inner, lost = polygons_of(part)
                found += inner
                dropped += lost
            else:
                dropped.append(f"geometry {number}, a {part.geom_type} without area")
    return found, dropped


def pieces_of(polygon: Any) -> list[Any]:
    """A polygon, or the pieces without holes that upright lines through the middle of each hole make of it."""
    if not polygon.interiors:
        return [polygon]
    load("shapely", "polygons")
    from shapely.geometry import LineString
    from shapely.ops import split

    low, high = polygon.bounds[1], polygon.bounds[3]
    reach = high - low
    middles = sorted(ring.envelope.centroid.x for ring in polygon.interiors)
    middle = middles[len(middles) // 2]  # halves are cut further
    line = LineString([(middle, low - reach), (middle, high + reach)])
    parts = (part.simplify(1e-9 * reach) for part in split(polygon, line).geoms)  # without corners that nearly meet
    return [piece for part in parts for piece in pieces_of(part)]


class _Materials:
    """Numbers of materials: pieces of a polygon with holes have one each, to bond them alone."""

    def __init__(self, last: int) -> None:
        self._last = last
        self.origin: dict[int, int] = {}  #: Material that a further number stands for
        self.bonds: list[tuple[int, int]] = []  #: Numbers of pieces of one polygon

    def of(self, shape: BlockShape) -> list[int]:
        """Numbers of the materials of the pieces of a polygon."""
        if len(shape.pieces) == 1 or shape.fixed:
            return [shape.material] * len(shape.pieces)
        numbers = list(range(self._last + 1, self._last + 1 + len(shape.pieces)))
        self._last = numbers[-1]
        self.origin.update(dict.fromkeys(numbers, shape.material))
        self.bonds += [(a, b) for a in numbers for b in numbers if a < b]
        return numbers

    def all_of(self, material: int) -> list[int]:
        """A material and all numbers that stand for it."""
        return [material, *(number for number, of in self.origin.items() if of == material)]


def _points(corners: Any) -> list[tuple[float, float]]:
    """Corners as pairs of floats; ValueError if they are none."""
    try:
        points = [(_number(x), _number(y)) for x, y in corners]
    except (TypeError, ValueError) as problem:
        text = " ".join(repr(corners).split())
        raise ValueError(f"expected corners as pairs of numbers, got {text[:60]}") from problem
    return points[:-1] if len(points) > 1 and points[0] == points[-1] else points


def _number(value: Any) -> float:
    """A number; ValueError if it is none."""
    if not isinstance(value, Real) or isinstance(value, bool):
        raise ValueError(f"expected a number, got {value!r}")
    return float(value)


def _flag(value: Any) -> bool:
    """A flag, NumPy's too; ValueError if it is none."""
    plain = value.item() if hasattr(value, "item") else value
    if not isinstance(plain, bool):
        raise ValueError(f"expected fixed as True or False, got {value!r}")
    return plain


def _whole(value: Any, least: int) -> int:
    """The number of a material; ValueError if it is none."""
    if not isinstance(value, Integral) or isinstance(value, bool) or value < least:
        raise ValueError(f"expected the number of a material, {least} or more, got {value!r}")
    return int(value)


def _words(given: dict[str, float], known: tuple[str, ...]) -> str:
    """Keys and values as an entry of the file of blocks writes them."""
    for name in given:
        if name not in known:
            raise ValueError(f"expected one of {', '.join(known)}, got '{name}'")
    return " ".join(f"{name} {_number(value)!r}" for name, value in given.items())
