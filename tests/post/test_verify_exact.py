"""`voussoir verify --exact`: limits proven in rational arithmetic, and our values inside of them."""

from __future__ import annotations

import math
import random
import re
from fractions import Fraction
from pathlib import Path

import pytest
from block_scene import wall
from dda_command import rows_of
from live_assemblies import random_wall
from test_verify import HEAD, run_scene

from voussoir.command.main import main
from voussoir.verify.rational import Factor, sine_cosine
from voussoir.verify.simplex import find_best

REPOSITORY = Path(__file__).parents[2]
ROUGH = "&joint friction_deg = 90 /\n&search /\n"
#: A proof of a load's limit whose two sides are as near as rounding lets them be
TIGHT = "&search parameter = '{}', tolerance = 1e-11 /\n"
#: Bricks that a push from the left brings down, of two materials and two kinds of joints
LINES = """0.001 8 4 1 0 1 0 0 0
0 0 3 0 1  3 0 3 3 1  3 3 0 3 1  0 3 0 0 1
-0.1 1 3.1 1 2  -0.1 2 3.1 2 3  1.5 0.9 1.5 2.1 2  1 1.9 1 3.1 3
0.2 2.5 2.8 2.5 2
-0.5 0.5 3.5 0.5
"""
MATERIALS = """0 100 2 3 0.01 0.1
2.0 20 1e6 0.2 0 0 0 0 0 0 0 0 0
3.0 45 1e6 0.2 0 0 0 0 0 0 0 0 0
90 0 0  35 0 0  27.5 0 0
"""


def intervals(folder: Path, capsys: pytest.CaptureFixture[str]) -> list[tuple[float, float]]:
    """Proven intervals of all cases of a folder."""
    capsys.readouterr()
    assert main(["verify", str(folder), "--exact"]) == 0, capsys.readouterr().out
    found = re.findall(r"critical from (\S+) to (\S+), proven", capsys.readouterr().out)
    return [(float(low), float(high)) for low, high in found]


@pytest.mark.parametrize("degrees", ["0", "30", "-54.5", "90", "135", "250.25", "-361", "1e-30"])
def test_sine_and_cosine_have_forty_digits(degrees: str) -> None:
    sine, cosine = sine_cosine(Fraction(degrees))
    angle = math.radians(float(degrees))
    assert float(sine) == pytest.approx(math.sin(angle), abs=1e-15)
    assert float(cosine) == pytest.approx(math.cos(angle), abs=1e-15)
    assert abs(sine**2 + cosine**2 - 1) < Fraction(3, 10**40)
    # three times the angle
    assert abs(sine_cosine(3 * Fraction(degrees))[0] - (3 * sine - 4 * sine**3)) < Fraction(12, 10**40)


@pytest.mark.parametrize("seed", range(10))
def test_sparse_equations_are_solved_exactly(seed: int) -> None:
    source = random.Random(seed)
    columns = [{i: Fraction(source.randint(1, 99), source.randint(1, 99)) for i in {j, *source.sample(range(20), 3)}}
               for j in range(20)]
    x = [Fraction(source.randint(-9, 9), 7) for _ in range(20)]
    right = [sum((column.get(i, 0) * value for column, value in zip(columns, x)), Fraction(0)) for i in range(20)]
    factor = Factor(columns)
    assert factor.solve(right) == x
    turned = [sum((value * x[i] for i, value in column.items()), Fraction(0)) for column in columns]
    assert factor.solve_transposed(turned) == x


def test_the_best_vertex_is_a_fraction() -> None:
    """Most of z where x + y + z = 1 and x - 3 z = 0, y free to be nothing: a quarter."""
    one = Fraction(1)
    found = find_best([{0: one, 1: one}, {0: one}, {0: one, 1: Fraction(-3)}], [one, Fraction(0)], 1)
    assert found == [Fraction(3, 4), 0, Fraction(1, 4)]


