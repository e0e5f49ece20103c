# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that tell where the program runs: of the surface, the object, the camera, the path."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np

from ... import compat
from .. import unrolled
from ..attribute import (
    CENTER,
    DEFAULT_COLOR,
    DIAMETER,
    INTERCEPT,
    LENGTH,
    POINT_RANDOM,
    RADIUS,
    RANDOM,
    STRAND,
)
from ..socket_value import own_value
from ..tree import NodeUse
from .attribute_names import ALL as NAMES_OF_CYCLES
from .attribute_names import known_as, place_of
from .builder import Value, constant, is_zero
from .reader import Reader, kind_of_socket


def _own(use: NodeUse, output: Any, p: Reader) -> Value:
    return constant(own_value(use, output), kind_of_socket(output.type))


def _of_node(name: str) -> Any:
    """What a node holds as its own setting."""

    def function(use: NodeUse, _output: Any, _p: Reader) -> Value:
        value = getattr(use.node, name)
        return float(value) if isinstance(value, bool | int) else tuple(value)  # type: ignore[return-value]

    return function


def _menu(use: NodeUse, output: Any, _p: Reader) -> Value | None:
    """Whether an item is the chosen one; what that hands on is read elsewhere (tree.py)."""
    chosen = unrolled.chosen(use)
    return None if chosen is None or output.identifier == "Output" else float(output.name == chosen)


def _iteration(use: NodeUse, _output: Any, _p: Reader) -> Value:
    return float(use.entered[-1].iteration)


def _scene_time(use: NodeUse, output: Any, _p: Reader) -> Value:
    scene = use.owner.context.layer[1]
    frame = scene.frame_current + scene.frame_subframe
    return frame if output.name == "Frame" else frame * scene.render.fps_base / scene.render.fps


SHIFTED = {"position", "uv", "generated", "object", "camera", "window", "parametric"}


def _by_output(names: dict[str, str]) -> Any:
    """Output -> operation."""

    def read(_use: NodeUse, output: Any, p: Reader) -> Value | None:
        name = names.get(output.name)
        return None if name is None else p.place(name) if name in SHIFTED else p(name)

    return read


def _coordinates(use: NodeUse, output: Any, p: Reader) -> Value | None:
    if use.node.from_instancer and output.name in {"Generated", "UV"} and p.kind != "world":
        return _of_instancer(use, output, p)
    if output.name == "Object" and use.node.object is not None:
        return p.mapped(p.place("position"), [use.node.object.matrix_world.inverted_safe()])
    return _by_output(COORDINATES)(use, output, p)  # type: ignore[no-any-return]


COORDINATES = {
    "Generated": "generated",
    "Normal": "object-normal",
    "UV": "uv",
    "Object": "object",
    "Camera": "camera",
    "Window": "window",
    "Reflection": "reflection",
}


def _uv_map(use: NodeUse, output: Any, p: Reader) -> Value:
    if use.node.from_instancer:
        return _of_instancer(use, output, p)
    return p.place("uv", **_set(use.node.uv_map))


def _of_instancer(use: NodeUse, output: Any, p: Reader) -> Value:
    if p.kind == "light":
        use.note(f"takes its {output.name} from what brings the lamp, which is not supported; 0 is used instead")
    return p.place("attribute", name=f"instance:{output.name}")


def _set(name: str) -> dict[str, str]:
    return {"set": name} if name else {}


def _tangent(use: NodeUse, _output: Any, p: Reader) -> Value:
    if use.node.direction_type == "UV_MAP":
        return p("tangent-uv", **_set(use.node.uv_map))
    return p("tangent", axis=use.node.axis.lower())


THIRD = float(np.float32(1 / 3))  # by which Cycles takes a mean of three
# where attributes of other things than geometry are kept, on the node of the object
ATTRIBUTE_PREFIX = {"OBJECT": "object:", "INSTANCER": "instancer:", "VIEW_LAYER": "layer:"}


def _attribute(use: NodeUse, output: Any, p: Reader) -> Value:
    name, kind = use.node.attribute_name, use.node.attribute_type
    if kind != "GEOMETRY":
        return _attribute_output(ATTRIBUTE_PREFIX[kind] + name, output, p)
    place = place_of(name, output, p)
    return _attribute_output(known_as(use, name), output, p) if place is None else place


