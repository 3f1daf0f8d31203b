"""Help: on every subcommand, in every way to ask; every option in it works, every default shows."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from dda_command import rows_of, run_dda

SUBCOMMANDS = ["run", "check", "cut", "export", "help"]
LINES = Path(__file__).parents[2] / "input" / "limerick" / "terrace.geo"
SWEEP = "&arch thickness_ratio = 0.12 /\n&sweep parameter = 'radius', first = 1, last = 4, count = 4 /\n"


def help_on(*words: str) -> str:
    """What a call for help prints; it must succeed and say nothing on standard error."""
    done = run_dda(*words)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.mark.parametrize("words", [(), ("help",), ("--help",), ("-h",)])
def test_first_page_names_every_subcommand_and_status(words: tuple[str, ...]) -> None:
    page = help_on(*words)
    assert [verb for verb in ("dda run", "dda check", "dda help", "--version") if verb not in page] == []
    for status in "0234":
        assert re.search(rf"[:;,] {status} |\b{status} ", page)


@pytest.mark.parametrize("verb", SUBCOMMANDS)
def test_every_way_to_ask_gives_the_same_page(verb: str) -> None:
    page = help_on("help", verb)
    assert page.startswith(f"dda {verb} ")
    assert page == help_on(verb, "--help") == help_on(verb, "-h")
    assert max(map(len, page.splitlines())) <= 100


def test_help_wins_over_other_options() -> None:
    assert help_on("run", "no such deck.nml", "--quiet", "--help") == help_on("help", "run")


def test_example_of_the_first_page_runs(tmp_path: Path) -> None:
    lines = [line.strip() for line in help_on().splitlines()]
    deck = [line for line in lines if line.startswith("&") and line.endswith("/")]
    assert len(deck) == 2
    (tmp_path / "arch.nml").write_text("\n".join(deck))
    assert run_dda("run", "arch.nml", cwd=tmp_path).returncode == 0
    assert "0.1074241" in (tmp_path / "arch" / "results.csv").read_text()


def test_version_is_that_of_the_project() -> None:
    project = (Path(__file__).parents[2] / "CMakeLists.txt").read_text()
    version = re.search(r"project\(voussoir VERSION ([\d.]+)", project)
    assert version
    assert help_on("--version") == f"dda {version[1]}\n"


def cases(folder: Path, name: str = "deck") -> int:
    """Number of rows of a table of results."""
    return (folder / name / "results.csv").read_text().count("\n") - 1


def run_out(folder: Path) -> None:
    assert run_dda("run", "deck.nml", "--out", "a/b", cwd=folder).returncode == 0
    assert cases(folder, "a/b") == 4


def run_jobs(folder: Path) -> None:
    tables = []
    for jobs in "13":
        assert run_dda("run", "deck.nml", "--jobs", jobs, "--out", jobs, cwd=folder).returncode == 0
        rows = [{**row, "seconds": ""} for row in rows_of(folder / jobs / "results.csv")]
        tables.append(sorted(map(str, rows)))
    assert tables[0] == tables[1]
    assert len(tables[0]) == 4


def run_set(folder: Path) -> None:
    done = run_dda("run", "deck.nml", "--set", "arch%voussoirs=7", "--set", "joint%friction_deg=60", cwd=folder)
    assert done.returncode == 0
    for row in (folder / "deck" / "results.csv").read_text().splitlines()[1:]:
        assert ",7,90,0.12,60," in row


def run_cases(folder: Path) -> None:
    assert run_dda("run", "deck.nml", "--cases", "4,1-2", cwd=folder).returncode == 0
    rows = (folder / "deck" / "results.csv").read_text().splitlines()[1:]
    assert [row.split(",")[1] for row in rows] == ["1", "2", "4"]
    assert run_dda("run", "deck.nml", "--resume", cwd=folder).returncode == 0
    assert cases(folder) == 4


def run_resume(folder: Path) -> None:
    table = folder / "deck" / "results.csv"
    assert run_dda("run", "deck.nml", cwd=folder).returncode == 0
    whole = table.read_text()
    table.write_text("".join(whole.splitlines(keepends=True)[:3]))
    assert run_dda("run", "deck.nml", "--resume", cwd=folder).returncode == 0
    assert table.read_text().splitlines()[:3] == whole.splitlines()[:3]
    assert cases(folder) == 4


def run_tight(folder: Path) -> None:
    write = (folder / "push.nml").write_text
    write("&arch thickness_ratio = 0.2, half_angle_deg = 80, voussoirs = 9 /\n&joint friction_deg = 40 /\n"
          "&search parameter = 'horizontal_coefficient' /\n&analysis flow = 'associated' /\n")
    assert run_dda("run", "push.nml", "--tight", cwd=folder).returncode == 0
    assert "search%tolerance\n  1e-11\n" in (folder / "push" / "deck.record").read_text()


def run_force(folder: Path) -> None:
    (folder / "deck").mkdir()
    (folder / "deck" / "results.csv").write_text("of others\n")
    assert run_dda("run", "deck.nml", cwd=folder).returncode == 4
    assert run_dda("run", "deck.nml", "--force", cwd=folder).returncode == 0
    assert cases(folder) == 4


def run_quiet(folder: Path) -> None:
    done = run_dda("run", "deck.nml", "--quiet", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert cases(folder) == 4


def check_set(folder: Path) -> None:
    done = run_dda("check", "deck.nml", "--set", "arch%voussoirs=7", cwd=folder)
    assert "7 free" in done.stdout


def check_record(folder: Path) -> None:
    done = run_dda("check", "deck.nml", "--record", cwd=folder)
    assert "\ndeck.record:\ndda " in done.stdout
    assert "deck.record:" not in run_dda("check", "deck.nml", cwd=folder).stdout


def check_quiet(folder: Path) -> None:
    done = run_dda("check", "deck.nml", "--quiet", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def cut_out(folder: Path) -> None:
    assert run_dda("cut", LINES, "--out", "blocks.csv", cwd=folder).returncode == 0
    assert (folder / "blocks.csv").read_text().count("\n") > 2


def cut_quiet(folder: Path) -> None:
    assert "terrace.geo: " in run_dda("cut", LINES, cwd=folder).stdout
    done = run_dda("cut", LINES, "--quiet", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def export_out(folder: Path) -> None:
    assert run_dda("export", "deck.nml", "--out", "files", cwd=folder).returncode == 0
    assert len(list((folder / "files").glob("*.geo"))) == 8


def export_set(folder: Path) -> None:
    for name, count in (("few", "4"), ("many", "40")):
        setting = f"arch%voussoirs={count}"
        done = run_dda("export", "deck.nml", "--out", name, "--set", setting, cwd=folder)
        assert done.returncode == 0
    few, many = (sum(file.stat().st_size for file in (folder / name).glob("*.geo")) for name in ("few", "many"))
    assert many > 2 * few


def export_quiet(folder: Path) -> None:
    done = run_dda("export", "deck.nml", "--quiet", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list(folder.glob("*.geo"))


def help_json(folder: Path) -> None:
    assert json.loads(help_on("help", "keys", "--json"))["groups"][0]["name"] == "scene"


#: Subcommand and option: what proves that the option works
PROOFS: dict[tuple[str, str], Callable[[Path], None]] = {
    ("run", "--out"): run_out, ("run", "--jobs"): run_jobs, ("run", "--set"): run_set, ("run", "--cases"): run_cases,
    ("run", "--resume"): run_resume, ("run", "--tight"): run_tight, ("run", "--quiet"): run_quiet,
    ("run", "--force"): run_force, ("help", "--json"): help_json,
    ("check", "--set"): check_set, ("check", "--record"): check_record, ("check", "--quiet"): check_quiet,
    ("cut", "--out"): cut_out, ("cut", "--quiet"): cut_quiet, ("export", "--out"): export_out,
    ("export", "--set"): export_set, ("export", "--quiet"): export_quiet}


def options_of(verb: str) -> dict[str, str]:
    """Options on the page of a subcommand, with what the page says of each."""
    parts = re.split(r"^   (--[a-z-]+)", help_on("help", verb), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("verb", SUBCOMMANDS)
def test_every_option_of_a_page_has_a_proof(verb: str) -> None:
    listed = {(verb, option) for option in options_of(verb) if option != "--help"}
    assert listed == {proof for proof in PROOFS if proof[0] == verb}


@pytest.mark.parametrize("verb", SUBCOMMANDS)
def test_every_option_says_what_holds_without_it(verb: str) -> None:
    for option, text in options_of(verb).items():
        assert option == "--help" or "without it" in text or "default" in text, option


@pytest.mark.parametrize(("verb", "option"), PROOFS)
def test_option_works(tmp_path: Path, verb: str, option: str) -> None:
    (tmp_path / "deck.nml").write_text(SWEEP)
    PROOFS[verb, option](tmp_path)


def test_every_key_shows_its_default_or_what_holds_without_it() -> None:
    keys = re.findall(r"^   (\w+)(.*)\n      (.+)", help_on("help", "keys"), flags=re.MULTILINE)
    assert len(keys) > 40
    bare = [name for name, rest, _ in keys if not re.search(r" = |without it|\(required", rest)]
    assert set(bare) <= {"geometry", "analysis", "parameter"}


def test_required_keys_are_not_left_out(tmp_path: Path) -> None:
    """Help names them as required, and no message advises to leave one out."""
    assert "   height   (required)\n" in help_on("help", "fill%height")
    (tmp_path / "a.nml").write_text("&arch /\n&fill height = x, unit_weight = 1 /\n")
    message = run_dda("check", "a.nml", cwd=tmp_path).stderr
    assert "fill%height must be a number" in message and message.endswith("; correct it\n")


def test_commands_of_voussoir_are_named() -> None:
    main = (Path(__file__).resolve().parents[2] / "post/voussoir/command/main.py").read_text(encoding="utf-8")
    commands = set(re.findall(r'^    "([\w-]+)": \("voussoir\.', main, flags=re.MULTILINE)) - {"lines", "export"}
    assert len(commands) > 10 and "'voussoir help'" in help_on()
    for command in commands:
        done = run_dda(command, "x")
        assert (done.returncode, done.stderr) == (
            2, f"dda:1: error: expected a subcommand of dda, got '{command}', which voussoir has; write "
            f"'voussoir {command}'\n")
        assert run_dda("help", command).stderr.endswith(f"; write 'voussoir help {command}'\n")


def test_help_on_a_group_a_key_or_both() -> None:
    everything = help_on("help", "keys")
    joint = help_on("help", "&joint")
    assert joint == help_on("help", "joint") == help_on("help", "JOINT") and joint in everything
    assert joint.startswith("&joint   ") and "   friction_deg = 50.0\n" in joint and "&load" not in joint
    radius = help_on("help", "radius")
    assert radius == help_on("help", "arch%radius") and radius.count("\n") == 4
    owners = re.findall(r"^&(\w+)", help_on("help", "friction_deg"), flags=re.MULTILINE)
    assert owners[:2] == ["fill", "joint"]
    assert re.findall(r"^&(\w+)", help_on("help", "analysis"), flags=re.MULTILINE) == ["scene", "analysis"]
    assert help_on("help", "outline").startswith("&outline   ")


def test_help_on_a_file_of_blocks_has_every_entry_of_the_page() -> None:
    page = (Path(__file__).resolve().parents[2] / "docs" / "input.md").read_text(encoding="utf-8")
    table = page[page.index("| entry | meaning |"):].split("\n\n")[0]
    entries = [row.split(" | ")[0].strip("| ").replace("`", "") for row in table.splitlines()[2:]]
    printed = help_on("help", "blocks").splitlines()
    assert len(entries) >= 16 and [entry for entry in entries if entry not in printed] == []


def test_keys_as_json_are_the_keys_as_text() -> None:
    groups = json.loads(help_on("help", "keys", "--json"))["groups"]
    text = help_on("help", "keys")
    heads = [f"&{group['name']}   {group['meaning']}" for group in groups]
    assert heads == re.findall("^&.*", text, flags=re.MULTILINE)
    names = re.findall(r"^ {3}(\w+)", text, flags=re.MULTILINE)
    assert [key["name"] for group in groups for key in group["keys"]] == names
    keys = {(group["name"], key["name"]): key for group in groups for key in group["keys"]}
    assert keys["arch", "radius"] == {
        "name": "radius", "kind": "number", "unit": "m", "default": "10.0", "from": 1e-9, "to": 1e9, "sweep": True,
        "search": True, "meaning": "Radius of the centre line, half way between intrados and extrados."}
    assert keys["scene", "kind"]["words"] == ["arch", "lines", "blocks"]
    assert (keys["material", "poisson"]["above"], keys["material", "poisson"]["below"]) == (-1.0, 0.5)
    assert keys["arch", "joints_deg"]["without"] == "equal voussoirs"


@pytest.mark.parametrize("words", [["nothing"], ["keys", "--jsn"], ["radius", "span"], ["keys", "--json", "more"]])
def test_help_on_nothing_known_is_one_line(words: list[str]) -> None:
    done = run_dda("help", *words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert re.match(r"dda:[23]: error: expected ", done.stderr)
