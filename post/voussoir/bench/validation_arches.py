"""Scenes of arches: section 1.8."""

from __future__ import annotations

import math

from voussoir.bench.validation_scene import MOVED, Check, Outcome, Scene, critical, verdict

ARCHES = "Arches"


def _arches() -> list[Scene]:
    """Scenes of section 1.8."""
    thickness = {
        4: 0.097361, 5: 0.094980, 6: 0.104134, 8: 0.099972, 9: 0.101525, 11: 0.104589, 12: 0.104857, 13: 0.102526,
        17: 0.105462, 20: 0.107348, 27: 0.106721, 30: 0.107410, 40: 0.107432}
    rows = tuple(
        Check(f"least t/R of {n} voussoirs", exact, _critical, 1e-6, case, scale=1.0)
        for case, (n, exact) in enumerate(thickness.items(), 1)
    )
    states = tuple(
        verdict(state, what, case)
        for case, (state, what) in enumerate(
            (
                ("collapsed", "t/R 0.25, friction 0.28"),
                ("stable", "t/R 0.25, friction 0.34"),
                ("collapsed", "t/R 0.12, friction 0.34"),
                ("stable", "t/R 0.12, friction 0.42"),
            ),
            1,
        )
    )
    scenes = [
        Scene(ARCHES, "arch_polygons", "limit analysis, six digits", rows),
        Scene(ARCHES, "arch_friction", "limit analysis", states),
    ]
    for deck in ("lateral_arch", "lateral_arch_blocks"):
        for more, accept in (((), 2e-6), (MOVED, 1e-3)):
            push = (critical("horizontal force over weight", 0.373612, accept),)
            scenes.append(Scene(ARCHES, deck, "limit analysis, six digits", push, more))
    return [*scenes, *_lateral(), *_loaded(), _sliding(), *_buttresses(), *_pulses()]


def _lateral() -> list[Scene]:
    """The lateral push by the number of voussoirs and by friction."""
    more = tuple(
        (f"force over weight, {n} voussoirs", exact, case)
        for case, (n, exact) in enumerate(((14, 0.359609), (15, 0.356745), (21, 0.356026), (50, 0.353657)), 1)
    )
    rubbed = tuple(
        (f"force over weight, friction {mu}", exact, case)
        for case, (mu, exact) in enumerate(((0.6, 0.373612), (0.5, 0.367966), (0.4, 0.257000), (0.3, 0.138946)), 1)
    )
    source = "limit analysis, six digits"
    scenes = []
    for settings, accept in (((), 4e-6), (MOVED, 1e-3)):
        for deck, rows in (("lateral_arches", more), ("lateral_arch_friction", rubbed)):
            checks = tuple(critical(what, exact, accept, case) for what, exact, case in rows)
            scenes.append(Scene(ARCHES, deck, source, checks, settings))
    return scenes


#: Point loads: deck, voussoirs, thickness over radius, load over weight by limit analysis
POINT_LOADS = (
    ("point_load_quarter_15", 15, 0.15, 0.366425),
    ("point_load_crown_15", 15, 0.15, 0.190244),
    ("point_load_quarter_20", 20, 0.15, 0.277248),
    ("point_load_thick_quarter_15", 15, 0.2, 0.752245),
    ("point_load_thick_crown_15", 15, 0.2, 0.623812),
    ("point_load_thick_quarter_20", 20, 0.2, 0.575677),
)


def _loaded() -> list[Scene]:
    """Semicircles of 1 m under a load of 10 kN/m on one voussoir."""
    scenes = []
    for deck, n, ratio, exact in POINT_LOADS:
        area = n * math.sin(math.pi / n) * ratio
        share = lambda outcome, area=area: 1e4 / (outcome.critical * area)  # noqa: E731
        for more, accept in (((), 3e-6), (MOVED, 2e-3)):
            checks = (Check("load over weight of the arch", exact, share, accept),)
            scenes.append(Scene(ARCHES, deck, "limit analysis, six digits", checks, more))
    return scenes


#: Least thickness ratio of semicircles by coefficient of friction, for 15, 27 and 50 voussoirs.
#: The last row is that of every friction above 0.3958
SLIDING_ARCHES = (
    (0.3093, (0.1931, 0.1969, 0.1986)),
    (0.32, (0.1796, 0.1838, 0.1856)),
    (0.35, (0.1484, 0.1512, 0.1520)),
    (0.38, (0.1199, 0.1211, 0.1214)),
    (0.39, (0.1110, 0.1116, 0.1123)),
    (0.42, (0.106068, 0.106721, 0.107442)),
)


def _sliding() -> Scene:
    """Semicircles whose springings slide."""
    rows = [
        (f"least t/R, friction {mu}, {n} voussoirs", exact, 1e-6 if mu > 0.4 else 5.1e-5)
        for mu, row in SLIDING_ARCHES
        for n, exact in zip((15, 27, 50), row, strict=True)
    ]
    checks = tuple(
        Check(what, exact, _critical, accept, case, scale=1.0) for case, (what, exact, accept) in enumerate(rows, 1)
    )
    return Scene(ARCHES, "arch_sliding", "limit analysis, four digits", checks)


def _buttresses() -> list[Scene]:
    """Semicircles on buttresses a little wider and narrower than they must be."""
    scenes = []
    for height, width in ((1, 0.26813), (2, 0.33394), (3, 0.36364)):
        for deck, share, state in (("stand", 1.01, "stable"), ("fall", 0.99, "collapsed")):
            checks = (verdict(state, f"buttresses {share * width:.5f} R wide"),)
            source = f"limit analysis: {width} R"
            for more in ((), MOVED):
                scenes.append(Scene(ARCHES, f"buttresses_{height}_{deck}", source, checks, more))
    return scenes


#: Rectangular pulses: percent of g, critical duration, what is accepted, and that of links whose hinges stay [s]
PULSES = ((100, 0.2246, 0.0006, 0.2363), (60, 0.4769, 0.001, 0.4857), (45, 0.8286, 0.003, 0.8689))


def _pulses() -> list[Scene]:
    """How long a pulse an arch bears; the classical model of four links is on the unsafe side."""
    scenes = []
    for percent, exact, accept, _ in PULSES:
        check = Check(f"longest pulse of {percent / 100:g} g [s]", exact, _critical, accept, scale=1.0)
        source = "rigid time stepping, written apart"
        scenes.append(Scene(ARCHES, f"arch_pulse_{percent}", source, (check,), slow=True))
    links = tuple(
        verdict("collapsed", f"{percent / 100:g} g for {links} s", case)
        for case, (percent, _, _, links) in enumerate(PULSES, 1)
    )
    return [*scenes, Scene(ARCHES, "arch_pulse_four_links", "four links bear it", links, slow=True)]


def _critical(outcome: Outcome) -> float:
    """Critical value of the outcome."""
    return outcome.critical


#: Every scene of this module
SCENES = tuple(_arches())
