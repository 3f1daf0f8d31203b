"""Springings that &support displaces: as blocks by hand, as far as linear programmes let them, thrusts by limits."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda, run_deck

DATA = Path(__file__).resolve().parents[1] / "data"
RADIUS = 10.0
#: How &support says the ways of make_led_supports.py for each metre
WAYS = {
    "apart": "left_dx = -0.5, right_dx = 0.5",
    "one": "right_dx = 1.0",
    "together": "left_dx = 0.5, right_dx = -0.5",
    "down": "right_dy = -1.0",
    "up": "right_dy = 1.0",
    "oblique": "right_dx = 0.8, right_dy = -0.6",
}
ARCH = "&arch radius = 10, thickness_ratio = {}, half_angle_deg = {}, voussoirs = {} /\n"
MOVED = "&joint friction_deg = 85 /\n&material young = 5e11 /\n&analysis geometry = 'current' /\n"

Row = dict[str, str]
Point = tuple[float, float]


def run(folder: Path, deck: str) -> Row:
    """The row of the only case of a deck."""
    run_deck(folder, deck, "--out", "out", "--quiet")
    return table(folder, "results")[0]


def table(folder: Path, name: str) -> list[Row]:
    """Rows of a table."""
    return rows_of(folder / "out" / f"{name}.csv")


def blocks_by_hand(ratio: float, half_angle_deg: float, count: int, ways: tuple[Point, Point]) -> str:
    """The same arch as a file of blocks, with a square block behind each springing joint, led at the joint's ends.

    Corners are computed from the left end, those at the right of a voussoir from the right end: they coincide but for
    round-off.
    """
    inner, outer, half = RADIUS * (1 - ratio / 2), RADIUS * (1 + ratio / 2), math.radians(half_angle_deg)

    def place(radius: float, joint: int, from_right: bool = False) -> Point:
        angle = half - 2 * half * (count - joint) / count if from_right else -half + 2 * half * joint / count
        return radius * math.sin(angle), radius * math.cos(angle)

    def polygon(*corners: Point) -> str:
        return "block\n" + "".join(f"{x!r} {y!r}\n" for x, y in corners)

    text = [polygon(place(inner, i), place(outer, i), place(outer, i + 1, True), place(inner, i + 1, True))
            for i in range(count)]
    for joint, (x, y) in zip((0, count), ways):
        lower, upper = place(inner, joint), place(outer, joint)
        along = upper[0] - lower[0], upper[1] - lower[1]
        side = 1.0 if joint else -1.0
        out = side * along[1], -side * along[0]
        text.append(polygon(lower, upper, *((at[0] + out[0], at[1] + out[1]) for at in (upper, lower))))
        number = count + (2 if joint else 1)
        text += [f"displacement block {number} {at[0]!r} {at[1]!r} {x!r} {y!r}\n" for at in (lower, upper)]
    return "".join(text)


@pytest.mark.parametrize(("support", "ways"), [
    ("left_dx = -5e-3, right_dx = 5e-3", ((-5e-3, 0.0), (5e-3, 0.0))),
    ("left_dx = 0, right_dx = 4e-3, right_dy = -8e-3", ((0.0, 0.0), (4e-3, -8e-3)))])
def test_springings_collapse_as_blocks_by_hand(tmp_path: Path, support: str, ways: tuple[Point, Point]) -> None:
    search = "&search parameter = 'displacement_factor', low = 0, high = 1000, tolerance = 1e-2 /\n"
    generated = run(tmp_path, ARCH.format(0.15, 80, 15) + f"&support {support} /\n" + MOVED + search)
    forces = [[float(row[f"force_{axis}"]) for axis in "xy"] for row in table(tmp_path, "joints")]
    (tmp_path / "x.blocks").write_text(blocks_by_hand(0.15, 80.0, 15, ways))
    by_hand = run(tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n" + MOVED + search)
    assert generated["verdict"] == by_hand["verdict"] == "found"
    assert float(generated["critical"]) == pytest.approx(float(by_hand["critical"]), rel=1e-9)
    # the joints of the last equilibrium carry the same
    largest = max(math.hypot(*force) for force in forces)
    for force, row in zip(forces, table(tmp_path, "joints"), strict=True):
        assert math.hypot(*force) == pytest.approx(
            math.hypot(float(row["force_x"]), float(row["force_y"])), abs=1e-6 * largest)


@pytest.mark.parametrize(("count", "half_angle_deg", "support", "ways"), [
    (15, 80.0, "left_dx = -5e-3, right_dx = 5e-3", ((-5e-3, 0.0), (5e-3, 0.0))),
    (11, 60.0, "left_dx = -15e-3", ((-15e-3, 0.0), (0.0, 0.0))),
    (9, 49.7, "left_dx = -8.92e-3, left_dy = 7.81e-3, right_dx = -6.2e-3", ((-8.92e-3, 7.81e-3), (-6.2e-3, 0.0))),
    (16, 76.0, "left_dy = -6.08e-3, right_dx = -3.4e-3, right_dy = 2.84e-3", ((0.0, -6.08e-3), (-3.4e-3, 2.84e-3))),
    (16, 70.0, "right_dx = 4e-3, right_dy = -8e-3", ((0.0, 0.0), (4e-3, -8e-3))),
    (9, 85.0, "left_dy = -6e-3, right_dx = -9e-3", ((0.0, -6e-3), (-9e-3, 0.0)))])
def test_displaced_springings_move_voussoirs_as_blocks_by_hand(
    tmp_path: Path, count: int, half_angle_deg: float, support: str, ways: tuple[Point, Point]
) -> None:
    """The corners by hand differ by round-off, which must not choose between two corners that coincide."""
    rest = MOVED + "&output vtu = F, joints = T /\n"
    (tmp_path / "x.blocks").write_text(blocks_by_hand(0.15, half_angle_deg, count, ways))
    motions, forces = [], []
    for deck in (ARCH.format(0.15, half_angle_deg, count) + f"&support {support} /\n",
                 "&scene kind = 'blocks', geometry = 'x.blocks' /\n"):
        run(tmp_path, deck + rest)
        motions.append({(row["block"], f"{float(row['x']):.6f}", f"{float(row['y']):.6f}"):
                        (float(row["u"]), float(row["v"])) for row in table(tmp_path, "blocks")})
        forces.append([math.hypot(float(row["force_x"]), float(row["force_y"])) for row in table(tmp_path, "joints")])
    for place in [place for place in motions[0] if int(place[0]) <= count]:
        assert motions[0][place] == pytest.approx(motions[1][place], abs=1e-11)
    assert forces[0] == pytest.approx(forces[1], abs=1e-9 * max(forces[0]))


LED = [tuple(row.values()) for row in rows_of(DATA / "led_supports.csv")]


@pytest.mark.parametrize(("count", "ratio", "half_angle", "way", "longest"), LED)
def test_springings_go_as_far_as_linear_programmes_let_them(
    tmp_path: Path, count: str, ratio: str, half_angle: str, way: str, longest: str
) -> None:
    beyond = 1.3 * float(longest)
    row = run(tmp_path, ARCH.format(ratio, half_angle, count)
              + f"&support {WAYS[way]} /\n&load displacement_factor = {beyond!r} /\n" + MOVED)
    assert row["verdict"] == "collapsed"
    # the path lasts from -1 to 0
    assert (1.0 + float(row["path_time"])) * beyond == pytest.approx(float(longest), rel=1e-3)


@pytest.mark.parametrize(("support", "limit"), [
    ("right_dx = 0.1", "thrust_min"), ("left_dx = -0.05, right_dx = 0.05", "thrust_min"),
    ("right_dx = -0.1", "thrust_max"), ("left_dx = 0.1", "thrust_max")])
def test_an_arch_spread_has_its_least_thrust_and_an_arch_squeezed_its_greatest(
    tmp_path: Path, support: str, limit: str
) -> None:
    row = run(tmp_path, ARCH.format(0.15, 90, 16) + f"&support {support} /\n&joint friction_deg = 80 /\n"
              "&output thrust_joint = 8 /\n")
    assert row["verdict"] == "stable"
    crown = min(table(tmp_path, "joints"), key=lambda joint: abs(float(joint["x_intrados"])))
    assert abs(float(crown["force_x"])) == pytest.approx(float(row[limit]), rel=1e-8)


def test_a_springing_turns_about_the_middle_of_its_joint(tmp_path: Path) -> None:
    """Both ends of the joint, half of the thickness away, after a settlement and a turn; the factor scales both."""
    angle = math.radians(2.0)
    run(tmp_path, ARCH.format(0.2, 60, 8) + "&support right_dy = -0.005, right_rotation_deg = 1 /\n"
        "&load displacement_factor = 2 /\n" + MOVED + "&output vtu = F /\n")
    corners = [row for row in table(tmp_path, "blocks") if row["block"] == "10"]
    half = math.radians(60.0)
    for radius in (9.0, 11.0):
        x, y = radius * math.sin(half), radius * math.cos(half)
        (row,) = [row for row in corners if math.hypot(float(row["x"]) - x, float(row["y"]) - y) < 1e-9]
        arm = (radius - 10.0) * math.sin(half), (radius - 10.0) * math.cos(half)
        sine, cosine = math.sin(angle), math.cos(angle)
        assert float(row["u"]) == pytest.approx(arm[0] * (cosine - 1) - arm[1] * sine, abs=1e-7)
        assert float(row["v"]) == pytest.approx(arm[0] * sine + arm[1] * (cosine - 1) - 0.01, abs=1e-7)


def test_a_single_springing_is_searched_by_its_own_key(tmp_path: Path) -> None:
    """Row `one` of led_supports.csv: 1.4 m to either side of the answer."""
    (longest,) = [float(row[-1]) for row in LED if row[0] == "9"]
    row = run(tmp_path, ARCH.format(0.16, 75, 9) + MOVED
              + "&search parameter = 'right_dx', low = 1.1, high = 3.9, tolerance = 1e-3 /\n")
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(longest, rel=2e-3)


@pytest.mark.parametrize(("deck", "message"), [
    ("&arch buttress_width = 3, buttress_height = 2 /\n&support right_dx = 1 /\n",
     "x.nml:1: error: arch%buttress_width: expected springings that &support can displace, got buttresses; "
     "remove one of the two"),
    ("&scene kind = 'blocks', geometry = 'x.blocks' /\n&support right_dx = 1 /\n",
     "x.nml:2: error: &support needs an arch, got scene%kind = 'blocks'; remove it, and add displacement lines to a "
     "file of blocks"),
    ("&arch voussoirs = 8 /\n&load displacement_factor = 2 /\n",
     "x.nml:2: error: load%displacement_factor needs a prescribed displacement, got none; add &support or a "
     "displacement line of a file of blocks")])
def test_what_cannot_be_displaced_is_refused(tmp_path: Path, deck: str, message: str) -> None:
    (tmp_path / "x.blocks").write_text("block fixed\n0 0\n1 0\n1 1\n0 1\n")
    (tmp_path / "x.nml").write_text(deck)
    done = run_dda("run", "x.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(message)


def test_an_exported_arch_has_its_displacements(tmp_path: Path) -> None:
    deck = ARCH.format(0.15, 80, 15).replace("thickness_ratio = 0.15", "thickness = 1.5") + \
        "&support right_dx = 0.3, right_rotation_deg = 1 /\n"
    kept = run(tmp_path, deck + MOVED)
    assert run_dda("export", "x.nml", cwd=tmp_path).returncode == 0
    exported = run(tmp_path, "&scene kind = 'blocks', geometry = 'x.blocks' /\n" + MOVED)
    for name in ("verdict", "steps", "path_time"):
        assert exported[name] == kept[name]
