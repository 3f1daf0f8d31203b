"""Types are complete: mypy in its strict mode finds nothing."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

POST = Path(__file__).resolve().parents[2] / "post"


def has_typed_packages() -> bool:
    """Return true if mypy is there, and packages with stubs of their own: older ones leave types out."""
    if not all(importlib.util.find_spec(name) for name in ("mypy", "numpy", "matplotlib")):
        return False
    import matplotlib
    import numpy

    versions = [tuple(int(part) for part in module.__version__.split(".")[:2]) for module in (numpy, matplotlib)]
    return versions[0] >= (2, 2) and versions[1] >= (3, 8)


def test_types_are_complete() -> None:
    if not has_typed_packages():
        pytest.skip("mypy with numpy 2.2 and matplotlib 3.8 is not installed")
    words = [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir", "/dev/null"]
    packages = [word for package in POST.iterdir() for word in ("-p", package.name)]
    done = subprocess.run([*words, *packages], cwd=POST, capture_output=True, text=True)
    assert [line for line in done.stdout.splitlines() if ": error: " in line] == []
