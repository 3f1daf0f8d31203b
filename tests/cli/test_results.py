"""Tables that dda run writes: columns, verdicts, brackets, sweeps, collapse modes, joints."""

from __future__ import annotations

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


# sweeps


def test_no_slip_springings_change_the_answer(tmp_path: Path) -> None:
    text = """&arch thickness_ratio = 0.12 /
        &joint friction_deg = 20 /
        &sweep parameter = 'springing', texts = 'frictional', 'no-slip' /"""
    assert [row["verdict"] for row in run_deck(tmp_path, text)] == ["collapsed", "stable"]


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


# the scene plan


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
