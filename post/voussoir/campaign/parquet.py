"""Tables of results as Parquet, a batch of rows after the other: memory does not grow with the table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from voussoir.campaign.merge import replace
from voussoir.extras import load
from voussoir.results._tables import read_pieces

#: Rows that are held at the same time, and in one group of the file
BATCH = 50000


def write_parquet(table: Path) -> Path:
    """Write a table as .parquet beside itself, with the types that `voussoir.results` gives its columns.

    ValueError if a cell has another type than its column, MissingPackage if there is no pyarrow.
    """
    arrow, parquet = load("pyarrow", "Parquet"), load("pyarrow.parquet", "Parquet")
    target = table.with_suffix(".parquet")

    def write(file: Any) -> None:
        writer = None
        try:
            for names, columns in read_pieces(table, BATCH):
                batch = arrow.table({
                    name: arrow.array(column.tolist(), arrow.list_(arrow.float64())) if column.dtype == object
                    else arrow.array(column) for name, column in zip(names, columns)})
                writer = writer or parquet.ParquetWriter(file, batch.schema)
                writer.write_table(batch)
        finally:
            if writer:
                writer.close()

    replace(target, write)
    return target
