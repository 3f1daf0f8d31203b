"""The ground in time: records, pulses, their scale, and what of them is refused."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from block_scene import box
from dda_command import rows_of, run_dda

BLOCKS = "block fixed\n-9 -1\n9 -1\n9 0\n-9 0\nblock\n0 0\n1 0\n1 2\n0 2\nmeasure 0.5 1\n"
RECORD = "Station 7, in g\ntime,\"East\",up\n0.0,0.2,0\n\n# later\n0.1, -0.5,0\n0.25, 0.3,0\n0.4,0.0,0\n"
#: Gravity is off and the base far below in effect: the block flies, and goes back as the ground goes forth
FREE = "&load gravity = 0 /\n&analysis mode = 'dynamic', geometry = 'current', duration = 0.6, steps = 100000{more} /\n"


def rows(folder: Path, table: str) -> list[dict[str, str]]:
    """Rows of a table."""
    return rows_of(folder / "out" / f"{table}.csv")


def run(folder: Path, blocks: str, groups: str, *settings: str, command: str = "run") -> tuple[int, str]:
    """Run a scene of blocks: status and messages."""
    (folder / "x.blocks").write_text(blocks)
    (folder / "x.nml").write_text(f"&scene kind = 'blocks', geometry = 'x.blocks' /\n{groups}")
    out = ("--out", "out", "--quiet") if command == "run" else ()
    done = run_dda(command, "x.nml", *out, *settings, cwd=folder)
    return done.returncode, done.stderr


def test_quantities_and_both_homes_of_a_record_agree(tmp_path: Path) -> None:
    """A ramp of velocity is a constant acceleration, and so is a parabola; in the file of blocks as in &ground."""
    (tmp_path / "a.csv").write_text("0,1.5\n0.6,1.5\n")
    (tmp_path / "v.csv").write_text("0 0\n0.6 0.9\n")
    (tmp_path / "d.csv").write_text("".join(f"{t / 10},{0.75 * (t / 10) ** 2}\n" for t in range(7)))
    ways = []
    for word, name in (("acceleration", "a"), ("velocity", "v"), ("displacement", "d")):
        status, message = run(
            tmp_path, BLOCKS + f"base_{word} file '{name}.csv' scale 2\n", FREE.format(more=", time_step = 0.01"))
        assert status == 0, message
        ways.append(float(rows(tmp_path, "points")[-1]["u"]))
        group = f"&ground record = '{name}.csv', quantity = '{word}', unit = 4.0, scale = 0.5 /\n"
        status, message = run(tmp_path, BLOCKS, group + FREE.format(more=", time_step = 0.01"))
        assert status == 0, message
        ways.append(float(rows(tmp_path, "points")[-1]["u"]))
    assert ways == pytest.approx([-3.0 * 0.6**2 / 2] * 6, rel=1e-9)


@pytest.mark.parametrize("separator", [";", ",", "\t"], ids=["semicolon", "comma", "tab"])
def test_columns_whose_names_have_blanks_are_named_in_both_homes(tmp_path: Path, separator: str) -> None:
    """The moved block is that of the same record by the numbers of its columns."""
    names, lines = ["Time (s)", "Vertical", "Acc NS (g)"], ["0 0 1.5", "0.6 0 1.5"]
    text = "\n".join(separator.join(words) for words in [names, *(line.split() for line in lines)])
    (tmp_path / "a.csv").write_text(text + "\n")
    step = FREE.format(more=", time_step = 0.01")
    ways = []
    for columns in ("1 3", "time (s); Acc NS (g)", "Time (s), acc ns (g)"):
        status, message = run(tmp_path, BLOCKS, f"&ground record = 'a.csv', columns = '{columns}', unit = 2 /\n{step}")
        assert status == 0, message
        ways.append(float(rows(tmp_path, "points")[-1]["u"]))
    for columns in ("1 3", "'Time (s)' \"Acc NS (g)\"", "1 'ACC NS (G)' '0'"):
        base = f"base_acceleration file 'a.csv' columns {columns} scale 2\n"
        status, message = run(tmp_path, BLOCKS + base, step)
        assert status == 0, message
        ways.append(float(rows(tmp_path, "points")[-1]["u"]))
    assert ways == pytest.approx([-3.0 * 0.6**2 / 2] * 6, rel=1e-9)


def test_a_led_point_follows_its_record(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("t,ux,uy\n0,0,0\n0.5,20,-8\n")
    led = BLOCKS + "".join(f"displacement {x} 1 file 'p.csv' columns t ux uy scale 0.001\n" for x in (0.2, 0.8))
    status, message = run(tmp_path, led.replace("block fixed\n-9 -1\n9 -1\n9 0\n-9 0\n", ""),
                          FREE.format(more=", time_step = 0.05"))
    assert status == 0, message
    end = rows(tmp_path, "points")[-1]
    assert (float(end["u"]), float(end["v"])) == pytest.approx((0.02, -0.008), abs=1e-9)


def test_an_amplitude_brings_a_record_to_it(tmp_path: Path) -> None:
    """Decks of one amplitude are equal whatever the record's unit, and are swept by record and amplitude."""
    (tmp_path / "One.csv").write_text("0,0\n0.1,4\n0.2,-8\n0.3,0\n")
    (tmp_path / "two.csv").write_text("0,0\n0.1,0.05\n0.2,-0.1\n0.3,0\n")
    deck = FREE.format(more=", time_step = 0.01") + (
        "&ground unit = 1.0, record = 'One.csv' /\n"
        "&sweep parameter = 'record', texts = 'One.csv', 'two.csv' /\n"
        "&sweep parameter = 'amplitude', values = 1, 3 /\n")
    status, message = run(tmp_path, BLOCKS, deck)
    assert status == 0, message
    results = rows(tmp_path, "results")
    assert [row["record"] for row in results] == ["One.csv"] * 2 + ["two.csv"] * 2
    ends: dict[str, str] = {row["case"]: row["u"] for row in rows(tmp_path, "points")}
    ways = [float(ends[case]) for case in "1234"]
    assert ways[0] == pytest.approx(ways[2], rel=1e-12) and ways[1] == pytest.approx(3 * ways[0], rel=1e-12)


