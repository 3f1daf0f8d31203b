"""Draw docs/images/shapes.svg: an arch of every shape with its thrust line."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

import voussoir
from voussoir.plot.case_joints import JointMarks
from voussoir.plot.case_picture import draw_supports
from voussoir.plot.case_scene import scene_of
from voussoir.plot.figure_style import STONE, house_style
from voussoir.plot.motion import motion_of

#: Title, then keys of each
SHAPES = {
    "segmental": "shape = 'segmental', span = 6, rise = 1.5, thickness = 0.5, voussoirs = 21",
    "pointed": "shape = 'pointed', span = 5, rise = 4, thickness = 0.6, voussoirs = 24",
    "elliptic": "shape = 'elliptic', span = 8, rise = 3, thickness = 0.9, voussoirs = 29",
    "basket": "shape = 'basket', span = 8, rise = 2.6, crown_thickness = 0.7, springing_thickness = 1.1,"
    " voussoirs = 29",
    "parabolic, on unequal springings": "shape = 'parabolic', span = 6, rise = 3, right_rise = 1.5,"
    " thickness = 0.5, voussoirs = 23",
    "catenary": "shape = 'catenary', span = 6, rise = 4, thickness = 0.3, voussoirs = 27",
    "flat": "shape = 'flat', span = 2, thickness = 0.5, voussoirs = 9",
    "two spans of two rings": "radius = 3, half_angle_deg = 70, thickness_ratio = 0.2, voussoirs = 24, rings = 2,"
    " spans = 2, pier_width = 1.5, pier_height = 2, pier_courses = 3",
    "semicircular, on buttresses": "radius = 3, voussoirs = 20, buttress_width = 1.6, buttress_height = 3,"
    " pier_courses = 3",
}


def main() -> None:
    """Draw."""
    with house_style():
        figure, grid = plt.subplots(3, 3, figsize=(6.0, 5.4), layout="constrained")
        for axes, (title, keys) in zip(grid.flat, SHAPES.items()):
            run = voussoir.run(f"&arch {keys} /\n&joint friction_deg = 60 /\n")
            scene = scene_of(run, 1)
            draw_supports(axes, [block.corners for block in scene.supports])
            axes.add_collection(PolyCollection(scene.shapes(0.0), facecolor=STONE, edgecolor="#777777", linewidth=0.6))
            joints = run.joints_of(1)
            marks = JointMarks(scene, joints, motion_of(scene.blocks, scene.supports, 0.0, 0.0), 1.0, 0.5)
            marks.draw_thrust(axes)
            axes.autoscale_view()
            axes.set_aspect("equal")
            axes.set_axis_off()
            axes.set_title(title, fontsize=11)
        figure.savefig(Path(__file__).parents[1] / "images" / "shapes.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
