"""Sets of case numbers of one byte a case: a million of them are a megabyte."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, MutableSet


class CaseSet(MutableSet):
    """A set of whole numbers from 0, kept as a byte each up to the largest."""

    def __init__(self, cases: Iterable[int] = ()) -> None:
        self._bytes = bytearray()
        self._count = 0
        #: Whether each number was put in after all smaller ones, and once
        self.in_order = True
        for case in cases:
            self.add(case)

    def __contains__(self, case: object) -> bool:
        return isinstance(case, int) and 0 <= case < len(self._bytes) and self._bytes[case] == 1

    def __iter__(self) -> Iterator[int]:
        """Numbers in their order."""
        case = self._bytes.find(1)
        while case >= 0:
            yield case
            case = self._bytes.find(1, case + 1)

    def __len__(self) -> int:
        return self._count

    def add(self, case: int) -> None:
        """Put a number in."""
        known = self._bytes
        if case >= len(known):
            known.extend(bytes(case + 1 - len(known)))
        else:
            self.in_order = False
        self._count += 1 - known[case]
        known[case] = 1

    def discard(self, case: int) -> None:
        """Take a number out."""
        if case in self:
            self._bytes[case] = 0
            self._count -= 1
