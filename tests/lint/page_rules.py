"""How pages are written: length of sentences and lines, phrases, digits, and files that exist."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from word_rules import WORDS, Word

REPOSITORY = Path(__file__).resolve().parents[2]
#: Largest mean and 90th percentile of the words per sentence of a page
MEAN_WORDS, LONG_WORDS = 20.0, 32
FRAGMENT = 4  #: Words of a list item or caption without a full stop that are no sentence yet
LINE_LENGTH = 120  #: Characters of a line of Markdown outside tables and code
DIGITS = 6  #: Significant digits of a number in prose

#: Phrases of pages that are not on the list of exceptions, and what to write instead
PHRASES = (
    Word(r"\blines? of thrust\b", "thrust line"),
    Word(r"\bline of heads\b", "piezometric line"),
    Word(r"\b(held|measured) points?\b", "restraint; monitoring point"),
    Word(r"\b(critical|greatest|least) push\b", "horizontal load factor at collapse"),
    Word(r"\bfells\b|\bto fell\b", "load at which it collapses"),
    Word(r"\binterior springs?\b", "barrier (interior-point) stiffness"),
    Word(r"\bblocks that (keep their places|move and deform)\b", "small; large displacements"),
    Word(r"\b(row|line|file|page|picture|panel|entry|test|folder|corner|column|piece|front|module) an? "
         r"(case|block|joint|step|deck|corner|figure|group|key|class|row|scene|task|member|page|procedure)\b", "per"),
    Word(r"\b(goes|go) before\b", "takes precedence"),
    Word(r"\btoday\b|\bnowadays\b|\bas before\b", "state what is"),
    Word(r"\bwhat (stands|falls|lies|follows|is left|rests|moves|remains|acts|counts)\b", "name the thing"),
    Word(r"\b(dda|voussoir|program|deck|page|log|table|message|verify|cut|check|search)`? "
         r"(says?|knows?|asks?|feels?|sees?|blames?|lets?)\b", "computes; reads; reports; prints"),
    Word(r"\blest\b|\bwhence\b|\bwhither\b|\bthereof\b|\bsave that\b|\bbe it\b|\blikewise\b", "plain words"),
    Word(r"\b(is|are) no matter\b|\bno matter (if|whether)\b", "acceptable; independent of"),
    Word(r"\bin vain\b|\bstray(s|ed)?\b|\bof old\b|\bfor want of\b|\bof one's own\b", "plain words"),
    Word(r"\bfor certain\b|\bwith nothing left over\b|\bat most may\b", "plain words"),
    Word(r"\bwhat (there )?is at once\b|\bhow it falls\b", "dead load; collapse mechanism"),
)
#: A sentence that has no subject but a clause
CLAUSE = re.compile(r"^(What|Whether|How much|How many|How far|How fast)\b")
DAY = re.compile(r"\b20\d\d-\d\d-\d\d\b")  #: A day: history belongs to the list of changes
#: Inline code that names a file of this repository
FILE = re.compile(r"`((?:src|tests|docs|input|cmake|post)/[\w./*{}-]+)`")
TEST = re.compile(r"`(test_\w+\.(?:py|pf))`")
NUMBER = re.compile(r"(?<![\w.,/-])\d[\d_ ]*\.?\d*(?:[eE][-+]?\d+)?")
#: Where a sentence ends: not after "e.g.", "Fig." and the like
END = re.compile(r"(?<!\be\.g)(?<!\bi\.e)(?<!\bcf)(?<!\bvs)(?<!\bFig)(?<!\bFigs)(?<!\bEq)(?<!\bNo)(?<!\bet al)"
                 r"[.!?]+[)\"'*_]*\s+(?=[A-Z0-9`*(\"'_$-])")


@dataclass(frozen=True)
class Sentence:
    """A sentence of a page: its line and its words, code and formulas as one word each."""

    line: int
    text: str

    @property
    def length(self) -> int:
        """Number of its words."""
        return sum(1 for word in self.text.split() if re.search(r"[^\W_]", word))


def without_code(text: str) -> str:
    """A page with the lines of code, comments and tables empty, so that lines keep their numbers."""
    def empty(match: re.Match) -> str:
        return "\n" * match[0].count("\n")

    text = re.sub(r"^([ ]*)```.*?^[ ]*```[ ]*$", empty, text, flags=re.M | re.S)
    return re.sub(r"<!--.*?-->", empty, text, flags=re.S)


def is_table(line: str) -> bool:
    """Whether a line is a row of a table."""
    return line.lstrip().startswith("|")


def plain(text: str) -> str:
    """Words as they are read: pictures gone, links their text, code and formulas one word each."""
    text = re.sub(r"\[?!\[[^\]]*\]\([^)]*\)(\]\([^)]*\))?", " ", text)
    text = re.sub(r"\$\$[^$]*\$\$|\$[^$\n]+(\n[^$\n]+)?\$", " formula ", text)
    text = re.sub(r"`[^`]*`", " code ", text)
    return re.sub(r"\[([^\]]*)\](\([^)]*\)|\[[^\]]*\])?", r"\1", text)


def paragraphs(text: str) -> Iterator[tuple[int, str]]:
    """Paragraphs and items of lists with their first lines; no headings, tables and code."""
    begin, words = 0, []
    for number, line in enumerate([*without_code(text).splitlines(), ""], 1):
        starts_item = re.match(r"\s*([-*+]|\d+\.)\s", line)
        if words and (not line.strip() or starts_item or is_table(line) or line.startswith("#")):
            yield begin, "\n".join(words)
            words = []
        if line.strip() and not is_table(line) and not line.startswith("#"):
            begin = begin if words else number
            words.append(re.sub(r"^\s*([-*+]|\d+\.)\s+|^\s*>\s*", "", line))


def sentences(text: str) -> Iterator[Sentence]:
    """Sentences of a page."""
    for line, words in paragraphs(text):
        at = 0
        readable = plain(words)
        for stop in [*(match.end() for match in END.finditer(readable)), len(readable)]:
            sentence = Sentence(line, " ".join(readable[at:stop].split()))
            at = stop
            if sentence.length > FRAGMENT or (sentence.length and sentence.text[-1] in ".!?"):
                yield sentence


def lengths(text: str) -> tuple[float, int]:
    """Mean and 90th percentile of the words per sentence."""
    words = sorted(sentence.length for sentence in sentences(text))
    if not words:
        return 0.0, 0
    return sum(words) / len(words), words[min(int(0.9 * len(words)), len(words) - 1)]


def digits_of(number: str) -> int:
    """Significant digits of a number as it is written."""
    mantissa = re.split("[eE]", number)[0]
    digits = re.sub(r"\D", "", mantissa).lstrip("0")
    return len(digits if "." in mantissa else digits.rstrip("0"))


def text_of(path: Path) -> str:
    """A page as Markdown; of a notebook its cells of words."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".ipynb":
        return text
    cells = [cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "markdown"]
    return "\n\n".join("".join(cell["source"]) for cell in cells)


