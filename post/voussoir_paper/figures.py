"""All figures and animations of the paper's section 3, by their numbers."""

from __future__ import annotations

from pathlib import Path

from voussoir.plot.collapse_animation import animate
from voussoir.plot.figure_style import house_style, save
from voussoir.results import Results
from voussoir_paper import curve_figures, hinge_figures, mechanism_figures, theory_figures
from voussoir_paper.campaign import Campaign

FIGURES = {
    "figure8": mechanism_figures.friction_modes,
    "figure8_friction": curve_figures.friction,
    "figure9": mechanism_figures.block_numbers,
    "figure10": hinge_figures.block_numbers,
    "figure11": curve_figures.numbers_of_blocks,
    "figure12": mechanism_figures.imposed_at_90,
    "figure13": mechanism_figures.sample_at_90,
    "figure14": curve_figures.imposed_at_90,
    "figure15": mechanism_figures.imposed_at_140,
    "figure16": mechanism_figures.sample_at_140,
    "figure17": curve_figures.imposed_at_140,
    "figure18": mechanism_figures.half_angles,
    "figure19": hinge_figures.half_angles,
    "figure20": curve_figures.half_angles,
}
"""Name of each figure and what draws it from a campaign."""


#: Animations by their names: the deck whose cases move, and what stands above them
ANIMATIONS = {
    "animation8": ("figure8", mechanism_figures.short_friction_title),
    "animation13": ("figure12", mechanism_figures.imposed_title),
    "animation16": ("figure15", mechanism_figures.imposed_title),
    "animation18": ("figure18", mechanism_figures.short_half_angle_title),
}
#: Figures 1 to 7, from the theory alone
THEORY = {f"figure{number}": draw for number, draw in enumerate(theory_figures.FIGURES, 1)}


def names() -> list[str]:
    """Names of all figures and animations, those that take longest first."""
    return [*reversed(ANIMATIONS), *FIGURES, *THEORY]


def make(campaign: Campaign, folder: Path, name: str) -> list[Path]:
    """Draw one figure as SVG and PNG, or write one animation as GIF."""
    folder.mkdir(parents=True, exist_ok=True)
    with house_style():
        if name in THEORY:
            return save(THEORY[name](), folder, name)
        if name in FIGURES:
            return save(FIGURES[name](campaign), folder, name)
        deck, title = ANIMATIONS[name]
        run = campaign.results(deck)
        return [animate(run, _cases(name, run), title, folder / f"{name}.gif")]


def _cases(name: str, run: Results) -> list[int]:
    """Cases that an animation shows."""
    titles = mechanism_figures
    if name == "animation13":
        return [titles.case_of_joint(run, 54.5)]
    if name == "animation16":
        return [titles.case_of_joint(run, 59.0)]
    if name == "animation18":
        angles = (45, 90, 120, 145)
        return [int(run.cases.where(half_angle_deg=angle)["case"][0]) for angle in angles]
    return list(run.cases["case"])
