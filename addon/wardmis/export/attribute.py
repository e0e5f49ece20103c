# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in for the attributes of meshes: the mean of their colours."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np


def mean_color(name: str) -> np.ndarray | None:
    """RGB over the corners or vertices of all meshes of the file that have this attribute; an empty name: the active colours.

    None: it is no colour, or may be made by a modifier. Black where nothing has it, as in Cycles.
    """
    found, sums, count = False, np.zeros(3), 0
    for mesh in bpy.data.meshes:
        attribute = _attribute(mesh, name)
        found = found or attribute is not None or name in mesh.uv_layers
        if attribute is not None and attribute.data_type in {"FLOAT_COLOR", "BYTE_COLOR"}:
            values = np.empty(4 * len(attribute.data), np.float32)
            attribute.data.foreach_get("color", values)
            sums += values.reshape(-1, 4)[:, :3].sum(axis=0, dtype=float)
            count += len(attribute.data)
    if count:
        return sums / count
    made = any(modifier.type == "NODES" for obj in bpy.data.objects for modifier in obj.modifiers)
    return None if found or made else np.zeros(3)


def _attribute(mesh: Any, name: str) -> Any:
    return mesh.attributes.get(name) if name else mesh.color_attributes.active_color
