"""Files of blocks under Shi's scheme: what it decides, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest
from block_scene import run_scene
from dda_command import rows_of, run_dda

GROUND = "block fixed\n -2 -1\n 4 -1\n 4 0\n -2 0\n"
BLOCK = "block\n 0 0\n 1 0\n 1 2\n 0 2\n"
# 2 m2 of 20 kN/m3
MATERIAL = "&material density = 2000.0, unit_weight = 20e3, young = 1e9 /\n"
MODE = "&analysis mode = 'limerick' /\n"


def polygon(*corners: tuple[float, float], head: str = "block") -> str:
    """One block of a file."""
    return "\n".join([head, *(f"{x!r} {y!r}" for x, y in corners)]) + "\n"


def portal(scale: float = 1.0, x: float = 0.0, y: float = 0.0) -> str:
    """The portal of docs/howto_blocks.md, of another size, at another place."""

    def box(left: float, low: float, right: float, high: float, head: str = "block") -> str:
        corners = ((left, low), (right, low), (right, high), (left, high))
        return polygon(*((x + scale * a, y + scale * b) for a, b in corners), head=head)

    return (box(-1, -0.5, 6, 0, "block fixed") + box(0, 0, 1, 3) + box(4, 0, 5, 3) + box(0, 3, 5, 3.8))


def run(folder: Path, blocks: str, groups: str = MATERIAL + MODE, *options: str) -> dict[str, str]:
    """The row of results.csv of a deck of blocks."""
    (row,) = rows_of(run_scene(folder, blocks, groups, *options) / "results.csv")
    return row


@pytest.mark.parametrize(
    "place", [{}, {"scale": 0.1}, {"x": 4096.0, "y": -65536.0}], ids=["as it is", "a tenth", "far away"],
)
def test_portal_falls_at_a_third_of_its_weight(tmp_path: Path, place: dict[str, float]) -> None:
    """Both posts turn about their right feet: 1/3, whatever the size."""
    row = run(tmp_path, portal(**place),
              "&material density = 2400.0 /\n&joint friction_deg = 35.0 /\n" + MODE
              + "&search parameter = 'horizontal_coefficient' /\n")
    assert row["verdict"] == "found" and row["blocks"] == "3"
    assert float(row["critical"]) == pytest.approx(1 / 3, rel=0.01)
    assert row["collapse_mode"] == "rotational"


def test_leaning_block_falls(tmp_path: Path) -> None:
    leaning = polygon((0, 0), (1, 0), (6.5, 8), (5.5, 8))
    wide = polygon((-5, -1), (5, -1), (5, 0), (-5, 0), head="block fixed")
    assert run(tmp_path, wide + leaning, MODE)["verdict"] == "collapsed"


def test_one_square_alone_falls_or_rests_where_it_is_fixed(tmp_path: Path) -> None:
    square = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    assert run(tmp_path, polygon(*square))["verdict"] == "collapsed"
    assert run(tmp_path, polygon(*square, head="block fixed"))["verdict"] == "stable"


def test_check_counts_the_blocks_of_the_file(tmp_path: Path) -> None:
    run(tmp_path, GROUND + BLOCK)
    done = run_dda("check", "x.nml", cwd=tmp_path)
    assert "2, fixed at 4 points" in done.stdout
    # 6 m wide, 3 m high
    assert "half size     3 m" in done.stdout


def test_load_that_comes_late_overturns(tmp_path: Path) -> None:
    """At the upper corner a quarter of the weight is just borne: 40 kN 0.5 m = 2 m 10 kN."""
    late = "load 0 2\n 0 0 0\n 100 {} 0\n"
    assert run(tmp_path, GROUND + BLOCK + late.format(9.5e3))["verdict"] == "stable"
    assert run(tmp_path, GROUND + BLOCK + late.format(10.5e3))["verdict"] == "collapsed"


def test_held_line_carries_every_block_that_it_crosses(tmp_path: Path) -> None:
    beside = polygon((1, 0), (2, 0), (2, 2), (1, 2))
    assert run(tmp_path, BLOCK + beside + "fix_line -1 1 3 1\n")["verdict"] == "stable"
    assert run(tmp_path, BLOCK + beside + "fix_line -1 1 0.9 1\n")["verdict"] == "collapsed"


def test_measured_point_ends_where_its_corner_does(tmp_path: Path) -> None:
    row = run(tmp_path, GROUND + BLOCK + "measure 1 2\nmeasure 0.5 0\n")
    points = rows_of(tmp_path / "out" / "points.csv")
    assert [points[0]["step"], points[-1]["step"]] == ["0", row["steps"]]
    assert len(points) == 2 * (int(row["steps"]) + 1)
    corner = next(line for line in rows_of(tmp_path / "out" / "blocks.csv")
                  if (line["block"], line["x"], line["y"]) == ("2", "1", "2"))
    last = points[-2]
    assert float(last["u"]) == pytest.approx(float(corner["u"]), abs=1e-15)
    assert float(last["v"]) == pytest.approx(float(corner["v"]), rel=1e-12)
    # it sinks by the penetration that the penalty aims at, 4e-4 of the half size of 3 m, and strain
    assert float(last["v"]) == pytest.approx(-1.2e-3, rel=0.1)


def test_stress_at_the_beginning_lets_go(tmp_path: Path) -> None:
    """sx = -1 kPa strains a block that is held upright by (1 - 0.2**2) 1 kPa over 1 GPa.

    Springs that hold it are 5000 times as stiff as its material.
    """
    pressed = BLOCK.replace("block", "block stress -1e3 0 0")
    run(tmp_path, pressed + "fix 0.5 0.5\nfix 0.5 1.5\nmeasure 0 1\nmeasure 1 1\n")
    left, right = rows_of(tmp_path / "out" / "points.csv")[-2:]
    assert float(right["u"]) - float(left["u"]) == pytest.approx(0.96e-6, rel=1e-4)


def test_joint_of_one_corner_says_its_force(tmp_path: Path) -> None:
    """A roof of 1 m base and 1 m height stands on its tip between two walls' corners."""
    tip = polygon((0.5, 0), (1.0, 1.0), (0, 1.0))
    walls = "".join(polygon((x, 0.5), (x + 1, 0.5), (x + 1, 1), (x, 1), head="block fixed") for x in (-1.0, 1.0))
    run(tmp_path, GROUND.replace("-1", "-2") + tip + walls)
    joints = rows_of(tmp_path / "out" / "joints.csv")
    (joint,) = (row for row in joints if {row["block_1"], row["block_2"]} == {"1", "2"})
    assert float(joint["normal_force"]) == pytest.approx(10e3, rel=1e-2)
    assert joint["x_intrados"] == joint["x_extrados"]


