"""What the comparison with the paper shows, in sentences whose numbers come from the results."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

import numpy as np

from voussoir import theory
from voussoir_paper.campaign import Campaign
from voussoir_paper.tables import THEORIES, Row, Value

_RIGID, _ELASTIC, _PAPER = "ours, rigid", "ours, elastic", "paper DDA"


@dataclass(frozen=True)
class Finding:
    """A claim and what supports it; both may hold HTML."""

    claim: str
    support: str


def find_all(campaign: Campaign) -> list[Finding]:
    """All findings, in the order in which a reader needs them."""
    return [
        rigid_is_exact(campaign), from_below(campaign), growth_with_blocks(campaign), paper_elsewhere(campaign),
        *other_columns(campaign), hinges(campaign), standing_at_ccr(campaign), friction_of_50(campaign),
        thresholds(campaign), elastic_shift(campaign), which_theory(campaign)]


def rigid_is_exact(campaign: Campaign) -> Finding:
    """Rigid blocks against limit analysis."""
    errors = [abs(value.error) for _, value in _values(campaign, _RIGID) if value.error is not None]
    cases = campaign.results("figure8_thickness").cases
    friction = np.abs(cases["relative_error"]).max()
    return Finding(
        "Rigid blocks give the exact values of statics",
        f"In {len(errors)} arches of Tables 1 to 4 the critical thickness of rigid blocks "
        f"deviates from limit analysis of the same polygons by at most {max(errors):.0e} of "
        f"its value, in {len(cases)} arches whose joints may slip by at most {friction:.0e}. "
        "Differences from the values of the paper are therefore those of its program.",
    )


def from_below(campaign: Campaign) -> Finding:
    """Exact discrete values against the continuous arch."""
    limit = float(theory.critical(math.pi / 2, "milankovitch")[1])
    even = np.arange(10, 182, 2)
    exact = theory.discrete_critical(even, math.pi / 2)
    falls = int(np.count_nonzero(np.diff(exact) < 0.0))
    cases = campaign.results("figure10").cases
    first = cases.where(thickness_ratio=cases["thickness_ratio"].min())
    example = next((i for i in range(len(first) - 1) if first["exact"][i + 1] < first["exact"][i]), None)
    shown = ""
    if example is not None:
        shown = (
            f" Of the numbers in Fig. 10, {first['blocks'][example]} blocks need {first['exact'][example]:.9f} and "
            f"{first['blocks'][example + 1]} blocks {first['exact'][example + 1]:.9f}."
        )
    return Finding(
        f"More blocks bring the critical thickness up to {limit:.6f}, from below and in no steady way",
        f"Of {even.size} even numbers of blocks from {even[0]} to {even[-1]}, {int(np.count_nonzero(exact < limit))} "
        f"need less than the continuous arch of Milankovitch ({limit:.6f}); the largest value is {exact.max():.9f}, at "
        f"{even[exact.argmax()]} blocks. From one even number to the next the value decreases {falls} times: it "
        f"depends on the distance of a joint from {math.degrees(theory.critical(math.pi / 2, 'milankovitch')[0]):.2f} "
        "degrees." + shown,
    )


def growth_with_blocks(campaign: Campaign) -> Finding:
    """The paper's growth with the number of blocks."""
    rows = campaign.tables["table1"].rows
    number = np.array([float(row.blocks) for row in rows])
    paper = np.array([row.values[_PAPER].eta for row in rows], dtype=float)
    exact = np.array([row.exact for row in rows], dtype=float)
    slope = np.polyfit(number, 100.0 * (paper / exact - 1.0), 1)[0]
    late = exact[number >= 30]
    return Finding(
        "The paper's growth with the number of blocks is not statics",
        f"Its values exceed the exact ones by {100 * (paper[0] / exact[0] - 1):.1f} % at {rows[0].blocks} blocks and "
        f"by {100 * (paper[-1] / exact[-1] - 1):.1f} % at {rows[-1].blocks}, about {slope:.2f} % more for each block. "
        f"The exact values from 30 blocks on lie within {100 * (late.max() / late.min() - 1):.3f} % of one another. "
        "The cause is the compliance of the contacts in the program that the paper used: it lowers its penalty until "
        "the deepest corner penetrates by a fixed share of the size of the whole model, whatever Young's modulus is. "
        "The closures of the joints add up, more joints to more: 36 blocks sink by a tenth of their thickness at the "
        "crown while they still stand, and the flatter arch needs more thickness. Limit analysis of the arch so "
        "deformed gives the paper's value.",
    )


