"""Tables 1 to 4 of the paper beside the results of dda.

As a script it prints the tables without the theories, and needs no package:
``python3 paper/tables.py RESULTS paper_tables.csv``.
"""

from __future__ import annotations

import argparse
import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

TITLES = {
    "table1": "Table 1: semicircular arch, number of voussoirs",
    "table2": "Table 2: semicircular arch of four blocks, imposed haunch joint",
    "table3": "Table 3: half angle 140 degrees, four blocks, imposed haunch joint, no-slip joints",
    "table4": "Table 4: half angle of embrace, voussoirs of 5 degrees (no-slip at 140 and 145)",
}
"""Heading of each table, by the name of its deck."""

THEORIES = {"milankovitch": "Milankovitch", "ccr": "CCR", "heyman": "Heyman"}
"""Headings of the analytic solutions, in the order of the paper."""

Cells = dict[str, str]


@dataclass(frozen=True)
class Value:
    """One thickness."""

    eta: float | None  #: Critical thickness ratio; None if it was not found
    error: float | None  #: Deviation from the exact value of the same polygons, relative to that
    hinge: str  #: Intrados hinges [deg], joined by semicolons
    printed: str = ""  #: The thickness as the paper prints it; empty of what is computed here

    def digits(self, column: str) -> str:
        """The thickness as people read it."""
        return self.printed or thickness(self.eta, column)


@dataclass
class Row:
    """One arch: what it is, its exact thickness, and a value for each column."""

    half_angle: str
    blocks: str
    joint: str
    exact: float | None = None
    values: dict[str, Value] = field(default_factory=dict)


@dataclass
class PaperTable:
    """One table of the paper: its name, its columns of values and its rows."""

    name: str
    columns: list[str]
    rows: list[Row]

    @property
    def title(self) -> str:
        """Heading."""
        return TITLES[self.name]


def method_of(row: Cells) -> str:
    """Heading of the column that a row of results.csv belongs to."""
    if row["mode"] != "static":
        return f"{row['mode'].capitalize()} mode"
    return {"reference": "ours, rigid", "current": "ours, elastic"}[row["geometry"]]


def read_table(file: Path) -> list[Cells]:
    """Rows of a CSV file whose comments begin with a number sign."""
    with file.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def results_of(folder: Path, table: str) -> Iterator[Cells]:
    """Rows of the results of one table: of its own deck, and of decks named table_something.

    A column joins a table by a further deck alone.
    """
    for file in sorted(folder.glob(f"{table}*/results.csv")):
        if file.parent.name == table or file.parent.name.startswith(f"{table}_"):
            yield from sorted(read_table(file), key=lambda row: int(row["case"]))


def number(text: str | None) -> float | None:
    """Number in a cell, None if the cell is empty."""
    return float(text) if text else None


def key_of(half_angle: str, blocks: str, joint: str) -> tuple[float, int, float]:
    """Distinction of an arch from the others of its table."""
    return float(half_angle), int(blocks), float(joint or 0.0)


def read_paper(file: Path, table: str) -> list[Row]:
    """The rows of one table as the paper prints them."""
    return [
        Row(
            half_angle=row["alpha_deg"], blocks=row["blocks"], joint=row["beta_imposed_deg"],
            values={"paper DDA": Value(float(row["eta_dda"]), None, row["beta_dda_deg"], row["eta_dda"])})
        for row in read_table(file)
        if row["table"] == table
    ]


def join(rows: list[Row], results: Iterator[Cells]) -> list[str]:
    """Put the results of dda into the paper's rows of the same arches: the headings of the columns as they came.

    ValueError if a result is of no arch of the paper, or an arch of the paper has no result.
    """
    by_key = {key_of(row.half_angle, row.blocks, row.joint): row for row in rows}
    methods: list[str] = []
    for cells in results:
        key = key_of(cells["half_angle_deg"], cells["blocks"], cells.get("joints_deg(2)", ""))
        if key not in by_key:
            raise ValueError(
                f"the paper has no arch of {cells['half_angle_deg']} degrees, "
                f"{cells['blocks']} blocks, joint {cells.get('joints_deg(2)', '-')}")
        row, method = by_key[key], method_of(cells)
        if method not in methods:
            methods.append(method)
        row.exact = number(cells["exact"]) if row.exact is None else row.exact
        eta = number(cells["critical"])
        error = number(cells["relative_error"])
        if error is None and eta is not None and row.exact is not None:
            error = eta / row.exact - 1.0
        row.values[method] = Value(eta, error, cells["intrados_hinge_deg"])
    for row in rows:
        if len(row.values) == 1:
            raise ValueError(f"no result for {row.blocks} blocks at {row.half_angle} degrees")
    return methods


