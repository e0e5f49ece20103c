# SPDX-License-Identifier: GPL-3.0-or-later
"""What the trees of worlds and lights shine."""

from __future__ import annotations

import numpy as np

from ... import compat
from ..model import ProgramData
from ..tree import NodeUse, Owner
from .builder import Result, Value
from .closures import Shading
from .reader import Reader
from .sky import linear
from .surface import MOST_OPERATIONS, Writer


class Shine(Shading):
    """A shader tree of which light alone counts: what scatters it gives none, in Cycles too."""

    def read(self, use: NodeUse, key: str | int, weight: Value = 1.0) -> None:
        origin = use.source(key).use
        is_background = origin is not None and origin.node.bl_idname == "ShaderNodeBackground"
        if origin is not None and is_background and self.p.kind == "light" and not compat.BACKGROUND_LIGHTS_LAMPS:
            origin.note("gives no light in a lamp, in Cycles of this Blender either; use Emission")
            return
        super().read(use, key, weight)

    def add_unknown(self, use: NodeUse, weight: Value) -> None:
        pass


def emission(p: Reader, output: NodeUse) -> Value:
    """Of a tree's output, a vector."""
    shine = Shine(p)
    shine.read(output, "Surface")
    return shine.emission


class Light:
    """A value as a constant factor and, where it is not one, a program whose value `result` is multiplied by it."""

    def __init__(self, p: Reader, value: Value, owner: Owner) -> None:
        writer = Writer(p)
        color = writer.color(value)
        self.factor = color.value
        self.value: Value = (1.0, 1.0, 1.0) if color.result is None else Result(color.result, "vector")
        self.program: ProgramData | None = writer.program()
        self.result = color.result or 0
        if self.program is not None and len(self.program.operations) > MOST_OPERATIONS:
            owner.context.note(
                f"{owner.place}: its nodes make {len(self.program.operations)} operations, of which {MOST_OPERATIONS} are the most; "
                "it gives no light"
            )
            self.factor, self.program = (0.0, 0.0, 0.0), None


def image_of_directions(p: Reader, value: Value) -> tuple[int, str, np.ndarray] | None:
    """Of nothing but an image of all directions: its texture, its projection, and the matrix, (3, 3), to its directions."""
    if not isinstance(value, Result) or p.operations[value.index].name != "environment":
        return None
    operation = p.operations[value.index]
    parameters = dict(operation.parameters)
    if parameters.get("unassociate"):
        return None
    matrix = linear(p, operation.arguments[0])
    if matrix is None or not _has_inverse(matrix):
        return None
    return parameters["texture"], parameters.get("projection", "equirectangular"), matrix


def _has_inverse(matrix: np.ndarray) -> bool:
    """As the renderer asks for it, with some room."""
    lengths = np.prod(np.linalg.norm(matrix, axis=1))
    return bool(1e-18 < lengths < 1e18 and abs(np.linalg.det(matrix)) > 1e-4 * lengths)
