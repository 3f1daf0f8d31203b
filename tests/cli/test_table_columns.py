"""Every column of every table beside numbers by hand of one block: pushed, at its limit, at rest, in flight."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import block, rows_of, run_blocks

#: 2 m by 1 m of 10 kN/m3 at x = 10 on a base
WEIGHT, PUSH = 20e3, 4000.0
BASE = block([(5.0, -1.0), (15.0, -1.0), (15.0, 0.0), (5.0, 0.0)], "fixed")
BRICK = [(10.0, 0.0), (12.0, 0.0), (12.0, 1.0), (10.0, 1.0)]
HEAVY = "&material unit_weight = 10e3, density = 1000 /\n&joint friction_deg = 80 /\n"
JOINTS = "&output joints = .true., reactions = .true. /\n"


def check(row: dict[str, str], expected: dict[str, object], exact: float = 1e-12) -> None:
    """All columns of a row: words and empty fields as they are, numbers to a relative or absolute share."""
    assert list(row) == list(expected)
    for name, value in expected.items():
        if isinstance(value, str):
            assert row[name] == value, name
        else:
            assert float(row[name]) == pytest.approx(value, rel=exact, abs=exact), name


def tables(folder: Path, *names: str) -> list[list[dict[str, str]]]:
    """Rows of some tables of the run."""
    return [rows_of(folder / "out" / f"{name}.csv") for name in names]


def test_a_brick_that_is_pushed_stands(tmp_path: Path) -> None:
    """By a fifth of its weight at half its height: the force on the base moves 0.1 m from the middle."""
    row = run_blocks(tmp_path, BASE + block(BRICK) + "live 10 0.5 1000 0\n",
                     HEAVY + "&load load_factor = 4 /\n&analysis unknowns = 3 /\n" + JOINTS)
    del row["seconds"], row["open_close_iterations"], row["factorisations"], row["steps"]
    check(row, {
        "deck": "x", "case": 1, "blocks": 1, "half_angle_deg": "", "thickness_ratio": "", "friction_deg": 80,
        "mode": "static", "geometry": "reference", "verdict": "stable", "critical": "", "critical_low": "",
        "critical_high": "", "collapses_at": "", "exact": "", "relative_error": "", "collapse_mode": "none",
        "sliding_share": "", "intrados_hinge_deg": "", "extrados_hinge_deg": "", "springing_hinge": "",
        "unknowns": 3, "exact_low": 40, "exact_high": 40, "imbalance": 0, "law_violation": 0, "mechanism_power": "",
        "safety_thickness": "", "thrust_min": "", "thrust_max": "", "path_time": "", "worst_position": "",
        "worst_direction": "", "contact_residual": ""}, 1e-9)
    joints, reactions, forces = tables(tmp_path, "joints", "reactions", "proof_forces")
    check(joints[0], {
        "case": 1, "joint": 1, "angle_deg": "", "x_intrados": 12, "y_intrados": 0, "x_extrados": 10, "y_extrados": 0,
        "normal_force": WEIGHT, "shear_force": PUSH, "eccentricity_ratio": 0.1, "opening_intrados": 0,
        "opening_extrados": 0, "slip": 0, "state": "locked", "block_1": 1, "block_2": 2, "x": 11.1, "y": 0,
        "force_x": -PUSH, "force_y": WEIGHT, "mechanism": "none", "slides_x": "", "slides_y": ""})
    # the moment about the origin of the file: 11.1 m of the weight
    check(reactions[0], {"case": 1, "time": 0, "block": 1, "point": 0, "fx": -PUSH, "fy": WEIGHT,
                         "moment": 11.1 * WEIGHT})
    check(forces[0], {"case": 1, "value": "", "kind": "contact", "block_1": 1, "block_2": 2, "x_1": 12, "y_1": 0,
                      "x_2": 10, "y_2": 0, "normal_1": 0.55 * WEIGHT, "normal_2": 0.45 * WEIGHT, "shear": PUSH})
    assert [len(joints), len(reactions), len(forces)] == [1, 1, 1]


def test_a_brick_at_its_limit_turns_about_its_corner(tmp_path: Path) -> None:
    """The weight at 1 m from the corner, 1000 N at 0.5 m above it: 40 times."""
    row = run_blocks(tmp_path, BASE + block(BRICK) + "live 10 0.5 1000 0\n", HEAVY
                     + "&analysis unknowns = 3 /\n&search parameter = 'load_factor' /\n&output joints = .true. /\n")
    for name, value in {"critical": 40, "critical_low": 40, "critical_high": 40, "exact_low": 40, "exact_high": 40,
                        "sliding_share": 0, "law_violation": 0, "imbalance": 0}.items():
        assert float(row[name]) == pytest.approx(value, rel=1e-8, abs=1e-9), name
    assert [row[name] for name in ("verdict", "collapses_at", "collapse_mode")] == ["found", "high", "rotational"]
    assert float(row["critical_low"]) < float(row["critical"]) < float(row["critical_high"])
    assert float(row["exact_low"]) <= float(row["exact_high"])
    blocks, joints, forces, motion = tables(tmp_path, "blocks", "joints", "proof_forces", "proof_motion")
    check(forces[0], {"case": 1, "value": 40, "kind": "contact", "block_1": 1, "block_2": 2, "x_1": 12, "y_1": 0,
                      "x_2": 10, "y_2": 0, "normal_1": WEIGHT, "normal_2": 0, "shear": 40000}, 1e-6)
    check(motion[0], {"case": 1, "value": 40, "block": 2, "x": 11, "y": 0.5, "u": 0.5, "v": 1, "spin": -1}, 1e-9)
    assert joints[0]["mechanism"] == "hinge_intrados"
    # the corner farthest from the hinge moves by one
    far = math.hypot(2.0, 1.0)
    for number, (x, y) in enumerate(BRICK, start=1):
        check(blocks[4 + number - 1], {"case": 1, "block": 2, "state": "free", "vertex": number, "x": x, "y": y,
                                       "u": y / far, "v": (12.0 - x) / far}, 1e-9)
    assert [line["state"] for line in blocks[:4]] == ["fixed"] * 4
    assert [line["u"] + line["v"] for line in blocks[:4]] == ["00"] * 4


def test_a_brick_at_rest_in_time_keeps_its_forces(tmp_path: Path) -> None:
    row = run_blocks(tmp_path, BASE + block(BRICK) + f"load 10 0.5 {PUSH} 0\nmeasure 12 1\n", HEAVY
                     + "&analysis unknowns = 3, mode = 'dynamic', geometry = 'current', time_step = 0.01,"
                     " duration = 0.05, steps = 100, start = 'static' /\n&output frames = 5, reactions = .true. /\n")
    assert row["verdict"] == "completed"
    pictures, points, reactions = tables(tmp_path, "frame_joints", "points", "reactions")
    for number, line in enumerate(pictures):
        check(line, {"case": 1, "frame": number, "joint": 1, "x_1": 12, "y_1": 0, "x_2": 10, "y_2": 0,
                     "x": 11.1, "y": 0, "force_x": -PUSH, "force_y": WEIGHT, "state_1": "locked",
                     "state_2": "locked"}, 1e-7)
    for number, line in enumerate(points):
        check(line, {"case": 1, "step": number, "time": 0.01 * number, "point": 1, "x": 12, "y": 1, "u": 0, "v": 0,
                     "vx": 0, "vy": 0}, 1e-7)
    for number, line in enumerate(reactions, start=1):
        check(line, {"case": 1, "time": 0.01 * number, "block": 1, "point": 0, "fx": -PUSH, "fy": WEIGHT,
                     "moment": 11.1 * WEIGHT}, 1e-8)
    assert [len(pictures), len(points), len(reactions)] == [6, 6, 5]


def test_a_brick_in_flight_is_pictured_where_it_is(tmp_path: Path) -> None:
    """At 2 and 3 m/s, turning by 0.5 rad/s, without weight; each step turns by what is exact."""
    scene = BASE + block([(x, y + 1.0) for x, y in BRICK], "velocity 2 3 0.5") + "measure 12 2\n"
    run_blocks(tmp_path, scene, "&material unit_weight = 1e-9, density = 1000 /\n"
               "&analysis unknowns = 3, mode = 'dynamic', geometry = 'current', time_step = 0.01, duration = 0.1,"
               " steps = 100 /\n&output frames = 5, energy = .true. /\n")
    pictures, points, energy = tables(tmp_path, "frames", "points", "energy")
    flying = [line for line in pictures if line["block"] == "2"]
    assert [line["frame"] for line in flying] == [str(k) for k in range(6) for _ in range(4)]
    for i, line in enumerate(flying):
        frame, vertex = divmod(i, 4)
        x, y = placed(BRICK[vertex], 0.02 * frame)
        check(line, {"case": 1, "frame": frame, "step": 2 * frame, "time": 0.02 * frame, "block": 2,
                     "vertex": vertex + 1, "x": x, "y": y}, 1e-6)
    for number, line in enumerate(points):
        x, y = placed((12.0, 1.0), 0.01 * number)
        c, s = math.cos(0.005 * number), math.sin(0.005 * number)
        # the arm of 1 m and 0.5 m, turned
        vx, vy = 2.0 - 0.5 * (s + 0.5 * c), 3.0 + 0.5 * (c - 0.5 * s)
        check(line, {"case": 1, "step": number, "time": 0.01 * number, "point": 1, "x": x, "y": y, "u": x - 12.0,
                     "v": y - 2.0, "vx": vx, "vy": vy}, 1e-6)
    # 2000 kg, and a moment of inertia of 2000 (4 + 1)/12
    kinetic = 0.5 * 2000.0 * (4.0 + 9.0) + 0.5 * 2000.0 * 5.0 / 12.0 * 0.25
    assert [float(line["kinetic"]) for line in energy] == pytest.approx([kinetic] * 10, rel=1e-10)


def placed(corner: tuple[float, float], time: float) -> tuple[float, float]:
    """A corner of the brick that flies from 1 m above the base."""
    c, s = math.cos(0.5 * time), math.sin(0.5 * time)
    x, y = corner[0] - 11.0, corner[1] - 0.5
    return 11.0 + c * x - s * y + 2.0 * time, 1.5 + s * x + c * y + 3.0 * time
