"""HTML pages that need no other file: the document, and tables of cells."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence


def escape(text: object) -> str:
    """A text as it stands in HTML."""
    return html.escape(str(text))


def document(title: str, style: str, body: str) -> str:
    """A page with a title in plain text, its style sheet and its body in HTML."""
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{style}</style></head>\n<body>{body}</body></html>\n")


def cell(content: str, kind: str = "", tag: str = "td") -> str:
    """A cell of a table from HTML, with a class if one is given."""
    return f"<{tag}{_class(kind)}>{content}</{tag}>"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "") -> str:
    """A table of cells, without a head where there are no cells for it."""
    lines = ["<tr>" + "".join(row) + "</tr>" for row in rows]
    top = f"<thead><tr>{''.join(head)}</tr></thead>" if head else ""
    return f"<table{_class(kind)}>{top}<tbody>{''.join(lines)}</tbody></table>"


def _class(kind: str) -> str:
    """Attribute of a class."""
    return f' class="{kind}"' if kind else ""
