"""The table of stiff and extreme scenes as CSV, Markdown and a page with colours."""

from __future__ import annotations

import csv
import html
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from voussoir.stability_judge import RIGHT, UNDECIDED, WRONG


@dataclass(frozen=True)
class Line:
    """One line of the table; all text."""

    group: str
    scene: str
    result: str
    wanted: str
    found: str
    error: str
    passes: str
    factorisations: str
    condition: str
    seconds: str
    guard: str
    reason: str


_STYLE = """body { font: 13px/1.35 sans-serif; margin: 2em; }
table { border-collapse: collapse; margin-bottom: 2em; }
th, td { padding: .15em .5em; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
td.guard, td.reason { min-width: 14em; } td.wanted, td.found, td.error { max-width: 20em; }
th { border-bottom: 2px solid #000; } td { border-bottom: 1px solid #ddd; }
td.right { background: #d9efd9; } td.undecided { background: #fbeebf; }
td.WRONG { background: #d1632a; color: #fff; font-weight: bold; }
h1.bad { color: #d1632a; }"""


def headline(lines: Sequence[Line]) -> str:
    """The count that matters, in one sentence.

    Parameters
    ----------
    lines : sequence of Line
        The table.

    Returns
    -------
    str
        How many are WRONG, undecided and right.
    """
    count = Counter(line.result for line in lines)
    share = 100.0 * count[UNDECIDED] / max(1, len(lines))
    return (
        f"{count[WRONG]} WRONG, {count[UNDECIDED]} undecided ({share:.1f} %), "
        f"{count[RIGHT]} right of {len(lines)} scenes"
    )


def write_csv(lines: Sequence[Line], file: Path) -> None:
    """Write the table as CSV.

    Parameters
    ----------
    lines : sequence of Line
        The table.
    file : Path
        Where.
    """
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, [field.name for field in fields(Line)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(line) for line in lines)


def write_markdown(lines: Sequence[Line], file: Path) -> None:
    """Write a summary by group, and every scene that is not right, as Markdown.

    Parameters
    ----------
    lines : sequence of Line
        The table.
    file : Path
        Where.
    """
    text = [f"# Stiff and extreme scenes\n\n**{headline(lines)}**\n"]
    text.append("| group | scenes | right | undecided | WRONG | largest error | longest [s] |")
    text.append("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for group in dict.fromkeys(line.group for line in lines):
        text.append(_summary(group, [line for line in lines if line.group == group]))
    text.append("\n| scene | result | wanted | found | error | reason |\n" + "| --- " * 6 + "|")
    text += [
        f"| {line.group}: {line.scene} | {line.result} | {line.wanted} | {line.found} "
        f"| {line.error} | {line.reason} |"
        for line in lines
        if line.result != RIGHT
    ]
    file.write_text("\n".join(text) + "\n", encoding="utf-8")


def _summary(group: str, lines: Sequence[Line]) -> str:
    """Row of one group."""
    count = Counter(line.result for line in lines)
    errors = [abs(float(line.error)) for line in lines if _is_number(line.error)]
    worst = f"{max(errors):.1e}" if errors else "-"
    longest = max(float(line.seconds or 0.0) for line in lines)
    return (
        f"| {group} | {len(lines)} | {count[RIGHT]} | {count[UNDECIDED]} | {count[WRONG]} "
        f"| {worst} | {longest:.2f} |"
    )


def _is_number(text: str) -> bool:
    """Whether a text is one number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def write_page(lines: Sequence[Line], file: Path) -> None:
    """Write a page: the groups, what is not right, then every scene; green, yellow and red.

    Parameters
    ----------
    lines : sequence of Line
        The table.
    file : Path
        Where.
    """
    bad = " class='bad'" if any(line.result == WRONG for line in lines) else ""
    doubtful = [line for line in lines if line.result != RIGHT]
    text = [
        "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'>",
        f"<title>Stiff and extreme scenes</title><style>{_STYLE}</style></head><body>",
        f"<h1{bad}>{html.escape(headline(lines))}</h1>",
        *_group_table(lines),
    ]
    if doubtful:
        text += ["<h2>What is not right, and why</h2>", *_scene_table(doubtful)]
    text += ["<h2>Every scene</h2>", *_scene_table(lines), "</body></html>"]
    file.write_text("\n".join(text) + "\n", encoding="utf-8")


def _group_table(lines: Sequence[Line]) -> list[str]:
    """Counts of each group; a count above zero has its colour."""
    results = (RIGHT, UNDECIDED, WRONG)
    head = "".join(f"<th>{name}</th>" for name in ("group", "scenes", *results))
    text = [f"<table><thead><tr>{head}</tr></thead><tbody>"]
    for group in dict.fromkeys(line.group for line in lines):
        count = Counter(line.result for line in lines if line.group == group)
        cells = "".join(
            f"<td class='number {result if count[result] else ''}'>{count[result]}</td>"
            for result in results
        )
        name = html.escape(group)
        text.append(f"<tr><td>{name}</td><td class='number'>{count.total()}</td>{cells}</tr>")
    return [*text, "</tbody></table>"]


def _scene_table(lines: Sequence[Line]) -> list[str]:
    """One row a scene."""
    names = [field.name for field in fields(Line)]
    head = "".join(f"<th>{name}</th>" for name in names)
    text = [f"<table><thead><tr>{head}</tr></thead><tbody>"]
    for line in lines:
        cells = "".join(
            f"<td class='{value if name == 'result' else _kind(name, value)}'>"
            f"{html.escape(value)}</td>"
            for name, value in asdict(line).items()
        )
        text.append(f"<tr>{cells}</tr>")
    return [*text, "</tbody></table>"]


def _kind(name: str, value: str) -> str:
    """Class of a cell."""
    return "number" if name not in ("wanted", "found") and _is_number(value) else name
