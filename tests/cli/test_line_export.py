"""Blocks of lines as a file of blocks: the same verdict and forces; then they may come and go."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

Rows = list[dict[str, str]]

MAP = (
    "&lines seed = 3 /\n"
    "&outline left = -10, right = 10, bottom = -8, top = 10, fixed = 'left', 'right', 'bottom' /\n"
    "&joint_set dip_deg = 0, spacing = 1.5, spacing_law = 'uniform', spacing_randomness = 0.2 /\n"
    "&joint_set dip_deg = 70, spacing = 1.7 /\n"
)
GROUND = MAP.replace("70", "60").replace("10", "12").replace("-8", "-10").replace("seed = 3", "seed = 1")
OPENING = "&opening shape = 'horseshoe', width = 5, wall = 2, y = -2, sides = 12 /\n"
BOLTS = "&bolts number = 9, from_deg = 0, to_deg = 180, length = 5, stiffness = 1e8, strength = 5e5 /\n"
KEYS = "&material density = 2600, young = 5e9 /\n&joint friction_deg = 35 /\n"


def run(folder: Path, *words: str) -> None:
    """Run the program without output."""
    done = run_dda(*words, "--quiet", cwd=folder)
    assert done.returncode == 0, done.stderr


def exported(folder: Path, joint_map: str) -> str:
    """The blocks of a map as a file of blocks."""
    (folder / "map.nml").write_text(joint_map)
    run(folder, "lines", "map.nml", "--out", "rock.geo")
    (folder / "rock.nml").write_text("&scene kind = 'lines', geometry = 'rock.geo' /\n" + KEYS)
    run(folder, "export", "rock.nml")
    return (folder / "rock.blocks").read_text()


def results(folder: Path, blocks: str) -> tuple[dict[str, str], Rows]:
    """Row of results.csv and rows of joints.csv of a file of blocks."""
    (folder / "own.blocks").write_text(blocks)
    # nothing of the lines' deck is needed any more
    (folder / "own.nml").write_text("&scene kind = 'blocks', geometry = 'own.blocks' /\n")
    run(folder, "run", "own.nml")
    return rows_of(folder / "own" / "results.csv")[0], rows_of(folder / "own" / "joints.csv")


@pytest.mark.parametrize(("more", "verdict"), [(OPENING, "collapsed"), (OPENING + BOLTS, "stable")])
def test_blocks_of_lines_have_the_verdict_and_forces_of_the_lines(tmp_path: Path, more: str, verdict: str) -> None:
    blocks = exported(tmp_path, MAP + more)
    row, joints = results(tmp_path, blocks)
    run(tmp_path, "run", "rock.nml")
    (own,) = rows_of(tmp_path / "rock" / "results.csv")
    assert row["verdict"] == own["verdict"] == verdict
    assert row["blocks"] == own["blocks"]
    if verdict == "stable":
        tables = (joints, rows_of(tmp_path / "rock" / "joints.csv"))
        told = [sorted(float(joint["normal_force"]) for joint in rows) for rows in tables]
        assert told[0] == pytest.approx(told[1], abs=1e-8 * told[0][-1])
        assert len(rows_of(tmp_path / "own" / "bars.csv")) == 9


def test_a_tunnel_is_dug_in_two_stages(tmp_path: Path) -> None:
    blocks = exported(tmp_path, GROUND)
    corners = ((-2.5, 2.5, 0.5, 3.0), (-2.5, 2.5, -2.0, 0.5))
    for number, (left, right, low, high) in enumerate(corners, 1):
        blocks += f"remove polygon at {number}\n{left} {low}\n{right} {low}\n{right} {high}\n{left} {high}\n"
    row, joints = results(tmp_path, blocks)
    assert row["verdict"] == "stable"
    assert float(row["path_time"]) == 2.0
    left = {int(line["block"]) for line in rows_of(tmp_path / "own" / "blocks.csv")}
    gone = set(range(1, 10**3)) - left
    assert gone & set(range(1, max(left)))
    assert all(int(joint["block_1"]) in left and int(joint["block_2"]) in left for joint in joints)
    log = (tmp_path / "own" / "log.txt").read_text()
    # the joints that slid are those of the last table
    slid = [int(word) for word in log.split("(")[1].split(")")[0].replace(",", "").split() if word.isdigit()]
    assert slid and max(slid) <= len(joints)


def test_materials_fixed_points_loads_and_histories_come_along(tmp_path: Path) -> None:
    source = Path(__file__).parents[2] / "input" / "limerick"
    (tmp_path / "t.nml").write_text(
        f"&scene kind = 'lines', geometry = '{source / 'terrace.geo'}', analysis = '{source / 'terrace.ana'}' /\n"
        "&joint friction_deg = 40, cohesion = 0, tension = 0 /\n"
    )
    run(tmp_path, "export", "t.nml")
    run(tmp_path, "run", "t.nml")
    text = (tmp_path / "t.blocks").read_text()
    row, _ = results(tmp_path, text)
    (own,) = rows_of(tmp_path / "t" / "results.csv")
    assert (row["verdict"], row["blocks"]) == (own["verdict"], own["blocks"])
    assert "density" in text and "block fixed" in text


def test_several_laws_of_joints_are_refused(tmp_path: Path) -> None:
    source = Path(__file__).parents[2] / "input" / "limerick"
    (tmp_path / "t.nml").write_text(
        f"&scene kind = 'lines', geometry = '{source / 'terrace.geo'}', analysis = '{source / 'terrace.ana'}' /\n"
    )
    done = run_dda("export", "t.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert "t.nml:1: error: " in done.stderr and "joints of one law" in done.stderr


def test_what_slip_takes_comes_along(tmp_path: Path) -> None:
    exported(tmp_path, MAP + OPENING)
    worn = KEYS.replace("friction_deg = 35", "friction_deg = 35, residual_deg = 20, slip_length = 0.002")
    (tmp_path / "rock.nml").write_text("&scene kind = 'lines', geometry = 'rock.geo' /\n" + worn)
    run(tmp_path, "export", "rock.nml")
    laws = [line.split() for line in (tmp_path / "rock.blocks").read_text().splitlines() if line.startswith("joint")]
    told = [dict(zip(words[3::2], map(float, words[4::2]))) for words in laws]
    assert told and all(law["residual_deg"] == pytest.approx(20.0) and law["slip_length"] == 0.002 for law in told)
    row, _ = results(tmp_path, (tmp_path / "rock.blocks").read_text())
    assert row["verdict"] == "collapsed"
