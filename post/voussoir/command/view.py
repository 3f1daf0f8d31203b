"""`voussoir view`: blocks in a window that turns, with a slider for frames and a picker for blocks."""

from __future__ import annotations

import argparse
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from voussoir import results
from voussoir.extras import load
from voussoir.files import fresh
from voussoir.results import Frame, Results

#: Depth that the blocks are drawn with, over the size of the scene
DEPTH = 0.08
#: Colours of blocks that can move, of supports, and of the block that is picked
STONE, SUPPORT, PICKED = "#e4dccb", "#9a9a9a", "#d1632a"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Opens a window (pyvista) with the blocks of a case. The mouse turns it, the slider selects a frame or a "
        "stage of the mechanism, and the right button picks a block and shows its number and displacement."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results")
    parser.add_argument("--case", metavar="N", type=int, default=1, help="number of the case")
    parser.add_argument(
        "--out", metavar="FILE", type=Path, help="write the last frame as a .png instead (default: open the window)")


def run(arguments: argparse.Namespace) -> int:
    """Show."""
    read = results.read(arguments.folder)
    read.case(arguments.case)
    pictures = pictures_of_case(read, arguments.case)
    show(load("pyvista", "a window that turns"), read, arguments.case, pictures, arguments.out)
    return 0


def pictures_of_case(read: Results, number: int) -> list[Frame]:
    """What is shown: the pictures of the motion, or the blocks as they stand."""
    from voussoir.plot.collapse_picture import pictures_of

    blocks = read.blocks_of(number)
    return pictures_of(read, number) or [Frame(0, 0, 0.0, [block.corners for block in blocks], results.Table({}))]


def block_at(shapes: list[np.ndarray], point: np.ndarray) -> int:
    """The number of the block that a point of the plane lies in, or else is nearest to."""
    from voussoir.polygon import distance

    return 1 + int(np.argmin([distance(corners, point) for corners in shapes]))


def words_of(read: Results, number: int, pictures: list[Frame], frame: Frame, block: int) -> str:
    """Text about a picked block."""
    picked = read.blocks_of(number)[block - 1]
    way = frame.blocks[block - 1] - pictures[0].blocks[block - 1]
    if picked.state == "fixed":
        return f"block {block}: does not move"
    return f"block {block}: a corner is {np.hypot(*way.T).max():.4g} m from its initial position"


def show(window: ModuleType, read: Results, number: int, pictures: list[Frame], file: Path | None) -> None:
    """Open the window, or write its last picture to a file."""
    from voussoir.plot.case_title import title_of

    blocks = read.blocks_of(number)
    depth = DEPTH * float(np.ptp(np.vstack(pictures[0].blocks), axis=0).max())
    plotter: Any = window.Plotter(off_screen=file is not None, window_size=(1200, 800))
    shown: dict[str, Any] = {"frame": pictures[-1], "block": 0}

    def draw() -> None:
        frame: Frame = shown["frame"]
        parts: dict[str, list[Any]] = {}
        for block, corners in zip(blocks, frame.blocks):
            colour = PICKED if block.number == shown["block"] else SUPPORT if block.state == "fixed" else STONE
            parts.setdefault(colour, []).append(prism(window, corners, depth))
        for colour in (STONE, SUPPORT, PICKED):
            plotter.remove_actor(colour, render=False)
            plotter.remove_actor(colour + "edges", render=False)
            if colour in parts:
                solids = window.merge([solid for solid, _ in parts[colour]])
                plotter.add_mesh(solids, color=colour, name=colour, reset_camera=False)
                edges = window.merge([edge for _, edge in parts[colour]])
                plotter.add_mesh(edges, color="black", name=colour + "edges", pickable=False, reset_camera=False)

    def go(value: float) -> None:
        shown["frame"] = pictures[round(value)]
        draw()

    def pick(point: np.ndarray) -> None:
        shown["block"] = block_at(shown["frame"].blocks, np.asarray(point)[:2])
        draw()
        words = words_of(read, number, pictures, shown["frame"], shown["block"])
        plotter.add_text(words, position="lower_left", font_size=12, name="picked")

    draw()
    plotter.add_text(title_of(read.case(number), read), position="upper_left", font_size=12, name="title")
    plotter.view_xy()
    if file is not None:
        file.parent.mkdir(parents=True, exist_ok=True)
        plotter.screenshot(str(fresh(file)))
        plotter.close()
        print(file)
        return
    plotter.enable_surface_point_picking(callback=pick, show_message=False, show_point=False)
    if len(pictures) > 1:
        plotter.add_slider_widget(go, (0, len(pictures) - 1), len(pictures) - 1, title="picture", fmt="%.0f")
    plotter.show()


def prism(window: ModuleType, corners: np.ndarray, depth: float) -> tuple[Any, Any]:
    """A block with a depth, and the edges of its two faces."""
    count = len(corners)
    points = np.column_stack([corners, np.zeros(count)])
    face = window.PolyData(points, faces=[count, *range(count)])
    ring = [count + 1, *range(count), 0]
    behind = [count + 1, *(count + place for place in ring[1:])]
    edges = window.PolyData(np.vstack([points, points + [0, 0, depth]]), lines=[*ring, *behind])
    return face.triangulate().extrude((0.0, 0.0, depth), capping=True), edges
