# SPDX-License-Identifier: GPL-3.0-or-later
"""The attributes that geometry nodes give to instances, which a depsgraph's instances do not tell themselves.

Where Blender tells add-ons an object's evaluated geometry, they are those of its instances; which one a depsgraph's instance is
follows from its persistent id: of each level, from the innermost to the outermost, the instance's number or "id", and the number of
what stands before the instances of a level that has other geometry, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from .. import compat
from .attribute import TYPES

NO_NUMBER = 2**31 - 1  # in a persistent id
OTHERS = ("mesh", "curves", "pointcloud", "volume", "grease_pencil")  # in the order in which Blender places them


class InstanceAttributes:
    """Of all objects that place something; a place's are found by `of`."""

    def __init__(self) -> None:
        self._levels: dict[int, _Level | None] = {}

    def of(self, instance: Any) -> list[_Place]:
        """What has attributes of a depsgraph's instance, the innermost first."""
        if not instance.is_instance or instance.parent is None:
            return []
        parent = instance.parent
        key = parent.as_pointer()
        if key not in self._levels:
            geometry = compat.evaluated_geometry(parent) if _has_nodes(parent) else None
            self._levels[key] = None if geometry is None else _Level(geometry, parent.type.lower())
        level = self._levels[key]
        path = [number for number in instance.persistent_id if number != NO_NUMBER]
        return [] if level is None else list(level.places(path[::-1]))[::-1]


def are_out_of_reach(instance: Any) -> bool:
    """Whether an instance may have attributes that Blender does not tell add-ons."""
    parent = instance.parent if instance.is_instance else None
    if parent is None:
        return False
    if _has_nodes(parent):
        return not compat.TELLS_EVALUATED_GEOMETRY
    group = parent.instance_collection if parent.instance_type == "COLLECTION" else None
    return group is not None and any(_has_nodes(obj) for obj in group.all_objects)


def _has_nodes(obj: Any) -> bool:
    return any(modifier.type == "NODES" for modifier in obj.modifiers)


class _Level:
    """The instances of one geometry, and the geometry of each. `own`: of which kind is what is no instance here."""

    def __init__(self, geometry: Any, own: str = "") -> None:
        self._geometry = geometry  # keeps what follows alive
        self._before = sum(getattr(geometry, kind, None) is not None for kind in OTHERS if kind != own)
        self._points = geometry.instances_pointcloud()
        self._values: dict[str, np.ndarray | None] = {}
        self._inside: list[_Level | None] = []
        self._rows: dict[int, int] = {}
        self._same: list[int] = []
        if self._points is None:
            return
        self._inside = [
            _Level(found) if hasattr(found, "instances_pointcloud") else None
            for found in geometry.instance_references()
        ]
        ids = self.values("id")
        numbers = range(len(self._points.points)) if ids is None else compat.whole_numbers(self._points, "id").tolist()
        for row, number in enumerate(numbers):
            if number in self._rows:
                self._same.append(row)  # Blender has given it another one
            else:
                self._rows[number] = row
        self._same.reverse()
        self._references = compat.whole_numbers(self._points, ".reference_index")

    def places(self, path: list[int]) -> Iterator[_Place]:
        """From here on inwards, along the numbers of a persistent id."""
        if self._before and path:
            if path[0] != self._before:  # no instance, but what stands before them
                return
            path = path[1:]
        if self._points is None or not path:
            return
        if path[0] not in self._rows:
            if not self._same:
                return
            self._rows[path[0]] = self._same.pop()  # they come in their order
        row = self._rows[path[0]]
        yield _Place(self, row)
        inside = self._inside[self._references[row]]
        if inside is not None:
            yield from inside.places(path[1:])

    def values(self, name: str) -> np.ndarray | None:
        """(n,) or (n, 2 to 4) float32."""
        if name not in self._values:
            attribute = self._points.attributes.get(name)
            known = attribute is not None and attribute.data_type in TYPES
            self._values[name] = (
                compat.attribute_values(attribute, *TYPES[attribute.data_type]) if known else None  # type: ignore[union-attr]
            )
        return self._values[name]


class _Place:
    """As a mapping."""

    def __init__(self, level: _Level, row: int) -> None:
        self._level, self._row = level, row

    def __contains__(self, name: str) -> bool:
        return self._level.values(name) is not None

    def __getitem__(self, name: str) -> Any:
        values = self._level.values(name)
        if values is None:
            raise KeyError(name)
        return values[self._row].tolist()
