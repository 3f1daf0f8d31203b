"""Work-precision diagrams: the points as CSV, tables in Markdown, and the figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from voussoir_benches import work_precision_scenes as scenes
from voussoir_benches.report_tables import grouped, markdown, write_csv
from voussoir_benches.work_precision_fronts import Panel, Point, front
from voussoir_benches.work_precision_motion import MotionPoint, order
from voussoir_benches.work_precision_runs import Race

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

ALL_DIGITS = 1e-14  #: Errors up to this are rounding: all digits are right
LEAST_ERROR = 1e-16  #: Smallest error that a logarithmic axis shows: below, digits are spent
#: Colour of words in the axes
_QUIET = "#555555"
#: Errors whose cost the tables have, and that of blocks that move
GOALS, MOTION_GOALS = (1e-1, 1e-3, 1e-6, 1e-9), (1e-2, 1e-3, 1e-4, 1e-6)
#: Colour (place in the style's inks), mark and line of each method
_LOOKS = {
    scenes.RIGID: (1, "o", "-"), scenes.ELASTIC: (0, "s", "-"), scenes.COULOMB: (0, "s", "-"),
    scenes.ASSOCIATED: (1, "D", "--"), scenes.ORIGINAL: (2, "^", "-"), scenes.SIMPLEX: (3, "v", "--"),
    scenes.INTERIOR: (3, "P", ":")}


def write_points(panels: Sequence[Panel], file: Path) -> None:
    """Write all points, those behind the fronts too."""
    best = {id(point) for panel in panels for own in grouped(panel.points, "method").values() for point in front(own)}
    write_csv(file, ("scene", "method", "setting", "answer", "error", "seconds", "on_front"), (
        [point.scene, point.method, point.setting,
         *("" if value is None else repr(value) for value in (point.answer, point.error)),
         repr(point.seconds), int(id(point) in best)]
        for panel in panels for point in panel.points
    ))


def front_table(panels: Sequence[Panel]) -> list[str]:
    """Markdown lines: the least time in which a method reaches an error, a line a class and method."""
    rows = []
    for panel in panels:
        for method, own in grouped(panel.points, "method").items():
            best = front(own)
            least = f"{max(best[-1].known_error, LEAST_ERROR):.0e}" if best else "no answer"
            reached = [next((point for point in best if point.known_error <= goal), None) for goal in GOALS]
            times = [f"{point.seconds * 1e3:.3g} ms" if point else "-" for point in reached]
            rows.append([own[0].scene, method, least, *times])
    heads = ["scene", "method", "least error", *(f"error ≤ {goal:g}" for goal in GOALS)]
    return markdown(heads, "llr" + "r" * len(GOALS), rows)


_RACE = (
    "half angle", "voussoirs", "decision us", "right", "search us", "general LP us", "right", "compact LP us", "right",
    "general / decision", "compact / decision", "search / compact")


def race_table(races: Sequence[Race]) -> list[str]:
    """Markdown lines of the decisions' times and their ratios."""
    rows = []
    for race in races:
        row = [f"{race.arch.half_angle_deg:g}", str(race.arch.voussoirs), f"{race.decision * 1e6:.0f}",
               f"{race.right} of 4", f"{race.search * 1e6:.0f}"]
        if race.general is None or race.compact is None:
            row += ["-"] * 7
        else:
            row += [f"{race.general * 1e6:.0f}", f"{race.general_right} of 4", f"{race.compact * 1e6:.0f}",
                    f"{race.compact_right} of 4", f"{race.general / race.decision:.0f}",
                    f"{race.compact / race.decision:.1f}", f"{race.search / race.compact:.2f}"]
        rows.append(row)
    return markdown(_RACE, "r" * 12, rows)


def write_motion(points: Sequence[MotionPoint], file: Path) -> None:
    """Write all points of blocks that move."""
    write_csv(file, ("scene", "step", "error", "seconds", "steps"), (
        [point.scene, repr(point.step), repr(point.error), repr(point.seconds), point.steps] for point in points))


def motion_table(points: Sequence[MotionPoint]) -> list[str]:
    """Markdown lines: order of convergence, and the longest step that reaches each accuracy."""
    rows = []
    for scene, own in grouped(points, "scene").items():
        slope = order(own)
        errors = [point.error for point in own]
        rows.append([scene, "rounding at any step" if slope is None else f"{slope:.1f}", f"{max(errors):.1e}",
                     f"{min(errors):.1e}", *(_cheapest(own, goal) for goal in MOTION_GOALS)])
    heads = ["scene", "order", "largest error", "least error", *(f"error <= {goal:.0e}" for goal in MOTION_GOALS)]
    return markdown(heads, "lrrr" + "l" * len(MOTION_GOALS), rows)


def _cheapest(points: Sequence[MotionPoint], goal: float) -> str:
    """The longest step that reaches an accuracy, and its time."""
    best = max((point for point in points if point.error <= goal), key=lambda point: point.step, default=None)
    return f"{best.step * 1e3:g} ms: {best.seconds * 1e3:.1f} ms" if best else "none"


