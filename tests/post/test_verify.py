"""`voussoir verify`: proofs that hold are accepted, and a number that is changed anywhere is found."""

from __future__ import annotations

import csv
import random
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda, run_deck
from live_assemblies import programme, random_assembly
from random_bridges import random_study

from voussoir.verify import command as verify_command
from voussoir.command.main import main
from voussoir.verify.deck import read_deck

HEAD = "&scene kind = 'blocks', geometry = 'x.blocks' /\n"
SEARCH = "&search parameter = 'load_factor' /\n"
#: Numbers that are changed: a table and its columns
CHANGED = [
    ("proof_forces", ("normal_1", "normal_2", "shear")),
    ("proof_motion", ("u", "v", "spin")),
    ("joints", ("normal_force", "shear_force", "force_x", "force_y")),
    ("blocks", ("x", "y")),
    ("blocks", ("u", "v")),
]
BLOCKS = "block fixed\n-5 -1\n5 -1\n5 0\n-5 0\nblock\n0 0\n1 0\n1 2\n0 2\n"
#: An arch below fill, a lune, a tied arch on buttresses; a dam, blocks on bolts to the ground and to one another
FILLED = (
    "&arch shape = 'segmental', span = 6.55, rise = 1.428, thickness = 0.22, voussoirs = 14 /\n"
    "&joint friction_deg = 31 /\n&vehicle axles = 1000, position = -1.6 /\n"
    "&fill height = 0.165, unit_weight = 20e3, {} /\n"
)
CRUSHED = (
    "&arch shape = 'segmental', span = 10, rise = 2.5, thickness = 0.6, voussoirs = 16 /\n"
    "&material unit_weight = 2e4, compressive_strength = {} /\n&joint friction_deg = 38 /\n"
    "&vehicle axles = 1000, position = -2.4 /\n&analysis flow = 'associated' /\n"
)
FLAT = ("&arch shape = 'flat', half_angle_deg = 20, span = 3, thickness = 0.6, voussoirs = 5 /\n"
        "&joint friction_deg = 30 /\n{}&search parameter = 'horizontal_coefficient', low = 0, high = {} /\n")
LUNE = "&arch shape = 'circular', thickness_ratio = {}, lune_deg = 10, voussoirs = 21 /\n"
TIED = (
    "&arch shape = 'circular', radius = 1, thickness = 0.15, voussoirs = 12, buttress_width = 0.2, "
    "buttress_height = 1.0 /\n&tie x1 = -0.925, y1 = -0.1, x2 = 0.925, y2 = -0.1, ea = 1e6, strength = {} /\n"
)
DAM = ("block fixed\n-20 -5\n40 -5\n40 0\n-20 0\nblock\n0 0\n16 0\n12 8\n0 30\n"
       "water -10 24 0 24 5 20 16 0 factor {}\n0 0\n1 6\n")
BOLTED = ("block fixed\n-5 -1\n5 -1\n5 0\n-5 0\nblock\n0 0\n1 0\n1 1\n0 1\nblock\n0.2 1\n1 1\n1 2\n0.2 2\n"
          "bar 0.5 1.5 -2 -0.5 stiffness 1e8 {0}\nbar 0.5 0.5 0.6 1.4 ea 1e8 {0}\nbar 0.8 1.2 9 9 stiffness 1e7 {0}\n")
PILLARS = ("block fixed\n-5 -1\n9 -1\n9 0\n-5 0\n" + "".join(
    f"block\n{x} 0\n{x + 1} 0\n{x + 1} 1\n{x} 1\n" for x in (0, 1.5, 3, 5)) + "block\n0 1\n6 1\n6 2\n0 2\n")
