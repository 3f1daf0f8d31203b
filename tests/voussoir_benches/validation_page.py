"""The verification manual: results of the validation suite, as CSV and as a page."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from voussoir_benches.report_tables import grouped, markdown, write_csv
from voussoir_benches.scene import MOVED, Scene
from voussoir_benches.validation_plot import diagonal, has_diagonal, has_history, history
from voussoir_benches.validation_run import Line
from voussoir_benches.validation_sketch import sketch

SKETCHES = "images/verification"  #: Folder of the sketches beside the page
#: Heads of the entries of several decks, by the first of them
HEADS = {
    "incline": "Blocks that slide down a slope",
    "newmark_flat": "Newmark's sliding block",
    "overhang_stands": "Stacks with an overhang",
    "rocking_stocky": "Rocking blocks released from rest",
    "pulse_rocks": "Blocks in a rectangular pulse",
    "dry_wall_2x4": "Dry-stone walls under horizontal load",
    "lateral_arch": "Arches under horizontal load",
    "point_load_quarter_15": "Semicircles under a point load",
    "buttresses_1_stand": "Semicircle on buttresses 1 R high",
    "buttresses_2_stand": "Semicircle on buttresses 2 R high",
    "buttresses_3_stand": "Semicircle on buttresses 3 R high",
    "arch_pulse_100": "Arch of seven voussoirs in rectangular pulses",
    "bounce_first": "Rebounds in two runs",
    "worst_rings_2": "Arches of rings under an axle at its worst position",
}
_COLUMNS = "section scene quantity source exact computed error accepted rate seconds verdict".split()

_HEAD = """# Verification manual

Problems with exact answers, one entry per problem: model, input, exact value and its source, result and error.
`voussoir validation` writes this page from the decks of `input/benchmarks`. Do not edit it.

- **Exact value**: the entry states its formula or source.
- **Error**: relative to the exact value. It is absolute where that value is 0, and for displacements and angles.
  Verdicts have no error.
- **Accepted**: the largest accepted error. A larger one is marked **MISSED**.
- **Rate**: order of convergence in the time step, from three runs with halved steps. A dash means a single run or
  errors below 1e-9.
- **Sketch**: fixed blocks dark, movable blocks light, small displacements and mechanisms enlarged and dashed.
- **Plot**: displacement of the monitoring point against time, u solid and v dashed; or computed against exact
  values, where the dashed line is exact. Single critical values have their mechanism in the sketch.
- **Current**: the same deck with `--set analysis%geometry=current` (large displacements, deformable blocks). Its
  error includes the elastic shift.
"""

_TAIL = """
## Convergence rates

- Free flight is exact at any step, and so are bounces with restitution, since a step ends at each impact.
- Rocking converges with second order, also without restitution. Housner's blocks are rigid; the decks use 5e12 Pa,
  since 5e9 Pa changes the period by 1e-5. Errors below 1e-6 depend on where the reversal lies in its step, and may not
  decrease.
- `upslope_returns`: the error varies with the position of the reversal in its step.
- A rate near 0 means an error that does not depend on the step: on slopes the elastic strain under self-weight, 1e-7
  to 1e-6 m; in `toppling_onset` above the critical angle the strain of the block. Newmark's decks sample the ground
  motion every 4 to 5 ms; samples every 1 ms reduce their error to 1e-4.

## Dry walls

