"""The table of the validation suite, as CSV and as a page."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

from voussoir.bench.report_tables import markdown, write_csv
from voussoir.bench.validation_run import Line

_COLUMNS = "section scene quantity source exact computed error accepted rate seconds verdict".split()

_HEAD = """# Validation

Scenes with exact answers: what the answer is, what the program computes, and how far apart the
two are. This page is written by `voussoir validation` from a run of the decks in
`input/benchmarks`; do not edit it, run the command again.

- *error*: over the exact value; where that is 0, or where a way or an angle is compared as it
  stands, in the unit of the quantity or over what it names. Scenes that stand or fall have none.
- *accepted*: the largest error that is accepted. A line that misses it says **MISSED**.
- *rate*: order of the error in the time step, from runs with the deck's step, a half and a
  quarter of it. A dash: not run in shorter steps, or round-off (below 1e-9).
- *time*: wall time of the whole deck with its own step [s]. It depends on the machine.
- A scene named with `current` is the deck with `--set analysis%geometry=current`: blocks that
  move and strain.
"""

_TAIL = """
## What the lines that miss show

- **dry walls.** The limit is that of dilatant friction, an upper bound for Coulomb's. The answer
  under Coulomb friction depends on the way of the loads; [limits.md](limits.md) says what was found.

## What the rates show

- Flight is exact at any step, and so are bounces with restitution: a step ends where blocks meet.
- **rocking.** Second order in the step, without restitution. Housner's blocks are rigid: these have a modulus of
  5e12 Pa, for with 5e9 Pa their strain makes 1e-5 of the period. Some next amplitudes fall faster than that, or
  not at all below 1e-6, as the step in which the block turns back lies.
- **upslope_returns.** The error is made in the step in which the block turns; where in the step
  that is changes with its length.
- A rate near 0 is an error that is not one of the step. On slopes it is the strain of the block
  that settles when its weight comes on (1e-7 to 1e-6 m). Newmark's decks give the ground's motion
  at points 4 or 5 ms apart; with points at every ms their errors are near 1e-4. In `toppling_onset`
  above phi_c it is the strain of the block; ten thousand times as stiff it errs by 3e-6.

## Not in the suite

- **Newton's cradle.** Simultaneous impacts are not unique.
- **The cantilever of one block.** A block has one strain and does not bend ([limits.md](limits.md)).
- **Sliding of a flat arch** between walls that do not yield: its thrust may grow, so there is no
  one coefficient of friction at which it slips.
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


def page(lines: Sequence[Line], version: str) -> str:
    """The page of lines in the order of their sections, and of what `dda --version` prints."""
    missed = sum(not line.accepted for line in lines)
    scenes = len({line.scene.name for line in lines})
    text = [_HEAD, f"{scenes} scenes, {len(lines)} values, **{missed} missed**; computed by {version}."]
    heads = ("scene", "quantity", "exact", "computed", "error", "accepted", "rate", "time")
    for section, own in itertools.groupby(lines, lambda line: line.scene.group):
        text += ["", f"## {section}", "", *markdown(heads, "l" * len(heads), map(_row, own))]
    return "\n".join(text) + "\n" + _TAIL


def told(line: Line) -> str:
    """One line for the terminal."""
    found = line.computed if isinstance(line.computed, str) else f"{line.computed:.8g}"
    what = f"{line.scene.name}: {line.check.what}"
    return f"{_verdict(line):6} {what}: {found}, error {line.errors[0]:.1e}"


def _verdict(line: Line) -> str:
    return "ok" if line.accepted else "MISSED"


def _row(line: Line) -> list[str]:
    """A row of the page."""
    check = line.check
    if isinstance(check.exact, str):
        cells = [check.exact, str(line.computed), "", ""]
    else:
        cells = [f"{check.exact:.8g}", f"{line.computed:.8g}"]
        cells += [f"{line.errors[0]:.1e}", f"{check.accept:g}"]
    if not line.accepted:
        cells[3] = f"{cells[3]} **MISSED**".strip()
    rate = "-" if line.rate is None else f"{round(line.rate, 1) + 0.0:.1f}"
    name = f"`{line.scene.name}` ({line.scene.note})"
    return [name, check.what, *cells, rate, f"{line.seconds:.2f}"]
