"""The house rules of the Fortran sources: what can be told from the text alone."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

#: Longest file, procedure and line
FILE_LINES, PROCEDURE_LINES, LINE_LENGTH = 400, 60, 100

_STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
_PROCEDURE = re.compile(r"(?!end\b)(?:[\w()=*:, ]+ )?(?:subroutine|function|module procedure) (\w+) *(?:\(|$)")
#: An argument of a derived type that is no array: the type says what it is
_IS_NAMED_TYPE = re.compile(r"(?:type|class)\(\w+\)[^:(]*(?:intent\(\w+\))[^:(]*:: *\w+(?: *, *\w+)*$")
_END_PROCEDURE = re.compile(r"end (?:subroutine|function|procedure)\b")
_TYPED = re.compile(r"(?:type|class) *\((\w+)\)")
_BLOCK = re.compile(r"(type\b(?! *\()|interface\b|abstract interface\b)")


@dataclass
class Statement:
    """A statement on one line, in small letters, without strings and comments."""

    text: str
    first: int  #: Its first and last line in the file, from 1
    last: int
    documented: bool  #: Whether a comment for FORD stands right before it, or behind it


def statements(lines: list[str]) -> Iterator[Statement]:
    """Statements of a file, continued lines joined."""
    text, first, documented, comment = "", 0, False, False
    for number, line in enumerate(lines, start=1):
        if line.lstrip().startswith("!"):
            # directives of OpenMP are no documentation, and no end of it
            comment = comment or line.lstrip().startswith("!>")
            continue
        code, _, behind = _STRING.sub("''", line).partition("!")
        code = code.strip().lower()
        if not code:
            comment = False
            continue
        if not text:
            first, documented = number, comment or behind.startswith("!")
        comment = False
        text = f"{text} {code.lstrip('&').strip()}".strip()
        if text.endswith("&"):
            text = text[:-1].strip()
            continue
        yield Statement(re.sub(r"\s+", " ", text), first, number, documented)
        text = ""


def offences(path: Path) -> list[str]:
    """List what a source breaks: FILE:LINE: rule."""
    lines = path.read_text(encoding="utf-8").splitlines()
    of_this = list(statements(lines))
    explained: set[tuple[str, str]] = set()
    for above in re.findall(r"\w+", of_this[0].text.split(")")[0])[1:] if of_this and of_this[
            0].text.startswith("submodule") else []:
        text = (path.parent / f"{above}.f90").read_text(encoding="utf-8").splitlines()
        explained |= _explained(list(statements(text)))
    found = list(_of_lines(lines)) + list(_of_statements(of_this, explained))
    return [f"{path}:{number}: {rule}" for number, rule in sorted(found)]


def _of_lines(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Rules of lines and of the whole file."""
    if len(lines) > FILE_LINES:
        yield len(lines), f"a file has at most {FILE_LINES} lines"
    for number, line in enumerate(lines, start=1):
        if len(line) > LINE_LENGTH:
            yield number, f"a line has at most {LINE_LENGTH} characters"
        if line != line.rstrip() or "\t" in line:
            yield number, "no tabs, no blanks at the end of a line"


def _explained(all_of_them: list[Statement]) -> set[tuple[str, str]]:
    """Arguments, by type and name, that a module explains: its submodules need not."""
    return {argument for this in all_of_them if this.documented and "intent(" in this.text.replace(
        " ", "") for argument in _arguments(this.text)}


def _of_statements(all_of_them: list[Statement], explained: set[tuple[str, str]]) -> Iterator[tuple[int, str]]:
    """Rules of statements, procedures and modules."""
    open_procedures: list[Statement] = []
    inner = 0  # lines of internal procedures, which are judged on their own
    block, contains = 0, False
    for this in all_of_them:
        text = this.text
        yield from ((this.first, rule) for rule in _of_one(text))
        if re.match(r"end (type|interface)\b", text):
            block -= 1
        elif _BLOCK.match(text):
            block += 1
            if not text.startswith(("interface", "abstract")) and not this.documented:
                yield this.first, "a type has its !> line"
        elif _END_PROCEDURE.match(text):
            if open_procedures:
                begin = open_procedures.pop()
                if this.last - (0 if open_procedures else inner) - begin.first >= PROCEDURE_LINES:
                    yield begin.first, f"a procedure has at most {PROCEDURE_LINES} lines"
                inner = inner + this.last - begin.first + 1 if open_procedures else 0
        elif _PROCEDURE.match(text) and not (block and text.startswith("module procedure")):
            if not this.documented:
                yield this.first, "a procedure has its !> line"
            open_procedures.append(this)
        elif "intent(" in text.replace(" ", "") and not _IS_NAMED_TYPE.match(text):
            if this.documented:
                explained.update(_arguments(text))
            elif not explained.issuperset(_arguments(text)):
                yield this.first, "an argument of an intrinsic type, or an array, has its !> line"
        elif text == "contains":
            contains = True
        elif not (block or contains or open_procedures) and _is_variable(text):
            if all_of_them[0].text.startswith("module"):
                yield this.first, "no module variables"
    texts = [this.text for this in all_of_them]
    if texts and texts[0].startswith(("module", "submodule", "program")) and "implicit none" not in texts:
        yield 1, "implicit none"
    if texts and texts[0].startswith("module") and not {"private", "enum, bind(c)"} & set(texts):
        yield 1, "a module is private, and names what is public"


