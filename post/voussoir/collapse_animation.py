"""Collapses as GIF animations."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation, PillowWriter

from voussoir.collapse_picture import draw_frame, limits, set_limits
from voussoir.results import Results

#: Pictures a second, and how many times the last one is shown
_RATE, _REST = 6, 6


def animate(
    run: Results,
    numbers: list[int],
    title: Callable[[dict[str, Any]], str],
    file: Path,
    columns: int = 2,
    width: float = 5.6,
) -> Path:
    """Write the motion of some cases, side by side, as one GIF.

    Parameters
    ----------
    run : Results
        The results of the deck.
    numbers : list of int
        Numbers of the cases; the pictures of shorter motions wait at their end.
    title : callable
        From the row of a case to the words above its picture.
    file : Path
        Where to write.
    columns : int, optional
        Pictures in a row, at most as many as cases.
    width : float, optional
        Of the animation [inch], at 100 dots an inch.

    Returns
    -------
    Path
        The file.
    """
    columns = min(columns, len(numbers))
    frames = [run.frames_of(number) for number in numbers]
    boxes = [limits(run, [number]) for number in numbers]
    shape = max((high[1] - low[1]) / (high[0] - low[0]) for low, high in boxes)
    lines = -(-len(numbers) // columns)
    figure, grid = plt.subplots(
        lines,
        columns,
        figsize=(width, lines * (width / columns * shape + 0.35)),
        layout="constrained",
        squeeze=False,
    )

    def draw(moment: int) -> None:
        for axes, number, pictures, box in zip(grid.flat, numbers, frames, boxes):
            axes.clear()
            draw_frame(axes, run, number, pictures[min(moment, len(pictures) - 1)], size=4.0)
            set_limits(axes, box)
            axes.set_title(title(run.case(number)), fontsize=9)

    length = max(map(len, frames)) + _REST
    FuncAnimation(figure, draw, frames=length).save(file, writer=PillowWriter(fps=_RATE), dpi=100)
    plt.close(figure)
    return file
