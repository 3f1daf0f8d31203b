"""Words of comments, and beginnings of doc comments and subjects of commits."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

from word_rules import WORDS, Word

_CODE = re.compile(r"""(?:"[^"]*"|'[^']*'|[^"'!])*""")  #: Code before a comment of Fortran, with its strings
_COMMENT = re.compile(r"(!!|!>|!)(?: (.*))?$")  #: A comment; directives such as `!$omp` have no blank after the mark
#: A sentence of a comment that begins with a clause instead of a verb, a noun phrase or `True if`
CLAUSE = re.compile(r"(?:^|[.:] )(?:What|Whether|How|Which|Whose|By how much)\b")
#: Words that comments do not use, in addition to those that pages do not use
COMMENT_WORDS = (
    Word(r"\bknows?\b", "has; stores; reads"),
    Word(r"\bsa(?:ys?|id|ying)\b", "gives; contains; is"),
    Word(r"\bwants?\b", "needs; True to"),
    Word(r"\bhands? (?:over|out|on)\b|\bhanded\b", "move; return; pass"),
    Word(r"\blook(?:s|ed)? (?:at|around|for)\b", "check; find; use"),
    Word(r"\bparted\b|\bparting\b|\bparts? (?:them|two|convex|blocks)\b", "separate; split; open"),
    Word(r"\b(?:anew|lest)\b", "again; so that not"),
    Word(r"\bfe(?:els?|lt)\b", "acts on; carries"),
    Word(r"\bsee(?:n|s)? (?:from|of|near|where)\b|\bas .{1,20} sees? it\b", "relative to; rows of"),
    Word(r"\b(?:dis)?likes\b|\bas it likes\b", "any"),
    Word(r"\bspeaks? of\b", "refers to"),
    Word(r"\btak(?:e|es|en) (?:in|over|away)\b", "read; continue; remove"),
    Word(r"\bremember(?:s|ed)?\b|\bforg[eo]ts?\b", "store; keep; delete"),
    Word(r"\b(?:left|stays?) as (?:it|they) (?:is|was|are|were)\b", "unchanged"),
    Word(r"\b(?:will|would) do\b", "suffices; is valid"),
    Word(r"\blines? of heads\b", "piezometric line"),
    Word(r"\b(?:blocks?|move|search|run|end|step|begin|joints?)s? in time\b", "dynamic run"),
    Word(r"\bmeasured points?\b|\bheld points?\b", "monitoring point; restrained point"),
    Word(r"\bthe original(?:'s)?\b", "Shi's"),
    Word(r"\bchecks? sums?\b", "checksum"),
    Word(r"\b(?:row|line|point|result|text)s? a (?:block|case|row|step|joint|corner|sweep)\b", "per"),
    Word(r"\bthe (?:step|row|sweep) before\b", "previous"),
)

#: A doc comment of Fortran or a docstring that begins with a clause instead of a verb or a noun phrase
OPENING = re.compile(r"^\s*(?:!>|\"\"\")\s*(What|Whether|How|Which|That|Is|Has)\b")
SUBJECT = re.compile(r"^[a-z0-9_,/ -]+: ([a-z-]+) \S")  #: Subject of a commit: area, colon, verb
SUBJECT_LENGTH = 65
#: First words of a subject: what a change does. Other plain verbs join the list as they are needed
VERBS = frozenset("""
accept accumulate add adopt align allow apply assemble assert average avoid balance bound break build bump cache call
cap change check choose clamp clean clear clip close collect combine compare compile complete compress compute condense
convert copy count cover cut damp decide decouple defer define delete derive describe detect disable document draw
drive drop eliminate enable end ensure enter estimate evaluate exclude expect explain export expose extend extract
factor fail find fit fix flatten fold follow format free generate group guard halve handle head hide hold ignore
implement import improve include index infer initialise inline install integrate introduce invert join judge keep label
lead lengthen lift limit link list load lock lower make map mark match measure mention merge mesh mirror model mount
move name normalise note omit open order overwrite pack parse pass permit pin place plot port prefer prescribe preserve
prevent print project propagate prove publish quote raise reach read rebuild record recover redraw reduce refine refuse
reject relax release remove rename reorder repair replace report require reset resolve restart restore restrict retain
return reuse revert rewrite rotate round run sample save scale schedule search select separate set share shift shorten
show shrink simplify sketch skip snap solve sort split spread stabilise start state step stop store strengthen strip
structure substitute support suppress swap switch take terminate test thin tighten time title trace track translate
trim truncate try turn unify update use validate verify view warn weaken weigh widen wrap write
""".split())


def openings(folder: Path) -> Iterator[str]:
    """Doc comments below a folder that begin with a clause: FILE:LINE: the comment."""
    for file in sorted(folder.rglob("*")):
        if file.suffix in (".f90", ".inc", ".pf", ".py"):
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                if OPENING.match(line):
                    yield f"{file}:{number}: {line.strip()}"


def comments(source: str) -> Iterator[tuple[int, str]]:
    """Comments of a Fortran source with their first lines; the lines of a paragraph are one text.

    Parameters
    ----------
    source : str
        The source.

    Yields
    ------
    tuple of int and str
        Line of the beginning, and the text without marks.
    """
    text, begin, mark = "", 0, ""
    for number, line in enumerate(source.splitlines(), 1):
        code = _CODE.match(line)[0]
        found = _COMMENT.match(line[len(code):])
        words = (found[2] or "").strip() if found else ""
        if text and words and not code.strip() and found[1] == mark:
            text += f" {words}"
            continue
        if text:
            yield begin, text
        text, begin, mark = words, number, found[1] if found else ""
    if text:
        yield begin, text


def offences_of_comments(file: Path) -> list[str]:
    """Comments of a Fortran source that need other words: FILE:LINE: the place, and the words."""
    found = []
    for line, text in comments(file.read_text(encoding="utf-8")):
        if CLAUSE.search(text):
            found.append(f"{file}:{line}: {text[:60]!r}: begin with a verb, a noun phrase or `True if`")
        for word in (*COMMENT_WORDS, *WORDS):
            if not word.messages_only:
                found += [f"{file}:{line}: {text[max(0, place - 20):place + 40]!r}: write {word.new}"
                          for place in word.places(text)]
    return found


def offence_of_subject(subject: str) -> str:
    """Fault of the subject of a commit, empty if there is none."""
    found = SUBJECT.match(subject)
    if len(subject) > SUBJECT_LENGTH:
        return f"{subject!r}: {len(subject)} characters, at most {SUBJECT_LENGTH}"
    if not found:
        return f"{subject!r}: expected `area: verb object`"
    return "" if found[1] in VERBS else f"{subject!r}: {found[1]!r} is no verb of comment_rules.VERBS"


def newest_subjects(repository: Path, count: int) -> list[str]:
    """Subjects of the newest commits; none where there is no history."""
    words = ["git", "log", "--no-merges", f"-n{count}", "--format=%s"]
    done = subprocess.run(words, cwd=repository, capture_output=True, text=True, check=False)
    return done.stdout.splitlines() if done.returncode == 0 else []
