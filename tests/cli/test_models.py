"""Every model (kind, mode, geometry) and everything that can be searched in one: right, or refused."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import NamedTuple

import pytest
from bridges import spans
from dda_command import rows_of, run_dda

KINDS = ("arch", "lines", "blocks")
MODES = ("static", "dynamic", "limerick")
#: Keys of arches of any shape
SHAPE_KEYS = ("span", "rise", "right_rise", "thickness", "crown_thickness", "springing_thickness", "pier_width",
              "pier_height", "buttress_width", "buttress_height", "lune_deg")
STRENGTH = "material%compressive_strength"  #: Arches with it are a shape, too; tests/cli/test_crushing.py
WATER = "&scene kind = 'blocks', geometry = 's.water' /\n"  #: Blocks far above the water
GEOMETRIES = ("reference", "current")
DATA = Path(__file__).parents[1] / "data"
INPUT_DOC = Path(__file__).parents[2] / "docs" / "input.md"

# a block of 1 x 2 m on a ground, as lines and as polygons
LINES = "\n".join([
    "0.01", "7 0 0 0 2 0 0 0", "-3 -1 3 -1 1", "3 -1 3 0 1", "3 0 -3 0 1", "-3 0 -3 -1 1",
    "1 0 1 2 1", "1 2 0 2 1", "0 2 0 0 1", "-2.5 -0.5 -2.5 -0.5", "2.5 -0.5 2.5 -0.5", ""])
BLOCKS = "block fixed\n -3 -1\n 3 -1\n 3 0\n -3 0\nblock\n 0 0\n 1 0\n 1 2\n 0 2\n"
# the same, pushed at its upper left corner
PUSHED = BLOCKS + "load 0 2 5000 0\n"
# led to the side
LED = BLOCKS + "displacement 0.5 1 0.01 0\n"
# led to the side, at two points, and back
SWAYED = BLOCKS + "".join(f"displacement 0.5 {y}\n0 0 0\n0.2 0.01 0\n0.4 0 0\n" for y in (0.5, 1.5))
# a sine of four periods a second, for one
SINES = "".join(f"{k / 2000},{math.sin(8 * math.pi * k / 2000)}\n" for k in range(501))
# critical thickness ratio of semicircles of 36 and 12 voussoirs by limit analysis with 60 digits, without
# slip and with a friction of 21 degrees, and of joints at 45 degrees: tests/data/arch_exact.csv
EXACT_36, EXACT_12_F21, EXACT_45 = 0.10742413832037053, 0.11890187237381047, 0.10086104924420147
# that of 12 voussoirs in the original program: docs/limerick.md
ORIGINAL_12 = 0.10880
# thrust of the semicircle at its springings is half its weight: 8 voussoirs of 2240 kg/m3
HALF_ARCH = 4 * 0.5 * math.sin(math.pi / 8) * (10.75**2 - 9.25**2) * 2240 * 9.81


def scene(kind: str) -> str:
    """The first group of a deck."""
    return "" if kind == "arch" else f"&scene kind = '{kind}', geometry = 's.{kind}' /\n"


def write_files(folder: Path) -> None:
    """The files that the decks name."""
    for name, text in (
        ("lines", LINES), ("blocks", BLOCKS), ("pushed", PUSHED), ("led", LED), ("swayed", SWAYED), ("sine", SINES),
        ("water", BLOCKS + "\nwater -100 -50 100 -50\n"),
    ):
        (folder / f"s.{name}").write_text(text)


def markdown(text: str) -> list[dict[str, str]]:
    """Rows of the tables in a text; fields by the titles above them."""
    rows: list[dict[str, str]] = []
    titles: list[str] = []
    for line in text.splitlines():
        fields = [field.strip() for field in line.strip("|").split("|")]
        if not line.startswith("|"):
            titles = []
        elif not titles:
            titles = fields
        elif not line.startswith("| ---"):
            rows.append(dict(zip(titles, fields)))
    return rows


def models_help() -> str:
    """What the program says of its models."""
    return run_dda("help", "models").stdout


def real_keys() -> list[str]:
    """All keys of the structure and of the method that have real values, as group%key."""
    keys = []
    for group in re.split(r"^&", run_dda("help", "keys").stdout, flags=re.M)[1:]:
        name = group.split()[0]
        if name in ("scene", "search", "sweep", "output"):
            continue
        for key, kind in re.findall(r"^   (\w+)\b.*\n      .*\n      (a number|a list of numbers)", group, re.M):
            keys.append(f"{name}%{key}" + ("(2)" if "list" in kind else ""))
    return keys


def test_docs_have_the_tables_that_the_program_prints() -> None:
    assert models_help() in INPUT_DOC.read_text()


def test_table_has_every_mode_with_every_geometry() -> None:
    rows = [row for row in markdown(models_help()) if "mode" in row]
    pairs = [(row["mode"].strip("`"), row["geometry"].strip("`")) for row in rows]
    assert sorted(pairs) == sorted((mode, geometry) for mode in MODES for geometry in GEOMETRIES)


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", KINDS)
def test_every_model_bears_the_weight_or_is_refused(tmp_path: Path, kind: str, mode: str, geometry: str) -> None:
    """The ground carries the block's 40 kN, a springing half the arch; whatever the model."""
    (row,) = (row for row in markdown(models_help())
              if (row.get("mode"), row.get("geometry")) == (f"`{mode}`", f"`{geometry}`"))
    write_files(tmp_path)
    time = ", duration = 20, damping = 5, time_step = 0.02, steps = 20000" if mode == "dynamic" else ""
    (tmp_path / "m.nml").write_text(
        (scene(kind) or "&arch voussoirs = 8 /\n") + "&material young = 1e8"
        + ("" if kind == "arch" else ", unit_weight = 20e3") + " /\n"
        f"&analysis mode = '{mode}', geometry = '{geometry}'{time} /\n")
    done = run_dda("run", "m.nml", cwd=tmp_path)
    if row[kind] == "no":
        assert done.returncode == 2
        assert re.match(r"m\.nml:3: error: .*" + re.escape(row["why not"]), done.stderr)
        return
    assert done.returncode == 0, done.stderr
    (result,) = rows_of(tmp_path / "m" / "results.csv")
    assert result["verdict"] == ("completed" if mode == "dynamic" else "stable")
    assert result["blocks"] == ("8" if kind == "arch" else "1")
    joints = rows_of(tmp_path / "m" / "joints.csv")
    # those of the arch that move or sink lean their springings by some 1e-4
    accuracy = 1e-2 if mode == "limerick" else 1e-4
    for joint in (joints[0], joints[-1]):
        assert float(joint["normal_force"]) == pytest.approx(HALF_ARCH if kind == "arch" else 40e3, rel=accuracy)
    done = run_dda("check", "m.nml", cwd=tmp_path)
    assert f"{kind}, {mode} {geometry}; available for {kind}: " in done.stdout


