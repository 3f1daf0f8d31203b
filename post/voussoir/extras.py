"""Packages that only some commands want: how to get one that is missing."""

from __future__ import annotations

import importlib
import sys
import sysconfig
from pathlib import Path
from types import ModuleType

#: Packages that Debian has as python3-NAME
_DEBIAN = frozenset("distributed ezdxf matplotlib meshio pandas scipy shapely".split())


class MissingPackage(ImportError):
    """A package that a command wants is not there: the message says how to get it."""


def advice(package: str) -> str:
    """How to install a package, or that of a module, for this interpreter.

    With pip in a virtual environment or where the system leaves its Python to pip; else with the system's package, and
    an environment where it has none.
    """
    package = package.partition(".")[0]
    if not _is_managed():
        return f"install it: {Path(sys.executable).name} -m pip install {package}"
    if package in _DEBIAN:
        return f"install it: apt-get install python3-{package}"
    return f"the system has no package of it: use a virtual environment and pip install {package}"


def _is_managed() -> bool:
    """Whether the system's packages alone may change this interpreter's (PEP 668)."""
    if sys.prefix != sys.base_prefix:
        return False
    return (Path(sysconfig.get_path("stdlib")) / "EXTERNALLY-MANAGED").is_file()


def load(package: str, purpose: str) -> ModuleType:
    """Import a package for a purpose such as "a DXF drawing"; MissingPackage if it is not there."""
    try:
        return importlib.import_module(package)
    except ImportError as missing:
        name = package.partition(".")[0]
        raise MissingPackage(f"{purpose} needs {name}, got none ({missing}); {advice(name)}") from missing
