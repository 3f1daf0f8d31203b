"""An arch of rigid voussoirs that rocks without sliding, by steps in time written apart from the program.

Blocks have three unknowns and corners; at each joint two pairs of corners may part but not enter one another, and
the pair that touches does not slide. A step ends with gaps that are closed at its end (Stewart and Trinkle 1996),
impacts without rebound, of the first order in the step.
"""

from __future__ import annotations

import numpy as np

G = 9.81
FALLEN = 0.5  #: Turn of a voussoir from which no arch comes back [rad]


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
    block, joint = np.arange(n), np.arange(n + 1)
    cosine, sine = np.cos(place[:, 2]), np.sin(place[:, 2])
    turn = np.array([[cosine, sine], [-sine, cosine]]).transpose(2, 0, 1)
    # arms from a block's centre to its corners at the joint before it and behind it; springings stay
    arms = [(arch.joint[b:n + b] - arch.centre[:, None]) @ turn for b in (0, 1)]
    sides = [arch.joint.copy(), arch.joint.copy()]
    for b, arm, side in zip((0, 1), arms, sides):
        side[b:n + b] = arm + (arch.centre + place[:, :2])[:, None]
    along = sum(side[:, 1] - side[:, 0] for side in sides)
    along /= np.hypot(*along.T)[:, None]
    across = np.stack([along[:, 1], -along[:, 0]], axis=1)
    apart = sides[0] - sides[1]
    gaps = np.einsum("jkx,jx->jk", apart, across)
    touching = gaps.argmin(axis=1)
    lag = np.einsum("jx,jx->j", apart[joint, touching], along)
    rows, shear = np.zeros((n + 1, 2, n, 3)), np.zeros((n + 1, n, 3))
    for b, sign, arm in zip((0, 1), (1, -1), arms):
        there, way = across[b:n + b], along[b:n + b]
        rows[block + b, :, block, :2] = sign * there[:, None]
        rows[block + b, :, block, 2] = sign * _moment(arm, there[:, None])
        shear[block + b, block, :2] = sign * way
        shear[block + b, block, 2] = sign * _moment(arm[block, touching[b:n + b]], way)
    return rows.reshape(-1, 3 * n), gaps.ravel(), shear.reshape(-1, 3 * n), lag


def _moment(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Moments of forces."""
    return arm[..., 0] * force[..., 1] - arm[..., 1] * force[..., 0]
