"""Work-precision diagrams: the points as CSV, tables in Markdown, and the figures."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from voussoir.bench import work_precision_scenes as scenes
from voussoir.bench.work_precision_fronts import Panel, Point, front
from voussoir.bench.work_precision_runs import Race

#: Smallest error that a logarithmic axis shows: below, digits are spent
LEAST_ERROR = 1e-16
#: Errors that the table tells the cost of
GOALS = (1e-1, 1e-3, 1e-6, 1e-9)
#: Colour (place in the style's inks), mark and line of each method
_LOOKS = {
    scenes.RIGID: (1, "o", "-"),
    scenes.ELASTIC: (0, "s", "-"),
    scenes.ASSOCIATED: (1, "D", "--"),
    scenes.ORIGINAL: (2, "^", "-"),
    scenes.SIMPLEX: (3, "v", "--"),
    scenes.INTERIOR: (3, "P", ":"),
}


def write_csv(panels: Sequence[Panel], file: Path) -> None:
    """Write all points, those behind the fronts too."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["scene", "method", "setting", "answer", "error", "seconds", "on_front"])
        for panel in panels:
            best = {id(point) for own in by_method(panel).values() for point in front(own)}
            for point in panel.points:
                known = ["" if value is None else repr(value) for value in (point.answer, point.error)]
                writer.writerow(
                    [point.scene, point.method, point.setting, *known, repr(point.seconds), int(id(point) in best)]
                )


def by_method(panel: Panel) -> dict[str, list[Point]]:
    """The points of each method."""
    methods: dict[str, list[Point]] = {}
    for point in panel.points:
        methods.setdefault(point.method, []).append(point)
    return methods


def front_table(panels: Sequence[Panel]) -> list[str]:
    """Markdown lines: the least time in which a method reaches an error.

    Returns
    -------
    list of str
        The table, a line a class and method.
    """
    lines = [
        "| scene | method | least error " + "".join(f"| error ≤ {goal:g} " for goal in GOALS) + "|",
        "| --- | --- | ---: " + "| ---: " * len(GOALS) + "|",
    ]
    for panel in panels:
        for method, own in by_method(panel).items():
            best = front(own)
            least = f"{max(best[-1].error, LEAST_ERROR):.0e}" if best else "no answer"
            reached = [next((point for point in best if point.error <= goal), None) for goal in GOALS]
            cells = [f"{point.seconds * 1e3:.3g} ms" if point else "-" for point in reached]
            lines.append(f"| {own[0].scene} | {method} | {least} | " + " | ".join(cells) + " |")
    return lines


def race_table(races: Sequence[Race]) -> list[str]:
    """Markdown lines of the decisions' times and their ratios."""
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


def draw(panels: Sequence[Panel], folder: Path) -> list[Path]:
    """Error against run time: all panels in one figure, and the first one alone.

    Parameters
    ----------
    folder : Path
        Where work_precision.svg and work_precision_arch.svg go, and .png of both.
    """
    from voussoir.plot.figure_style import Picture, house_style, save

    with house_style():
        whole = Picture(figsize=(10.4, 11.4), layout="constrained")
        grid = list(whole.subplots(3, 2, sharex=True).flat)
        handles: dict[str, object] = {}
        for axes, panel in zip(grid, panels):
            handles |= _draw_panel(axes, panel)
        for axes in grid[len(panels) :]:
            axes.set_axis_off()
        for axes in grid[: len(panels)]:
            axes.tick_params(labelbottom=True)
            axes.set_xlabel("time [ms]")
        order = [handles[name] for name in _LOOKS if name in handles]
        if len(panels) < len(grid):
            grid[-1].legend(handles=order, loc="center", fontsize=11, title="best settings of")
        else:
            whole.legend(handles=order, loc="outside lower center", ncols=3)
        paths = save(whole, folder, "work_precision")
        alone = Picture(figsize=(6.4, 4.6), layout="constrained")
        axes = alone.subplots()
        shown = _draw_panel(axes, panels[0])
        axes.set_xlabel("time [ms]")
        axes.legend(handles=list(shown.values()), fontsize=9, loc="best")
        return paths + save(alone, folder, "work_precision_arch")


def _draw_panel(axes, panel: Panel) -> dict[str, object]:
    """One panel; gives the entries of the legend by their methods."""
    from voussoir.plot.figure_style import INK

    entries = {}
    for method, own in by_method(panel).items():
        best = front(own)
        color, mark, dash = _LOOKS[method]
        times = [point.seconds * 1e3 for point in best]
        errors = [max(point.error, LEAST_ERROR) for point in best]
        # between two points nothing better is known than the one that took less time
        (entries[method],) = axes.loglog(
            times,
            errors,
            drawstyle="steps-post",
            linestyle=dash,
            linewidth=1.3,
            color=INK[color],
            marker=mark,
            markersize=5.5,
            markerfacecolor="white",
            label=method,
        )
    if panel.gap:
        axes.axhline(panel.gap, color=INK[2], linewidth=0.9, linestyle=(0, (1, 2)))
        axes.annotate(
            f"the associated limit is {100.0 * panel.gap:.2g} % above the answer under Coulomb friction",
            (0.02, panel.gap),
            xycoords=("axes fraction", "data"),
            xytext=(0, -10),
            textcoords="offset points",
            fontsize=8,
            color=INK[2],
        )
    axes.set_title(panel.title, fontsize=11)
    axes.set_ylabel("relative error")
    least = min((point.error for own in by_method(panel).values() for point in front(own)), default=0)
    decades = 16 if least < 1e-6 else 6
    axes.set_ylim(10.0**-decades / 3.0, 3.0)
    axes.set_yticks([10.0**-k for k in range(0, decades + 1, decades // 4 if decades > 6 else 2)])
    silent = [method for method, own in by_method(panel).items() if not front(own)]
    if silent:
        axes.annotate("no answer: " + ", ".join(silent), (0.02, 0.5), va="center", xycoords="axes fraction", fontsize=8)
    return entries
