"""What a stiff or extreme scene must answer, and the judgement of what it did answer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from voussoir.deck_runs import Finished, Row

RIGHT, UNDECIDED, WRONG = "right", "undecided", "WRONG"


@dataclass(frozen=True)
class Judgement:
    """Judgement of one scene.

    Attributes
    ----------
    colour
        "right", "undecided" or "WRONG".
    found
        What the program answered.
    error
        Its deviation, or the invariant that was looked at.
    reason
        Why it is undecided or WRONG; empty if right.
    """

    colour: str
    found: str
    error: str = ""
    reason: str = ""


class Expectation(Protocol):
    """What a scene must answer."""

    def wanted(self) -> str:
        """The answer in words."""

    def judge(self, rows: list[Row]) -> Judgement:
        """Judge rows that are all there and decided."""


@dataclass(frozen=True)
class Critical:
    """A search whose bracket holds the exact value, or that says that there is none.

    Attributes
    ----------
    exact
        Critical value by limit analysis; 0 where everything stands, None where nothing does.
    """

    exact: float | None

    def wanted(self) -> str:
        """The answer in words."""
        if self.exact is None:
            return "collapsed"
        return f"{self.exact:.10g}" if self.exact > 0.0 else "stable"

    def judge(self, rows: list[Row]) -> Judgement:
        """Judge the first row."""
        (row,) = rows
        if self.exact is None or self.exact == 0.0:
            return _verdict(row, self.wanted())
        if row["verdict"] != "found":
            return Judgement(WRONG, row["verdict"], "", "a critical value exists")
        low, high = float(row["critical_low"]), float(row["critical_high"])
        error = f"{float(row['critical']) / self.exact - 1.0:.1e}"
        inside = low <= self.exact <= high
        why = "" if inside else f"the exact value is not between {low!r} and {high!r}"
        return Judgement(RIGHT if inside else WRONG, row["critical"], error, why)


@dataclass(frozen=True)
class Shifted:
    """A search whose value differs from the exact one of rigid blocks by no more than elasticity.

    Attributes
    ----------
    exact
        Critical value of rigid blocks; None where there is none.
    bound
        Largest deviation.
    """

    exact: float | None
    bound: float

    def wanted(self) -> str:
        """The answer in words."""
        if self.exact is None:
            return "collapsed"
        return f"{self.exact:.8g} +- {self.bound:.1e}"

    def judge(self, rows: list[Row]) -> Judgement:
        """Judge the first row."""
        (row,) = rows
        if self.exact is None:
            return _verdict(row, "collapsed")
        if row["verdict"] != "found":
            return Judgement(WRONG, row["verdict"], "", "a critical value exists")
        shift = float(row["critical"]) - self.exact
        near = abs(shift) <= self.bound
        why = "" if near else f"more than elasticity explains: {self.bound:.1e}"
        colour = RIGHT if near else WRONG
        return Judgement(colour, row["critical"], f"{shift / self.exact:.1e}", why)


@dataclass(frozen=True)
class Verdict:
    """A decision.

    Attributes
    ----------
    word
        "stable" or "collapsed".
    """

    word: str

    def wanted(self) -> str:
        """The answer in words."""
        return self.word

    def judge(self, rows: list[Row]) -> Judgement:
        """Judge all rows."""
        return next(
            (found for row in rows if (found := _verdict(row, self.word)).colour == WRONG),
            _verdict(rows[0], self.word),
        )


@dataclass(frozen=True)
class Same:
    """Critical values of all cases agree.

    Attributes
    ----------
    tolerance
        Largest relative difference.
    """

    tolerance: float

    def wanted(self) -> str:
        """The answer in words."""
        return f"the same to {self.tolerance:.0e}"

    def judge(self, rows: list[Row]) -> Judgement:
        """Judge all rows."""
        if any(row["verdict"] != "found" for row in rows):
            return Judgement(WRONG, rows[0]["verdict"], "", "critical values exist")
        values = [float(row["critical"]) for row in rows]
        spread = (max(values) - min(values)) / abs(values[0])
        same = spread <= self.tolerance
        return Judgement(
            RIGHT if same else WRONG, rows[0]["critical"], f"{spread:.1e}", "" if same else "differ"
        )


@dataclass(frozen=True)
class Refused:
    """Bad input: refused with a message that names a word.

    Attributes
    ----------
    word
        What the message names.
    """

    word: str

    def wanted(self) -> str:
        """The answer in words."""
        return "refused"

    def judge(self, rows: list[Row]) -> Judgement:
        """Judge rows of a deck that was not refused."""
        return Judgement(WRONG, rows[0]["verdict"] if rows else "nothing", "", "not refused")


def judge(expectation: Expectation, finished: Finished) -> Judgement:
    """Judge a finished run.

    Parameters
    ----------
    expectation : Expectation
        What the scene must answer.
    finished : Finished
        What its run left.

    Returns
    -------
    Judgement
        A crash, a NaN in a table and a missing row are WRONG whatever was expected.
    """
    if finished.status is None:
        return Judgement(UNDECIDED, "nothing", "", finished.message)
    if finished.not_a_number:
        return Judgement(WRONG, "NaN or Inf", "", "in " + ", ".join(finished.not_a_number))
    if finished.status not in (0, 2, 3):
        return Judgement(WRONG, f"exit status {finished.status}", "", finished.message[:200])
    if isinstance(expectation, Refused) and finished.status == 2:
        named = expectation.word in finished.message
        why = "" if named else f"the message does not name {expectation.word}"
        return Judgement(RIGHT if named else WRONG, "refused", finished.message[:160], why)
    if finished.status == 2 or not finished.rows:
        return Judgement(WRONG, "refused", "", finished.message[:200])
    open_cases = [row for row in finished.rows if row["verdict"] == "undecided"]
    if open_cases:
        reason = finished.remarks.get(open_cases[0]["case"], "")
        return Judgement(UNDECIDED, "undecided", "", reason)
    return expectation.judge(finished.rows)


def _verdict(row: Row, word: str) -> Judgement:
    """Judge a row that must have a verdict."""
    found = row["verdict"]
    if found == word:
        return Judgement(RIGHT, found)
    at = f" at {row['critical']}" if found == "found" else ""
    return Judgement(WRONG, found + at, "", f"{word} is the truth")