#: Decks that leave proofs of every kind
DECKS = {
    "arch": "&arch thickness_ratio = 0.12 /\n",
    "thickness": "&search /\n&arch voussoirs = 12 /\n",
    "listed joints": "&arch joints_deg = 0, 30, 54.5, 90, facet_deg = 5, thickness_ratio = 0.2 /\n",
    "tilt": "&search parameter = 'gravity_direction_deg', low = -90, high = -45 /\n&arch half_angle_deg = 75 /\n",
    "tilt of an arch in fill": "&arch shape = 'segmental', span = 8.4, voussoirs = 7, rise = 3, right_rise = 3.3, "
        "thickness = 0.46 /\n&joint friction_deg = 21 /\n&fill height = 0.2, unit_weight = 18e3 /\n"
        "&search parameter = 'gravity_direction_deg', low = -90, high = -50 /\n",
    "sweeps": "&sweep parameter = 'friction_deg', values = 20, 40 /\n&search parameter = 'horizontal_coefficient' /\n"
              "&sweep parameter = 'half_angle_deg', values = 60, 70 /\n"
              "&sweep parameter = 'voussoirs', values = 11, 12, linked = .true. /\n",
    "no slip at springings": "&arch half_angle_deg = 70, springing = 'no-slip' /\n&joint friction_deg = 30 /\n"
                             "&load horizontal_coefficient = 0.1 /\n",
    "vehicle": "&arch half_angle_deg = 60, voussoirs = 15 /\n&search parameter = 'load_factor' /\n"
               "&vehicle axles = 2e4, 1e4, spacings = 1.5, worst = .true. /\n",
    "an axle": "&arch half_angle_deg = 60, voussoirs = 15 /\n&vehicle axles = 2e4, length = 0, position = 2.0 /\n",
    "live": HEAD + "&load load_factor = 3.0 /\n",
    "falls": HEAD + "&load load_factor = 30.0, horizontal_coefficient = 0.05 /\n",
    "fill": FILLED.format("passive_coefficient = 1.3") + SEARCH,
    "fill and backing": FILLED.format("friction_deg = 35, passive_share = 0.5, backing_height = 0.7")
                        + "&load load_factor = 20 /\n",
    "spans in fill": FILLED.format("passive_coefficient = 1").replace(
        "&arch", "&arch spans = 2, pier_width = 1, pier_height = 2, ") + SEARCH,
    "too much on fill": FILLED.format("passive_coefficient = 1") + "&load load_factor = 80 /\n",
    "rings and a rise on one side": "&arch shape = 'elliptic', span = 5, rise = 2, right_rise = 1.4, thickness = 0.5, "
        "rings = 2, voussoirs = 13 /\n&fill height = 0.2, unit_weight = 18e3, passive_coefficient = 0.6 /\n"
        "&vehicle axles = 3e4, 2e4, spacings = 1.1, worst = .true. /\n" + SEARCH,
    "an axle on the crown of a pointed arch in fill": "&arch shape = 'pointed', span = 4.767, voussoirs = 6, "
        "rise = 2.77, thickness = 0.2226 /\n&joint friction_deg = 48.4 /\n"
        "&fill height = 0.165, unit_weight = 21e3, passive_coefficient = 1.4 /\n"
        "&vehicle axles = 5e4, length = 0, position = 0 /\n" + SEARCH,
    "an axle on a joint of a level arch in fill": "&arch shape = 'flat', span = 10, voussoirs = 22, "
        "half_angle_deg = 30, thickness = 1.1 /\n&fill height = 0.1, unit_weight = 18e3, passive_coefficient = 2 /\n"
        "&vehicle axles = 2e4, 3e4, spacings = 1.2, position = 0 /\n" + SEARCH,
    "extrados and intrados that are highest at two places": "&arch shape = 'elliptic', span = 4, rise = 1.07, "
        "right_rise = 1.2, crown_thickness = 0.44, springing_thickness = 0.75, voussoirs = 30 /\n"
        "&fill height = 0.03, unit_weight = 18e3, passive_coefficient = 1.4 /\n"
        "&vehicle axles = 2e4, 3e4, spacings = 1.2, position = 1.1 /\n" + SEARCH,
    "a springing in a notch of its pier": "&arch shape = 'parabolic', span = 9.2, rise = 4.2, right_rise = 3.4, "
        "thickness = 0.88, joint_direction = 'radial', voussoirs = 24, spans = 2, pier_width = 2.1, "
        "pier_height = 0.85 /\n&material unit_weight = 20e3 /\n&joint friction_deg = 50 /\n"
        "&vehicle axles = 2e4, position = -2.1 /\n" + SEARCH,
    "a flat arch that no push fells": FLAT.format("", 2),
    "a flat arch under the associated rule": FLAT.format("&analysis flow = 'associated' /\n", 0.2),
    "a segment that no push fells": FLAT.format("&analysis flow = 'associated' /\n", 0.3).replace(
        "shape = 'flat', half_angle_deg = 20", "shape = 'segmental', rise = 0.5"),
    "a lune": LUNE.format(0.06),
    "a lune that falls": LUNE.format(0.03),
    "thickness of a lune": "&arch shape = 'circular', lune_deg = 10, voussoirs = 21, facet_deg = 2 /\n"
                           "&search parameter = 'thickness_ratio', low = 0.01, high = 0.2 /\n",
    "a spread arch": "&arch thickness_ratio = 0.12, voussoirs = 16 /\n&support right_dx = 0.1 /\n",
    "push on a settled arch": "&arch thickness_ratio = 0.12 /\n&support left_dy = -0.1 /\n"
        "&search parameter = 'horizontal_coefficient' /\n",
    "a tie": TIED.format(1e5) + "&output thrust_bar = 1 /\n",
    "a weak tie": TIED.format(100),
    "strength of a tie": TIED.format(1e5) + "&search parameter = 'strength(1)', low = 0, high = 1e5 /\n",
    "live load on a tied arch": TIED.format(2e4) + "&live x = 0, y = 1, fy = -1e3 /\n" + SEARCH,
    "an arch that crushes": CRUSHED.format(1e6) + SEARCH,
    "an arch that is crushed": CRUSHED.format(1e6) + "&load load_factor = 80 /\n",
    "an arch that is not": CRUSHED.format(1e6) + "&load load_factor = 30 /\n",
    "thickness of what crushes": CRUSHED.format(8e5).replace("thickness = 0.6, ", "").split("&vehicle")[0]
        + "&analysis flow = 'associated' /\n&search parameter = 'thickness', low = 0.1, high = 2 /\n",
    "strength": CRUSHED.format(1e6) + "&load load_factor = 30 /\n"
        + "&search parameter = 'compressive_strength', low = 1e4, high = 1e9 /\n",
    "a push on what crushes": CRUSHED.format(1e6).split("&vehicle")[0] + "&analysis flow = 'associated' /\n"
        + "&search parameter = 'horizontal_coefficient' /\n",
    "no slip on buttresses": "&arch shape = 'segmental', span = 6.0, rise = 1.5, thickness = 0.4, voussoirs = 9, "
        "buttress_width = 2.0, buttress_height = 2.0, springing = 'no-slip' /\n&joint friction_deg = 20 /\n"
        "&search parameter = 'horizontal_coefficient' /\n",
    "no slip on a pier": "&arch shape = 'segmental', span = 4.0, rise = 1.2, thickness = 0.4, voussoirs = 7, "
        "spans = 2, pier_width = 1.2, pier_height = 2.0, springing = 'no-slip' /\n&joint friction_deg = 18 /\n"
        "&search parameter = 'horizontal_coefficient' /\n",
    "fill on an overhanging arch": "&arch shape = 'circular', span = 2.0, rise = 1.45, thickness = 0.25, "
        "voussoirs = 20 /\n&fill height = 0.2, unit_weight = 16e3 /\n",
    "a vehicle that drives backward": "&arch shape = 'segmental', span = 8, rise = 1.5, right_rise = 2.5, "
        "thickness = 0.5, voussoirs = 25 /\n&fill height = 0.3, unit_weight = 18e3 /\n"
        "&vehicle axles = 60e3, 20e3, spacings = 2.5, worst = .true. /\n" + SEARCH,
    "a vehicle without which dead loads fall": "&arch shape = 'circular', span = 6, rise = 2.9, thickness = 0.25, "
        "voussoirs = 20 /\n&joint friction_deg = 60 /\n&load horizontal_coefficient = 0.2 /\n"
        "&fill height = 0.3, unit_weight = 18e3, passive_coefficient = 1, spread = 0.25 /\n"
        "&vehicle axles = 6e4, length = 0.5, worst = .true. /\n&analysis flow = 'associated' /\n" + SEARCH,
    "a vehicle that a flat arch carries at any factor": "&arch shape = 'flat', span = 3.483, voussoirs = 18, "
        "half_angle_deg = 24.64, thickness = 0.7518, spans = 2, pier_width = 0.9679, pier_height = 1.42 /\n"
        "&joint friction_deg = 37.15 /\n&vehicle axles = 19330, length = 0, worst = .true. /\n" + SEARCH,
    # the end of the last voussoir and that of its abutment are one but for their last digit
    "an axle beside an arch in fill": "&arch shape = 'parabolic', span = 14.61, voussoirs = 16, rise = 7.028, "
        "right_rise = 7.301, crown_thickness = 1.472, springing_thickness = 2.321 /\n"
        "&joint friction_deg = 28.28 /\n&fill height = 0.8984, unit_weight = 17480 /\n"
        "&vehicle axles = 112700, 97230, spacings = 7.559, position = 3.039 /\n" + SEARCH,
    "an arch as thin as 2e-6 of its radius": "&arch half_angle_deg = 5.7, voussoirs = 30 /\n&search /\n",
    "a thin segment by its thickness": "&arch shape = 'segmental', span = 10, rise = 0.158, thickness = 0.001, "
        "voussoirs = 57 /\n&search parameter = 'thickness', low = 1e-6, high = 1 /\n",
    "friction": HEAD + "&load load_factor = 5.0 /\n&search parameter = 'friction_deg' /\n",
}
#: Files of blocks with bars and water, each with a deck
SCENES = {
    "a dam": (DAM.format("0.3"), "&material unit_weight = 24e3 /\n"),
    "a dam with uplift": (DAM.format("1"), "&material unit_weight = 24e3 /\n"),
    "level behind a dam": (DAM.format("0.3"), "&material unit_weight = 24e3 /\n"
                           "&search parameter = 'water_rise', low = -20, high = 10 /\n"),
    "bolts": (BOLTED.format("strength 1e4"), "&search parameter = 'horizontal_coefficient' /\n"),
    "a bolt without strength": (BOLTED.format(""), "&search parameter = 'horizontal_coefficient' /\n"),
    "a slope that bolts hold": (BOLTED.format("strength 1e4"), "&load gravity_direction_deg = -60 /\n"),
    "a heading, then a bench": (
        PILLARS + "remove block 3 at 1\nremove polygon at 2\n2.9 0.1\n4.1 0.1\n4.1 0.9\n2.9 0.9\n",
        "&joint friction_deg = 50 /\n"),
    "a prop that comes and goes": (PILLARS + "add block 3 at 1\nremove block 3 at 2.5\n", ""),
    "a stage that falls": (PILLARS + "remove block 3 at 1\nremove block 5 at 2\nremove block 4 at 3\n", ""),
    "a slope that they do not": (BOLTED.format("strength 1e2"), "&load gravity_direction_deg = -30 /\n"),
}
#: What the file of blocks has beside its blocks
ACTING = (
    "live block 2 0 2 1000 0\nload block 2 0.5 2 0 -5000\nmaterial 2 density 1.8d3\njoint 1 1 friction_deg 35\n"
    "block material 2\n2 0\n3 0\n3 1\n2 1\nfix 2.5 1 x\n"
)


