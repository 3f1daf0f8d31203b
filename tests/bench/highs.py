"""Limits of joint graphs by the linear programmes of HiGHS, for comparison (needs SciPy)."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TextIO

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csc_matrix, hstack

CONTACT, NO_SLIP, CORNER, CORNER_NO_SLIP, PIN, MIRROR = range(1, 7)


@dataclass
class Graph:
    """A joint graph as Assembly.text writes it."""

    name: str
    dead: np.ndarray
    live: np.ndarray
    blocks: np.ndarray
    kinds: np.ndarray
    friction: np.ndarray
    lengths: np.ndarray
    rows: np.ndarray


def read_graphs(stream: TextIO) -> Iterator[Graph]:
    """All graphs of a stream."""
    while header := stream.readline().split():
        n_block, n_joint = int(header[0]), int(header[1])
        loads = np.array([stream.readline().split() for _ in range(n_block)], dtype=float)
        joints = np.array([stream.readline().split() for _ in range(n_joint)], dtype=float)
        yield Graph(header[2], loads[:, :3], loads[:, 3:], joints[:, :2].astype(int), joints[:, 2].astype(int),
                    joints[:, 3], joints[:, 4], joints[:, 5:].reshape(-1, 2, 3, 3))


def rays(kind: int, friction: float) -> list[tuple[list[float], bool]]:
    """Rays of a joint, and whether each may be negative."""
    first, second, shear = [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]
    if kind in (CONTACT, CORNER):
        normals = [first, second] if kind == CONTACT else [first]
        return [([*n[:2], sign * friction], False) for n in normals for sign in ((1.0, -1.0) if friction else (0.0,))]
    return {NO_SLIP: [(first, False), (second, False), (shear, True)], CORNER_NO_SLIP: [(first, False), (shear, True)],
            PIN: [(first, True), (shear, True)], MIRROR: [(first, True), (second, True)]}[kind]


def columns(graph: Graph) -> tuple[csc_matrix, list[tuple[float | None, float | None]]]:
    """What a unit of each ray does to the blocks, and the bounds of its factor."""
    length = 0.5 * graph.lengths.mean()
    row, column, value, bounds = [], [], [], []
    for blocks, kind, friction, sides in zip(graph.blocks, graph.kinds, graph.friction, graph.rows):
        for force, free in rays(kind, friction):
            for block, side in zip(blocks, sides):
                if block:
                    row += [3 * block - 3, 3 * block - 2, 3 * block - 1]
                    column += [len(bounds)] * 3
                    value += list(np.array(force) @ side / [1.0, 1.0, length])
            bounds.append((None if free else 0.0, None))
    return csc_matrix((value, (row, column)), shape=(3 * len(graph.dead), len(bounds))), bounds


def solve(graph: Graph, dead: np.ndarray, live: np.ndarray, method: str = "highs-ds") -> tuple[str, float, float]:
    """State, largest factor and seconds of HiGHS on dead + factor*live."""
    matrix, bounds = columns(graph)
    scale = [1.0, 1.0, 0.5 * graph.lengths.mean()]
    unit = max(np.abs(dead).mean(), np.abs(live).mean(), 1e-300)
    matrix = hstack([matrix, csc_matrix((live / scale).reshape(-1, 1) / unit)]).tocsc()
    cost = np.zeros(matrix.shape[1])
    cost[-1] = -1.0
    accuracy = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    if method == "highs-ipm":
        accuracy["ipm_optimality_tolerance"] = 1e-12
    start = time.perf_counter()
    found = linprog(cost, A_eq=matrix, b_eq=-(dead / scale).ravel() / unit, bounds=[*bounds, (0.0, None)],
                    method=method, options=accuracy)
    seconds = time.perf_counter() - start
    state = {0: "found", 2: "infeasible", 3: "unbounded"}.get(found.status, found.message)
    return state, -found.fun if found.status == 0 else float("nan"), seconds


def judge(graph: Graph) -> tuple[str, float]:
    """State of a limit, and its factor, where the dead load is decided first."""
    if not carries(graph, graph.dead):
        return "no dead equilibrium", float("nan")
    state, factor, _ = solve(graph, graph.dead, graph.live)
    return state, factor


def carries(graph: Graph, load: np.ndarray) -> bool:
    """Whether a load is carried."""
    return solve(graph, load, np.zeros_like(load))[0] in ("found", "unbounded")
