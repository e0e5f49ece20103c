# SPDX-License-Identifier: GPL-3.0-or-later
"""What an input socket receives, as a value of a program."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

from mathutils import Matrix

from ... import compat
from ..socket_value import own_value
from ..tree import NodeUse, Source
from .builder import Builder, Result, Value, constant, is_constant, kind_of
from .lamp import Lamp

NUMBERS = {"VALUE", "INT", "BOOLEAN"}

NOWHERE = (0.0, 0.0, 0.0)
DIRECTION = "direction"
# What stands for operations of place in worlds and lights; lights are objects to Cycles since 5.0.
ELSEWHERE: dict[str, dict[str, str | Value]] = {
    "world": {
        "position": DIRECTION,
        "generated": DIRECTION,
        "object": DIRECTION,
        "uv": NOWHERE,
        "attribute": NOWHERE,
        "attribute-number": 0.0,
        "attribute-alpha": 0.0,
    },
    "light": {
        "generated": "object" if compat.CYCLES >= 5 else "position",
        "object": "object" if compat.CYCLES >= 5 else "position",
        "uv": NOWHERE,
        "attribute": NOWHERE,
        "attribute-number": 0.0,
        "attribute-alpha": 0.0,
    },
}


def kind_of_socket(kind: str) -> str:
    return "number" if kind in NUMBERS else "vector"


class Reader(Builder):
    """Reads node trees of one owner into one program. `shift`: where Bump nodes want their height ("none", "x", "y"), and its width.

    `kind`: of the owner, material, world or light.
    """

    def __init__(self, kind: str = "material") -> None:
        super().__init__()
        self.kind = kind
        self.lamp: Lamp | None = None
        self.discs = True  # whether skies show the discs of their suns
        # of the suns shown: direction in the world, None if that is not fixed, and angle
        self.suns: list[tuple[Any, float]] = []
        self.shift: tuple[str, float] = ("none", 1.0)
        self._outputs: dict[tuple[Any, ...], Value | None] = {}  # None: being read

    def bend(self, normal: Value) -> None:
        super().bend(normal)
        self._outputs = {}

    def place(self, name: str, /, **parameters: Any) -> Value:
        """An operation that tells where the program runs; what is elsewhere than on a surface, as Cycles has it there."""
        # of all sets of UVs a lamp has the one without a name
        if self.lamp is not None and (name == "parametric" or (name == "uv" and compat.CYCLES >= 4 and not parameters)):
            return self.lamp.coordinates(self)
        elsewhere = ELSEWHERE.get(self.kind, {}).get(name, name)
        if not isinstance(elsewhere, str):
            return elsewhere
        if elsewhere == "direction":  # which no step along a surface changes
            return self(elsewhere)
        name = elsewhere
        direction, width = self.shift
        return (
            self(name, **parameters) if direction == "none" else self(name, shift=direction, width=width, **parameters)
        )

    def read(self, use: NodeUse, key: str | int, implicit: Callable[[], Value] | None = None) -> Value:
        """`implicit`: what Cycles links to it where nothing is."""
        source = use.source(key)
        if implicit is not None and use.is_left_open(key, source):
            return implicit()
        return self.converted(self._first(use, source, key), source.kinds)

    def optional(self, use: NodeUse, name: str, default: float = 0.0) -> Value:
        """A number that only some settings or versions of the node have."""
        return self.read(use, name) if use.has(name) and use.node.inputs[name].enabled else default

    def inputs(self, use: NodeUse) -> list[Value]:
        """Of the inputs in use: of each name some nodes have one socket per data type, all but one disabled."""
        return [self.read(use, i) for i, socket in enumerate(use.node.inputs) if socket.enabled]

    def linked(self, use: NodeUse, name: str) -> Value | None:
        """Of an input that is nothing unless it is linked, as of normals."""
        return self.read(use, name) if use.is_linked(name) else None

    def number(self, use: NodeUse, name: str) -> float:
        """Of an input where only a constant will do."""
        value = self.read(use, name)
        if is_constant(value):
            return float(value)  # type: ignore[arg-type]
        use.note(f"needs a constant as its '{name}'; the input's own is used instead")
        return float(own_value(use, use.node.inputs[name])[0])

    def mapped(self, vector: Value, matrices: list[Matrix]) -> Value:
        """By maps one after the other, the last one first; between two of them the vector is made a unit one."""
        for i, matrix in enumerate(reversed(matrices)):
            if i > 0:
                vector = self("vector-normalize", vector)
            if matrix != Matrix.Identity(4):
                vector = self._moved(vector, matrix)
        return vector

    def _moved(self, vector: Value, matrix: Matrix) -> Value:
        """By one map, which takes one before it in."""
        if isinstance(vector, Result) and self.operations[vector.index].name == "mapping":
            operation = self.operations[vector.index]
            rows = dict(operation.parameters)["matrix"]
            before = Matrix((rows[0:4], rows[4:8], rows[8:12], (0.0, 0.0, 0.0, 1.0)))
            return self._moved(operation.arguments[0], matrix @ before)
        return self("mapping", vector, matrix=tuple(float(x) for row in matrix[:3] for x in row))

    def converted(self, value: Value, kinds: tuple[str, ...]) -> Value:
        """Blender's implicit conversions of a value of the first kind of socket to the others in turn."""
        for before, after in pairwise(kinds):
            if after in NUMBERS and kind_of(value) == "vector":
                value = (
                    self("luminance", value, version=compat.CYCLES)
                    if before == "RGBA"
                    else self("vector-length" if after == "BOOLEAN" else "mean", value)
                )
            elif after not in NUMBERS:
                value = self.vector(value)
            if after == "INT" and before != "INT":
                value = self("truncate", value)
            if after == "BOOLEAN" and before != "BOOLEAN":
                value = self("greater-than", value, 0.0)
        return value

    def _first(self, use: NodeUse, source: Source, key: str | int) -> Value:
        kind = kind_of_socket(source.kinds[0])
        if source.socket is None:
            return constant(0.0, kind)
        if source.use is None:
            return constant(own_value(use, source.socket), kind)
        return self._given(source.use, source.socket, use, key)

    def _given(self, origin: NodeUse, output: Any, use: NodeUse, key: str | int) -> Value:
        place = (origin.place, output.identifier, self.shift, self.discs)
        if place in self._outputs:
            known = self._outputs[place]
            if known is None:
                raise RecursionError
            return known
        self._outputs[place] = None
        value = self._of_node(origin, output)
        if value is None:  # nothing can be said about it: the value of the input that it feeds
            value = constant(own_value(use, use.node.inputs[key]), "vector")
        kind = kind_of_socket(output.type)
        value = self.vector(value) if kind == "vector" else self("x", value) if kind_of(value) == "vector" else value
        self._outputs[place] = value
        return value

    def _of_node(self, use: NodeUse, output: Any) -> Value | None:
        from .elsewhere import elsewhere  # late: nodes are read by this class
        from .neutral import NEUTRAL
        from .nodes import NODES

        kind = use.node.bl_idname
        value = elsewhere(use, output, self)
        if value is None and kind in NODES:
            value = NODES[kind](use, output, self)
        if value is not None:
            return value
        if kind not in NEUTRAL:
            use.note("is not supported as a colour or number; the constant of the input that it feeds is used instead")
            return None
        neutral, what = NEUTRAL[kind](use, output, self)
        use.note(f"is not supported as a colour or number; {what} is used instead")
        return neutral
