"""The program under test, named by the environment variable DDA."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path


def run_dda(
    *arguments: str | Path, cwd: Path | None = None, timeout: float = 600.0
) -> subprocess.CompletedProcess[str]:
    """Run the program and return its status and what it printed."""
    return subprocess.run(
        [os.environ["DDA"], *map(str, arguments)], cwd=cwd, capture_output=True, text=True, timeout=timeout,
        check=False)
