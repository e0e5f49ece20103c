# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes tell in worlds and lamps, where there is no surface, as far as that is another thing there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from mathutils import Matrix

from ... import compat
from ..attribute import object_attribute
from ..tree import NodeUse
from .builder import Value, is_zero
from .inputs import ATTRIBUTE_PREFIX, THIRD
from .reader import NOWHERE, Reader

Answer = Value | Callable[[NodeUse, Reader], Value | None]
NOT_A_NUMBER = "is not a number in Cycles of this Blender, which shows black; 0 is used instead"


def elsewhere(use: NodeUse, output: Any, p: Reader) -> Value | None:
    """None: as on surfaces."""
    if p.kind == "material":
        return None
    place = (use.node.bl_idname.removeprefix("ShaderNode"), output.name)
    if place[0] == "Attribute":
        return _attribute(use, output, p)
    answer = OF_BOTH.get(place)
    if answer is None:
        answer = (OF_WORLDS if p.kind == "world" else OF_LAMPS).get(place)
    return answer(use, p) if callable(answer) else answer


def _attribute(use: NodeUse, output: Any, p: Reader) -> Value:
    """There is no mesh; a world, and a lamp before it was an object, have no object either."""
    owners = {"layer:": use.owner.context.layer}
    if p.lamp is not None and compat.CYCLES >= 5:
        owners |= p.lamp.object.owners
    prefix = ATTRIBUTE_PREFIX.get(use.node.attribute_type, "")
    found = (0.0, 0.0, 0.0, 1.0)
    if prefix in owners:
        found = object_attribute(prefix + use.node.attribute_name, owners)
    r, g, b, alpha = found
    if output.name == "Alpha":
        return alpha
    return _mean(r, g, b) if output.type == "VALUE" else (r, g, b)


def _mean(r: float, g: float, b: float) -> float:
    """To the last bit."""
    mean = (np.float32(r) + np.float32(g) + np.float32(b)) * np.float32(THIRD)
    return float(mean * np.float32(3) * np.float32(THIRD) if compat.NUMBERS_ARE_MEANS else mean)


def _tangent_of_geometry(use: NodeUse, p: Reader) -> Value:
    if p.kind == "world" and compat.CYCLES >= 5:
        return p("vector-normalize", p("vector-cross", (1.0, 1.0, 1.0), p("normal")))
    use.note(f"has a Tangent that {NOT_A_NUMBER}")
    return NOWHERE


def _tangent(use: NodeUse, p: Reader) -> Value | None:
    """Around an axis, by the position; on a lamp turned as the lamp is."""
    if use.node.direction_type == "UV_MAP":
        return NOWHERE
    if compat.CYCLES < 4:
        use.note("has a direction that is arbitrary in Cycles of this Blender; 0 is used instead")
        return NOWHERE
    if p.kind == "world":
        return None
    assert p.lamp is not None
    turned = p.mapped(p("position"), [p.lamp.normals @ ABOUT[use.node.axis]])
    return p("vector-cross", p("normal"), p("vector-normalize", p("vector-cross", turned, p("normal"))))


# from a position to the tangent around an axis through (1/2, 1/2, 1/2)
ABOUT = {
    "X": Matrix(((0, 0, 0, 0), (0, 0, -1, 0.5), (0, 1, 0, -0.5), (0, 0, 0, 1))),
    "Y": Matrix(((0, 0, -1, 0.5), (0, 0, 0, 0), (1, 0, 0, -0.5), (0, 0, 0, 1))),
    "Z": Matrix(((0, -1, 0, 0.5), (1, 0, 0, -0.5), (0, 0, 0, 0), (0, 0, 0, 1))),
}


def _ray_depth(use: NodeUse, _p: Reader) -> Value | None:
    if use.owner.ray == "camera":
        return 1.0
    use.note(
        "tells one more in Cycles where a ray of a surface finds the world than where the world is aimed at; "
        "the Ray Depth of the latter is used"
    )
    return None


def _falloff(_use: NodeUse, _p: Reader) -> Value | None:
    """The way to a world was no way."""
    return 0.0 if compat.CYCLES < 5 else None


def _falloff_of_lamp(use: NodeUse, p: Reader) -> Value | None:
    """The way to a sun was the largest of all numbers."""
    assert p.lamp is not None
    if p.lamp.type != "SUN" or compat.CYCLES != 4:
        return None
    use.note(NOT_A_NUMBER)
    return 0.0