def run_scene(folder: Path, deck: str, blocks: str = BLOCKS + ACTING, *options: str) -> Path:
    """Folder of the results of a deck."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "x.blocks").write_text(blocks)
    run_deck(folder, deck, "--quiet", *options)
    return folder / "x"


@pytest.mark.parametrize("deck", DECKS.values(), ids=DECKS)
def test_proofs_of_the_program_hold(tmp_path: Path, deck: str, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path, deck)
    assert main(["verify", str(folder)]) == 0, capsys.readouterr().out
    cases = len(rows_of(folder / "results.csv"))
    assert f"{cases} of {cases} cases have proofs, 0 fail" in capsys.readouterr().out


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_proofs_of_bars_and_water_hold(
    tmp_path: Path, scene: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = run_scene(tmp_path, HEAD + scene[1], scene[0])
    assert main(["verify", str(folder)]) == 0, capsys.readouterr().out
    assert "1 of 1 cases have proofs, 0 fail" in capsys.readouterr().out


@pytest.mark.parametrize("seed", [0, 2, 3, 5, 6, 7, 9])
def test_random_bridges_of_all_keys_are_accepted(
    tmp_path: Path, seed: int, capsys: pytest.CaptureFixture[str]
) -> None:
    done = run_deck(tmp_path, random_study(seed), "--quiet", accepted=(0, 2, 3))
    if done.returncode == 2:
        return  # keys that exclude one another: no folder
    assert main(["verify", str(tmp_path / "x")]) == 0, capsys.readouterr().out


#: A bridge of three rings that slides as it falls
FALLING_RINGS = """&arch shape = 'segmental', span = 2.341, voussoirs = 18, rise = 0.4865, thickness = 0.1717,
    rings = 3, spans = 3, pier_width = 0.6641, pier_height = 1.102, springing = 'no-slip' /
