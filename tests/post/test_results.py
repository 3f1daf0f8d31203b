"""voussoir.results: what dda has written, with types, in the order of the cases."""

from __future__ import annotations

import argparse
import random
from pathlib import Path

import numpy as np
import pytest

import voussoir
from voussoir import results


@pytest.fixture(scope="module")
def searched(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """Critical thickness of six arches."""
    text = """&search /
        &sweep parameter = 'voussoirs', values = 4, 7, 12 /
        &sweep parameter = 'plane', texts = 'stress', 'strain' /"""
    return voussoir.run(text, out=tmp_path_factory.mktemp("searched"))


@pytest.fixture(scope="module")
def moved(tmp_path_factory: pytest.TempPathFactory) -> results.Results:
    """Collapse of two arches with pictures."""
    text = """&arch voussoirs = 6 /
        &analysis geometry = 'current' /
        &output frames = 4 /
        &sweep parameter = 'thickness_ratio', values = 0.05, 0.2 /"""
    return voussoir.run(text, out=tmp_path_factory.mktemp("moved"))


def test_columns_have_their_types(searched: results.Results) -> None:
    cases = searched.cases
    assert len(cases) == 6
    assert cases["case"].dtype == np.int64
    assert cases["blocks"].tolist() == [4, 4, 7, 7, 12, 12]
    assert cases["critical"].dtype == float
    assert np.isnan(cases["thickness_ratio"]).all()
    assert cases["plane"].tolist() == ["stress", "strain"] * 3
    assert cases["intrados_hinge_deg"][4] == (60.0,)
    assert cases["extrados_hinge_deg"][4] == (0.0, 90.0)


def test_columns_are_what_the_file_holds(searched: results.Results) -> None:
    lines = (searched.folder / "results.csv").read_text().splitlines()
    names = lines[0].split(",")
    for line in lines[1:]:
        cells = dict(zip(names, line.split(",")))
        row = searched.case(int(cells["case"]))
        assert row["critical"] == float(cells["critical"])
        assert row["verdict"] == cells["verdict"]
        assert row["seconds"] == float(cells["seconds"])


def test_order_of_the_rows_does_not_matter(searched: results.Results, tmp_path: Path) -> None:
    for name in ("results.csv", "joints.csv"):
        head, *rows = (searched.folder / name).read_text().splitlines()
        blocks: dict[str, list[str]] = {}
        for row in rows:
            blocks.setdefault(row.split(",")[1 if name == "results.csv" else 0], []).append(row)
        keys = list(blocks)
        random.Random(1).shuffle(keys)
        text = "\n".join([head, *(row for key in keys for row in blocks[key])]) + "\n"
        (tmp_path / name).write_text(text)
    shuffled = results.read(tmp_path)
    assert shuffled.cases["critical"].tolist() == searched.cases["critical"].tolist()
    assert (shuffled.joints_of(3)["x_intrados"].tolist() == searched.joints_of(3)["x_intrados"].tolist())


def test_where_keeps_what_is_wanted(searched: results.Results) -> None:
    kept = searched.cases.where(blocks=7, plane="strain")
    assert kept["case"].tolist() == [4]
    assert [row["case"] for row in searched.cases.where(blocks=12).rows()] == [5, 6]


def test_joints_belong_to_their_case(searched: results.Results) -> None:
    joints = searched.joints_of(5)
    assert len(joints) == 13
    assert joints["angle_deg"][[0, 6, 12]].tolist() == [-90.0, 0.0, 90.0]
    assert set(joints["state"]) <= {"locked", "hinge_intrados", "hinge_extrados", "sliding", "open"}


def test_unknown_case_is_an_error(searched: results.Results) -> None:
    with pytest.raises(KeyError, match="no case 7"):
        searched.case(7)


def test_frames_hold_blocks_and_joints(moved: results.Results) -> None:
    frames = moved.frames_of(1)
    assert [frame.number for frame in frames] == list(range(len(frames)))
    assert len(frames) >= 4
    assert [frame.time for frame in frames] == sorted(frame.time for frame in frames)
    for frame in frames:
        assert [block.shape for block in frame.blocks] == [(4, 2)] * 8
        assert len(frame.joints) == 7
    moving = np.linalg.norm(frames[-1].blocks[2] - frames[0].blocks[2], axis=1)
    assert moving.max() > 0.5
    assert np.array_equal(frames[-1].blocks[-1], frames[0].blocks[-1])
    file = moved.pvd(1)
    assert file is not None and file.name == "case_1.pvd"


def test_decks_without_pictures_have_none(searched: results.Results) -> None:
    assert searched.frames is None
    assert searched.frames_of(1) == []
    assert searched.pvd(1) is None


def test_folder_without_results_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no results.csv"):
        results.read(tmp_path)


def test_torn_row_is_named_with_its_line(searched: results.Results, tmp_path: Path) -> None:
    text = (searched.folder / "results.csv").read_text()
    (tmp_path / "results.csv").write_text(text[:-40])
    with pytest.raises(ValueError, match=r"results.csv:7: error: expected \d+ cells"):
        results.read(tmp_path)


def test_run_without_cases_reads_as_empty(searched: results.Results, tmp_path: Path) -> None:
    head = (searched.folder / "results.csv").read_text().splitlines()[0]
    (tmp_path / "results.csv").write_text(head + "\n")
    assert len(results.read(tmp_path).cases) == 0


def test_tables_read_in_pieces_are_those_read_at_once(searched: results.Results, tmp_path: Path) -> None:
    from voussoir.results._tables import DamagedTable, read_columns

    table = searched.folder / "results.csv"
    whole = read_columns(table, None)
    for rows in (1, 2, 5, 6, 7):
        pieces = read_columns(table, rows)
        assert list(pieces) == list(whole)
        for name, column in whole.items():
            assert pieces[name].dtype.kind == column.dtype.kind
            assert [repr(cell) for cell in pieces[name].tolist()] == [repr(cell) for cell in column.tolist()]
    mixed = tmp_path / "other.csv"
    mixed.write_text("case,record\n1,7\n2,8\n3,quake\n4,9\n")
    assert read_columns(mixed, 2)["record"].tolist() == ["7", "8", "quake", "9"]
    mixed.write_text("case,record\n1,7\n2,8\nx,9\n4,9\n")
    with pytest.raises(DamagedTable, match="other.csv:4: error: expected case"):
        read_columns(mixed, 1)


def test_columns_of_one_value_take_no_room_and_read_the_same(tmp_path: Path) -> None:
    from voussoir.results._tables import read_columns

    rows = [f"{case},arch,,{case % 3},{'0;60' if case % 2 else '40'}" for case in range(1, 31)]
    table = tmp_path / "some.csv"
    table.write_text("\n".join(["case,deck,exact,friction_deg,intrados_hinge_deg", *rows, ""]))
    whole, pieces = read_columns(table, None), read_columns(table, 4)
    assert pieces["deck"].strides == pieces["exact"].strides == (0,)
    assert pieces["case"].strides != (0,)
    for name, column in whole.items():
        assert np.array_equal(column, pieces[name], equal_nan=column.dtype.kind == "f")
    assert pieces["intrados_hinge_deg"][0] == (0.0, 60.0)
    some = results.Table(pieces).take(np.array([5, 2]))
    assert some["case"].tolist() == [6, 3] and some["deck"].tolist() == ["arch"] * 2
    assert list(read_columns(table, 4, lambda names: names[:2])) == ["case", "deck"]


def test_chart_of_a_large_table_reads_its_columns_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from voussoir.command import plot
    from voussoir.plot.design_chart import chart_columns

    whole = voussoir.run(
        "&arch voussoirs = 12 /\n&search parameter = 'thickness_ratio' /\n"
        "&sweep parameter = 'half_angle_deg', values = 60, 70, 80 /\n"
        "&sweep parameter = 'horizontal_coefficient', first = 0, last = 0.1, count = 41 /\n", out=tmp_path)
    some = results.read(whole.folder, chart_columns)
    assert {"horizontal_coefficient", "half_angle_deg", "critical"} <= set(some.cases) < set(whole.cases)
    assert all(np.array_equal(whole.cases[name], some.cases[name], equal_nan=True) for name in ("case", "critical"))
    pictures = []
    for large in (0, plot.LARGE):
        monkeypatch.setattr(plot, "LARGE", large)
        out = tmp_path / str(large)
        parser = argparse.ArgumentParser()
        plot.add_arguments(parser)
        assert plot.run(parser.parse_args([str(whole.folder), "--chart", "--format", "png", "--out", str(out)])) == 0
        pictures.append((out / "chart.png").read_bytes())
    assert pictures[0] == pictures[1]