def draw(panels: Sequence[Panel], folder: Path) -> list[Path]:
    """Error against run time: work_precision_arch.svg and so on, a class of scene each, on the same axis of time."""
    from voussoir.plot.figure_style import Picture, house_style, save

    fronts = [front(own) for panel in panels for own in grouped(panel.points, "method").values()]
    times = [point.seconds for best in fronts for point in best]
    if not times:
        return []
    span = 10.0 ** math.floor(math.log10(min(times)) - 0.1), 10.0 ** math.ceil(math.log10(max(times)) + 0.2)
    paths = []
    with house_style():
        for panel in panels:
            picture = Picture(figsize=(4.8, 4.7), layout="constrained")
            axes = picture.subplots()
            handles = _draw_panel(axes, panel, span)
            axes.legend(
                handles=handles, fontsize=9.5, handlelength=2.4, loc="upper left", bbox_to_anchor=(-0.12, -0.16))
            paths += save(picture, folder, "work_precision_" + panel.points[0].scene.replace(" ", "_"))
    return paths


def answer_words(method: str, own: Sequence[Point]) -> str:
    """Least error of a method and its time: a line of a legend."""
    best = front(list(own))
    if not best:
        return f"{method}: no answer"
    last = next(point for point in best if point.known_error <= max(best[-1].known_error, ALL_DIGITS))
    if last.known_error <= ALL_DIGITS:
        return f"{method}: all digits in {_duration(last.seconds)}"
    return f"{method}: {_share(last.known_error)} in {_duration(last.seconds)}"


def _share(error: float) -> str:
    """An error in words: percent where that is legible."""
    if error >= 1e-4:
        return f"{100.0 * error:.2g} %"
    digit, _, power = f"{error:.0e}".partition("e")
    return f"${digit}\\cdot10^{{{int(power)}}}$"


def _duration(seconds: float, digits: int = 2) -> str:
    """A time with its unit, to so many digits."""
    unit, scale = ("s", 1.0) if seconds >= 1.0 else ("ms", 1e3) if seconds >= 1e-5 else ("µs", 1e6)
    shown = float(f"{scale * seconds:.{digits - 1}e}")
    return f"{shown:g} {unit}"


def _draw_panel(axes: Axes, panel: Panel, span: tuple[float, float]) -> list[Line2D]:
    """One panel; gives the lines of its legend, the quickest method first."""
    from voussoir.plot.figure_style import INK

    methods = grouped(panel.points, "method")
    least = min((point.known_error for own in methods.values() for point in front(own)), default=0.0)
    decades = 16 if least < 1e-6 else 4
    bottom, top = 10.0**-decades / (6.0 if decades == 16 else 2.0), 2.0
    entries = {}
    for method, own in methods.items():
        best = front(own)
        color, mark, dash = _LOOKS[method]
        times = [point.seconds for point in best]
        errors = [max(point.known_error, LEAST_ERROR) for point in best]
        look: dict[str, Any] = {"linestyle": dash, "color": INK[color], "linewidth": 1.4}
        if best:  # nothing is known before the first answer, and the best one holds from then on
            end = times[-1] if errors[-1] <= ALL_DIGITS else span[1]
            axes.plot([times[0], *times, end], [top, *errors, errors[-1]], drawstyle="steps-post", **look)
        marks: dict[str, Any] = {"marker": mark, "markersize": 6, "markerfacecolor": "white"}
        axes.plot(times, errors, color=INK[color], linestyle="none", zorder=3, **marks)
        (entries[method],) = axes.plot([], [], label=answer_words(method, own), **look, **marks)
    axes.set(xscale="log", yscale="log", xlim=span, ylim=(bottom, top))
    axes.set_title(panel.title, fontsize=11.5, loc="left")
    axes.set_xlabel("time to answer")
    axes.set_ylabel("relative error of the answer")
    axes.set_xticks([t for t in (10.0**k for k in range(-6, 4)) if span[0] <= t <= span[1]])
    axes.xaxis.set_major_formatter(lambda t, place: _duration(t))
    axes.set_yticks([10.0**-k for k in range(0, decades + 1, decades // 4)])
    axes.yaxis.set_major_formatter(lambda error, place: _tick(error))
    axes.minorticks_off()
    if decades == 16:
        axes.axhspan(bottom, ALL_DIGITS, color="#eeeeee", zorder=0)
        _note(axes, "rounding", ALL_DIGITS, -11, right=True)
    if panel.gap:
        axes.axhline(panel.gap, color=_QUIET, linewidth=0.9, linestyle=(0, (1, 2)))
        _note(axes, f"the associated limit is {_share(panel.gap)} above\nthe load under Coulomb friction",
              panel.gap, -24, right=True)
    return [entries[method] for method in sorted(entries, key=lambda method: _first_time(methods[method]))]


def _first_time(own: Sequence[Point]) -> float:
    """When a method has its best answer; never where it has none."""
    best = front(list(own))
    return best[-1].seconds if best else math.inf


def _tick(error: float) -> str:
    """An error at its tick: percent as long as it is legible, then powers of ten."""
    power = round(math.log10(error))
    return f"{100.0 * error:g} %" if power >= -4 else f"$10^{{{power}}}$"


def _note(axes: Axes, text: str, error: float, below: float, right: bool = False) -> None:
    """Words at the left or right end of the axes, so many points below an error."""
    box = {"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.85} if "\n" in text else None
    place, side = (0.98, "right") if right else (0.02, "left")
    axes.annotate(text, (place, error), xycoords=("axes fraction", "data"), xytext=(0, below), bbox=box, ha=side,
                  textcoords="offset points", fontsize=8.5, color=_QUIET, linespacing=1.1, zorder=4)