class Answer(NamedTuple):
    """A deck without its search, the ends of the search, and what it must find."""

    deck: str
    low: float
    high: float
    wanted: float | str  #: the critical value, or the verdict of both ends
    near: float = 0.0  #: largest relative error with mode = 'limerick' or 'dynamic'; static decisions are exact


def of_the_block(kind: str, mode: str) -> dict[str, Answer]:
    """What is known of the block on the ground by statics."""
    dense, light = "&material density = 2000 /\n", "&material density = 500 /\n"
    g, push = "&load gravity = 10 /\n", "&load gravity = 10, horizontal_coefficient = 0.3 /\n"
    rough = "&joint friction_deg = 60 /\n"
    answers = {
        # it turns about its lower corner: 0.5 m of 1 m
        "load%horizontal_coefficient": Answer(dense + g + rough, 0, 1, 0.5, 0.01),
        "load%gravity_direction_deg": Answer(
            dense + g + rough, -90, -45, -90 + math.degrees(math.atan(0.5)), 0.01),
        "load%load_factor": Answer(
            dense + "&load gravity = 10, horizontal_coefficient = 0.2, live_horizontal = T /\n" + rough,
            0, 9, 2.5, 0.01),
        "joint%friction_deg": Answer(dense + push, 5, 60, math.degrees(math.atan(0.3)), 0.01),
        # no stiffness makes or breaks equilibrium
        "material%young": Answer(dense + push, 1e8, 1e12, "stable"),
        "material%poisson": Answer(dense + push, -0.5, 0.4, "stable"),
    }
    if mode == "static":
        # 8 kPa on 1 m bear a fifth of 40 kN; it hangs by 40 kPa
        glued = "&joint friction_deg = 0, cohesion = 8e3 /\n"
        fifth = "&load gravity = 10, horizontal_coefficient = 0.2 /\n"
        live = dense + g + rough + "&live x = {}, y = {}, fx = {}, fy = {} /\n"
        pushed = live.format(0, 2, 15e3, 0) + "&vehicle length = {}, position = {}, axles = {} /\n"
        if kind == "blocks":
            # small displacements bring nothing down
            led = "&scene kind = 'blocks', geometry = 's.led' /\n"
            answers["load%displacement_factor"] = Answer(led + dense, 0, 5, "stable")
            answers["load%water_rise"] = Answer(WATER + dense, 0, 5, "stable")
            # 8 kNm of the push are 40 kN on half of what a strip of 40 kN over the strength leaves of 1 m
            answers[STRENGTH] = Answer(dense + fifth + rough, 4.1e4, 1e6, 40e3 / 0.6)
        answers |= {
            "vehicle%axles(2)": Answer(pushed.format(0, 0.1, "1e-6, 1 spacings = 0.4"), 1e3, 5e4, 20e3),
            "vehicle%spacings(2)": Answer(
                pushed.format(0, 0.1, "2*1e-6, 20e3 spacings = 0.1, 0.1"), 0.05, 0.7, 0.3),
            "vehicle%position": Answer(pushed.format(0.1, 0, "20e3"), 0.1, 0.9, 0.5),
            "vehicle%length": Answer(pushed.format(0.1, 0.4, "25e3"), 0.1, 0.5, "stable"),
            # moments about the lower corner, with the 20 kNm of the weight
            "live%fx(2)": Answer(live.format("0, 0", "0, 2", "0, 1", "0, 0"), 0, 5e4, 10e3),
            "live%fy(2)": Answer(live.format("0, 0", "2, 2", "12e3, 0", "0, 0"), -1e4, 0, -4e3),
            "live%y(2)": Answer(live.format("0, 0", "0, 1", "0, 20e3", "0, 0"), 0.1, 1.9, 1.0),
            "live%x(2)": Answer(live.format("0, 0.3", "2, 2", "15e3, 0", "0, -20e3"), 0.1, 0.9, 0.5),
            "material%density": Answer(light + fifth + glued, 500, 8000, 2000.0),
            "material%unit_weight": Answer(light + fifth + glued, 5e3, 8e4, 20e3),
            "load%gravity": Answer(dense + "&load horizontal_coefficient = 0.2 /\n" + glued, 2, 40, 10.0),
            "joint%cohesion": Answer(dense + fifth + "&joint friction_deg = 0 /\n", 0, 1e5, 8e3),
            "joint%tension": Answer(
                dense + "&load gravity = 10, gravity_direction_deg = 90 /\n&joint cohesion = 1e9 /\n", 0, 1e6, 40e3),
        }
    elif kind == "blocks":
        # 5 kN on 2 m turn it over: 20 kN on 0.5 m
        heavy = "&scene kind = 'blocks', geometry = 's.pushed' /\n"
        answers |= {
            "material%density": Answer(heavy + light + g + rough, 500, 4000, 1000.0, 0.01),
            "material%unit_weight": Answer(heavy + light + g + rough, 5e3, 4e4, 10e3, 0.01),
            "load%gravity": Answer(heavy + dense + rough, 2, 40, 5.0, 0.01),
        }
    else:
        # friction goes with the weight
        answers |= {
            "material%density": Answer(light + push, 500, 8000, "stable"),
            "material%unit_weight": Answer(light + push, 5e3, 8e4, "stable"),
            "load%gravity": Answer(dense + push, 2, 40, "stable"),
        }
    return {key: answer if answer.deck.startswith("&scene") else
            answer._replace(deck=scene(kind) + answer.deck) for key, answer in answers.items()}