&joint friction_deg = 45.0 /
&material unit_weight = 23840.0, compressive_strength = 13520000.0 /
&vehicle axles = 18390.0, 102700.0, 33550.0, 87160.0, spacings = 0.704, 1.097, 0.4409, length = 0.3,
    position = 0.6958 /
&load load_factor = 0.2198 /
&analysis flow = 'coulomb' /
"""


def test_what_slides_as_it_falls_has_the_friction_of_the_corner_that_presses(tmp_path: Path) -> None:
    """At a hinge that slides the shear force is that of the one normal force, to rounding."""
    folder = run_scene(tmp_path, FALLING_RINGS)
    rows = [row for row in rows_of(folder / "joints.csv") if row["state"] == "sliding" and "hinge" in row["mechanism"]]
    assert len(rows) > 10
    for row in rows:
        assert abs(float(row["shear_force"])) <= float(row["normal_force"]) * (1 + 1e-12)


#: A search whose loading path ends by a jump, so that its bracket is 15 % wide
WIDE_BRACKET = """&arch shape = 'parabolic', span = 2.443, voussoirs = 17, rise = 1.384, thickness = 0.09879,
    joint_direction = 'radial', rings = 3, buttress_width = 0.6802, buttress_height = 1.466 /
&joint friction_deg = 64.02 /
&fill height = 0.2716, unit_weight = 15990.0, passive_coefficient = 2.886, backing_height = 0.4636 /
&material unit_weight = 24090.0 /
&vehicle axles = 78210.0, 94980.0, 61710.0, 21080.0, 117800.0, spacings = 1.427, 0.2784, 0.8948, 0.3769,
    length = 0.0, position = -0.2442 /
