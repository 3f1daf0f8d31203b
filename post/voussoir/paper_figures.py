"""All figures and animations of the paper's section 3, by their numbers."""

from __future__ import annotations

from pathlib import Path

from voussoir import (
    paper_curve_figures,
    paper_hinge_figures,
    paper_mechanism_figures,
    theory_figures,
)
from voussoir.collapse_animation import animate
from voussoir.figure_style import house_style, save
from voussoir.paper_campaign import Campaign

FIGURES = {
    "figure8": paper_mechanism_figures.friction_modes,
    "figure8_friction": paper_curve_figures.friction,
    "figure9": paper_mechanism_figures.block_numbers,
    "figure10": paper_hinge_figures.block_numbers,
    "figure11": paper_curve_figures.numbers_of_blocks,
    "figure12": paper_mechanism_figures.imposed_at_90,
    "figure13": paper_mechanism_figures.sample_at_90,
    "figure14": paper_curve_figures.imposed_at_90,
    "figure15": paper_mechanism_figures.imposed_at_140,
    "figure16": paper_mechanism_figures.sample_at_140,
    "figure17": paper_curve_figures.imposed_at_140,
    "figure18": paper_mechanism_figures.half_angles,
    "figure19": paper_hinge_figures.half_angles,
    "figure20": paper_curve_figures.half_angles,
}
"""Name of each figure and what draws it from a campaign."""


def draw_all(campaign: Campaign, folder: Path) -> list[Path]:
    """Draw figures 1 to 20 as SVG and PNG.

    Parameters
    ----------
    campaign : Campaign
        The results.
    folder : Path
        Where the files go.

    Returns
    -------
    list of Path
        The files.
    """
    files = theory_figures.draw_all(folder)
    with house_style():
        for name, draw in FIGURES.items():
            files += save(draw(campaign), folder, name)
    return files


def animate_all(campaign: Campaign, folder: Path) -> list[Path]:
    """Write the animations as GIF.

    Parameters
    ----------
    campaign : Campaign
        The results.
    folder : Path
        Where the files go.

    Returns
    -------
    list of Path
        The files.
    """
    titles = paper_mechanism_figures
    four, wide, five = (campaign.results(name) for name in ("figure12", "figure15", "figure18"))
    friction = campaign.results("figure8")
    shown = [int(five.cases.where(half_angle_deg=angle)["case"][0]) for angle in (45, 90, 120, 145)]
    with house_style():
        return [
            animate(
                friction,
                list(friction.cases["case"]),
                titles.short_friction_title,
                folder / "animation8.gif",
            ),
            animate(
                four,
                [titles.case_of_joint(four, 54.5)],
                titles.imposed_title,
                folder / "animation13.gif",
            ),
            animate(
                wide,
                [titles.case_of_joint(wide, 59.0)],
                titles.imposed_title,
                folder / "animation16.gif",
            ),
            animate(five, shown, titles.short_half_angle_title, folder / "animation18.gif"),
        ]
