"""Random bridges of all keys: their worst position beside fixed ones in both directions of travel.

`python3 random_bridges.py --dda build/bin/dda --count 200 --seed 1` computes the load factor at the worst position of
each bridge and at 61 fixed positions in both directions. Status 1 if a fixed position contradicts the worst one.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

POSITIONS = 61  #: Fixed positions of each direction
MOST_SECONDS = 120  #: Processor time that the program may take for a deck [s]
SMALLER = 1e-6  #: Share of the reported factor by which that of a fixed position may be smaller
SHAPES = ("segmental", "segmental", "circular", "circular", "pointed", "elliptic", "basket", "parabolic", "catenary",
          "flat")


@dataclass(frozen=True)
class Bridge:
    """A bridge, its vehicle and the friction rule."""

    groups: str
    axles: list[float]
    spacings: list[float]
    length: float
    flow: str

    def deck(self, vehicle: str, more: str = "", backward: bool = False) -> str:
        """A deck with its vehicle as it drives forward or backward."""
        step = -1 if backward else 1
        spacings = f"spacings = {listed(self.spacings[::step])}, " if self.spacings else ""
        return (f"{self.groups}&vehicle axles = {listed(self.axles[::step])}, {spacings}length = {self.length!r}, "
                f"{vehicle} /\n&search parameter = 'load_factor' /\n&analysis flow = '{self.flow}' /\n{more}")


def listed(values: list[float]) -> str:
    """Numbers as a namelist has them."""
    return ", ".join(map(repr, values))


def rounded(value: float) -> float:
    """A number of four digits, as users write them."""
    return float(f"{value:.4g}")


def group(name: str, keys: dict[str, object]) -> str:
    """A group of a deck."""
    texts = (f"{key} = {value!r}" if not isinstance(value, list) else f"{key} = {listed(value)}"
             for key, value in keys.items())
    return f"&{name} {', '.join(texts)} /\n"


def random_arch(pick: random.Random, span: float) -> dict[str, object]:
    """Keys of &arch."""
    shape = pick.choice(SHAPES)
    keys: dict[str, object] = {"shape": shape, "span": span, "voussoirs": pick.randint(5, 36)}
    if shape == "flat":
        keys["half_angle_deg"] = rounded(pick.uniform(10.0, 40.0))
        keys["thickness"] = rounded(span * pick.uniform(0.1, 0.25))
    else:
        low, high = {"pointed": (0.51, 0.9), "segmental": (0.1, 0.5), "circular": (0.2, 0.72)}.get(shape, (0.15, 0.6))
        keys["rise"] = rounded(span * pick.uniform(low, high))
        keys["thickness"] = rounded(span * pick.uniform(0.035, 0.11))
        if pick.random() < 0.15:
            keys["right_rise"] = rounded(keys["rise"] * pick.uniform(0.8, 1.3))
    if shape in ("elliptic", "parabolic", "catenary", "flat", "segmental", "circular") and pick.random() < 0.2:
        keys["joint_direction"] = "radial"
    if pick.random() < 0.15:
        keys["crown_thickness"] = keys.pop("thickness")
        keys["springing_thickness"] = rounded(keys["crown_thickness"] * pick.uniform(1.0, 1.8))
    if pick.random() < 0.25:
        keys["rings"] = pick.choice((2, 2, 3))
        keys["voussoirs"] = min(keys["voussoirs"], 20)
    if pick.random() < 0.25:
        keys["spans"] = pick.choice((2, 2, 3))
        keys["voussoirs"] = min(keys["voussoirs"], 18)
        keys["pier_width"] = rounded(span * pick.uniform(0.1, 0.3))
        keys["pier_height"] = rounded(span * pick.uniform(0.1, 0.6))
    if pick.random() < 0.15:
        keys["buttress_width"] = rounded(span * pick.uniform(0.15, 0.4))
        keys["buttress_height"] = rounded(span * pick.uniform(0.1, 0.7))
    if pick.random() < 0.15:
        keys["springing"] = "no-slip"
    return keys


def random_fill(pick: random.Random, span: float) -> dict[str, object]:
    """Keys of &fill."""
    keys: dict[str, object] = {"height": rounded(span * pick.uniform(0.01, 0.15)),
                               "unit_weight": rounded(pick.uniform(14e3, 22e3))}
    kind = pick.random()
    if kind < 0.5:
        keys["passive_coefficient"] = rounded(pick.uniform(0.2, 3.0))
    elif kind < 0.7:
        keys["friction_deg"] = rounded(pick.uniform(25.0, 40.0))
        keys["passive_share"] = rounded(pick.uniform(0.1, 1.0))
    if pick.random() < 0.3:
        keys["spread"] = pick.choice((0.0, 0.25, 1.0))
    if pick.random() < 0.15:
        keys["backing_height"] = rounded(span * pick.uniform(0.03, 0.3))
    return keys


def random_bridge(seed: int | str) -> Bridge:
    """The bridge of a seed."""
    pick = random.Random(f"bridge {seed}")
    span = rounded(math.exp(pick.uniform(math.log(2.0), math.log(20.0))))
    groups = group("arch", random_arch(pick, span))
    if pick.random() < 0.75:
        groups += group("joint", {"friction_deg": rounded(pick.uniform(18.0, 65.0))})
    if pick.random() < 0.75:
        groups += group("fill", random_fill(pick, span))
    material: dict[str, object] = {}
    if pick.random() < 0.5:
        material["unit_weight"] = rounded(pick.uniform(16e3, 27e3))
    if pick.random() < 0.25:
        material["compressive_strength"] = rounded(10.0 ** pick.uniform(5.5, 7.5))
    if material:
        groups += group("material", material)
    if pick.random() < 0.15:
        groups += group("load", {"horizontal_coefficient": rounded(pick.uniform(-0.1, 0.1))})
    axles = [rounded(pick.uniform(5e3, 120e3)) for _ in range(pick.choice((1, 1, 2, 2, 3, 4, 5)))]
    spacings = [rounded(span * pick.uniform(0.05, 0.6)) for _ in axles[1:]]
    length = pick.choice((0.0, 0.3, 0.3, rounded(span * pick.uniform(0.01, 0.1))))
    return Bridge(groups, axles, spacings, length, pick.choice(("coulomb", "associated")))


def random_study(seed: int | str) -> str:
    """A deck of a seed: a decision, a search of any kind or a sweep of a bridge of all keys, its vehicle in place."""
    pick = random.Random(f"study {seed}")
    bridge = random_bridge(f"study {seed}")
    span = float(bridge.groups.split("span = ")[1].split(",")[0])
    vehicle = pick.choice(("worst = .true.", f"position = {rounded(span * pick.uniform(-0.45, 0.3))}"))
    deck = bridge.deck(vehicle)
    if pick.random() < 0.2:
        # axles as point loads of a group of their own are no vehicle's
        deck = re.sub("&vehicle.*\n", "", deck)
    search = "&search parameter = 'load_factor' /\n"
    kind = pick.random()
    if kind < 0.6 and "worst" not in deck or "&vehicle" not in deck:
        deck = deck.replace(search, pick.choice((
            f"&load load_factor = {rounded(10.0 ** pick.uniform(-2.0, 1.5))} /\n",
            "&search parameter = 'horizontal_coefficient' /\n",
            "&search parameter = 'friction_deg', low = 5, high = 80 /\n",
            f"&search parameter = 'thickness', low = {rounded(0.01 * span)}, high = {rounded(0.4 * span)} /\n",
            "&search parameter = 'gravity_direction_deg', low = -90, high = -50 /\n",
        )))
        if deck.count("&load ") > 1 or "horizontal_coefficient' /" in deck:
            deck = re.sub(r"&load horizontal_coefficient.*\n", "", deck)
        if "'thickness'" in deck:
            deck = re.sub("&vehicle.*\n", "", deck)
    if pick.random() < 0.25:
        deck += "&sweep parameter = 'joint%friction_deg', values = 25, 45, 90 /\n"
    return deck


def limit_time() -> None:
    """Let the process end after its processor time."""
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS + 1))


def run(dda: str, folder: Path, name: str, deck: str) -> list[dict[str, str]]:
    """Rows of the results of a deck; none if it is refused."""
    (folder / f"{name}.nml").write_text(deck)
    done = subprocess.run([dda, "run", f"{name}.nml", "--quiet"], cwd=folder, capture_output=True, text=True,
                          preexec_fn=limit_time)
    if done.returncode == 2:
        return []
    if done.returncode == -signal.SIGXCPU:
        raise TimeoutError(f"more than {MOST_SECONDS} s of processor time")
    if done.returncode not in (0, 3):
        raise RuntimeError(f"status {done.returncode} of\n{deck}{done.stderr}")
    with (folder / name / "results.csv").open(newline="") as lines:
        return list(csv.DictReader(lines))


def reach_of(folder: Path) -> tuple[float, float]:
    """Where the blocks that move begin and end along x."""
    with (folder / "blocks.csv").open(newline="") as lines:
        x = [float(row["x"]) for row in csv.DictReader(lines) if row["state"] != "fixed"]
    return min(x), max(x)


def places_of(bridge: Bridge, low: float, high: float, backward: bool) -> list[float]:
    """Fixed positions at which an axle stands above a block that moves."""
    offsets = [0.0]
    for spacing in bridge.spacings[::-1] if backward else bridge.spacings:
        offsets.append(offsets[-1] + spacing)
    first, last = low - offsets[-1], high
    places = [first + (last - first) * (k + 0.5) / POSITIONS for k in range(POSITIONS)]
    return [place for place in places if any(low < place + offset < high for offset in offsets)]


def fixed_rows(dda: str, folder: Path, bridge: Bridge, places: list[float], backward: bool) -> list[dict[str, str]]:
    """Rows of fixed positions; those at which the ground carries all axles are refused, and left out."""
    while places:
        sweep = f"&sweep parameter = 'position', values = {listed(places)} /\n"
        name = f"fixed{int(backward)}"
        (folder / f"{name}.nml").write_text(bridge.deck("position = 0", sweep, backward))
        done = subprocess.run([dda, "check", f"{name}.nml"], cwd=folder, capture_output=True, text=True)
        refused = re.search(r"got none at position (\S+);", done.stderr)
        if refused is None:
            return run(dda, folder, name, bridge.deck("position = 0", sweep, backward))
        # the message rounds the position
        places.remove(min(places, key=lambda place: abs(place - float(refused[1]))))
    return []


def contradiction(worst: dict[str, str], fixed: dict[str, str]) -> str:
    """What a fixed position says against the worst one; empty if nothing."""
    told = {"found": worst["critical"], "stable": "inf", "collapsed": "0"}.get(worst["verdict"])
    if told is None or fixed["verdict"] in ("undecided", "stable"):
        return ""
    least = float(fixed["critical"]) if fixed["collapses_at"] == "high" else 0.0
    if least < float(told) * (1.0 - SMALLER):
        return f"{fixed['verdict']} {fixed['critical']} at {fixed['position']}, worst is {worst['verdict']} {told}"
    return ""


def check(dda: str, folder: Path, bridge: Bridge) -> tuple[str, list[str]]:
    """Verdict at the worst position, empty if the bridge is refused, and what contradicts it."""
    rows = run(dda, folder, "worst", bridge.deck("worst = .true."))
    if not rows:
        return "", []
    (worst,) = rows
    faults = []
    low, high = reach_of(folder / "worst")
    for backward in (False, True):
        places = places_of(bridge, low, high, backward)
        here = worst.get("worst_position") and worst.get("worst_direction") == ("backward" if backward else "forward")
        if here:
            places.append(float(worst["worst_position"]))
        fixed = fixed_rows(dda, folder, bridge, places, backward)
        if not fixed:
            raise RuntimeError(f"no rows of fixed positions of\n{bridge.deck('position = 0')}")
        way = "backward" if backward else "forward"
        faults += [f"{way}: {text}" for text in (contradiction(worst, row) for row in fixed) if text]
        if here and worst["verdict"] == "found" and not (
                fixed[-1]["verdict"] == "found"
                and abs(float(fixed[-1]["critical"]) / float(worst["critical"]) - 1.0) <= SMALLER):
            faults.append(f"{way}: {fixed[-1]['verdict']} {fixed[-1]['critical']} at the worst position itself, "
                          f"which has {worst['critical']}")
    return worst["verdict"], faults


def check_seed(dda: str, folder: Path, seed: int) -> tuple[str, list[str]]:
    """Verdict of a random bridge at its worst position, and its faults with its deck."""
    bridge = random_bridge(seed)
    try:
        verdict, faults = check(dda, folder, bridge)
    except TimeoutError as problem:
        verdict, faults = "slow", [str(problem)]
    return verdict, [f"{len(faults)} contradictions: {faults[0]}\n{bridge.deck('worst = .true.')}"] if faults else []


def campaign(description: str | None, count: int, judge: Callable[[str, Path, int], tuple[str, list[str]]]) -> int:
    """Judge the bridges of a command line, and print their faults; 1 if there are any."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--dda", required=True, type=os.path.abspath)
    parser.add_argument("--count", type=int, default=count)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    verdicts: dict[str, int] = {}
    wrong = 0
    for seed in range(arguments.seed, arguments.seed + arguments.count):
        with tempfile.TemporaryDirectory() as folder:
            verdict, faults = judge(arguments.dda, Path(folder), seed)
        verdicts[verdict or "refused"] = verdicts.get(verdict or "refused", 0) + 1
        if faults:
            wrong += 1
            print(f"seed {seed}: {'; '.join(faults)}", flush=True)
    print(f"{wrong} of {arguments.count} bridges have faults; verdicts: {verdicts}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(campaign(__doc__, 200, check_seed))
