"""One field of the cells of a VTU file with raw appended data."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from voussoir.files import plain

_DATA = b'<AppendedData encoding="raw">'


def cell_field(path: Path, name: str) -> np.ndarray:
    """Read a field of the cells of a file as the program writes it: 64 bits, little-endian."""
    whole = plain(path).read_bytes()
    head, _, data = whole.partition(_DATA)
    cells = re.search(r"<CellData.*?</CellData>", head.decode(), re.DOTALL)
    entry = re.search(rf'<DataArray[^>]*Name="{name}"[^>]*>', cells[0]) if cells else None
    offset = re.search(r'offset="(\d+)"', entry[0]) if entry else None
    if entry is None or offset is None:
        raise ValueError(f"{path}: expected a field {name} of the cells, got none")
    start = int(offset[1])
    columns = int((re.search(r'NumberOfComponents="(\d+)"', entry[0]) or (0, 1))[1])
    data = data[data.index(b"_") + 1 :]
    length = int(np.frombuffer(data, "<u8", 1, start)[0])
    return np.frombuffer(data, "<f8", length // 8, start + 8).reshape(-1, columns)