def test_two_joints_between_two_blocks_share_the_weight(tmp_path: Path) -> None:
    """A bridge of two feet on one ground: half the weight each."""
    bridge = polygon((0, 0), (0.5, 0), (0.5, 1), (1.5, 1), (1.5, 0), (2, 0), (2, 2), (0, 2))
    run(tmp_path, GROUND + bridge)
    forces = [float(row["normal_force"]) for row in rows_of(tmp_path / "out" / "joints.csv")]
    assert forces == pytest.approx([30e3, 30e3], rel=1e-3)


@pytest.mark.parametrize(
    "line, text, words",
    [
        (11, "fix 0.5 1 x\n", "restrains points along x and y"),
        (11, "fix_line 0 1 1 1 y\n", "restrains points along x and y"),
        (11, "displacement 0.5 1 0.1 0\n", "has no prescribed displacements"),
        (12, "measure 1 2\ndisplacement 0.5 1\n 0 0 0\n 1 0.1 0\n", "has no prescribed displacements"),
        (11, "base_acceleration 0.1 0\n", "no ground motion"),
        (12, "measure 1 2\nbase_velocity\n 0 0 0\n 1 1 0\n 2 0 0\n", "no ground motion"),
        (11, polygon((2, 0), (3, 0), (3, 1), head="block velocity 1 0 0"), "step at rest"),
    ],
    ids=["roller", "line", "led", "led in time", "ground", "ground by velocity", "velocity"],
)
def test_what_the_scheme_cannot_do_is_refused(tmp_path: Path, line: int, text: str, words: str) -> None:
    (tmp_path / "x.blocks").write_text(GROUND + BLOCK + text)
    (tmp_path / "x.nml").write_text("&scene kind = 'blocks', geometry = 'x.blocks' /\n" + MODE)
    for command in ("check", "run"):
        done = run_dda(command, "x.nml", cwd=tmp_path)
        assert done.returncode == 2
        (message,) = done.stderr.splitlines()
        assert message.startswith(f"x.blocks:{line}: error: ") and words in message
    assert not (tmp_path / "x").exists()


def test_every_mode_of_a_sweep_is_checked(tmp_path: Path) -> None:
    (tmp_path / "x.blocks").write_text(GROUND + BLOCK + "fix 0.5 1 x\n")
    (tmp_path / "x.nml").write_text("&scene kind = 'blocks', geometry = 'x.blocks' /\n"
                                    "&sweep parameter = 'mode', texts = 'static', 'limerick' /\n")
    done = run_dda("run", "x.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("x.blocks:11: error: ")