def offences(path: Path) -> list[str]:
    """Everything about a page that breaks the rules: FILE:LINE: what, and what instead."""
    text = text_of(path)
    name = str(path.relative_to(REPOSITORY)) if path.is_relative_to(REPOSITORY) else path.name
    mean, long = lengths(text)
    found = []
    if mean > MEAN_WORDS or long > LONG_WORDS:
        found.append(f"{name}:1: {mean:.1f} words per sentence, {long} in the 90th percentile; "
                     f"at most {MEAN_WORDS:.0f} and {LONG_WORDS}: {_longest(text)}")
    for rule in (_long_lines, _tables, _phrases, _sentences, _numbers, _days, _files):
        found += [f"{name}:{line}: {words}" for line, words in rule(text, path)]
    return found


#: Terms that pages of the guide link to the glossary where they first use them
TERMS = (
    "associated flow", "bracket", "Coulomb flow", "critical value", "current geometry", "dead load",
    "factor of safety", "geometric safety factor", "hinge", "horizontal load factor", "live load", "load case",
    "load factor", "loading path", "mechanism", "monitoring point", "piezometric line", "reference geometry",
    "restraint", "thrust line", "verdict",
)


def unlinked_terms(text: str) -> list[str]:
    """Terms that a page uses in its words and links nowhere to the glossary."""
    words = plain(" ".join(paragraph for _, paragraph in paragraphs(re.sub(r"\[[^\]]*\]\([^)]*\)", " ", text))))
    words = re.sub(r"horizontal\s+load\s+factor", "horizontal_load factor", words)
    return [term for term in TERMS if f"glossary.md#{term.lower().replace(' ', '-')})" not in text and re.search(
        rf"\b{term.replace('horizontal ', 'horizontal_')}s?\b", " ".join(words.split()), re.IGNORECASE)]


