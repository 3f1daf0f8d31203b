"""The first collapse of rings that slide is no lower than a state that the programmes of HiGHS end at."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("scipy", reason="the linear programme wants scipy")
pytest.importorskip("voussoir.verify.command", reason="PYTHONPATH wants python/")

from voussoir.verify import command as verify_command  # noqa: E402
from voussoir.verify.deck import read_record  # noqa: E402

sys.path.insert(0, str(Path(__file__).parents[1] / "cli"))

from bridges import rings  # noqa: E402
from live_assemblies import held_state  # noqa: E402
from test_live_loads import friction_of, table  # noqa: E402

ROWS = [row for row in table("practice_multi_ring.csv") if row["P_over_weight_one_coulomb_state"]]
#: Slower than the others: half the way there and back for ever
SHARES = {("0.12", "2", "0.6"): 0.15}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: "-".join(list(row.values())[:5]))
def test_first_collapse_is_between_a_state_of_coulombs_law_and_the_associated_limit(
    tmp_path: Path, row: dict[str, str]
) -> None:
    """The states of the table are those of a repetition that was stopped: up to 6e-5 above where it ends."""
    key = (row["thickness_ratio"], row["rings"], row["friction_all_joints"])
    (tmp_path / "x.blocks").write_text(rings(row))
    (tmp_path / "x.nml").write_text(
        "&scene kind = 'blocks', geometry = 'x.blocks' /\n&material unit_weight = 1.0 /\n"
        f"&joint friction_deg = {friction_of(key[2])} /\n&search parameter = 'load_factor' /\n"
    )
    subprocess.run([os.environ["DDA"], "run", "x.nml", "--quiet"], cwd=tmp_path, check=True)
    folder = tmp_path / "x"
    tables = {name: verify_command.read_table(folder / f"{name}.csv") for name in ("results", "blocks")}
    (found,) = tables["results"][1]
    deck = read_record(folder).with_value("load_factor", "1")
    scene = verify_command.scene_of(deck, tables["blocks"][1], [tmp_path], verify_command.Finding())
    state = held_state(scene, SHARES.get(key, 0.8))
    # a collapse it is: forces in balance and within the law, and a motion that the loads drive
    assert state.power == pytest.approx(1.0, abs=1e-12)
    assert state.imbalance < 1e-12 and state.change < 1e-10 and state.beyond < 1e-10
    assert max(state.closing, state.opening, state.slip, state.uphill) < 1e-9
    assert state.factor <= float(row["P_over_weight_one_coulomb_state"]) * (1.0 + 1e-9)
    assert state.factor * (1.0 - 1e-9) <= float(found["critical"])
    assert float(found["critical"]) <= float(found["exact_high"])
    if state.factor > 0.99999 * float(found["exact_high"]):
        assert float(found["critical"]) == pytest.approx(state.factor, rel=1e-9)
