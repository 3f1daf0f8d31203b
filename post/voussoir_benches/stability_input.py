"""Input that means nothing, or hardly anything: refused, warned of, or run all the same."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from voussoir_benches.checks import GRAVITY, Check, verdict
from voussoir_benches.expectations import Expectation, Measured, Refused, Verdict, Warned
from voussoir_benches.scene import Corners, Scene, block_scene, rectangle, written_block, written_blocks
from voussoir_benches.stability_blocks import BASE, WEIGHT, normal_force

_SQUARE = rectangle(0.0, 0.0, 1.0, 1.0)
_BLOCK = written_block(_SQUARE)
_FALLS = {"mode": "dynamic", "geometry": "current", "time_step": 0.01, "duration": 1.0}
_STANDS = Measured((verdict("stable", "verdict"), Check("N [N/m]", WEIGHT, normal_force(1), 1e-6)))
#: Four lines that enclose a block, as a file of lines
_LINES = ("0 0 1 0 1", "1 0 1 1 1", "1 1 0 1 1", "0 1 0 0 1")
_GROUP = "bad input"
_GUARD = "input is checked before anything is computed"


def input_scenes() -> Iterator[Scene]:
    """All scenes of doubtful input."""
    yield from _polygons()
    yield from _overlaps()
    yield from _supports()
    yield from _materials()
    yield from _written()
    yield from _lines()


def _blocks(name: str, text: str, expectation: Expectation, **groups: Any) -> Scene:
    """A scene of a doubtful file of blocks."""
    groups = {"material": {"unit_weight": WEIGHT}, **groups}
    return block_scene(_GROUP, name, _GUARD, text, expectation, **groups)


def _polygons() -> Iterator[Scene]:
    """Corners that make no block, or a doubtful one."""
    merged = Warned("corners given twice are merged", _STANDS)
    for name, corners, answer in (
        ("bow tie", [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)], Refused("edges 1 and 3 meet at")),
        ("clockwise", _SQUARE[::-1], _STANDS),
        ("zero area", [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], Refused("block 2")),
        ("two corners", [(0.0, 0.0), (1.0, 0.0)], Refused("block 2")),
        ("a corner twice", [*_SQUARE[:2], _SQUARE[1], *_SQUARE[2:]], merged),
        ("one corner four times", [(0, 0)] * 4, Refused("block 2")),
        ("sliver of 1e-9", rectangle(0.0, 0.0, 1.0, 1e-9), Refused("block 2")),
        ("an edge of 1e-9", [*_SQUARE[:2], (1.0, 1e-9), *_SQUARE[2:]], merged),
        ("an edge of 1e-6", [*_SQUARE[:2], (1.0, 1e-6), *_SQUARE[2:]], _STANDS),
        ("a spike without width", [*_SQUARE, (-1.0, 1.0), (0.0, 1.0)], Refused("block 2")),
    ):
        yield _blocks(name, BASE + written_block(corners), answer)


def _overlaps() -> Iterator[Scene]:
    """Blocks that share space."""
    overlaps: tuple[tuple[str, Sequence[Corners], Expectation], ...] = (
        *((f"blocks overlap by {share:g}", [rectangle(0.0, -share, 1.0, 1.0)], Refused("blocks 1 and 2 overlap"))
          for share in (0.1, 0.01, 1e-3)),
        ("blocks overlap by 1e-7", [rectangle(0.0, -1e-7, 1.0, 1.0)], _STANDS),
        ("a block inside another", [rectangle(0.0, -0.8, 0.5, 0.5)], Refused("block 2 lies inside block 1")),
        ("the same block twice", [_SQUARE, _SQUARE], Refused("block 3 lies inside block 2")),
        ("a cross of two blocks", [_SQUARE, rectangle(-0.5, 0.4, 2.0, 0.2)], Refused("2 and 3")),
    )
    for name, shapes, answer in overlaps:
        yield _blocks(name, BASE + written_blocks(shapes), answer)


def _supports() -> Iterator[Scene]:
    """Blocks that nothing holds, or everything."""
    high = written_block(rectangle(0.0, 1.0, 1.0, 1.0))
    weightless = {"load": {"gravity": 0.0}, "material": {"density": 2240.0}}
    for name, text, answer, groups in (
        ("floating, static", BASE + high, Refused("block 2 has no support"), {}),
        ("floating, static, moving", BASE + high, Refused("block 2 has no support"),
         {"analysis": {"geometry": "current"}}),
        ("nothing fixed, static", _BLOCK + high, Refused("has no support"), {}),
        ("all fixed", BASE + written_block(_SQUARE, "fixed"), Warned("fixed", Verdict("stable")), {}),
        ("a restraint outside", BASE + _BLOCK + "fix 5 5\n", Refused("lies in none"), {}),
        ("a restraint with a prescribed displacement", BASE + _BLOCK + "fix 0.5 0.5\ndisplacement 0.5 0.5 0.1 0\n",
         Refused("prescribed points"), {}),
        ("a block held twice", BASE + _BLOCK + "fix block 2 0 0\nfix block 2 1 0\n", Verdict("stable"), {}),
        ("no weight, static", BASE + _BLOCK, Refused("gravity"), weightless),
        ("gravity up", BASE + _BLOCK, Verdict("collapsed"), {"load": {"gravity_direction_deg": 90.0}}),
        ("empty file", "", Refused("scene.blocks"), {}),
        ("no block", "material 2 density 1\n", Refused("block"), {}),
    ):
        yield _blocks(name, text, answer, **groups)
    fall = Check("fall [m]", -GRAVITY / 2.0, lambda outcome: float(outcome.end(1)[1]), 1e-9)
    falls = Measured((verdict("completed", "verdict"), fall))
    gap = written_block(rectangle(-10.0, -9.0, 20.0, 1.0), "fixed")
    deck = {"analysis": {**_FALLS, "steps": 10000}, "material": {"density": 2240.0}}
    for name, below, word in (("nothing fixed", "", "nothing is fixed"), ("floating", gap, "has no support")):
        yield _blocks(f"{name}, dynamic", below + _BLOCK + "measure 0.5 0.5\n", Warned(word, falls), **deck)


def _materials() -> Iterator[Scene]:
    """Densities, moduli and joints that no material has."""
    for words in (
        "density 0", "density -1", "density NaN", "density Inf", "young 0", "young -5e9", "young nan", "poisson 0.5",
        "poisson 0.7", "poisson -1", "unit_weight -1", "mass 3",
    ):
        text = BASE + written_block(_SQUARE, "material 2") + f"material 2 {words}\n"
        yield _blocks(f"material {words}", text, Refused("scene.blocks:"))
    strain = {"material": {"poisson": 0.5, "plane": "strain"}}
    yield _blocks("poisson 0.5, plane strain", BASE + _BLOCK, Refused("poisson"), **strain)
    yield _blocks("material not given", BASE + written_block(_SQUARE, "material 7"), Refused("material 7"))
    again = BASE + _BLOCK + "material 2 density 1\nmaterial 2 density 3\n"
    yield _blocks("material given twice", again, Refused("2"))
    for words in ("friction_deg -1", "friction_deg 91", "cohesion -1", "friction_deg x", "friction_deg"):
        yield _blocks(f"joint {words}", BASE + _BLOCK + f"joint 1 1 {words}\n", Refused("scene.blocks:"))
    for name, size, away, base, word in (
        ("millimetres for metres", 1e3, 0.0, (-1.0, -1.0, 3.0, 1.0), "units"),
        ("blocks of 0.1 m at 1e7 m", 0.1, 1e7, (-10.0, -1.0, 20.0, 1.0), "digits"),
    ):
        low, block = (
            [(x * size + away, y * size) for x, y in corners] for corners in (rectangle(*base), _SQUARE)
        )
        text = written_block(low, "fixed") + written_block(block)
        yield _blocks(name, text, Warned(word, Verdict("stable")))


def _written() -> Iterator[Scene]:
    """Decks that are written badly, or oddly."""
    arch = b"&arch voussoirs = 12, thickness_ratio = 0.15 /\n"

    def scene(name: str, deck: bytes, expectation: Expectation) -> Scene:
        return Scene(_GROUP, name, deck, expectation, _GUARD)

    for name, deck in (
        ("CRLF", arch.replace(b", ", b",\r\n")),
        ("byte order mark", b"\xef\xbb\xbf" + arch),
        ("a million blanks", arch.replace(b" /", b" " * 1000000 + b"/")),
        ("no end of line", arch.rstrip()),
        ("tabs", arch.replace(b" ", b"\t")),
        ("a comment in UTF-8", "! Gewölbe, α\n".encode() + arch),
    ):
        yield scene(name, deck, Verdict("stable"))
    for name, deck, word in (
        ("empty deck", b"", "deck.nml"),
        ("only blanks", b" " * 1000 + b"\n", "deck.nml"),
        ("comma decimal", b"&arch radius = 10,5 /\n", "radius"),
        ("unknown group", b"&arc voussoirs = 12 /\n", "arc"),
        ("unknown key", b"&arch vousoirs = 12 /\n", "voussoirs"),
        ("a key twice", b"&arch voussoirs = 12, voussoirs = 13 /\n", "voussoirs"),
        ("a group twice", arch + arch, "arch"),
        ("no end of a group", b"&arch voussoirs = 12\n", "deck.nml:1"),
        ("text between groups", b"arch\n" + arch, "deck.nml:1"),
        ("a negative count", b"&arch voussoirs = -12 /\n", "voussoirs"),
        ("a huge count", b"&arch voussoirs = 99999999999 /\n", "voussoirs"),
        ("a count with a point", b"&arch voussoirs = 12.5 /\n", "voussoirs"),
        ("no number", b"&arch radius = ten /\n", "radius"),
        ("no value", b"&arch radius = /\n", "radius"),
        ("an open quote", b"&material plane = 'stress /\n", "deck.nml:1"),
        ("an unknown word", b"&material plane = 'stretch' /\n", "plane"),
        ("bytes that are no text", bytes(range(256)), "deck.nml"),
        ("a sweep without values", arch + b"&sweep parameter = 'radius' /\n", "deck.nml:2"),
        ("a sweep of nothing", arch + b"&sweep parameter = 'colour', values = 1 /\n", "colour"),
        (
            "too many cases", arch + b"&sweep parameter = 'radius', first = 1, last = 2, count = 9999999 /\n",
            "max_cases"),
        ("no such file", b"&scene kind = 'blocks', geometry = 'none.blocks' /\n", "none.blocks"),
        ("a folder for a file", b"&scene kind = 'blocks', geometry = 'out' /\n", "out"),
        ("no file named", b"&scene kind = 'blocks' /\n", "geometry"),
    ):
        yield scene(name, deck, Refused(word))
    yield _blocks("no number in a file", BASE + _BLOCK.replace("1.0", "one"), Refused("blocks:8"))
    comma = BASE + _BLOCK.replace("1.0 0.0", "1,0 0,0")
    yield _blocks("comma decimal in a file", comma, Refused("scene.blocks:"))
    for word in ("NaN", "Inf", "1e999"):
        text = BASE + _BLOCK.replace("1.0", word, 1)
        yield _blocks(f"{word} in a file", text, Refused("scene.blocks:"))
    yield _blocks("unknown word in a file", BASE + "blok\n", Refused("blok"))
    odd = "\ufeff" + (BASE + _BLOCK).replace("\n", "\r\n").replace(" ", " \t ")
    yield _blocks("CRLF, tabs and a mark in a file", odd, _STANDS)


def _lines() -> Iterator[Scene]:
    """Lines that enclose blocks badly."""

    def scene(name: str, lines: tuple[str, ...], expectation: Expectation) -> Scene:
        held = "0.2 0.2 0.2 0.2\n0.8 0.2 0.8 0.2"
        head = f"0.01\n{len(lines)} 0\n0\n0\n2\n0\n0\n0\n"
        deck = {"scene": {"kind": "lines", "geometry": "lines.geo"}}
        text = head + "\n".join(lines) + "\n" + held + "\n"
        return Scene(_GROUP, name, deck, expectation, "trees and doubles are cut off", {"lines.geo": text})

    stands = Verdict("stable")
    dangling = ("0 0.5 0.7 0.5 1", "3 3 4 4 1")
    joint = "0 0.3 1 0.3 1"
    yield scene("a line that dangles", (*_LINES, joint, *dangling), stands)
    yield scene("a line twice", (*_LINES, joint, joint, *_LINES[:2]), stands)
    yield scene("lines that cross at 0.001 deg", (*_LINES, "-0.1 0.5 1.1 0.5 1", "-0.1 0.49999 1.1 0.50001 1"), stands)
    yield scene("lines that are not closed", _LINES[:3], Refused("enclose"))
    short = ("0 0 1 0 1", "1 0 1 0.9999 1", *_LINES[2:])
    yield scene("ends that miss by 1e-4", short, Refused("enclose"))
