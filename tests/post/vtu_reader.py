"""A small reader of VTU files with raw appended data, written from VTK's description of the format.

https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

#: Letters of struct of VTK's types.
LETTER = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B", "UInt64": "Q"}
MARK = b'<AppendedData encoding="raw">\n_'


@dataclass
class Column:
    """One array of a file."""

    type: str  #: VTK's word for the type of its numbers.
    components: list[str]  #: Names of the components, empty where the file has none.
    rows: list[tuple[float, ...]]  #: One tuple a point or cell.

    @property
    def numbers(self) -> list[float]:
        """The numbers of an array of one component."""
        return [number for (number,) in self.rows]


@dataclass
class Grid:
    """What a file holds."""

    points: list[tuple[float, ...]]
    cells: list[list[int]]  #: Points of each cell, counted from 0.
    types: list[int]  #: VTK's numbers of the kinds of cells.
    point_fields: dict[str, Column]
    cell_fields: dict[str, Column]


def read_column(element: ElementTree.Element, data: bytes, order: str, length: str) -> Column:
    """Read one array."""
    assert element.get("format") == "appended"
    start = int(element.get("offset", ""))
    (n_byte,) = struct.unpack_from(order + length, data, start)
    start += struct.calcsize(order + length)
    assert start + n_byte <= len(data)
    number = order + LETTER[element.get("type", "")]
    numbers = [value for (value,) in struct.iter_unpack(number, data[start:start + n_byte])]
    width = int(element.get("NumberOfComponents", "1"))
    assert len(numbers) % width == 0
    return Column(
        type=element.get("type", ""), components=[element.get(f"ComponentName{i}", "") for i in range(width)],
        rows=list(zip(*[iter(numbers)] * width)))


def read_vtu(path: Path) -> Grid:
    """Read a file."""
    head, data = path.read_bytes().split(MARK, 1)
    data, tail = data[:data.rindex(b"</AppendedData>")], data[data.rindex(b"</AppendedData>"):]
    # without its data the file is XML from its first to its last line
    root = ElementTree.fromstring(head + MARK + tail)
    assert (root.tag, root.get("type")) == ("VTKFile", "UnstructuredGrid")
    order = {"LittleEndian": "<", "BigEndian": ">"}[root.get("byte_order", "")]
    length = LETTER[root.get("header_type", "UInt32")]
    (piece,) = root.findall("UnstructuredGrid/Piece")

    def columns(part: str) -> dict[str, Column]:
        return {element.get("Name", ""): read_column(element, data, order, length)
                for element in piece.findall(f"{part}/DataArray")}

    cells = columns("Cells")
    offsets = [0, *map(int, cells["offsets"].numbers)]
    connectivity = list(map(int, cells["connectivity"].numbers))
    grid = Grid(
        points=columns("Points")["Points"].rows, cells=[connectivity[a:b] for a, b in zip(offsets, offsets[1:])],
        types=list(map(int, cells["types"].numbers)), point_fields=columns("PointData"),
        cell_fields=columns("CellData"))
    assert len(grid.points) == int(piece.get("NumberOfPoints", ""))
    assert len(grid.cells) == len(grid.types) == int(piece.get("NumberOfCells", ""))
    return grid
