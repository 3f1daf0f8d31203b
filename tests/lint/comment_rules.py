"""How doc comments and subjects of commits begin."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

#: A doc comment of Fortran or a docstring that begins with a clause instead of a verb or a noun phrase
OPENING = re.compile(r"^\s*(?:!>|\"\"\")\s*(What|Whether|How|Which|That|Is|Has)\b")
#: Subject of a commit: area, colon, verb
SUBJECT = re.compile(r"^[a-z0-9_,/ -]+: ([a-z-]+) \S")
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