def _vertex_color(use: NodeUse, output: Any, p: Reader) -> Value:
    name = use.node.layer_name
    if name in NAMES_OF_CYCLES:  # it finds neither Cycles' nor the user's
        return 0.0 if output.name == "Alpha" else (0.0, 0.0, 0.0)
    return _attribute_output(name or DEFAULT_COLOR, output, p)


def _attribute_output(name: str, output: Any, p: Reader) -> Value:
    if output.name == "Alpha":
        return p.place("attribute-alpha", name=name)
    return attribute_number(p, name) if output.type == "VALUE" else p.place("attribute", name=name)


def attribute_number(p: Reader, name: str) -> Value:
    """To the last bit, which white noise shows."""
    number = p.place("attribute-number", name=name)
    return p.multiply(p.multiply(number, 3.0), THIRD) if compat.NUMBERS_ARE_MEANS else number


def _geometry(use: NodeUse, output: Any, p: Reader) -> Value | None:
    return _by_output(GEOMETRY)(use, output, p)  # type: ignore[no-any-return]


GEOMETRY = {
    "Position": "position",
    "Normal": "normal",
    "Tangent": "tangent",
    "True Normal": "true-normal",
    "Incoming": "incoming",
    "Parametric": "parametric",
    "Backfacing": "backfacing",
}
OBJECT = {
    "Location": "object-location",
    "Color": "object-color",
    "Alpha": "object-alpha",
    "Object Index": "object-index",
    "Material Index": "material-index",
    "Random": "object-random",
}
LIGHT_PATH = {
    "Is Camera Ray": "is-camera-ray",
    "Is Shadow Ray": "is-shadow-ray",
    "Is Diffuse Ray": "is-diffuse-ray",
    "Is Glossy Ray": "is-glossy-ray",
    "Is Singular Ray": "is-singular-ray",
    "Is Reflection Ray": "is-reflection-ray",
    "Is Transmission Ray": "is-transmission-ray",
    "Ray Length": "ray-length",
    "Ray Depth": "ray-depth",
    "Diffuse Depth": "diffuse-depth",
    "Glossy Depth": "glossy-depth",
    "Transparent Depth": "transparent-depth",
    "Transmission Depth": "transmission-depth",
}


# the kinds of ray for which they are 1; what glass lets pass is glossy, too
OF_KIND = {
    "is-camera-ray": {"camera"},
    "is-diffuse-ray": {"diffuse"},
    "is-glossy-ray": {"glossy", "transmission"},
    "is-reflection-ray": {"diffuse", "glossy"},
    "is-transmission-ray": {"transmission"},
}


def _light_path(use: NodeUse, output: Any, p: Reader) -> Value | None:
    """Of a world as its kind of ray sees it; of a light, which is looked at for rays of all kinds at once, as Cycles does."""
    name = LIGHT_PATH.get(output.name)
    if name is None or use.owner.kind == "material" or name == "ray-depth":
        return None if name is None else p(name)
    ray = use.owner.ray
    if name == "ray-length":
        return 0.0 if use.owner.kind == "world" and compat.CYCLES < 5 else p(name)
    if name.endswith("-depth"):
        if ray != "camera":
            use.note(f"is not supported as a colour or number; 0 as its {output.name} is used instead")
        return 0.0
    return float(ray in OF_KIND.get(name, ()))


def _object_info(use: NodeUse, output: Any, p: Reader) -> Value | None:
    if use.owner.kind == "world":
        return constant(0.0, kind_of_socket(output.type))
    return _by_output(OBJECT)(use, output, p)  # type: ignore[no-any-return]


CURVES = {"Is Strand": STRAND, "Intercept": INTERCEPT, "Length": LENGTH, "Thickness": DIAMETER, "Random": RANDOM}


def _curves_info(_use: NodeUse, output: Any, p: Reader) -> Value | None:
    """0 where there is no curve."""
    name = CURVES.get(output.name)
    if name in {STRAND, DIAMETER}:  # no attributes to Cycles
        return p.place("attribute-number", name=name)
    return None if name is None else attribute_number(p, name)