def of_the_arch(mode: str) -> dict[str, Answer]:
    """What is known of arches: by limit analysis, by scale, or by the original itself."""
    keyed = "&joint friction_deg = 90 /\n"
    glued = "&arch thickness_ratio = 0.1 /\n&joint cohesion = 1e8, tension = 50e3 /\n"
    pushed = "&arch half_angle_deg = 78.75, voussoirs = 7, thickness_ratio = 0.15 /\n" + keyed
    # docs/validation.md: the arch of Oppenheim falls by a push of 0.3736; a tilt is the same push
    push = 0.37361169
    tilt = -90 + math.degrees(math.atan(push))
    thick = "&arch voussoirs = 12 /\n"
    # scale and stiffness do not matter without strength
    answers = {key: Answer(thick, low, high, "stable") for key, low, high in (
        ("material%density", 1, 1e5), ("material%unit_weight", 1, 1e6), ("load%gravity", 1, 100),
        ("arch%radius", 1, 100), ("material%young", 1e8, 1e12), ("material%poisson", 0, 0.4))}
    # the push again, in tenths
    live = pushed + "&load live_horizontal = T, horizontal_coefficient = 0.1 /\n"
    if mode == "static":
        # a span of tests/data/practice_multi_span.csv; a load of nothing is carried anywhere
        one = rows_of(DATA / "practice_multi_span.csv")[0]
        weight, x, y = -float(spans(one).split()[-1]), *spans(one).split()[-4:-2]
        span = (f"&arch radius = 1, half_angle_deg = 60, voussoirs = 20 /\n&material unit_weight = 1 /\n"
                f"&joint friction_deg = {math.degrees(math.atan(0.6))!r} /\n"
                f"&live x = 2*{x}, y = 2*{y}, fy = 0, {{}} /\n")
        factor = float(one["P_over_weight_of_one_arch"])
        axles = span.split("&live")[0] + "&vehicle length = {}, position = {}, axles = {} /\n"
        answers |= {
            "load%load_factor": Answer(span.format(-weight), 0, 9, factor),
            "live%fy(2)": Answer(span.format(-weight), -9 * weight, 0, -factor * weight),
            "vehicle%axles(2)": Answer(axles.format(0, float(x) - 0.1, "1e-12, 1 spacings = 0.1"),
                                       0.5 * weight, 2 * weight, factor * weight),
            "vehicle%spacings(2)": Answer(
                axles.format(0, 0, "3*1e-9 spacings = 0.1, 0.1"), 0.05, 0.3, "stable"),
            "vehicle%position": Answer(axles.format(0.1, 0, "1e-9"), -0.5, 0.5, "stable"),
            "vehicle%length": Answer(axles.format(0.1, 0, "1e-9"), 0.1, 0.5, "stable"),
            "live%fx(2)": Answer(
                span.format(-1e-9).replace("fy", "fx = 2*0, fy"), -1e-9, 1e-9, "stable"),
            "live%x(2)": Answer(span.format(-1e-9), float(x) - 0.02, float(x), "stable"),
            "live%y(2)": Answer(span.format(-1e-9), float(y) - 0.05, float(y) - 0.01, "stable"),
        }
        twelve = "&arch voussoirs = 12, thickness_ratio = {} /\n" + keyed
        return answers | {
            "arch%thickness_ratio": Answer(keyed, 0.05, 0.2, EXACT_36),
            "arch%half_angle_deg": Answer(f"&arch thickness_ratio = {EXACT_36} /\n" + keyed, 80, 100, 90.0),
            "arch%joints_deg(2)": Answer(
                f"&arch joints_deg = 0, 40, 90, facet_deg = 0.5, thickness_ratio = {EXACT_45} /\n" + keyed,
                30, 52, 45.0),
            # 12 voussoirs of 15 degrees need 0.10486 with one chord, 0.10504 with two
            "arch%facet_deg": Answer(twelve.format(0.10495), 8, 25, 15.0),
            "joint%friction_deg": Answer(f"&arch voussoirs = 12, thickness_ratio = {EXACT_12_F21} /\n", 10, 60, 21.0),
            "load%horizontal_coefficient": Answer(pushed, 0, 1, push),
            "load%gravity_direction_deg": Answer(pushed, -90, -45, tilt),
            # too thin, it hangs by its glue; nothing but strength over weight times size counts: below
            "joint%tension": Answer(glued, 0, 1e6, "glue"),
            "joint%cohesion": Answer("&arch thickness_ratio = 0.1 /\n&joint tension = 1e8 /\n", 0, 1e7, "glue"),
        }
    at_limit = f"&arch voussoirs = 12, thickness_ratio = {ORIGINAL_12} /\n"
    return answers | {
        "arch%thickness_ratio": Answer("&arch voussoirs = 12 /\n", 0.1, 0.12, ORIGINAL_12, 1e-3),
        "arch%half_angle_deg": Answer(at_limit, 80, 100, 90.0, 1e-2),
        "arch%joints_deg(2)": Answer("&arch joints_deg = 0, 45, 90 /\n", 30, 52, "stable"),
        "arch%facet_deg": Answer(at_limit.replace("0.1088", "0.1089"), 8, 25, 15.0, 1e-2),
        # none slips beyond 22 degrees
        "joint%friction_deg": Answer("&arch voussoirs = 12, thickness_ratio = 0.13 /\n", 40, 80, "stable"),
        "load%horizontal_coefficient": Answer(pushed, 0.2, 0.5, push, 0.05),
        "load%gravity_direction_deg": Answer(pushed, -80, -60, tilt, 0.05),
        "load%load_factor": Answer(live, 2, 5, 10 * push, 0.05),
        # 4.3 m are what the original's limit is of
        "arch%abutment_size": Answer(at_limit, 2, 8, 4.3, 0.05),
        "arch%abutment_overhang": Answer(at_limit, 2, 8, 4.3, 0.05),
    }


