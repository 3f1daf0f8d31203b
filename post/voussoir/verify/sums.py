"""Compare the checksum of the rows of a case with that in sizes.record."""

from __future__ import annotations

import re
import zlib
from pathlib import Path

from voussoir.files import plain, read_text
from voussoir.verify.deck import VerifyError

#: Tables whose lines are in the sum beside those of results.csv, where a run leaves them
SUMMED = (
    "joints.csv", "log.txt", "frames.csv", "frame_joints.csv", "points.csv", "energy.csv", "blocks.csv",
    "proof_forces.csv", "proof_motion.csv", "bars.csv", "reactions.csv",
)

#: A comma that parts two fields: an even number of quotes is behind it
_COMMA = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')


def recorded_sums(folder: Path) -> dict[int, int]:
    """Sums that the program has written down: the sum of each case."""
    path = folder / "sizes.record"
    if not path.exists():
        raise VerifyError("no sizes.record: run the deck again, or check proofs alone by --ignore-sums")
    first, *lines = read_text(path).splitlines() or [""]
    if first != "case,bytes,sum":
        raise VerifyError("sizes.record has no checksums: run the deck again, or check proofs alone by --ignore-sums")
    sums = {}
    for number, line in enumerate(lines, 2):
        if not re.fullmatch(r"\d{1,10},\d{1,20},\d{1,10}", line, re.ASCII):
            raise VerifyError(f"{path}:{number}: error: expected a case, its bytes and their sum, got {line[:40]!r}")
        case, _, total = line.split(",")
        sums[int(case)] = int(total)
    return sums


def sums_of(folder: Path) -> dict[int, int]:
    """Sums of the tables as they are: CRC-32 of each line, added up for each case; lines of no case under 0."""
    sums = _sums_of_results(folder / "results.csv")
    for path in [folder / name for name in SUMMED]:
        if not path.exists():
            continue
        blank = b" " if path.suffix == ".txt" else b","
        with plain(path).open("rb") as lines:
            next(lines, None)
            for line in lines:
                word = line.split(blank, 1)[0]
                case = int(word) if word.isdigit() else 0
                sums[case] = (sums.get(case, 0) + zlib.crc32(line.rstrip(b"\n"))) % 2**32
    return sums


def _sums_of_results(table: Path) -> dict[int, int]:
    """Sums of the rows of results.csv, without their seconds: no two runs agree in these."""
    header, *rows = (_COMMA.split(line) for line in read_text(table).rstrip("\n").split("\n"))
    case, seconds = header.index("case"), header.index("seconds")
    sums: dict[int, int] = {}
    for row in rows:
        number = int(row[case]) if len(row) > case and row[case].isdigit() else 0
        row[seconds:seconds + 1] = [""] * (len(row) > seconds)
        sums[number] = (sums.get(number, 0) + zlib.crc32(",".join(row).encode())) % 2**32
    return sums
