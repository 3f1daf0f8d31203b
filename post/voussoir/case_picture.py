"""The picture of one case: blocks, line of thrust, hinges, slips, forces, displaced shape."""

from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from voussoir.collapse_picture import MARKS, MEANINGS
from voussoir.figure_style import INK, STONE
from voussoir.joint_chain import JointChain, chain_of, displaced, forces, outlines, thrust_points
from voussoir.results import Results, Table

#: Longest force and largest displacement in the picture, over the arch's width
FORCE_LENGTH, DISPLACED_LENGTH = 0.10, 0.04
#: A joint whose shear comes so near to its friction slides
AT_LIMIT = 1.0 - 1.0e-6

Row = dict[str, Any]


def draw_case(
    run: Results, number: int, magnify: float | None = None, with_forces: bool = True
) -> Figure:
    """Draw one case of an arch.

    Parameters
    ----------
    run : Results
        The results of the deck.
    number : int
        Number of the case.
    magnify : float, optional
        Magnification of the displaced shape, 0 for none; chosen and stated if not given.
    with_forces : bool, optional
        Whether the forces of the joints are drawn.

    Returns
    -------
    Figure
        The figure.
    """
    row, joints = run.case(number), run.joints_of(number)
    chain = chain_of(joints)
    blocks = outlines(chain, facet_of(run, row))
    width = float(np.ptp(np.vstack((chain.intrados, chain.extrados))[:, 0]))
    figure, axes = plt.subplots(figsize=(8.0, 5.2), layout="constrained")
    axes.set_aspect("equal")
    axes.set_axis_off()
    entries = [draw_blocks(axes, blocks)]
    entries += draw_displaced(axes, chain, joints, blocks, width, magnify)
    entries += draw_thrust(axes, chain, joints)
    if with_forces:
        entries += draw_forces(axes, chain, joints, width)
    entries += draw_marks(axes, chain, joints, row, width)
    axes.autoscale_view()
    axes.set_title(title_of(row), fontsize=11)
    figure.legend(
        handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2, fontsize=9
    )
    return figure


def title_of(row: Row) -> str:
    """What the case is and how it ended.

    Parameters
    ----------
    row : dict
        Its row of results.csv.

    Returns
    -------
    str
        One or two lines.
    """
    given = [f"{row['blocks']} blocks", f"half angle {row['half_angle_deg']:g}°"]
    for name, words in (("thickness_ratio", "t/r = {:g}"), ("friction_deg", "friction {:g}°")):
        if not math.isnan(row[name]):
            given.append(words.format(row[name]))
    end = f"{row['verdict']}"
    if row["verdict"] == "found":
        end += f": critical value {row['critical']:.6f}"
        if not math.isnan(row["exact"]):
            end += f", exact {row['exact']:.6f}"
    if row["collapse_mode"] != "none":
        end += f", {row['collapse_mode']} collapse"
    return f"Case {row['case']}: " + ", ".join(given) + "\n" + end


def facet_of(run: Results, row: Row) -> float | None:
    """Largest angle of a chord: swept, or given in the deck that the folder's record tells of.

    Parameters
    ----------
    run : Results
        The results of the deck.
    row : dict
        Row of the case.

    Returns
    -------
    float or None
        The angle [deg], None for one chord a block.
    """
    if "facet_deg" in row:
        return float(row["facet_deg"])
    record = run.folder / "deck.record"
    lines = record.read_text(encoding="utf-8").splitlines() if record.is_file() else []
    if "arch%facet_deg" not in lines:
        return None
    return float(lines[lines.index("arch%facet_deg") + 1])


def draw_blocks(axes: Axes, blocks: list[np.ndarray]) -> Line2D:
    """Draw the blocks as they are before any motion; gives the entry of the legend."""
    axes.add_collection(
        PolyCollection(blocks, facecolors=STONE, edgecolors=INK[3], linewidths=0.7, zorder=1)
    )
    return _entry("blocks", marker="s", markerfacecolor=STONE, markeredgecolor=INK[3])


