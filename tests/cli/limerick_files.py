"""Files of the Limerick line that several tests use, and whether the program reads XML."""

from __future__ import annotations

import os
from pathlib import Path

from dda_command import run_dda

ROOT = Path(__file__).parents[2]
INPUT = ROOT / "input" / "limerick"  #: models of our own
#: the original's examples and arches at its limits, which are not part of the project
HELD = Path(os.environ.get("VOUSSOIR_SHARED", ROOT.parent / "shared")) / "data" / "limerick"
#: a square of 1 by 1, in the plain form
SQUARE = "0.01\n4 0\n0\n0\n0\n0\n0\n0\n0 0 1 0 1\n1 0 1 1 1\n1 1 0 1 1\n0 1 0 0 1\n"


def reads_xml() -> bool:
    """Tell whether the program was built with libxml2."""
    return "no libxml2" not in run_dda("cut", INPUT / "terrace_ddaml.geo").stderr


HAS_XML = reads_xml()
