"""The notebook of the docs: executed, and its numbers are those that its cells print today."""

from __future__ import annotations

import contextlib
import io
import json
import re
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")

NOTEBOOK = Path(__file__).resolve().parents[2] / "docs" / "notebook.ipynb"


def without_rounding(text: str) -> str:
    """Text without numbers that are rounding errors."""
    return re.sub(r"\de-\d\d", "ROUNDING", text)


def test_cells_print_what_stands_below_them_and_end_in_pictures() -> None:
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    names: dict = {}
    pictures = 0
    for cell in (cell for cell in cells if cell["cell_type"] == "code"):
        assert cell["execution_count"] and cell["outputs"], "the notebook is not executed"
        *statements, last = "".join(cell["source"]).split("\n")
        printed = io.StringIO()
        drawn = last.startswith(("run.plot", "wide.chart"))
        with contextlib.redirect_stdout(printed):
            exec("\n".join(statements if drawn else [*statements, last]), names)
        shown = "".join(text for output in cell["outputs"] for text in output.get("text", []))
        assert without_rounding(printed.getvalue()) == without_rounding(shown)
        if drawn:
            assert eval(last, names)._repr_png_() and "image/png" in cell["outputs"][-1]["data"]
            pictures += 1
    assert pictures == 2
