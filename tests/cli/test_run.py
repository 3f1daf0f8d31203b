"""The command dda as a whole: help, exit statuses, folders, names, jobs, repetition."""

from __future__ import annotations

import os
import pty
import subprocess
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

STABLE = "&arch thickness_ratio = 0.12 /\n"
UNDECIDED = "&arch thickness_ratio = 0.12 /\n&analysis geometry = 'current', steps = 1 /\n"
BAD = "&arch\n thickness_ratio = 2 /\n"
PROOFS = ["proof_forces.csv", "proof_motion.csv"]
TABLES = ["blocks.csv", "joints.csv", "log.txt", *PROOFS, "reactions.csv", "results.csv"]
FILES = sorted(["deck.record", "run.lock", "sizes.record", *TABLES])


def write_decks(folder: Path, **texts: str) -> None:
    """Write decks into a folder."""
    for name, text in texts.items():
        (folder / f"{name}.nml").write_text(text)


def cases_of(folder: Path) -> list[dict[str, str]]:
    """Rows of results.csv in a folder, by case."""
    return sorted(rows_of(folder / "results.csv"), key=lambda row: int(row["case"]))


def names_in(folder: Path) -> list[str]:
    """Sorted names of what a folder holds."""
    return sorted(path.name for path in folder.iterdir())


# exit statuses


@pytest.mark.parametrize(
    ("decks", "status"),
    [
        (["stable"], 0),
        (["bad"], 2),
        (["undecided"], 3),
        (["blocked"], 4),
        (["stable", "undecided"], 3),
        (["undecided", "bad"], 2),
        (["bad", "undecided", "stable"], 2),
        (["blocked", "undecided"], 4),
        (["undecided", "blocked"], 4),
        (["blocked", "bad"], 4),
        (["bad", "undecided", "blocked", "stable"], 4),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, list) else None,
)
def test_first_of_4_2_3_is_the_exit_status(tmp_path: Path, decks: list[str], status: int) -> None:
    write_decks(tmp_path, stable=STABLE, undecided=UNDECIDED, bad=BAD, blocked=STABLE)
    (tmp_path / "blocked").write_text("a file where the folder would be")
    done = run_dda("run", *[f"{deck}.nml" for deck in decks], cwd=tmp_path)
    assert done.returncode == status
    for deck in decks:
        written = (tmp_path / deck / "results.csv").exists()
        assert written == (deck in ("stable", "undecided"))


def test_a_dynamic_run_may_take_the_steps_of_its_duration(tmp_path: Path) -> None:
    """Six hundred of a millisecond, where nobody has said how many."""
    motion = "&analysis mode = 'dynamic', geometry = 'current', duration = 0.6, time_step = 1e-3 /\n"
    write_decks(tmp_path, deck=STABLE + motion)
    assert run_dda("run", "deck.nml", cwd=tmp_path).returncode == 0
    (row,) = cases_of(tmp_path / "deck")
    assert row["verdict"] == "completed"
    assert int(row["steps"]) >= 600


# results that cannot be written


@pytest.mark.parametrize("table", TABLES)
def test_folder_in_place_of_a_table_gives_4(tmp_path: Path, table: str) -> None:
    write_decks(tmp_path, deck=STABLE)
    (tmp_path / "deck" / table).mkdir(parents=True)
    done = run_dda("run", "deck.nml", cwd=tmp_path)
    assert done.returncode == 4
    assert f"deck/{table}" in done.stderr


@pytest.mark.parametrize("out", ["file", "file/below", "deck.nml", "/proc/none/below"])
def test_output_folder_that_cannot_be_made_gives_4(tmp_path: Path, out: str) -> None:
    write_decks(tmp_path, deck=STABLE)
    (tmp_path / "file").write_text("kept")
    done = run_dda("run", "deck.nml", "--out", out, cwd=tmp_path)
    assert done.returncode == 4
    assert "error: " in done.stderr
    assert "case" not in done.stdout
    assert (tmp_path / "file").read_text() == "kept"
    assert (tmp_path / "deck.nml").read_text() == STABLE


# where results go


def test_default_folder_is_named_as_the_deck_in_the_current_folder(tmp_path: Path) -> None:
    (tmp_path / "decks").mkdir()
    (tmp_path / "work").mkdir()
    write_decks(tmp_path / "decks", arch=STABLE)
    assert run_dda("run", "../decks/arch.nml", cwd=tmp_path / "work").returncode == 0
    assert names_in(tmp_path / "work") == ["arch"]
    assert names_in(tmp_path / "decks") == ["arch.nml"]
    assert names_in(tmp_path / "work" / "arch") == FILES


def test_only_the_last_ending_is_cut(tmp_path: Path) -> None:
    (tmp_path / "arch.v1.nml").write_text(STABLE)
    assert run_dda("run", "arch.v1.nml", cwd=tmp_path).returncode == 0
    (row,) = cases_of(tmp_path / "arch.v1")
    assert row["deck"] == "arch.v1"