def test_a_block_turns_at_an_exact_push(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A block of 2 by 2 and unit weight 3, pushed by 1 at its top: it turns at 12 times 1 over 2."""
    blocks = "block fixed\n-5 -1\n5 -1\n5 0\n-5 0\nblock\n0 0\n2 0\n2 2\n0 2\nlive block 2 0 2 1 0\n"
    material = "&material unit_weight = 3 /\n&joint friction_deg = 60 /\n"
    ((low, high),) = intervals(run_scene(tmp_path, HEAD + material + TIGHT.format("load_factor"), blocks), capsys)
    assert low <= 6.0 <= high and high - low < 1e-12 * 6.0


@pytest.mark.parametrize("table", ["table1", "table2", "table3", "table4"])
def test_arches_of_the_paper_are_proven(tmp_path: Path, table: str, capsys: pytest.CaptureFixture[str]) -> None:
    rows = [row for row in rows_of(REPOSITORY / "tests" / "data" / "paper_exact.csv") if row["table"] == table]
    joints = table in ("table2", "table3")
    names = ("arch%joints_deg(2)", "beta_imposed_deg") if joints else ("voussoirs", "blocks")
    deck = f"&sweep parameter = '{names[0]}', values = {', '.join(row[names[1]] for row in rows)} /\n"
    if joints:
        deck += f"&arch joints_deg = 0, 5, {rows[0]['alpha_deg']}, facet_deg = 0.5 /\n"
    else:
        angles = ", ".join(row["alpha_deg"] for row in rows)
        deck += f"&sweep parameter = 'half_angle_deg', values = {angles}, linked = .true. /\n"
    found = intervals(run_scene(tmp_path, ROUGH + deck), capsys)
    assert len(found) == len(rows)
    for (low, high), row in zip(found, rows):
        assert low < float(row["eta_exact"]) < high
        assert high - low < 1e-12


@pytest.mark.parametrize("seed", range(14))
def test_limits_of_walls_are_proven(tmp_path: Path, seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    source = random.Random(seed)
    friction = f"&joint friction_deg = {source.uniform(20.0, 42.0)!r} /\n"
    folder = run_scene(tmp_path, HEAD + friction + TIGHT.format("load_factor"), random_wall(source))
    ((low, high),), (row,) = intervals(folder, capsys), rows_of(folder / "results.csv")
    assert low <= (float(row["exact_low"]) + float(row["exact_high"])) / 2.0 <= high
    assert high - low < 1e-12 * max(1.0, high)


@pytest.mark.parametrize(("units", "courses"), [(2, 4), (3, 5), (4, 4), (3, 8), (4, 8), (5, 6)])
def test_limits_of_brick_walls_are_proven(
    tmp_path: Path, units: int, courses: int, capsys: pytest.CaptureFixture[str]
) -> None:
    deck = HEAD + "&joint friction_deg = 33.0 /\n" + TIGHT.format("horizontal_coefficient")
    ((low, high),) = intervals(run_scene(tmp_path, deck, wall(courses, units, 2.0, 1.0, 1.0)), capsys)
    assert 0.5 < low < high < 0.65 and high - low < 1e-12


@pytest.mark.parametrize(
    ("deck", "words"),
    [
        ("&arch thickness_ratio = 0.12 /\n", "forces carry the loads"),
        ("&arch thickness_ratio = 0.12 /\n&load horizontal_coefficient = 0.3 /\n", "the loads drive a mechanism"),
        ("&arch half_angle_deg = 75 /\n&search parameter = 'gravity_direction_deg', low = -90, high = -45 /\n",
         "gravity_direction_deg is critical"),
        ("&arch half_angle_deg = 60, voussoirs = 15 /\n&search parameter = 'load_factor' /\n"
         "&vehicle axles = 2e4, 1e4, spacings = 1.5, worst = .true. /\n", "load_factor is critical"),
        ("&arch voussoirs = 12 /\n&joint friction_deg = 22 /\n&search /\n", "thickness_ratio is critical"),
        ("&arch voussoirs = 12, springing = 'no-slip' /\n&load horizontal_coefficient = 0.1 /\n&search /\n",
         "forces carry the loads at thickness_ratio = 0.13137424"),
    ],
)
def test_what_is_proven_is_said(tmp_path: Path, deck: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path, deck)
    capsys.readouterr()
    assert main(["verify", str(folder), "--exact"]) == 0
    out = capsys.readouterr().out
    assert words in out and "proven" in out


def test_a_wrong_bound_is_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A limit in the row that is off by its eleventh digit, with forces that are right for it but for rounding."""
    folder = run_scene(tmp_path, HEAD + TIGHT.format("load_factor"))
    text = (folder / "results.csv").read_text()
    (row,) = rows_of(folder / "results.csv")
    low, high = (float(row[name]) for name in ("exact_low", "exact_high"))
    for name, value in (("exact_low", low * (1 + 1e-11)), ("exact_high", high * (1 + 2e-11))):
        text = text.replace(row[name], repr(value))
        for proof in ("proof_forces", "proof_motion"):
            path = folder / f"{proof}.csv"
            path.write_text(path.read_text().replace(row[name], repr(value)))
    (folder / "results.csv").write_text(text)
    assert main(["verify", str(folder), "--ignore-sums"]) == 0
    assert main(["verify", str(folder), "--ignore-sums", "--exact"]) == 1
    assert "by rational arithmetic" in capsys.readouterr().out


def test_too_many_joints_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = run_scene(tmp_path, "&arch voussoirs = 200, thickness_ratio = 0.12 /\n")
    assert main(["verify", str(folder)]) == 0
    assert main(["verify", str(folder), "--exact"]) == 2
    assert "at most 200 joints" in capsys.readouterr().err


@pytest.mark.parametrize("keys", ["", "&material unit_weight = 30 /\n", "&joint friction_deg = 20 /\n"])
def test_lines_with_materials_of_a_file_are_proven(
    tmp_path: Path, keys: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "x.geo").write_text(LINES)
    (tmp_path / "x.ana").write_text(MATERIALS)
    head = "&scene kind = 'lines', geometry = 'x.geo', analysis = 'x.ana' /\n"
    folder = run_scene(tmp_path, head + keys + TIGHT.format("horizontal_coefficient"))
    assert len(intervals(folder, capsys)) == 1
    for name, old, new in (("x.ana", "20 1e6", "21 1e6"), ("x.ana", "35 0 0", "36 0 0"), ("x.ana", "27.5", "28"),
                           ("x.geo", "1.5 2.1 2", "1.5 2.1 3")):
        text = (tmp_path / name).read_text()
        assert old in text
        (tmp_path / name).write_text(text.replace(old, new))
        matters = "friction" not in keys if name == "x.geo" or old != "20 1e6" else "unit_weight" not in keys
        assert main(["verify", str(folder), "--quiet"]) in ((0, 1) if matters else (0,))
        (tmp_path / name).write_text(text)