&search parameter = 'load_factor' /
&analysis flow = 'coulomb' /
"""


def test_forces_balance_the_loads_at_one_place_of_a_wide_bracket(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A joint force that is off by 1e-4 of itself is found, although the loads at the two ends differ by 1.7 %."""
    folder = run_scene(tmp_path, WIDE_BRACKET)
    assert main(["verify", str(folder), "--ignore-sums"]) == 0, capsys.readouterr().out
    rows = rows_of(folder / "joints.csv")
    largest = max(rows, key=lambda row: float(row["normal_force"]))
    for name in ("force_x", "force_y", "normal_force", "shear_force"):
        largest[name] = repr(float(largest[name]) * (1 + 1e-4))
    with (folder / "joints.csv").open("w", newline="") as lines:
        writer = csv.DictWriter(lines, list(largest), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    assert main(["verify", str(folder), "--ignore-sums"]) == 1
    assert "balance (joints.csv)" in capsys.readouterr().out


#: An axle all but above the crown of an arch that crushes
CRUSHING_ARCH = """&arch shape = 'basket', span = 5.893, voussoirs = 25, rise = 2.089, thickness = 0.3525 /
&joint friction_deg = 25 /
&fill height = 0.4747, unit_weight = 20540.0, backing_height = 1.201 /
&material compressive_strength = 16030000.0 /
&vehicle axles = 80390.0, length = 0.3, position = -1e-9 /
&analysis flow = 'coulomb' /
&load load_factor = {} /
"""


@pytest.mark.parametrize("factor", [1.9, 2.0, 2.01618])
def test_the_path_of_joints_that_crush_ends_where_its_load_does(tmp_path: Path, factor: float) -> None:
    """An event that lies farther away than rates lead goes no farther than the load."""
    folder = run_scene(tmp_path, CRUSHING_ARCH.format(factor))
    (row,) = rows_of(folder / "results.csv")
    assert row["verdict"] == "stable"
    assert main(["verify", str(folder), "--quiet"]) == 0


def test_stages_that_were_left_out_are_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path, HEAD, PILLARS + "remove block 3 at 1\nremove block 4 at 2\n")
    results = (folder / "results.csv").read_text()
    rows = rows_of(folder / "results.csv")
    place = list(rows[0]).index("path_time")
    head, row = results.splitlines()
    fields = row.split(",")
    assert fields[place] == "2"
    fields[place] = "1"
    (folder / "results.csv").write_text(f"{head}\n{','.join(fields)}\n")
    assert main(["verify", str(folder), "--ignore-sums"]) == 1
    said = capsys.readouterr().out
    assert "expected blocks [1, 2, 4, 5, 6] in the last stage, got [1, 2, 5, 6]" in said


