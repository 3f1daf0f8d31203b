"""Arches of any shape by deck keys alone: critical thickness, spans, rings, domes, files written, input refused."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda
from test_live_loads import SEARCH, friction_of, rows, table

DATA = Path(__file__).resolve().parents[1] / "data"


def keys_of(row: dict[str, str], *names: str) -> str:
    """Keys of a deck from columns that are given."""
    return "".join(f", {name} = {row[name]}" for name in names if row[name])


@pytest.mark.parametrize("row", table("arch_shapes.csv"), ids=lambda row: f"{row['shape']}-{row['voussoirs']}")
def test_critical_thickness_is_that_of_a_linear_programme(tmp_path: Path, row: dict[str, str]) -> None:
    thickness = float(row["critical_thickness"])
    deck = (
        f"&arch shape = '{row['shape']}'{keys_of(row, 'span', 'rise', 'right_rise', 'voussoirs')} /\n"
        f"&joint friction_deg = {row['friction_deg']} /\n"
        f"&search parameter = 'thickness', low = {thickness / 3.0}, high = {thickness * 2.0} /\n"
    )
    (found,) = rows(tmp_path, deck, head="")
    assert found["verdict"] == "found"
    assert float(found["critical"]) == pytest.approx(thickness, rel=1e-8)


@pytest.mark.parametrize("row", table("practice_multi_span.csv"), ids=lambda row: "-".join(list(row.values())[:8]))
def test_spans_on_piers_need_no_file(tmp_path: Path, row: dict[str, str]) -> None:
    """The load is on the middle of an extrados chord, counted from 0."""
    half, n, t = float(row["embrace_deg"]) / 2.0, int(row["voussoirs"]), float(row["thickness_ratio"])
    step, start = 2.0 * half / n, -half + 2.0 * half / n * int(row["loaded_voussoir_of_span_1"])
    ends = [math.radians(start), math.radians(start + step)]
    outer = 1.0 + t / 2.0
    x, y = outer * sum(map(math.sin, ends)) / 2.0, outer * sum(map(math.cos, ends)) / 2.0
    weight = n * math.sin(math.radians(step)) * t
    piers = f", spans = {row['spans']}, pier_width = {row['pier_width_over_R']}"
    piers += f", pier_height = {row['pier_height_over_R']}"
    deck = (
        f"&arch shape = 'circular', radius = 1, half_angle_deg = {half}, thickness_ratio = {t}, voussoirs = {n}"
        f"{piers if row['spans'] != '1' else ', rings = 1'} /\n&material unit_weight = 1.0 /\n"
        f"&joint friction_deg = {friction_of(row['friction'])} /\n"
        f"&live x = {x!r}, y = {y!r}, fy = {-weight!r} /\n" + SEARCH
    )
    (found,) = rows(tmp_path, deck, head="")
    assert float(found["critical"]) == pytest.approx(float(row["P_over_weight_of_one_arch"]), rel=1e-8)


@pytest.mark.parametrize("row", table("practice_multi_ring.csv"), ids=lambda row: "-".join(list(row.values())[:5]))
def test_rings_need_no_file(tmp_path: Path, row: dict[str, str]) -> None:
    n = int(row["voussoirs_a_ring"])
    t, step = float(row["thickness_ratio"]), math.radians(float(row["embrace_deg"]) / n)
    deck = (
        f"&arch radius = 1, half_angle_deg = {float(row['embrace_deg']) / 2.0}, thickness_ratio = {t},\n"
        f"   voussoirs = {n}, rings = {row['rings']} /\n"
        "&material unit_weight = 1.0 /\n&analysis flow = 'associated' /\n"
        f"&joint friction_deg = {friction_of(row['friction_all_joints'])} /\n"
        f"&live x = {row['load_x_over_R']}, y = {row['load_y_over_R']}, fy = {-n * math.sin(step) * t!r} /\n" + SEARCH
    )
    (found,) = rows(tmp_path, deck, head="")
    assert float(found["critical"]) == pytest.approx(float(row["P_over_weight_associated_upper_bound"]), rel=1e-8)


@pytest.mark.parametrize(("voussoirs", "ratio"), [(40, 0.04273), (160, 0.0428328), (320, 0.042834)])
def test_a_lune_of_a_dome_is_as_thin_as_heyman_has_it(tmp_path: Path, voussoirs: int, ratio: float) -> None:
    deck = (
        f"&arch radius = 1, voussoirs = {voussoirs}, lune_deg = 10, facet_deg = 0.5 /\n&joint friction_deg = 89.9 /\n"
        "&search parameter = 'thickness_ratio', low = 0.01, high = 0.2 /\n"
    )
    (found,) = rows(tmp_path, deck, head="")
    assert float(found["critical"]) == pytest.approx(ratio, rel=1e-4)


def test_a_semicircle_of_one_ring_is_the_circular_arch(tmp_path: Path) -> None:
    """By span and rise its intrados is given: the ratio follows from the thickness found."""
    chain = "&arch voussoirs = 20 /\n&joint friction_deg = 40 /\n&search /\n"
    (exact,) = rows(tmp_path, chain, head="")
    ratio = float(exact["exact"])
    inner = 1.0 - ratio / 2.0
    deck = (
        f"&arch shape = 'segmental', span = {2.0 * inner!r}, rise = {inner!r}, voussoirs = 20 /\n"
        "&joint friction_deg = 40 /\n&search parameter = 'thickness', low = 0.05, high = 0.3 /\n"
    )
    (found,) = rows(tmp_path, deck, head="")
    assert float(found["critical"]) == pytest.approx(ratio, rel=1e-8)


@pytest.mark.parametrize("loads", ["&live x = -2, y = 2, fy = -1e5 /\n", "&load horizontal_coefficient = 9 /\n"])
def test_hinges_of_a_shape_are_named_as_those_of_its_ring(tmp_path: Path, loads: str) -> None:
    """Ends of joints by their distance from the centre, at both springings too; hinges by where their force acts."""
    deck = "&arch shape = 'segmental', span = 8, rise = 2, thickness = 0.5, voussoirs = 12 /\n" + loads
    factor = SEARCH if "live" in loads else ""
    (found,) = rows(tmp_path, deck + "&joint friction_deg = 60 /\n" + factor, head="")
    assert found["collapse_mode"] == "rotational"
    joints = [{name: joint[name] if name in ("state", "mechanism") else float(joint[name] or "nan") for name in joint}
              for joint in table(str(tmp_path / "x" / "joints.csv"))]
    assert len(joints) == 13
    hinges = []
    for joint in joints:
        inner, outer, acts = (math.hypot(joint[f"x{end}"], joint[f"y{end}"] + 3.0) for end in
                              ("_intrados", "_extrados", ""))
        assert (inner, outer) == pytest.approx((5.0, 5.5), abs=1e-9)
        if joint["mechanism"].startswith("hinge"):
            side = "intrados" if acts < 5.25 else "extrados"
            hinges.append(side)
            assert joint["mechanism"] == f"hinge_{side}"
            assert joint["eccentricity_ratio"] == pytest.approx(1.0 if side == "intrados" else -1.0, abs=1e-6)
            opens = "extrados" if side == "intrados" else "intrados"
            assert joint[f"opening_{opens}"] >= joint[f"opening_{side}"]
    # along the arch they take turns
    assert len(hinges) == 4 and sum(side == "intrados" for side in hinges) == 2


def test_an_undecided_search_says_its_bracket(tmp_path: Path) -> None:
    """A catenary so thin that its rounded corners hide how it falls: the exact value, of 40 digits, is near."""
    deck = "&arch shape = 'catenary', span = 20.541, rise = 4.905, right_rise = 3.758, voussoirs = 43 /\n"
    search = "&search parameter = 'thickness', low = 2e-7, high = 2 /\n"
    (tmp_path / "x.nml").write_text(deck + "&joint friction_deg = 60 /\n" + search)
    status = run_dda("run", "x.nml", "--quiet", cwd=tmp_path).returncode
    (row,) = rows_of(tmp_path / "x" / "results.csv")
    told = (tmp_path / "x" / "log.txt").read_text()
    assert status == (3 if row["verdict"] == "undecided" else 0)
    values = re.findall(r"(?:collapsed|stable) at ([\d.e-]+)", told) or [row["critical"], row["critical"]]
    assert [float(value) for value in values] == pytest.approx([1.45321918691568e-5] * 2, rel=1e-6)


def test_the_blocks_written_carry_what_the_arch_does(tmp_path: Path) -> None:
    arch = (
        "&arch shape = 'pointed', span = 4, rise = 3, thickness = 0.4, voussoirs = 13, spans = 2, pier_width = 1,\n"
        "   pier_height = 2, pier_courses = 3, rings = 2 /\n"
    )
    rest = "&live x = -1, y = 2.7, fy = -1e3 /\n" + SEARCH
    (tmp_path / "arch.nml").write_text(arch + rest)
    assert run_dda("export", "arch.nml", cwd=tmp_path).returncode == 0
    (by_keys,) = rows(tmp_path, arch + rest, head="")
    (by_file,) = rows(tmp_path, SEARCH, head="&scene kind = 'blocks', geometry = 'arch.blocks' /\n")
    assert float(by_file["critical"]) == pytest.approx(float(by_keys["critical"]), rel=1e-9)


@pytest.mark.parametrize(
    ("arch", "line", "words"),
    [
        ("shape = 'segmental', span = 4,\nrise = 2.1, thickness = 0.3", 2, "at most half the span"),
        ("shape = 'pointed', span = 4,\nrise = 1.9, thickness = 0.3", 2, "half the span or more"),
        ("shape = 'basket', span = 4,\nrise = 2.0, thickness = 0.3", 2, "below half the span"),
        ("shape = 'basket', span = 4, rise = 1.5,\nright_rise = 1.2, thickness = 0.3", 2, "one height"),
        ("radius = 1, half_angle_deg = 60, spans = 2,\npier_width = 0.1, pier_height = 1", 2, "as wide as"),
        ("radius = 1, spans = 2, pier_width = 0.5", 1, "expected the height of piers"),
        ("shape = 'elliptic', span = 4, thickness = 0.3", 1, "expected a rise, got none"),
        ("shape = 'elliptic', span = 4, rise = 1", 1, "expected a thickness, got none"),
        ("shape = 'elliptic', span = 4, rise = 1, radius = 3, thickness = 0.3", 1, "expected span and rise alone"),
        ("shape = 'flat', span = 4, rise = 1, thickness = 0.3", 1, "no rise of a flat arch"),
        ("radius = 1,\nthickness = 2.1", 2, "expected joints that do not cross"),
        ("radius = 1, rings = 2,\njoints_deg = 0, 30, 90", 2, "expected voussoirs, got joints_deg"),
        ("radius = 1, crown_thickness = 0.1", 1, "got one; give both"),
        ("radius = 1, thickness = 0.1, thickness_ratio = 0.1", 1, "expected the thickness once"),
        ("radius = 1, lune_deg = 5, spans = 2, pier_width = 1, pier_height = 1", 1, "expected a lune of one span"),
    ],
)
def test_an_arch_that_cannot_be_is_refused_by_its_line(tmp_path: Path, arch: str, line: int, words: str) -> None:
    (tmp_path / "bad.nml").write_text(f"&arch {arch} /\n")
    for command in ("run", "check", "export"):
        done = run_dda(command, "bad.nml", cwd=tmp_path)
        assert done.returncode == 2, done.stdout
        assert done.stderr.startswith(f"bad.nml:{line}: error: "), done.stderr
        assert words in done.stderr
        assert ";" in done.stderr


def test_every_length_of_a_shape_is_searched(tmp_path: Path) -> None:
    """The width of buttresses on which an arch just stands: wider stands, narrower falls."""
    arch = "&arch shape = 'parabolic', span = 4, rise = 1.5, thickness = 0.4, voussoirs = 12, buttress_height = 2"
    deck = f"{arch} /\n&search parameter = 'buttress_width', low = 0.45, high = 3 /\n"
    (found,) = rows(tmp_path, deck, head="")
    assert found["verdict"] == "found"
    width = float(found["critical"])
    for factor, verdict in ((1.0 - 1e-6, "collapsed"), (1.0 + 1e-6, "stable")):
        (row,) = rows(tmp_path, f"{arch}, buttress_width = {width * factor!r} /\n", head="")
        assert row["verdict"] == verdict


def test_the_table_of_shapes_holds_every_curve() -> None:
    assert {row["shape"] for row in rows_of(DATA / "arch_shapes.csv")} >= {
        "segmental", "circular", "pointed", "elliptic", "parabolic", "catenary", "basket"}