def _point_info(_use: NodeUse, output: Any, p: Reader) -> Value | None:
    if output.name == "Random":
        return attribute_number(p, POINT_RANDOM)
    if output.name == "Position":
        return _of_object(p, p.place("attribute", name=CENTER), "point")
    if output.name != "Radius":
        return None
    share = p.multiply(p.place("attribute-number", name=RADIUS), 1.0 / math.sqrt(3.0))  # along each axis
    return p("vector-length", _of_object(p, p("combine", share, share, share), "vector"))


def _of_object(p: Reader, vector: Value, kind: str) -> Value:
    """In the world."""
    parameters = {"type": kind, "from": "object", "to": "world"}
    return p("vector-transform", vector, **parameters, version=compat.CYCLES)


CAMERA = {"View Vector": "view-vector", "View Z Depth": "view-depth", "View Distance": "view-distance"}


def normal(use: NodeUse, p: Reader, name: str = "Normal") -> Value:
    """The shading normal where nothing is linked."""
    return p.read(use, name, lambda: p("normal"))


def _fresnel(use: NodeUse, _output: Any, p: Reader) -> Value:
    return p("fresnel", p.read(use, "IOR"), normal(use, p))


def _layer_weight(use: NodeUse, output: Any, p: Reader) -> Value:
    return p(f"layer-weight-{output.name.lower()}", p.read(use, "Blend"), normal(use, p))


def _light_falloff(use: NodeUse, output: Any, p: Reader) -> Value:
    strength, smooth = p.read(use, "Strength"), p.read(use, "Smooth")
    if output.name == "Quadratic" and is_zero(smooth):  # what light does anyway
        return strength
    return p(f"light-falloff-{output.name.lower()}", strength, smooth, version=compat.CYCLES)


WITHOUT_IES = 100.0  # what Cycles has instead of a file
MOST_OF_IES = 1 << 20  # bytes, within which the first keyword stands


def _has_ies_file(node: Any) -> bool:
    """Whether an IES node has what Cycles reads as a file."""
    if node.mode == "INTERNAL":
        text = "" if node.ies is None else node.ies.as_string()
    else:
        try:
            with open(bpy.path.abspath(node.filepath), encoding="latin-1") as file:
                text = file.read(MOST_OF_IES)
        except OSError:
            text = ""
    return "\nTILT=" in text


def _ies(use: NodeUse, _output: Any, p: Reader) -> Value | None:
    """None: what a file says is not supported."""
    if _has_ies_file(use.node):
        return None
    use.note("has no IES file; its strength counts a hundredfold, as in Cycles")
    return p.multiply(p.read(use, "Strength"), WITHOUT_IES)


def _bevel(use: NodeUse, _output: Any, p: Reader) -> Value:
    use.note("is not supported; the surface's own normal is used instead")
    return normal(use, p)


def _ambient_occlusion(use: NodeUse, output: Any, p: Reader) -> Value:
    use.note("is not supported as a colour or number; what is not occluded is used instead")
    return p.read(use, "Color") if output.name == "Color" else 1.0


NODES = {
    "RGB": _own,
    "Value": _own,
    "TexCoord": _coordinates,
    "UVMap": _uv_map,
    "Tangent": _tangent,
    "Attribute": _attribute,
    "VertexColor": _vertex_color,
    "NewGeometry": _geometry,
    "ObjectInfo": _object_info,
    "LightPath": _light_path,
    "CameraData": _by_output(CAMERA),
    "HairInfo": _curves_info,
    "PointInfo": _point_info,
    "Fresnel": _fresnel,
    "LayerWeight": _layer_weight,
    "LightFalloff": _light_falloff,
    "TexIES": _ies,
    "Bevel": _bevel,
    "AmbientOcclusion": _ambient_occlusion,
}
# of other kinds of trees, since Blender 5
SHARED = {
    "FunctionNodeInputBool": _of_node("boolean"),
    "FunctionNodeInputInt": _of_node("integer"),
    "FunctionNodeInputVector": _of_node("vector"),
    "GeometryNodeMenuSwitch": _menu,
    "GeometryNodeRepeatInput": _iteration,
    "GeometryNodeInputSceneTime": _scene_time,
}
