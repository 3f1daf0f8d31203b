"""Costs of parts of the scene plan where they are forced in: time, memory, and the answer."""

from __future__ import annotations

import math
import os
import re
import subprocess
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from voussoir.dda_program import find_dda
from voussoir.deck.text import Groups, deck_text
from voussoir.files import write_text
from voussoir_benches.deck_runs import read_rows
from voussoir_benches.report_tables import markdown
from voussoir_benches.scene import BLOCKS, Corners, written_block
from voussoir_benches.work_precision_runs import FRICTION_DEG, Arch

_PEAK = re.compile(r"VmHWM:\s+(\d+) kB")
THICKER = 1.05  #: Thickness over the critical one of the arch that is decided
_BARE = {"joints": False, "blocks": False, "vtu": False}  #: Tables that are left out where nothing else is said
#: What is forced in, and the groups of a deck that do it; None: joints found among polygons
PARTS: tuple[tuple[str, Groups | None], ...] = (
    ("nothing: the plan", {}),
    ("strain: 6 unknowns a block", {"analysis": {"unknowns": 6}}),
    ("decisions with strain: joints.csv", {"output": {"joints": True, "vtu": False}}),
    ("strength that can break", {"joint": {"friction_deg": FRICTION_DEG, "cohesion": 1e-9}}),
    ("pictures: vtu", {"output": {**_BARE, "vtu": True}}),
    ("condition", {"output": {**_BARE, "condition": True}}),
    ("joints searched among polygons", None),
    ("blocks that move, contacts that follow", {"analysis": {"geometry": "current"}}),
)
MOST_MOVING = 100  #: Blocks that move are left out beyond this number of voussoirs: they take minutes


@dataclass(frozen=True)
class Cost:
    """Costs of one part."""

    voussoirs: int  #: Their number
    part: str  #: What was forced in
    search: bool  #: Whether a critical thickness was searched, not one thickness decided
    seconds: float  #: Least time
    megabytes: float  #: Largest memory of the process
    answer: str  #: Critical thickness ratio, or the verdict


def plan_costs(counts: Sequence[int], folder: Path, repeats: int) -> Iterator[Cost]:
    """Run a semicircle with every part forced in: a cost a number, part and kind of run."""
    folder.mkdir(parents=True, exist_ok=True)
    for count in counts:
        arch = Arch(90.0, count)
        ratio = THICKER * arch.exact()
        write_text(folder / BLOCKS, _polygons(arch, ratio))
        for part, groups in PARTS:
            if "move" in part and count > MOST_MOVING:
                continue
            for search in (False, True):
                if groups is None and search:
                    continue
                yield _cost(arch, part, groups, ratio, search, folder, repeats)


def _cost(arch: Arch, part: str, more: Groups | None, ratio: float, search: bool, folder: Path, repeats: int) -> Cost:
    """Time, memory and answer of one deck."""
    groups: dict[str, Any] = {"arch": {"half_angle_deg": 90.0, "voussoirs": arch.voussoirs}}
    if more is None:
        groups = {"scene": {"kind": "blocks", "geometry": BLOCKS}}
    elif search:
        groups["search"] = {"parameter": "thickness_ratio"}
    else:
        groups["arch"]["thickness_ratio"] = ratio
    deck = deck_text({**groups, "joint": {"friction_deg": FRICTION_DEG}, "output": _BARE, **(more or {})})
    write_text(folder / "plan.nml", deck)
    seconds, megabytes = [], []
    for _ in range(repeats):
        megabytes.append(_run(folder))
        (row,) = read_rows(folder / "out" / "results.csv")
        seconds.append(float(row["seconds"]))
    answer = row["critical"] if row["verdict"] == "found" else row["verdict"]
    return Cost(arch.voussoirs, part, search, min(seconds), max(megabytes), answer)


def _run(folder: Path) -> float:
    """Run the deck; the largest memory of the process [MB], as last seen before its end."""
    words = [str(find_dda()), "run", "plan.nml", "--quiet", "--out", "out"]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    process = subprocess.Popen(words, cwd=folder, env=environment)
    status = Path(f"/proc/{process.pid}/status")
    largest = 0.0
    while process.poll() is None:
        try:
            seen = _PEAK.search(status.read_text(encoding="ascii"))
        except OSError:
            break
        largest = float(seen[1]) / 1024.0 if seen else largest
        time.sleep(1e-4)
    process.wait()
    return largest


def _polygons(arch: Arch, ratio: float) -> str:
    """The arch as a file of blocks, between two held ones."""
    inner, outer = 10.0 * (1.0 - ratio / 2.0), 10.0 * (1.0 + ratio / 2.0)

    def corners(angle: float) -> tuple[tuple[float, float], tuple[float, float]]:
        s, c = math.sin(angle), math.cos(angle)
        return (inner * s, inner * c), (outer * s, outer * c)

    step = math.pi / arch.voussoirs
    text = ""
    for i in range(arch.voussoirs):
        left, right = (corners(-math.pi / 2.0 + (i + k) * step) for k in (0, 1))
        text += written_block([left[0], right[0], right[1], left[1]])
    for sign in (-1.0, 1.0):
        ends: Corners = [(sign * x, y) for x in (8.0, 12.0) for y in (0.0, -1.0)]
        text += written_block([ends[0], ends[1], ends[3], ends[2]], "fixed")
    return text


def cost_table(costs: Sequence[Cost]) -> list[str]:
    """Markdown lines: what each part costs over the plan."""
    found = {(cost.voussoirs, cost.part, cost.search): cost for cost in costs}
    heads = ("voussoirs", "forced in", "decision ms", "times", "MB", "search ms", "times", "MB", "answer")
    rows = []
    for count in dict.fromkeys(cost.voussoirs for cost in costs):
        for part, _ in PARTS:
            cells = []
            for search in (False, True):
                cells += _cells(found.get((count, part, search)), found.get((count, PARTS[0][0], search)))
            if set(cells) != {"-"}:
                rows.append([str(count), part, *cells, _difference(found, count, part)])
    return markdown(heads, "rlrrrrrrl", rows)


def _cells(cost: Cost | None, plan: Cost | None) -> list[str]:
    """Time, times that of the plan, memory."""
    if cost is None or plan is None:
        return ["-"] * 3
    return [f"{cost.seconds * 1e3:.3g}", f"{cost.seconds / plan.seconds:.2f}", f"{cost.megabytes:.1f}"]


def _difference(found: dict[tuple[int, str, bool], Cost], count: int, part: str) -> str:
    """Difference of the answer from that of the plan."""
    plan = PARTS[0][0]
    one, other = found.get((count, part, True)), found.get((count, plan, True))
    if one is None or other is None:
        return found[count, part, False].answer
    try:
        return f"{abs(float(one.answer) / float(other.answer) - 1.0):.0e}"
    except ValueError:
        return one.answer