Limit analysis with dilatant friction is an upper bound of the tilt at collapse. The collapse load under Coulomb
friction depends on the loading path ([limits.md](limits.md#coulomb-friction-and-the-loading-path)).

## Not included

- **Newton's cradle**: simultaneous impacts have no unique solution.
- **Cantilever of one block**: a block has one strain and does not bend.
- **Sliding of a flat arch** between rigid walls: its thrust is not bounded, so no coefficient of friction is critical.
"""


def write_lines(lines: Sequence[Line], file: Path) -> None:
    """Write the table with every digit; columns error_2, error_4 hold the errors in shorter steps."""
    longest = max((len(line.errors) for line in lines), default=1)
    write_csv(file, [*_COLUMNS, *(f"error_{2**k}" for k in range(1, longest))], (
        [line.scene.group, line.scene.name, line.check.what, line.scene.note, line.check.exact, line.computed,
         *line.errors[:1], line.check.accept, "" if line.rate is None else f"{line.rate:.3f}", f"{line.seconds:.3f}",
         _verdict(line), *line.errors[1:]]
        for line in lines
    ))


def page(lines: Sequence[Line], titles: Mapping[str, str], version: str) -> str:
    """Return the verification manual.

    Parameters
    ----------
    lines : sequence of Line
        Results, in the order of their sections.
    titles : mapping of str to str
        Titles of the decks by their names.
    version : str
        Output of `dda --version`.
    """
    missed = sum(not line.accepted for line in lines)
    decks = len({line.scene.benchmark for line in lines})
    text = [_HEAD, f"{decks} decks, {len(lines)} values, **{missed} missed**; computed by {version}."]
    for section, own in itertools.groupby(lines, lambda line: line.scene.group):
        text += ["", f"## {section}"]
        problems: dict[tuple[str, str], list[Line]] = {}
        for line in own:
            problems.setdefault(_problem(line.scene), []).append(line)
        for problem in problems.values():
            text += _entry(problem, titles)
    return "\n".join(text) + "\n" + _TAIL


def sketches(lines: Sequence[Line]) -> dict[str, str]:
    """Sketches and plots of the entries as SVG, by the names of their files."""
    problems: dict[tuple[str, str, str], list[Line]] = {}
    for line in lines:
        problems.setdefault((line.scene.group, *_problem(line.scene)), []).append(line)
    drawn = {}
    for own in problems.values():
        if own[0].shapes:
            drawn[f"{own[0].scene.benchmark}.svg"] = sketch(own[0].shapes)
        if plot := _plot(own):
            drawn[f"{own[0].scene.benchmark}_result.svg"] = plot
    return drawn


def _plot(lines: Sequence[Line]) -> str:
    """Plot of the results of a problem as SVG: over time, else against exact values of one unit, else empty."""
    if has_history(lines[0].track):
        return history(lines[0].track)
    known = [line for line in lines if not isinstance(line.check.exact, str) and not isinstance(line.computed, str)]
    units = [re.search(r"\[.*\]$", line.check.what) for line in known]
    unit = units[0][0] if units and units[0] else ""
    same = [line for line, own in zip(known, units) if unit == (own[0] if own else "")]
    exact, computed = [float(line.check.exact) for line in same], [float(line.computed) for line in same]
    if same and has_diagonal(exact):
        return diagonal(exact, computed, unit)
    return ""


def screen_line(line: Line) -> str:
    """One line for the terminal."""
    found = line.computed if isinstance(line.computed, str) else f"{line.computed:.8g}"
    what = f"{line.scene.name}: {line.check.what}"
    return f"{_verdict(line):6} {what}: {found}, error {line.errors[0]:.1e}"


def _verdict(line: Line) -> str:
    return "ok" if line.accepted else "MISSED"


def _problem(scene: Scene) -> tuple[str, str]:
    """Key of decks that share an entry: the first word of their names, and the source of their exact values."""
    return re.sub(r"s?(_.*)?$", "", scene.benchmark), scene.note


def _is_current(scene: Scene) -> bool:
    """Return true for a deck that is run with large displacements."""
    return scene.settings == MOVED


def _entry(lines: list[Line], titles: Mapping[str, str]) -> list[str]:
    """Entry of one problem: its decks, its exact value, and its table."""
    decks = grouped((line.scene for line in lines), "benchmark")
    links = {deck: f"[`{deck}`](../input/benchmarks/{deck}.nml)" for deck in decks}
    plain = [line for line in lines if not _is_current(line.scene)]
    moved = {(line.scene.benchmark, line.check.what): line for line in lines if _is_current(line.scene)}
    pairs = [(line, moved.get((line.scene.benchmark, line.check.what)) if plain else None) for line in plain or lines]
    columns = _columns(pairs, len(decks) > 1)
    cells = [[cell(*pair) for cell in columns.values()] for pair in pairs]
    exact = f"Exact: {lines[0].scene.note}.{_accepted(plain, moved.values())}"
    first = lines[0].scene.benchmark
    if len(decks) == 1:
        about = [f"### {titles[first]}", "", f"{links[first]}.", exact]
    else:
        listed = [f"- {link}:\n  {titles[deck]}" for deck, link in links.items()]
        about = [f"### {HEADS.get(first, titles[first])}", "", *listed, "", exact]
    if lines[0].shapes:
        about += ["", f"![{lines[0].scene.benchmark}]({SKETCHES}/{lines[0].scene.benchmark}.svg)"]
        if _plot(lines):
            about.append(f"![{lines[0].scene.benchmark}_result]({SKETCHES}/{lines[0].scene.benchmark}_result.svg)")
    return ["", *about, "", *markdown(list(columns), "l" * len(columns), cells)]


def _accepted(lines: Iterable[Line], moved: Iterable[Line]) -> str:
    """Sentence on the largest accepted errors, empty for verdicts."""
    bounds = [_bounds(lines), _bounds(moved)]
    if bounds[0] == bounds[1] or not all(bounds):
        bounds = [bounds[0] or bounds[1]]
    return f" Accepted: {', current '.join(bounds)}." if bounds[0] else ""


def _bounds(lines: Iterable[Line]) -> str:
    """Least and largest of the accepted errors."""
    bounds = [line.check.accept for line in lines if not isinstance(line.check.exact, str)]
    return " to ".join(f"{bound:g}" for bound in dict.fromkeys((min(bounds), max(bounds)))) if bounds else ""


def _columns(pairs: list[tuple[Line, Line | None]], named: bool) -> dict[str, Callable[[Line, Line | None], str]]:
    """Columns of a table: their heads, and the cell of a line and its counterpart in current geometry."""
    heads: dict[str, Callable[[Line, Line | None], str]] = {}
    if named:
        heads["deck"] = lambda line, _: f"`{line.scene.benchmark}`"
    heads["quantity"] = lambda line, _: line.check.what
    heads["exact"] = lambda line, _: _number(line.check.exact)
    heads["computed"] = lambda line, _: _number(line.computed)
    measured = any(not isinstance(line.check.exact, str) for line, _ in pairs)
    if measured or not all(line.accepted for line, _ in pairs):
        heads["error"] = lambda line, _: _error(line)
    if any(line.rate is not None for line, _ in pairs):
        heads["rate"] = lambda line, _: "-" if line.rate is None else f"{round(line.rate, 1) + 0.0:.1f}"
    if any(moved for _, moved in pairs):
        heads["current"] = lambda _, moved: _number(moved.computed) if moved else "-"
        if measured:
            heads["its error"] = lambda _, moved: _error(moved) if moved else "-"
    return heads


def _number(value: float | str) -> str:
    """A verdict, or a number of six digits."""
    return value if isinstance(value, str) else f"{value:.6g}"


def _error(line: Line) -> str:
    """Error of a line, marked if it is not accepted."""
    error = "" if isinstance(line.check.exact, str) else f"{line.errors[0]:.1e}"
    return error if line.accepted else f"{error} **MISSED**".strip()
