"""`voussoir verify`: recompute the proofs of a folder of results, with nothing of the program that made them."""

from __future__ import annotations

import argparse
import math
import re
import sys
from pathlib import Path

import numpy as np

from voussoir.verify.blocks import Source, arch_corners, led_springings, read_blocks
from voussoir.verify.contacts import TOUCH, Block, find_joints, make_block
from voussoir.verify.deck import LENGTHS, Deck, VerifyError, read_deck
from voussoir.verify.exact import MOST_JOINTS, check_exactly
from voussoir.verify.lines import read_lines
from voussoir.verify.loads import loads_on
from voussoir.verify.proofs import TOLERANCE, Finding, Scene, check_forces, check_motion
from voussoir.verify.read import COLUMNS, Row, read_table, recorded_sums, sums_of
from voussoir.verify.tables import check_joints, check_rigid

#: A collapse without limit analysis is that of blocks that strain, which may be so far from rigid
STRAIN = 1e-3
TABLES = tuple(COLUMNS)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the subcommand."""
    parser.description = (
        "Checks the proofs of static verdicts in a folder of results. Forces must balance the loads and obey the law "
        "of every joint. Mechanisms must not close a joint, and the loads must drive them. Joints, weights and loads "
        "are derived from blocks.csv, deck.record and the file of blocks. Checksums protect numbers that a proof "
        "does not cover, such as the velocity of a separated block."
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder of the results")
    parser.add_argument(
        "--decks", metavar="DIR", type=Path,
        help="folder of the deck and its file of blocks (default: the parent of DIR, then the current folder)")
    parser.add_argument(
        "--exact", action="store_true",
        help=f"repeat proofs of limits in rational arithmetic, for up to {MOST_JOINTS} joints")
    parser.add_argument(
        "--ignore-sums", action="store_true", help="ignore checksums, for tables that another program has rewritten")
    parser.add_argument("--quiet", action="store_true", help="print the worst case only")


def run(arguments: argparse.Namespace) -> int:
    """Check a folder; exit status 0 if all proofs hold, 1 if one does not, 2 if nothing can be checked."""
    try:
        with np.errstate(all="ignore"):  # numbers beyond all bounds keep no law
            found = _check_folder(arguments)
    except (ArithmeticError, LookupError, OSError, TypeError, ValueError) as error:
        has_place = re.search(r":\d+: error: ", str(error))
        words = str(error) if has_place or isinstance(error, VerifyError) else f"damaged files: {error!r}"
        place = "" if has_place else f"{arguments.folder}: error: "
        sys.stderr.write(f"{place}{' '.join(words.split())}\n")
        return 2
    return _report(found, arguments.quiet)


def _check_folder(arguments: argparse.Namespace) -> dict[int, Finding]:
    """Check every case of a folder: what was found of each."""
    deck = read_deck(arguments.folder)
    tables = {name: read_table(arguments.folder / f"{name}.csv") for name in TABLES}
    places = [arguments.decks] if arguments.decks else [arguments.folder.parent, Path()]
    found = {number: _check_case(deck, number, tables, places) for number in sorted(tables["results"])}
    if not arguments.ignore_sums:
        _check_sums(arguments.folder, found)
    if arguments.exact:
        for number, finding in found.items():
            if finding.figures:
                rows = {name: tables[name].get(number, []) for name in TABLES}
                check_exactly(*_case_of(deck, number, rows["results"][0], places), rows, finding)
    return found


def _check_sums(folder: Path, found: dict[int, Finding]) -> None:
    """Check that the rows of each case are those that the program wrote."""
    recorded, sums = recorded_sums(folder), sums_of(folder)
    for number, finding in found.items():
        if sums.get(number) != recorded.get(number):
            finding.faults.append("its rows are not as the program wrote them")
    for number in sums.keys() - found.keys():
        raise VerifyError(f"rows of case {number} in the tables, which results.csv does not have")


def _report(found: dict[int, Finding], quiet: bool) -> int:
    """Print what was found, and give the exit status."""
    for number, finding in found.items():
        if finding.faults:
            sys.stdout.write(f"case {number}: FAILS: {'; '.join(finding.faults[:3])}\n")
        elif not quiet:
            figures = ", ".join(f"{name} {value:.1e}" for name, value in finding.figures.items())
            sys.stdout.write(f"case {number}: {figures or 'no proof'}\n")
        if finding.interval and not finding.faults:
            sys.stdout.write(f"case {number}: {finding.interval}\n")
    proven = {number: finding for number, finding in found.items() if finding.figures}
    failed = sum(1 for finding in found.values() if finding.faults)
    text = f"{len(proven)} of {len(found)} cases have proofs, {failed} fail"
    if proven:
        worst = max(proven, key=lambda number: proven[number].worst()[0])
        _, name, value, most = proven[worst].worst()
        text += f"; the worst is case {worst}: {name} {value:.1e}, at most {most:.0e} is allowed"
    if not proven and not failed:
        text = f"no case of {len(found)} has a proof: nothing was verified"
    sys.stdout.write(text + "\n")
    return 1 if failed else 0


def _check_case(deck: Deck, number: int, tables: dict[str, dict[int, list[Row]]], places: list[Path]) -> Finding:
    """Check the proofs of one case."""
    finding = Finding()
    forces, motion = (tables[name].get(number, []) for name in ("proof_forces", "proof_motion"))
    result = tables["results"][number][0]
    if not forces and not motion:
        if result["imbalance"] or result["mechanism_power"]:
            finding.faults.append("figures of a proof without its rows")
        return finding
    of_case, _ = _case_of(deck, number, result, places)
    # what falls to the low side is carried from above
    carried, stopped = ("exact_high", "exact_low") if result["collapses_at"] == "low" else ("exact_low", "exact_high")
    for rows, name in ((forces, "forces"), (motion, "motion")):
        if not rows:
            continue
        if len({row["value"] for row in rows}) > 1:
            finding.faults.append(f"rows of the {name} are of several values")
        at_value = of_case
        if deck.searched is not None:
            at_value = of_case.with_value(deck.searched, rows[0]["value"])
        scene = scene_of(at_value, tables["blocks"].get(number, []), places, finding)
        if name == "forces":
            check_forces(scene, rows, finding)
            _check_bound(result, carried, rows[0]["value"], finding)
        else:
            power = check_motion(scene, rows, finding, _apart(of_case, result))
            if power < -TOLERANCE or deck.searched is None and not power > 0.0:
                finding.faults.append(f"the loads do not drive the mechanism: power {power:.3e}")
            if deck.searched is None:
                # the program may let bars and fill take more than they can
                off = float(result["mechanism_power"]) - power
                finding.keep("power (results.csv)", max(off, 0.0) if scene.pulls else abs(off))
            _check_bound(result, stopped, rows[0]["value"], finding)
            if deck.searched is not None and result["exact_high"]:
                finding.keep("power at the limit", abs(power))
    _check_tables(deck, of_case, result, {name: tables[name].get(number, []) for name in TABLES}, places, finding)
    return finding


def _case_of(deck: Deck, number: int, result: Row, places: list[Path]) -> tuple[Deck, list[Path]]:
    """The deck of a case, and its file of blocks or of lines and their materials."""
    of_case = deck.case(number)
    if result["worst_position"]:
        of_case.values["vehicle%position"] = [result["worst_position"]]
        if result["worst_direction"] == "backward":
            for name in ("vehicle%axles", "vehicle%spacings"):
                of_case.values[name] = of_case.values.get(name, [])[::-1]
    of_case.values["path_time"] = [result["path_time"]]
    return of_case, _files_of(of_case, places)


def _files_of(deck: Deck, places: list[Path]) -> list[Path]:
    """The file of blocks of a deck, or its files of lines and of their materials."""
    keys = ["geometry"] if deck.text("scene%kind") == "blocks" else []
    if deck.gives("scene%analysis"):
        keys = ["geometry", "analysis"]
    return [_find(deck.text(f"scene%{key}"), places) for key in keys]


def _check_tables(
    deck: Deck, of_case: Deck, result: Row, rows: dict[str, list[Row]], places: list[Path], finding: Finding
) -> None:
    """Check joints.csv and blocks.csv: forces of stable cases, mechanisms of collapses."""
    at_value, at_end = of_case, None
    if deck.searched is not None and result["verdict"] == "found":
        stands = "critical_high" if result["collapses_at"] == "low" else "critical_low"
        at_value = of_case.with_value(deck.searched, result[stands])
        at_end = of_case.with_value(deck.searched, result["critical"])
    elif deck.searched is not None and rows["proof_forces"]:
        at_value = of_case.with_value(deck.searched, rows["proof_forces"][0]["value"])
    elif deck.searched is not None:
        return
    scene = scene_of(at_value, rows["blocks"], places, Finding())
    _check_numbers(scene, rows)
    _check_stage(scene.source, result, finding)
    bars = [float(row["force"]) for row in rows["bars"]] if result["verdict"] in ("stable", "found") else None
    # where a path ends, the forces are those of the very end
    there, here = (loads_on(of, scene.source, scene.blocks) for of in (at_end or at_value, at_value))
    check_joints(scene, rows["joints"], bars, finding, there - here, _apart(of_case, result))
    strain = 0.0 if result["exact_high"] else STRAIN
    check_rigid(scene, rows["blocks"], finding, math.inf if result["verdict"] == "stable" else strain)


def _apart(of_case: Deck, result: Row) -> float:
    """How far corners at the two ends of a bracket are apart: blocks.csv is for one of them [m]."""
    name = of_case.searched
    if name is None or result["verdict"] != "found" or of_case.text("scene%kind") != "arch":
        return 0.0
    ends = [result["critical_low"], result["critical_high"]]
    if not of_case.is_shape():
        low, high = (arch_corners(of_case.with_value(name, end)) for end in ends)
        return max(float(np.abs(there - here).max()) for there, here in zip(low, high))
    # lengths move corners by as much as they change; other keys of &arch leave corners of a shape or are refused
    lengths = [key.split("%")[1] for key in LENGTHS]
    return abs(float(ends[1]) - float(ends[0])) if name.split("%")[-1] in lengths else 0.0


def _check_numbers(scene: Scene, rows: dict[str, list[Row]]) -> None:
    """Check that rows name blocks of the scene, which are numbered from 1."""
    if [block.number for block in scene.blocks] != list(range(1, len(scene.blocks) + 1)):
        raise VerifyError("blocks.csv: expected blocks numbered from 1 without a gap")
    for name in ("joints", "proof_forces", "proof_motion"):
        for row in rows[name]:
            for column in {"block", "block_1", "block_2"} & row.keys():
                if int(row[column]) > len(scene.blocks):
                    raise VerifyError(f"{name}.csv: expected blocks up to {len(scene.blocks)}, got {row[column]}")


def _check_stage(source: Source, result: Row, finding: Finding) -> None:
    """What stands has stood to its last stage; what falls in an earlier one does so under loads that do not change."""
    last = max((change.time for change in source.changes), default=0.0)
    if not source.changes or float(result["path_time"]) >= last:
        return
    if result["verdict"] == "stable":
        finding.faults.append(f"stable to time {result['path_time']}, but the last stage is at {last}")
    if source.changing:
        raise VerifyError("time histories of a collapse before the last stage are not verified")


def _check_bound(result: Row, column: str, value: str, finding: Finding) -> None:
    """A proven bound is the value of its proof."""
    if value and result[column] and float(result[column]) != float(value):
        finding.faults.append(f"{column} is {result[column]}, but its proof is of {value}")


def scene_of(deck: Deck, rows: list[Row], places: list[Path], finding: Finding) -> Scene:
    """Blocks and joints of a case, from its rows of blocks.csv and a file of blocks in one of the places.

    The finding receives how far corners are from those of the deck.
    """
    if not rows:
        raise VerifyError("no blocks of a case in blocks.csv: run the deck with output%blocks = .true.")
    corners: dict[int, list[list[float]]] = {}
    fixed: dict[int, bool] = {}
    for row in rows:
        corners.setdefault(int(row["block"]), []).append([float(row["x"]), float(row["y"])])
        fixed[int(row["block"])] = row["state"] == "fixed"
    blocks = [make_block(number, np.array(corners[number]), fixed[number]) for number in sorted(corners)]
    for block in blocks:
        if not 0.0 < block.size < math.inf:
            raise VerifyError(f"blocks.csv: block {block.number} has no area")
    joints = find_joints(blocks, deck.number("scene%contact_tolerance"))
    source = Source()
    if deck.text("scene%kind") == "blocks":
        source = read_blocks(_files_of(deck, places)[0], deck)
        there = source.present(float(deck.text("path_time") or 0))
        if sorted(corners) != there:
            finding.faults.append(f"expected blocks {there} in the last stage, got {sorted(corners)}")
        _compare([np.array(corners[n]) for n in sorted(corners)], [source.corners[n - 1] for n in there], finding)
        # what is not there keeps its number, touches nothing and carries nothing
        gone = [make_block(n + 1, c, True) for n, c in enumerate(source.corners) if n + 1 not in corners]
        blocks = sorted(blocks + gone, key=lambda block: block.number)
    elif deck.gives("scene%analysis"):
        lines, materials = _files_of(deck, places)
        source = read_lines(lines, materials, blocks, deck)
    elif deck.text("scene%kind") == "arch" and not deck.is_shape():
        _compare([np.array(corners[n]) for n in sorted(corners) if not fixed[n]], arch_corners(deck), finding)
        _check_supports(blocks, source, finding)
    elif deck.is_shape():
        movable = sum(1 for block in blocks if not block.fixed)
        if not 0 < deck.voussoirs <= movable:
            raise VerifyError(f"expected {deck.voussoirs:.4g} voussoirs by deck.record, got {movable} blocks that move")
        source.held = led_springings(deck, [block.corners for block in blocks])
        _check_supports(blocks, source, finding)
    return Scene(blocks, joints, source, deck)


def _check_supports(blocks: list[Block], source: Source, finding: Finding) -> None:
    """What an arch of any shape stands on is a rectangle behind a joint: as deep as that is long, or half as deep."""
    led = {held.block for held in source.held}
    corners = np.concatenate([block.corners for block in blocks if not block.fixed and block.number not in led])
    for block in blocks:
        if not block.fixed and block.number not in led:
            continue
        apart = np.linalg.norm(block.corners[:, None, :] - corners[None, :, :], axis=2)
        ends = [corners[row.argmin()] for row in apart if row.min() <= TOUCH * block.size]
        off = [1.0]
        for start, end in (ends, ends[::-1]) if len(ends) == 2 else ():
            outward = np.array([end[1] - start[1], start[0] - end[0]])
            for deep in (outward, outward / 2):
                wanted = np.array([start, end, end + deep, start + deep])
                apart = np.linalg.norm(wanted[:, None, :] - block.corners[None, :, :], axis=2)
                off.append(float(max(apart.min(axis=1).max(), apart.min(axis=0).max())) / block.size)
        finding.keep("corners", min(off))


def _find(name: str, places: list[Path]) -> Path:
    """A file that a deck names."""
    for place in places:
        if (place / name).exists():
            return place / name
    raise VerifyError(f"cannot find {name}: name the folder of the deck by --decks")


def _compare(written: list[np.ndarray], given: list[np.ndarray], finding: Finding) -> None:
    """Corners of blocks.csv are those of the deck, in any order."""
    if len(written) != len(given):
        finding.faults.append(f"expected {len(given)} blocks, got {len(written)}")
        return
    for number, (mine, its) in enumerate(zip(written, given), 1):
        size = float(np.linalg.norm(np.ptp(its, axis=0)))
        apart = np.linalg.norm(mine[:, None, :] - its[None, :, :], axis=2)
        off = max(float(apart.min(axis=1).max()), float(apart.min(axis=0).max())) / size
        finding.keep("corners", off)
        if off > TOLERANCE:
            finding.faults.append(f"corners of block {number} are not those of the deck")
