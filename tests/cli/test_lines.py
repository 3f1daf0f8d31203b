"""Decks of lines: the same answers as decks of arches, files written by dda export."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda
from limerick_files import HAS_XML, HELD, INPUT, SQUARE


def row_of(folder: Path, name: str, text: str) -> dict[str, str]:
    """Run a deck of one case."""
    (folder / f"{name}.nml").write_text(text)
    done = run_dda("run", f"{name}.nml", cwd=folder)
    assert done.returncode == 0, done.stderr
    return rows_of(folder / name / "results.csv")[0]


@pytest.mark.parametrize("geometry", ["reference", "current"])
@pytest.mark.parametrize(
    "arch",
    [
        "thickness_ratio=0.12, voussoirs=12",
        "thickness_ratio=0.115, voussoirs=37, radius=3.7",
        "thickness_ratio=0.2, joints_deg=0,54.5,90, facet_deg=5",
        "thickness_ratio=0.06, half_angle_deg=60, voussoirs=24",
        "thickness_ratio=0.4, half_angle_deg=100, voussoirs=20, abutment_size=1",
        "thickness_ratio=0.2, voussoirs=15, springing='no-slip'",
    ],
)
def test_an_arch_from_a_file_and_a_generated_one_agree_to_1e12(tmp_path: Path, arch: str, geometry: str) -> None:
    stone = "&material unit_weight=22000, young=5e10 /\n"
    search = (
        f"&analysis geometry='{geometry}' /\n"
        "&search parameter='horizontal_coefficient', low=0, high=1, tolerance=1e-13 /\n"
    )
    (tmp_path / "ring.nml").write_text(f"&arch {arch} /\n{stone}")
    assert run_dda("export", "ring.nml", cwd=tmp_path).returncode == 0
    generated = row_of(tmp_path, "generated", f"&arch {arch} /\n{stone}{search}")
    files = [("ring.geo", "ring_plain.ana")] + [("ring_ddaml.geo", "ring.ana")] * HAS_XML
    for geo, ana in files:
        scene = f"&scene kind='lines', geometry='{geo}', analysis='{ana}' /\n"
        read = row_of(tmp_path, "read", scene + search)
        assert read["verdict"] == generated["verdict"] == "found"
        assert read["blocks"] == generated["blocks"]
        assert float(read["critical"]) == pytest.approx(float(generated["critical"]), rel=1e-12)


@pytest.mark.skipif(not HAS_XML, reason="this build reads no XML")
@pytest.mark.parametrize("path", sorted(HELD.glob("arches/*.geo")) or [HELD])
def test_arches_of_the_original_stand_when_rigid(tmp_path: Path, path: Path) -> None:
    if path == HELD:
        pytest.skip(f"{HELD} is not here: its arches were not run")
    # both sides of the original's limit are thicker than the exact rigid value
    ana = HELD / "arches" / "arch20000.ana"
    text = f"&scene kind='lines', geometry='{path}', analysis='{ana}' /\n"
    assert row_of(tmp_path, "held", text)["verdict"] == "stable"


def test_two_steps_and_a_parapet_stand(tmp_path: Path) -> None:
    text = (INPUT / "terrace.nml").read_text()
    for name in ("terrace.geo", "terrace.ana"):
        (tmp_path / name).write_text((INPUT / name).read_text())
    row = row_of(tmp_path, "terrace", text)
    assert (row["verdict"], row["blocks"]) == ("stable", "7")
    # the blocks at the bottom are held: the joints on them carry the weight of all the others
    joints = rows_of(tmp_path / "terrace" / "joints.csv")
    base = [joint for joint in joints if joint["y_intrados"] == joint["y_extrados"] == "1"]
    assert len(base) == 3
    carried = sum(float(joint["normal_force"]) for joint in base)
    assert carried == pytest.approx(21.9744 * 30.0, rel=1e-9)


def test_check_accepts_a_deck_of_lines(tmp_path: Path) -> None:
    done = run_dda("check", INPUT / "terrace.nml", cwd=tmp_path)
    assert done.returncode == 0
    assert "7 free, 3 fixed" in done.stdout
    assert "a load point has no force" in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("fixed", "loads", "wanted"),
    [
        ("0.5 0.5 0.5 0.5\n", 0, "expected coincident edges"),
        ("0.2 0.5 0.2 0.5\n0.7 0.5 0.7 0.5\n", 0, "only fixed ones"),
        ("", 0, "expected coincident edges"),
    ],
)
def test_what_cannot_be_run_is_checked_and_refused(tmp_path: Path, fixed: str, loads: int, wanted: str) -> None:
    lines = SQUARE.replace("0\n0\n0\n0 0 1", f"0\n{loads}\n0\n0 0 1", 1).splitlines(True)
    lines[4] = f"{fixed.count(chr(10))}\n"
    (tmp_path / "a.geo").write_text("".join(lines) + fixed)
    (tmp_path / "a.nml").write_text("&scene kind='lines',\n geometry='a.geo' /\n")
    done = run_dda("check", "a.nml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert wanted in done.stdout
    done = run_dda("run", "a.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("a.nml:2: error: ")
    assert wanted in done.stderr


def test_a_block_without_joints_falls_in_time(tmp_path: Path) -> None:
    lines = SQUARE.splitlines(True)
    lines[4] = "0\n"
    (tmp_path / "a.geo").write_text("".join(lines))
    (tmp_path / "a.nml").write_text("&scene kind='lines', geometry='a.geo' /\n&analysis mode='dynamic', "
                                    "geometry='current', time_step=0.01, duration=0.1, unknowns=3 /\n")
    assert run_dda("run", "a.nml", cwd=tmp_path).returncode == 0
    assert rows_of(tmp_path / "a" / "results.csv")[0]["verdict"] == "completed"
    assert float(rows_of(tmp_path / "a" / "blocks.csv")[0]["v"]) == pytest.approx(-9.81 * 0.1**2 / 2.0)


@pytest.mark.parametrize(
    ("deck", "wanted"),
    [
        ("&scene kind='lines',\n geometry='b.geo' /", "a.nml:2: error: scene%geometry = 'b.geo': "),
        ("&scene kind='lines', geometry='a.geo',\n analysis='b' /", "a.nml:2: error: scene%anal"),
        ("&scene kind='lines', geometry='bad.geo' /", "bad.geo:2: error: "),
        ("&scene kind='lines', geometry='a.geo', analysis='a.geo' /", "a.geo:1: error: "),
        ("&scene kind='lines', geometry='two.geo', analysis='a.ana' /", "two.geo:12: error: expected one of"),
    ],
)
def test_faults_of_the_files_have_their_line(tmp_path: Path, deck: str, wanted: str) -> None:
    (tmp_path / "a.geo").write_text(SQUARE)
    (tmp_path / "bad.geo").write_text(SQUARE.replace("4 0", "4 x", 1))
    (tmp_path / "two.geo").write_text(SQUARE[:-2] + "2\n")
    (tmp_path / "a.ana").write_text("0 9 1 1 0.01 0.01\n1 1 1 0 0 0 0 0 0 0 0 0 0\n30 0 0\n")
    (tmp_path / "a.nml").write_text(deck)
    done = run_dda("check", "a.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(wanted)


def test_names_of_files_are_relative_to_the_deck(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "a.geo").write_text(SQUARE)
    (tmp_path / "deep" / "a.nml").write_text("&scene kind='lines', geometry='a.geo' /\n")
    assert run_dda("check", "deep/a.nml", cwd=tmp_path).returncode == 0


def test_export_writes_each_case_in_both_forms(tmp_path: Path) -> None:
    text = "&arch abutment_size=1 /\n&sweep parameter='voussoirs', values=6, 12 /\n"
    (tmp_path / "ring.nml").write_text(text + "&load horizontal_coefficient=0.1 /\n")
    done = run_dda("export", "ring.nml", "--out", "files", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    endings = (".geo", "_ddaml.geo", ".ana", "_plain.ana")
    names = {f"ring_{case}{ending}" for case in (1, 2) for ending in endings}
    assert {path.name for path in (tmp_path / "files").iterdir()} == names
    assert "has a place for load%horizontal_coefficient" in done.stdout
    for case, blocks in ((1, 8), (2, 14)):
        cut = run_dda("cut", tmp_path / "files" / f"ring_{case}.geo")
        assert f"{blocks} blocks" in cut.stdout
        assert "dropped     nothing" in cut.stdout


def test_export_follows_the_conventions_of_the_held_arches(tmp_path: Path) -> None:
    held = HELD / "arches" / "big4.3_N36_hi_0.115020.geo"
    if not held.exists():
        pytest.skip(f"{held} is not here")
    (tmp_path / "a.nml").write_text("&arch thickness_ratio=0.115020, abutment_size=4.3 /\n")
    assert run_dda("export", "a.nml", cwd=tmp_path).returncode == 0
    ours, theirs = ((path.read_text().split()) for path in (tmp_path / "a.geo", held))
    assert len(ours) == len(theirs)
    assert ours[:9] == theirs[:9]
    as_pairs = [
        [sorted(zip(map(float, words[k : k + 4 : 2]), map(float, words[k + 1 : k + 4 : 2])))
         for k in range(9, 9 + 5 * 115, 5)]
        for words in (ours, theirs)
    ]
    for one, other in zip(*map(sorted, as_pairs)):
        for a, b in zip(one, other):
            assert a == pytest.approx(b, abs=1e-11)


def test_export_refuses_what_it_cannot_write(tmp_path: Path) -> None:
    (tmp_path / "a.nml").write_text("&arch\n half_angle_deg=130,\n abutment_size=8 /\n")
    done = run_dda("export", "a.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("a.nml:3: error: arch%abutment_size must")
    (tmp_path / "b.nml").write_text("&arch /\n")
    (tmp_path / "b.geo").mkdir()
    assert run_dda("export", "b.nml", cwd=tmp_path).returncode == 4
    assert run_dda("export", INPUT / "terrace.nml", cwd=tmp_path).returncode == 2


def test_a_changed_file_of_lines_is_computed_again(tmp_path: Path) -> None:
    (tmp_path / "ring.nml").write_text("&arch thickness_ratio=0.12, voussoirs=12 /\n")
    assert run_dda("export", "ring.nml", cwd=tmp_path).returncode == 0
    scene = "&scene kind='lines', geometry='ring.geo', analysis='ring_plain.ana' /\n"
    assert row_of(tmp_path, "a", scene)["verdict"] == "stable"
    kept = (tmp_path / "a" / "results.csv").read_text()
    assert run_dda("run", "a.nml", "--resume", cwd=tmp_path).returncode == 0
    assert (tmp_path / "a" / "results.csv").read_text() == kept
    (tmp_path / "ring.nml").write_text("&arch thickness_ratio=0.10, voussoirs=12 /\n")
    assert run_dda("export", "ring.nml", cwd=tmp_path).returncode == 0
    assert run_dda("run", "a.nml", "--resume", cwd=tmp_path).returncode == 0
    assert ",collapsed," in (tmp_path / "a" / "results.csv").read_text()


def block_on_ground(points: str, x: float = 0.0) -> str:
    """Lines of a block of 1 x 2 m on a ground, moved to the right, with two fixed points and more."""
    ground, block = [(-3, -1), (4, -1), (4, 0), (-3, 0)], [(0, 0), (1, 0), (1, 2), (0, 2)]
    sides = [(*a, *b) for ring in (ground, block) for a, b in zip(ring, ring[1:] + ring[:1])]
    sides.remove((0, 0, 1, 0))
    rows = "".join(f"{a + x!r} {b} {c + x!r} {d} 1\n" for a, b, c, d in sides)
    held = f"{x - 2!r} -0.5 {x - 2!r} -0.5\n{x + 3!r} -0.5 {x + 3!r} -0.5\n"
    return f"0.01\n{len(sides)} 0 0 0 {{}} 0\n{rows}{held}{points}"


ANALYSIS = """<DDA><Analysis><Numtimesteps timesteps="20"/><Maxtimestep maxtimestep="0.01"/>
<Maxdisplacement maxdisplacement="0.002"/><Gravaccel value="10"/>
<Blockmaterial type="1"><Unitmass> 2000 </Unitmass><Unitweight> 20000 </Unitweight><Youngsmod> 1e10 </Youngsmod>
<Poissonratio> 0.2 </Poissonratio></Blockmaterial>
<Jointproperties type="1"><Friction> 60 </Friction><Cohesion> 0 </Cohesion><Tensile> 0 </Tensile></Jointproperties>
<Loadpointlist><Loadpoint numpoints="{}"> {} </Loadpoint></Loadpointlist></Analysis></DDA>
"""


@pytest.mark.skipif(not HAS_XML, reason="no libxml2")
@pytest.mark.parametrize("x", [0.0, 2.0**20])
@pytest.mark.parametrize("records", ["1 0 {force} 0", "2 0 0 0; 5 {force} 0"])
def test_forces_on_load_points_topple_a_block(tmp_path: Path, x: float, records: str) -> None:
    """40 kN half a metre from its corner, a push 1.5 m above it: it turns from 40/3 kN on, at whatever time."""
    (tmp_path / "a.geo").write_text(block_on_ground(f"{x + 0.5!r} 1.5\n", x).format("2 1 0"))
    deck = "&scene kind='lines', geometry='a.geo', analysis='a.ana' /\n"
    for factor, verdict in ((0.999, "stable"), (1.001, "collapsed")):
        count, rest = records.split(" ", 1)
        (tmp_path / "a.ana").write_text(ANALYSIS.format(count, rest.format(force=factor * 4e4 / 3.0)))
        row = row_of(tmp_path, f"d{verdict}", deck)
        assert row["verdict"] == verdict
        # the file of blocks of it says the same
        assert run_dda("export", f"d{verdict}.nml", cwd=tmp_path).returncode == 0
        (tmp_path / "e.nml").write_text(f"&scene kind='blocks', geometry='d{verdict}.blocks' /\n")
        assert row_of(tmp_path, "e", (tmp_path / "e.nml").read_text())["verdict"] == verdict


@pytest.mark.skipif(not HAS_XML, reason="no libxml2")
@pytest.mark.parametrize("x", [0.0, 2.0**20])
def test_a_single_fixed_point_takes_a_force_that_acts_there(tmp_path: Path, x: float) -> None:
    deck = "&scene kind='lines', geometry='a.geo', analysis='a.ana' /\n"
    (tmp_path / "a.ana").write_text(ANALYSIS.format(1, "0 1e6 0"))
    for held, verdict in ((f"{x + 0.5!r} 1.5 {x + 0.5!r} 1.5\n", "stable"), ("", "collapsed")):
        text = block_on_ground(f"{held}{x + 0.5!r} 1.5\n", x).format("3 1 0" if held else "2 1 0")
        (tmp_path / "a.geo").write_text(text)
        assert row_of(tmp_path, verdict, deck)["verdict"] == verdict


@pytest.mark.parametrize("x", [0.0, 2.0**20])
def test_measured_points_of_a_file_are_reported(tmp_path: Path, x: float) -> None:
    """The ground moves to the left by 4.5 m/s2; the block slides by what friction does not bear."""
    (tmp_path / "a.geo").write_text(block_on_ground(f"{x + 0.25!r} 1.9\n", x).format("2 0 1"))
    motion = "&ground pulse='rectangular', amplitude=-4.5, duration=1.0 /\n&joint friction_deg=20 /\n"
    row_of(tmp_path, "a", "&scene kind='lines', geometry='a.geo' /\n" + motion
           + "&analysis mode='dynamic', geometry='current', start='static',\n"
           "   duration=0.2, time_step=1e-3, steps=1000 /\n")
    last = rows_of(tmp_path / "a" / "points.csv")[-1]
    assert float(last["x"]) - x == pytest.approx(0.25 + float(last["u"]), abs=1e-9)
    slides = 0.5 * (4.5 - 9.81 * math.tan(math.radians(20.0))) * 0.2**2
    assert float(last["u"]) == pytest.approx(slides, rel=0.02)


@pytest.mark.parametrize("mode", ["static", "limerick"])
def test_a_model_far_away_is_reported_where_it_is(tmp_path: Path, mode: str) -> None:
    """A block of 1 x 2 m on a ground, 2**20 m to the right and 2**18 m below zero."""
    x, y = 2.0**20, -(2.0**18)
    ground, block = [(-3, -1), (4, -1), (4, 0), (-3, 0)], [(0, 0), (1, 0), (1, 2), (0, 2)]
    sides = [(*a, *b) for ring in (ground, block) for a, b in zip(ring, ring[1:] + ring[:1])]
    sides.remove((0, 0, 1, 0))
    fixed = [(-2, -0.5, -2, -0.5), (3, -0.5, 3, -0.5)]
    rows = [f"{a + x!r} {b + y!r} {c + x!r} {d + y!r}" for a, b, c, d in sides + fixed]
    text = "\n".join(["0.01", f"{len(sides)} 0 0 0 2 0 0 0", *(row + " 1" for row in rows[:-2]), *rows[-2:]])
    (tmp_path / "a.geo").write_text(text + "\n")
    row_of(tmp_path, "far", f"&scene kind='lines', geometry='a.geo' /\n&analysis mode='{mode}' /\n")
    (joint,) = rows_of(tmp_path / "far" / "joints.csv")
    assert {round(float(joint[f"x_{end}"]) - x, 2) for end in ("intrados", "extrados")} == {0, 1}
    assert float(joint["y_intrados"]) - y == pytest.approx(0, abs=0.01)
    corners = {(float(line["x"]) - x, float(line["y"]) - y) for line in rows_of(tmp_path / "far" / "blocks.csv")}
    assert corners >= {*ground, *block}


def test_export_refuses_what_is_a_file_already_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "a.blocks").write_text("block fixed\n0 0\n1 0\n1 1\n")
    (tmp_path / "a.nml").write_text("&scene\n kind='blocks', geometry='a.blocks' /\n")
    done = run_dda("export", "a.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("a.nml:2: error: dda export needs scene%kind 'arch' or 'lines', got 'blocks'")
    assert not (tmp_path / "a.geo").exists()