def add_theories(rows: list[Row], theory: Any) -> None:
    """Add the three analytic solutions to the rows.

    Where the joint is imposed it is eta(beta), for which Heyman is CCR; else the critical state.
    """
    for row in rows:
        alpha = math.radians(float(row.half_angle))
        for name, heading in THEORIES.items():
            if row.joint:
                beta = math.radians(float(row.joint))
                eta = float(theory.equilibrium_thickness(beta, alpha, name))
            else:
                beta, eta, _ = (float(value) for value in theory.critical(alpha, name))
            row.values[heading] = Value(eta, None, f"{math.degrees(beta):.4f}")


def build_table(name: str, results: Path, paper: Path, theory: Any = None) -> PaperTable:
    """One table with all its columns, from a folder that has a folder of results for each deck.

    The analytic solutions are those of the module `voussoir.theory`, left out without it.
    """
    rows = read_paper(paper, name)
    columns = ["paper DDA", *join(rows, results_of(results, name))]
    if theory is not None:
        add_theories(rows, theory)
        columns += THEORIES.values()
    for row in rows:
        for heading, value in row.values.items():
            if value.error is None and value.eta is not None and row.exact is not None:
                row.values[heading] = replace(value, error=value.eta / row.exact - 1.0)
    return PaperTable(name, columns, rows)


def percent(share: float | None) -> str:
    """A share in percent, in as many digits as say something; empty if it is unknown."""
    if share is None:
        return ""
    percents = 100.0 * share
    if abs(percents) < 5e-16:
        return "0"
    if abs(percents) < 5e-5:
        return f"{percents:+.0e}"
    return f"{percents:+.2f}" if abs(percents) >= 1.0 else f"{percents:+.4f}"


def thickness(eta: float | None, column: str) -> str:
    """A thickness ratio in the digits that its column deserves."""
    if eta is None:
        return "undecided"
    return f"{eta:.10f}" if column in ("ours, rigid", "exact") else f"{eta:.7f}"


def headings(table: PaperTable) -> list[str]:
    """Headings of the columns that people read."""
    names = ["half angle", "blocks", *(["joint"] if table.rows[0].joint else []), "exact polygon"]
    for column in table.columns:
        names += [column, "error %"]
    return [*names, "intrados hinge, ours"]


def cells_of(table: PaperTable, row: Row) -> list[str]:
    """Cells of one row, as people read them."""
    cells = [row.half_angle, row.blocks, *([row.joint] if row.joint else [])]
    cells.append("" if row.exact is None else thickness(row.exact, "exact"))
    for column in table.columns:
        value = row.values.get(column, Value(None, None, ""))
        cells += [value.digits(column), percent(value.error)]
    return [*cells, row.values.get("ours, rigid", Value(None, None, "")).hinge]


def as_text(table: PaperTable) -> str:
    """Table with aligned columns."""
    lines = [headings(table), *(cells_of(table, row) for row in table.rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(line, widths)) for line in lines)


def as_markdown(table: PaperTable) -> str:
    """Table in Markdown, under its heading."""
    names = headings(table)
    lines = [names, ["---:"] * len(names), *(cells_of(table, row) for row in table.rows)]
    return f"## {table.title}\n\n" + "\n".join("| " + " | ".join(line) + " |" for line in lines)


def write_csv(table: PaperTable, file: Path) -> None:
    """Write a table with all digits: a value, an error and a hinge for each column."""
    names = ["half_angle_deg", "blocks", "beta_imposed_deg", "exact"]
    for column in table.columns:
        stem = column.lower().replace(", ", "_").replace(" ", "_")
        names += [stem, f"{stem}_error", f"{stem}_hinge_deg"]
    file.unlink(missing_ok=True)  # a link is replaced, not followed
    with file.open("w", encoding="utf-8", newline="") as lines:
        writer = csv.writer(lines, lineterminator="\n")
        writer.writerow(names)
        for row in table.rows:
            cells: list[Any] = [row.half_angle, row.blocks, row.joint, row.exact]
            for column in table.columns:
                value = row.values.get(column, Value(None, None, ""))
                cells += [value.eta, value.error, value.hinge]
            writer.writerow(["" if cell is None else cell for cell in cells])


def write_tables(tables: list[PaperTable], folder: Path) -> list[Path]:
    """Write each table as CSV and all of them as Markdown."""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for table in tables:
        files.append(folder / f"{table.name}.csv")
        write_csv(table, files[-1])
    files.append(folder / "tables.md")
    files[-1].unlink(missing_ok=True)
    files[-1].write_text("\n\n".join(map(as_markdown, tables)) + "\n", encoding="utf-8")
    return files


def main(arguments: list[str] | None = None) -> None:
    """Print the tables of a folder of results, and write them into it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder with table1/results.csv and so on")
    parser.add_argument("paper", type=Path, help="the paper's values, paper_tables.csv")
    options = parser.parse_args(arguments)
    tables = [build_table(name, options.results, options.paper) for name in TITLES]
    for table in tables:
        print(f"\n{table.title}\n{as_text(table)}")
    write_tables(tables, options.results)


if __name__ == "__main__":
    main()
