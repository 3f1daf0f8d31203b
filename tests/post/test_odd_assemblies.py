"""Odd assemblies: decisions, limits and told forces that the checker proves and a linear programme repeats."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_deck
from live_assemblies import programme
from odd_assemblies import UNIT_WEIGHT, odd_assembly

from voussoir.command.main import main
from voussoir.verify import command as verify_command
from voussoir.verify.deck import read_deck

#: Assemblies of every kind: smooth, lifted by as much as they weigh, on one corner, held by what rounding leaves
SEEDS = [0, 3, 9, 15, 18, 34, 37, 38, 46, 77, 83, 95, 97, 110, 115, 123, 126, 128, 140, 150, 153]
MOST = 50.0  #: The largest factor that is looked for


def run(
    folder: Path, seed: int, flow: str, task: str, live: bool = True, friction: float | None = None
) -> dict[str, str]:
    """Row of results of a deck of an odd assembly, with its live loads or without; its proofs hold."""
    blocks, own = odd_assembly(seed)
    friction = own if friction is None else friction
    if not live:
        blocks = "".join(line for line in blocks.splitlines(keepends=True) if not line.startswith("live"))
    (folder / "x.blocks").write_text(blocks)
    run_deck(
        folder, "&scene kind = 'blocks', geometry = 'x.blocks' /\n&output joints = .true., blocks = .true. /\n"
        f"&material density = 2000, unit_weight = {UNIT_WEIGHT!r} /\n&joint friction_deg = {friction!r} /\n"
        f"&analysis flow = '{flow}' /\n{task} /\n", "--quiet")
    assert main(["verify", str(folder / "x"), "--quiet"]) == 0
    return rows_of(folder / "x" / "results.csv")[0]


@pytest.mark.parametrize("flow", ["associated", "coulomb"])
@pytest.mark.parametrize("seed", SEEDS)
def test_decisions_on_both_sides_of_a_limit_are_proven(tmp_path: Path, seed: int, flow: str) -> None:
    dead = run(tmp_path, seed, flow, "&load load_factor = 0")
    row = run(tmp_path, seed, flow, f"&search parameter = 'load_factor', low = 0, high = {MOST}")
    assert (row["verdict"] == "collapsed") == (dead["verdict"] == "collapsed")
    if flow == "associated":
        compare_with_programme(tmp_path, row)
    if row["verdict"] == "found":
        for share, verdict in ((0.97, "stable"), (1.03, "collapsed")):
            factor = share * float(row["critical"]) + (share - 1) * 1e-3
            assert run(tmp_path, seed, flow, f"&load load_factor = {max(factor, 0.0)!r}")["verdict"] == verdict


@pytest.mark.parametrize("flow", ["associated", "coulomb"])
@pytest.mark.parametrize(("seed", "verdict"), [(51032, "found"), (51273, "found"), (51340, "collapsed")])
def test_smooth_joints_without_two_proofs_of_a_limit_are_bracketed(
    tmp_path: Path, seed: int, verdict: str, flow: str
) -> None:
    """Smooth joints leave no forces inside their law: decisions bracket a limit of nothing, and one of 2.64."""
    row = run(tmp_path, seed, flow, f"&search parameter = 'load_factor', low = 0, high = {MOST}")
    assert row["verdict"] == verdict
    if verdict == "found":
        low, high, limit = float(row["critical_low"]), float(row["critical_high"]), programme_of(tmp_path)
        assert limit is not None and low - 1e-12 <= limit <= high
        assert high - low <= max(1e-10, 1e-6 * limit)


def programme_of(folder: Path) -> float | None:
    """The limit by a linear programme of the joints that the checker finds."""
    pytest.importorskip("scipy", reason="the linear programme wants scipy")
    tables = {name: verify_command.read_table(folder / "x" / f"{name}.csv") for name in verify_command.TABLES}
    deck = read_deck(folder / "x").with_value("load_factor", "1")
    return programme(verify_command.scene_of(deck, tables["blocks"][1], [folder], verify_command.Finding()))


def compare_with_programme(folder: Path, row: dict[str, str]) -> None:
    """The associated limit is that of a linear programme."""
    limit = programme_of(folder)
    if row["verdict"] == "found" and float(row["critical"]) > 0.0:
        assert limit == pytest.approx(float(row["critical"]), rel=1e-7, abs=1e-9)
    elif row["verdict"] == "stable":
        assert limit is None or limit > MOST


#: Seed, what is searched and from where to where: to the low side alone, to both, beyond the horizontal
SIDES = [
    (7, "horizontal_coefficient", -4, 0), (12, "horizontal_coefficient", -3, 3), (19, "horizontal_coefficient", -4, 0),
    (26, "horizontal_coefficient", -4, 0), (9, "gravity_direction_deg", -150, -30),
    (23, "gravity_direction_deg", -90, -10), (27, "gravity_direction_deg", -60, 60),
    (31, "gravity_direction_deg", -170, -90), (77, "gravity_direction_deg", 0, 80),
    (146, "gravity_direction_deg", 0, 80), (1004, "gravity_direction_deg", -60, 60),
]


@pytest.mark.parametrize("flow", ["associated", "coulomb"])
@pytest.mark.parametrize(("seed", "key", "low", "high"), SIDES)
def test_searches_to_either_side_agree_with_decisions(
    tmp_path: Path, seed: int, key: str, low: float, high: float, flow: str
) -> None:
    row = run(tmp_path, seed, flow, f"&search parameter = '{key}', low = {low}, high = {high}", live=False)
    if row["verdict"] == "found":
        critical, way = float(row["critical"]), 1 if row["collapses_at"] == "high" else -1
        off = way * 0.02 * abs(critical)
        asked = [(critical - off, "stable"), (critical + off, "collapsed")]
    else:
        asked = [(low, row["verdict"]), (high, row["verdict"])]
    for value, verdict in asked:
        assert run(tmp_path, seed, flow, f"&load {key} = {value!r}", live=False)["verdict"] == verdict


@pytest.mark.parametrize("friction", [1.0, 40.0, 85.0])
def test_what_floats_at_just_its_weight_stands_whatever_the_friction(tmp_path: Path, friction: float) -> None:
    """Pieces of a box, each lifted by as much as it weighs but for the last digit."""
    row = run(tmp_path, 9, "associated", "&load load_factor = 1", friction=friction)
    assert (row["verdict"], row["collapse_mode"]) == ("stable", "none")


@pytest.mark.parametrize("seed", [19, 24, 56, 395])
def test_blocks_that_jam_are_proven_by_forces_without_bound(tmp_path: Path, seed: int) -> None:
    search = "&search parameter = 'friction_deg', low = 1, high = 85"
    row = run(tmp_path, seed, "associated", f"&load load_factor = 1 /\n{search}")
    assert row["verdict"] == "found"