def paper_elsewhere(campaign: Campaign) -> Finding:
    """The paper's values in the other tables."""
    parts = []
    for name in ("table2", "table3", "table4"):
        table = campaign.tables[name]
        worst, least = (chosen(table.rows, key=lambda row: row.values[_PAPER].error or 0.0) for chosen in (max, min))
        parts.append(
            f"Table {name[-1]}: {_share(least, _PAPER)} ({_arch(least)}) to {_share(worst, _PAPER)} ({_arch(worst)})")
    count = sum((value.error or 0.0) > 0.0 for _, value in _values(campaign, _PAPER))
    total = sum(1 for _ in _values(campaign, _PAPER))
    return Finding(
        f"The paper's values lie above the exact ones in {count} of {total} arches",
        "; ".join(parts) + ". The thinner the arch, the more the same closure of its joints weighs.")


def other_columns(campaign: Campaign) -> Iterator[Finding]:
    """Columns that joined by decks of their own, against the paper."""
    known = {_PAPER, _RIGID, _ELASTIC, *THEORIES.values()}
    columns = {column for table in campaign.tables.values() for column in table.columns}
    for column in sorted(columns - known):
        shares = [
            abs(value.eta / printed - 1.0)
            for row, value in _values(campaign, column)
            if value.eta is not None and (printed := row.values[_PAPER].eta) is not None
        ]
        total = sum(1 for _ in _values(campaign, column))
        if shares:
            yield Finding(
                f"{column}: Shi's scheme and constants",
                f"{len(shares)} of {total} arches were found; they deviate from the paper's own values by at most "
                f"{100 * max(shares):.1f} %, by {100 * float(np.median(shares)):.2f} % in the middle.",
            )


def hinges(campaign: Campaign) -> Finding:
    """Hinges of ours, of the paper and of the exact mechanism."""
    rows = campaign.tables["table4"].rows
    same = sum(float(row.values[_RIGID].hinge) == float(row.values[_PAPER].hinge) for row in rows)
    exact = sum(
        [float(part) for part in row.values[_RIGID].hinge.split(";") if part] == exact_hinges(row) for row in rows)
    return Finding(
        f"The hinges of Table 4 are the paper's in {same} of {len(rows)} rows",
        f"They are the joints that bind in limit analysis in {exact} of {len(rows)} rows. The "
        "thickness that the paper's program gets is off, its mechanism is not.",
    )


def exact_hinges(row: Row) -> list[float]:
    """Intrados hinges of the exact critical state of an arch of equal blocks without slip [deg]."""
    solution = theory.discrete_solution(int(row.blocks), math.radians(float(row.half_angle)))
    return sorted({round(math.degrees(abs(angle)), 6) for angle in solution.intrados_hinges})


def standing_at_ccr(campaign: Campaign) -> Finding:
    """Arches of Figs. 9 and 10 that stand."""
    words = []
    for name, deck in (("rigid", "figure10"), ("elastic", "figure9")):
        cases = campaign.results(deck).cases
        ccr = cases.where(thickness_ratio=cases["thickness_ratio"].max())
        standing = ", ".join(str(n) for n in ccr.where(verdict="stable")["blocks"])
        words.append(f"{name} arches of {standing or 'no number of'} blocks")
    cases = campaign.results("figure10").cases
    eta = cases["thickness_ratio"].max()
    stands = cases.where(thickness_ratio=eta, verdict="stable")
    values = ", ".join(f"{value:.7f}" for value in stands["exact"])
    return Finding(
        f"Some arches stand at the thickness of CCR, {eta:g}",
        f"{words[0].capitalize()} and {words[1]} stand there; the exact critical values of the rigid ones, {values}, "
        "lie below it. A collapse that the paper saw in them is its program's.",
    )


def friction_of_50(campaign: Campaign) -> Finding:
    """Where a friction angle of 50 degrees does not do."""
    parts = []
    for row in campaign.tables["table4"].rows:
        if float(row.half_angle) < 140.0:
            continue
        alpha = math.radians(float(row.half_angle))
        joints = int(row.blocks)
        at_50 = theory.discrete_solution(joints, alpha, friction=math.radians(50.0))
        least = least_friction(joints, alpha=alpha)
        outcome = {
            "none_admissible": "stands at no thickness", "found": f"needs {at_50.eta:.6f} in place of {row.exact:.6f}"
        }[at_50.status]
        parts.append(
            f"with it the arch of {row.half_angle} degrees {outcome}, and turns without slip "
            f"from {least:.2f} degrees on only")
    table3 = {row.joint: least_friction_of(row) for row in campaign.tables["table3"].rows}
    high = ", ".join(
        f"{angle:.2f} degrees with the joint at {joint}" for joint, angle in table3.items() if angle > 55.0)
    rest = max(angle for angle in table3.values() if angle <= 55.0)
    return Finding(
        "Friction of 50 degrees cannot hold the arches of 140 and 145 degrees",
        "The paper names that angle for all runs. In Table 4, "
        + "; ".join(parts)
        + f". In Table 3 the turning mechanism needs {high}, and up to {rest:.2f} in the other "
        "rows. Here these arches have joints that cannot slide.",
    )