def test_a_changed_record_is_another_deck(tmp_path: Path) -> None:
    """--resume keeps what was done with the same record, and nothing of another one."""
    (tmp_path / "q.csv").write_text(RECORD)
    blocks = BLOCKS + "base_acceleration file 'q.csv'\n"
    for text, words in ((RECORD, "1 of 1"), (RECORD.replace("0.3", "0.4"), "")):
        run(tmp_path, blocks, FREE.format(more=", time_step = 0.1"))
        (tmp_path / "q.csv").write_text(text)
        done = run_dda("run", "x.nml", "--out", "out", "--resume", cwd=tmp_path)
        assert done.returncode == 0
        assert ("already" in done.stdout + done.stderr) == bool(words), done.stdout + done.stderr


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("base_acceleration file quake.csv", "in quotes after 'file'"),
        ("base_acceleration file", "in quotes after 'file'"),
        ("base_acceleration file 'no.csv'", "there is no such file"),
        ("base_acceleration file 'q.csv", "expected a second quote"),
        ("base_acceleration file 'q.csv' 'q.csv'", "expected one text in quotes"),
        ("base_acceleration file 'q.csv' columns 1", "two or three columns"),
        ("base_acceleration file 'q.csv' columns 1 2 3 4", "two or three columns"),
        ("base_acceleration file 'q.csv' columns 0 2", "expected column '0'"),
        ("base_acceleration file 'q.csv' columns 1 north", "expected column 'north'"),
        ("base_acceleration file 'q.csv' columns 1 9", "in column 9, got ''"),
        ("base_acceleration file 'q.csv' scale", "1 numbers after 'scale'"),
        ("base_acceleration file 'q.csv' scale 1 scale 2", "once each"),
        ("base_acceleration file 'q.csv' speed 1", "expected columns or scale"),
        ("base_acceleration file 'q.csv'\n0 1 1", "got both"),
        ("base_acceleration 1 2 file 'q.csv'", "expected two components"),
        ("fix 0.5 1 file 'q.csv'", "unknown word 'file'"),
        ("block 'q.csv'", "got '''"),
    ],
)
def test_a_line_that_names_a_record_badly_is_refused(tmp_path: Path, line: str, words: str) -> None:
    (tmp_path / "q.csv").write_text(RECORD)
    status, message = run(tmp_path, BLOCKS + line + "\n", FREE.format(more=""), command="check")
    assert status == 2 and words in message and message.count("\n") == 1, message


