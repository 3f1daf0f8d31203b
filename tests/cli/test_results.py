"""Tables that dda run writes: columns, verdicts, brackets, sweeps, collapse modes, joints."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

FIRST = ["deck", "case"]
LAST = """blocks half_angle_deg thickness_ratio friction_deg mode geometry verdict critical
    critical_low critical_high collapses_at exact relative_error collapse_mode sliding_share
    intrados_hinge_deg extrados_hinge_deg springing_hinge steps open_close_iterations
    factorisations seconds unknowns exact_low exact_high imbalance law_violation mechanism_power
    safety_thickness thrust_min thrust_max path_time worst_position worst_direction
    contact_residual""".split()
JOINTS = """case joint angle_deg x_intrados y_intrados x_extrados y_extrados normal_force
    shear_force eccentricity_ratio opening_intrados opening_extrados slip state block_1
    block_2 x y force_x force_y mechanism slides_x slides_y""".split()

Row = dict[str, str]


def read_table(file: Path) -> tuple[list[str], list[Row]]:
    """Names of the columns and rows of a table."""
    header = next(line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    return header.split(","), rows_of(file)


def run_deck(folder: Path, text: str, status: int = 0) -> list[Row]:
    """Run a deck."""
    (folder / "deck.nml").write_text(text)
    done = run_dda("run", "deck.nml", "--quiet", cwd=folder)
    assert done.returncode == status, done.stderr
    return read_table(folder / "deck" / "results.csv")[1]


def numbers(row: Row, *names: str) -> list[float]:
    """Values of some columns of a row."""
    return [float(row[name]) for name in names]


def angles(row: Row, name: str) -> list[float]:
    """Hinge angles of a row."""
    return [float(angle) for angle in row[name].split(";") if angle]


# columns


def test_columns_are_those_of_the_contract(tmp_path: Path) -> None:
    run_deck(tmp_path, "&arch thickness_ratio = 0.12 /\n")
    assert read_table(tmp_path / "deck" / "results.csv")[0] == FIRST + LAST
    assert read_table(tmp_path / "deck" / "joints.csv")[0] == JOINTS


def test_swept_parameters_without_a_column_get_one(tmp_path: Path) -> None:
    text = """&arch joints_deg = 0, 50, 90, thickness_ratio = 0.2 /
        &sweep parameter = 'thickness_ratio', values = 0.2, 0.3 /
        &sweep parameter = 'joints_deg(2)', values = 45.5, 60 /
        &sweep parameter = 'springing', texts = 'no-slip', 'frictional' /
        &sweep parameter = 'radius', values = 5 /
        &sweep parameter = 'mode', texts = 'static' /
        &sweep parameter = 'friction_deg', values = 50 /"""
    rows = run_deck(tmp_path, text)
    own = ["joints_deg(2)", "springing", "radius"]
    assert read_table(tmp_path / "deck" / "results.csv")[0] == FIRST + own + LAST
    columns = ["thickness_ratio", "joints_deg(2)", "springing", "radius", "friction_deg"]
    assert [rows[1][name] for name in columns] == ["0.2", "45.5", "frictional", "5", "50"]
    assert [rows[6][name] for name in columns] == ["0.3", "60", "no-slip", "5", "50"]


@pytest.mark.parametrize("joints", [".true.", ".false."])
def test_joints_are_written_where_wanted(tmp_path: Path, joints: str) -> None:
    text = f"&arch thickness_ratio = 0.12 /\n&output joints = {joints} /\n"
    run_deck(tmp_path, text)
    assert (tmp_path / "deck" / "joints.csv").exists() == (joints == ".true.")


def test_columns_of_a_run_without_search(tmp_path: Path) -> None:
    (row,) = run_deck(
        tmp_path,
        "&arch half_angle_deg = 80, voussoirs = 35, thickness_ratio = 0.12 /\n" "&joint friction_deg = 45 /\n")
    assert [row[name] for name in ("deck", "case", "blocks")] == ["deck", "1", "35"]
    assert numbers(row, "half_angle_deg", "thickness_ratio", "friction_deg") == [80, 0.12, 45]
    assert [row["mode"], row["geometry"]] == ["static", "reference"]
    for name in ("critical", "critical_low", "critical_high", "collapses_at", "relative_error"):
        assert row[name] == ""
    assert all(int(row[name]) > 0 for name in ("steps", "open_close_iterations", "factorisations"))
    assert 0.0 < float(row["seconds"]) < 60.0


@pytest.mark.parametrize(
    ("name", "group", "text"),
    [
        ("thickness_ratio", "arch", "&search parameter = 'thickness_ratio' /\n"),
        ("friction_deg", "joint", "&search parameter = 'friction_deg' /\n"),
        ("half_angle_deg", "arch", "&search parameter = 'half_angle_deg' /\n"),
    ],
)
def test_searched_parameter_leaves_its_own_column_empty(tmp_path: Path, name: str, group: str, text: str) -> None:
    given = {"thickness_ratio": "0.15", "friction_deg": "50", "half_angle_deg": "90"}
    (row,) = run_deck(tmp_path, f"&{group} {name} = {given[name]} /\n{text}")
    assert row["verdict"] == "found"
    assert {key: row[key] for key in given} == given | {name: ""}


def test_names_and_titles_with_commas_and_quotes_stay_one_field(tmp_path: Path) -> None:
    (tmp_path / 'a, "b"; c.nml').write_text("&scene title = 'one, two; \"three\"' /\n&arch thickness_ratio = 0.12 /\n")
    assert run_dda("run", 'a, "b"; c.nml', "--out", "out", cwd=tmp_path).returncode == 0
    columns, (row,) = read_table(tmp_path / "out" / "results.csv")
    assert columns == FIRST + LAST
    assert row["deck"] == 'a, "b"; c'
    assert row["verdict"] == "stable"


# verdicts


@pytest.mark.parametrize(
    ("text", "verdict", "status"),
    [
        ("&arch thickness_ratio = 0.12 /\n", "stable", 0),
        ("&arch thickness_ratio = 0.10 /\n", "collapsed", 0),
        ("&arch thickness_ratio = 0.12 /\n&analysis geometry = 'current', steps = 1 /\n", "undecided", 3),
        ("&arch thickness_ratio = 0.12 /\n&analysis mode = 'dynamic' /\n", "completed", 0),
        ("&search /\n", "found", 0),
        ("&arch voussoirs = 3 /\n&search /\n", "stable", 0),
        ("&joint friction_deg = 17.0 /\n&search /\n", "collapsed", 0),
        ("&arch half_angle_deg = 145, voussoirs = 58 /\n" "&joint friction_deg = 55 /\n&search /\n", "collapsed", 0),
        ("&search low = 0.2, high = 0.5 /\n", "stable", 0),
        ("&search low = 0.02, high = 0.05 /\n", "collapsed", 0),
        ("&search parameter = 'friction_deg', low = 30, high = 80 /\n", "stable", 0),
        ("&search parameter = 'friction_deg', low = 1, high = 10 /\n", "collapsed", 0),
        ("&search /\n&analysis geometry = 'current', steps = 1 /\n", "undecided", 3),
    ],
)
def test_verdict_is_one_word(tmp_path: Path, text: str, verdict: str, status: int) -> None:
    (row,) = run_deck(tmp_path, text, status)
    assert row["verdict"] == verdict
    if verdict != "found":
        columns = ["critical", "critical_low", "critical_high", "collapses_at", "relative_error"]
        assert [row[name] for name in columns] == [""] * 5
    if verdict != "collapsed":
        assert (row["collapse_mode"] == "none") == (verdict != "found")


@pytest.mark.parametrize(
    "text",
    [
        "&joint friction_deg = 17.0 /\n",
        "&arch half_angle_deg = 145, voussoirs = 58 /\n&joint friction_deg = 55 /\n",
        "&arch voussoirs = 3 /\n",
        "&load horizontal_coefficient = 0.05 /\n",
        "&load gravity_direction_deg = -85 /\n",
        "&joint cohesion = 1e4 /\n",
    ],
    ids=["friction-17", "friction-55-at-145", "three", "horizontal", "tilted", "cohesion"],
)
def test_exact_is_empty_where_none_is_known(tmp_path: Path, text: str) -> None:
    (row,) = run_deck(tmp_path, text)
    assert row["exact"] == row["relative_error"] == ""


def test_exact_stands_beside_a_run_without_search(tmp_path: Path) -> None:
    (row,) = run_deck(tmp_path, "&arch thickness_ratio = 0.12 /\n")
    assert float(row["exact"]) == pytest.approx(0.1074241383203705, rel=1e-12)


def test_current_geometry_has_the_elastic_shift(tmp_path: Path) -> None:
    text = """&analysis geometry = 'current' /
        &search /
        &sweep parameter = 'young', values = 5e9, 5e10 /"""
    rows = run_deck(tmp_path, text)
    assert [row["geometry"] for row in rows] == ["current"] * 2
    shift = [float(row["relative_error"]) for row in rows]
    assert shift[0] == pytest.approx(5.4e-4, rel=0.1)
    assert shift[0] / shift[1] == pytest.approx(10.0, rel=0.01)


# searches


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize(
    "arch",
    [
        "half_angle_deg = 90, voussoirs = 36",
        "half_angle_deg = 45, voussoirs = 18",
        "half_angle_deg = 140, voussoirs = 56",
        "half_angle_deg = 60, voussoirs = 7",
        "joints_deg = 0, 54.5, 90, facet_deg = 0.5",
    ],
)
def test_bracket_is_closed_and_holds_the_truth(tmp_path: Path, arch: str, tolerance: float) -> None:
    text = f"&arch {arch} /\n&joint friction_deg = 90 /\n&search tolerance = {tolerance} /\n"
    (row,) = run_deck(tmp_path, text)
    low, high, critical = numbers(row, "critical_low", "critical_high", "critical")
    exact, relative_error = numbers(row, "exact", "relative_error")
    assert row["verdict"] == "found"
    assert row["collapses_at"] == "low"
    assert low < critical < high
    assert low < exact < high
    assert high - low <= 1.001 * tolerance * critical
    assert critical == pytest.approx((low + high) / 2.0, rel=1e-15)
    assert relative_error == pytest.approx((critical - exact) / exact, abs=1e-15)


@pytest.mark.parametrize("tolerance", [1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14])
def test_bracket_claims_no_more_than_a_decision_resolves(tmp_path: Path, tolerance: float) -> None:
    text = f"""&joint friction_deg = 90 /
        &search tolerance = {tolerance} /
        &sweep parameter = 'half_angle_deg', values = 10, 20, 45, 90, 140 /
        &sweep parameter = 'voussoirs', values = 7, 12, 36, 180 /
        &output joints = .false. /"""
    (tmp_path / "deck.nml").write_text(text)
    run_dda("run", "deck.nml", "--quiet", cwd=tmp_path)
    beside = []
    for row in read_table(tmp_path / "deck" / "results.csv")[1]:
        if row["verdict"] == "found":
            low, high, exact = numbers(row, "critical_low", "critical_high", "exact")
            if not low < exact < high:
                beside.append((row["half_angle_deg"], row["voussoirs"], low, exact, high))
        else:
            assert row["verdict"] == "undecided"
    assert beside == []


def test_very_shallow_arch_is_found_right_or_not_at_all(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text("&arch half_angle_deg = 1, voussoirs = 10 /\n&search /\n")
    run_dda("run", "deck.nml", "--quiet", cwd=tmp_path)
    _, (row,) = read_table(tmp_path / "deck" / "results.csv")
    if row["verdict"] == "found":
        low, high, exact = numbers(row, "critical_low", "critical_high", "exact")
        assert low < exact < high
    else:
        assert row["verdict"] == "undecided"


@pytest.mark.parametrize(
    ("text", "critical", "tolerance", "collapses_at"),
    [
        (
            "&arch half_angle_deg = 78.75, voussoirs = 7, thickness_ratio = 0.15 /\n"
            "&joint friction_deg = 90 /\n&search parameter = 'horizontal_coefficient' /\n",
            0.373612,
            1e-6,
            "high",
        ),
        # thickness_ratio is the exact value of these friction and half angles in arch_exact.csv
        (
            "&arch thickness_ratio = 0.15001749477121489 /\n" "&search parameter = 'friction_deg' /\n", 19.37, 1e-6,
            "low"),
        (
            "&arch thickness_ratio = 0.15800602179655778 /\n"
            "&search parameter = 'friction_deg', low = 5, high = 40 /\n",
            19.0,
            1e-6,
            "low",
        ),
        (
            "&arch thickness_ratio = 0.1074241383203705 /\n" "&search parameter = 'half_angle_deg' /\n", 90.0, 1e-5,
            "high"),
        (
            "&arch thickness_ratio = 0.1074241383203705 /\n"
            "&search parameter = 'half_angle_deg', low = 30, high = 120 /\n",
            90.0,
            1e-5,
            "high",
        ),
    ],
    ids=["horizontal", "friction", "friction-given-ends", "half-angle", "half-angle-given-ends"],
)
def test_search_of_another_parameter(
    tmp_path: Path, text: str, critical: float, tolerance: float, collapses_at: str
) -> None:
    (row,) = run_deck(tmp_path, text)
    low, found, high = numbers(row, "critical_low", "critical", "critical_high")
    assert row["verdict"] == "found"
    assert low < found < high
    assert high - low <= 1.001e-8 * found
    assert abs(found - critical) <= tolerance
    assert row["collapses_at"] == collapses_at


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("&material young = 5e9 /", "&material young = 5e15 /"),
        ("&analysis penalty_ratio = 1 /", "&analysis penalty_ratio = 1e4 /"),
        ("&arch radius = 0.001 /", "&arch radius = 1e4 /"),
        ("&material density = 1 /", "&material unit_weight = 1e6 /"),
        ("&material plane = 'stress' /", "&material plane = 'strain' /"),
        ("&load gravity = 1.62 /", "&material poisson = 0.45 /"),
    ],
)
def test_critical_thickness_of_rigid_blocks_has_no_scale(tmp_path: Path, first: str, second: str) -> None:
    critical = [float(run_deck(tmp_path, f"{text}\n&search /\n")[0]["critical"]) for text in (first, second)]
    assert critical[0] == pytest.approx(critical[1], rel=1e-8)


# sweeps


def test_last_sweep_runs_fastest_and_linked_ones_go_together(tmp_path: Path) -> None:
    text = """&arch thickness_ratio = 0.3 /
        &sweep parameter = 'half_angle_deg', values = 45, 60 /
        &sweep parameter = 'voussoirs', values = 9, 12, linked = .true. /
        &sweep parameter = 'springing', texts = 'no-slip', 'frictional' /
        &sweep parameter = 'friction_deg', first = 30, last = 60, count = 4 /"""
    rows = run_deck(tmp_path, text)
    shapes = [("45", "9"), ("60", "12")]
    wanted = [
        (*shape, springing, friction)
        for shape in shapes
        for springing in ("no-slip", "frictional")
        for friction in ("30", "40", "50", "60")
    ]
    columns = ["half_angle_deg", "voussoirs", "springing", "friction_deg"]
    assert [tuple(row[name] for name in columns) for row in rows] == wanted
    assert [row["case"] for row in rows] == [str(case) for case in range(1, 17)]
    assert all(row["blocks"] == row["voussoirs"] for row in rows)


@pytest.mark.parametrize(
    ("name", "texts"),
    [
        ("springing", ["'frictional'", "'no-slip'"]),
        ("plane", ["'stress'", "'strain'"]),
        ("mode", ["'static'", "'dynamic'"]),
    ],
)
def test_words_may_be_swept(tmp_path: Path, name: str, texts: list[str]) -> None:
    text = f"&arch thickness_ratio = 0.12 /\n&sweep parameter='{name}', texts={','.join(texts)} /"
    rows = run_deck(tmp_path, text)
    assert [f"'{row[name]}'" for row in rows] == texts


def test_no_slip_springings_change_the_answer(tmp_path: Path) -> None:
    text = """&arch thickness_ratio = 0.12 /
        &joint friction_deg = 20 /
        &sweep parameter = 'springing', texts = 'frictional', 'no-slip' /"""
    assert [row["verdict"] for row in run_deck(tmp_path, text)] == ["collapsed", "stable"]


def test_joint_sweep_moves_the_haunch(tmp_path: Path) -> None:
    text = """&arch joints_deg = 0, 50, 90, facet_deg = 0.5 /
        &search /
        &sweep parameter = 'joints_deg(2)', first = 40, last = 60, count = 5 /"""
    rows = run_deck(tmp_path, text)
    assert [float(row["joints_deg(2)"]) for row in rows] == [40, 45, 50, 55, 60]
    assert [angles(row, "intrados_hinge_deg") for row in rows] == [[40], [45], [50], [55], [60]]


def test_joint_sweep_of_the_springing_sets_the_half_angle(tmp_path: Path) -> None:
    text = """&arch joints_deg = 0, 50, 90, thickness_ratio = 0.5 /
        &sweep parameter = 'joints_deg(3)', values = 80, 100 /"""
    rows = run_deck(tmp_path, text)
    assert [float(row["half_angle_deg"]) for row in rows] == [80, 100]


def test_joints_and_equal_voussoirs_are_the_same_arch(tmp_path: Path) -> None:
    rows = [
        run_deck(tmp_path, f"&arch {arch} /\n&search /\n")[0]
        for arch in ("joints_deg = 0, 30, 60, 90", "voussoirs = 6", "voussoirs = 6, facet_deg = 30")
    ]
    critical = [float(row["critical"]) for row in rows]
    assert critical == pytest.approx([critical[0]] * 3, rel=1e-12)
    assert [row["blocks"] for row in rows] == ["6"] * 3


def test_sweep_and_single_run_agree_bit_for_bit(tmp_path: Path) -> None:
    swept = run_deck(tmp_path, "&search /\n&sweep parameter = 'voussoirs', values = 7, 36 /\n")
    (single,) = run_deck(tmp_path, "&search /\n&arch voussoirs = 36 /\n")
    for name in LAST:
        if name != "seconds":
            assert swept[1][name] == single[name]


# collapse modes and hinges


@pytest.mark.parametrize(
    ("friction", "share", "mode"),
    [
        (0, 1.0, "sliding"),
        (5, 1.0, "sliding"),
        (10, 0.76, "mixed"),
        (15, 0.73, "mixed"),
        (20, 0.71, "mixed"),
        (21, 0.71, "mixed"),
        (22, 0.0, "rotational"),
        (30, 0.0, "rotational"),
        (50, 0.0, "rotational"),
        (90, 0.0, "rotational"),
    ],
)
def test_sliding_share_of_the_semicircle(tmp_path: Path, friction: int, share: float, mode: str) -> None:
    text = f"&arch thickness_ratio = 0.105965 /\n&joint friction_deg = {friction} /\n"
    (row,) = run_deck(tmp_path, text)
    assert row["verdict"] == "collapsed"
    assert float(row["sliding_share"]) == pytest.approx(share, abs=0.006)
    assert row["collapse_mode"] == mode
    if mode == "rotational":
        assert angles(row, "intrados_hinge_deg") == [55.0]
        assert angles(row, "extrados_hinge_deg") == [0.0, 90.0]
        assert row["springing_hinge"] == "extrados"
    else:
        assert row["springing_hinge"] == "none"


@pytest.mark.parametrize(
    ("voussoirs", "hinge"),
    [(20, 54), (24, 52.5), (30, 54), (36, 55), (40, 54), (48, 56.25), (60, 54), (72, 55), (90, 54)]
    + [(120, 54), (180, 55), (360, 54.5)],
)
def test_intrados_hinge_below_the_critical_thickness(tmp_path: Path, voussoirs: int, hinge: float) -> None:
    text = f"&arch thickness_ratio = 0.105965, voussoirs = {voussoirs} /\n"
    (row,) = run_deck(tmp_path, text)
    assert angles(row, "intrados_hinge_deg") == [hinge]
    assert angles(row, "extrados_hinge_deg") == [0.0, 90.0]
    assert row["springing_hinge"] == "extrados"


@pytest.mark.parametrize("voussoirs", [12, 18])
def test_coarse_arch_stands_at_the_same_thickness(tmp_path: Path, voussoirs: int) -> None:
    text = f"&arch thickness_ratio = 0.105965, voussoirs = {voussoirs} /\n"
    (row,) = run_deck(tmp_path, text)
    assert row["verdict"] == "stable"


@pytest.mark.parametrize(
    ("voussoirs", "intrados", "extrados"),
    [(5, 54.0, [18.0, 90.0]), (7, 64.285714286, [12.857142857, 90.0])],
)
def test_arch_of_an_odd_number_turns_beside_the_crown(
    tmp_path: Path, voussoirs: int, intrados: float, extrados: list[float]
) -> None:
    (row,) = run_deck(tmp_path, f"&arch voussoirs = {voussoirs} /\n&search /\n")
    assert angles(row, "intrados_hinge_deg") == pytest.approx([intrados], abs=1e-8)
    assert angles(row, "extrados_hinge_deg") == pytest.approx(extrados, abs=1e-8)


# joints.csv


def read_joints(folder: Path) -> list[dict[str, float | str]]:
    """Rows of joints.csv; what is no number stays text."""
    rows = read_table(folder / "deck" / "joints.csv")[1]
    return [
        {
            name: value if name in ("state", "mechanism") or value == "" else float(value)
            for name, value in row.items()
        }
        for row in rows
    ]


def joint_force(joint: dict[str, float]) -> tuple[float, float, float]:
    """Force of a joint on the block at its right, and its moment about the origin."""
    angle = math.radians(joint["angle_deg"])
    along, outwards = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))
    force = [joint["normal_force"] * along[i] + joint["shear_force"] * outwards[i] for i in range(2)]
    intrados = (joint["x_intrados"], joint["y_intrados"])
    extrados = (joint["x_extrados"], joint["y_extrados"])
    ratio = joint["eccentricity_ratio"]
    point = [((1 + ratio) * intrados[i] + (1 - ratio) * extrados[i]) / 2 for i in range(2)]
    return force[0], force[1], point[0] * force[1] - point[1] * force[0]


def area_and_centre(corners: list[tuple[float, float]]) -> tuple[float, float]:
    """Area of a polygon and the x of its centre of gravity."""
    area = moment = 0.0
    for (x1, y1), (x2, y2) in zip(corners, corners[1:] + corners[:1]):
        cross = x1 * y2 - x2 * y1
        area += cross / 2
        moment += cross * (x1 + x2) / 6
    return abs(area), moment / area


@pytest.mark.parametrize(
    ("arch", "load"),
    [
        ("thickness_ratio = 0.12", 0.0),
        ("thickness_ratio = 0.2, voussoirs = 7, half_angle_deg = 60", 0.0),
        ("thickness_ratio = 0.7, voussoirs = 28, half_angle_deg = 140", 0.0),
        ("thickness_ratio = 0.2, joints_deg = 0, 20, 54.5, 90, radius = 3", 0.0),
        ("thickness_ratio = 0.25", 0.1),
    ],
    ids=["semicircle", "odd", "horseshoe", "uneven", "horizontal"],
)
def test_joint_forces_balance_every_voussoir(tmp_path: Path, arch: str, load: float) -> None:
    text = (
        f"&arch {arch} /\n&joint friction_deg = 80 /\n"
        f"&load horizontal_coefficient = {load} /\n&material unit_weight = 22e3 /\n"
    )
    (row,) = run_deck(tmp_path, text)
    assert row["verdict"] == "stable"
    joints = read_joints(tmp_path)
    total = 0.0
    for left, right in zip(joints, joints[1:]):
        corners = [
            (joint[f"x_{side}"], joint[f"y_{side}"])
            for joint, side in [
                (left, "intrados"),
                (right, "intrados"),
                (right, "extrados"),
                (left, "extrados"),
            ]
        ]
        area, x_centre = area_and_centre(corners)
        weight = 22e3 * area
        y_centre = area_and_centre([(y, x) for x, y in corners])[1]
        moment = -weight * (x_centre + load * y_centre)
        into, out = joint_force(left), joint_force(right)
        radius = max(abs(value) for corner in corners for value in corner)
        assert abs(into[0] - out[0] + load * weight) <= 1e-9 * weight
        assert abs(into[1] - out[1] - weight) <= 1e-9 * weight
        assert abs(into[2] - out[2] + moment) <= 1e-9 * weight * radius
        total += weight
    assert joint_force(joints[0])[1] - joint_force(joints[-1])[1] == pytest.approx(total, rel=1e-9)


@pytest.mark.parametrize("voussoirs", [36, 35])
@pytest.mark.parametrize("search", ["", "&search /\n"], ids=["decided", "searched"])
def test_joints_of_a_symmetric_arch_are_mirrored(tmp_path: Path, voussoirs: int, search: str) -> None:
    text = f"&arch thickness_ratio = 0.12, voussoirs = {voussoirs} /\n{search}"
    run_deck(tmp_path, text)
    joints = read_joints(tmp_path)
    force = max(joint["normal_force"] for joint in joints)
    assert len(joints) == voussoirs + 1
    assert [joint["joint"] for joint in joints] == list(range(1, voussoirs + 2))
    for left, right in zip(joints, reversed(joints)):
        assert left["angle_deg"] == -right["angle_deg"]
        for name in ("x_intrados", "x_extrados"):
            assert left[name] == pytest.approx(-right[name], abs=1e-13)
        for name in ("y_intrados", "y_extrados"):
            assert left[name] == pytest.approx(right[name], abs=1e-13)
        assert left["normal_force"] == pytest.approx(right["normal_force"], abs=1e-9 * force)
        assert left["shear_force"] == pytest.approx(-right["shear_force"], abs=1e-9 * force)
        assert left["eccentricity_ratio"] == pytest.approx(right["eccentricity_ratio"], abs=1e-8)
        assert left["opening_intrados"] == pytest.approx(right["opening_intrados"], abs=1e-9)
        assert left["opening_extrados"] == pytest.approx(right["opening_extrados"], abs=1e-9)
        assert left["slip"] == pytest.approx(-right["slip"], abs=1e-9)
        assert left["state"] == right["state"]


def test_corners_of_joints_lie_on_two_circles(tmp_path: Path) -> None:
    run_deck(tmp_path, "&arch radius = 4, thickness_ratio = 0.3, half_angle_deg = 100 /\n")
    for joint in read_joints(tmp_path):
        angle = math.radians(joint["angle_deg"])
        for side, radius in (("intrados", 4 * 0.85), ("extrados", 4 * 1.15)):
            x, y = radius * math.sin(angle), radius * math.cos(angle)
            assert (joint[f"x_{side}"], joint[f"y_{side}"]) == pytest.approx((x, y), abs=1e-14)


@pytest.mark.parametrize(
    ("arch", "friction"),
    [("thickness_ratio = 0.12", 50), ("thickness_ratio = 0.2", 18), ("thickness_ratio = 0.5", 30)],
)
def test_standing_arch_obeys_the_laws_of_its_joints(tmp_path: Path, arch: str, friction: float) -> None:
    (row,) = run_deck(tmp_path, f"&arch {arch} /\n&joint friction_deg = {friction} /\n")
    assert row["verdict"] == "stable"
    for joint in read_joints(tmp_path):
        limit = math.tan(math.radians(friction)) * joint["normal_force"]
        assert joint["normal_force"] > 0.0
        assert abs(joint["shear_force"]) <= limit * (1.0 + 1e-9)
        assert -1.0 <= joint["eccentricity_ratio"] <= 1.0


@pytest.mark.parametrize("thickness", [0.105, 0.12])
def test_thrust_of_a_hinge_lies_at_its_corner(tmp_path: Path, thickness: float) -> None:
    run_deck(tmp_path, f"&arch thickness_ratio = {thickness} /\n")
    joints = read_joints(tmp_path)
    at_corner = [joint for joint in joints if abs(joint["eccentricity_ratio"]) == 1.0]
    assert at_corner
    for joint in at_corner:
        open_side, closed_side = ("extrados", "intrados")
        if joint["eccentricity_ratio"] < 0.0:
            open_side, closed_side = closed_side, open_side
        assert joint[f"opening_{open_side}"] > 1e-6
        assert abs(joint[f"opening_{closed_side}"]) < 1e-6
    for joint in joints:
        if joint not in at_corner:
            assert max(joint["opening_intrados"], joint["opening_extrados"]) <= 0.0


def test_hinges_of_a_collapse_are_those_of_its_row(tmp_path: Path) -> None:
    (row,) = run_deck(tmp_path, "&arch thickness_ratio = 0.105 /\n")
    joints = read_joints(tmp_path)
    for column, side in (("intrados_hinge_deg", 1.0), ("extrados_hinge_deg", -1.0)):
        turning = [joint for joint in joints if joint["eccentricity_ratio"] == side]
        assert sorted({abs(joint["angle_deg"]) for joint in turning}) == angles(row, column)


@pytest.mark.parametrize(
    "arch", ["thickness_ratio = 0.1", "thickness_ratio = 0.05", "voussoirs = 35, thickness_ratio = 0.09",
             "half_angle_deg = 140, thickness_ratio = 0.2"]
)
def test_collapse_of_a_chain_is_that_of_its_joint_graph(tmp_path: Path, arch: str) -> None:
    # gravity that tilts is left to the joint graph, whose interior point ends at 1e-11
    tilted = "&load gravity_direction_deg = -90.0000000001 /\n&analysis flow = 'associated' /\n"
    run_deck(tmp_path, f"&arch {arch} /\n{tilted}")
    graph = {name: read_table(tmp_path / "deck" / name)[1] for name in ("blocks.csv", "joints.csv")}
    row = run_deck(tmp_path, f"&arch {arch} /\n")[0]
    assert row["verdict"] == "collapsed" and row["factorisations"] == "0"
    for name, columns in (("blocks.csv", ("u", "v")), ("joints.csv", ("normal_force", "shear_force"))):
        chain = read_table(tmp_path / "deck" / name)[1]
        largest = max(abs(value) for row in chain for value in numbers(row, *columns))
        assert len(chain) == len(graph[name]) > 30
        for mine, others in zip(chain, graph[name], strict=True):
            assert numbers(mine, *columns) == pytest.approx(numbers(others, *columns), abs=1e-7 * largest)


def test_sliding_voussoirs_move_outwards_at_the_springings(tmp_path: Path) -> None:
    (row,) = run_deck(tmp_path, "&arch thickness_ratio = 0.2 /\n&joint friction_deg = 0 /\n")
    joints = read_joints(tmp_path)
    assert row["collapse_mode"] == "sliding"
    assert joints[0]["slip"] > 1e-3
    assert joints[-1]["slip"] < -1e-3
    assert all(joint["shear_force"] == 0.0 for joint in joints)


def test_joints_of_every_case_are_written(tmp_path: Path) -> None:
    text = """&arch thickness_ratio = 0.2 /
        &sweep parameter = 'voussoirs', values = 4, 9 /
        &sweep parameter = 'radius', values = 1, 2 /"""
    run_deck(tmp_path, text)
    cases = [joint["case"] for joint in read_joints(tmp_path)]
    assert cases == [1] * 5 + [2] * 5 + [3] * 10 + [4] * 10


@pytest.mark.parametrize("tolerance", ["1e-2", "1e-3", "1e-4"])
def test_coarse_tolerance_is_found_around_the_exact_value(tmp_path: Path, tolerance: str) -> None:
    (tmp_path / "coarse.nml").write_text(f"&joint friction_deg = 90 /\n&search tolerance = {tolerance} /\n")
    assert run_dda("run", "coarse.nml", "--quiet", cwd=tmp_path).returncode == 0
    (row,) = rows_of(tmp_path / "coarse" / "results.csv")
    assert row["verdict"] == "found"
    assert float(row["critical_low"]) < 0.10742413832037053 < float(row["critical_high"])
    width = float(row["critical_high"]) - float(row["critical_low"])
    assert width <= 1.01 * float(tolerance) * float(row["critical"])


# the scene plan


def both_plans(folder: Path, text: str) -> list[tuple[list[Row], list[Row]]]:
    """Rows of results.csv and joints.csv with 3 and with 6 unknowns, side by side."""
    tables = []
    for plan, more in (("3", ""), ("6", "&analysis unknowns = 6 /\n")):
        rows = run_deck(folder, text + more)
        assert {row["unknowns"] for row in rows} == {plan}
        tables.append((rows, read_table(folder / "deck" / "joints.csv")[1]))
    return list(zip(*tables))


SEARCHED = {
    "half angles": "&search /\n&sweep parameter = 'half_angle_deg', values = 20, 45, 90, 130 /\n",
    "friction": "&search /\n&sweep parameter = 'friction_deg', values = 17.5, 19, 21.5, 50 /\n",
    "springings": "&arch half_angle_deg = 145, voussoirs = 58 /\n&search /\n"
    "&sweep parameter = 'friction_deg', values = 60, 70, 85 /\n",
    "push": "&search parameter = 'horizontal_coefficient' /\n"
    "&sweep parameter = 'thickness_ratio', values = 0.12, 0.2 /\n",
    "joint": "&arch joints_deg = 0, 54.5, 90, facet_deg = 0.5 /\n&search /\n"
    "&sweep parameter = 'joints_deg(2)', values = 30, 54.5, 70 /\n",
}


@pytest.mark.parametrize("text", SEARCHED.values(), ids=list(SEARCHED))
def test_critical_values_do_not_depend_on_strain(tmp_path: Path, text: str) -> None:
    (rigid, elastic), _ = both_plans(tmp_path, text)
    for one, other in zip(rigid, elastic, strict=True):
        for name in ("critical", "critical_low", "critical_high", "sliding_share"):
            assert float(one[name]) == pytest.approx(float(other[name]), rel=1e-10, abs=1e-10)
        for name in ("verdict", "collapses_at", "collapse_mode", "intrados_hinge_deg"):
            assert one[name] == other[name]


def test_joint_forces_at_rest_do_not_depend_on_the_plan(tmp_path: Path) -> None:
    text = "&search /\n&sweep parameter = 'half_angle_deg', values = 45, 90, 120 /\n"
    _, (rigid, elastic) = both_plans(tmp_path, text)
    weight = 2240.0 * 9.81 * math.pi * 10.0 * 10.0 * 0.2
    assert len(rigid) == 3 * 37
    # so near to the critical thickness the thrust has a range of the root of what is left
    for one, other in zip(rigid, elastic, strict=True):
        for name in ("normal_force", "shear_force"):
            assert float(one[name]) == pytest.approx(float(other[name]), abs=3e-9 * weight)


@pytest.mark.parametrize("unknowns", [3, 6])
def test_three_thin_voussoirs_stand_in_spite_of_rounding(tmp_path: Path, unknowns: int) -> None:
    text = f"""&arch voussoirs = 3, facet_deg = 1 /
        &joint friction_deg = 20 /
        &analysis unknowns = {unknowns} /
        &sweep parameter = 'thickness_ratio', first = 1.0e-6, last = 1.1e-6, count = 20 /"""
    assert {row["verdict"] for row in run_deck(tmp_path, text)} == {"stable"}


def test_condition_is_reported_where_wanted(tmp_path: Path) -> None:
    text = "&arch thickness_ratio = 0.12 /\n&output condition = .true. /\n"
    rows = run_deck(tmp_path, text + "&sweep parameter = 'unknowns', values = 3, 6 /\n")
    assert [row["unknowns"] for row in rows] == ["3", "6"]
    for row in rows:
        assert 1e3 < float(row["condition"]) < 1e13
    (row,) = run_deck(tmp_path, "&arch thickness_ratio = 0.12 /\n")
    assert "condition" not in row


@pytest.mark.parametrize("unknowns", [3, 6])
@pytest.mark.parametrize("joints", ["0, {w}, 54.5, 90", "0, 54.5, {s}, 90", "0, 54.5, {e}, 90"])
def test_slivers_of_stone_change_nothing(tmp_path: Path, unknowns: int, joints: str) -> None:
    for width in (1e-3, 1e-5, 1e-7):
        places = joints.format(w=width, s=54.5 + width, e=90.0 - width)
        (row,) = run_deck(
            tmp_path,
            f"&arch joints_deg = {places}, facet_deg = 0.5 /\n&search /\n"
            f"&joint friction_deg = 90 /\n&analysis unknowns = {unknowns} /\n",
        )
        low, exact, high = numbers(row, "critical_low", "exact", "critical_high")
        assert low < exact < high
        assert exact == pytest.approx(0.1074776776, abs=1e-9)
        assert high - low < 1e-5 * exact


@pytest.mark.parametrize("young", [1e12, 1e14, 1e15])
def test_moving_blocks_of_stiff_stone_come_to_rest(tmp_path: Path, young: float) -> None:
    text = f"&analysis geometry = 'current' /\n&material young = {young} /\n&search /\n"
    (row,) = run_deck(tmp_path, text + "&joint friction_deg = 90 /\n")
    critical, exact = numbers(row, "critical", "exact")
    shift = 2240.0 * 9.81 * 10.0 / young
    assert abs(critical - exact) < 2.0 * shift + 1e-8 * exact