@pytest.mark.parametrize("name", ["dry_wall_2x4", "four_corners", "jammed", "goodman_bray", "wedge_in_notch"])
def test_proofs_of_benchmarks_hold(tmp_path: Path, name: str) -> None:
    decks = Path(__file__).parents[2] / "input" / "benchmarks"
    assert run_dda("run", decks / f"{name}.nml", "--quiet", cwd=tmp_path).returncode == 0
    assert main(["verify", str(tmp_path / name), "--decks", str(decks)]) == 0


def test_a_joint_as_short_as_blocks_may_be_apart_has_two_ends(tmp_path: Path) -> None:
    """Bricks that overlap by 1.8e-4 of their size."""
    blocks, friction = random_assembly(113)
    folder = run_scene(tmp_path, HEAD + f"&joint friction_deg = {friction!r} /\n" + SEARCH, blocks)
    assert main(["verify", str(folder), "--exact"]) == 0


@pytest.mark.parametrize("overlap", [5e-5, 2e-6, 5e-7, 0.0, -2e-6, -5e-5])
def test_bricks_that_all_but_meet_above_a_head_joint_have_the_joints_that_are_drawn(
    tmp_path: Path, overlap: float
) -> None:
    """Two bricks on two, head joint on head joint but for an overlap of a fraction of a millimetre."""
    corners = [(-1, -1, 5, 0), (0, 0, 1, 0.5), (1, 0, 2, 0.5), (0.4, 0.5, 1 + overlap, 1), (1 + overlap, 0.5, 1.9, 1)]
    blocks = "".join(f"block {'fixed' if y < 0 else ''}\n{x} {y}\n{u} {y}\n{u} {v}\n{x} {v}\n"
                     for x, y, u, v in corners)
    push = "&search parameter = 'horizontal_coefficient' /\n&analysis flow = 'associated' /\n"
    folder = run_scene(tmp_path, HEAD + "&joint friction_deg = 35 /\n" + push, blocks)
    assert main(["verify", str(folder), "--exact"]) == 0


@pytest.mark.parametrize("foot", [0.99995, 0.99997, 1.0, 1.00001, 1.0006, 1.1, 1.3])
def test_a_block_tips_about_its_only_corner_by_a_force_in_the_cone(tmp_path: Path, foot: float) -> None:
    """Its other foot stands on the very end of the table or beyond it."""
    blocks = ("block fixed\n0 -1\n1 -1\n1 0\n0 0\n" f"block\n0.3 0\n0.5 0.3\n0.8 0.3\n{foot} 0\n1.6 0.5\n0.1 0.5\n")
    folder = run_scene(tmp_path, HEAD + "&output joints = .true., blocks = .true. /\n", blocks)
    row = rows_of(folder / "results.csv")[0]
    assert row["verdict"] == "collapsed"
    joint, = rows_of(folder / "joints.csv")
    assert float(joint["normal_force"]) > 0.0
    assert main(["verify", str(folder)]) == 0


