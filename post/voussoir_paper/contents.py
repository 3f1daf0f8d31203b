"""What the report holds, in its order, and what is said below each figure."""

from __future__ import annotations

from voussoir_paper.campaign import Campaign
from voussoir_paper.tables import Row

CAPTIONS = {
    "figure8": "Fig. 8: collapse of 36 blocks of the thickness 0.105965 at friction angles of "
    "0, 10, 20 and 30 degrees, followed until a corner has moved by a tenth of the radius. "
    "Grey: before. The sliding share is slip over slip and opening of all joints at the onset.",
    "figure8_friction": "Behind Fig. 8: critical thickness of 36 rigid blocks against the "
    "friction angle, with the two thresholds that the paper cites from others.",
    "figure9": "Fig. 9: collapse against the number of blocks; thickness 0.105965 (Heyman) and "
    "0.107426 (CCR), elastic blocks. &beta;: intrados hinge at the onset.",
    "figure10": "Fig. 10: intrados hinge against the number of blocks, rigid and elastic, among the joints that the "
    "arch has. Below its critical thickness an arch may turn at the next joint.",
    "figure11": "Fig. 11: critical thickness against the number of blocks. The line joins the "
    "exact values of every even number of blocks.",
    "figure12": "Fig. 12: collapse of four blocks at half angle 90 degrees, joint imposed at "
    "&beta;, at their critical thickness &eta; (elastic).",
    "figure13": "Fig. 13: the same, joint at 54.5 degrees.",
    "figure14": "Fig. 14: thickness against the imposed joint, half angle 90 degrees, and how "
    "far the values lie above the exact ones; within, the piece around the top.",
    "figure15": "Fig. 15: collapse of four blocks at half angle 140 degrees, joint imposed at "
    "&beta;, at their critical thickness &eta; (elastic, joints that cannot slide).",
    "figure16": "Fig. 16: the same, joint at 59 degrees.",
    "figure17": "Fig. 17: thickness against the imposed joint, half angle 140 degrees, and how "
    "far the values lie above the exact ones; within, the piece around the top.",
    "figure18": "Fig. 18: collapse of arches of voussoirs of 5 degrees at their critical "
    "thickness (elastic; joints that cannot slide at 140 and 145 degrees).",
    "figure19": "Fig. 19: intrados hinge against the half angle of embrace; the joints lie 5 "
    "degrees apart. Marks of one half angle stand side by side, those of rigid blocks at their place.",
    "figure20": "Fig. 20: critical thickness against the half angle of embrace, and how far "
    "the values lie above the exact ones.",
}
"""What each figure shows, as HTML."""

#: Sections of the paper: title, and what stands there in its order
SECTIONS = (
    ("3.1 Friction at the joints", ("figure8", "figure8_modes", "figure8_friction", "thresholds")),
    ("3.2 Where the haunches turn", ("figure9", "figure10", "hinges9")),
    ("3.3 Critical thickness", ("table1", "figure11")),
    (
        "3.4 Imposed haunch joint",
        ("table2", "figure12", "figure13", "figure14", "table3", "figure15", "figure16", "figure17"),
    ),
    ("3.5 Half angle of embrace", ("table4", "hinges4", "figure18", "figure19", "figure20")),
)

ANIMATIONS = {
    "figure8": ("animation8", "The collapses of Fig. 8."),
    "figure13": ("animation13", "The collapse of Fig. 13."),
    "figure16": ("animation16", "The collapse of Fig. 16."),
    "figure18": ("animation18", "Collapses of Fig. 18."),
}
"""Name and caption of the animation that follows a figure."""

THEORY_CAPTIONS = (
    "collapse mode of a half arch, CCR",
    "thrust line and forces on the upper part of a half arch",
    "thrust lines of the semicircle above, at and below the critical thickness, CCR",
    "thickness for equilibrium against the hinge angle, semicircle, CCR",
    "the same for several half angles, CCR",
    "the same for the three theories, half angle 90 degrees",
    "the same for the three theories, half angle 140 degrees",
)
"""What figures 1 to 7 show."""

_SIDE = "The paper's text: its hinges lie on the side of Milankovitch (54.48) and CCR (54.50), not of Heyman (58.83)."
#: What the paper says in words where its figures have no numbers in its tables
_IN_WORDS = {
    "figure8": "The paper: purely sliding, mainly sliding, mixed, purely rotational.",
    "figure8_friction": "The paper cites 0.309 or 0.31, and 0.395 or 0.396, for the two thresholds of &mu;.",
    "figure9": _SIDE,
    "figure10": _SIDE,
}
#: Tables whose values the figures show, and the columns that identify their rows
_TABLE_OF = {
    "figure11": ("table1", "blocks"),
    "figure12": ("table2", "joint"),
    "figure13": ("table2", "joint"),
    "figure14": ("table2", "joint"),
    "figure15": ("table3", "joint"),
    "figure16": ("table3", "joint"),
    "figure17": ("table3", "joint"),
    "figure18": ("table4", "half_angle"),
    "figure19": ("table4", "half_angle"),
    "figure20": ("table4", "half_angle"),
}
#: Joints of the two samples [deg]
_SAMPLES = {"figure13": 54.5, "figure16": 59.0}


def caption(part: str, campaign: Campaign) -> str:
    """What a figure shows, and the paper's value beside ours."""
    words = _IN_WORDS.get(part) or _beside(part, campaign)
    return f'{CAPTIONS[part]} <span class="paper">{words}</span>'


def _beside(part: str, campaign: Campaign) -> str:
    """The paper's values of a figure, those of rigid blocks in parentheses."""
    name, key = _TABLE_OF[part]
    rows = campaign.tables[name].rows
    unit = " blocks" if key == "blocks" else "&deg;"
    if part == "figure19":
        entries = [f"{row.half_angle}&deg;: {row.values['paper DDA'].hinge}" for row in rows]
        return "The paper's hinges [deg] by half angle: " + ", ".join(entries) + "."
    if part in _SAMPLES:
        rows = [row for row in rows if float(row.joint) == _SAMPLES[part]]
    elif part != "figure18":  # the table beside has them all
        rows = [rows[0], max(rows, key=_paper_value), rows[-1]]
        rows = [row for place, row in enumerate(rows) if row not in rows[:place]]
    entries = []
    for row in rows:
        paper, own = row.values["paper DDA"].digits("paper DDA"), row.values["ours, rigid"].eta
        digits = len(paper.partition(".")[2])
        entries.append(f"{getattr(row, key)}{unit}: {paper} ({own or 0.0:.{digits}f})")
    return "The paper's &eta; (ours, rigid): " + ", ".join(entries) + "."


def _paper_value(row: Row) -> float:
    """The paper's thickness."""
    return row.values["paper DDA"].eta or 0.0
