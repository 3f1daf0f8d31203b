"""Input that means nothing, or hardly anything: refused, warned of, or run all the same."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from voussoir.bench.stability_blocks import BASE, WEIGHT, normal_force
from voussoir.bench.stability_judge import Expectation, Measured, Refused, Verdict, Warned
from voussoir.bench.stability_scene import Scene, block_scene, rectangle, written_block
from voussoir.bench.validation_scene import GRAVITY, Check, verdict

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


def _blocks(name: str, text: str, expectation: Expectation, **groups: dict[str, Any]) -> Scene:
    """A scene of a doubtful file of blocks."""
    groups = {"material": {"unit_weight": WEIGHT}, **groups}
    return block_scene(_GROUP, name, _GUARD, text, expectation, **groups)


def _polygons() -> Iterator[Scene]:
    """Corners that make no block, or a doubtful one."""
    bow_tie = [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]
    yield _blocks("bow tie", BASE + written_block(bow_tie), Refused("edges 1 and 3 meet at"))
    turned = written_block(_SQUARE[::-1])
    yield _blocks("clockwise", BASE + turned, _STANDS)
    line = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]
    yield _blocks("zero area", BASE + written_block(line), Refused("block 2"))
    two = [(0.0, 0.0), (1.0, 0.0)]
    yield _blocks("two corners", BASE + written_block(two), Refused("block 2"))
    twice = [*_SQUARE[:2], _SQUARE[1], *_SQUARE[2:]]
    merged = Warned("corners given twice are merged", _STANDS)
    yield _blocks("a corner twice", BASE + written_block(twice), merged)
    yield _blocks("one corner four times", BASE + written_block([(0, 0)] * 4), Refused("block 2"))
    thin = written_block(rectangle(0.0, 0.0, 1.0, 1e-9))
    yield _blocks("sliver of 1e-9", BASE + thin, Refused("block 2"))
    short = [*_SQUARE[:2], (1.0, 1e-9), *_SQUARE[2:]]
    yield _blocks("an edge of 1e-9", BASE + written_block(short), merged)
    edge = [*_SQUARE[:2], (1.0, 1e-6), *_SQUARE[2:]]
    yield _blocks("an edge of 1e-6", BASE + written_block(edge), _STANDS)
    spike = [*_SQUARE, (-1.0, 1.0), (0.0, 1.0)]
    yield _blocks("a spike without width", BASE + written_block(spike), Refused("block 2"))


def _overlaps() -> Iterator[Scene]:
    """Blocks that share space."""
    for share in (0.1, 0.01, 1e-3):
        low = written_block(rectangle(0.0, -share, 1.0, 1.0))
        yield _blocks(f"blocks overlap by {share:g}", BASE + low, Refused("blocks 1 and 2 overlap"))
    low = written_block(rectangle(0.0, -1e-7, 1.0, 1.0))
    yield _blocks("blocks overlap by 1e-7", BASE + low, _STANDS)
    inside = written_block(rectangle(0.0, -0.8, 0.5, 0.5))
    yield _blocks("a block inside another", BASE + inside, Refused("block 2 lies inside block 1"))
    yield _blocks("the same block twice", BASE + _BLOCK + _BLOCK, Refused("block 3 lies inside block 2"))
    cross = written_block(rectangle(-0.5, 0.4, 2.0, 0.2))
    yield _blocks("a cross of two blocks", BASE + _BLOCK + cross, Refused("2 and 3"))


def _supports() -> Iterator[Scene]:
    """Blocks that nothing holds, or everything."""
    high = written_block(rectangle(0.0, 1.0, 1.0, 1.0))
    fall = Check("fall [m]", -GRAVITY / 2.0, lambda outcome: float(outcome.end(1)[1]), 1e-9)
    falls = Measured((verdict("completed", "verdict"), fall))
    free = _BLOCK + "measure 0.5 0.5\n"
    gap = written_block(rectangle(-10.0, -9.0, 20.0, 1.0), "fixed")
    yield _blocks("floating, static", BASE + high, Refused("block 2 has no support"))
    still = {"geometry": "current"}
    name = "floating, static, moving"
    yield _blocks(name, BASE + high, Refused("block 2 has no support"), analysis=still)
    for name, text in (("nothing fixed", free), ("floating", gap + free)):
        word = "nothing is fixed" if name == "nothing fixed" else "has no support"
        deck = {"analysis": {**_FALLS, "steps": 10000}, "material": {"density": 2240.0}}
        yield _blocks(f"{name}, dynamic", text, Warned(word, falls), **deck)
    yield _blocks("nothing fixed, static", _BLOCK + high, Refused("has no support"))
    fixed = Warned("fixed", Verdict("stable"))
    yield _blocks("all fixed", BASE + written_block(_SQUARE, "fixed"), fixed)
    yield _blocks("a held point outside", BASE + _BLOCK + "fix 5 5\n", Refused("lies in none"))
    led = "fix 0.5 0.5\ndisplacement 0.5 0.5 0.1 0\n"
    yield _blocks("a held point that is led", BASE + _BLOCK + led, Refused("prescribed points"))
    pinned = BASE + _BLOCK + "fix block 2 0 0\nfix block 2 1 0\n"
    yield _blocks("a block held twice", pinned, Verdict("stable"))
    up = {"gravity_direction_deg": 90.0}
    yield _blocks("no weight, static", BASE + _BLOCK, Refused("gravity"), **_weightless())
    yield _blocks("gravity up", BASE + _BLOCK, Verdict("collapsed"), load=up)
    yield _blocks("empty file", "", Refused("scene.blocks"))
    yield _blocks("no block", "material 2 density 1\n", Refused("block"))


def _weightless() -> dict[str, dict[str, Any]]:
    """Groups of a deck without gravity."""
    return {"load": {"gravity": 0.0}, "material": {"density": 2240.0}}


def _materials() -> Iterator[Scene]:
    """Densities, moduli and joints that no material has."""
    for words in (
        "density 0", "density -1", "density NaN", "density Inf", "young 0", "young -5e9", "young nan", "poisson 0.5",
        "poisson 0.7", "poisson -1", "unit_weight -1", "mass 3"):
        text = BASE + written_block(_SQUARE, "material 2") + f"material 2 {words}\n"
        yield _blocks(f"material {words}", text, Refused("scene.blocks:"))
    strain = {"material": {"poisson": 0.5, "plane": "strain"}}
    yield _blocks("poisson 0.5, plane strain", BASE + _BLOCK, Refused("poisson"), **strain)
    missing = BASE + written_block(_SQUARE, "material 7")
    yield _blocks("material not given", missing, Refused("material 7"))
    again = BASE + _BLOCK + "material 2 density 1\nmaterial 2 density 3\n"
    yield _blocks("material given twice", again, Refused("2"))
    for words in ("friction_deg -1", "friction_deg 91", "cohesion -1", "friction_deg x", "friction_deg"):
        text = BASE + _BLOCK + f"joint 1 1 {words}\n"
        yield _blocks(f"joint {words}", text, Refused("scene.blocks:"))
    small = [(x * 1e3, y * 1e3) for x, y in _SQUARE]
    base = written_block([(x * 1e3, y * 1e3) for x, y in rectangle(-1.0, -1.0, 3.0, 1.0)], "fixed")
    doubt = Warned("units", Verdict("stable"))
    yield _blocks("millimetres for metres", base + written_block(small), doubt)
    far = [(x * 0.1 + 1e7, y * 0.1) for x, y in _SQUARE]
    base = written_block([(1e7 - 1.0, -0.1), (1e7 + 1.0, -0.1), (1e7 + 1.0, 0.0), (1e7 - 1.0, 0.0)])
    base = base.replace("block", "block fixed", 1)
    spaced = Warned("digits", Verdict("stable"))
    yield _blocks("blocks of 0.1 m at 1e7 m", base + written_block(far), spaced)


def _written() -> Iterator[Scene]:
    """Decks that are written badly, or oddly."""
    arch = b"&arch voussoirs = 12, thickness_ratio = 0.15 /\n"

    def scene(name: str, deck: bytes, expectation: Expectation) -> Scene:
        return Scene(_GROUP, name, deck, expectation, _GUARD)

    line_ends = arch.replace(b", ", b",\r\n")
    for name, deck in (
        ("CRLF", line_ends),
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
