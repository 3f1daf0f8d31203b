"""Work-precision diagrams: the points as CSV, tables in Markdown, and the figure."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from voussoir.work_precision_runs import Arch, Point, Race

#: Smallest error that a logarithmic axis shows: below, digits are spent
LEAST_ERROR = 1e-16


def write_csv(points: Sequence[Point], file: Path) -> None:
    """Write all points.

    Parameters
    ----------
    points : sequence of Point
        The points.
    file : Path
        Where.
    """
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(
            ["half_angle_deg", "voussoirs", "family", "setting", "error", "seconds", "work"]
        )
        for point in points:
            error = "" if point.error is None else repr(point.error)
            writer.writerow(
                [
                    f"{point.arch.half_angle_deg:g}",
                    point.arch.voussoirs,
                    point.family,
                    point.setting,
                    error,
                    repr(point.seconds),
                    point.decisions,
                ]
            )


def race_table(races: Sequence[Race]) -> list[str]:
    """Markdown lines of the decisions' times and their ratios.

    Parameters
    ----------
    races : sequence of Race
        The times.

    Returns
    -------
    list of str
        The table.
    """
    lines = [
        "| half angle | voussoirs | decision us | right | search us | general LP us | right "
        "| compact LP us | right | general / decision | compact / decision | search / compact |",
        "| ---: " * 12 + "|",
    ]
    for race in races:
        start = (
            f"| {race.arch.half_angle_deg:g} | {race.arch.voussoirs} | {race.decision * 1e6:.0f} "
            f"| {race.right} of 4 | {race.search * 1e6:.0f} "
        )
        if race.general is None or race.compact is None:
            lines.append(start + "| - " * 7 + "|")
            continue
        lines.append(
            start + f"| {race.general * 1e6:.0f} | {race.general_right} of 4 "
            f"| {race.compact * 1e6:.0f} | {race.compact_right} of 4 "
            f"| {race.general / race.decision:.0f} | {race.compact / race.decision:.1f} "
            f"| {race.search / race.compact:.2f} |"
        )
    return lines


def best_table(points: Sequence[Point]) -> list[str]:
    """Markdown lines: the fastest setting that reaches each accuracy.

    Parameters
    ----------
    points : sequence of Point
        The points.

    Returns
    -------
    list of str
        The table.
    """
    goals = (1e-3, 1e-6, 1e-8, 1e-10)
    lines = [
        "| half angle | voussoirs " + "".join(f"| error <= {goal:.0e} " for goal in goals) + "|",
        "| ---: | ---: " + "| --- " * len(goals) + "|",
    ]
    for arch in dict.fromkeys(point.arch for point in points):
        cells = []
        for goal in goals:
            reached = [
                point
                for point in points
                if point.arch == arch and point.error is not None and point.error <= goal
            ]
            best = min(reached, key=lambda point: point.seconds, default=None)
            cells.append(
                f"{best.family} = {best.setting}: {best.seconds * 1e3:.2f} ms" if best else "none"
            )
        lines.append(f"| {arch.half_angle_deg:g} | {arch.voussoirs} | " + " | ".join(cells) + " |")
    return lines


def draw(points: Sequence[Point], folder: Path) -> list[Path]:
    """Error against run time, one panel an arch.

    Parameters
    ----------
    points : sequence of Point
        The points.
    folder : Path
        Where work_precision.svg and .png go.

    Returns
    -------
    list of Path
        The files.
    """
    from voussoir.figure_style import house_style, plt, save

    arches = list(dict.fromkeys(point.arch for point in points))
    families = list(dict.fromkeys(point.family for point in points))
    columns = min(3, len(arches))
    rows = -(-len(arches) // columns)
    with house_style():
        size = 4.2 * columns, 3.6 * rows
        figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False)
        for axis in axes.flat[len(arches) :]:
            axis.set_visible(False)
        for axis, arch in zip(axes.flat, arches):
            _draw_panel(axis, arch, [point for point in points if point.arch == arch], families)
        handles = dict(
            pair for axis in axes.flat for pair in zip(*reversed(axis.get_legend_handles_labels()))
        )
        shown = [name for name in families if name in handles]
        figure.legend(
            [handles[name] for name in shown], shown, loc="lower center", ncol=4, fontsize=8
        )
        figure.tight_layout(rect=(0.0, 0.2 / rows, 1.0, 1.0))
        return save(figure, folder, "work_precision")


def _draw_panel(axis, arch: Arch, points: Sequence[Point], families: Sequence[str]) -> None:
    """One panel."""
    from voussoir.figure_style import DASHES, INK

    marks = "osv^Dx+*Pph<"
    for number, family in enumerate(families):
        shown = [point for point in points if point.family == family and point.error is not None]
        axis.loglog(
            [point.seconds * 1e3 for point in shown],
            [max(point.error, LEAST_ERROR) for point in shown],
            marker=marks[number % len(marks)],
            markersize=3.5,
            linewidth=0.9,
            color=INK[number % len(INK)],
            linestyle=DASHES[number // len(INK) % len(DASHES)],
            label=family,
        ) if shown else None
    axis.set_title(f"{arch.half_angle_deg:g}°, {arch.voussoirs} voussoirs", fontsize=10)
    axis.set_xlabel("time [ms]")
    axis.set_ylabel("relative error")
