"""Imports of the Python packages have no cycle, and reading one module takes few others."""

from __future__ import annotations

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
ROOTS = (REPOSITORY / "post", REPOSITORY / "tests")  #: Folders of packages that import one another
LONGEST_CHAIN = 14  #: Most modules of a chain in which each imports the next


def imports(*roots: Path, packages: str = "**") -> dict[str, set[str]]:
    """Modules of each module of some packages, also those that only a function or a type needs."""
    files = {".".join(file.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): file
             for root in roots for file in root.glob(f"{packages}/*.py")}
    found: dict[str, set[str]] = {}
    for name, file in files.items():
        named: list[str] = []
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                named += [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                full = [f"{node.module}.{alias.name}" for alias in node.names]
                named += [word if word in files else str(node.module) for word in full]
        found[name] = (set(named) & files.keys()) - {name}
    return found


def longest_chain(graph: dict[str, set[str]]) -> list[str]:
    """The longest chain of imports; CycleError if they have a cycle."""
    chains: dict[str, list[str]] = {}
    for name in TopologicalSorter(graph).static_order():
        chains[name] = [name, *max((chains[other] for other in graph[name]), key=len, default=[])]
    return max(chains.values(), key=len)


def test_imports_have_no_cycle_and_short_chains() -> None:
    graph = imports(*ROOTS, packages="voussoir*/**")
    assert len(graph) > 100
    chain = longest_chain(graph)
    assert len(chain) <= LONGEST_CHAIN, " -> ".join(chain)


def test_a_cycle_through_a_function_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("import b\n")
    (tmp_path / "b.py").write_text("def work() -> None:\n    from c import thing\n")
    (tmp_path / "c.py").write_text("")
    assert longest_chain(imports(tmp_path)) == ["a", "b", "c"]
    (tmp_path / "c.py").write_text("from a import other\n")
    with pytest.raises(CycleError):
        longest_chain(imports(tmp_path))