def test_a_limit_that_the_loading_path_all_but_reaches_says_forces_that_carry_it(tmp_path: Path) -> None:
    """The path ends one part in ten millions below the limit, whose load is a thousand times a block's weight."""
    blocks, friction = random_assembly(95)
    head = HEAD + f"&material unit_weight = 1 /\n&joint friction_deg = {friction!r} /\n"
    folder = run_scene(tmp_path, head + SEARCH, blocks)
    assert main(["verify", str(folder)]) == 0


@pytest.mark.parametrize("seed", range(12))
def test_random_assemblies_are_proven_on_both_sides_of_their_programme(tmp_path: Path, seed: int) -> None:
    pytest.importorskip("scipy", reason="the linear programme wants scipy")
    blocks, friction = random_assembly(seed)
    head = HEAD + f"&material unit_weight = 1 /\n&joint friction_deg = {friction!r} /\n"
    folder = run_scene(tmp_path, head + SEARCH, blocks)
    assert main(["verify", str(folder), "--quiet"]) == 0
    (row,) = rows_of(folder / "results.csv")
    tables = {name: verify_command.read_table(folder / f"{name}.csv") for name in verify_command.TABLES}
    deck = read_deck(folder).with_value("load_factor", "1")
    scene = verify_command.scene_of(deck, tables["blocks"][1], [tmp_path], verify_command.Finding())
    factor = programme(scene)
    assert factor is not None and row["verdict"] == "found"
    low, high = float(row["exact_low"]), float(row["exact_high"])
    assert low <= factor * (1 + 1e-10) and factor * (1 - 1e-10) <= high
    assert high - low <= 1e-8 * factor


@pytest.mark.parametrize("seed", [3, 1105])
@pytest.mark.parametrize("asked", ["", SEARCH], ids=["decision", "search"])
def test_tight_bounds_are_as_near_as_rounding_lets_them_be(tmp_path: Path, seed: int, asked: str) -> None:
    blocks, friction = random_assembly(seed)
    head = HEAD + f"&joint friction_deg = {friction!r} /\n" + (asked or "&load load_factor = 0.001 /\n")
    folder = run_scene(tmp_path, head, blocks, "--tight")
    (row,) = rows_of(folder / "results.csv")
    low, high = float(row["exact_low"]), float(row["exact_high"])
    assert high - low <= 1e-12 * high
    assert main(["verify", str(folder), "--exact"]) == 0


