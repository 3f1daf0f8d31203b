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


_STYLE = """body { font: 14px/1.4 sans-serif; margin: 2em; }
table { border-collapse: collapse; } th, td { padding: .2em .6em; text-align: left; }
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
    """Write the table as a page: green for right, yellow for undecided, red for WRONG.

    Parameters
    ----------
    lines : sequence of Line
        The table.
    file : Path
        Where.
    """
    names = [field.name for field in fields(Line)]
    bad = " class='bad'" if any(line.result == WRONG for line in lines) else ""
    text = [
        "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'>",
        f"<title>Stiff and extreme scenes</title><style>{_STYLE}</style></head><body>",
        f"<h1{bad}>{html.escape(headline(lines))}</h1><table><thead><tr>",
        "".join(f"<th>{name}</th>" for name in names) + "</tr></thead><tbody>",
    ]
    for line in lines:
        cells = "".join(
            f"<td{f' class={value!r}' if name == 'result' else ''}>{html.escape(value)}</td>"
            for name, value in asdict(line).items()
        )
        text.append(f"<tr>{cells}</tr>")
    text.append("</tbody></table></body></html>")
    file.write_text("\n".join(text) + "\n", encoding="utf-8")