#: A free block goes A T^2/2 pi in a sine of one period; IN_TIME means collapse by 0.05 m
SINE = "&load gravity = 0 /\n&ground pulse = 'sine', amplitude = {}, frequency = 4, {} /\n"
RECORD = "&load gravity = 0 /\n&ground record = 's.sine' /\n"
FAR = 2 * math.pi * 0.05 * 16


FEW = "&arch voussoirs = 4 /\n"  #: An arch that takes no time


def in_time(kind: str) -> dict[str, Answer]:
    """What is known of motions: of a free block in a sine, and that nothing falls at rest."""
    still = "&joint friction_deg = 60 /\n"
    live = still + "&live x = {}, y = {}, fx = {}, fy = {} /\n"
    # on the block, or at the crown of the arch
    x, y = (0.5, 2.0) if kind != "arch" else (0.0, 10.5)
    vehicle = still + "&vehicle length = 0.1, position = {}, axles = {} /\n"
    answers = {key: Answer(still, low, high, "stable") for key, low, high in (
        ("material%density", 500, 8000), ("material%unit_weight", 5e3, 8e4), ("material%young", 1e8, 1e12),
        ("material%poisson", 0, 0.4), ("joint%friction_deg", 40, 80), ("joint%cohesion", 0, 1e5),
        ("load%gravity", 1, 100), ("load%gravity_direction_deg", -95, -85),
        ("load%horizontal_coefficient", 0, 0.05), ("analysis%restitution", 0, 1), ("analysis%damping", 0, 10))}
    answers |= {
        "joint%tension": Answer("&joint cohesion = 1e9 /\n", 0, 1e5, "stable"),
        "load%load_factor": Answer(live.format(x, y, 0, -1), 0, 9, "stable"),
        "live%x(2)": Answer(live.format(f"0, {x}", f"{y}, {y}", "0, 0", "0, -1"), x - 0.1, x + 0.1, "stable"),
        "live%y(2)": Answer(live.format(f"0, {x}", f"{y}, {y}", "0, 0", "0, -1"), y - 0.1, y, "stable"),
        "live%fx(2)": Answer(live.format(f"0, {x}", f"{y}, {y}", "0, 0", "0, -1"), -1, 1, "stable"),
        "live%fy(2)": Answer(live.format(f"0, {x}", f"{y}, {y}", "0, 0", "0, -1"), -1, 1, "stable"),
        "vehicle%axles(2)": Answer(vehicle.format(x - 0.1, "1, 1, spacings = 0.1"), 1, 9, "stable"),
        "vehicle%spacings(2)": Answer(vehicle.format(x - 0.1, "1, 1, 1, spacings = 0.1, 0.1"), 0.1, 0.2, "stable"),
        "vehicle%position": Answer(vehicle.format(x, "1"), x - 0.1, x + 0.1, "stable"),
        "vehicle%length": Answer(vehicle.format(x, "1"), 0.1, 0.2, "stable"),
    }
    if kind == "arch":
        little = FEW + "&ground pulse = 'rectangular', duration = 0.1, amplitude = 0.1 /\n"
        whole = FEW + "&ground pulse = 'sine', amplitude = 0.1, frequency = 4 /\n"
        record = FEW + "&ground record = 's.sine', amplitude = 0.1 /\n"
        return {key: answer._replace(deck=FEW + answer.deck) for key, answer in answers.items()} | {
            key: Answer(deck + still, low, high, "stable") for key, deck, low, high in (
            ("ground%scale", little, -1, 1), ("ground%amplitude", little, -1, 1),
            ("ground%duration", little, 0.01, 0.1),
            ("ground%frequency", whole, 4, 9), ("ground%direction_deg", little, -90, 90), ("ground%unit", record, 1, 2),
            ("arch%thickness_ratio", FEW, 0.15, 0.2), ("arch%radius", FEW, 1, 100),
            ("arch%half_angle_deg", FEW, 60, 90), ("arch%facet_deg", FEW, 2, 9),
            ("arch%joints_deg(2)", "&arch joints_deg = 0, 45, 90, facet_deg = 1 /\n", 40, 50))}
    if kind == "blocks":
        led = "&scene kind = 'blocks', geometry = 's.swayed' /\n&load gravity = 0 /\n"
        answers["load%displacement_factor"] = Answer(led, 1, 20, 5.0, 1e-3)
        answers["load%water_rise"] = Answer(WATER + "&load gravity = 0 /\n", 0, 5, "stable")
    return {key: answer if answer.deck.startswith("&scene") else answer._replace(deck=scene(kind) + answer.deck)
            for key, answer in (answers | {
                "ground%scale": Answer(SINE.format(1, ""), 1, 20, FAR, 1e-3),
                "ground%amplitude": Answer(SINE.format(1, ""), 1, 20, FAR, 1e-3),
                "ground%unit": Answer(RECORD, 1, 20, FAR, 1e-3),
                # one period is enough, and what is left of another leaves a speed
                "ground%duration": Answer(SINE.format(1.1 * FAR, "duration = 1"), 0.25, 0.5, "collapsed"),
                "ground%frequency": Answer(SINE.format(FAR, ""), 3, 5, 4.0, 1e-3),
                "ground%direction_deg": Answer(SINE.format(1.1 * FAR, ""), -90, 90, "collapsed"),
            }).items()}