def test_a_message_shows_no_byte_that_is_no_letter(tmp_path: Path) -> None:
    (tmp_path / "q.csv").write_text(RECORD)
    (tmp_path / "x.blocks").write_text(BLOCKS)
    deck = b"&scene kind = 'blocks', geometry = 'x.blocks' /\n&ground record = 'q.csv', columns = '1\xc3\xa9east' /\n"
    (tmp_path / "x.nml").write_bytes(deck + FREE.format(more="").encode())
    done = run_dda("check", "x.nml", cwd=tmp_path)
    assert done.returncode == 2
    assert "got '1?east'" in done.stderr


def test_residuals_of_rounding_are_not_reported(tmp_path: Path) -> None:
    """Blocks that are as good as at rest leave 3e-15 m/s, far below what gravity adds in a step: the log is silent."""
    drums = "".join(f"block\n-0.4 {y}\n0.4 {y}\n0.4 {y + 1}\n-0.4 {y + 1}\n" for y in range(4))
    (tmp_path / "quake.csv").write_text("".join(
        f"{i / 50} {0.5 * math.exp(-i / 100) * math.sin(6 * i / 50)}\n" for i in range(201)))
    status, message = run(
        tmp_path, "block fixed\n-3 -0.5\n3 -0.5\n3 0\n-3 0\n" + drums,
        "&material density = 2600 /\n&joint friction_deg = 35 /\n&ground record = 'quake.csv', unit = 9.81 /\n"
        "&analysis mode = 'dynamic', geometry = 'current', start = 'static', unknowns = 3, time_step = 4e-3, "
        "duration = 0.1 /\n")
    assert status == 0, message
    assert float(rows(tmp_path, "results")[0]["contact_residual"]) < 1e-12
    assert "law of contact" not in (tmp_path / "out" / "log.txt").read_text()


@pytest.mark.parametrize("slabs", [1, 2, 3])
def test_slabs_that_move_together_turn_within_a_step(tmp_path: Path, slabs: int) -> None:
    """Slabs that slide on the ground are stopped by its motion and slide back, in whatever part of a step."""
    friction, shake, speed, time = math.tan(math.radians(6.0)) * 9.81, 1.2, 0.01, 0.0201
    text = box(-5.0, -1.0, 10.0, 1.0, "fixed") + "material 2 density 2400\njoint 1 2 friction_deg 6\n"
    text += "".join(box(-1.0, 0.1 * k, 2.0, 0.1, f"material 2 velocity {speed!r} 0 0") for k in range(slabs))
    text += f"measure block 2 0 0.05\nbase_acceleration\n0 {shake} 0\n10 {shake} 0\n"
    status, message = run(
        tmp_path, text, "&joint friction_deg = 20 /\n&material young = 1e12 /\n&analysis mode = 'dynamic', "
        f"geometry = 'current', time_step = 1e-3, duration = {time}, unknowns = 3 /\n")
    assert status == 0, message
    end = rows(tmp_path, "points")[-1]
    stop = speed / (shake + friction)
    back = (shake - friction) * (time - stop)
    assert float(end["vx"]) == pytest.approx(-back, abs=1e-10)
    assert float(end["u"]) == pytest.approx((speed * stop - back * (time - stop)) / 2, abs=1e-12)
