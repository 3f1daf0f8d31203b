"""What must hold of every assembly: invariance, balance, monotony, and that what is written can be read.

    python3 tests/cli/properties.py build/bin/dda --count 200

Each property is asked of random assemblies, the same ones for the same seeds; a counterexample leaves its folder.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import math
import random
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))
from assembly import area_and_centre  # noqa: E402
from block_scene import deepest_entry
from moving_walls import moving_wall  # noqa: E402
from random_assemblies import shape  # noqa: E402

Point = tuple[float, float]
#: Share of the largest force by which forces may differ, and of a limit
SAME_FORCE, SAME_LIMIT = 1e-6, 1e-7
#: Load factors that are stable and collapsed, over the associated limit
BELOW, ABOVE = 0.8, 1.2


class Violation(AssertionError):
    """A property does not hold."""


@dataclass(frozen=True)
class Scene:
    """Blocks, the first of them fixed, under their weight and a live push on each that can move."""

    fixed: list[list[Point]]
    blocks: list[list[Point]]
    push: Point = (1.0, 0.0)  #: Live force on the block of the same number over its weight
    gravity_deg: float = -90.0
    unit_weight: float = 20e3
    young: float = 5e9
    friction_deg: float = 35.0
    cohesion: float = 0.0
    order: list[int] = field(default_factory=list)  #: Numbers of the blocks that these were before

    def text(self) -> str:
        """The file of blocks."""
        lines = []
        for head, polygons in (("block fixed", self.fixed), ("block", self.blocks)):
            for polygon in polygons:
                lines += [head, *(f"{x!r} {y!r}" for x, y in polygon)]
        for number, polygon in enumerate(self.blocks, start=len(self.fixed) + 1):
            area, (x, y) = area_and_centre(polygon)
            fx, fy = (self.unit_weight * area * part for part in self.push)
            lines.append(f"live block {number} {x!r} {y!r} {fx!r} {fy!r}")
        return "\n".join(lines) + "\n"

    def deck(self, flow: str, task: str, factor: float | None = None) -> str:
        """A deck of it, at a load factor or for a search of it."""
        load = "" if factor is None else f", load_factor = {factor!r}"
        return (f"&scene kind = 'blocks', geometry = 'x.blocks' /\n"
                f"&material density = {self.unit_weight / 10.0!r}, unit_weight = {self.unit_weight!r},\n"
                f"  young = {self.young!r} /\n"
                f"&joint friction_deg = {self.friction_deg!r}, cohesion = {self.cohesion!r} /\n"
                f"&load gravity_direction_deg = {self.gravity_deg!r}{load} /\n&analysis flow = '{flow}' /\n{task}\n")


@dataclass(frozen=True)
class Change:
    """A scene that must give the same answer, and what becomes of a force."""

    scene: Scene
    force: Callable[[Point], Point]
    same_path: bool = True  #: Whether the loading path is the same: turned gravity comes from upright gravity
    rounding: float = 0.0  #: What rounding of the corners changes a limit by


def scene_of(seed: int) -> Scene:
    """The scene of a seed."""
    assembly, ground, pick = shape(seed)
    return Scene([list(polygon) for polygon in ground], [list(polygon) for polygon in assembly.blocks],
                 friction_deg=pick.uniform(15.0, 60.0))


def moved(scene: Scene, way: Callable[[Point], Point]) -> Scene:
    """All corners moved, in the same order."""
    return replace(scene, fixed=[[way(p) for p in polygon] for polygon in scene.fixed],
                   blocks=[[way(p) for p in polygon] for polygon in scene.blocks])


def mirrored(scene: Scene, pick: random.Random) -> Change:
    """Left for right."""
    other = moved(scene, lambda p: (-p[0], p[1]))
    other = replace(other, fixed=[polygon[::-1] for polygon in other.fixed],
                    blocks=[polygon[::-1] for polygon in other.blocks], push=(-scene.push[0], scene.push[1]))
    return Change(other, lambda f: (-f[0], f[1]))


def shifted(scene: Scene, pick: random.Random) -> Change:
    """A thousand kilometres away, by whole metres."""
    x, y = (pick.choice((-1e6, 1e6)) for _ in range(2))
    # corners a thousand kilometres away are rounded to 1e-10 m, which a small limit shows
    return Change(moved(scene, lambda p: (p[0] + x, p[1] + y)), lambda f: f, rounding=1e-9)


def turned(scene: Scene, pick: random.Random) -> Change:
    """Turned by any angle, and gravity with it."""
    degrees = pick.uniform(-180.0, 180.0)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def turn(p: Point) -> Point:
        return c * p[0] - s * p[1], s * p[0] + c * p[1]

    gravity = (scene.gravity_deg + degrees + 180.0) % 360.0 - 180.0
    return Change(replace(moved(scene, turn), push=turn(scene.push), gravity_deg=gravity), turn, same_path=False)


def renumbered(scene: Scene, pick: random.Random) -> Change:
    """Blocks in another order, each begun at another corner."""
    order = list(range(len(scene.blocks)))
    pick.shuffle(order)
    blocks = []
    for number in order:
        first = pick.randrange(len(scene.blocks[number]))
        blocks.append(scene.blocks[number][first:] + scene.blocks[number][:first])
    return Change(replace(scene, blocks=blocks, order=order), lambda f: f)


def longer(scene: Scene, pick: random.Random) -> Change:
    """Scaled, the stiffness with the stress."""
    scale = 10.0 ** pick.uniform(-3.0, 3.0)
    other = moved(scene, lambda p: (scale * p[0], scale * p[1]))
    return Change(replace(other, young=scene.young * scale), lambda f: (f[0] * scale**2, f[1] * scale**2))


def heavier(scene: Scene, pick: random.Random) -> Change:
    """Density and stiffness scaled."""
    scale = 10.0 ** pick.uniform(-3.0, 3.0)
    other = replace(scene, unit_weight=scene.unit_weight * scale, young=scene.young * scale)
    return Change(other, lambda f: (f[0] * scale, f[1] * scale))


def stiffer(scene: Scene, pick: random.Random) -> Change:
    """Blocks that strain less: where all is small the forces are the same."""
    return Change(replace(scene, young=scene.young * 10.0 ** pick.uniform(0.0, 3.0)), lambda f: f)


@dataclass
class Bench:
    """Where decks are run."""

    dda: Path
    folder: Path

    def run(self, scene: Scene, flow: str, task: str = "", factor: float | None = None) -> dict[str, str]:
        """The row of results.csv; the other tables stay in the folder x."""
        (self.folder / "x.blocks").write_text(scene.text())
        (self.folder / "x.nml").write_text(scene.deck(flow, task, factor))
        return self.run_deck()

    def run_deck(self) -> dict[str, str]:
        """Run x.nml."""
        done = subprocess.run([self.dda, "run", "x.nml", "--quiet"], cwd=self.folder, capture_output=True, text=True,
                              check=False)
        if "has no support" in done.stderr:
            # a block above an opening that nothing carries
            return {"verdict": "refused", "critical": ""}
        if done.returncode not in (0, 3):
            raise Violation(f"refused: {done.stderr}")
        return self.table("results")[0]

    def table(self, name: str) -> list[dict[str, str]]:
        """Rows of a table of the last run."""
        with (self.folder / "x" / f"{name}.csv").open(newline="") as lines:
            return list(csv.DictReader(lines))

    def limit(self, scene: Scene, flow: str = "associated") -> tuple[str, float]:
        """Verdict and largest load factor; none where it falls without load."""
        row = self.run(scene, flow, "&search parameter = 'load_factor' /\n&output joints = .false. /")
        return row["verdict"], float(row["critical"] or "nan")

    def jumped(self) -> bool:
        """Whether the last run jumped on its loading path: rounding chooses where such a motion comes to rest."""
        return "jumps on the loading path" in (self.folder / "x" / "log.txt").read_text()

    def forces(self, scene: Scene) -> dict[tuple[int, int], Point]:
        """Force of each block on each of a higher number, of the numbers before, after a decision."""
        total: dict[tuple[int, int], Point] = {}
        number = {len(scene.fixed) + new + 1: len(scene.fixed) + old + 1 for new, old in enumerate(scene.order)}
        for row in self.table("joints"):
            one, two = (number.get(int(row[name]), int(row[name])) for name in ("block_1", "block_2"))
            sign = 1.0 if one < two else -1.0
            x, y = total.get((min(one, two), max(one, two)), (0.0, 0.0))
            force = x + sign * float(row["force_x"]), y + sign * float(row["force_y"])
            total[min(one, two), max(one, two)] = force
        return total


def demand(holds: bool, words: str) -> None:
    """Raise a violation unless something holds."""
    if not holds:
        raise Violation(words)


def check_change(change: Callable[[Scene, random.Random], Change]) -> Callable[[Bench, int], None]:
    """The property that a change changes no answer: limit, verdicts on both its sides, forces below it."""

    def check(bench: Bench, seed: int) -> None:
        scene = scene_of(seed)
        other = change(scene, random.Random(seed))
        verdict, limit = bench.limit(scene)
        again, same = bench.limit(other.scene)
        demand(verdict == again, f"search: {verdict}, changed {again}")
        if verdict != "found" or limit < 1e-6:
            return
        demand(abs(same - limit) <= max(SAME_LIMIT * limit, other.rounding), f"limit {limit!r}, changed {same!r}")
        flows = ("associated", "coulomb") if other.same_path else ("associated",)
        for flow, share in itertools.product(flows, (BELOW, ABOVE)):
            row, before = bench.run(scene, flow, JOINTS, share * limit), bench.forces(scene)
            jumped = bench.jumped()
            changed, after = bench.run(other.scene, flow, JOINTS, share * limit), bench.forces(other.scene)
            demand(row["verdict"] == changed["verdict"],
                   f"{flow} at {share} of the limit: {row['verdict']}, changed {changed['verdict']}")
            if row["verdict"] == "stable" and not (jumped or bench.jumped()):
                compare({pair: other.force(force) for pair, force in before.items()}, after, f"{flow} at {share}")

    return check


def compare(expected: dict[tuple[int, int], Point], found: dict[tuple[int, int], Point], where: str) -> None:
    """Forces between blocks that must be the same."""
    most = max(math.hypot(*force) for force in expected.values())
    for pair in expected.keys() | found.keys():
        one, two = expected.get(pair, (0.0, 0.0)), found.get(pair, (0.0, 0.0))
        error = math.hypot(one[0] - two[0], one[1] - two[1]) / most
        demand(error <= SAME_FORCE, f"{where}: force of {pair}: {one}, changed {two}, {error:.1e} of the largest")


def check_balance(bench: Bench, seed: int) -> None:
    """Action is reaction: joints, weights and live forces balance each block, and the ground carries them all."""
    scene = scene_of(seed)
    verdict, limit = bench.limit(scene)
    if verdict != "found":
        return
    factor = BELOW * limit
    row = bench.run(scene, "associated", "&output joints = .true., reactions = .true. /", factor)
    if row["verdict"] != "stable":
        return
    blocks = scene.fixed + scene.blocks
    areas = [area_and_centre(polygon) for polygon in blocks]
    rest, weights = [[0.0, 0.0, 0.0] for _ in blocks], 0.0
    for number in range(len(scene.fixed), len(blocks)):
        weight = scene.unit_weight * areas[number][0]
        rest[number][0] += factor * weight * scene.push[0]
        rest[number][1] += factor * weight * scene.push[1] - weight
        weights += weight
    for joint in bench.table("joints"):
        x, y, fx, fy = (float(joint[name]) for name in ("x", "y", "force_x", "force_y"))
        for name, sign in (("block_1", -1.0), ("block_2", 1.0)):
            number = int(joint[name]) - 1
            cx, cy = areas[number][1]
            rest[number][0] += sign * fx
            rest[number][1] += sign * fy
            rest[number][2] += sign * ((x - cx) * fy - (y - cy) * fx)
    for number in range(len(scene.fixed), len(blocks)):
        size = math.sqrt(areas[number][0])
        worst = max(abs(rest[number][0]), abs(rest[number][1]), abs(rest[number][2]) / size)
        demand(worst <= SAME_FORCE * weights, f"block {number + 1} is off balance by {worst!r} of {weights!r}")
    for name, part in (("fx", factor * weights * scene.push[0]), ("fy", -weights)):
        carried = sum(float(line[name]) for line in bench.table("reactions"))
        demand(abs(carried + part) <= SAME_FORCE * weights, f"{name} of the ground {carried!r}, loads {part!r}")


def check_strength(bench: Bench, seed: int) -> None:
    """More friction never lowers the associated limit, and none is below that of no friction."""
    scene, last = scene_of(seed), 0.0
    for friction in (10.0, 25.0, 40.0, 60.0, 85.0):
        verdict, limit = bench.limit(replace(scene, friction_deg=friction))
        limit = limit if verdict == "found" else 0.0 if verdict == "collapsed" else math.inf
        demand(limit >= last * (1.0 - SAME_LIMIT), f"limit {limit!r} at {friction} degrees, {last!r} with less")
        last = limit


def check_proof(bench: Bench, seed: int) -> None:
    """The forces of a stable verdict, and the motion of a collapse, pass the checker, which knows nothing of dda."""
    scene = scene_of(seed)
    verdict, limit = bench.limit(scene)
    if verdict == "refused":
        return
    for share in (BELOW, ABOVE) if verdict == "found" else (BELOW,):
        bench.run(scene, "associated", JOINTS, share * limit if verdict == "found" else 0.0)
        done = subprocess.run([sys.executable, "-m", "voussoir", "verify", "x"], cwd=bench.folder, capture_output=True,
                              text=True, check=False)
        demand(done.returncode == 0, done.stdout + done.stderr)


def check_energy(bench: Bench, seed: int) -> None:
    """In time the columns of energy.csv add up, and what blocks hold never rises without work."""
    scene = scene_of(seed)
    task = ("&analysis mode = 'dynamic', geometry = 'current', time_step = 0.005, duration = 0.1, steps = 400 /\n"
            "&material unit_weight = 20e3, density = 2000.0 /\n&output energy = .true., joints = .false. /\n")
    (bench.folder / "x.blocks").write_text(replace(scene, push=(0.2, 0.0)).text())
    (bench.folder / "x.nml").write_text(
        f"&scene kind = 'blocks', geometry = 'x.blocks' /\n&joint friction_deg = {scene.friction_deg!r} /\n" + task)
    bench.run_deck()
    rows = [{name: float(value) for name, value in row.items()} for row in bench.table("energy")]
    weights = sum(scene.unit_weight * area_and_centre(polygon)[0] for polygon in scene.blocks)
    held = [sum(row[name] for name in ("kinetic", "elastic", "contact", "gravity")) - row["work"] for row in rows]
    gone = [sum(row[name] for name in ("friction", "damping", "impact", "numerical")) for row in rows]
    scale = max(max(abs(row[name]) for row in rows for name in ("kinetic", "gravity", "work")), 1e-6 * weights)
    # all of it is zero at the beginning
    for row, before, after, spent in zip(rows, [0.0, *held], held, gone):
        demand(after <= before + 1e-6 * scale, f"energy rises from {before!r} to {after!r} at {row['time']!r} s")
        demand(abs(after + spent) <= 1e-9 * scale, f"columns do not add up at {row['time']!r} s")


def check_motion(bench: Bench, seed: int) -> None:
    """Walls of many bricks that are hit, shaken and held move to the end, and no step adds to what they hold.

    No brick enters another by more than 1e-4 of its size.
    """
    wall = moving_wall(seed)
    (bench.folder / "x.blocks").write_text(wall.blocks)
    (bench.folder / "x.nml").write_text("&scene kind = 'blocks', geometry = 'x.blocks' /\n" + wall.keys)
    row = bench.run_deck()
    demand(row["verdict"] == "completed", f"the run ends {row['verdict']}")
    rows = [{name: float(value) for name, value in row.items()} for row in bench.table("energy")]
    held = [sum(row[name] for name in ("kinetic", "elastic", "gravity")) - row["work"] for row in rows]
    most = max(row["kinetic"] for row in rows) + wall.fall
    for row, before, after in zip(rows, [wall.begun, *held], held):
        demand(after <= before + 1e-4 * most, f"energy rises by {after - before!r} of {most!r} at {row['time']!r} s")
    depth = deepest_entry(bench.folder / "x")
    demand(depth <= 1e-4, f"bricks enter by {depth!r} of their size")


def check_deck(bench: Bench, seed: int) -> None:
    """A deck written in another way, or from its record, is the same deck."""
    pick = random.Random(seed)
    values = {
        "arch": {"half_angle_deg": pick.uniform(30.0, 120.0), "voussoirs": pick.randint(5, 60),
                 "radius": 10.0 ** pick.uniform(-2.0, 3.0), "thickness_ratio": pick.uniform(0.2, 0.5)},
        "material": {"density": pick.uniform(1.0, 5000.0), "young": 10.0 ** pick.uniform(7.0, 12.0)},
        "joint": {"friction_deg": pick.uniform(40.0, 80.0)},
        "load": {"horizontal_coefficient": pick.uniform(-0.1, 0.1)},
        "analysis": {"flow": pick.choice(["'associated'", "'coulomb'"]), "steps": pick.randint(100, 900)},
        "output": {"joints": pick.choice([".true.", ".false."])},
    }
    records = []
    for way in range(3):
        groups = list(values) if way == 0 else pick.sample(list(values), len(values))
        text = "".join(write_group(group, values[group], pick, plain=way == 0) for group in groups)
        (bench.folder / "x.nml").write_text(text if way < 2 else from_record(records[0]))
        row = bench.run_deck()
        records.append((bench.folder / "x" / "deck.record").read_text())
        demand(row["verdict"] in ("stable", "collapsed", "undecided"), row["verdict"])
        kept = [line for line in records[-1].splitlines()[1:] if not line.startswith(("&", "files"))]
        first = [line for line in records[0].splitlines()[1:] if not line.startswith(("&", "files"))]
        demand(entries(kept) == entries(first), f"way {way} of writing the deck gives another record")


def write_group(group: str, values: dict[str, object], pick: random.Random, plain: bool) -> str:
    """A group as a careful or as a careless hand writes it."""
    if plain:
        return f"&{group} " + ", ".join(f"{key} = {value!s}" for key, value in values.items()) + " /\n"
    lines = [f"{pick.choice([group, group.upper()])}"]
    for key in pick.sample(list(values), len(values)):
        value = values[key]
        text = f"{value:.17e}".replace("e", pick.choice("deED")) if isinstance(value, float) else str(value)
        lines.append(f"{pick.choice([key, key.upper()])}{pick.choice(['=', ' = '])}{text}{pick.choice(['', ' ! so'])}")
    return "&" + "\n".join(lines) + "\n/\n"


def entries(lines: list[str]) -> dict[str, list[str]]:
    """Keys of a record with their values, numbers as such."""
    found: dict[str, list[str]] = {}
    key = ""
    for line in lines:
        if not line.startswith(" "):
            key = line
            found[key] = []
            continue
        try:
            found[key].append(repr(float(line)))
        except ValueError:
            found[key].append(line.strip())
    return found


def from_record(record: str) -> str:
    """A deck of what a record says."""
    text = ""
    for key, (value, *_) in entries([line for line in record.splitlines()[1:]
                                     if not line.startswith(("&", "files"))]).items():
        group, name = key.split("%")
        quoted = f"'{value}'" if value[0].isalpha() else value
        whole = str(int(float(value))) if name in ("voussoirs", "steps") else quoted
        text = text.replace(f"&{group} ", f"&{group} {name} = {whole}, ", 1) if f"&{group} " in text \
            else text + f"&{group} {name} = {whole} /\n"
    return text


JOINTS = "&output joints = .true., blocks = .true. /"
CHANGES = {"mirror": mirrored, "translation": shifted, "rotation": turned, "numbers": renumbered, "length": longer,
           "density": heavier, "stiffness": stiffer}
PROPERTIES = {**{name: check_change(change) for name, change in CHANGES.items()}, "balance": check_balance,
              "strength": check_strength, "proof": check_proof, "energy": check_energy, "motion": check_motion,
              "deck": check_deck}


def main() -> int:
    """Ask properties of many assemblies; counterexamples are kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dda", type=Path, help="the command")
    parser.add_argument("--count", type=int, default=200, help="assemblies a property [200]")
    parser.add_argument("--first", type=int, default=0, help="first seed [0]")
    parser.add_argument("--keep", type=Path, help="folder for counterexamples [a temporary one]")
    parser.add_argument("properties", nargs="*", help=f"some of {', '.join(PROPERTIES)} [all]")
    asked = parser.parse_args()
    keep = asked.keep or Path(tempfile.mkdtemp(prefix="properties_"))
    failures = 0
    for name in asked.properties or PROPERTIES:
        broken = []
        for seed in range(asked.first, asked.first + asked.count):
            folder = keep / f"{name}_{seed}"
            folder.mkdir(parents=True, exist_ok=True)
            try:
                PROPERTIES[name](Bench(asked.dda.resolve(), folder), seed)
            except Violation as violation:
                broken.append(seed)
                print(f"{name} {seed}: {violation}", flush=True)
            else:
                subprocess.run(["rm", "-r", str(folder)], check=True)
        failures += len(broken)
        print(f"{name}: {asked.count - len(broken)} of {asked.count}", flush=True)
    if failures:
        print(f"counterexamples are in {keep}")
    return int(failures > 0)


if __name__ == "__main__":
    sys.exit(main())