def test_out_of_one_deck_is_the_folder_itself(tmp_path: Path) -> None:
    write_decks(tmp_path, deck=STABLE)
    assert run_dda("run", "deck.nml", "--out", "a/b/c", cwd=tmp_path).returncode == 0
    assert names_in(tmp_path / "a" / "b" / "c") == FILES
    assert not (tmp_path / "deck").exists()


def test_out_of_several_decks_has_a_folder_for_each(tmp_path: Path) -> None:
    write_decks(tmp_path, one=STABLE, two=STABLE)
    done = run_dda("run", "one.nml", "two.nml", "--out", "both", cwd=tmp_path)
    assert done.returncode == 0
    assert names_in(tmp_path / "both") == ["one", "two"]
    assert names_in(tmp_path / "both" / "two") == FILES


def test_out_may_be_absolute_and_end_in_a_slash(tmp_path: Path) -> None:
    write_decks(tmp_path, deck=STABLE)
    assert run_dda("run", "deck.nml", "--out", f"{tmp_path}/results/", cwd=tmp_path).returncode == 0
    assert names_in(tmp_path / "results") == FILES


def test_results_of_an_earlier_run_are_replaced(tmp_path: Path) -> None:
    sweep = "&sweep parameter = 'radius', values = 5, 10, 20 /\n"
    write_decks(tmp_path, many=STABLE + sweep, one=STABLE + "&output joints = .false., blocks = .false. /\n")
    assert run_dda("run", "many.nml", "--out", "results", cwd=tmp_path).returncode == 0
    assert run_dda("run", "one.nml", "--out", "results", cwd=tmp_path).returncode == 0
    assert len(cases_of(tmp_path / "results")) == 1
    files = ["deck.record", "log.txt", "results.csv", "run.lock", "sizes.record"]
    assert names_in(tmp_path / "results") == files


# names


