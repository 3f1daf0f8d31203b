"""Single faults that a tired programmer might make, found line by line in Fortran sources.

A fault is one change of one line: a sign, an index that is off by one, another comparison, a term that is
left out, a constant that is ten times too large, a condition that is negated or not asked at all.
"""

from __future__ import annotations

import random
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator

#: Lines that compute nothing: comments, imports, declarations, headings, ends
IDLE = re.compile(
    r"\s*(!|use\b|implicit\b|private\b|public\b|module\b|submodule\b|contains\b|end\b|type\b|interface\b|"
    r"(pure |elemental |impure |recursive )*(real|integer|logical|character|complex|class|subroutine|function)\b|"
    r"procedure\b|else\s*$|return\b|exit\b|cycle\b|import\b|allocate\b|deallocate\b)")
CONSTANT = re.compile(r"\s*(real|integer)\b.*\bparameter\b.*::.*=")  #: Declarations of constants, whose values count
#: A real number with its kind; of the argument of an inquiry its kind alone counts
REAL = re.compile(r"(?<![\w.])(?<!tiny\()(?<!huge\()(?<!epsilon\()(\d+\.\d*(?:e[+-]?\d+)?)_wp")
COMPARISONS = {"<": ("<=", ">"), "<=": ("<", ">"), ">": (">=", "<"), ">=": (">", "<"), "==": ("/=",), "/=": ("==",)}


@dataclass(frozen=True)
class Fault:
    """One change of one line."""

    path: Path
    line: int
    kind: str
    before: str
    after: str


def closing(text: str, start: int) -> int:
    """Place of the bracket that closes the one at `start`, or -1."""
    depth = 0
    for i in range(start, len(text)):
        depth += (text[i] in "([") - (text[i] in ")]")
        if depth == 0:
            return i
    return -1


def without_texts(line: str) -> str:
    """The line with blanks for what stands in quotes, and without its comment."""
    line = re.sub(r"\"[^\"]*\"|'[^']*'", lambda m: " " * len(m.group()), line)
    return line.split("!", 1)[0].rstrip()


def swaps(code: str) -> Iterator[tuple[str, int, int, str]]:
    """Kind, start, end and replacement of all changes of signs, comparisons, words and numbers."""
    for m in re.finditer(r" ([+-]) ", code):
        yield "sign", m.start(1), m.end(1), "-" if m.group(1) == "+" else "+"
    for m in re.finditer(r"(?<=[=(,])( ?)-(?=[a-z(])", code):
        yield "sign", m.end() - 1, m.end(), ""
    for m in re.finditer(r" (<=|>=|==|/=|<|>) ", code):
        for other in COMPARISONS[m.group(1)]:
            yield "comparison", m.start(1), m.end(1), other
    for m in re.finditer(r"\.(and|or)\.", code):
        yield "condition", m.start(), m.end(), ".or." if m.group(1) == "and" else ".and."
    for m in re.finditer(r"\b(min|max|minval|maxval)\(", code):
        word = m.group(1)
        yield "extreme", m.start(1), m.end(1), ("max" if word.startswith("min") else "min") + word[3:]
    for m in REAL.finditer(code):
        if float(m.group(1)) != 0.0:
            yield "ten times", m.start(1), m.end(1), repr(10.0 * float(m.group(1)))
    for m in re.finditer(r"[+-] 1(?![\w.])", code):
        yield "off by one", m.start(), m.end(), m.group()[:-1] + "2"
    for m in re.finditer(r"\bdo \w+ = 1(?=,)", code):
        yield "off by one", m.end() - 1, m.end(), "2"


def dropped_terms(code: str) -> Iterator[tuple[str, int, int, str]]:
    """The same for terms that are added or taken off, or factors, where they end on the line."""
    for m in re.finditer(r" [+-] |(?<=[\w)])[*/](?=[\w(])", code):
        i = m.end()
        while i < len(code) and (code[i].isalnum() or code[i] in "_%.(["):
            i = closing(code, i) + 1 if code[i] in "([" else i + 1
            if i == 0:
                break
        else:
            rest = code[i:i + 1]
            if i > m.end() and rest in ("", ")", ",", " ") and "&" not in code[i:]:
                yield "dropped", m.start(), i, ""


def conditions(code: str, line: str) -> Iterator[tuple[str, int, int, str]]:
    """The same for conditions, negated or not asked."""
    m = re.match(r"\s*(?:else )?if \(", code)
    if not m:
        return
    end = closing(code, m.end() - 1)
    if end < 0:
        return
    yield "negated", m.end(), end, f".not. ({line[m.end():end]})"
    behind = code[end + 1:].strip()
    if behind and behind != "then" and "&" not in behind:
        yield "skipped", len(code) - len(code.lstrip()), 9999, "continue"


def faults_of(path: Path, root: Path) -> list[Fault]:
    """All faults that one file may have."""
    found = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        code = without_texts(line)
        is_constant = CONSTANT.match(code) is not None
        if not code or (IDLE.match(code) and not is_constant) or "error(" in code:
            continue
        changes = list(swaps(code))
        if is_constant:
            changes = [change for change in changes if change[0] == "ten times"]
        else:
            changes += [*dropped_terms(code), *conditions(code, line)]
        for kind, start, end, other in changes:
            after = line[:start] + other + line[end:]
            if len(after) <= 132:
                found.append(Fault(path.relative_to(root), number, kind, line, after))
    return found


def draw_faults(root: Path, packages: list[str], count: int, seed: int) -> list[Fault]:
    """As many faults, every package and in it every kind in turn, for the same seed the same."""
    chance = random.Random(seed)
    drawn: list[Fault] = []
    by_package = {}
    for package in packages:
        kinds: dict[str, list[Fault]] = {}
        for path in sorted((root / "src" / package).glob("*.f90")):
            for fault in faults_of(path, root):
                kinds.setdefault(fault.kind, []).append(fault)
        for faults in kinds.values():
            chance.shuffle(faults)
        names = sorted(kinds)
        chance.shuffle(names)
        by_package[package] = [kinds[name] for name in names]
    while len(drawn) < count and any(by_package.values()):
        for package in packages:
            if by_package[package] and len(drawn) < count:
                faults = by_package[package].pop(0)
                drawn.append(faults.pop())
                if faults:
                    by_package[package].append(faults)
    return drawn