def answers(kind: str, mode: str) -> dict[str, Answer]:
    """All known answers of a kind and a mode."""
    if mode == "dynamic":
        return in_time(kind)
    return of_the_arch(mode) if kind == "arch" else of_the_block(kind, mode)


def allowed(key: str, kind: str, mode: str) -> bool:
    """Whether the program's table lets a key be searched."""
    group, name = key.split("%")
    fits = [row for row in markdown(models_help()) if "searched" in row and (
        f"`{name.split('(')[0]}`" in row["searched"] or f"`&{group}`" in row["searched"])]
    assert fits, f"no row of the table speaks of {key}"
    return mode in fits[0][kind].split(", ")


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", KINDS)
def test_everything_searched_is_right_or_refused(tmp_path: Path, kind: str, mode: str) -> None:
    write_files(tmp_path)
    known, refused = answers(kind, mode), []
    assert set(known) <= set(real_keys())
    length, limit = (0.03, 5.0) if kind == "arch" else (0.6, 0.05)
    time = f", geometry = 'current', duration = {length}, time_step = 0.005, collapse_displacement = {limit}"
    time += ", steps = 9999"
    analysis = f"&analysis mode = '{mode}'{time if mode == 'dynamic' else ''} /\n"
    for key in real_keys():
        of_shapes = key.removeprefix("arch%") in SHAPE_KEYS or key == STRENGTH or key.startswith("support%")
        if kind == "arch" and of_shapes:
            continue  # setting one makes the arch a shape: test_arch_shapes.py and test_supports.py
        name = re.sub(r"[^a-z]", "_", key)
        answer = known.get(key, Answer(scene(kind), 1, 2, "refused"))
        assert (key in known) == allowed(key, kind, mode), f"{key} of {kind} in mode {mode}"
        search = f"&search\n parameter = '{key}', low = {answer.low}, high = {answer.high}"
        near = "" if mode == "static" else ", tolerance = 1e-3"
        of_key = analysis.replace(" /", ", flow = 'associated' /") if key == STRENGTH and key in known else analysis
        (tmp_path / f"{name}.nml").write_text(answer.deck + of_key + f"{search}{near} /\n")
        if key not in known:
            refused.append(name)
    done = run_dda("run", *(f"{name}.nml" for name in refused), "--out", "refused", cwd=tmp_path)
    assert done.returncode == 2 and not (tmp_path / "refused").exists()
    assert len(done.stderr.splitlines()) == len(refused)
    line = len((scene(kind) + analysis).splitlines()) + 2
    for name, message in zip(refused, done.stderr.splitlines()):
        assert message.startswith(f"{name}.nml:{line}: error: "), message
    if not known:
        return
    names = {key: re.sub(r"[^a-z]", "_", key) for key in known}
    done = run_dda("run", *(f"{name}.nml" for name in names.values()), "--out", "out", "--quiet", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = {key: rows_of(tmp_path / "out" / name / "results.csv")[0] for key, name in names.items()}
    for key, answer in known.items():
        if answer.wanted in ("stable", "collapsed"):
            assert found[key]["verdict"] == answer.wanted, key
        elif answer.wanted != "glue":
            assert found[key]["verdict"] == "found", key
            assert float(found[key]["critical"]) == pytest.approx(answer.wanted, rel=answer.near or 1e-6), key
    if kind == "arch" and mode == "static":
        # the tip of the Mohr-Coulomb law: cohesion over tan(50 degrees) is the tension that counts
        glue = {key: float(found[f"joint%{key}"]["critical"]) for key in ("tension", "cohesion")}
        assert glue["cohesion"] == pytest.approx(glue["tension"] * math.tan(math.radians(50)), rel=1e-6)


@pytest.mark.parametrize(
    "key, low, high, value",
    [("radius", 5, 40, 10.0), ("density", 1e3, 1e4, 2240.0), ("gravity", 4, 40, 9.81),
     ("unit_weight", 1e4, 1e5, 2240 * 9.81)],
)
def test_strength_goes_with_weight_and_size(tmp_path: Path, key: str, low: float, high: float, value: float) -> None:
    """An arch that is too thin hangs by its glue: what counts is strength over unit weight and radius."""
    deck = "&arch thickness_ratio = 0.1 /\n&joint cohesion = 1e8{} /\n&search parameter = '{}', low = {}, high = {} /\n"
    (tmp_path / "a.nml").write_text(deck.format("", "tension", 0, 1e6))
    assert run_dda("run", "a.nml", "--quiet", cwd=tmp_path).returncode == 0
    tension = rows_of(tmp_path / "a" / "results.csv")[0]["critical"]
    (tmp_path / "b.nml").write_text(deck.format(f", tension = {tension}", key, low, high))
    assert run_dda("run", "b.nml", "--quiet", cwd=tmp_path).returncode == 0
    (row,) = rows_of(tmp_path / "b" / "results.csv")
    assert row["collapses_at"] == "high"
    assert float(row["critical"]) == pytest.approx(value, rel=1e-6)


def test_check_says_what_is_run_and_searched(tmp_path: Path) -> None:
    write_files(tmp_path)
    (tmp_path / "a.nml").write_text(scene("blocks") + "&analysis mode = 'dynamic' /\n")
    done = run_dda("check", "a.nml", cwd=tmp_path)
    assert "numbers of &ground, restitution, damping" in done.stdout
    done = run_dda("check", "a.nml", "--set", "analysis%mode=limerick", cwd=tmp_path)
    assert "blocks, limerick current; available for blocks: static reference, " in done.stdout
    assert "other numbers of &joint" in done.stdout and "tension" not in done.stdout


def test_an_analysis_file_that_is_dynamic_is_not_searched(tmp_path: Path) -> None:
    write_files(tmp_path)
    (tmp_path / "s.ana").write_text("1 100 1 1 0.001 0.01\n2 20 1e6 0.2 0 0 0 0 0 0 0 0 0\n30 0 0\n")
    (tmp_path / "a.nml").write_text(
        "&scene kind = 'lines', geometry = 's.lines', analysis = 's.ana' /\n"
        "&analysis mode = 'limerick' /\n&search parameter = 'friction_deg' /\n")
    done = run_dda("run", "a.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("a.nml:3: error: search%parameter: ") and "it ends 'completed'" in done.stderr
    done = run_dda("run", "a.nml", "--set", "limerick%dynamic=.false.", "--set", "analysis%steps=3000", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
