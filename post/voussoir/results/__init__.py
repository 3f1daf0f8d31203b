"""Read what `dda run` has written.

from voussoir import results
run = results.read("table1")
run.cases["critical"]            # a column as an array, cases in order
run.cases.where(geometry="current")["relative_error"]
run.cases.to_pandas()
run.plot(1)
for frame in run.frames_of(1): frame.blocks
"""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, KeysView, Mapping, ValuesView
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from voussoir.extras import advice
from voussoir.html_page import escape
from voussoir.record import Record, read_record
from voussoir.results import _table_view
from voussoir.results._tables import Choice, DamagedTable, read_columns

if TYPE_CHECKING:
    import pandas

    from voussoir.plot.figure_style import Picture

__all__ = ["Block", "DamagedTable", "Frame", "Results", "Table", "read"]


class Table(Mapping[str, np.ndarray]):
    """Columns of equal length by their names.

    As of a data frame, `len` is the number of rows, and iteration gives the names of the columns.

    Parameters
    ----------
    columns : dict of str to ndarray
        Whole numbers, floats (NaN where a cell is empty), texts, or objects (tuples of floats for the hinge angles).
    """

    def __init__(self, columns: dict[str, np.ndarray]) -> None:
        self.columns = columns

    def __getitem__(self, name: str) -> np.ndarray:
        """A column."""
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        """Names of the columns."""
        return iter(self.columns)

    def __len__(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values()), ()))

    def __eq__(self, other: object) -> bool:
        """Whether another table has the same columns and cells; NaN equals NaN."""
        if not isinstance(other, Table) or list(self) != list(other):
            return False
        return all(
            np.array_equal(mine, its, equal_nan=mine.dtype.kind == its.dtype.kind == "f")  # NaN where NaN is
            for mine, its in zip(self.values(), other.values()))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return _table_view.as_text(self.columns, len(self))

    def _repr_html_(self) -> str:
        return _table_view.as_html(self.columns, len(self))

    def keys(self) -> KeysView[str]:
        """Names of the columns."""
        return self.columns.keys()

    def values(self) -> ValuesView[np.ndarray]:
        """The columns."""
        return self.columns.values()

    def items(self) -> ItemsView[str, np.ndarray]:
        """Names and columns."""
        return self.columns.items()

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a data frame of pandas; ImportError if there is none."""
        try:
            import pandas
        except ImportError as missing:
            raise ImportError(f"expected pandas, got none ({missing}); {advice('pandas')}") from missing
        return pandas.DataFrame(dict(self.columns))

    def rows(self) -> Iterator[dict[str, Any]]:
        """Rows one by one."""
        for row in range(len(self)):
            yield {name: column[row] for name, column in self.columns.items()}

    def where(self, **wanted: Any) -> Table:
        """Rows, in the same order, whose columns have the wanted values: where(geometry="current")."""
        kept = np.ones(len(self), dtype=bool)
        for name, value in wanted.items():
            kept &= self.columns[name] == value
        return self.take(kept)

    def take(self, rows: np.ndarray) -> Table:
        """Some of the rows, by a mask or by their places."""
        count = int(np.count_nonzero(rows)) if rows.dtype == bool else len(rows)
        return Table(
            {
                name: np.broadcast_to(column[:1], count) if column.strides == (0,) and len(column) else column[rows]
                for name, column in self.columns.items()
            }
        )


@dataclass(frozen=True)
class Frame:
    """One picture of a run."""

    number: int  #: Its number
    step: int  #: Number of the time step before it
    time: float  #: Sum of the time steps before it [s]
    blocks: list[np.ndarray]  #: Corners of each block, (n, 2) [m]
    joints: Table  #: Contact points, force and states of each joint: the rows of frame_joints.csv


@dataclass(frozen=True)
class Block:
    """One block of a case."""

    number: int  #: Its number, from 1
    state: str  #: "fixed", "held" (by points) or "free"
    corners: np.ndarray  #: Where its corners are at the beginning, anticlockwise: (n, 2) [m]
    displacement: np.ndarray  #: Displacements of the corners: (n, 2) [m]; NaN where none are known


@dataclass(frozen=True, repr=False)
class Results:
    """The results of one deck."""

    folder: Path  #: Folder from which they were read
    cases: Table  #: results.csv, in the order of the cases
    joints: Table | None = None  #: joints.csv, likewise; None if it was not written
    frames: Table | None = None  #: frames.csv, likewise
    frame_joints: Table | None = None  #: frame_joints.csv, likewise
    blocks: Table | None = None  #: blocks.csv, likewise
    points: Table | None = None  #: points.csv, likewise
    reactions: Table | None = None  #: reactions.csv, likewise

    def __repr__(self) -> str:
        title = self.setting("scene%title")
        return f"Results of {title + ': ' if title else ''}{self._summary()}"

    def _repr_html_(self) -> str:
        title = escape(self.setting("scene%title") or "")
        return f"<p>{title and f'<b>{title}</b>: '}{escape(self._summary())}</p>{self.cases._repr_html_()}"

    def _summary(self) -> str:
        """Verdicts and tables, in one line."""
        verdicts, counts = np.unique(self.cases["verdict"], return_counts=True)
        ends = ", ".join(f"{count} {verdict}" for verdict, count in zip(verdicts, counts))
        there = ", ".join(name for name in ("cases", "joints", "blocks", "points", "frames", "frame_joints")
                          if getattr(self, name) is not None)
        return f"{len(self.cases)} case{'s' * (len(self.cases) != 1)} ({ends}); tables {there}"

    def plot(self, case: int = 1, **options: Any) -> Picture:
        """Draw a case as `voussoir plot` does.

        Parameters
        ----------
        case : int, optional
            Its number.
        **options
            Those of `case_picture.draw_case`: magnify, with_forces and so on.

        Returns
        -------
        Picture
            A figure of matplotlib that notebooks show; `savefig` writes it.
        """
        return _drawn("case_picture", "draw_case", self, case, **options)

    def chart(self, column: str | None = None) -> Picture:
        """Draw the critical values of a sweep against one of its columns, as `voussoir plot --chart`.

        Parameters
        ----------
        column : str, optional
            The abscissa; by default the swept number with the most values.

        Returns
        -------
        Picture
            As of `plot`.
        """
        return _drawn("design_chart", "draw_chart", self, column)

    @cached_property
    def record(self) -> Record:
        """Values of the keys of the deck, from deck.record."""
        return read_record(self.folder)

    def setting(self, name: str) -> str | None:
        """Value of a key in the deck, such as "arch%radius"; None if it is not set."""
        return self.record.setting(name)

    def settings(self, name: str) -> list[str]:
        """Values of a list key in the deck, such as "vehicle%axles"; empty if it is not set."""
        return self.record.values.get(name, [])

    @property
    def kind(self) -> str:
        """Kind of the scene: "arch", "shape" for arches that are no circular ring, "lines" or "blocks"."""
        return "shape" if self.record.is_shape() else self.setting("scene%kind") or "arch"

    @property
    def searched(self) -> str | None:
        """Parameter that was searched, None if none was."""
        return self.record.searched

    @property
    def swept(self) -> list[str]:
        """Parameters that were swept, in the order of the deck."""
        return [sweep.name for sweep in self.record.sweeps]

    @property
    def given(self) -> list[str]:
        """Names of the keys that the deck gives, such as "arch%radius"."""
        return [name for name in self.record.values if "%" in name]

    def case(self, number: int) -> dict[str, Any]:
        """Row of one case; KeyError if there is no such case."""
        for row in self.cases.where(case=number).rows():
            return row
        raise KeyError(f"no case {number} in {self.folder}")

    def joints_of(self, number: int) -> Table:
        """Joints of one case; KeyError if none were written."""
        if self.joints is None:
            raise KeyError(
                f"no joints.csv in {self.folder}: run the deck again with --set output%joints=.true. --cases {number}")
        return self.joints.where(case=number)

    def blocks_of(self, number: int) -> list[Block]:
        """Blocks of one case; KeyError if they were not written."""
        rows = None if self.blocks is None else self.blocks.where(case=number)
        if not rows:
            raise KeyError(
                f"no blocks of case {number} in {self.folder}: run the deck again with "
                f"--set output%blocks=.true. --set output%joints=.true. --cases {number}"
            )
        corners = np.column_stack((rows["x"], rows["y"]))
        moves = np.column_stack((rows["u"], rows["v"]))
        starts = np.flatnonzero(np.diff(rows["block"])) + 1
        return [
            Block(int(rows["block"][first]), str(rows["state"][first]), shape, motion)
            for first, shape, motion in zip([0, *starts], np.split(corners, starts), np.split(moves, starts))
        ]

    def points_of(self, number: int) -> list[Table]:
        """Trajectories of the monitoring points of one case, one table per point; empty if none were written."""
        if self.points is None:
            return []
        rows = self.points.where(case=number)
        return [rows.where(point=point) for point in np.unique(rows["point"])]

    def frames_of(self, number: int) -> list[Frame]:
        """Pictures of one case in their order; none where none were written."""
        if self.frames is None or self.frame_joints is None:
            return []
        corners = self.frames.where(case=number)
        joints = self.frame_joints.where(case=number)
        pictures = []
        for frame in np.unique(corners["frame"]):
            rows = corners.where(frame=frame)
            blocks = np.split(np.column_stack((rows["x"], rows["y"])), np.flatnonzero(np.diff(rows["block"])) + 1)
            step, time = int(rows["step"][0]), float(rows["time"][0])
            pictures.append(Frame(int(frame), step, time, blocks, joints.where(frame=frame)))
        return pictures

    def pvd(self, number: int) -> Path | None:
        """The file to open in ParaView for one case, None if there is none."""
        file = self.folder / "frames" / f"case_{number}.pvd"
        return file if file.is_file() else None


def read(folder: str | Path, choice: Choice | None = None) -> Results:
    """Read the results of one deck.

    Parameters
    ----------
    folder : str or Path
        Where `dda run` has written them.
    choice : callable, optional
        Selects the columns of results.csv from their names; other tables are then left out.

    Returns
    -------
    Results
        The tables with their types, sorted by case.

    Raises
    ------
    FileNotFoundError
        If there is no results.csv in the folder.
    DamagedTable
        If a table has contents that `dda` does not write.
    """
    folder = Path(folder)
    cases = _read_table(folder / "results.csv", choice)
    if cases is None:
        raise FileNotFoundError(f"no results.csv in {folder}: not a folder written by 'dda run'")
    others = ("joints", "frames", "frame_joints", "blocks", "points", "reactions") if choice is None else ()
    return Results(folder, cases, **{name: _read_table(folder / f"{name}.csv") for name in others})


def _drawn(module: str, function: str, *arguments: Any, **options: Any) -> Picture:
    """A picture in the style of all figures, by a function of `voussoir.plot`, which is loaded when it is needed."""
    draw = getattr(import_module(f"voussoir.plot.{module}"), function)
    with import_module("voussoir.plot.figure_style").house_style():
        picture: Picture = draw(*arguments, **options)
    return picture


def _read_table(file: Path, choice: Choice | None = None) -> Table | None:
    """A table with typed columns in the order of its cases, None if there is no such file."""
    if not file.is_file():
        return None
    table = Table(read_columns(file, choice=choice))
    if np.all(table["case"][1:] >= table["case"][:-1]):
        return table
    return table.take(np.argsort(table["case"], kind="stable"))
