# SPDX-License-Identifier: GPL-3.0-or-later
"""Sky Texture nodes: tables of what Cycles makes of them (measured_sky.py), looked up by direction."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..image import Pixels
from ..mapping import own_mapping
from ..measured_sky import COLUMNS, DISC, ROWS, MeasuredSky, NotMeasured, measured
from ..sky import mean_radiance
from ..tree import NodeUse
from .builder import Result, Value, constant
from .reader import Reader


def _sky(use: NodeUse, _output: Any, p: Reader) -> Value:
    node = use.node
    try:
        found = measured(node, use.owner.context)
    except NotMeasured as why:
        use.note(f"could not be evaluated: {why}; the mean of its light over all directions is used instead")
        return mean_radiance(node)
    given = use.has("Vector") and use.node.inputs["Vector"].enabled  # with a sun's disc there are no coordinates
    vector = p.read(use, "Vector", lambda: p.place("generated")) if given else p.place("generated")
    vector = p.mapped(vector, own_mapping(node.texture_mapping))
    sky = _looked_up(use, p, f"{node.name}", found.sky, "REPEAT", _place(p, vector))
    if found.disc is None or not p.discs:
        return sky
    matrix = linear(p, vector)
    turns = matrix is not None and bool(np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-5))
    p.suns.append((found.axes[2] @ matrix if turns and matrix is not None else None, found.size))
    return p.add(sky, _disc(use, p, found, vector))


def _looked_up(use: NodeUse, p: Reader, name: str, pixels: np.ndarray, extension: str, place: Value) -> Value:
    known = f"{name} {hash(pixels.tobytes())} {pixels.shape}"
    image = Pixels(f"{name} (sky)", known, pixels.astype(np.float32))
    return p("image", place, texture=use.owner.context.texture(image, "Linear", extension))


def _place(p: Reader, vector: Value) -> Value:
    """In the table, as measured_sky.directions() has it: u over a full turn, v by the root of the height."""
    turn = p.multiply(p("atan2", p("y", vector), p("x", vector)), 0.5 / math.pi)
    height = p.multiply(p("asin", p("z", vector)), 2.0 / math.pi)
    root = p("multiply", p("sign", height), p("sqrt", p("absolute", height)))
    v = p("multiply-add", root, 0.5, 0.5)
    border = 0.5 / ROWS  # straight up and down there is no other side
    assert COLUMNS % 2 == 0
    return p("combine", turn, p("clamp", v, border, 1.0 - border), 0.0)


def _disc(use: NodeUse, p: Reader, found: MeasuredSky, vector: Value) -> Value:
    """What the sun's disc adds: black outside it."""
    assert found.disc is not None
    right, up, sun = (constant(axis, "vector") for axis in found.axes)
    forward = p("vector-dot", vector, sun)
    scale = 1.0 / math.tan(found.size / 2.0)
    x, y = (p.multiply(p("divide", p("vector-dot", vector, axis), forward), scale) for axis in (right, up))
    squared = p("multiply-add", x, x, p("multiply", y, y))
    rim = 1.0 + 1.0 / DISC**2
    inside = p("multiply", p("less-than", squared, rim), p("greater-than", forward, 0.0))
    place = p("combine", p("multiply-add", x, 0.5, 0.5), p("multiply-add", y, 0.5, 0.5), 0.0)
    return p.multiply(_looked_up(use, p, f"{use.node.name} sun", found.disc, "EXTEND", place), inside)


def linear(p: Reader, vector: Value) -> np.ndarray | None:
    """The matrix, (3, 3), by which the vector looks where a world's direction does, if there is one. Its length means nothing."""
    if not isinstance(vector, Result):
        return None
    operation = p.operations[vector.index]
    if operation.name == "direction":
        return np.eye(3)
    if operation.name not in {"mapping", "vector-normalize"}:
        return None
    before = linear(p, operation.arguments[0])
    if before is None or operation.name == "vector-normalize":
        return before
    matrix = np.array(dict(operation.parameters)["matrix"]).reshape(3, 4)
    return None if matrix[:, 3].any() else np.asarray(matrix[:, :3] @ before)


NODES = {"TexSky": _sky}
