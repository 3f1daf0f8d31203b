"""Figures 1 to 7: in both formats, alike at every run, their sketches true to mechanics."""

import math

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="figures want matplotlib")

from voussoir import theory  # noqa: E402
from voussoir_paper import arch_sketch, theory_curves, theory_figures  # noqa: E402


def test_seven_figures_in_two_formats_alike_at_every_run(tmp_path):
    first = theory_figures.draw_all(tmp_path / "first")
    second = theory_figures.draw_all(tmp_path / "second")
    assert [path.name for path in first] == [
        f"figure{number}.{ending}" for number in range(1, 8) for ending in ("svg", "png")
    ]
    for one, other in zip(first, second):
        assert one.stat().st_size > 10_000
        assert one.read_bytes() == other.read_bytes()


def test_command_names_its_files(tmp_path, capsys):
    assert theory_figures.main(["--out", str(tmp_path)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 14


def test_mechanism_keeps_its_chunks_and_opens_at_the_hinges():
    alpha = math.radians(120.0)
    beta, eta, _ = theory.critical(alpha, "ccr")
    chunks, hinges = arch_sketch.collapsed_half(alpha, beta, eta, 0.05)
    for outline, ends in zip(chunks, ((0.0, beta), (beta, alpha))):
        before = arch_sketch.chunk(*ends, eta)
        lengths = [np.linalg.norm(shape - shape[:, :1], axis=0) for shape in (before, outline)]
        assert lengths[0] == pytest.approx(lengths[1], abs=1e-13)
    assert hinges[0, 0] == 0.0
    assert hinges[1, 0] < 1.0 + eta / 2
    assert hinges[0, 1] > arch_sketch.on_circle(1 - eta / 2, beta)[0]


def test_drawn_critical_thrust_stays_in_the_arch():
    alpha = math.radians(90.0)
    eta = theory.critical(alpha, "ccr")[1]
    angle = np.linspace(0.0, alpha, arch_sketch.STATIONS)
    assert np.abs(theory.thrust_line(angle, alpha, eta, "ccr")).max() <= 1.0 + 1e-12


@pytest.mark.parametrize("alpha_deg", [90.0, 140.0])
def test_compared_curves_print_the_critical_values(alpha_deg):
    (axes,) = theory_curves.compared_curves(alpha_deg).axes
    labels = " ".join(text.get_text() for text in axes.get_legend().get_texts())
    for name in theory.THEORIES:
        assert f"{float(theory.critical(math.radians(alpha_deg), name)[1]):.6f}" in labels
