"""`voussoir theory` at the command line, and the benchmark's own arithmetic."""

import math

import numpy as np
import pytest
import theory_times as bench_theory

from voussoir import theory
from voussoir.command.main import main


def test_table_has_a_line_for_each_theory(capsys):
    assert main(["theory", "--alpha", "90"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 4
    assert "54.483974" in lines[3] and "1.074780e-01" in lines[3] and "milankovitch" in lines[3]


def test_csv_keeps_every_digit(capsys):
    assert main(["theory", "--alpha", "45", "140", "--theory", "ccr", "--csv"]) == 0
    header, *rows = capsys.readouterr().out.splitlines()
    assert header == "alpha_deg,theory,beta_deg,beta_rad,eta,h"
    for row, alpha in zip(rows, (45.0, 140.0)):
        numbers = [float(word) for word in row.split(",")[3:]]
        assert numbers == [float(value) for value in theory.critical(math.radians(alpha), "ccr")]


def test_beyond_a_limit_the_table_says_so(capsys):
    assert main(["theory", "--alpha", "150"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "ends at 148.371 degrees" in lines[1]
    assert "39.917798" in lines[2]
    assert main(["theory", "--alpha", "150", "--theory", "heyman", "--csv"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == "150.0,heyman,,,,"


@pytest.mark.parametrize("word", ["x", "0", "180", "-5", "nan", "inf"])
def test_bad_angle_is_bad_input(word, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["theory", f"--alpha={word}"])
    assert stop.value.code == 2
    assert "(0, 180) degrees" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["nonsense"], ["help", "nonsense"], ["theory"], ["theory", "--alpha", "90", "--theory", "x"]]
)
def test_bad_command_is_bad_input(words, capsys):
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert stop.value.code == 2
    assert "usage" in capsys.readouterr().err


@pytest.mark.parametrize("name", theory.THEORIES)
def test_benchmark_compares_equal_things(name):
    pytest.importorskip("scipy", reason="the benchmark wants scipy")
    angles = np.linspace(0.2, 2.2, 41)
    fortran = theory.critical(angles, name)
    vectorised = bench_theory.numpy_critical(angles, name)
    scalar = np.transpose([bench_theory.brentq_critical(angle, name) for angle in angles])
    for found, same, printed in zip(fortran, vectorised, scalar):
        assert same == pytest.approx(found, rel=2e-14)
        assert printed == pytest.approx(found, rel=1e-11)
