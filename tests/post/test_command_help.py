"""Help of `voussoir`: on every subcommand, every default shown, every option run by some test."""

from __future__ import annotations

import argparse
import ast
import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import page_rules
import pytest

from voussoir import __version__
from voussoir.command import main as command_line
from voussoir.command.main import build_parser, main

COMMANDS = {**command_line.COMMANDS, **command_line.SOURCE_COMMANDS}

TESTS = Path(__file__).parents[1]


def help_of(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What a call for help prints."""
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert stop.value.code == 0
    return capsys.readouterr().out


def parser_of(command: str) -> argparse.ArgumentParser:
    """The parser of a subcommand."""
    parser = argparse.ArgumentParser()
    importlib.import_module(COMMANDS[command][0]).add_arguments(parser)
    return parser


def options_of(command: str) -> Iterator[argparse.Action]:
    """Options of a subcommand but --help."""
    for action in parser_of(command)._actions:
        if action.option_strings and action.option_strings[-1] != "--help":
            yield action


@pytest.mark.parametrize("words", [[], ["help"], ["--help"], ["-h"], ["help", "help"]])
def test_first_page_names_every_subcommand(words: list[str], capsys) -> None:
    page = help_of(words, capsys)
    assert [name for name in COMMANDS if name not in page] == []


def test_version_is_reported(capsys) -> None:
    assert help_of(["--version"], capsys) == f"voussoir {__version__}\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_every_way_to_ask_gives_the_same_page(command: str, capsys) -> None:
    page = help_of(["help", command], capsys)
    assert page == help_of([command, "--help"], capsys)
    for action in parser_of(command)._actions:
        assert action.help, f"{command} {action.dest} is not explained"
        assert (action.option_strings or [action.metavar or action.dest])[-1] in page


@pytest.mark.parametrize("command", COMMANDS)
def test_every_default_is_shown(command: str, capsys) -> None:
    subparsers = build_parser(command)._subparsers._group_actions[0].choices
    show = subparsers[command]._get_formatter()._get_help_string
    for action in options_of(command):
        assert action.required or "default" in show(action), action.option_strings


@pytest.mark.parametrize("command", [None, *COMMANDS])
def test_help_is_in_the_words_of_the_pages(command: str | None, tmp_path: Path, capsys) -> None:
    page = tmp_path / "help.md"
    page.write_text(help_of(["help", *filter(None, [command])], capsys).replace("`", ""))
    assert [line for line in page_rules.offences(page) if "words per sentence" not in line] == []


@pytest.mark.parametrize("verb", ["run", "check", "cut"])
def test_verbs_of_dda_are_named(verb: str, capsys) -> None:
    assert main([verb, "a.nml"]) == 2
    assert capsys.readouterr().err == (
        f"voussoir: error: expected a command of voussoir, got '{verb}', which dda has; write 'dda {verb}'\n")
    assert "'dda run DECK'" in " ".join(help_of(["help"], capsys).split())


@pytest.mark.parametrize("command", command_line.SOURCE_COMMANDS)
def test_commands_that_are_not_installed_are_named(command: str) -> None:
    package = Path(command_line.__file__).parents[1]  # without the packages beside it
    code = f"""import sys, types; voussoir = types.ModuleType("voussoir"); voussoir.__path__ = [{str(package)!r}]
sys.modules["voussoir"], voussoir.__version__ = voussoir, ""
from voussoir.command.main import main; sys.exit(main([{command!r}, "--quiet"]))"""
    done = subprocess.run([sys.executable, "-I", "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (2, (
        f"voussoir: error: expected an installed command, got '{command}', which a build of the source has; write "
        f"'build/bin/voussoir {command}' there\n"))


def words_of_calls() -> Iterator[set[str]]:
    """Words of each list, tuple or call in the tests, where they are written out."""
    for file in TESTS.rglob("test_*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, (ast.List, ast.Tuple, ast.Call)):
                parts = [part for part in ast.walk(node) if isinstance(part, ast.Constant)]
                yield {part.value.split("=")[0] for part in parts if isinstance(part.value, str)}


CALLS = list(words_of_calls())

# `voussoir paper` runs every deck of the paper: the target `paper` of the build is its test
@pytest.mark.parametrize("command", [name for name in COMMANDS if name != "paper"])
def test_every_option_is_run_by_a_test(command: str) -> None:
    for action in options_of(command):
        tested = [words for words in CALLS if {command, action.option_strings[-1]} <= words]
        assert tested, f"no test calls voussoir {command} {action.option_strings[-1]}"


def test_a_reader_that_has_enough_is_no_error() -> None:
    read, write = os.pipe()
    os.close(read)
    text = "import sys; from voussoir.command.main import main; sys.exit(main(['examples']))"
    command = [sys.executable, "-u", "-c", text]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, timeout=60)
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")
