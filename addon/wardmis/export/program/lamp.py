# SPDX-License-Identifier: GPL-3.0-or-later
"""What a lamp's nodes know of it, and where on it they are: Geometry's Parametric and, since Cycles 4, its UVs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mathutils import Matrix

from ... import compat
from .builder import Value

Coordinates = Callable[[Any], Value]  # of a Reader


@dataclass(frozen=True)
class LampObject:
    """What Object Info and Attribute tell of it."""

    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    alpha: float = 1.0
    index: float = 0.0
    random: float = 0.0
    owners: dict[str, tuple[Any, ...]] = field(default_factory=dict)  # of attributes, by how their names begin


@dataclass(frozen=True)
class Lamp:
    type: str
    coordinates: Coordinates
    normals: Matrix  # takes normals in its space to the world
    object: LampObject


def lamp_of(light: Any, matrix: np.ndarray, found: LampObject) -> Lamp:
    inverse = Matrix(matrix.tolist()).inverted_safe()
    return Lamp(light.type, coordinates(light, matrix), inverse.to_3x3().transposed().to_4x4(), found)


def coordinates(light: Any, matrix: np.ndarray) -> Coordinates:
    """`matrix`: of the lamp's object. (u, v, 0), from 0 to 1 over an area lamp, the cone of a spot, the disc of a sun, and all directions."""
    kind = light.type
    inverse = Matrix(matrix.tolist()).inverted_safe()
    directions = inverse.to_3x3().to_4x4()
    if kind == "AREA":
        return lambda p: p.mapped(p("position"), [_over(light) @ inverse])
    if compat.CYCLES < 4:
        return _of_old_sphere if kind in {"POINT", "SPOT"} else lambda _: (0.0, 0.0, 0.0)
    if kind == "POINT":
        return lambda p: p("combine", *_sphere(p, p.mapped(p("normal"), [directions])), 0.0)
    if kind == "SPOT":
        return lambda p: _cone(p, p.mapped(p("incoming"), [directions]), 0.5 / math.tan(light.spot_size / 2))
    return lambda p: _disc(p, p.mapped(p("incoming"), [directions]), light.angle / 2)


def sides(light: Any) -> tuple[float, float]:
    """Of an area lamp, in its own space."""
    return light.size, light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size


def _over(light: Any) -> Matrix:
    """From an area lamp's own space to its sides."""
    x, y = (1.0 / size if size > 0 else 0.0 for size in sides(light))
    return Matrix(((x, 0, 0, 0.5), (0, y, 0, 0.5), (0, 0, 0, 0), (0, 0, 0, 1)))


def _sphere(p: Any, direction: Value) -> tuple[Value, Value]:
    """As an image is wound around it."""
    unit = p("vector-normalize", direction)
    turn = p.multiply(p("atan2", p("x", unit), p("y", unit)), -0.5 / math.pi)
    height = p.multiply(p("acos", p("z", unit)), -1.0 / math.pi)
    return p.add(turn, 0.5), p.add(height, 1.0)


def _of_old_sphere(p: Any) -> Value:
    u, v = _sphere(p, p("incoming"))
    return p("combine", p.complement(p.add(u, v)), u, 0.0)


def _cone(p: Any, direction: Value, half_cotangent: float) -> Value:
    """`direction`: of the light."""
    scale = p("divide", -half_cotangent, p("z", direction))
    return _about_the_middle(p, direction, scale)


def _disc(p: Any, direction: Value, half_angle: float) -> Value:
    if half_angle == 0:
        return (0.5, 0.5, 0.0)
    beyond = p("vector-length", p("vector-subtract", direction, (0.0, 0.0, 1.0)))
    return _about_the_middle(p, direction, p("divide", -0.5 / math.sin(half_angle / 2), beyond))


def _about_the_middle(p: Any, direction: Value, scale: Value) -> Value:
    u, v = (p("multiply-add", p(axis, direction), scale, 0.5) for axis in ("x", "y"))
    return p("combine", u, v, 0.0)
