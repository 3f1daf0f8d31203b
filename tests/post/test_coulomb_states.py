"""The first collapse of rings that slide is no lower than a state that the programmes of HiGHS end at."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("scipy", reason="the linear programme wants scipy")

from bridges import rings  # noqa: E402
from dda_command import run_deck  # noqa: E402
from live_assemblies import held_state, random_assembly  # noqa: E402
from test_live_loads import friction_of, table  # noqa: E402

from voussoir.command.main import main  # noqa: E402
from voussoir.verify import command as verify_command  # noqa: E402
from voussoir.verify.deck import read_deck  # noqa: E402
from voussoir.verify.proofs import Scene  # noqa: E402

ROWS = [row for row in table("practice_multi_ring.csv") if row["P_over_weight_one_coulomb_state"]]
SHARES = {("0.12", "2", "0.6"): 0.15}  #: Slower than the others: half the way there and back for ever


def search(folder: Path, blocks: str, friction: str) -> tuple[dict[str, str], Scene]:
    """Row of the search of the first collapse, and the scene under a load factor of one."""
    (folder / "x.blocks").write_text(blocks)
    run_deck(
        folder, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&material unit_weight = 1.0 /\n"
        f"&joint friction_deg = {friction} /\n&search parameter = 'load_factor' /\n", "--quiet")
    assert main(["verify", str(folder / "x"), "--quiet"]) == 0
    tables = {name: verify_command.read_table(folder / "x" / f"{name}.csv") for name in ("results", "blocks")}
    (found,) = tables["results"][1]
    deck = read_deck(folder / "x").with_value("load_factor", "1")
    return found, verify_command.scene_of(deck, tables["blocks"][1], [folder], verify_command.Finding())


@pytest.mark.parametrize("row", ROWS, ids=lambda row: "-".join(list(row.values())[:5]))
def test_first_collapse_is_between_a_state_of_coulombs_law_and_the_associated_limit(
    tmp_path: Path, row: dict[str, str]
) -> None:
    """The states of the table are those of a repetition that was stopped: up to 6e-5 above where it ends."""
    key = (row["thickness_ratio"], row["rings"], row["friction_all_joints"])
    found, scene = search(tmp_path, rings(row), friction_of(key[2]))
    state = held_state(scene, SHARES.get(key, 0.8))
    # a collapse it is: forces in balance and within the law, and a motion that the loads drive
    assert state.power == pytest.approx(1.0, abs=1e-12)
    assert state.imbalance < 1e-12 and state.change < 1e-10 and state.beyond < 1e-10
    assert max(state.closing, state.opening, state.slip, state.uphill) < 1e-9
    assert state.factor <= float(row["P_over_weight_one_coulomb_state"]) * (1.0 + 1e-9)
    assert state.factor * (1.0 - 1e-9) <= float(found["critical"])
    assert float(found["critical"]) <= float(found["exact_high"])
    if key != ("0.12", "3", "0.6"):
        # the path of three rings ends at another state
        assert float(found["critical"]) == pytest.approx(state.factor, rel=1e-9)


def test_a_motion_that_a_small_share_of_the_load_drives_is_a_collapse(tmp_path: Path) -> None:
    """Damping of a path took half a percent of the load there, and the blocks seemed to rest up to 3 % more."""
    blocks, friction = random_assembly(62138)
    found, scene = search(tmp_path, blocks, repr(friction))
    state = held_state(scene, 1.0)
    assert state.change < 1e-6
    assert float(found["critical"]) == pytest.approx(state.factor, rel=1e-6)
    assert float(found["critical"]) < 0.97 * float(found["exact_high"])


def test_forces_at_the_end_of_a_path_balance_where_so_small_a_share_drives(tmp_path: Path) -> None:
    blocks, friction = random_assembly(62076)
    found, _ = search(tmp_path, blocks, repr(friction))
    assert float(found["critical"]) < float(found["exact_high"])
