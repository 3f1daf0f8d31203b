"""docs/tables.md describes every column of the tables that `dda run` writes."""

from __future__ import annotations

import re
from pathlib import Path

from dda_command import run_dda

PAGE = (Path(__file__).resolve().parents[2] / "docs/tables.md").read_text(encoding="utf-8")
DECK = """&arch half_angle_deg = 60 /
&analysis mode = 'dynamic', geometry = 'current', duration = 0.02, time_step = 0.01 /
&output energy = .true., frames = 2, reactions = .true. /
"""
BLOCKS = """block fixed
-1 -1
2 -1
2 0
-1 0
block
0 0
1 0
1 1
0 1
measure 1 1
bar 0.5 0.5 0.5 -0.5 stiffness 1e6
"""


def tables(folder: Path) -> dict[str, list[str]]:
    """Columns of the tables of a folder."""
    return {file.name: file.read_text().partition("\n")[0].split(",") for file in folder.glob("*.csv")}


def section(name: str) -> str:
    """What the page says of a table: its own part, or its row among the other tables and proofs."""
    parts = re.split(r"^## ", PAGE, flags=re.M)
    own = [part for part in parts if part.startswith(f"{name}\n")]
    return own[0] if own else "".join(part for part in parts if part.startswith(("Proofs", "Other tables")))


def test_page_names_every_table_and_column(tmp_path: Path) -> None:
    (tmp_path / "arch.nml").write_text(DECK)
    (tmp_path / "wall.blocks").write_text(BLOCKS)
    (tmp_path / "wall.nml").write_text("&scene kind = 'blocks', geometry = 'wall.blocks' /\n")
    assert run_dda("run", "arch.nml", "wall.nml", "--out", "out", "--quiet", cwd=tmp_path).returncode == 0
    found = tables(tmp_path / "out/arch") | tables(tmp_path / "out/wall")
    assert {"results.csv", "joints.csv", "blocks.csv", "points.csv", "reactions.csv", "bars.csv", "energy.csv",
            "frames.csv", "frame_joints.csv", "proof_forces.csv"} <= found.keys()
    assert [name for name in found if name not in PAGE] == []
    assert [f"{name}: {column}" for name, columns in found.items() for column in columns
            if f"`{column}`" not in section(name)] == []
