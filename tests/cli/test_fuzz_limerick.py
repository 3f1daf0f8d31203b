"""A short run of the fuzzer of Limerick files; the long one is a command of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path


def test_mutants_of_all_four_forms_are_read_or_refused(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, Path(__file__).with_name("fuzz_limerick.py"), "--dda", os.environ["DDA"],
         "--mutants", "800", "--seed", "7", "--keep", tmp_path],
        capture_output=True, text=True, check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert ", 0 failed" in done.stdout
