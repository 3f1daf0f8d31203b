"""Mode 'limerick': the original's verdicts and searches, and what the deck check refuses."""

from __future__ import annotations

import math
import re
import statistics
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda, run_deck
from limerick_files import HAS_XML, HELD

ROOT = Path(__file__).parents[2]
DECKS = ROOT / "input" / "limerick"
MODE = "&analysis mode = 'limerick', steps = 20000, collapse_displacement = 0.5 /\n"


def results_of(folder: Path, text: str, *options: str) -> list[dict[str, str]]:
    """Rows of results.csv of a deck, by case."""
    run_deck(folder, text, "--out", "out", "--quiet", *options, name="deck")
    return read_rows(folder / "out" / "results.csv")


def read_rows(file: Path) -> list[dict[str, str]]:
    """Rows of a table, comments left out, by case where there are cases."""
    rows = rows_of(file)
    return sorted(rows, key=lambda row: int(row.get("case", 0)))


def test_twelve_voussoirs_fall_and_stand_where_they_do_in_the_original(tmp_path: Path) -> None:
    done = run_dda("run", DECKS / "both_sides.nml", "--out", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    rows = read_rows(tmp_path / "results.csv")
    assert [row["verdict"] for row in rows] == ["collapsed", "stable"]
    # the original, too, falls after about a thousand steps, and comes to rest within two thousand
    assert 1000 < int(rows[0]["steps"]) < 1300
    assert int(rows[1]["steps"]) == 2000
    assert all(row["mode"] == "limerick" and row["geometry"] == "current" for row in rows)
    assert rows[0]["collapse_mode"] == "rotational"
    assert rows[0]["intrados_hinge_deg"] == "60"
    assert rows[0]["springing_hinge"] == "extrados"


def test_joints_of_the_standing_arch_carry_its_weight(tmp_path: Path) -> None:
    results_of(tmp_path, "&arch voussoirs = 12 /\n&material unit_weight = 22e3 /\n" + MODE)
    joints = rows_of(tmp_path / "out" / "joints.csv")
    # trapezoids: the area of the ring is that of the chords
    area = 12 * 0.5 * 0.2588190451025208 * (10.75**2 - 9.25**2)
    assert len(joints) == 13
    for end in (joints[0], joints[-1]):
        assert float(end["normal_force"]) == pytest.approx(22e3 * area / 2, rel=0.01)
    shear = [float(joint["shear_force"]) for joint in joints]
    assert shear[0] == pytest.approx(-shear[-1], rel=0.01)
    # the thrust is horizontal at the crown
    assert shear[6] == pytest.approx(0.0, abs=0.01 * 22e3 * area)


def test_search_finds_the_limit_of_the_original(tmp_path: Path) -> None:
    (row,) = results_of(
        tmp_path, "&arch voussoirs = 12 /\n" + MODE + "&search low = 0.1087, high = 0.10895, tolerance = 8e-4 /\n")
    assert row["verdict"] == "found"
    assert row["collapses_at"] == "low"
    assert float(row["critical_low"]) < 0.10880 < float(row["critical_high"])
    assert float(row["exact"]) == pytest.approx(0.104857, abs=1e-6)
    assert float(row["relative_error"]) == pytest.approx(0.038, abs=0.001)


def test_less_penetration_brings_the_limit_to_the_exact_value(tmp_path: Path) -> None:
    deck = "&arch voussoirs = 12 /\n" + MODE + "&search tolerance = 1e-3 /\n"
    (coarse,) = results_of(tmp_path, deck + "&limerick penetration_ratio = 8e-4 /\n")
    (fine,) = results_of(tmp_path, deck + "&limerick penetration_ratio = 1e-4 /\n")
    # the excess grows with the penetration: eight times as much, about eight times the excess
    assert 6.0 < float(coarse["relative_error"]) / float(fine["relative_error"]) < 10.0


def test_limit_is_linear_in_the_penetration_and_exact_without_any(tmp_path: Path) -> None:
    # of 36 voussoirs, whose searches take long, four of six penetrations
    done = run_dda("run", DECKS / "penetration.nml", "--out", tmp_path, "--quiet", "--set", "search%tolerance=1e-3",
                   "--cases", "1-8,10,12")
    assert done.returncode == 0, done.stderr
    slopes = []
    for voussoirs, count in (("12", 6), ("36", 4)):
        rows = [row for row in read_rows(tmp_path / "results.csv") if row["voussoirs"] == voussoirs]
        ratio = [float(row["penetration_ratio"]) for row in rows]
        limit = [float(row["critical"]) / float(row["exact"]) for row in rows]
        line = statistics.linear_regression(ratio, limit)
        assert len(rows) == count
        assert line.intercept == pytest.approx(1.0, abs=0.005)
        assert limit == pytest.approx([line.slope * x + line.intercept for x in ratio], abs=0.004)
        slopes.append(line.slope)
    # more joints close more
    assert slopes[1] > 1.5 * slopes[0]


def test_jobs_do_not_change_a_bit(tmp_path: Path) -> None:
    deck = MODE + "&arch voussoirs = 8 /\n&sweep parameter = 'thickness_ratio', values = 0.1, 0.12 /\n"
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    one = results_of(tmp_path / "one", deck)
    two = results_of(tmp_path / "two", deck, "--jobs", "2")
    for row in one + two:
        del row["seconds"]
    assert one == two


def test_steps_that_are_spent_leave_it_stable_with_a_remark(tmp_path: Path) -> None:
    (row,) = results_of(
        tmp_path,
        "&arch voussoirs = 12, thickness_ratio = 0.1 /\n"
        "&analysis mode = 'limerick', steps = 50, collapse_displacement = 0.5 /\n",
    )
    assert row["verdict"] == "stable"
    assert "still moving" in (tmp_path / "out" / "log.txt").read_text()


def test_plan_says_the_half_size_that_all_is_compared_with(tmp_path: Path) -> None:
    (tmp_path / "deck.nml").write_text(MODE + "&arch voussoirs = 12, thickness_ratio = 0.12 /\n")
    done = run_dda("check", "deck.nml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    # radius, half the thickness, overhang: 10 + 0.6 + 4.3
    half_size = re.search(r"half size\s+(\S+) m", done.stdout)
    assert half_size is not None
    assert float(half_size[1]) == pytest.approx(14.9, rel=1e-12)
    assert "12 and 2 abutments" in done.stdout
    assert "84 in all" in done.stdout


def block_on_slope(folder: Path, friction: float) -> str:
    """Write a block on a slope of 20 degrees as files of lines; gives the group &scene that names them."""
    turn = complex(math.cos(math.radians(20)), math.sin(math.radians(20)))

    def line(*ends: complex) -> str:
        places = [end * turn for end in ends]
        return " ".join(f"{place.real!r} {place.imag!r}" for place in places) + " 1"

    base = [-4 - 1j, 4 - 1j, 4 + 0j, -4 + 0j]
    block = [-1 + 0j, 1 + 0j, 1 + 1j, -1 + 1j]
    sides = [line(base[i], base[(i + 1) % 4]) for i in range(4)]
    sides += [line(block[i], block[i + 1]) for i in (1, 2)] + [line(block[3], block[0])]
    held = [place * turn for place in (-3 - 0.5j, 3 - 0.5j)]
    points = [f"{p.real!r} {p.imag!r} {p.real!r} {p.imag!r}" for p in held]
    head = ["0.001", f"{len(sides)} 0", "0", "0", f"{len(points)} 0 0 0"]
    (folder / "slope.geo").write_text("\n".join(head + sides + points) + "\n")
    material = "2.0 20.0 1e6 0.2 0 0 0 0 0 0 0 0 0"
    (folder / "slope.ana").write_text(f"0 3000 1 1 0.001 0.01\n{material}\n{friction} 0 0\n")
    return "&scene kind = 'lines', geometry = 'slope.geo', analysis = 'slope.ana' /\n"


def test_friction_of_a_file_is_searched(tmp_path: Path) -> None:
    (row,) = results_of(
        tmp_path,
        block_on_slope(tmp_path, 50.0) + "&analysis mode = 'limerick', steps = 40000 /\n"
        "&search parameter = 'friction_deg', low = 10, high = 30, tolerance = 1e-2 /\n",
    )
    assert row["verdict"] == "found"
    assert float(row["critical"]) == pytest.approx(20.0, rel=0.01)


@pytest.mark.parametrize("search", [False, True])
def test_pictures_of_a_static_run_go_evenly_to_the_collapse(tmp_path: Path, search: bool) -> None:
    arch = "&arch voussoirs = 12, thickness_ratio = 0.09 /\n&output frames = 5 /\n"
    results_of(tmp_path, arch + MODE + ("&search low = 0.09, high = 0.13, tolerance = 0.02 /\n" if search else ""))
    frames = read_rows(tmp_path / "out" / "frames.csv")
    numbers = sorted({int(row["frame"]) for row in frames})
    assert numbers == list(range(len(numbers)))
    assert 5 <= len(numbers) <= 7
    first = {(row["block"], row["vertex"]): row for row in frames if row["frame"] == "0"}
    way = [
        max(
            math.dist(*((float(r["x"]), float(r["y"])) for r in (row, first[row["block"], row["vertex"]])))
            for row in frames
            if int(row["frame"]) == number
        )
        for number in numbers
    ]
    assert way[0] == 0.0
    assert way[-1] > 0.5
    assert [round(value / 0.1) for value in way[:5]] == [0, 1, 2, 3, 4]


ARCHES = HELD / "arches"


@pytest.mark.skipif(not ARCHES.is_dir(), reason=f"{ARCHES} is not here")
@pytest.mark.skipif(not HAS_XML, reason="the program was built without libxml2")
@pytest.mark.parametrize("name", sorted(path.stem for path in ARCHES.glob("*.geo")))
def test_held_files_stand_and_fall_as_in_the_original(tmp_path: Path, name: str) -> None:
    (row,) = results_of(
        tmp_path,
        f"&scene kind = 'lines', geometry = '{ARCHES / name}.geo', "
        f"analysis = '{ARCHES / 'arch20000.ana'}' /\n"
        "&analysis mode = 'limerick', collapse_displacement = 0.5 /\n",
    )
    assert row["verdict"] == ("stable" if "_hi_" in name else "collapsed")


def test_exported_arch_falls_as_the_one_of_the_deck(tmp_path: Path) -> None:
    arch = "&arch voussoirs = 12, thickness_ratio = 0.108773 /\n"
    (tmp_path / "arch.nml").write_text(arch)
    done = run_dda("export", "arch.nml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    ends = []
    for scene in (arch, "&scene kind = 'lines', geometry = 'arch.geo' /\n"):
        (row,) = results_of(tmp_path, scene + MODE)
        ends.append((row["verdict"], int(row["steps"])))
    assert ends[0][0] == ends[1][0] == "collapsed"
    assert ends[1][1] == pytest.approx(ends[0][1], rel=0.02)
