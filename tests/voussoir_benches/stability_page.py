"""The table of stiff and extreme scenes as CSV, Markdown and a page with colours."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass, fields
from pathlib import Path

from voussoir.files import write_text
from voussoir.html_page import cell, document, escape, table
from voussoir_benches.expectations import RIGHT, UNDECIDED, WRONG
from voussoir_benches.report_tables import markdown, write_csv


@dataclass(frozen=True)
class Line:
    """One line of the table; all text."""

    group: str
    scene: str
    result: str
    expected: str
    found: str
    error: str
    passes: str
    factorisations: str
    condition: str
    seconds: str
    guard: str
    reason: str


_STYLE = """body { font: 14px/1.4 sans-serif; margin: 1em auto; max-width: 72em; padding: 0 1em; }
div.wide { overflow-x: auto; } table { border-collapse: collapse; margin-bottom: 1em; }
th, td { padding: .15em .6em; text-align: left; vertical-align: top; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
th { border-bottom: 2px solid #000; } td { border-bottom: 1px solid #ddd; }
td.right { background: #d9efd9; } td.undecided { background: #fbeebf; }
td.WRONG { background: #d1632a; color: #fff; font-weight: bold; }
h1 { font-size: 1.4em; } h1.bad { color: #d1632a; } summary { cursor: pointer; padding: .2em 0; }
@media print { details { display: none; } }"""
#: Columns of the table of scenes; those of the ones that are not right have the reason, too
_SHOWN = ("scene", "result", "expected", "found", "error", "seconds")


@dataclass(frozen=True)
class Kind:
    """Results of the scenes of one kind."""

    name: str  #: The kind
    count: Counter[str]  #: Scenes by their result
    worst: float | None  #: Largest relative error of those that are right; None where none is known
    median: float  #: Times of one scene [s]
    longest: float

    def cells(self) -> list[str]:
        """Its row."""
        total = self.count.total()
        undecided = self.count[UNDECIDED]
        return [
            self.name, str(total), "-" if self.worst is None else f"{self.worst:.0e}",
            f"{undecided} ({100.0 * undecided / total:.1f} %)" if undecided else "0", str(self.count[WRONG]),
            *(f"{1e3 * time:.3g}" if time < 1.0 else f"{1e3 * time:.0f}" for time in (self.median, self.longest))]


#: Heads of the table of kinds
_HEADS = ("kind", "scenes", "worst error", "undecided", "WRONG", "median time [ms]", "longest [ms]")


def kinds(lines: Sequence[Line]) -> list[Kind]:
    """Results of each kind of scene, all of them last, in the order of the table."""
    groups = {line.group: [other for other in lines if other.group == line.group] for line in lines}
    found = []
    for name, own in {**groups, "all": list(lines)}.items():
        errors = [abs(float(line.error)) for line in own if line.result == RIGHT and _is_number(line.error)]
        times = [float(line.seconds) for line in own if line.seconds] or [0.0]
        count = Counter(line.result for line in own)
        worst = max(errors, default=None)
        found.append(Kind(name, count, worst, statistics.median(times), max(times)))
    return found


def headline(lines: Sequence[Line]) -> str:
    """The count that matters, in one sentence: how many are WRONG, undecided and right."""
    count = Counter(line.result for line in lines)
    share = 100.0 * count[UNDECIDED] / max(1, len(lines))
    return (
        f"{count[WRONG]} WRONG, {count[UNDECIDED]} undecided ({share:.1f} %), "
        f"{count[RIGHT]} right of {len(lines)} scenes"
    )


def write_lines(lines: Sequence[Line], file: Path) -> None:
    """Write the table as CSV."""
    write_csv(file, [field.name for field in fields(Line)], map(astuple, lines))


def write_markdown(lines: Sequence[Line], file: Path) -> None:
    """Write a table by kind, and every scene that is not right, as Markdown."""
    odd = [
        [f"{line.group}: {line.scene}", line.result, line.expected, line.found, line.error, line.reason]
        for line in lines if line.result != RIGHT
    ]
    text = [
        f"# Stiff and extreme scenes\n\n**{headline(lines)}**\n",
        *markdown(_HEADS, "l" + "r" * (len(_HEADS) - 1), [kind.cells() for kind in kinds(lines)]), "",
        *markdown(("scene", "result", "expected", "found", "error", "reason"), "llllll", odd),
    ]
    write_text(file, "\n".join(text) + "\n")


def _is_number(text: str) -> bool:
    """Return true if a text is one number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def write_page(lines: Sequence[Line], file: Path) -> None:
    """Write a page: the kinds, what is not right, then every scene by kind, folded."""
    bad = " class='bad'" if any(line.result == WRONG for line in lines) else ""
    doubtful = [line for line in lines if line.result != RIGHT]
    text = [f"<h1{bad}>{escape(headline(lines))}</h1>", _kind_table(lines)]
    if doubtful:
        text += ["<h2>What is not right, and why</h2>"]
        text += [_scene_table(doubtful, ("group", "scene", "result", "found", "reason"))]
    text += ["<h2>Every scene, by kind</h2>"]
    for kind in kinds(lines)[:-1]:
        own = [line for line in lines if line.group == kind.name]
        text += [f"<details><summary>{escape(kind.name)}: {len(own)} scenes</summary>"]
        text += [_scene_table(own, _SHOWN), "</details>"]
    write_text(file, document("Stiff and extreme scenes", _STYLE, "\n".join(text)))


def _kind_table(lines: Sequence[Line]) -> str:
    """A row a kind; what is undecided or WRONG has its colour."""
    number = ["", *["number"] * (len(_HEADS) - 1)]
    rows = []
    for kind in kinds(lines):
        colour = {3: UNDECIDED if kind.count[UNDECIDED] else "", 4: WRONG if kind.count[WRONG] else ""}
        rows.append([cell(escape(word), f"{side} {colour.get(place, '')}".strip())
                     for place, (word, side) in enumerate(zip(kind.cells(), number))])
    heads = [cell(name, side, "th") for name, side in zip(_HEADS, number)]
    return f"<div class='wide'>{table(heads, rows)}</div>"


def _scene_table(lines: Sequence[Line], names: Sequence[str]) -> str:
    """One row a scene."""
    rows = [
        [cell(escape(row[name]), row[name] if name == "result" else _class(name, row[name])) for name in names]
        for row in map(asdict, lines)]
    return f"<div class='wide'>{table([cell(name, tag='th') for name in names], rows)}</div>"


def _class(name: str, value: str) -> str:
    """Class of a cell."""
    return "number" if name not in ("expected", "found") and _is_number(value) else name
