"""How long a pulse an arch bears, by the program and by an integrator written apart from it."""

from __future__ import annotations

from pathlib import Path

import pytest
from dda_command import rows_of, run_deck
from rocking_arch import G, Arch, stands

#: Acceleration over g, the longest pulse by the integrator for steps of 2 ms, and that of four links [s]
PULSES = [(1.0, 0.22393, 0.2363), (0.6, 0.47627, 0.4857), (0.45, 0.82628, 0.8689)]
SHAPE = {"voussoirs": 7, "radius": 10.0, "ratio": 0.15, "half_deg": 78.75}


def bears(folder: Path, share: float, duration: float) -> bool:
    """Whether the program's arch stands after a pulse."""
    run_deck(
        folder, "&arch radius = 10.0, thickness_ratio = 0.15, half_angle_deg = 78.75, voussoirs = 7 /\n"
        "&joint friction_deg = 89.9 /\n"
        f"&ground pulse = 'rectangular', amplitude = {share * G!r}, duration = {duration!r} /\n"
        "&analysis mode = 'dynamic', geometry = 'current', unknowns = 3, time_step = 0.002, duration = 8.0,\n"
        "  steps = 1000000, max_displacement_ratio = 0.02, collapse_rotation_deg = 45.0 /\n"
        "&output vtu = .false., joints = .false. /\n", "--quiet")
    (row,) = rows_of(folder / "x" / "results.csv")
    assert row["verdict"] in ("completed", "collapsed")
    return row["verdict"] == "completed"


@pytest.mark.parametrize(("share", "longest", "of_four_links"), PULSES)
def test_an_arch_bears_as_long_a_pulse_as_an_integrator_says(
    tmp_path: Path, share: float, longest: float, of_four_links: float
) -> None:
    """Both tell the longest pulse to 0.3 %; four links whose hinges stay bear pulses that neither arch does."""
    arch = Arch(**SHAPE)
    for duration, survives in ((0.997 * longest, True), (1.003 * longest, False), (of_four_links, False)):
        assert stands(arch, share * G, duration, 2e-3) is survives
        assert bears(tmp_path, share, duration) is survives
