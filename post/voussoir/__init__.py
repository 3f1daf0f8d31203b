"""Masonry arches and block systems by discontinuous deformation analysis and by theory.

run
    Run a deck, its text, or Python values; gives tables and pictures.
Arch, Blocks
    Decks made of Python values, shapely polygons among them.
read
    Read a folder that `dda run` has written.
theory
    The analytic solutions of the Couplet-Heyman problem.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.2.0"
__all__ = ["Arch", "Blocks", "read", "results", "run", "theory"]

#: Where the public names are; a module is loaded when its name is first used
_HOMES = {
    "Arch": "voussoir.deck.run",
    "Blocks": "voussoir.deck.blocks",
    "read": "voussoir.results",
    "run": "voussoir.deck.run",
}


def __getattr__(name: str) -> Any:
    """A public name, loaded when it is first used."""
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    if name in ("results", "theory"):
        return import_module(f"voussoir.{name}")
    raise AttributeError(f"module 'voussoir' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
