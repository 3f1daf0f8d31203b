"""`voussoir assess`: one printable page that says whether an arch stands, with what safety, under which axle."""

from __future__ import annotations

import argparse
import hashlib
import platform
import re
from collections.abc import Sequence
from pathlib import Path

from voussoir import __version__
from voussoir.dda_program import DdaError, find_dda
from voussoir.deck.assessment import Assessment, assess
from voussoir.files import read_text, write_text

#: The file that a deck is computed from
_COPY = re.compile(rf"\S*voussoir-[^/\s]+/[^:\s]+(?=:\d)|\bdeck\.nml(?=:\d)")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Assesses an arch: verdict, geometric safety factor, load factor, worst position of its vehicle. Writes one "
        "HTML page with load cases, assumptions and meanings, for two sheets of A4. Several decks are compared on one "
        "page."
    )
    parser.add_argument("deck", metavar="DECK", type=Path, nargs="+", help="static decks of arches with one case each")
    parser.add_argument(
        "--out", metavar="FILE", type=Path,
        help="page to write (default: DECK with the ending .html; comparison.html for several decks)")


def run(arguments: argparse.Namespace) -> int:
    """Write the page."""
    from voussoir.plot.assess_page import comparison, single

    decks: list[Path] = arguments.deck
    several = len(decks) > 1
    out = arguments.out or (Path("comparison.html") if several else decks[0].with_suffix(".html"))
    found = []
    for deck in decks:
        arguments.deck = deck  # messages name the deck that they are about
        try:
            text = read_text(deck)
            check(text, deck)
            found.append(assess(text, deck))
        except DdaError as error:
            raise DdaError(_COPY.sub(str(deck).replace("\\", r"\\"), str(error))) from error
        except OSError as error:
            raise ValueError(f"expected a deck that can be read: {error.strerror}") from error
    origin = origin_of(decks, found)
    written = comparison(found, origin) if several else single(found[0], origin)
    try:
        write_text(out, written)
    except OSError as error:
        raise DdaError(f"{out}:1: error: expected a file that can be written: {error.strerror}", 4) from error
    print(out)
    return 0


def check(text: str, deck: Path) -> None:
    """Refuse decks of many cases and of other things than arches."""
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.split("!")[0].lower()
        if "&sweep" in bare:
            raise ValueError(f"{deck}:{number}: error: expected one case, got &sweep; remove it")
        if re.search(r"kind\s*=\s*['\"](lines|blocks)", bare):
            raise ValueError(f"{deck}:{number}: error: expected an arch, got another kind; assess a deck with &arch")


def origin_of(decks: Sequence[Path], found: Sequence[Assessment]) -> list[tuple[str, str]]:
    """Versions, check sums and methods."""
    methods = {
        "equilibrium of blocks with no tension that move and strain" if one.value("analysis%geometry") == "current" else
        "limit analysis and loading path of rigid blocks with no tension" for one in found}
    program = find_dda()
    rows = [("Deck", f"{deck.name}, SHA-256 {hashlib.sha256(deck.read_bytes()).hexdigest()}") for deck in decks]
    return rows + [
        ("Program", f"voussoir {__version__}, dda SHA-256 {hashlib.sha256(Path(program).read_bytes()).hexdigest()}"),
        ("Python", f"{platform.python_version()} on {platform.system()}"),
        ("Method", f"{'; '.join(sorted(methods))}; see docs/method.md"),
    ]
