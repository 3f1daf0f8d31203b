"""Decks written from Python values, and keys found by their bare names."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Union

from voussoir.dda_program import keys_of

#: Groups of a deck: a mapping of keys each; of &sweep a list of such mappings will do
Groups = Mapping[str, Union[Mapping[str, Any], list[Any]]]
#: Names of groups and keys; a key may have the number of a joint
_NAME = re.compile(r"[a-z]\w*", re.ASCII | re.IGNORECASE)
_KEY = re.compile(r"[a-z]\w*(\(\d+\))?", re.ASCII | re.IGNORECASE)


def value_text(value: Any, key: str = "") -> str:
    """A value as a deck writes it (".true.", "0.5", "'no-slip'", "0, 54.5, 90").

    TypeError, with the key where it is known, if a deck has no such value.
    """
    if hasattr(value, "tolist"):  # NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, Path)):
        if len(str(value).splitlines()) > 1:
            raise ValueError(f"expected a text of one line, got {value!r}")
        return "'" + str(value).replace("'", "''") + "'"
    if isinstance(value, (list, tuple, range)):
        return ", ".join(value_text(item, key) for item in value)
    of_key = f" as {key}" if key else ""
    raise TypeError(f"expected a number, a flag, a text or a list of them{of_key}, got {value!r}")


def value_of(word: str) -> int | float | bool | str:
    """A value as decks and records write it: a flag, a number or a text, which may have quotes."""
    if word.strip(".").lower() in ("true", "false"):
        return word.strip(".").lower() == "true"
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            continue
    return word.strip("'\"")


def deck_text(groups: Groups) -> str:
    """A deck as text, a line a group: {"arch": {"voussoirs": 36}, "search": {}}; "sweep" may hold a list of them."""
    lines = []
    for group, keys in checked(groups).items():
        for one in _as_list(keys):
            words = ", ".join(f"{key} = {value_text(value, f'{group}%{key}')}" for key, value in one.items())
            lines.append(f"&{group} {words} /".replace("  ", " "))
    return "\n".join(lines) + "\n"


def checked(groups: Any) -> Groups:
    """Groups as they are; ValueError where they are no groups with keys of a deck."""
    if not isinstance(groups, Mapping):
        raise ValueError(f"expected the groups of a deck as a dict, got {groups!r}")
    for group, keys in groups.items():
        if not isinstance(group, str) or not _NAME.fullmatch(group):
            raise ValueError(f"expected the name of a group, got {group!r}")
        is_list = group == "sweep" and isinstance(keys, (list, tuple))
        for one in keys if is_list else [keys]:
            if not isinstance(one, Mapping):
                raise ValueError(f"expected the keys of &{group} as a dict, got {one!r}")
            for key in one:
                if not isinstance(key, str) or not _KEY.fullmatch(key):
                    raise ValueError(f"expected the name of a key of &{group}, got {key!r}")
    return groups


def merged(groups: Groups, more: Groups) -> dict[str, Any]:
    """Groups as for `deck_text`; keys of `more` go before, its sweeps are added."""
    joint: dict[str, Any] = dict(checked(groups))
    for group, keys in checked(more).items():
        there = joint.get(group)
        if group == "sweep":
            joint[group] = [*_as_list(there or []), *_as_list(keys)]
        else:
            joint[group] = {**(there or {}), **dict(keys)}
    return joint


def _as_list(keys: Any) -> list[Any]:
    """Sweeps as a list of mappings."""
    return [keys] if isinstance(keys, Mapping) else list(keys)


@lru_cache(maxsize=4)
def groups_of_keys(dda: Path) -> dict[str, tuple[str, ...]]:
    """Which groups a key's name means, as in &sweep, or else have it; a group's own name, with its mark, is its own."""
    owners: dict[str, tuple[str, ...]] = {}
    meant: dict[str, tuple[str, ...]] = {}
    for group, keys in keys_of(dda).items():
        owners["&" + group] = (group,)
        for name, key in keys.items():
            owners[name] = (*owners.get(name, ()), group)
            if key["sweep"] and key.get("bare", True):
                meant[name] = (*meant.get(name, ()), group)
    return owners | meant


def groups_of(dda: Path, keys: Mapping[str, Any]) -> dict[str, Any]:
    """Groups, as for `deck_text`, from keyword arguments.

    Keys are bare names ("friction_deg"), names with the group ("arch%radius"), or a group as a mapping ("search" to
    {"parameter": "friction_deg"}, for which that text alone will do). ValueError if no group has such a key, or several
    do.
    """
    owners = groups_of_keys(dda)
    groups: dict[str, Any] = {}
    for name, value in keys.items():
        if "&" + name in owners and (name not in owners or isinstance(value, Mapping)):  # scene%analysis is a key
            groups = merged(groups, {name: _group_of(name, value)})
            continue
        group, _, key = name.rpartition("%")
        group = group or _only_owner(key, owners)
        groups = merged(groups, {group: {key: value}})
    return groups


def _group_of(name: str, value: Any) -> Any:
    """Keys of a group that was given whole."""
    if name == "search" and isinstance(value, str):
        return {"parameter": value}
    if name == "search" and value is True:
        return {}
    if isinstance(value, Mapping) or (name == "sweep" and isinstance(value, (list, tuple))):
        return value
    raise ValueError(f"expected the keys of &{name} as a dict, got {value!r}")


def _only_owner(key: str, owners: Mapping[str, tuple[str, ...]]) -> str:
    """The group that has a key."""
    plain = re.sub(r"\(\d+\)$", "", key)
    groups = owners.get(plain, ())
    if len(groups) == 1:
        return groups[0]
    if groups:
        names = " or ".join(f"'{group}%{plain}'" for group in groups)
        raise ValueError(f"expected {names}, got '{key}', a key of several groups")
    near = difflib.get_close_matches(plain, owners, 1)
    words = f"; did you mean '{near[0]}'?" if near else ""
    raise ValueError(f"expected a key of a deck, got '{key}'{words}")
