# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of vectors, and of normals."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ... import compat
from ..mapping import affine
from ..socket_value import own_value
from ..tree import NodeUse
from .builder import Value, constant, is_constant
from .colors import curve_table
from .folds import VECTOR_MATH
from .inputs import normal
from .reader import Reader


def _vector_math(use: NodeUse, _output: Any, p: Reader) -> Value | None:
    name = VECTOR_MATH.get(use.node.operation)
    return None if name is None else p(name, *p.inputs(use))


def _vector_curve(use: NodeUse, _output: Any, p: Reader) -> Value:
    return p("curves", p.read(use, 0), p.read(use, 1), **curve_table(use.node.mapping, [0, 1, 2], 3))


def _mapping(use: NodeUse, _output: Any, p: Reader) -> Value:
    kind = use.node.vector_type
    vector = p.read(use, "Vector")
    moves = kind in {"POINT", "TEXTURE"}
    rest = [p.read(use, name) for name in ((("Location",) if moves else ()) + ("Rotation", "Scale"))]
    if all(map(is_constant, rest)):
        location = rest[0] if moves else (0.0, 0.0, 0.0)
        return p.mapped(vector, affine(kind, location, *rest[-2:]))
    return p(f"mapping-{kind.lower()}", vector, *rest)


AXES = {"X_AXIS": (1.0, 0.0, 0.0), "Y_AXIS": (0.0, 1.0, 0.0), "Z_AXIS": (0.0, 0.0, 1.0)}


def _vector_rotate(use: NodeUse, _output: Any, p: Reader) -> Value:
    kind = use.node.rotation_type
    invert = {"invert": True} if use.node.invert else {}
    vector, center = p.read(use, "Vector"), p.read(use, "Center")
    if kind == "EULER_XYZ":
        return p("vector-rotate-euler", vector, center, p.read(use, "Rotation"), **invert)
    axis = p.read(use, "Axis") if kind == "AXIS_ANGLE" else AXES[kind]
    return p("vector-rotate-axis", vector, center, axis, p.read(use, "Angle"), **invert)


def _vector_transform(use: NodeUse, _output: Any, p: Reader) -> Value:
    node = use.node
    parameters = {"type": node.vector_type.lower(), "from": node.convert_from.lower(), "to": node.convert_to.lower()}
    return p("vector-transform", p.read(use, "Vector"), **parameters, version=compat.CYCLES)


def _normal(use: NodeUse, output: Any, p: Reader) -> Value:
    direction = constant(own_value(use, use.node.outputs[0]), "vector")
    if output.name == "Normal":
        return direction
    given = p("vector-normalize", p.read(use, 0))
    return p("vector-dot", p("vector-normalize", direction), given)


SPACES = {
    "TANGENT": ("tangent", {}),
    "OBJECT": ("object", {}),
    "WORLD": ("world", {}),
    "BLENDER_OBJECT": ("object", {"flip": True}),
    "BLENDER_WORLD": ("world", {"flip": True}),
}


def _normal_map(use: NodeUse, _output: Any, p: Reader) -> Value:
    node = use.node
    space, flip = SPACES[node.space]
    parameters: dict[str, Any] = {"version": compat.NORMAL_MAP, **flip}
    if getattr(node, "convention", "OPENGL") == "DIRECTX":
        parameters["invertGreen"] = True
    if space == "tangent" and node.uv_map:
        parameters["set"] = node.uv_map
    return p(f"normal-map-{space}", p.read(use, "Color"), p.read(use, "Strength"), **parameters)


def _heights(p: Reader, width: float, height: Callable[[], Value]) -> list[Value]:
    """Here, and a step of a pixel's width aside."""
    before = p.shift
    heights = []
    for direction in ("none", "x", "y"):
        p.shift = (direction, width)
        heights.append(height())
    p.shift = before
    return heights


def bend_by_displacement(output: NodeUse, p: Reader) -> None:
    """What Cycles makes of a displacement where it moves nothing: a bump of the surface's own normal, as high as it reaches along that."""
    own, width = p("normal"), compat.DISPLACEMENT_WIDTH
    heights = _heights(p, width, lambda: p("vector-dot", p.read(output, "Displacement"), own))
    if len(set(heights)) > 1 or compat.CYCLES == 3:  # 3.4 turns it towards the viewer, too
        p.bend(p("bump", *heights, 1.0, 1.0, own, width=width, version=compat.CYCLES))


def _displacement(use: NodeUse, _output: Any, p: Reader) -> Value:
    along = normal(use, p)
    height = p("subtract", p.read(use, "Height"), p.read(use, "Midlevel"))
    height = p.multiply(height, p.read(use, "Scale"))
    if use.node.space != "OBJECT":
        return p.multiply(along, height)
    spaces = {"from": "world", "to": "object"}
    along = p("vector-transform", along, type="normal", **spaces, version=max(compat.CYCLES, 4))
    return _moved_to_world(p, p.multiply(along, height))


def _vector_displacement(use: NodeUse, _output: Any, p: Reader) -> Value:
    midlevel = p.vector(p.read(use, "Midlevel"))
    moved = p.multiply(p("vector-subtract", p.read(use, "Vector"), midlevel), p.read(use, "Scale"))
    if use.node.space == "TANGENT":
        return p("vector-displacement", moved)
    return _moved_to_world(p, moved) if use.node.space == "OBJECT" else moved


def _moved_to_world(p: Reader, moved: Value) -> Value:
    return p("vector-transform", moved, type="vector", **{"from": "object", "to": "world"}, version=compat.CYCLES)


def _bump(use: NodeUse, _output: Any, p: Reader) -> Value:
    """Without a height it hands on its normal."""
    given = normal(use, p)
    if not use.is_linked("Height"):
        return given
    width = p.number(use, "Filter Width") if use.has("Filter Width") else 1.0
    heights = _heights(p, width, lambda: p.read(use, "Height"))
    distance = p.read(use, "Distance")
    if use.node.invert:
        distance = p("multiply", distance, -1.0)
    return p("bump", *heights, distance, p.read(use, "Strength"), given, width=width, version=compat.CYCLES)


NODES = {
    "VectorMath": _vector_math,
    "VectorCurve": _vector_curve,
    "Mapping": _mapping,
    "VectorRotate": _vector_rotate,
    "VectorTransform": _vector_transform,
    "Normal": _normal,
    "NormalMap": _normal_map,
    "Bump": _bump,
    "Displacement": _displacement,
    "VectorDisplacement": _vector_displacement,
}
