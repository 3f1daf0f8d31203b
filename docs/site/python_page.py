"""The page of Python interfaces: signatures with types, tables of parameters, links between classes."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Modules of the names that scripts import: those of the package itself, or all of a module
PUBLIC = {
    "deck/run": ("run", "Deck", "Arch"), "deck/blocks": ("Blocks",), "results/__init__": (),
    "theory/__init__": ()}
HEAD = """# Python interfaces

Scripts `import voussoir`. [Python](howto_python.md) shows it at work. Types that this page describes are links.
"""
#: Sections of a docstring that become tables, and the head of their first column
SECTIONS = {"Parameters": "parameter", "Attributes": "attribute", "Returns": "returns", "Yields": "yields",
            "Raises": "raises"}


def python_page() -> str:
    """Public names of the Python package, with their docstrings, as Markdown."""
    lines = [HEAD]
    trees = {module: _tree(module) for module in PUBLIC}
    classes = {node.name for module, tree in trees.items() for node in _public(tree, PUBLIC[module])
               if isinstance(node, ast.ClassDef)}
    for module, tree in trees.items():
        home = "voussoir" if PUBLIC[module] else f"voussoir.{module.partition('/')[0]}"
        if not PUBLIC[module]:
            lines += [f"## {home}", "", "```text", ast.get_docstring(tree) or "", "```", ""]
        for node in _public(tree, PUBLIC[module]):
            lines += _interface(node, home, "##" if PUBLIC[module] else "###", classes)
    return "\n".join(lines)


def _tree(module: str) -> ast.Module:
    """Source of a module; fields of its classes have the words beside or above them as their `type_comment`."""
    text = (ROOT / f"post/voussoir/{module}.py").read_text(encoding="utf-8")
    tree, lines = ast.parse(text), text.splitlines()
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign):
            beside, above = lines[node.end_lineno - 1].partition("  #: ")[2], lines[node.lineno - 2].partition("#: ")
            node.type_comment = beside or ("" if above[0].strip() else above[2])
    return tree


def _public(tree: ast.Module, names: tuple[str, ...]) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Public functions and classes of a module, or those of the names."""
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_"):
            if not names or node.name in names:
                yield node


def _interface(node: ast.FunctionDef | ast.ClassDef, home: str, level: str, classes: set[str]) -> Iterator[str]:
    """A function, or a class and its public methods."""
    name = f"{home}.{node.name}"
    if isinstance(node, ast.ClassDef):
        yield f'<a id="{node.name}"></a>'
        yield ""
    yield f"{level} `{name}`"
    yield ""
    signature = _signature(node, name)
    if signature:
        yield f"```python\n{signature}\n```\n"
    yield from _described(ast.get_docstring(node) or "", classes)
    fields = [inner for inner in node.body if getattr(inner, "type_comment", "")]
    if fields:
        yield "| attribute | type | meaning |\n| --- | --- | --- |"
        for field in fields:
            kind = _linked(ast.unparse(field.annotation), classes)
            yield f"| `{field.target.id}` | {kind} | {_cell(field.type_comment)} |"
        yield ""
    for inner in node.body if isinstance(node, ast.ClassDef) else []:
        if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_") and not _decorated(inner, "setter"):
            yield from _interface(inner, node.name, level + "#", classes)


def _signature(node: ast.FunctionDef | ast.ClassDef, name: str) -> str:
    """How it is called, with types; empty of classes that are not called by scripts."""
    if isinstance(node, ast.ClassDef):
        made = [inner for inner in node.body if isinstance(inner, ast.FunctionDef) and inner.name == "__init__"]
        return _signature(made[0], name).partition(" ->")[0] if made else ""
    if _decorated(node, "property"):
        return f"{name}: {ast.unparse(node.returns)}" if node.returns else ""
    arguments = ast.unparse(node.args)
    arguments = re.sub(r"^(self|cls)(, )?", "", arguments)
    text = f"{name}({arguments})" + (f" -> {ast.unparse(node.returns)}" if node.returns else "")
    if len(text) <= 88:
        return text
    opening, _, rest = text.partition("(")
    inside, _, after = rest.rpartition(")")
    return f"{opening}(\n    " + ",\n    ".join(_arguments(inside)) + f"\n){after}"


def _decorated(node: ast.FunctionDef, word: str) -> bool:
    """Return True if a function has a decorator such as property, or x.setter."""
    return any(ast.unparse(decorator).rpartition(".")[2] == word for decorator in node.decorator_list)


def _arguments(text: str) -> list[str]:
    """Arguments of a signature, one by one."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def _described(docstring: str, classes: set[str]) -> Iterator[str]:
    """A docstring: its words, tables of its sections, its examples as code."""
    parts = re.split(r"^(\w+)\n-{3,}\n", inspect.cleandoc(docstring), flags=re.M)
    yield _words(parts[0])
    for title, body in zip(parts[1::2], parts[2::2]):
        if title in SECTIONS:
            yield f"| {SECTIONS[title]} | type | meaning |\n| --- | --- | --- |"
            for name, kind, meaning in _entries(body, title):
                yield f"| {name} | {_linked(kind, classes)} | {_cell(meaning)} |"
            yield ""
        else:
            yield f"```text\n{body.strip()}\n```\n"


def _entries(body: str, title: str) -> Iterator[tuple[str, str, str]]:
    """Name, type and meaning of each entry of a section."""
    for entry in re.split(r"\n(?=\S)", body.strip()):
        head, _, meaning = entry.partition("\n")
        name, colon, kind = head.partition(" : ")
        if title in ("Returns", "Yields", "Raises") and not colon:
            name, kind = "", head
        yield f"`{name}`" if name else "", kind, " ".join(meaning.split())


def _linked(kind: str, classes: set[str]) -> str:
    """A type, with links to the classes of this page."""
    text = re.sub(r"\w+", lambda word: f"[{word[0]}](#{word[0]})" if word[0] in classes else word[0], kind)
    return text.replace("|", "&#124;")


def _cell(text: str) -> str:
    """Words in a cell of a table."""
    return text.replace("|", "&#124;").replace("``", "`").replace("*", r"\*")


def _words(text: str) -> str:
    """Paragraphs of a docstring; lines that are indented are code."""
    return text.replace("``", "`").replace("**", r"\*\*").strip() + "\n"
