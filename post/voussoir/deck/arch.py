"""Arches as Python values: `voussoir.Arch`."""

from __future__ import annotations

from typing import Any

from voussoir.dda_program import find_dda
from voussoir.deck.run import Deck
from voussoir.deck.text import groups_of


class Arch(Deck):
    """An arch, by the keys of a deck.

    Parameters
    ----------
    **keys
        Keys of &arch and of any other group, with the names and defaults of decks:
        Arch(half_angle_deg=75, voussoirs=21, friction_deg=35).

    Raises
    ------
    ValueError
        If no group has such a key, or several do.

    Examples
    --------
    >>> run = Arch(voussoirs=12).run(search="thickness_ratio")
    >>> round(float(run.cases["critical"][0]), 6)
    0.104857
    """

    def __init__(self, **keys: Any) -> None:
        groups = groups_of(find_dda(), keys)
        super().__init__({"arch": groups.pop("arch", {}), **groups})
