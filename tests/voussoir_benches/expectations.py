"""Expected answers of scenes, and the judgement of those found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from voussoir_benches.checks import Check, Outcome
from voussoir_benches.deck_runs import Finished, Row

RIGHT, UNDECIDED, WRONG = "right", "undecided", "WRONG"


@dataclass(frozen=True)
class Judgement:
    """Judgement of one scene."""

    colour: str  #: "right", "undecided" or "WRONG"
    found: str  #: What the program answered
    error: str = ""  #: Its deviation, or the invariant that was looked at
    reason: str = ""  #: Why it is undecided or WRONG; empty if right


class Expectation(Protocol):
    """Expected answer of a scene."""

    def expected(self) -> str:
        """The answer in words."""

    def judge(self, finished: Finished) -> Judgement:
        """Judge a run whose rows are all there and decided."""


@dataclass(frozen=True)
class Critical:
    """A search whose bracket holds the exact value but for what elasticity explains, or which says that none exists."""

    exact: float | None  #: Critical value by limit analysis; 0 where everything stands, None where nothing does
    bound: float = 0.0  #: By how much blocks that strain may differ from rigid ones

    def expected(self) -> str:
        """The answer in words."""
        if self.exact is None:
            return "collapsed"
        if self.bound:
            return f"{self.exact:.8g} +- {self.bound:.1e}"
        return f"{self.exact:.10g}" if self.exact > 0.0 else "stable"

    def judge(self, finished: Finished) -> Judgement:
        """Judge the only row."""
        (row,) = finished.rows
        if self.exact is None or self.exact == self.bound == 0.0:
            return _verdict(row, self.expected())
        if row["verdict"] != "found":
            return Judgement(WRONG, row["verdict"], "", "a critical value exists")
        low, high = float(row["critical_low"]), float(row["critical_high"])
        error = f"{float(row['critical']) / self.exact - 1.0:.1e}"
        if low - self.bound <= self.exact <= high + self.bound:
            return Judgement(RIGHT, row["critical"], error)
        why = f"more than elasticity explains: {self.bound:.1e}"
        if not self.bound:
            why = f"the exact value is not between {low!r} and {high!r}"
        return Judgement(WRONG, row["critical"], error, why)


@dataclass(frozen=True)
class Verdict:
    """A decision."""

    word: str  #: "stable" or "collapsed"

    def expected(self) -> str:
        """The answer in words."""
        return self.word

    def judge(self, finished: Finished) -> Judgement:
        """Judge all rows."""
        return next(
            (found for row in finished.rows if (found := _verdict(row, self.word)).colour == WRONG),
            _verdict(finished.rows[0], self.word),
        )


@dataclass(frozen=True)
class Same:
    """Critical values of all cases agree."""

    tolerance: float  #: Largest relative difference

    def expected(self) -> str:
        """The answer in words."""
        return f"the same to {self.tolerance:.0e}"

    def judge(self, finished: Finished) -> Judgement:
        """Judge all rows."""
        rows = finished.rows
        if any(row["verdict"] != "found" for row in rows):
            return Judgement(WRONG, rows[0]["verdict"], "", "critical values exist")
        values = [float(row["critical"]) for row in rows]
        spread = (max(values) - min(values)) / abs(values[0])
        same = spread <= self.tolerance
        return Judgement(RIGHT if same else WRONG, rows[0]["critical"], f"{spread:.1e}", "" if same else "differ")


@dataclass(frozen=True)
class Refused:
    """Bad input: refused with a message that names a word."""

    word: str  #: What the message names

    def expected(self) -> str:
        """The answer in words."""
        return "refused"

    def judge(self, finished: Finished) -> Judgement:
        """Judge a deck that was not refused."""
        found = finished.rows[0]["verdict"] if finished.rows else "nothing"
        return Judgement(WRONG, found, "", "not refused")


@dataclass(frozen=True)
class Warned:
    """A scene that runs, and of which a warning names a word."""

    word: str  #: What the warning names
    then: Expectation  #: What it must answer

    def expected(self) -> str:
        """The answer in words."""
        return f"a warning, {self.then.expected()}"

    def judge(self, finished: Finished) -> Judgement:
        """Judge what was printed, then the rest."""
        if "warning: " not in finished.message or self.word not in finished.message:
            why = f"no warning names {self.word}"
            return Judgement(WRONG, finished.rows[0]["verdict"], "", why)
        return self.then.judge(finished)


@dataclass(frozen=True)
class Measured:
    """Quantities of the results that are known."""

    checks: tuple[Check, ...]  #: What is compared

    def expected(self) -> str:
        """The answer in words."""
        return "; ".join(f"{check.what}: {_figure(check.exact)}" for check in self.checks)

    def judge(self, finished: Finished) -> Judgement:
        """Judge every quantity; report the one whose error is the largest share of the accepted."""
        worst, found, why, share = "", "", "", -1.0
        for check in self.checks:
            outcome = Outcome(finished.folder, check.case)
            try:
                computed = check.measure(outcome)
            except (IndexError, FileNotFoundError):
                return Judgement(WRONG, "nothing", "", f"{check.what}: nothing to measure")
            error = check.error(computed)
            # an error that is not a number is accepted nowhere
            bad = not error <= check.accept
            if bad or error / (check.accept or 1.0) > share:
                share = error / (check.accept or 1.0)
                worst, found = f"{error:.1e}", _figure(computed)
                why = f"{check.what}: accepted is {check.accept:.0e}" if bad else ""
            if bad:
                break
        return Judgement(WRONG if why else RIGHT, found, worst, why)


def _figure(value: float | str) -> str:
    """A value in short."""
    return value if isinstance(value, str) else f"{value:.8g}"


def judge(expectation: Expectation, finished: Finished) -> Judgement:
    """Judge a finished run: a crash, a NaN in a table and a missing row are WRONG whatever was expected."""
    if finished.status is None:
        return Judgement(UNDECIDED, "nothing", "", finished.message)
    if finished.not_a_number:
        return Judgement(WRONG, "NaN or Inf", "", "in " + ", ".join(finished.not_a_number))
    if finished.status not in (0, 2, 3):
        return Judgement(WRONG, f"exit status {finished.status}", "", finished.message[:200])
    if isinstance(expectation, Refused) and finished.status == 2 and not finished.rows:
        named = expectation.word in finished.message
        why = "" if named else f"the message does not name {expectation.word}"
        return Judgement(RIGHT if named else WRONG, "refused", finished.message[:160], why)
    if finished.status == 2 or not finished.rows:
        return Judgement(WRONG, "refused", "", finished.message[:200])
    open_cases = [row for row in finished.rows if row["verdict"] == "undecided"]
    if open_cases:
        reason = finished.remarks.get(open_cases[0]["case"], "")
        return Judgement(UNDECIDED, "undecided", "", reason)
    return expectation.judge(finished)


def _verdict(row: Row, word: str) -> Judgement:
    """Judge a row that must have a verdict."""
    found = row["verdict"]
    if found == word:
        return Judgement(RIGHT, found)
    at = f" at {row['critical']}" if found == "found" else ""
    return Judgement(WRONG, found + at, "", f"{word} is the truth")
