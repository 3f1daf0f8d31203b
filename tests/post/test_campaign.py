"""Campaigns: one table, whoever computed what; nothing finished is lost when workers are killed."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from dda_command import rows_of

from voussoir import results
from voussoir.campaign.merge import TABLES, merge
from voussoir.campaign.part import Part, cases_of, ranges_of, run_part
from voussoir.campaign.share import share
from voussoir.command.main import main
from voussoir.dda_program import ask

DDA = os.environ["DDA"]

DECK = """&arch voussoirs = 12 /
&search /
&sweep parameter = 'half_angle_deg', first = 60, last = 90, count = {angles} /
&sweep parameter = 'friction_deg', values = 20, 30, 50 /
"""


def test_no_table_of_the_program_is_forgotten() -> None:
    source = Path(__file__).resolve().parents[2] / "src/app/dda_result_tables.f90"
    if not source.is_file():
        pytest.skip("the sources are not here: skipped")
    names = re.findall(r'name_table\(.*"/(\w+\.\w+)"', source.read_text())
    assert len(names) >= 9 and set(names) == set(TABLES)


def write_deck(folder: Path, angles: int = 10) -> Path:
    """A deck of three times so many cases; some of them fall at any thickness."""
    deck = folder / "sweep.nml"
    deck.write_text(DECK.format(angles=angles))
    return deck


def tables(folder: Path) -> dict[str, list[str]]:
    """Tables sorted by case, seconds left out."""
    found = {}
    for name, column in (("results.csv", 1), ("joints.csv", 0)):
        if name == "joints.csv" and not (folder / name).exists():
            continue  # of more than 100 cases it is written on demand only
        header, *rows = (folder / name).read_text().splitlines()
        if name == "results.csv":
            place = header.split(",").index("seconds")
            rows = [",".join(row.split(",")[:place] + row.split(",")[place + 1 :]) for row in rows]
        found[name] = [header, *sorted(rows, key=lambda row: int(row.split(",")[column]))]
    header, *lines = (folder / "log.txt").read_text().splitlines()
    found["log.txt"] = [header, *sorted(lines, key=lambda line: int(line.split()[0]))]
    return found


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """Tables of one run that nobody disturbed."""
    folder = tmp_path_factory.mktemp("unbroken")
    subprocess.run([DDA, "run", write_deck(folder), "--out", folder, "--quiet"], check=False)
    return tables(folder)


def test_campaign_gives_the_tables_of_one_run_in_order(tmp_path: Path, unbroken) -> None:
    deck = str(write_deck(tmp_path))
    out = tmp_path / "out"
    status = main(["campaign", deck, "--out", str(out), "--workers", "3", "--quiet"])
    assert status == 0
    assert tables(out) == unbroken
    cases = [int(row["case"]) for row in rows_of(out / "results.csv")]
    assert cases == list(range(1, 31))
    assert not (out / "parts").exists()
    words = [DDA, "run", deck, "--out", out, "--resume"]
    assert "30" in subprocess.run(words, capture_output=True, text=True, check=True).stdout
    assert tables(out) == unbroken


def test_shares_of_a_job_array_make_one_table(tmp_path: Path, unbroken, capsys) -> None:
    deck, out = str(write_deck(tmp_path)), tmp_path / "out"
    for index in ("3", "1", "2"):
        assert not (out / "results.csv").exists()
        words = ["campaign", deck, "--out", str(out), "--index", index, "--of", "3"]
        assert main(words) == 0
    assert tables(out) == unbroken
    printed = capsys.readouterr().out
    assert "this share has ended, 20 cases of other shares remain" in printed
    assert "0 undecided, 0 not finished" in printed


def test_shares_are_all_cases_each_once() -> None:
    for total, of in ((10, 3), (3, 10), (100000, 7), (1, 1)):
        cases = [case for index in range(1, of + 1) for case in share(total, index, of)]
        assert cases == list(range(1, total + 1))


def test_merge_shows_what_is_finished_so_far(tmp_path: Path, unbroken, capsys) -> None:
    deck, out = str(write_deck(tmp_path)), tmp_path / "out"
    assert main(["campaign", deck, "--out", str(out), "--index", "2", "--of", "3"]) == 0
    assert main(["campaign", deck, "--out", str(out), "--merge"]) == 3
    assert "20 not finished" in capsys.readouterr().out
    whole = unbroken["results.csv"]
    assert tables(out)["results.csv"] == whole[:1] + whole[11:21]
    assert main(["campaign", deck, "--out", str(out)]) == 0
    assert "10 of 30 cases are already finished" in capsys.readouterr().out
    assert tables(out) == unbroken


def test_settings_reach_every_part(tmp_path: Path) -> None:
    deck, out = str(write_deck(tmp_path, 2)), tmp_path / "out"
    words = ["campaign", deck, "--out", str(out), "--set", "arch%voussoirs=7", "--quiet"]
    assert main(words) == 0
    assert {row["blocks"] for row in rows_of(out / "results.csv")} == {"7"}


def test_another_deck_is_not_mixed_with_the_first(tmp_path: Path, capsys) -> None:
    deck, out = write_deck(tmp_path, 2), tmp_path / "out"
    assert main(["campaign", str(deck), "--out", str(out), "--quiet"]) == 0
    deck.write_text(deck.read_text().replace("12", "8"))
    assert main(["campaign", str(deck), "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert "other arch%voussoirs" in error and ":1: error: expected" in error and "--discard" in error
    assert main(["campaign", str(deck), "--out", str(out), "--discard", "--quiet"]) == 0
    assert {row["blocks"] for row in rows_of(out / "results.csv")} == {"8"}


def test_bad_deck_is_reported_as_by_the_program(tmp_path: Path, capsys) -> None:
    (tmp_path / "bad.nml").write_text("&arch\n radius = -1 /\n")
    assert main(["campaign", str(tmp_path / "bad.nml"), "--out", str(tmp_path / "out")]) == 2
    assert "bad.nml:2: error: arch%radius must be" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--index", "1"], "give both"),
        (["--of", "3"], "give both"),
        (["--index", "4", "--of", "3"], "number the shares from 1"),
        (["--index", "1", "--of", "3", "--discard"], "remove the folder"),
        (["--scheduler", "tcp://127.0.0.1:1"], "--scheduler:1: error: expected"),
    ],
)
def test_options_that_do_not_go_together_are_refused(tmp_path, words, message, capsys, monkeypatch):
    monkeypatch.setattr("voussoir.campaign.dask.WAIT", 1.0)
    deck = str(write_deck(tmp_path))
    assert main(["campaign", deck, "--out", str(tmp_path / "out"), *words]) == 2
    assert message in capsys.readouterr().err


def test_folder_that_cannot_be_written_is_status_4(tmp_path: Path, capsys) -> None:
    (tmp_path / "taken").write_text("a file")
    deck = str(write_deck(tmp_path))
    assert main(["campaign", deck, "--out", str(tmp_path / "taken")]) == 4
    assert "taken" in capsys.readouterr().err


def test_missing_program_is_reported(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setenv("VOUSSOIR_DDA", str(tmp_path / "nothing"))
    assert main(["campaign", str(write_deck(tmp_path))]) == 2
    assert "expected the program dda" in capsys.readouterr().err


def part_of(folder: Path, dda: Path, first: int, last: int) -> Part:
    """A part of the deck of 30 cases."""
    deck = write_deck(folder)
    return Part(dda, deck, (), folder / "parts" / f"{first}-{last}", first, last, ask(Path(DDA), deck, []).record)


def test_program_that_is_killed_is_started_again(tmp_path: Path, unbroken) -> None:
    """Each start dies with two more rows in its table than the one before, sixteen times over."""
    dying, count = tmp_path / "dda", tmp_path / "count"
    count.write_text("1")
    dying.write_text(
        f"#!/bin/sh\n'{DDA}' \"$@\"\n"
        f"n=$(($(cat '{count}') + 2)); echo $n > '{count}'\n"
        'head -n $n "$4/results.csv" > "$4/cut"; mv "$4/cut" "$4/results.csv"\n'
        "[ $n -gt 31 ] || kill -9 $$\n"
    )
    dying.chmod(0o755)
    part = part_of(tmp_path, dying, 1, 30)
    assert run_part(part) == (0, "")
    assert int(count.read_text()) == 33
    merge([part.folder], 30, tmp_path, part.record, ask(Path(DDA), part.deck, []).headers)
    assert tables(tmp_path) == unbroken


def test_case_that_kills_the_program_holds_up_no_other(tmp_path: Path, capsys, monkeypatch) -> None:
    dying = tmp_path / "dda"
    dying.write_text(
        f"#!/bin/sh\ncase \" $* \" in *'--cases 4-'*|*'--cases 1-'*) kill -9 $$;; esac\nexec '{DDA}' \"$@\"\n")
    dying.chmod(0o755)
    part = part_of(tmp_path, dying, 4, 6)
    assert run_part(part) == (0, "")
    assert sorted(cases_of(part.folder / "results.csv")) == [5, 6]
    monkeypatch.setenv("VOUSSOIR_DDA", str(dying))
    assert main(["campaign", str(part.deck), "--out", str(tmp_path / "out")]) == 3
    assert "1 not finished" in capsys.readouterr().out


def test_rows_that_were_cut_off_are_not_taken(tmp_path: Path) -> None:
    table = tmp_path / "results.csv"
    table.write_text('deck,case,verdict,seconds\n"a,b",1,stable,0.1\na,2,stab')
    assert list(cases_of(table)) == [1]
    table.write_text("deck,case,verdict,seconds\na,1,stable\na,2,stable,0.1\n")
    assert list(cases_of(table))[-1] == 2 and 1 not in cases_of(table)


def test_part_that_another_program_computes_is_waited_for(tmp_path: Path, unbroken) -> None:
    """A worker that was killed may leave its program behind."""
    part = part_of(tmp_path, Path(DDA), 1, 30)
    part.folder.mkdir(parents=True)
    holder = subprocess.Popen(["flock", part.folder / "run.lock", "sleep", "0.5"])
    while subprocess.run(["flock", "-n", part.folder / "run.lock", "true"], check=False).returncode == 0:
        time.sleep(0.01)
    assert run_part(part) == (0, "")
    assert holder.wait() == 0
    assert len(list(cases_of(part.folder / "results.csv"))) == 30


def test_every_table_of_a_run_is_merged(tmp_path: Path) -> None:
    (tmp_path / "drop.blocks").write_text(
        "block fixed\n-1 -1\n1 -1\n1 0\n-1 0\nblock\n-0.5 0\n0.5 0\n0.5 1\n-0.5 1\n" "measure 0 0.5\n")
    deck = tmp_path / "drop.nml"
    deck.write_text(
        "&scene kind = 'blocks', geometry = 'drop.blocks' /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 0.02, time_step = 0.01 /\n"
        "&output frames = 2, energy = .true., reactions = .true. /\n"
        "&sweep parameter = 'friction_deg', values = 20, 30, 40 /\n"
    )
    subprocess.run([DDA, "run", deck, "--out", tmp_path / "one", "--quiet"], check=True)
    out = tmp_path / "out"
    assert main(["campaign", str(deck), "--out", str(out), "--workers", "2", "--quiet"]) == 0
    for name in set(TABLES) - {"results.csv", "bars.csv"}:  # it has no bars
        assert (out / name).read_text() == (tmp_path / "one" / name).read_text(), name
    again = subprocess.run([DDA, "run", deck, "--out", out, "--resume"], check=True, capture_output=True, text=True)
    assert "3 of 3 cases are already computed" in again.stdout
    assert {"points.csv", "energy.csv", "frames.csv"} <= {path.name for path in out.iterdir()}


def test_ranges_read_back() -> None:
    assert ranges_of(1, 10, set()) == "1-10"
    assert ranges_of(4, 9, {4, 6, 9}) == "5-5,7-8"


def computed(out: Path) -> set[int]:
    """Cases that parts have finished."""
    return {case for part in out.glob("parts/*") for case in cases_of(part / "results.csv")}


def test_campaign_killed_twice_loses_nothing(tmp_path: Path, unbroken) -> None:
    deck, out = write_deck(tmp_path), tmp_path / "out"
    command = [sys.executable, "-m", "voussoir", "campaign", str(deck), "--out", str(out)]
    known: set[int] = set()
    for _ in range(2):
        process = subprocess.Popen(command + ["--workers", "1", "--quiet"], start_new_session=True)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and process.poll() is None:
            if len(computed(out)) > len(known) + 3:
                os.killpg(process.pid, signal.SIGKILL)
                break
            time.sleep(0.002)
        process.wait()
        if (out / "results.csv").exists():
            break
        now = computed(out)
        assert now > known
        known = now
    assert subprocess.run(command, check=False).returncode == 0
    assert tables(out) == unbroken


def test_dask_cluster_gives_the_same_table_though_a_worker_is_killed(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: skipped")
    deck, out = write_deck(tmp_path, 200), tmp_path / "out"
    subprocess.run([DDA, "run", deck, "--out", tmp_path / "one", "--quiet"], check=True)
    with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        words = ["campaign", str(deck), "--out", str(out), "--scheduler", address]
        process = subprocess.Popen([sys.executable, "-m", "voussoir", *words])
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline and len(computed(out)) < 20:
            time.sleep(0.01)
        assert process.poll() is None
        os.kill(cluster.workers[0].pid, signal.SIGKILL)
        before = computed(out)
        assert 20 <= len(before) < 600
        assert process.wait(timeout=300) == 0
    assert tables(out) == tables(tmp_path / "one")


def test_parquet_has_the_cells_of_the_table(tmp_path: Path, monkeypatch) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed: skipped")
    monkeypatch.setattr("voussoir.campaign.parquet.BATCH", 7)  # several groups of rows
    out = tmp_path / "out"
    assert main(["campaign", str(write_deck(tmp_path)), "--out", str(out), "--parquet", "--quiet"]) == 0
    table, cases = parquet.read_table(out / "results.parquet"), results.read(out).cases
    assert parquet.ParquetFile(out / "results.parquet").num_row_groups == 5
    assert table.column_names == list(cases)
    assert table["critical"].to_numpy() == pytest.approx(cases["critical"], nan_ok=True, rel=0, abs=0)
    assert table["verdict"].to_pylist() == cases["verdict"].tolist()
    assert [tuple(row) for row in table["intrados_hinge_deg"].to_pylist()] == cases["intrados_hinge_deg"].tolist()


def test_parquet_without_its_package_is_reported_before_computing(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert main(["campaign", str(write_deck(tmp_path)), "--out", str(tmp_path / "out"), "--parquet"]) == 2
    assert "Parquet needs pyarrow, got none" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
