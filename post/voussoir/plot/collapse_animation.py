"""Motions as animations: GIF, MP4, or numbered PNG files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.figure import Figure

from voussoir.files import fresh
from voussoir.plot.collapse_picture import draw_frame, limits, pictures_of, set_limits
from voussoir.results import Results

#: Pictures a second, and how many times the last one is shown
_RATE, _REST = 6, 6
#: Endings of animations
ENDINGS = (".gif", ".mp4", ".png")


class WriterError(ValueError):
    """An animation of this kind cannot be written here: why, and what to do."""


def check_ending(file: Path) -> None:
    """Check that an animation of this name can be written; WriterError if its ending or program is missing."""
    ending = file.suffix.lower()
    if ending not in ENDINGS:
        raise WriterError(f"expected a file .gif, .mp4 or .png, got '{file.name}'; change its ending")
    if ending == ".mp4" and not FFMpegWriter.isAvailable():
        raise WriterError("expected the program ffmpeg for .mp4, got none; install it, or choose .gif or .png")


def animate(
    run: Results, numbers: list[int], title: Callable[[dict[str, Any]], str], file: Path, columns: int = 2,
    width: float = 5.6, magnify: float = 1.0
) -> Path:
    """Write the motion of some cases, side by side: .gif, .mp4, or .png for a file a picture; gives the first file.

    `title` gives the words above a picture from the row of its case. Pictures of shorter motions wait at their end. The
    width is in inches, at 100 dots each. WriterError if such a file cannot be written here.
    """
    check_ending(file)
    columns = min(columns, len(numbers))
    frames = [pictures_of(run, number) for number in numbers]
    boxes = [limits(run, [number], magnify) for number in numbers]
    shape = max((high[1] - low[1]) / (high[0] - low[0]) for low, high in boxes)
    timed = any(run.case(number)["mode"] == "dynamic" for number in numbers)
    words = captions(run, numbers, title, magnify)
    room = 0.2 * (1 + max(text.count("\n") for text in words) + timed) + 0.15
    lines = -(-len(numbers) // columns)
    figure, grid = plt.subplots(
        lines, columns, figsize=(width, lines * (width / columns * shape + room)), layout="constrained", squeeze=False)
    for axes in grid.flat[len(numbers):]:
        axes.set_axis_off()

    def draw(moment: int) -> None:
        for axes, number, pictures, box, text in zip(grid.flat, numbers, frames, boxes, words):
            frame = pictures[min(moment, len(pictures) - 1)]
            axes.clear()
            draw_frame(axes, run, number, frame, size=4.0, magnify=magnify)
            set_limits(axes, box)
            clock = f"\nt = {frame.time:.3f} s" if timed else ""
            axes.set_title(text + clock, fontsize=9)

    written = write(figure, draw, max(map(len, frames)), file)
    plt.close(figure)
    return written


def captions(run: Results, numbers: list[int], title: Callable[[dict[str, Any]], str], magnify: float) -> list[str]:
    """What stands above the pictures: the title of each case, and what its pictures are."""
    words = []
    for number in numbers:
        text = title(run.case(number))
        if len(run.frames_of(number)) < 2:
            text += "\nthe collapse mechanism, at a size of its own"
        elif run.kind != "arch" and magnify == 1.0:
            text += "\ncontacts: crosses slide, dots stick"
        words.append(text)
    return words


def write(figure: Figure, draw: Callable[[int], None], length: int, file: Path) -> Path:
    """Write the pictures of a figure that is drawn anew for each of them; gives the first file."""
    if file.suffix.lower() != ".png":
        writer = (FFMpegWriter if file.suffix.lower() == ".mp4" else PillowWriter)(fps=_RATE)
        with writer.saving(figure, str(fresh(file)), 100):
            for _ in _drawn(figure, draw, length):
                writer.grab_frame()
            for _ in range(_REST):
                writer.grab_frame()
        return file
    names = [file.with_name(f"{file.stem}_{moment + 1:03d}.png") for moment in range(length)]
    for moment in _drawn(figure, draw, length):
        figure.savefig(fresh(names[moment]), dpi=100, metadata={"Software": None})
    return names[0]


def _drawn(figure: Figure, draw: Callable[[int], None], length: int) -> Iterator[int]:
    """Draw one picture after the other; all have the layout of the first."""
    for moment in range(length):
        draw(moment)
        yield moment
        figure.set_layout_engine("none")
