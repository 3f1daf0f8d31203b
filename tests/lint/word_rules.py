"""Words that messages and pages do not use, and what they say instead."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

#: A literal of Fortran, a comment, or what may join two literals: `//` and a continued line
_PIECE = re.compile(r""""(?:[^"]|"")*"|'(?:[^'\n]|'')*'|![^\n]*|(?:\s|&|//)+|[^"'!\s&/]+|.""")


@dataclass(frozen=True)
class Word:
    """A word or phrase, as a regular expression whose blanks are any blanks, and what to write instead."""

    old: str
    new: str
    messages_only: bool = False  #: Only messages are held to it: pages use the word well

    def places(self, text: str) -> Iterator[int]:
        """Where it begins in a text."""
        pattern = self.old.replace(" ", r"\s+")
        return (found.start() for found in re.finditer(pattern, text, re.IGNORECASE))


WORDS = (
    Word(r"\bwant(s|ed)\b", "expected X, got Y; KEY must be X; KEY needs Y; sought"),
    Word(r"\bwant\b", "need", messages_only=True),
    Word(r"\bexpects\b", "KEY must be X; KEY needs Y", messages_only=True),
    Word("\N{HORIZONTAL ELLIPSIS} expected\\b", "KEY must be X", messages_only=True),
    Word(r"\b(expected|must be|needs)\b[^.;|`\n]*\bfound\b", "got"),
    Word(r"\b(none|nothing) (was|were) found\b", "got none", messages_only=True),
    Word(r"\bparted (by|with)\b|\bparting\b", "separated by; separating axis"), Word(r"(?<!--)\banew\b", "again"),
    Word(r"\bfor ever\b", "indefinitely"), Word(r"\bleave\b[^.;,:|]{1,30}\baway\b", "remove; omit"),
    Word(r"\bsteps (are|were) spent\b|\bspent steps\b", "step limit reached"), Word(r"\bbut for\b", "except"),
    Word(r"\brising (number|order|angle|time)", "increasing; ascending"),
    Word(r"\btold\b|\btells?\b|\btelling\b", "reported; written; says; known by"),
    Word(r"\bled (points?|supports?|apart|along)\b|\b(is|are|or) led\b", "prescribed displacement"),
    Word(r"\bwithout settling\b|\bdo(es)? not settle\b|\bsettles? at no\b|\bnot settled\b", "converge"),
    Word(r"\bfeign(s|ed)?\b", "round-off"), Word(r"\bmoments? of momentum\b", "angular momentum"),
    Word(r"\bto and fro\b", "forward and backward"), Word(r"\bblows?\b", "impact"),
    Word(r"\bthin air\b", "across a gap"), Word(r"\bto the eye\b", "visually"),
    Word(r"\bha(s|ve) no say\b", "carries none"), Word(r"\byardsticks?\b", "reference"),
    Word(r"\bno one answer\b", "not unique"), Word(r"\brests? on nothing\b", "has no support"),
    Word(r"\bloads? (is|are) upright\b|\bupright loads?\b", "vertical"),
    Word(r"\bno stable system\b", "the stiffness matrix is singular"), Word(r"\btill\b", "until"),
    Word(r"\bbehind the (last|point|numbers|coordinates)\b", "after"), Word(r"\bglued\b", "locked; fully bonded"),
    Word(r"\balbums?\b", "frames"), Word(r"\bjams?\b", "lock"), Word(r"\bdrowns?\b|\bdrowned\b", "is below round-off"),
    Word(r"\bas any (other )?blocks\b|\bof any blocks that touch\b", "general"),
    Word(r"\bneither (rest|stands|standing)\b", "neither equilibrium; neither stable", messages_only=True),
    Word(r"\bfall(s|en)?\b(?! freely)", "collapse", messages_only=True),
    Word(r"\bthe original\b", "Shi's scheme; Shi's program", messages_only=True),
    Word(r"\bslid or parted\b", "slid or opened"))


def messages(source: str) -> Iterator[tuple[int, str]]:
    """Texts of a Fortran source with their lines; literals joined by `//` alone are one text."""
    text, begin, line = "", 0, 1
    for piece in (match[0] for match in _PIECE.finditer(source)):
        if piece[0] in "\"'":
            begin = begin or line
            text += piece[1:-1]
        elif begin and piece[0] not in "!&/ \n":
            text += "\N{HORIZONTAL ELLIPSIS}" if text[-1:] != "\N{HORIZONTAL ELLIPSIS}" else ""
        if begin and "\n" in piece and "&" not in piece:
            yield begin, text
            text, begin = "", 0
        line += piece.count("\n")


def texts(source: str) -> Iterator[tuple[int, str]]:
    """Texts of a Python source with their lines, docstrings left out; values of f-strings are an ellipsis."""
    tree = ast.parse(source)
    owners = (ast.Module, ast.ClassDef, ast.FunctionDef)
    first = (node.body[0] for node in ast.walk(tree) if isinstance(node, owners) and node.body)
    skipped = {id(line.value) for line in first if isinstance(line, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            skipped |= {id(part) for part in node.values}
            yield node.lineno, "".join(
                part.value if isinstance(part, ast.Constant) else "\N{HORIZONTAL ELLIPSIS}" for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in skipped:
            yield node.lineno, node.value


def offences_of_source(path: Path) -> list[str]:
    """What the literals of a Fortran source should say in other words: FILE:LINE: what, and what instead."""
    return [
        f"{path}:{line}: {_excerpt(text, place)}: write {word.new}"
        for line, text in messages(path.read_text(encoding="utf-8"))
        for word in WORDS
        for place in word.places(text)
    ]


def offences_of_page(path: Path) -> list[str]:
    """What a page should say in other words: FILE:LINE: what, and what instead."""
    text = path.read_text(encoding="utf-8")
    return [
        f"{path}:{text.count(chr(10), 0, place) + 1}: {_excerpt(text, place)}: write {word.new}"
        for word in WORDS
        if not word.messages_only
        for place in word.places(text)
    ]


def _excerpt(text: str, place: int) -> str:
    """What stands at a place of a text."""
    return repr(" ".join(text[max(place - 20, 0) : place + 40].split()))