def _longest(text: str) -> str:
    """Lines and lengths of the longest sentences."""
    longest = sorted(sentences(text), key=lambda sentence: -sentence.length)[:5]
    return ", ".join(f"line {sentence.line} ({sentence.length})" for sentence in longest)


def _long_lines(text: str, _path: Path) -> Iterator[tuple[int, str]]:
    """Lines that are too long: not those of tables and code, nor one long link."""
    for number, line in enumerate(without_code(text).splitlines(), 1):
        if len(line) > LINE_LENGTH and not is_table(line) and not re.match(r"\s*\S*\]\(\S+\)\S*$|\s*!?\[.*\)$", line):
            yield number, f"{len(line)} characters, at most {LINE_LENGTH}"


def _tables(text: str, _path: Path) -> Iterator[tuple[int, str]]:
    """Tables that no renderer shows as such: the line below their head has another number of cells."""
    lines = re.sub(r"`[^`\n]*`|\\\|", " ", without_code(text)).splitlines()
    for number, (head, rule) in enumerate(zip(lines, lines[1:]), 1):
        if is_table(head) and re.fullmatch(r"\s*\|[\s|:-]+\|\s*", rule) and head.count("|") != rule.count("|"):
            yield number, f"{head.count('|') - 1} cells over {rule.count('|') - 1} dashes: give as many of both"


def _phrases(text: str, _path: Path) -> Iterator[tuple[int, str]]:
    """Phrases that are replaced."""
    words = without_code(text)
    for word in (*WORDS, *PHRASES):
        pattern = word.old.replace(" ", r"[ \t]*[ \t\n][ \t]*")  # across lines, not paragraphs
        hits = re.finditer(pattern, words, re.IGNORECASE) if not word.messages_only else ()
        for place in (hit.start() for hit in hits):
            excerpt = " ".join(words[max(place - 20, 0) : place + 40].split())
            yield words.count("\n", 0, place) + 1, f"{excerpt!r}: write {word.new}"


def _sentences(text: str, _path: Path) -> Iterator[tuple[int, str]]:
    """Sentences whose subject is a clause."""
    for sentence in sentences(text):
        if CLAUSE.match(sentence.text) and "?" not in sentence.text and sentence.text.endswith("."):
            yield sentence.line, f"{sentence.text[:40]!r}: begin with the thing itself"


def _numbers(text: str, _path: Path) -> Iterator[tuple[int, str]]:
    """Numbers in prose of more digits than a reader needs."""
    for line, words in paragraphs(text):
        for number in NUMBER.findall(plain(re.sub(r"\bhttps?:\S+|\b10\.\d{4,}/\S+", "", words))):
            if digits_of(number) > DIGITS:
                yield line, f"{number}: at most {DIGITS} significant digits"


def _days(text: str, path: Path) -> Iterator[tuple[int, str]]:
    """Days, which belong to the list of changes."""
    if path.name != "CHANGELOG.md":
        for line, words in paragraphs(text):
            for day in DAY.findall(plain(words)):
                yield line, f"{day}: history belongs to CHANGELOG.md"


def _files(text: str, _path: Path) -> Iterator[tuple[int, str]]:
    """Files of the repository that do not exist."""
    for number, line in enumerate(without_code(text).splitlines(), 1):
        for name in FILE.findall(line):
            parts = re.match(r"(.*)\{([^}]*)\}(.*)$", name)
            names = [parts[1] + one + parts[3] for one in parts[2].split(",")] if parts else [name]
            for one in names:
                if not (list(REPOSITORY.glob(one)) if "*" in one else (REPOSITORY / one).exists()):
                    yield number, f"there is no {one}"
        for name in TEST.findall(line):
            if not list((REPOSITORY / "tests").rglob(name)):
                yield number, f"there is no {name}"
