"""Types are complete: mypy in its strict mode finds nothing."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[1]
POST = TESTS.parent / "post"


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
    names = [*(package.name for package in POST.iterdir()), "voussoir_benches"]
    packages = [word for name in names for word in ("-p", name)]
    places = {**os.environ, "MYPYPATH": f"{POST}{os.pathsep}{TESTS}"}
    done = subprocess.run([*words, *packages], cwd=POST, env=places, capture_output=True, text=True)
    assert [line for line in done.stdout.splitlines() if ": error: " in line] == []
