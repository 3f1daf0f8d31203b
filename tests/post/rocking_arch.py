"""An arch of rigid voussoirs that rocks without sliding, by steps in time written apart from the program.

Blocks have three unknowns and corners; at each joint two pairs of corners may part but not enter one another, and
the pair that touches does not slide. A step ends with gaps that are closed at its end (Stewart and Trinkle 1996),
impacts without rebound, of the first order in the step.
"""

from __future__ import annotations

import numpy as np

G = 9.81
#: Turn of a voussoir from which no arch comes back [rad]
FALLEN = 0.5


class Arch:
    """Voussoirs between two springings: corners of the joints, centres, masses and moments of inertia."""

    def __init__(self, voussoirs: int, radius: float, ratio: float, half_deg: float) -> None:
        angles = np.radians(np.linspace(-half_deg, half_deg, voussoirs + 1))
        way = np.stack([np.sin(angles), np.cos(angles)], axis=1)
        self.joint = np.stack([(1.0 + sign * ratio / 2.0) * radius * way for sign in (-1, 1)], axis=1)
        self.centre = np.zeros((voussoirs, 2))
        self.metric = np.zeros((voussoirs, 3))
        for b in range(voussoirs):
            corner = np.concatenate([self.joint[b], self.joint[b + 1, ::-1]])
            after = np.roll(corner, -1, axis=0)
            cross = corner[:, 0] * after[:, 1] - corner[:, 1] * after[:, 0]
            area = cross.sum() / 2.0
            self.centre[b] = ((corner + after) * cross[:, None]).sum(0) / (6.0 * area)
            second = ((corner**2 + corner * after + after**2).sum(1) * cross).sum() / 12.0
            self.metric[b] = abs(area), abs(area), abs(second - area * self.centre[b] @ self.centre[b])


def stands(arch: Arch, acceleration: float, duration: float, step: float, end: float = 6.0) -> bool:
    """Whether the arch stands after a rectangular pulse of the ground [m/s2, s, s, s]."""
    n = len(arch.centre)
    place, speed = np.zeros((n, 3)), np.zeros((n, 3))
    closed = np.ones(2 * n + 2, dtype=bool)
    for k in range(round(end / step)):
        share = min(1.0, max(0.0, duration / step - k))
        free = speed + step * np.array([-share * acceleration, -G, 0.0])
        speed = _contact_speeds(arch, place, free.ravel(), closed, step).reshape(n, 3)
        place += step * speed
        turn = np.abs(place[:, 2]).max()
        if turn > FALLEN:
            return False
        if k * step > duration + 0.5 and turn < 1e-3:
            return True
    return True


def _contact_speeds(arch: Arch, place: np.ndarray, free: np.ndarray, closed: np.ndarray, step: float) -> np.ndarray:
    """Speeds that leave no corner inside at the end of a step, by an active set, which the next begins with."""
    rows, gaps, shear, lag = _constraints(arch, place)
    for _ in range(60):
        on = np.flatnonzero(closed)
        hold = np.vstack([rows[on], shear])
        answer = hold / arch.metric.ravel()
        kernel = answer @ hold.T
        # more constraints than unknowns where joints are closed: of all forces the smallest
        kernel[np.diag_indices_from(kernel)] += 1e-10 * np.trace(kernel) / len(kernel)
        force = np.linalg.solve(kernel, -np.concatenate([gaps[on], lag]) / step - hold @ free)
        speed = free + answer.T @ force
        depth = np.where(closed, 0.0, rows @ speed + gaps / step)
        if depth.min() < -1e-9:
            closed[np.argmin(depth)] = True
        elif force[: len(on)].min() < -1e-9:
            closed[on[np.argmin(force[: len(on)])]] = False
        else:
            return speed
    return speed


def _constraints(arch: Arch, place: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rows and gaps of two corners a joint across it, and of the touching one along it."""
    n = len(place)
    rows, gaps = np.zeros((2 * n + 2, n, 3)), np.zeros(2 * n + 2)
    shear, lag = np.zeros((n + 1, n, 3)), np.zeros(n + 1)
    for j in range(n + 1):
        sides = [(b, *_corners(arch, place, b, j)) for b in (j - 1, j)]
        along = sum(corner[1] - corner[0] for _, _, corner in sides)
        along /= np.hypot(*along)
        across = np.array([along[1], -along[0]])
        apart = sides[1][2] - sides[0][2]
        gaps[2 * j : 2 * j + 2] = apart @ across
        touching = int(np.argmin(apart @ across))
        lag[j] = apart[touching] @ along
        for sign, (b, arm, _) in zip((-1, 1), sides):
            if not 0 <= b < n:
                continue
            for k in range(2):
                rows[2 * j + k, b] = sign * np.array([*across, arm[k, 0] * across[1] - arm[k, 1] * across[0]])
            arm_there = arm[touching]
            shear[j, b] = sign * np.array([*along, arm_there[0] * along[1] - arm_there[1] * along[0]])
    return rows.reshape(-1, 3 * n), gaps, shear.reshape(-1, 3 * n), lag


def _corners(arch: Arch, place: np.ndarray, block: int, joint: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a block at a joint, from its centre and where they are; of a springing, where they stay."""
    if not 0 <= block < len(place):
        return arch.joint[joint], arch.joint[joint]
    cosine, sine = np.cos(place[block, 2]), np.sin(place[block, 2])
    arm = (arch.joint[joint] - arch.centre[block]) @ np.array([[cosine, sine], [-sine, cosine]])
    return arm, arm + arch.centre[block] + place[block, :2]
