"""Campaigns: the cases of one deck, computed by many processes, merged into one table."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from voussoir.campaign_merge import replace
from voussoir.campaign_part import Part, finished_in, run_part
from voussoir.dda_program import DdaError, count_cases, version_of

#: Most cases of a part: its command line stays short, and little is done twice after a kill
LARGEST_PART = 2000
#: Parts a worker, so that all end at about the same time
PARTS_A_WORKER = 8

#: Status and message of a part
Outcome = tuple[int, str]
#: Computes parts and yields the outcome of each as it ends
Engine = Callable[[list[Part]], Iterator[Outcome]]


@dataclass(frozen=True)
class Campaign:
    """What is computed, and where its results go."""

    #: The program dda
    dda: Path
    #: The deck
    deck: Path
    #: Values of --set
    settings: tuple[str, ...]
    #: Folder of the results
    out: Path
    #: Number of cases of the deck
    total: int

    @property
    def parts(self) -> Path:
        """Folder of the parts."""
        return self.out / "parts"


def open_campaign(dda: Path, deck: Path, settings: list[str], out: Path, anew: bool) -> Campaign:
    """Begin a campaign, or go on with one.

    Parameters
    ----------
    dda : Path
        The program.
    deck : Path
        The deck.
    settings : list of str
        Values of --set.
    out : Path
        Folder of the results.
    anew : bool
        Whether what an earlier campaign has left in that folder is discarded.

    Returns
    -------
    Campaign
        The campaign; its folder exists and says what it is for.

    Raises
    ------
    DdaError
        If the deck is bad input, or the folder holds another campaign.
    """
    total = count_cases(dda, deck, settings)
    campaign = Campaign(dda, deck.resolve(), tuple(settings), out, total)
    identity = {
        "program": version_of(dda),
        "deck": deck.name,
        "settings": list(settings),
        "sha256": fingerprint(deck),
        "cases": total,
    }
    file = out / "campaign.json"
    if anew:
        shutil.rmtree(campaign.parts, ignore_errors=True)
        file.unlink(missing_ok=True)
    campaign.parts.mkdir(parents=True, exist_ok=True)
    if not file.exists():
        for name in ("results.csv", "disk.record"):  # of whatever was there before
            (out / name).unlink(missing_ok=True)
        text = json.dumps(identity, indent=1) + "\n"
        replace(file, lambda opened: opened.write(text.encode()))
        return campaign
    known = json.loads(file.read_text(encoding="utf-8"))
    if known != identity:
        changed = ", ".join(key for key in identity if known.get(key) != identity[key])
        raise DdaError(
            f"{deck}:1: error: wanted the campaign that {out} was begun for, found another one "
            f"(other {changed}); choose another --out, or begin --anew"
        )
    return campaign


def fingerprint(deck: Path) -> str:
    """Digest of a deck and of the files that it names.

    Parameters
    ----------
    deck : Path
        The deck.

    Returns
    -------
    str
        SHA-256 in hexadecimal digits.
    """
    digest = hashlib.sha256(deck.read_bytes())
    text = deck.read_text(encoding="utf-8", errors="replace")
    for name in re.findall(r"\b(?:geometry|analysis)\s*=\s*['\"]([^'\"\n]+)", text, re.IGNORECASE):
        if (deck.parent / name).is_file():
            digest.update((deck.parent / name).read_bytes())
    return digest.hexdigest()


def split(campaign: Campaign, cases: range, workers: int, jobs: int = 1) -> list[Part]:
    """Cut cases that are not finished into parts of equal size.

    Parameters
    ----------
    campaign : Campaign
        The campaign.
    cases : range
        Cases that are wanted.
    workers : int
        How many will work.
    jobs : int
        Cases that each computes at the same time.

    Returns
    -------
    list of Part
        The parts, in the order of their cases.
    """
    done = finished_in(campaign.parts, cases)
    rest = [case for case in cases if case not in done]
    size = max(1, min(LARGEST_PART, -(-len(rest) // (PARTS_A_WORKER * workers))))
    return [
        Part(
            campaign.dda,
            campaign.deck,
            campaign.settings,
            campaign.parts,
            tuple(rest[start : start + size]),
            jobs,
        )
        for start in range(0, len(rest), size)
    ]


def share(total: int, index: int, of: int) -> range:
    """Cases of one member of a job array.

    Parameters
    ----------
    total : int
        Number of cases.
    index : int
        Number of the member, from 1.
    of : int
        How many members there are.

    Returns
    -------
    range
        Its cases; those of all members are all cases, each once.
    """
    return range((index - 1) * total // of + 1, index * total // of + 1)


def local_engine(workers: int) -> Engine:
    """Processes on this machine.

    Parameters
    ----------
    workers : int
        How many at the same time.

    Returns
    -------
    Engine
        Runs parts.
    """

    def run(parts: list[Part]) -> Iterator[Outcome]:
        with ThreadPoolExecutor(workers) as pool:
            futures = [pool.submit(run_part, part) for part in parts]
            try:
                for future in as_completed(futures):
                    yield future.result()
            finally:
                pool.shutdown(cancel_futures=True)

    return run


def run_parts(parts: list[Part], engine: Engine, shown: bool) -> Outcome:
    """Run all parts and tell how far they are.

    Parameters
    ----------
    parts : list of Part
        The parts.
    engine : Engine
        What runs them.
    shown : bool
        Whether progress is told, on standard error.

    Returns
    -------
    Outcome
        The worst status of the program, 4 before 2 before all others, and its message.
    """
    worst, message = 0, ""
    start = time.monotonic()
    for done, (status, text) in enumerate(engine(parts), start=1):
        if status == 4 or status == 2 and worst != 4:
            worst, message = status, text
        if shown and done < len(parts):
            left = (time.monotonic() - start) / done * (len(parts) - done)
            sys.stderr.write(f"\rpart {done} of {len(parts)}, about {left:.0f} s left ")
            sys.stderr.flush()
        if worst:
            break
    if shown:
        sys.stderr.write("\r" + 60 * " " + "\r")
    return worst, message
