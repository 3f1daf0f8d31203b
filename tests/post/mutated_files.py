"""Files of every format of `voussoir import`, and mutants of them."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path

from drawn_files import arc, assembly, bezier, block, box, drawing, ellipse, feature, geojson, groups, insert, line
from drawn_files import mesh, polyline

WORDS = (
    b"0 -1 1e12 1e308 1e-300 nan inf 100000000000 \xff\xfe \0 { [ ] \" , null true POLYGON EMPTY Z ( ) 70 SECTION "
    b"INSERT SPLINE < > &a; \xc3\xa4 999999 -32768 0.0001").split(b" ") + [b"", b"\n"]
VTK = """# vtk DataFile Version 3.0
x
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 6 double
0 0 0 1 0 0 1 1 0 0 1 0 2 0 0 2 1 0
CELLS 2 10
4 0 1 2 3
4 1 4 5 2
CELL_TYPES 2
9
9
"""
MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
2
1 2 2 0 1 1 2 3
2 2 2 0 1 1 3 4
$EndElements
"""
VTU = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="1"><Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>
"""


def seeds(folder: Path) -> dict[str, list[bytes]]:
    """Good files by their endings."""
    stones = [feature(box(-1, -1, 5, 1), "fixed"), feature(box(0, 0, 1, 2), "stone"),
              feature([(1, 0), (2, 0), (2, 1), (1.5, 1), (1.5, 1.8), (1.5, 1), (1, 1)])]
    traces = [feature([(0, 0), (3, 1)], "a", "LineString"), feature([(2, -1), (2, 3), (0, 2)], "b", "LineString")]
    parts = [(mesh((-1.5, -0.5, -0.5), (1.5, 0.5, 0)), True), (mesh((0, -0.5, 0), (1, 0.5, 2)), False)]
    heavy = groups(0, "POLYLINE", 8, "fixed", 66, 1, 70, 1)
    for x, y in box(-9, -1, 20, 1):
        heavy += groups(0, "VERTEX", 8, "fixed", 10, x, 20, y, 42, 0.0)
    rib = [ellipse("rib", 5.0, 0.6, 0.0, math.pi), ellipse("rib", 6.0, 0.6, 0.0, math.pi), line("rib", (5, 0), (6, 0)),
           line("rib", (-5, 0), (-6, 0)), arc("ring", (20, 0), 1.0, 0, 180), line("ring", (19, 0), (21, 0)),
           bezier("cap", [(30, 0), (30, 2), (34, 2), (34, 0)]), line("cap", (30, 0), (34, 0))]
    drawings = [
        drawing([*heavy, *groups(0, "SEQEND")], *rib, unit="m"),
        drawing(polyline("fixed", box(-1, -0.5, 3, 0.5), None), polyline("stones", box(0, 0, 1, 2), 1, [0.1, 0, 0, 0]),
                insert("b", "bricks", 4.0, 2, 2), groups(0, "TEXT", 8, "t", 10, 0, 20, 0, 40, 1, 1, "x"),
                blocks=block("b", polyline("0", box(0, 0, 1, 1)), insert("c", "0"))
                + block("c", groups(0, "CIRCLE", 8, "0", 10, 5, 20, 5, 40, 1)))]
    return {
        "dxf": [text.encode() for text in drawings],
        "geojson": [geojson(folder / "a", rows).read_bytes() for rows in (stones, traces)],
        "wkt": [b"fixed; POLYGON ((-1 -1, 4 -1, 4 0, -1 0, -1 -1))\nPOLYGON Z ((0 0 0, 1 0 0, 1 2 0, 0 2 0, 0 0 0), "
                b"(0.2 0.2 0, 0.4 0.2 0, 0.3 0.4 0, 0.2 0.2 0))\nMULTIPOLYGON (((1 0, 2 0, 2 1, 1 0)))\n",
                b"a; LINESTRING (0 0, 3 1)\nLINESTRING (2 -1, 2 3, 0 2)\n"],
        "json": [assembly(folder / "b", parts).read_bytes(),
                 json.dumps([{"dtype": "compas.geometry/Polygon", "data": {
                     "points": [[0, 0, 0], [1, 0, 0], [1, 0, 2], [0, 0, 2]]}}]).encode()],
        "vtk": [VTK.encode()], "msh": [MSH.encode()], "vtu": [VTU.encode()]}


def mutated(rng: random.Random, text: bytes, others: list[bytes]) -> bytes:
    """A file with a few changes: parts taken out, doubled, exchanged, overwritten; other words and numbers."""
    for _ in range(rng.choice([1, 1, 1, 2, 3, 6])):
        first = rng.randrange(len(text) + 1)
        last = min(len(text), first + rng.choice([0, 1, 2, 5, 20, 200]))
        kind = rng.randrange(8)
        if kind == 0:
            text = text[:first] + text[last:]
        elif kind == 1:
            text = text[:last] + text[first:]
        elif kind == 2:
            text = text[:first] + bytes([rng.randrange(256)]) + text[first + 1:]
        elif kind == 3:
            text = text[:first]
        elif kind == 4:
            other = rng.choice(others)
            begin = rng.randrange(len(other) + 1)
            text = text[:first] + other[begin: begin + rng.choice([5, 50, 500])] + text[last:]
        elif kind == 5:
            rows = text.split(b"\n")
            rows[rng.randrange(len(rows))] = rng.choice(WORDS)
            text = b"\n".join(rows)
        else:
            text = text[:first] + rng.choice(WORDS) + text[last:]
    return text