@pytest.mark.parametrize("seed", range(40))
def test_a_changed_number_is_found(tmp_path: Path, seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    source = random.Random(seed)
    blocks, friction = random_assembly(seed % 5)
    head = HEAD + f"&material unit_weight = 1 /\n&joint friction_deg = {friction!r} /\n"
    folder = run_scene(tmp_path, head + SEARCH, blocks)
    change_a_number(folder, source)
    assert main(["verify", str(folder), "--ignore-sums"]) == 1
    assert "FAILS" in capsys.readouterr().out


def change_a_number(folder: Path, source: random.Random) -> None:
    """Change a force, a velocity or a corner by more than a millionth of the largest of its columns."""
    tables = [(name, rows_of(folder / f"{name}.csv"), columns) for name, columns in CHANGED]
    cells = [[(row, column) for row in rows for column in columns if row[column]] for _, rows, columns in tables]
    place = source.choice([place for place, cell in enumerate(cells) if cell])
    table, rows, _ = tables[place]
    scale = max(abs(float(row[column])) for row, column in cells[place])
    row, column = source.choice(cells[place])
    row[column] = repr(float(row[column]) + source.choice([-1, 1]) * (scale or 1) * 10 ** source.uniform(-5.9, -1.0))
    with (folder / f"{table}.csv").open("w", newline="") as lines:
        writer = csv.DictWriter(lines, list(row), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


@pytest.mark.parametrize("name", [*DECKS, *SCENES])
def test_a_changed_number_is_found_whatever_a_proof_leaves_free(tmp_path: Path, name: str) -> None:
    scene = SCENES.get(name)
    folder = run_scene(tmp_path, HEAD + scene[1], scene[0]) if scene else run_scene(tmp_path, DECKS[name])
    before = {path: path.read_bytes() for path in folder.glob("*.csv")}
    for seed in range(8):
        change_a_number(folder, random.Random(f"{name} {seed}"))
        assert main(["verify", str(folder), "--quiet"]) == 1
        for path, text in before.items():
            path.write_bytes(text)
    assert main(["verify", str(folder), "--quiet"]) == 0


def test_tables_that_were_written_again_are_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path, DECKS["a lune that falls"])
    table = folder / "proof_motion.csv"
    text = table.read_text()
    # a velocity that is another one by less than a proof can see
    first, *rest = text.splitlines()
    *cells, spin = rest[0].split(",")
    other = repr(float(spin) * (1.0 + 1e-13))
    assert other != spin
    table.write_text("\n".join([first, ",".join([*cells, other]), *rest[1:]]) + "\n")
    assert main(["verify", str(folder)]) == 1
    assert "not as the program wrote them" in capsys.readouterr().out
    assert main(["verify", str(folder), "--ignore-sums"]) == 0
    table.write_text(text)
    assert main(["verify", str(folder)]) == 0
    # seconds are those of one run; any other cell of results.csv is the program's
    table = folder / "results.csv"
    text, header = table.read_text(), table.read_text().partition("\n")[0].split(",")
    for name, status in (("seconds", 0), ("steps", 1)):
        first, last = text.rstrip("\n").split("\n")
        cells = last.split(",")
        cells[header.index(name)] = "77"
        table.write_text(f"{first}\n{','.join(cells)}\n")
        assert main(["verify", str(folder), "--quiet"]) == status
    table.write_text(text)
    (folder / "sizes.record").unlink()
    assert main(["verify", str(folder)]) == 2
    assert "--ignore-sums" in capsys.readouterr().err


@pytest.mark.parametrize("deck", ["arch", "no slip at springings", "listed joints"])
def test_corners_of_what_is_fixed_are_those_of_the_arch(tmp_path: Path, deck: str) -> None:
    folder = run_scene(tmp_path, DECKS[deck])
    rows = rows_of(folder / "blocks.csv")
    far = [row for row in rows if row["state"] == "fixed"][-1]
    for column in "xy":
        text = (folder / "blocks.csv").read_text()
        other = dict(far, **{column: repr(float(far[column]) + 1e-5)})
        (folder / "blocks.csv").write_text(text.replace(",".join(far.values()), ",".join(other.values())))
        assert main(["verify", str(folder), "--quiet", "--ignore-sums"]) == 1
        (folder / "blocks.csv").write_text(text)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [("x/deck.record", "  30", "  31"), ("x.blocks", "0 -5000", "0 -5001"),
     ("x.blocks", "density 1.8d3", "density 1801"), ("x.blocks", "3 1\n", "3 1.001\n"),
     ("x.blocks", "block 2 0 2 1000 0", "block 2 0 1.9 1000 0")],
)
def test_another_deck_is_found(tmp_path: Path, name: str, old: str, new: str) -> None:
    deck = DECKS["live"].replace("3.0", "30.0") if "record" in name else DECKS["live"]
    run_scene(tmp_path, deck)
    assert main(["verify", str(tmp_path / "x"), "--quiet"]) == 0
    text = (tmp_path / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new))
    assert main(["verify", str(tmp_path / "x"), "--quiet"]) == 1


def test_a_folder_without_proofs_is_not_verified(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path, HEAD + "&analysis mode = 'dynamic', geometry = 'current', duration = 0.01 /\n")
    assert main(["verify", str(folder)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "no case of 1 has a proof: nothing was verified"


def test_what_cannot_be_checked_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", str(tmp_path)]) == 2
    assert "deck.record" in capsys.readouterr().err
    folder = run_scene(tmp_path, "&output joints = .false. /\n")
    assert main(["verify", str(folder)]) == 2
    assert "output%joints" in capsys.readouterr().err
    folder = run_scene(tmp_path, HEAD)
    (tmp_path / "x.blocks").rename(tmp_path / "away.blocks")
    assert main(["verify", str(folder)]) == 2
    assert "--decks" in capsys.readouterr().err
    (tmp_path / "other").mkdir()
    (tmp_path / "away.blocks").rename(tmp_path / "other" / "x.blocks")
    assert main(["verify", str(folder), "--decks", str(tmp_path / "other")]) == 0
