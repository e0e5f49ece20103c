# SPDX-License-Identifier: GPL-3.0-or-later
"""What a Mapping does to coordinates: the node, or the panel of a texture node.

Each is a list of maps one after the other, the last one first; between two of them the vector is made a unit one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from mathutils import Euler, Matrix, Vector


def own_mapping(mapping: Any) -> list[Matrix]:
    """A texture node's own Mapping, a panel of its own. Cycles minds neither its limits nor the node's own colours."""
    scale = Vector(mapping.scale)
    if mapping.vector_type in {"TEXTURE", "NORMAL"}:  # kept invertible, as in Cycles
        scale = Vector([s if abs(s) >= 1e-5 else np.copysign(1e-5, s) for s in scale])
    kind, turn = mapping.vector_type, mapping.rotation
    return _joined(affine(kind, mapping.translation, turn, scale), [axes(mapping)])


def axes(mapping: Any) -> Matrix:
    """Which coordinate is taken for which."""
    matrix = Matrix.Diagonal((0.0, 0.0, 0.0, 1.0))
    for row, name in enumerate((mapping.mapping_x, mapping.mapping_y, mapping.mapping_z)):
        if name != "NONE":
            matrix[row]["XYZ".index(name)] = 1.0
    return matrix


def affine(kind: str, location: Any, rotation: Any, scale: Any) -> list[Matrix]:
    """The maps of a Mapping node."""
    turn = Euler(rotation).to_matrix().to_4x4()
    inverse_scale = Matrix.Diagonal([1.0 / s if s else 0.0 for s in (*scale, 1.0)])  # a scale of 0 gives 0
    if kind == "NORMAL":
        return [Matrix.Identity(4), turn @ inverse_scale]
    if kind == "TEXTURE":
        return [inverse_scale @ turn.transposed() @ Matrix.Translation(-Vector(location))]
    moved = Matrix.Translation(Vector(location)) if kind == "POINT" else Matrix.Identity(4)
    return [moved @ turn @ Matrix.Diagonal((*scale, 1.0))]


def _joined(after: list[Matrix], before: list[Matrix]) -> list[Matrix]:
    return [*after[:-1], after[-1] @ before[0], *before[1:]]