def _arguments(text: str) -> Iterator[tuple[str, str]]:
    """Type and name, with its shape, of the arguments of a declaration."""
    kind, names = text.split("::", 1)
    kind = re.sub(r", *(intent *\(\w+\)|allocatable|optional|value)", "", kind).strip()
    yield from ((kind, name.replace(" ", "")) for name in re.findall(r"\w+(?:\([^)]*\))?", names))


def _of_one(text: str) -> Iterator[str]:
    """Rules of a single statement."""
    if re.search(r"\bgo ?to\b", text):
        yield "no goto"
    if re.match(r"[\w() =*,]+, *pointer\b.*::", text):
        yield "no pointers"
    if re.match(r"use\b", text) and not re.search(r"\bonly *:", text):
        yield "use names what it takes: only"
    if re.match(r"(common|equivalence|entry|data)\b[ /(]", text) and "::" not in text:
        if "=" not in text:
            yield "no common, equivalence, entry or data"


def _is_variable(text: str) -> bool:
    """Whether a statement declares something that can change."""
    declares = re.match(r"(integer|real|logical|complex|character|type *\(|class *\()", text)
    return bool(declares) and "::" in text and "parameter" not in text.split("::")[0]


@dataclass
class Part:
    """A component of a type."""

    name: str
    type: str  #: Name of its own type, empty for numbers and texts; of a type that is extended that type
    allocates: bool


def names_twice(paths: Collection[Path]) -> dict[str, list[str]]:
    """Public names that more than one module exports, with those modules."""
    exports: dict[str, list[str]] = {}
    for path in {path.stem: path for path in reversed(list(paths))}.values():
        text = re.sub(r"&\s*\n\s*&", "", path.read_text(encoding="utf-8"))
        for line in re.findall(r"^\s*public\s*::\s*([^!\n]*)", text, re.MULTILINE):
            for name in line.split(","):
                exports.setdefault(name.strip().lower(), []).append(path.stem)
    return {name: sorted(modules) for name, modules in exports.items() if len(modules) > 1}


def lost_memory(paths: Collection[Path]) -> list[str]:
    """Constructors of types with allocatable components that gfortran gets wrong.

    GCC 12 leaves components undefined that a structure constructor takes from strided sections, and
    loses the memory of elements that an array constructor copies.
    """
    texts = {path: list(statements(path.read_text().splitlines())) for path in paths}
    parts = _parts([one.text for text in texts.values() for one in text])
    owners = {name for name, own in parts.items() if any(part.allocates for part in own)}
    while grown := {name for name, own in parts.items() if name not in owners and any(
            part.type in owners for part in own)}:
        owners |= grown
    every = [part for own in parts.values() for part in own]
    lists = {part.name for part in every} - {part.name for part in every if part.type not in owners}
    found = []
    for path, text in texts.items():
        local = {name for one in text if (of := _TYPED.match(one.text)) and of[1] in owners
                 for name in re.findall(r"(\w+) *\(:", one.text)}
        for one in text:
            made = re.search(r"\b(\w+_t)\(.*\(.*:", _TYPED.sub("", one.text))
            longer = re.match(r"[\w%()]*?\b(\w+) *= *\[.*\b\1\b *,", one.text)
            if made and made[1] in owners:
                found.append(f"{path}:{one.first}: {made[1]}(...) of sections: assign its components")
            if longer and longer[1] in local | lists:
                found.append(f"{path}:{one.first}: {longer[1]} = [...] loses the memory of its items")
    return found


def _parts(texts: list[str]) -> dict[str, list[Part]]:
    """Components of each type by the type's name; types of the same name are taken together."""
    parts: dict[str, list[Part]] = {}
    name = ""
    for text in texts:
        begin = re.match(r"type(?:, *(?:extends *\((\w+)\)|abstract))* *:: *(\w+)$", text)
        if begin:
            name = begin[2]
            parts.setdefault(name, []).extend([Part("", begin[1], False)] if begin[1] else [])
        elif text.startswith("end type") or text == "contains":
            name = ""
        elif name and "::" in text:
            of = _TYPED.match(text)
            attributes, names = text.split("::", 1)
            parts[name] += [Part(one, of[1] if of else "", "allocatable" in attributes)
                            for one in re.findall(r"\b(\w+)\b(?=\(|,|$| =)", names)]
    return parts
