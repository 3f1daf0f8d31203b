"""Vehicles of a list, convoys and effective widths: as axles per metre of depth that are worked out by hand."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import run_dda
from test_live_loads import SEARCH, rows

ARCH = (
    "&arch shape = 'segmental', span = 5, rise = 1.4, thickness = 0.4, voussoirs = 14 /\n"
    "&joint friction_deg = 35 /\n&material unit_weight = 20e3 /\n"
)
LIST = (
    "name,axles_kN,spacings_m,track_m,wheel_width_m,length_m,source\n"
    'axle,90,,,,,"an axle, alone"\n'
    "lorry,40 90,2.1,2.0,0.4,0.2,hand\n"
)
LORRY, LENGTH = (40e3, 90e3), 0.2


def by_hand(axles: tuple[float, ...], spacings: tuple[float, ...], width: float, length: float = LENGTH) -> str:
    """Keys of &vehicle: axle loads over a width."""
    loads = ", ".join(repr(axle / width) for axle in axles)
    gaps = f", spacings = {', '.join(map(repr, spacings))}" if spacings else ""
    return f"axles = {loads}{gaps}, length = {length}"


def factor(folder: Path, vehicle: str, more: str = "", place: str = "position = -3.3") -> float:
    """Load factor of a vehicle at a position."""
    (folder / "list.csv").write_text(LIST)
    (row,) = rows(folder, ARCH + more + f"&vehicle {vehicle}, {place} /\n" + SEARCH, head="")
    assert row["verdict"] == "found"
    return float(row["critical"])


@pytest.mark.parametrize(
    ("height", "spread", "width"),
    [
        (None, 0.5, 0.8),  # two wheels of 0.4 m
        (0.5, 0.5, 1.8),  # two strips of 0.9 m
        (1.6, 0.5, 4.0),  # strips of 2 m meet at the track of 2 m
        (2.5, 0.5, 4.9),  # and overlap: 0.4 + 2.5 + 2
        (0.5, 1.0, 2.8),
    ],
)
def test_wheels_spread_to_either_side_until_they_overlap(
    tmp_path: Path, height: float | None, spread: float, width: float
) -> None:
    fill = "" if height is None else f"&fill height = {height}, unit_weight = 18e3, spread = {spread} /\n"
    found = factor(tmp_path, "list = 'list.csv', name = 'lorry'", fill)
    assert found == pytest.approx(factor(tmp_path, by_hand(LORRY, (2.1,), width), fill), rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "width"),
    [
        ("effective_width = 2.5", 2.5),
        ("track_width = 0.1", 0.5),  # strips of 0.4 m, 0.1 m apart, overlap
        ("wheel_width = 0.6", 1.2),
        ("track_width = 5, wheel_width = 0.25", 0.5),
    ],
)
def test_keys_of_the_deck_take_precedence_over_the_list(tmp_path: Path, keys: str, width: float) -> None:
    hand = factor(tmp_path, by_hand(LORRY, (2.1,), width))
    assert factor(tmp_path, f"list = 'list.csv', name = 'lorry', {keys}") == pytest.approx(hand, rel=1e-12)
    own = "axles = 40e3, 90e3, spacings = 2.1, length = 0.2"
    sizes = "".join(f", {key} = {size}" for key, size in (("track_width", 2), ("wheel_width", 0.4)) if key not in keys)
    assert factor(tmp_path, f"{own}{sizes}, {keys}") == pytest.approx(hand, rel=1e-12)


def test_a_row_without_sizes_takes_the_defaults(tmp_path: Path) -> None:
    hand = factor(tmp_path, by_hand((90e3,), (), 0.6, 0.3), place="position = -1")
    found = factor(tmp_path, "list = 'list.csv', name = 'axle'", place="position = -1")
    assert found == pytest.approx(hand, rel=1e-12)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_convoy_is_vehicles_in_a_row(tmp_path: Path, count: int) -> None:
    """The last vehicle is on the arch."""
    gaps, place = (2.1,) + (1.3, 2.1) * (count - 1), f"position = {-3.3 - 3.4 * (count - 1)}"
    hand = factor(tmp_path, by_hand(LORRY * count, gaps, 0.8), place=place)
    for vehicle in ("list = 'list.csv', name = 'lorry'", by_hand(LORRY, (2.1,), 0.8)):
        found = factor(tmp_path, f"{vehicle}, convoy = {count}, convoy_gap = 1.3", place=place)
        assert found == pytest.approx(hand, rel=1e-12)


@pytest.mark.parametrize("count", [1, 2])
def test_the_worst_of_a_convoy_is_the_least_over_positions_both_ways(tmp_path: Path, count: int) -> None:
    """To 1e-6 of a grid of positions, and a fine one about the worst position and its mirror image."""
    fill = "&fill height = 0.4, unit_weight = 18e3 /\n"
    (tmp_path / "list.csv").write_text(LIST)
    vehicle = f"&vehicle list = 'list.csv', name = 'lorry', convoy = {count}, convoy_gap = 1.5, worst = T /\n"
    (worst,) = rows(tmp_path, ARCH + fill + vehicle + SEARCH, head="")
    place, gaps = float(worst["worst_position"]), (2.1, 1.5, 2.1)[: 2 * count - 1]
    least = []
    for axles, spacings in ((LORRY * count, gaps), ((LORRY * count)[::-1], gaps[::-1])):
        near = [middle + 0.001 * i for middle in (place, -place - sum(gaps)) for i in range(-20, 21)]
        places = [-2.5 - sum(gaps) + (5.0 + sum(gaps)) / 150 * i for i in range(151)] + near
        swept = rows(
            tmp_path, ARCH + fill + f"&vehicle {by_hand(axles, spacings, 1.6)} /\n" + SEARCH
            + f"&sweep parameter = 'position', values = {', '.join(map(repr, places))} /\n", head="")
        least.append(min(float(row["critical"]) for row in swept if row["critical"]))
    assert float(worst["critical"]) == pytest.approx(min(least), rel=1e-6)


def test_loads_of_the_vehicle_and_per_metre_are_printed(tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text(LIST)
    (tmp_path / "x.nml").write_text(
        ARCH + "&vehicle list = 'list.csv', name = 'lorry', convoy = 2, worst = T /\n" + SEARCH)
    words = "2 x lorry, 260 kN over an effective width of 0.8 m: 325 kN per metre of depth"
    assert words in run_dda("check", "x.nml", cwd=tmp_path).stdout
    assert f"x.nml: {words}\n" in run_dda("run", "x.nml", cwd=tmp_path).stdout
    assert "effective width" not in run_dda(
        "run", "x.nml", "--force", "--set", "vehicle%convoy=1", "--quiet", cwd=tmp_path).stdout


def test_another_list_is_another_deck(tmp_path: Path) -> None:
    """A resumed run does not keep the factor of the old list."""
    deck = ARCH + "&vehicle list = 'list.csv', name = 'axle', position = -1 /\n" + SEARCH
    (tmp_path / "list.csv").write_text(LIST)
    first = float(rows(tmp_path, deck, head="")[0]["critical"])
    (tmp_path / "list.csv").write_text(LIST.replace("axle,90", "axle,45"))
    done = run_dda("run", "x.nml", "--resume", cwd=tmp_path)
    assert "nothing to resume" in done.stdout
    with (tmp_path / "x" / "results.csv").open() as table:
        head, row = (line.split(",") for line in table.read().splitlines())
    assert float(row[head.index("critical")]) == pytest.approx(2.0 * first, rel=1e-7)


LISTED = "list = 'list.csv', name = 'lorry'"
REFUSED = {
    "no file": ("list = 'none.csv', name = 'lorry'", LIST, "x.nml:4: error: vehicle%list = 'none.csv': "),
    "no name": (
        "list = 'list.csv'", LIST, "x.nml:4: error: expected a vehicle of list.csv, one of axle, lorry, got ''"),
    "another name": (
        "list = 'list.csv', name = 'tank'", LIST,
        "x.nml:4: error: expected a vehicle of list.csv, one of axle, lorry, got 'tank'"),
    "name alone": ("axles = 1, name = 'lorry'", LIST, "x.nml:4: error: vehicle%name needs list, got none; give it"),
    "axles too": (f"axles = 1, {LISTED}", LIST, "x.nml:4: error: vehicle%list needs no axles, got one"),
    "no column": (
        LISTED, "name,axles\nlorry,1\n", "list.csv:1: error: expected the columns name, axles_kN, spacings_m"),
    "too few spacings": (
        LISTED, "name,axles_kN,spacings_m\n\nlorry,1 2,\n",
        "list.csv:3: error: expected one spacing fewer than axles, got 2 axles and 0 spacings"),
    "no number": (
        LISTED, "name,axles_kN,spacings_m\nlorry,1 heavy,2\n",
        "list.csv:2: error: expected numbers above 0 as axles_kN, got 'heavy'"),
    "two tracks": (
        LISTED, "name,axles_kN,spacings_m,track_m\nlorry,1,,1 2\n",
        "list.csv:2: error: expected one number as track_m, got 2"),
}


@pytest.mark.parametrize(("vehicle", "listed", "message"), REFUSED.values(), ids=REFUSED)
def test_lists_that_are_none_are_refused_with_their_line(
    tmp_path: Path, vehicle: str, listed: str, message: str
) -> None:
    (tmp_path / "list.csv").write_text(listed)
    (tmp_path / "x.nml").write_text(ARCH + f"&vehicle {vehicle}, position = 0 /\n" + SEARCH)
    done = run_dda("run", "x.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(message) and len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("vehicle", "varied", "words"),
    [
        (LISTED, "height", "fill%height is varied, and changes the effective width"),
        ("axles = 1e4, wheel_width = 0.2", "fill%spread", "fill%spread is varied, and changes the effective width"),
        ("axles = 1e4, effective_width = 2", "axles(1)", "vehicle%axles is varied beside a list, a convoy or"),
        ("axles = 1e4, 1e4, spacings = 2, convoy = 2", "spacings(1)", "vehicle%spacings is varied beside a list"),
    ],
)
def test_what_would_change_the_loads_per_metre_is_not_varied(
    tmp_path: Path, vehicle: str, varied: str, words: str
) -> None:
    (tmp_path / "list.csv").write_text(LIST)
    (tmp_path / "x.nml").write_text(
        ARCH + f"&fill height = 0.5, unit_weight = 18e3 /\n&vehicle {vehicle}, position = 0 /\n" + SEARCH
        + f"&sweep parameter = '{varied}', values = 0.5, 1 /\n")
    done = run_dda("check", "x.nml", cwd=tmp_path)
    assert done.returncode == 2 and words in done.stderr


def test_a_given_width_lets_fill_vary(tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text(LIST)
    swept = "&fill height = 0.5, unit_weight = 18e3 /\n&sweep parameter = 'height', values = 0.5, 1 /\n"
    vehicle = f"&vehicle {LISTED}, effective_width = 2, position = -3.3 /\n"
    found = rows(tmp_path, ARCH + swept + vehicle + SEARCH, head="")
    vehicle = f"&vehicle {by_hand(LORRY, (2.1,), 2.0)}, position = -3.3 /\n"
    hand = rows(tmp_path, ARCH + swept + vehicle + SEARCH, head="")
    assert [row["critical"] for row in found] == [row["critical"] for row in hand]
    assert len({row["critical"] for row in found}) == 2
