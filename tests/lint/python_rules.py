"""The house rules of the Python sources: what can be told from the syntax tree alone."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

#: Longest line and function
LINE_LENGTH, FUNCTION_LINES = 120, 60

Function = ast.FunctionDef | ast.AsyncFunctionDef


def offences(path: Path, strict: bool) -> list[str]:
    """List what a source breaks: FILE:LINE: rule.

    With `strict`, as in the package, every function has type hints and every public one says what it does.
    """
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    found = list(_of_lines(text)) + list(_unused(tree, path)) + list(_traps(tree))
    if strict:
        found += _of_functions(tree)
    if not ast.get_docstring(tree):
        found.append((1, "a module says what it is for"))
    return [f"{path}:{number}: {rule}" for number, rule in sorted(found)]


def _of_lines(text: str) -> Iterator[tuple[int, str]]:
    """Rules of lines."""
    for number, line in enumerate(text.split("\n"), start=1):
        if len(line) > LINE_LENGTH:
            yield number, f"a line has at most {LINE_LENGTH} characters"
        if line != line.rstrip() or "\t" in line:
            yield number, "no tabs, no blanks at the end of a line"
    if text and not text.endswith("\n"):
        yield text.count("\n") + 1, "a file ends with a line end"


def _unused(tree: ast.Module, path: Path) -> Iterator[tuple[int, str]]:
    """Imports that nothing uses; __init__.py imports for others."""
    if path.name == "__init__.py":
        return
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    # annotations in quotes, and names that __all__ or a mark of pytest spells out
    words = {word for node in ast.walk(tree) if isinstance(node, ast.Constant)
             for word in str(node.value).replace(".", " ").split()}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            if isinstance(node, ast.ImportFrom) and node.module == "__future__":
                continue
            for alias in node.names:
                name = (alias.asname or alias.name).split(".")[0]
                if name not in names and name not in words:
                    yield node.lineno, f"{name} is imported and not used"


def _traps(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """What Python takes and nobody means."""
    known: set[str] = set()
    for node in tree.body:
        if isinstance(node, Function | ast.ClassDef):
            if node.name in known:
                yield node.lineno, f"a second {node.name} hides the first"
            known.add(node.name)
    for node in ast.walk(tree):
        if isinstance(node, ast.ExceptHandler) and node.type is None:
            yield node.lineno, "an except names what it catches"
        if isinstance(node, ast.ImportFrom) and any(name.name == "*" for name in node.names):
            yield node.lineno, "an import names what it takes"
        if isinstance(node, ast.Global):
            yield node.lineno, "no global variables"
        if isinstance(node, ast.Assert) and isinstance(node.test, ast.Tuple):
            yield node.lineno, "an assertion of a tuple always holds"
        if isinstance(node, Function):
            defaults = [*node.args.defaults, *node.args.kw_defaults]
            if any(isinstance(value, ast.List | ast.Dict | ast.Set) for value in defaults):
                yield node.lineno, "a default that can change is shared by all calls"


def _of_functions(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Rules of functions and classes of the package."""
    for node in ast.walk(tree):
        if isinstance(node, Function | ast.ClassDef) and not node.name.startswith("_"):
            if not ast.get_docstring(node) and node in _public(tree):
                yield node.lineno, f"{node.name} says what it does"
        if not isinstance(node, Function):
            continue
        body = node.body[bool(ast.get_docstring(node)) :] or node.body
        if (node.end_lineno or node.lineno) - body[0].lineno + 1 > FUNCTION_LINES:
            yield node.lineno, f"a function has at most {FUNCTION_LINES} lines below its docstring"
        if not node.name.startswith("_") and node in _public(tree):
            arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            bare = [item.arg for item in arguments if item.annotation is None and item.arg not in ("self", "cls")]
            if bare:
                yield node.lineno, f"{node.name} has no type of {', '.join(bare)}"


def _public(tree: ast.Module) -> list[ast.stmt]:
    """Functions and classes of the module, and methods of its public classes."""
    found: list[ast.stmt] = list(tree.body)
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            found += node.body
    return found
