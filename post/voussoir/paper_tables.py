"""Tables 1 to 4 of the paper beside the results of dda: printed, and written as Markdown and CSV."""

from __future__ import annotations

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path

TITLES = {
    "table1": "Table 1: semicircular arch, number of voussoirs",
    "table2": "Table 2: semicircular arch of four blocks, imposed haunch joint",
    "table3": "Table 3: half angle 140 degrees, four blocks, imposed haunch joint, no-slip joints",
    "table4": "Table 4: half angle of embrace, voussoirs of 5 degrees (no-slip at 140 and 145)",
}
"""Heading of each table, by the name of its deck."""

COLUMNS = (
    "half angle",
    "blocks",
    "joint",
    "paper DDA",
    "rigid",
    "elastic",
    "exact polygon",
    "paper error %",
    "rigid error %",
    "elastic error %",
    "intrados hinge",
)
"""Headings of the columns; angles in degrees, errors against the exact polygon."""


@dataclass(frozen=True)
class Row:
    """One arch.

    Attributes
    ----------
    half_angle, blocks, joint
        Half angle [deg], number of blocks, imposed joint [deg] (empty where none is imposed).
    paper, rigid, elastic, exact
        Critical thickness ratios: of the paper's DDA, of this program in reference and in current
        geometry, of limit analysis; None where there is none.
    rigid_error, elastic_error
        Relative deviations of this program's values, as it tells them itself.
    hinge
        Intrados hinges of the collapse nearest to critical [deg].
    """

    half_angle: str
    blocks: str
    joint: str
    paper: float
    rigid: float | None
    elastic: float | None
    exact: float | None
    rigid_error: float | None
    elastic_error: float | None
    hinge: str

    @property
    def paper_error(self) -> float | None:
        """Relative error of the paper's value."""
        return None if self.exact is None else self.paper / self.exact - 1.0

    def cells(self) -> list[str]:
        """Text of each column."""
        return [
            self.half_angle,
            self.blocks,
            self.joint,
            f"{self.paper:g}",
            "undecided" if self.rigid is None else f"{self.rigid:.10f}",
            "undecided" if self.elastic is None else f"{self.elastic:.7f}",
            "" if self.exact is None else f"{self.exact:.10f}",
            percent(self.paper_error, "+.2f"),
            percent(self.rigid_error, "+.1e"),
            percent(self.elastic_error, "+.3f"),
            self.hinge,
        ]


def percent(share: float | None, form: str) -> str:
    """A share in percent, empty if it is unknown."""
    return "" if share is None else format(100.0 * share, form)


def read_table(file: Path) -> list[dict[str, str]]:
    """Rows of a CSV file whose comments begin with a number sign."""
    with file.open(encoding="utf-8") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def number(text: str) -> float | None:
    """Number in a cell, None if the cell is empty."""
    return float(text) if text else None


def join_rows(paper: list[dict[str, str]], results: list[dict[str, str]]) -> list[Row]:
    """Put the paper's rows and those of dda together.

    Parameters
    ----------
    paper
        Rows of one table in the paper's order.
    results
        Rows of results.csv of the deck of the same table; its cases are in the same order, each
        in reference geometry and then in current geometry.

    Returns
    -------
    list of Row

    Raises
    ------
    ValueError
        If the rows are not of the same arches.
    """
    by_case = sorted(results, key=lambda row: int(row["case"]))
    rigid = [row for row in by_case if row["geometry"] == "reference"]
    elastic = [row for row in by_case if row["geometry"] == "current"]
    if not len(paper) == len(rigid) == len(elastic):
        raise ValueError(
            f"{len(paper)} rows in the paper, {len(rigid)} rigid and {len(elastic)} elastic results"
        )
    rows = []
    for printed, row, moved in zip(paper, rigid, elastic):
        if float(printed["alpha_deg"]) != float(row["half_angle_deg"]):
            raise ValueError(f"half angle {printed['alpha_deg']} against {row['half_angle_deg']}")
        if int(printed["blocks"]) != int(row["blocks"]):
            raise ValueError(f"{printed['blocks']} blocks against {row['blocks']}")
        rows.append(
            Row(
                half_angle=row["half_angle_deg"],
                blocks=row["blocks"],
                joint=row.get("joints_deg(2)", ""),
                paper=float(printed["eta_dda"]),
                rigid=number(row["critical"]),
                elastic=number(moved["critical"]),
                exact=number(row["exact"]),
                rigid_error=number(row["relative_error"]),
                elastic_error=number(moved["relative_error"]),
                hinge=row["intrados_hinge_deg"],
            )
        )
    return rows


def as_text(rows: list[Row]) -> str:
    """Table with aligned columns."""
    lines = [list(COLUMNS), *(row.cells() for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(COLUMNS))]
    return "\n".join(
        "  ".join(cell.rjust(width) for cell, width in zip(line, widths)) for line in lines
    )


def as_markdown(rows: list[Row]) -> str:
    """Table in Markdown."""
    lines = [COLUMNS, ["---:"] * len(COLUMNS), *(row.cells() for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def main(arguments: list[str] | None = None) -> None:
    """Print the tables of a folder of results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder with table1/results.csv and so on")
    parser.add_argument("paper", type=Path, help="the paper's values, paper_tables.csv")
    options = parser.parse_args(arguments)
    printed = read_table(options.paper)
    markdown = []
    for table, title in TITLES.items():
        rows = join_rows(
            [row for row in printed if row["table"] == table],
            read_table(options.results / table / "results.csv"),
        )
        print(f"\n{title}\n{as_text(rows)}")
        markdown.append(f"## {title}\n\n{as_markdown(rows)}\n")
        with (options.results / f"{table}.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([COLUMNS, *(row.cells() for row in rows)])
    (options.results / "tables.md").write_text("\n".join(markdown), encoding="utf-8")


if __name__ == "__main__":
    main()