def draw_displaced(
    axes: Axes,
    chain: JointChain,
    joints: Table,
    blocks: list[np.ndarray],
    width: float,
    magnify: float | None,
) -> list[Line2D]:
    """Draw the displaced shape where the joints tell one; gives the entries of the legend."""
    moved = None if magnify == 0 else displaced(chain, joints, blocks)
    if moved is None:
        return []
    largest = max(float(np.abs(part).max()) for part in moved)
    if magnify is None:
        magnify = rounded(DISPLACED_LENGTH * width / largest)
    shapes = [block + magnify * part for block, part in zip(blocks, moved)]
    axes.add_collection(
        PolyCollection(shapes, facecolors="none", edgecolors=INK[0], linewidths=0.8, zorder=2)
    )
    words = f"displaced shape, displacements × {magnify:g} (largest {largest:.3g} m)"
    return [_entry(words, linestyle="-", color=INK[0], linewidth=0.8)]


def draw_thrust(axes: Axes, chain: JointChain, joints: Table) -> list[Line2D]:
    """Draw the line of thrust; gives the entries of the legend."""
    axes.plot(*thrust_points(chain, joints).T, color=INK[1], linewidth=1.8, zorder=4)
    return [_entry("line of thrust", linestyle="-", color=INK[1])]


def draw_forces(axes: Axes, chain: JointChain, joints: Table, width: float) -> list[Line2D]:
    """Draw the force of each joint on the block behind it; gives the entries of the legend."""
    vectors = forces(chain, joints)
    largest = float(np.linalg.norm(vectors, axis=1).max())
    if not largest > 0.0:
        return []
    points, arrows = thrust_points(chain, joints), vectors * (FORCE_LENGTH * width / largest)
    axes.quiver(
        *points.T, *arrows.T, angles="xy", scale_units="xy", scale=1.0, color=INK[2],
        width=0.0022, zorder=3,
    )
    words = f"contact forces, longest {largest / 1e3:.4g} kN/m"
    return [_entry(words, linestyle="-", color=INK[2], linewidth=1.2)]


def draw_marks(
    axes: Axes, chain: JointChain, joints: Table, row: Row, width: float
) -> list[Line2D]:
    """Draw hinges and slips; gives the entries of the legend.

    Hinges are those of the case's row, that is of its collapse; where nothing collapses, the joints
    that have opened at one end.
    """
    entries = []
    angle, state = np.round(np.abs(joints["angle_deg"]), 6), joints["state"]
    for kind, ends in (("intrados", chain.intrados), ("extrados", chain.extrados)):
        hinge = np.isin(angle, np.round(row[f"{kind}_hinge_deg"], 6))
        if row["collapse_mode"] == "none":
            hinge = state == f"hinge_{kind}"
        if hinge.any():
            axes.plot(*ends[hinge].T, linestyle="none", markersize=7, zorder=6, **MARKS[kind])
            entries.append(_entry(MEANINGS[kind], **MARKS[kind]))
    slides = np.flatnonzero(sliding(joints, row))
    size = 0.03 * width
    for joint in slides:
        # the block behind the joint slides against the shear force that the joint puts on it
        way = -np.sign(joints["shear_force"][joint]) * size * chain.outward[joint]
        middle = 0.5 * (chain.intrados[joint] + chain.extrados[joint])
        for side in (1.0, -1.0):
            start = middle + side * (0.25 * size * chain.along[joint] - 0.5 * way)
            axes.annotate(
                "", start + side * way, start, zorder=7,
                arrowprops={"arrowstyle": "->", "color": INK[0], "linewidth": 1.4,
                            "shrinkA": 0, "shrinkB": 0},
            )
    if len(slides):
        entries.append(_entry("sliding joint: which way its sides move", marker=r"$\rightleftarrows$",
                              markerfacecolor=INK[0], markeredgecolor=INK[0], markersize=11))
    return entries


def sliding(joints: Table, row: Row) -> np.ndarray:
    """Which joints slide: by their state, or because friction has no more to give.

    Parameters
    ----------
    joints : Table
        Joints of the case.
    row : dict
        Row of the case.

    Returns
    -------
    ndarray
        A flag each: (n,).
    """
    slides = joints["state"] == "sliding"
    friction = row["friction_deg"]
    if not math.isnan(friction) and friction < 89.9 and row["sliding_share"] >= 1.0e-3:
        most = joints["normal_force"] * math.tan(math.radians(friction))
        slides = slides | (np.abs(joints["shear_force"]) >= AT_LIMIT * most)
    return slides & (joints["normal_force"] > 0.0)


def rounded(value: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that does not exceed a number.

    Parameters
    ----------
    value : float
        Above 0.

    Returns
    -------
    float
        Such as 200.
    """
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-12))


def _entry(label: str, **style) -> Line2D:
    return Line2D([], [], **({"linestyle": "none", "label": label} | style))
