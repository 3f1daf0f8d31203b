"""Maps of critical values over two swept numbers, a panel for each value of a third."""

from __future__ import annotations

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from voussoir.plot.figure_style import SMALL, Picture, type_of
from voussoir.plot.units import axis_label, value_label
from voussoir.results import Table

#: Most panels, and how many of them stand side by side
MOST_PANELS = 6
_ABREAST = 3
#: Fill where a case has no critical value
_NOTHING = "#c9c9c9"


def draw_field(found: Table, column: str, across: str, panels: str | None, searched: str, note: str) -> Figure:
    """Draw critical values as coloured cells, one a case: nothing is computed between them.

    The swept numbers lie along and up; of a third one with more values than there is room for, evenly spaced maps are
    drawn, and it is said. The colours have a label, the maps a note above them.
    """
    kept = np.array([np.nan]) if panels is None else np.unique(found[panels])
    chosen = kept[np.unique(np.linspace(0, len(kept) - 1, min(len(kept), MOST_PANELS)).round().astype(int))]
    abreast = min(len(chosen), _ABREAST)
    rows = -(-len(chosen) // abreast)
    width = 5.2 if abreast == 1 else 2.6 * abreast + 0.8
    figure = Picture(figsize=(width, 3.8 if abreast == 1 else 2.5 * rows + 0.9), layout="constrained")
    grid = figure.subplots(rows, abreast, sharex=True, sharey=True, squeeze=False)
    x, y = np.unique(found[column]), np.unique(found[across])
    critical = found["critical"]
    scale = ScalarMappable(Normalize(float(critical.min()), float(critical.max())), "viridis")
    for number, axes in enumerate(grid.flat):
        if number >= len(chosen):
            axes.remove()
            continue
        mine = found if panels is None else found.take(found[panels] == chosen[number])
        field = np.full((len(y), len(x)), np.nan)
        field[np.searchsorted(y, mine[across]), np.searchsorted(x, mine[column])] = mine["critical"]
        axes.set_facecolor(_NOTHING)
        axes.grid(False)
        axes.pcolormesh(x, y, field, shading="nearest", cmap=scale.cmap, norm=scale.norm, rasterized=True)
        if panels is not None:
            axes.set_title(value_label(panels, float(chosen[number])), fontsize=type_of(1.0))
    figure.supxlabel(axis_label(column), fontsize=type_of(1.1))
    figure.supylabel(axis_label(across), fontsize=type_of(1.1))
    figure.colorbar(scale, ax=grid, label=searched)
    notes = [note] if note else []
    if len(chosen) < len(kept):
        words = axis_label(panels or "").partition(" [")[0]
        notes.insert(0, f"{len(chosen)} of {len(kept)} values of the {words}")
    if notes:
        figure.suptitle("; ".join(notes), fontsize=type_of(SMALL), color="#555555")
    return figure
