"""Scenes of arches: section 1.8."""

from __future__ import annotations

import math
from functools import partial

from voussoir_benches.checks import Check, critical, verdict
from voussoir_benches.scene import Scene, benchmark, benchmark_in_both

ARCHES = "Arches"


#: Least thickness ratio by the number of voussoirs, and force over weight by that and by friction: limit analysis
THICKNESS = {
    4: 0.097361, 5: 0.094980, 6: 0.104134, 8: 0.099972, 9: 0.101525, 11: 0.104589, 12: 0.104857, 13: 0.102526,
    17: 0.105462, 20: 0.107348, 27: 0.106721, 30: 0.107410, 40: 0.107432}
BY_NUMBER = {14: 0.359609, 15: 0.356745, 21: 0.356026, 50: 0.353657}
BY_FRICTION = {0.6: 0.373612, 0.5: 0.367966, 0.4: 0.257000, 0.3: 0.138946}
SIX_DIGITS = "limit analysis, six digits"
_scene = partial(benchmark, ARCHES)


def _arches() -> list[Scene]:
    """Scenes of section 1.8."""
    rows = [
        critical(f"minimum t/R of {n} voussoirs", exact, 1e-6, case, 1.0)
        for case, (n, exact) in enumerate(THICKNESS.items(), 1)
    ]
    states = [
        verdict(state, f"t/R {ratio}, friction {mu}", case)
        for case, (state, ratio, mu) in enumerate((
            ("collapsed", 0.25, 0.28), ("stable", 0.25, 0.34), ("collapsed", 0.12, 0.34), ("stable", 0.12, 0.42)), 1)
    ]
    push = critical("horizontal force over weight", 0.373612, 2e-6)
    return [
        _scene("arch_polygons", SIX_DIGITS, *rows),
        _scene("arch_friction", "limit analysis", *states),
        *benchmark_in_both(ARCHES, "lateral_arch", SIX_DIGITS, push, moved=1e-3),
        *benchmark_in_both(ARCHES, "lateral_arch_blocks", SIX_DIGITS, push, moved=1e-3),
        *_lateral(), *_loaded(), _sliding(), *_buttresses(), *_pulses(),
    ]


def _lateral() -> list[Scene]:
    """The lateral push by the number of voussoirs and by friction."""
    number = [
        critical(f"force over weight, {n} voussoirs", exact, 4e-6, case)
        for case, (n, exact) in enumerate(BY_NUMBER.items(), 1)
    ]
    rubbed = [
        critical(f"force over weight, friction {mu}", exact, 4e-6, case)
        for case, (mu, exact) in enumerate(BY_FRICTION.items(), 1)
    ]
    pairs = zip(benchmark_in_both(ARCHES, "lateral_arches", SIX_DIGITS, *number, moved=1e-3),
                benchmark_in_both(ARCHES, "lateral_arch_friction", SIX_DIGITS, *rubbed, moved=1e-3))
    return [scene for pair in pairs for scene in pair]


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
    scenes: list[Scene] = []
    for deck, n, ratio, exact in POINT_LOADS:
        area = n * math.sin(math.pi / n) * ratio
        share = lambda outcome, area=area: 1e4 / (outcome.critical * area)  # noqa: E731
        check = Check("load over weight of the arch", exact, share, 3e-6)
        scenes += benchmark_in_both(ARCHES, deck, SIX_DIGITS, check, moved=2e-3)
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
    rows = [(mu, n, exact) for mu, row in SLIDING_ARCHES for n, exact in zip((15, 27, 50), row, strict=True)]
    checks = [
        critical(f"minimum t/R, friction {mu}, {n} voussoirs", exact, 1e-6 if mu > 0.4 else 5.1e-5, case, 1.0)
        for case, (mu, n, exact) in enumerate(rows, 1)
    ]
    return _scene("arch_sliding", "limit analysis, four digits", *checks)


def _buttresses() -> list[Scene]:
    """Semicircles on buttresses a little wider and narrower than they must be."""
    return [
        scene
        for height, width in ((1, 0.26813), (2, 0.33394), (3, 0.36364))
        for deck, share, state in (("stand", 1.01, "stable"), ("fall", 0.99, "collapsed"))
        for scene in benchmark_in_both(
            ARCHES, f"buttresses_{height}_{deck}", f"limit analysis: {width} R",
            verdict(state, f"buttresses {share * width:.5f} R wide"))
    ]


#: Rectangular pulses: percent of g, critical duration, what is accepted, and that of links whose hinges stay [s]
PULSES = ((100, 0.22393, 0.0006, 0.2363), (60, 0.47627, 0.001, 0.4857), (45, 0.82628, 0.003, 0.8689))


def _pulses() -> list[Scene]:
    """How long a pulse an arch bears; the classical model of four links is on the unsafe side."""
    scenes = [
        _scene(f"arch_pulse_{percent}", "independent integrator of rigid blocks",
               critical(f"longest pulse of {percent / 100:g} g [s]", exact, accept, 1, 1.0), slow=True)
        for percent, exact, accept, _ in PULSES
    ]
    links = [
        verdict("collapsed", f"{percent / 100:g} g for {links} s", case)
        for case, (percent, _, _, links) in enumerate(PULSES, 1)
    ]
    return [*scenes, _scene("arch_pulse_four_links", "the model of four links predicts no collapse", *links, slow=True)]


#: Every scene of this module
SCENES = tuple(_arches())
