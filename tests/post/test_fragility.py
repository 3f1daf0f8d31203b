"""Fragility curves: the most likely lognormal, and the way from records to a picture."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from voussoir.command.main import main  # noqa: E402
from voussoir.plot.fragility import Lognormal, draw_fragility, fit_shares, fit_values  # noqa: E402
from voussoir.results import read  # noqa: E402


def test_the_likelihood_is_at_its_maximum() -> None:
    """The fit beats its neighbours in both parameters, by scipy's own binomial likelihood."""
    stats = pytest.importorskip("scipy.stats")
    strength = np.array([0.2, 0.3, 0.4, 0.5, 0.7, 0.9])
    collapsed, total = np.array([0.0, 4, 5, 12, 20, 28]), np.full(6, 30.0)
    fit = fit_shares(strength, collapsed, total)
    assert fit is not None

    def likelihood(median: float, dispersion: float) -> float:
        share = stats.norm.cdf(np.log(strength / median) / dispersion)
        return float(stats.binom.logpmf(collapsed, total, share).sum())

    best = likelihood(fit.median, fit.dispersion)
    for median, dispersion in ((1.001, 1), (0.999, 1), (1, 1.001), (1, 0.999)):
        assert likelihood(median * fit.median, dispersion * fit.dispersion) < best


def test_shares_of_a_lognormal_give_it_back() -> None:
    exact = Lognormal(0.37, 0.42)
    strength = np.geomspace(0.1, 1.2, 9)
    total = np.full(9, 1e9)
    fit = fit_shares(strength, total * exact(strength), total)
    assert fit is not None
    assert (fit.median, fit.dispersion) == pytest.approx((0.37, 0.42), rel=1e-6)


def test_what_one_strength_parts_has_no_fit() -> None:
    assert fit_shares(np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, 5.0]), np.full(3, 5.0)) is None
    assert fit_values(np.array([1.0])) is None


def test_critical_values_give_median_and_dispersion() -> None:
    fit = fit_values(np.exp([-1.0, 0.0, 1.0]))
    assert fit is not None and (fit.median, fit.dispersion) == pytest.approx((1.0, 1.0))


def write_study(folder: Path, search: bool) -> Path:
    """Sines of several frequencies carry a free block beyond 5 cm, or not."""
    for frequency in (2, 3, 4, 5):
        times = np.linspace(0.0, 1.0 / frequency, 101)
        (folder / f"sine_{frequency}.csv").write_text(
            "time,a\n" + "".join(f"{t:.6f},{math.sin(2 * math.pi * frequency * t):.9f}\n" for t in times))
    (folder / "free.blocks").write_text("block\n0 0\n1 0\n1 2\n0 2\n")
    names = ", ".join(f"'sine_{frequency}.csv'" for frequency in (2, 3, 4, 5))
    deck = folder / "study.nml"
    deck.write_text(
        "&scene kind = 'blocks', geometry = 'free.blocks' /\n&load gravity = 0 /\n"
        "&ground record = 'sine_2.csv' /\n"
        "&analysis mode = 'dynamic', geometry = 'current', duration = 1, time_step = 0.01, steps = 9999,"
        f" collapse_displacement = 0.05 /\n&sweep parameter = 'record', texts = {names} /\n"
        + ("&search parameter = 'ground%amplitude', low = 0.1, high = 20 /\n" if search else
           "&sweep parameter = 'amplitude', values = 1, 2, 3, 4, 6, 9 /\n"))
    return deck


@pytest.mark.parametrize("search", [False, True])
def test_a_campaign_over_records_becomes_a_curve(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], search: bool
) -> None:
    """A sine carries A/2 pi f^2: what collapses is known of each, and so are median and dispersion."""
    deck, out = write_study(tmp_path, search), tmp_path / "out"
    assert main(["campaign", str(deck), "--out", str(out), "--workers", "2", "--quiet"]) == 0
    capsys.readouterr()
    assert main(["plot", str(out), "--fragility", "--format", "png"]) == 0
    critical = np.array([0.1 * math.pi * f**2 for f in (2, 3, 4, 5)])
    strength = np.array([1.0, 2, 3, 4, 6, 9])
    exact = fit_values(critical) if search else fit_shares(
        strength, (critical[None, :] < strength[:, None]).sum(axis=1).astype(float), np.full(6, 4.0))
    assert exact is not None
    words = capsys.readouterr().out.splitlines()[0].replace(",", "").split()
    assert [float(words[3]), float(words[5])] == pytest.approx([exact.median, exact.dispersion], rel=2e-3)
    assert (out / "plots" / "fragility.png").stat().st_size > 5000
    figure, _ = draw_fragility(read(out))
    assert figure.axes[0].get_xlabel() == "peak acceleration of the ground [m/s²]"


def test_results_without_strengths_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.nml").write_text("&arch voussoirs = 6 /\n&sweep parameter = 'radius', values = 5, 10 /\n")
    assert main(["campaign", str(tmp_path / "a.nml"), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert main(["plot", str(tmp_path / "out"), "--fragility"]) == 2
    assert "expected a sweep of amplitude or scale, got radius" in capsys.readouterr().err
