"""Materials of blocks and joints that were cut from lines, from the original program's two files."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from voussoir.files import read_text
from voussoir.verify.blocks import Law, Source
from voussoir.verify.contacts import Block, depth
from voussoir.verify.deck import Deck, VerifyError

#: Numbers of a line with its material, and of a block material and a joint material in the plain form
LINE, BLOCK, JOINT = 5, 13, 3
Rows = list[list[str]]


def read_lines(geometry: Path, analysis: Path, blocks: list[Block], deck: Deck) -> Source:
    """What files of lines and of materials say of the blocks that were cut; keys that the deck gives go before."""
    lines, crossing = _geometry(_text(geometry))
    materials, joints = _analysis(_text(analysis))
    source = Source(material=[1] * len(blocks))
    for row in crossing:
        ends = np.array([float(word) for word in row[:4]]).reshape(2, 2)
        crossed = [k for k, block in enumerate(blocks) if _crosses(block, ends)]
        for k in crossed or [max(range(len(blocks)), key=lambda k: depth(blocks[k], ends[0]))]:
            source.material[k] = int(row[4])
    for number, row in enumerate(materials, 1):
        if not deck.gives("material%density"):
            source.densities[number] = deck.read(row[0])
        if not any(deck.gives(key) for key in ("material%unit_weight", "material%density", "load%gravity")):
            source.weights[number] = deck.read(row[1])
    for row in lines:
        law = Law(*(deck.read(word) for word in joints[int(row[4]) - 1]))
        source.lines.append((np.array([float(word) for word in row[:4]]).reshape(2, 2), law))
    return source


def _text(path: Path) -> str:
    """A file of the original program."""
    try:
        return read_text(path)
    except OSError as error:
        raise VerifyError(f"cannot read {path}: name its folder by --decks") from error


def _words(text: str | None) -> list[str]:
    """Numbers of a text."""
    return re.findall(r"[-+.0-9eE]+", re.sub("[dD]", "e", text or ""))


def _parted(words: list[str], count: int, length: int) -> Rows:
    """So many records, taken off the beginning."""
    rows = [words[length * k: length * (k + 1)] for k in range(count)]
    del words[: count * length]
    return rows


def _geometry(text: str) -> tuple[Rows, Rows]:
    """Lines and material lines, each with the number of its material."""
    if text.lstrip().startswith("<"):
        root = ElementTree.fromstring(text)
        found = {name: [[*_words(item.text), item.get("type", "1")] for part in root.iter(name) for item in part]
                 for name in ("Boundlist", "Jointlist", "Matlinelist")}
        return found["Boundlist"] + found["Jointlist"], found["Matlinelist"]
    words = text.split()
    count, crossing = int(words[1]), int(words[3])
    words = _words(" ".join(words[9:]))
    return _parted(words, count, LINE), _parted(words, crossing, LINE)


def _analysis(text: str) -> tuple[Rows, Rows]:
    """Density and weight of blocks; friction angle, cohesion and strength of joints."""
    if text.lstrip().startswith("<"):
        root = ElementTree.fromstring(text)
        lists = []
        for name, parts in (("Blockmaterial", ("Unitmass", "Unitweight")),
                            ("Jointproperties", ("Friction", "Cohesion", "Tensile"))):
            items = sorted(root.iter(name), key=lambda item: int(item.get("type", "1")))
            lists.append([[_words(item.findtext(part))[0] for part in parts] for item in items])
        return lists[0], lists[1]
    words = _words(text)
    counts = int(words[2]), int(words[3])
    del words[:6]
    return _parted(words, counts[0], BLOCK), _parted(words, counts[1], JOINT)


def _crosses(block: Block, ends: np.ndarray) -> bool:
    """Whether a line crosses an edge of a block."""
    start = block.corners
    along, way = np.roll(start, -1, axis=0) - start, ends[1] - ends[0]
    away = ends[0] - start
    width = along[:, 0] * way[1] - along[:, 1] * way[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        on_edge = (away[:, 0] * way[1] - away[:, 1] * way[0]) / width
        on_line = (away[:, 0] * along[:, 1] - away[:, 1] * along[:, 0]) / width
    return bool(((on_edge >= 0) & (on_edge <= 1) & (on_line >= 0) & (on_line <= 1)).any())