def _parametric(use: NodeUse, p: Reader) -> Value | None:
    assert p.lamp is not None
    if p.lamp.type != "SUN" or compat.CYCLES >= 4:
        return None
    use.note("tells random numbers of a sun in Cycles of this Blender; their mean is used instead")
    return (0.0, 0.5, 0.0)


def _quadratic(use: NodeUse, p: Reader) -> Value | None:
    return None if is_zero(p.read(use, "Smooth")) else _falloff(use, p)


def _camera(_use: NodeUse, p: Reader) -> Value | None:
    """Lamps were no objects: a position was taken for a direction from the camera."""
    if compat.CYCLES >= 5:
        return None
    parameters = {"type": "vector", "from": "world", "to": "camera"}
    return p("vector-transform", p("position"), **parameters, version=compat.CYCLES)


def _window(use: NodeUse, _p: Reader) -> Value | None:
    if compat.CYCLES < 5:
        use.note(
            "takes a place on a lamp for a direction in Cycles of this Blender; where the camera sees it is used instead"
        )
    return None


def _reflection(_use: NodeUse, p: Reader) -> Value | None:
    return p("incoming") if compat.CYCLES < 5 else None


def _normal(_use: NodeUse, p: Reader) -> Value | None:
    """In the space of a spot as it stands; its round cone has another one."""
    assert p.lamp is not None
    if p.lamp.type != "SPOT" or compat.CYCLES >= 4:
        return None
    return p("vector-normalize", p.mapped(p("normal"), [p.lamp.normals.inverted_safe()]))


def _transform(use: NodeUse, p: Reader) -> Value | None:
    """Lamps had no space, and then one that was arbitrary."""
    node = use.node
    if compat.CYCLES >= 5 or "OBJECT" not in {node.convert_from, node.convert_to}:
        return None
    if compat.CYCLES == 4:
        use.note("takes an arbitrary space for a lamp's in Cycles of this Blender; its own is used instead")
        return None
    spaces = [space.lower().replace("object", "world") for space in (node.convert_from, node.convert_to)]
    parameters = {"type": node.vector_type.lower(), "from": spaces[0], "to": spaces[1]}
    return p("vector-transform", p.read(use, "Vector"), **parameters, version=compat.CYCLES)


def _of_object(name: str) -> Callable[[NodeUse, Reader], Value | None]:
    """Since lamps are objects, what Object Info tells of them."""

    def read(_use: NodeUse, p: Reader) -> Value | None:
        assert p.lamp is not None
        return getattr(p.lamp.object, name) if compat.CYCLES >= 5 else None

    return read


def _location(_use: NodeUse, _p: Reader) -> Value | None:
    return NOWHERE if compat.CYCLES < 5 else None


def _random(_use: NodeUse, p: Reader) -> Value:
    assert p.lamp is not None
    return p.lamp.object.random


OF_BOTH: dict[tuple[str, str], Answer] = {
    ("NewGeometry", "Tangent"): _tangent_of_geometry,
    ("NewGeometry", "Pointiness"): 0.0,
    ("NewGeometry", "Random Per Island"): 0.0,
    ("Tangent", "Tangent"): _tangent,
    ("PointInfo", "Position"): NOWHERE,
    ("PointInfo", "Radius"): 0.0,
}
OF_WORLDS: dict[tuple[str, str], Answer] = {
    ("NewGeometry", "Parametric"): (1.0, 0.0, 0.0),
    ("LightPath", "Ray Depth"): _ray_depth,
    ("LightFalloff", "Quadratic"): _quadratic,
    ("LightFalloff", "Linear"): _falloff,
    ("LightFalloff", "Constant"): _falloff,
}
OF_LAMPS: dict[tuple[str, str], Answer] = {
    ("NewGeometry", "Parametric"): _parametric,
    ("LightFalloff", "Linear"): _falloff_of_lamp,
    ("LightFalloff", "Constant"): _falloff_of_lamp,
    ("TexCoord", "Camera"): _camera,
    ("TexCoord", "Window"): _window,
    ("TexCoord", "Reflection"): _reflection,
    ("TexCoord", "Normal"): _normal,
    ("VectorTransform", "Vector"): _transform,
    ("ObjectInfo", "Location"): _location,
    ("ObjectInfo", "Color"): _of_object("color"),
    ("ObjectInfo", "Alpha"): _of_object("alpha"),
    ("ObjectInfo", "Object Index"): _of_object("index"),
    ("ObjectInfo", "Random"): _random,
}
