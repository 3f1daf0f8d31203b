"""Decks run from Python: the same answers as by the command, from files, texts, dicts and models."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import voussoir
from voussoir.dda_program import DdaError

ARCH = {"arch": {"voussoirs": 12}, "search": {"parameter": "thickness_ratio"}}
TEXT = "&arch voussoirs = 12 /\n&search /\n"


def test_file_text_dict_and_arch_give_the_same_critical_thickness(tmp_path: Path) -> None:
    file = tmp_path / "arch.nml"
    file.write_text(TEXT)
    exact = 0.1048566597  # limit analysis of the polygons of 12 voussoirs, theory.md
    for deck in (file, str(file), TEXT, ARCH):
        assert voussoir.run(deck).cases["critical"][0] == pytest.approx(exact, abs=1e-10)
    run = voussoir.Arch(voussoirs=12).run(search="thickness_ratio")
    assert run.cases["critical"][0] == pytest.approx(exact, abs=1e-10)


def test_set_keys_by_bare_name_with_group_and_as_groups() -> None:
    pushed = voussoir.run(
        {"arch": {}}, load={"horizontal_coefficient": 0.1}, search={"parameter": "thickness_ratio", "tolerance": 1e-6},
        friction_deg=60, **{"arch%voussoirs": 12, "scene%title": "l'arche"})
    row = pushed.case(1)
    assert (row["blocks"], row["friction_deg"], row["verdict"]) == (12, 60.0, "found")
    assert pushed.setting("scene%title") == "l'arche"


def test_bare_name_of_two_groups_is_the_one_that_a_sweep_means() -> None:
    run = voussoir.run({"arch": {"voussoirs": 3}}, mode="dynamic", duration=0.01, unknowns=3)
    assert run.setting("analysis%duration") == "0.01"


def test_sweeps_of_a_dict_and_of_a_text() -> None:
    sweep = {"parameter": "voussoirs", "values": [12, 18]}
    for deck in (ARCH, TEXT.replace("&arch voussoirs = 12 /\n", "")):
        assert voussoir.run(deck, sweep=sweep).cases["voussoirs"].tolist() == [12, 18]


def test_a_sweep_beside_a_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "arch.nml"
    file.write_text(TEXT)
    with pytest.raises(ValueError, match="expected &sweep in"):
        voussoir.run(file, sweep={"parameter": "voussoirs", "values": [12, 18]})


def test_unknown_and_ambiguous_keys_are_refused_with_the_nearest() -> None:
    with pytest.raises(ValueError, match="did you mean 'friction_deg'"):
        voussoir.run(ARCH, fricton_deg=40)
    with pytest.raises(ValueError, match="expected 'search%parameter' or 'sweep%parameter'"):
        voussoir.run(ARCH, parameter="friction_deg")
    with pytest.raises(TypeError, match="or a list of them as joint%friction_deg, got <object"):
        voussoir.run(ARCH, friction_deg=object())
    with pytest.raises(TypeError, match="as arch%joints_deg, got None"):
        voussoir.run(TEXT, joints_deg=[0, None])
    with pytest.raises(ValueError, match="expected the keys of &search as a dict, got 3"):
        voussoir.run(ARCH, search=3)


def test_what_the_program_refuses_is_an_exception_with_its_message() -> None:
    with pytest.raises(DdaError, match=r"deck.nml:1: error: arch%radius") as refusal:
        voussoir.Arch(radius=-1.0).run()
    assert refusal.value.status == 2


def test_an_undecided_case_is_a_result() -> None:
    run = voussoir.run({"arch": {"thickness_ratio": 0.12}}, steps=1, unknowns=6,
                       analysis={"geometry": "current", "time_step": 1e-9})
    assert run.cases["verdict"].tolist() == ["undecided"]


def test_results_without_a_folder_vanish_with_their_object(tmp_path: Path) -> None:
    run = voussoir.run(ARCH)
    folder = run.folder
    assert folder.is_dir()
    del run
    assert not folder.exists()
    kept = voussoir.run(ARCH, out=tmp_path / "kept")
    assert voussoir.read(tmp_path / "kept").cases == kept.cases
    again = voussoir.run(tmp_path / "kept" / "deck.nml", out=tmp_path / "again")
    assert again.cases["critical"] == kept.cases["critical"]


def test_blocks_fall_at_their_own_lever() -> None:
    wall = voussoir.Blocks(friction_deg=80)
    assert wall.add([(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True) == 1
    assert wall.add(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]])) == 2
    run = wall.run(search="horizontal_coefficient")
    assert run.cases["critical"][0] == pytest.approx(0.5, rel=1e-8)
    wall.material(2, density=1000.0)
    wall.joint(2, 1, friction_deg=20.0)
    wall.shapes[1] = type(wall.shapes[1])(wall.shapes[1].pieces, False, 2)
    slides = wall.run(search="horizontal_coefficient").cases["critical"][0]
    assert slides == pytest.approx(math.tan(math.radians(20.0)), rel=1e-8)


def test_a_polygon_with_holes_turns_as_one_block() -> None:
    shapely = pytest.importorskip("shapely")
    from shapely.geometry import box

    stone = box(0, 0, 1, 3).difference(box(0.2, 0.3, 0.6, 1)).difference(box(0.3, 1.5, 0.8, 2.5))
    blocks = voussoir.Blocks.from_shapely(stone, fixed=[box(-1, -1, 3, 0)], friction_deg=80)
    run = blocks.run(search="horizontal_coefficient")
    # turning about the right foot: lever of the weight over the height of its centre
    exact = (1.0 - stone.centroid.x) / stone.centroid.y
    assert run.cases["critical"][0] == pytest.approx(exact, rel=1e-7)
    assert shapely.area([stone]).sum() == pytest.approx(3.0 - 0.28 - 0.5)


def test_shapely_lines_and_points_are_dropped_by_name() -> None:
    pytest.importorskip("shapely")
    from shapely.geometry import LineString, MultiPolygon, box

    shapes = [MultiPolygon([box(0, 0, 1, 1), box(2, 0, 3, 1)]), LineString([(0, 0), (1, 1)])]
    with pytest.warns(UserWarning, match="geometry 2, a LineString without area"):
        blocks = voussoir.Blocks.from_shapely(shapes, fixed=box(-1, -1, 4, 0), material=[2, 1])
    assert [shape.material for shape in blocks.shapes] == [1, 2, 1]
    assert blocks.run().cases["verdict"].tolist() == ["stable"]
    with pytest.raises(ValueError, match="expected 2 materials"):
        voussoir.Blocks.from_shapely(shapes[:1], material=[1])


def test_tables_are_mappings_and_show_themselves() -> None:
    cases = voussoir.run(ARCH, sweep={"parameter": "friction_deg", "count": 30, "first": 40, "last": 69}).cases
    assert list(cases)[:2] == ["deck", "case"] and len(cases) == 30
    assert {**cases}.keys() == dict(cases.items()).keys() == cases.columns.keys()
    text, page = repr(cases), cases._repr_html_()
    assert "30 rows" in text and "..." in text and max(map(len, text.split("\n")[:-1])) <= 100
    assert page.count("<tr>") == 14 and "thickness_ratio" not in page
    assert cases == cases.take(np.arange(30)) and cases != cases.take(np.arange(29))


def test_tables_become_data_frames() -> None:
    pandas = pytest.importorskip("pandas")
    frame = voussoir.run(ARCH).cases.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame["blocks"].tolist() == [12]


def test_pictures_show_themselves_and_leave_the_backend_alone() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    import matplotlib.pyplot as plt

    before, figures = matplotlib.get_backend(), plt.get_fignums()
    run = voussoir.run(ARCH, sweep={"parameter": "voussoirs", "values": [12, 18]})
    pictures = [run.plot(2, magnify=0.0), run.chart()]
    assert all(picture._repr_png_().startswith(b"\x89PNG") for picture in pictures)
    assert plt.get_fignums() == figures and matplotlib.get_backend() == before


def test_the_package_alone_loads_neither_numpy_nor_the_program() -> None:
    words = "import sys, voussoir; dir(voussoir); assert 'numpy' not in sys.modules"
    subprocess.run([sys.executable, "-c", words], check=True)
    with pytest.raises(AttributeError, match="no attribute 'runs'"):
        voussoir.runs


def test_advice_fits_the_interpreter(monkeypatch: pytest.MonkeyPatch) -> None:
    from voussoir import extras

    for managed, words in ((True, "apt-get install python3-scipy"), (False, "-m pip install scipy")):
        monkeypatch.setattr(extras, "_is_managed", lambda managed=managed: managed)
        assert words in extras.advice("scipy")
        with pytest.raises(extras.MissingPackage, match="scipy_of_nowhere"):
            extras.load("scipy_of_nowhere", "a test")
    monkeypatch.setattr(extras, "_is_managed", lambda: True)
    assert "virtual environment" in extras.advice("compas")


class Foreign:
    """An object that no deck has."""


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
#: What is refused in one sentence, and a word of it
REFUSED = {
    "group without keys": (lambda: voussoir.run({"arch": None}), "&arch"),
    "group that is a number": (lambda: voussoir.run({"arch": 3}, friction_deg=40), "&arch"),
    "list for a group": (lambda: voussoir.run({"arch": [{"radius": 5}]}), "&arch"),
    "sweep of numbers": (lambda: voussoir.run({"arch": {}, "sweep": [1, 2]}), "&sweep"),
    "groups in a group's name": (lambda: voussoir.run({"arch radius = 5 /\n&joint": {}}), "name of a group"),
    "number for a group's name": (lambda: voussoir.run({1: {}}), "name of a group"),
    "groups in a key": (lambda: voussoir.run({"arch": {"radius = 5 /\n&joint friction_deg": 1}}), "name of a key"),
    "number for a key": (lambda: voussoir.run({"arch": {5: 1}}), "name of a key"),
    "blank in a key": (lambda: voussoir.run(ARCH, **{"arch%radius x": 5.0}), "key"),
    "nothing for a value": (lambda: voussoir.run({"arch": {"radius": None}}), "None"),
    "bytes for a value": (lambda: voussoir.run({"scene": {"title": b"x"}, "arch": {}}), "b'x'"),
    "lines in a value": (lambda: voussoir.run({"scene": {"title": "x' /\n&joint /"}, "arch": {}}), "one line"),
    "lines in a set value": (lambda: voussoir.run(ARCH, **{"scene%title": "a\nb"}), "one line"),
    "object for a deck": (lambda: voussoir.run(Foreign()), "deck"),
    "list for a deck": (lambda: voussoir.run([ARCH]), "deck"),
    "number for out": (lambda: voussoir.run(ARCH, out=3), "out"),
    "word for jobs": (lambda: voussoir.run(ARCH, jobs="two"), "jobs"),
    "no jobs": (lambda: voussoir.run(ARCH, jobs=0), "jobs"),
    "flag for jobs": (lambda: voussoir.run(ARCH, jobs=True), "jobs"),
    "half a job": (lambda: voussoir.run(ARCH, jobs=1.5), "jobs"),
    "word for fixed": (lambda: voussoir.Blocks().add(SQUARE, fixed="no"), "fixed"),
    "number for fixed": (lambda: voussoir.Blocks().add(SQUARE, fixed=1), "fixed"),
    "word for a material": (lambda: voussoir.Blocks().add(SQUARE, material="brick"), "material"),
    "material 0": (lambda: voussoir.Blocks().add(SQUARE, material=0), "material"),
    "material 1, which is the deck's": (lambda: voussoir.Blocks().material(1, density=1000), "2 or more"),
    "word for a density": (lambda: voussoir.Blocks().material(2, density="1000"), "number"),
    "nothing for a friction": (lambda: voussoir.Blocks().joint(1, 2, friction_deg=None), "number"),
    "corners in space": (lambda: voussoir.Blocks().add([(0, 0, 1), (1, 0, 2), (1, 1, 3)]), "pairs"),
    "corners of space in an array": (lambda: voussoir.Blocks().add(np.zeros((4, 3))), "pairs"),
    "words for corners": (lambda: voussoir.Blocks().add([("a", "b")]), "pairs"),
    "number for corners": (lambda: voussoir.Blocks().add(5), "pairs"),
    "lines for an entry": (lambda: voussoir.Blocks().entry("measure 1 2\nblock fixed"), "one line"),
    "number for a file": (lambda: voussoir.deck.run.Deck({"arch": {}}, {"x": 3}).run(), "files"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_of_another_kind_is_refused_in_one_sentence(what: str) -> None:
    call, word = REFUSED[what]
    with pytest.raises((TypeError, ValueError)) as refusal:
        call()
    said = str(refusal.value)
    assert said.startswith("expected ") and ", got " in said and word in said and "\n" not in said, said


def test_polygon_in_space_is_refused_and_a_level_one_taken() -> None:
    pytest.importorskip("shapely")
    from shapely.geometry import Polygon

    with pytest.raises(ValueError, match="in the plane, got z from 1 to 3"):
        voussoir.Blocks.from_shapely(Polygon([(0, 0, 1), (1, 0, 2), (1, 1, 3)]))
    assert voussoir.Blocks.from_shapely(Polygon([(0, 0, 5), (1, 0, 5), (1, 1, 5)])).shapes[0].pieces == (
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)],)


def test_flags_and_numbers_of_numpy_are_taken() -> None:
    blocks = voussoir.Blocks()
    assert blocks.add(np.array(SQUARE), fixed=np.bool_(True), material=np.int64(2)) == 1
    assert blocks.add(np.array(SQUARE, dtype=np.float32) + 5.0) == 2
    assert (blocks.shapes[0].fixed, blocks.shapes[0].material) == (True, 2)