@pytest.mark.parametrize(
    "name",
    [
        "with blanks in it.nml",
        " leading blank.nml",
        "Bögen-鱼-🏛.nml",
        "quote'd \"twice\", and; commas.nml",
        "semi;colon&ampersand$dollar*star?.nml",
        "-begins-with-a-dash.nml",
        "per%cent=equals.nml",
        "n" * 250 + ".nml",
        "UPPER.NML",
        "deck.",
        "deck.nml.txt",
    ],
)
def test_hostile_names_are_names(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(STABLE)
    done = run_dda("run", f"./{name}", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    stem = Path(name).stem if not name.endswith(".") else name[:-1]
    (row,) = cases_of(tmp_path / stem)
    assert row["deck"] == stem
    assert row["verdict"] == "stable"


def test_deep_folders_are_found_and_made(tmp_path: Path) -> None:
    deep = Path(*["d" * 200] * 8)
    (tmp_path / deep).mkdir(parents=True)
    (tmp_path / deep / "deck.nml").write_text(STABLE)
    done = run_dda("run", deep / "deck.nml", "--out", deep / "results", cwd=tmp_path)
    assert done.returncode == 0
    assert names_in(tmp_path / deep / "results") == FILES


def test_deck_without_an_ending_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "deck").write_text(STABLE)
    run_dda("run", "deck", cwd=tmp_path)
    assert (tmp_path / "deck").read_text() == STABLE
    assert run_dda("run", "deck", "--out", "results", cwd=tmp_path).returncode == 0


# what is printed


def test_quiet_prints_nothing(tmp_path: Path) -> None:
    write_decks(tmp_path, one=STABLE, two=UNDECIDED)
    done = run_dda("run", "one.nml", "two.nml", "--quiet", cwd=tmp_path)
    assert done.returncode == 3
    assert done.stdout == done.stderr == ""


def test_no_progress_where_standard_error_is_no_terminal(tmp_path: Path) -> None:
    write_decks(tmp_path, deck=STABLE + "&sweep parameter = 'radius', values = 5, 10 /\n")
    done = run_dda("run", "deck.nml", cwd=tmp_path)
    assert done.stderr == ""
    assert "deck/results.csv" in done.stdout


@pytest.mark.parametrize("quiet", [False, True])
def test_progress_goes_to_a_terminal_unless_quiet(tmp_path: Path, quiet: bool) -> None:
    write_decks(tmp_path, deck=STABLE + "&sweep parameter = 'radius', values = 5, 10, 20 /\n")
    try:
        ours, theirs = pty.openpty()
    except OSError as problem:
        pytest.skip(f"no terminal is to be had here: {problem}")
    done = subprocess.run(
        [os.environ["DDA"], "run", "deck.nml", *["--quiet"] * quiet], cwd=tmp_path, stdout=subprocess.DEVNULL,
        stderr=theirs, timeout=60.0, check=False)
    os.write(theirs, b"end")
    shown = os.read(ours, 10000).decode()
    os.close(theirs)
    os.close(ours)
    assert done.returncode == 0
    assert (shown == "end") == quiet
    assert ("2 of 3" in shown and " s left" in shown) != quiet


def test_options_may_stand_before_the_decks(tmp_path: Path) -> None:
    write_decks(tmp_path, deck=STABLE)
    assert run_dda("run", "--quiet", "--out", "o", "deck.nml", cwd=tmp_path).returncode == 0
    assert names_in(tmp_path / "o") == FILES


# --set


@pytest.mark.parametrize(
    ("setting", "column", "value"),
    [
        ("arch%half_angle_deg=60", "half_angle_deg", 60.0),
        ("ARCH%Half_Angle_deg = 6e1", "half_angle_deg", 60.0),
        ("arch%voussoirs=12", "blocks", 12.0),
        ("arch%joints_deg=0,50,100", "half_angle_deg", 100.0),
        ("arch%joints_deg=0 50 100", "blocks", 4.0),
        ("joint%friction_deg=45", "friction_deg", 45.0),
        ("arch%springing=no-slip", "blocks", 36.0),
        ("arch%springing='no-slip'", "blocks", 36.0),
        ('scene%title="a, b"', "blocks", 36.0),
        ("scene%title=a, b", "blocks", 36.0),
    ],
)
def test_set_overrides_the_deck(tmp_path: Path, setting: str, column: str, value: float) -> None:
    write_decks(tmp_path, deck="&arch thickness_ratio = 0.3 /\n")
    done = run_dda("run", "deck.nml", "--set", setting, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (row,) = cases_of(tmp_path / "deck")
    assert float(row[column]) == value


def test_set_may_switch_joints_off(tmp_path: Path) -> None:
    write_decks(tmp_path, deck=STABLE)
    setting = "output%joints=.false."
    assert run_dda("run", "deck.nml", "--set", setting, cwd=tmp_path).returncode == 0
    left_out = ("joints.csv", "reactions.csv", *PROOFS)
    assert names_in(tmp_path / "deck") == [name for name in FILES if name not in left_out]


def test_long_set_is_not_cut(tmp_path: Path) -> None:
    joints = ",".join(f"{0.18 * number:.10f}" for number in range(501))
    assert len(joints) > 4096
    write_decks(tmp_path, deck=STABLE)
    done = run_dda("run", "deck.nml", "--set", f"arch%joints_deg={joints}", cwd=tmp_path)
    assert done.returncode in (0, 2)
    if done.returncode == 0:
        (row,) = cases_of(tmp_path / "deck")
        assert row["blocks"] == "1000"


# repetition, jobs and a kill

MANY = (
    "&search /\n"
    "&sweep parameter = 'half_angle_deg', values = 60, 90, 120 /\n"
    "&sweep parameter = 'voussoirs', values = 4, 7, 36, 100 /\n"
)


def without_seconds(folder: Path) -> list[dict[str, str]]:
    """Rows of results.csv by case, wall times left out."""
    rows = cases_of(folder)
    for row in rows:
        del row["seconds"]
    return rows


def sorted_lines(file: Path) -> list[str]:
    """Lines of a file in order of the alphabet."""
    return sorted(file.read_text().splitlines())


@pytest.mark.parametrize("jobs", ["1", "2", "5"])
def test_repeated_runs_agree_bit_for_bit(tmp_path: Path, jobs: str) -> None:
    write_decks(tmp_path, deck=MANY)
    for out, number in (("first", "1"), ("second", jobs)):
        done = run_dda("run", "deck.nml", "--out", out, "--jobs", number, cwd=tmp_path)
        assert done.returncode == 0
    first, second = tmp_path / "first", tmp_path / "second"
    assert without_seconds(first) == without_seconds(second)
    assert sorted_lines(first / "joints.csv") == sorted_lines(second / "joints.csv")
    assert sorted_lines(first / "log.txt") == sorted_lines(second / "log.txt")


def test_one_job_writes_the_cases_in_order(tmp_path: Path) -> None:
    write_decks(tmp_path, deck=MANY)
    assert run_dda("run", "deck.nml", cwd=tmp_path).returncode == 0
    assert [int(row["case"]) for row in rows_of(tmp_path / "deck" / "results.csv")] == list(range(1, 13))


@pytest.mark.parametrize("jobs", ["64", "100000", "2147483647"])
def test_more_jobs_than_cases_do_no_harm(tmp_path: Path, jobs: str) -> None:
    write_decks(tmp_path, deck=STABLE + "&sweep parameter = 'radius', values = 5, 10 /\n")
    done = run_dda("run", "deck.nml", "--jobs", jobs, cwd=tmp_path)
    assert done.returncode == 0
    assert len(cases_of(tmp_path / "deck")) == 2


@pytest.mark.parametrize("name", ["-dash.nml", "--quiet", "--", "-"])
def test_names_that_begin_with_a_dash_follow_two_dashes(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(STABLE)
    for verb in ("check", "export"):
        assert run_dda(verb, "--", name, cwd=tmp_path).returncode == 0
    done = run_dda("run", "--out", "out", "--", name, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [row["verdict"] for row in cases_of(tmp_path / "out")] == ["stable"]
    assert run_dda("run", "--out", "out", f"./{name}", cwd=tmp_path).returncode == 0
    assert run_dda("run", "--out", "out", "--", "./" + name, "--quiet", cwd=tmp_path).returncode == 2
