"""Layers of outlines, with what files say of them besides their names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

#: Properties of a feature that are those of its material
MATERIAL = ("density", "unit_weight", "young", "poisson")


class Layer(str):
    """A layer by its name."""

    is_fixed: bool = False  #: Whether the file says that the outline does not move
    is_name: bool = False  #: Whether it is the name of the outline alone, which makes no material
    properties: tuple[tuple[str, float], ...] = ()  #: Properties of the material

    @property
    def material(self) -> object:
        """Equal for layers of one material: that of equal properties, else one of each layer."""
        return self.properties or ("" if self.is_name else str(self))

    @property
    def words(self) -> str:
        """The layer with its properties."""
        values = ", ".join(f"{name} {value:g}" for name, value in self.properties)
        name = str(self) or "(no layer)"
        return f"{name} ({values})" if values else name


def layer_of(properties: Mapping[str, Any], words: str) -> Layer:
    """The layer of a feature by its properties role, layer, material or name.

    ValueError if a property of its material is no number.
    """
    key = next((key for key in ("role", "layer", "material", "name") if properties.get(key)), "")
    layer = Layer(properties[key] if key else "")
    layer.is_name = key == "name"
    layer.is_fixed = properties.get("fixed") is True or str(properties.get("fixed")).lower() == "true"
    given = [(name, properties[name]) for name in MATERIAL if properties.get(name) is not None]
    for name, value in given:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value <= 1e30:
            raise ValueError(f"{words}: expected {name} as a number above 0, got {str(value)[:40]!r}")
    layer.properties = tuple((name, float(value)) for name, value in given)
    return layer


def merged_materials(layers: Iterable[str]) -> tuple[dict[object, int], dict[int, list[Layer]]]:
    """Numbers of materials, and the layers of each; layers of equal materials have one."""
    numbers: dict[object, int] = {}
    names: dict[int, list[Layer]] = {}
    for layer in layers:
        full = layer if isinstance(layer, Layer) else Layer(layer)
        number = numbers.setdefault(full.material, len(numbers) + 1)
        known = names.setdefault(number, [])
        if full not in known:
            known.append(full)
    return numbers, names
