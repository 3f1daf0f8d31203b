"""What steps cost where many blocks crowd: a pile of 500 dropped bricks, and a jointed slope of 291 blocks.

    python tests/bench/crowding.py build/bin/dda [another dda]

Several binaries take turns, each from the states that the first one has made; the least time of each counts.
"""

from __future__ import annotations

import argparse
import csv
import math
import pathlib
import resource
import subprocess
import tempfile

from jointed_slope import geometry

TIMES = (0.9, 1.0, 1.1, 1.2, 1.3)  #: Times at which the bricks crowd, each the beginning of a part that is timed [s]
PART = 0.02  #: Length of such a part [s]

PILE = """&scene kind='blocks', geometry='pile.blocks' /
&joint friction_deg={friction:.13f} /
&analysis mode='dynamic', geometry='current', unknowns=3, time_step=0.002, duration={end}, steps=1000000{restart} /
&output vtu=.false., joints=.false., restart=.true. /
"""
SLOPE = """&scene kind='lines', geometry='slope.geo' /
&joint friction_deg=30 /
&analysis mode='dynamic', geometry='current', time_step=0.005, duration=0.3, steps=1000000 /
&output vtu=.false., joints=.false. /
"""


def pile(columns: int, rows: int, seed: int = 20080301) -> str:
    """Bricks in the air, turned at random, above a floor between two walls; those of the tests."""
    state = seed

    def draw() -> float:
        nonlocal state
        state = 48271 * state % 2147483647
        return 2.0 * state / 2147483647.0 - 1.0

    def block(x: float, y: float, wide: float, high: float, turn: float = 0.0, at: tuple[float, float] = (0.0, 0.0),
              word: str = "") -> str:
        c, s = math.cos(turn), math.sin(turn)
        corners = ((x, y), (x + wide, y), (x + wide, y + high), (x, y + high))
        return f"block {word}\n" + "".join(f"{c * u - s * v + at[0]!r} {s * u + c * v + at[1]!r}\n" for u, v in corners)

    long, high = 0.25, 0.1
    cell = 2.0 * long
    width, height = cell * columns, 0.75 * cell * rows
    text = [block(-0.6 * cell, -0.4 * cell, width + 1.2 * cell, 0.4 * cell, word="fixed")]
    text += [block(x, -0.4 * cell, 0.4 * cell, 6.0 * cell + height, word="fixed") for x in (-cell, width + 0.6 * cell)]
    for j in range(1, rows + 1):
        for i in range(1, columns + 1):
            turn, across, up, _, _ = (draw() for _ in range(5))
            text.append(block(-long / 2, -high / 2, long, high, 3.14 * turn,
                              (cell * (i - 0.5 + 0.16 * across), 0.7 * cell * (j + 0.1 * up))))
    return "".join(text)


def run(dda: pathlib.Path, folder: pathlib.Path, deck: str, out: str) -> tuple[float, dict[str, str]]:
    """Processor time of a run [s], and its row of results."""
    (folder / "deck.nml").write_text(deck)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([dda, "run", "deck.nml", "--out", out, "--quiet"], cwd=folder, check=True)
    spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with (folder / out / "results.csv").open() as table:
        return spent, list(csv.DictReader(table))[-1]


def pile_deck(end: float, since: str = "") -> str:
    """The deck of the pile, to a time and from a folder that another run has left."""
    return PILE.format(friction=math.degrees(math.atan(0.6)), end=end,
                       restart=f", restart='{since}/case_1.restart'" if since else "")


def main() -> None:
    """Print milliseconds a step of the pile and seconds of the slope, for each binary."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dda", type=pathlib.Path, nargs="+", help="binaries")
    parser.add_argument("--turns", type=int, default=2, help="how often each is run; the best counts (2)")
    given = parser.parse_args()
    binaries = [path.resolve() for path in given.dda]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "pile.blocks").write_text(pile(25, 20))
        (folder / "slope.geo").write_text(geometry(18.0, 16.0, 5.0, 90.0, 1.5, None))
        steps, since = {}, ""
        for time in TIMES:
            steps[time] = int(run(binaries[0], folder, pile_deck(time, since), f"to_{time}")[1]["steps"])
            since = f"to_{time}"
        best: dict[pathlib.Path, list[float]] = {dda: [math.inf, math.inf] for dda in binaries}
        for _ in range(given.turns):
            for dda in binaries:
                spent, n = 0.0, 0
                for time in TIMES:
                    part, row = run(dda, folder, pile_deck(time + PART, f"to_{time}"), "part")
                    spent, n = spent + part, n + int(row["steps"]) - steps[time]
                slope = run(dda, folder, SLOPE, "slope")[0]
                best[dda] = [min(best[dda][0], 1e3 * spent / n), min(best[dda][1], slope)]
    for dda, (crowding, slope) in best.items():
        print(f"{dda}: pile of 500 bricks {crowding:.1f} ms a step, slope of 291 blocks {slope:.2f} s")


if __name__ == "__main__":
    main()