def least_friction_of(row: Row) -> float:
    """The same for an arch of Table 3: imposed joint, chords of half a degree."""
    half = np.radians([0.0, float(row.joint), float(row.half_angle)])
    return least_friction(half, facet=math.radians(0.5))


def least_friction(joints: Any, **arch: Any) -> float:
    """Least friction angle at which an arch needs no more thickness than without slip, to 1e-9 [deg]."""
    wanted = theory.discrete_solution(joints, **arch).eta * (1.0 + 1e-10)
    return _bisect(
        lambda angle: theory.discrete_solution(joints, friction=math.radians(angle), **arch).eta <= wanted, 0.0, 89.0)


def exact_threshold(blocks: int, eta: float) -> float:
    """Least friction angle at which a semicircle of blocks of a thickness stands, exactly [deg]."""
    return _bisect(
        lambda angle: theory.discrete_solution(blocks, math.pi / 2, friction=math.radians(angle)).eta <= eta, 0.0, 60.0)


def _bisect(holds: Any, low: float, high: float) -> float:
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return 0.5 * (low + high)


def thresholds(campaign: Campaign) -> Finding:
    """The two friction thresholds of the semicircle."""
    lower = campaign.results("figure8_lower").cases
    upper = campaign.results("figure8_upper").cases
    continuous = theory.friction("ccr")
    found = ", ".join(
        f"{math.tan(math.radians(angle)):.6f} ({blocks} blocks)"
        for angle, blocks in zip(lower["critical"], lower["blocks"]))
    return Finding(
        "The two friction thresholds that the paper cites are found",
        f"Below a coefficient of {found} the arch stands at no thickness (continuous arch: "
        f"{continuous['mu_mixed']:.6f}; the paper cites 0.309 and 0.31). From "
        f"{math.tan(math.radians(upper['critical'][0])):.6f} on ({upper['blocks'][0]} blocks; "
        f"continuous arch: {continuous['mu_rotational']:.6f}, the paper cites 0.395 and 0.396) "
        "no joint slips at the critical thickness. The exact values of the same polygons are "
        + ", ".join(
            f"{math.tan(math.radians(exact_threshold(int(blocks), eta))):.6f}"
            for blocks, eta in (
                *zip(lower["blocks"], lower["thickness_ratio"]), (upper["blocks"][0], upper["thickness_ratio"][0]),
            )
        )
        + ".",
    )


def elastic_shift(campaign: Campaign) -> Finding:
    """What elasticity adds to the thickness."""
    parts = []
    for name, table in campaign.tables.items():
        known = [(error, row) for row in table.rows if (error := row.values[_ELASTIC].error) is not None]
        worst = max(known, key=itemgetter(0))[1]
        median = float(np.median([error for error, _ in known]))
        parts.append(
            f"Table {name[-1]}: {100 * median:.3f} % in the middle, "
            f"{_share(worst, _ELASTIC, 2)} at most ({_arch(worst)})")
    shallow = campaign.tables["table4"].rows[0]
    return Finding(
        "Elastic blocks need a little more thickness, shallow and thin arches noticeably more",
        "Blocks of the paper's Young's modulus that move and deform shorten the arch under its own weight: "
        + "; ".join(parts)
        + f". It matters at {shallow.half_angle} degrees ({_share(shallow, _ELASTIC, 2)}) and where the arch is thin. "
        "The shift is inversely proportional to Young's modulus, and much smaller than what the paper's program adds.",
    )


def which_theory(campaign: Campaign) -> Finding:
    """The three theories against the polygons of Table 4."""
    rows = campaign.tables["table4"].rows
    parts = [
        f"{heading} by {100 * max(abs(row.values[heading].error or 0.0) for row in rows):.2f} %"
        for heading in THEORIES.values()
    ]
    return Finding(
        "Milankovitch's solution is the one that polygons of 5 degrees follow",
        "In Table 4 the theories deviate from the exact polygon values by at most: "
        + ", ".join(parts)
        + ". Most of what Milankovitch deviates is that the joints lie 5 degrees apart.",
    )


def _values(campaign: Campaign, column: str) -> Iterator[tuple[Row, Value]]:
    for table in campaign.tables.values():
        for row in table.rows:
            if column in row.values:
                yield row, row.values[column]


def _share(row: Row, column: str, digits: int = 1) -> str:
    return f"{100.0 * (row.values[column].error or 0.0):.{digits}f} %"


def _arch(row: Row) -> str:
    if row.joint:
        return f"joint at {row.joint} degrees"
    return f"{row.blocks} blocks, half angle {row.half_angle} degrees"
