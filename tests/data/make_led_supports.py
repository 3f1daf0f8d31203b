#!/usr/bin/env python3
"""How far the supports of rigid arches can be led: led_supports.csv beside this file, from scipy alone.

usage: make_led_supports.py > led_supports.csv

At every place of the supports the voussoirs settle where their weight lies lowest: a linear programme of their small
motions, with gaps that may not close beyond nothing and corners in touch that do not slide, in the geometry as it is,
solved again until nothing moves. Where the motion has no bound the arch falls.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import linprog

RADIUS = 10.0
#: How the left and the right support go for each metre that they are led
WAYS = {
    "apart": ((-0.5, 0.0), (0.5, 0.0)),
    "one": ((0.0, 0.0), (1.0, 0.0)),
    "together": ((0.5, 0.0), (-0.5, 0.0)),
    "down": ((0.0, 0.0), (0.0, -1.0)),
    "up": ((0.0, 0.0), (0.0, 1.0)),
    "oblique": ((0.0, 0.0), (0.8, -0.6)),
}
#: Voussoirs, thickness over radius, half angle [deg], way
CASES = (
    (16, 0.15, 90.0, "apart"),
    (12, 0.2, 80.0, "apart"),
    (23, 0.15, 70.0, "apart"),
    (22, 0.19, 89.0, "one"),
    (9, 0.16, 75.0, "one"),
    (15, 0.2, 81.0, "together"),
    (15, 0.18, 71.0, "down"),
    (25, 0.166, 81.0, "down"),
    (15, 0.2, 84.0, "up"),
    (18, 0.16, 86.0, "oblique"),
)


def voussoirs(count: int, ratio: float, half_angle: float) -> np.ndarray:
    """Corners of the voussoirs from left to right: (count, 4, 2), from the lower left one clockwise [m]."""
    angle = np.linspace(-half_angle, half_angle, count + 1)
    inner = RADIUS * (1 - ratio / 2) * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    outer = RADIUS * (1 + ratio / 2) * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    return np.stack([inner[:-1], outer[:-1], outer[1:], inner[1:]], axis=1)


def centre_and_area(corner: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre of gravity and area of a polygon."""
    after = np.roll(corner, -1, axis=0)
    twice = corner[:, 0] * after[:, 1] - after[:, 0] * corner[:, 1]
    centre = ((corner + after) * twice[:, None]).sum(axis=0) / (3 * twice.sum())
    return centre, abs(twice.sum()) / 2


class Arch:
    """Rigid voussoirs between two supports."""

    def __init__(self, count: int, ratio: float, half_angle: float) -> None:
        self.corner = voussoirs(count, ratio, half_angle)
        pairs = [centre_and_area(corner) for corner in self.corner]
        self.centre = np.array([centre for centre, _ in pairs])
        self.area = np.array([area for _, area in pairs])
        self.motion = np.zeros((count, 3))
        self.support = np.array([self.corner[0, :2], self.corner[-1, [3, 2]]])
        self.led = np.zeros((2, 2))

    def place(self, block: int, number: int) -> np.ndarray:
        """Where a corner is."""
        x, y, turn = self.motion[block]
        arm = self.corner[block, number] - self.centre[block]
        turned = [arm[0] * math.cos(turn) - arm[1] * math.sin(turn), arm[0] * math.sin(turn) + arm[1] * math.cos(turn)]
        return self.centre[block] + [x, y] + turned

    def ends(self, joint: int) -> np.ndarray:
        """Lower and upper corner of the left side of a joint, and of the right: (2, 2, 2)."""
        last = len(self.area)
        left = [self.place(joint - 1, k) for k in (3, 2)] if joint > 0 else self.support[0] + self.led[0]
        right = [self.place(joint, k) for k in (0, 1)] if joint < last else self.support[1] + self.led[1]
        return np.array([left, right])

    def row(self, joint: int, direction: np.ndarray, ends: np.ndarray, number: int) -> np.ndarray:
        """What the corners of a joint move apart along a direction, by the motions of all voussoirs."""
        row = np.zeros((len(self.area), 3))
        for block, side, sign in ((joint - 1, 0, -1.0), (joint, 1, 1.0)):
            if 0 <= block < len(self.area):
                arm = ends[side, number] - self.centre[block] - self.motion[block, :2]
                row[block] = sign * np.array([*direction, direction[1] * arm[0] - direction[0] * arm[1]])
        return row.ravel()

    def lower(self, most: float) -> np.ndarray | None:
        """The small motion that lowers the weight most; None if it has no bound."""
        opening, gap, slip, slipped = [], [], [], []
        for joint in range(len(self.area) + 1):
            ends = self.ends(joint)
            along = (ends[:, 1] - ends[:, 0]) / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[:, None]
            tangent = along.sum(axis=0) / np.linalg.norm(along.sum(axis=0))
            normal = np.array([tangent[1], -tangent[0]])
            gaps = (ends[1] - ends[0]) @ normal
            opening += [-self.row(joint, normal, ends, k) for k in (0, 1)]
            gap += list(gaps)
            closed = int(np.argmin(gaps))
            slip.append(self.row(joint, tangent, ends, closed))
            slipped.append(-tangent @ (ends[1, closed] - ends[0, closed]))
        weight = np.zeros((len(self.area), 3))
        weight[:, 1] = self.area / self.area.mean()
        found = linprog(
            weight.ravel(), A_ub=np.array(opening), b_ub=gap, A_eq=np.array(slip), b_eq=slipped,
            bounds=[(-most, most)] * weight.size, method="highs",
            options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
        )  # fmt: skip
        if found.status != 0 or np.abs(found.x).max() > 0.999 * most:
            return None
        return found.x.reshape(-1, 3)

    def settle(self) -> bool:
        """Whether the voussoirs come to rest near where they are."""
        for _ in range(60):
            motion = self.lower(0.5)
            if motion is None:
                return False
            self.motion += motion
            if np.abs(motion).max() < 1e-9:
                return True
        return False


def longest_way(count: int, ratio: float, half_angle: float, way: str) -> float:
    """How far the supports go before the arch falls [m]."""
    arch, led, step = Arch(count, ratio, half_angle), 0.0, 0.02
    while step > 1e-6:
        before = arch.motion.copy()
        arch.led = (led + step) * np.array(WAYS[way])
        if arch.settle():
            led += step
        else:
            arch.motion, step = before, step / 2
    return led


def main() -> None:
    """Print the table."""
    print("voussoirs,thickness_ratio,half_angle_deg,way,led")
    for count, ratio, degrees, way in CASES:
        led = longest_way(count, ratio, math.radians(degrees), way)
        print(f"{count},{ratio},{degrees},{way},{led:.6f}", flush=True)


if __name__ == "__main__":
    main()
