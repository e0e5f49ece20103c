# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in for a node that has no counterpart here: the value nearest to what it gives on the whole, and its name in words.

Never black or half where that is not its mean: a surface keeps its colour, a lamp its power, a sky its light.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .attribute import mean_color
from .read import read, read_number
from .sky import mean_radiance
from .tree import NodeUse
from .value import Value, calculator, constant

Neutral = tuple[Value, str]


def _number(value: float) -> Callable[[NodeUse, Any], Neutral]:
    return lambda _use, _output: (constant(value), f"{value:g}")


def _its_mean(value: float) -> Callable[[NodeUse, Any], Neutral]:
    return lambda _use, _output: (constant(value), f"its mean, {value:g},")


def _outputs(default: float, **values: float) -> Callable[[NodeUse, Any], Neutral]:
    """By the output's name, with _ for a space."""
    by_name = {name.replace("_", " "): value for name, value in values.items()}

    def neutral(_use: NodeUse, output: Any) -> Neutral:
        value = by_name.get(output.name, default)
        return constant(value), f"{value:g} as its {output.name}"

    return neutral


def _input(name: str) -> Callable[[NodeUse, Any], Neutral]:
    """An input that it hands on, changed in a way that has no counterpart."""
    return lambda use, _output: (read(use, name), f"its {name}")


def _ambient_occlusion(use: NodeUse, output: Any) -> Neutral:
    if output.name == "Color":
        return read(use, "Color"), "its Color, not occluded,"
    return constant(1.0), "1, not occluded,"


def _checker(use: NodeUse, output: Any) -> Neutral:
    if output.name != "Color":
        return constant(0.5), "its mean, 0.5,"
    return _mean(use, read(use, "Color1"), read(use, "Color2")), "the mean of its colours"


def _attribute(use: NodeUse, output: Any) -> Neutral:
    node = use.node
    if node.bl_idname == "ShaderNodeVertexColor":
        color = mean_color(node.layer_name)
    else:
        color = mean_color(node.attribute_name) if node.attribute_type == "GEOMETRY" else None
    if color is None or output.name == "Alpha":
        return constant(1.0), f"1 as its {output.name}"
    mean = Value(color)
    if output.type == "VALUE":
        mean = calculator(use).apply("mean", lambda x: np.repeat(x.mean(-1, keepdims=True), 3, -1), mean)
    return mean, "the mean of the attribute"


def _brick(use: NodeUse, output: Any) -> Neutral:
    width, height = (abs(read_number(use, name)) for name in ("Brick Width", "Row Height"))
    gap = 2.0 * read_number(use, "Mortar Size")
    bricks = max(0.0, 1.0 - gap / width) * max(0.0, 1.0 - gap / height) if width and height else 0.0
    if output.name != "Color":
        return constant(1.0 - bricks), "its mean"
    of_bricks = _mean(use, read(use, "Color1"), read(use, "Color2"))
    return _mean(use, of_bricks, read(use, "Mortar"), 1.0 - bricks), "the mean of its colours"


def _mean(use: NodeUse, a: Value, b: Value, share_of_b: float = 0.5) -> Value:
    calc = calculator(use)
    return calc.add(calc.multiply(a, constant(1.0 - share_of_b)), calc.multiply(b, constant(share_of_b)))


def _fresnel(use: NodeUse, _output: Any) -> Neutral:
    return constant(_reflectance(max(read_number(use, "IOR"), 1e-5))), "what it is seen straight on"


def _layer_weight(use: NodeUse, output: Any) -> Neutral:
    if output.name == "Facing":
        return constant(0.0), "what it is seen straight on, 0,"
    return constant(_reflectance(1.0 / max(1.0 - read_number(use, "Blend"), 1e-5))), "what it is seen straight on"


def _reflectance(ior: float) -> float:
    return ((ior - 1.0) / (ior + 1.0)) ** 2


def _light_path(use: NodeUse, output: Any) -> Neutral:
    """What the camera sees of a surface, and what surfaces see of a light; of a world, what is not known of its ray."""
    value = 1.0 if output.name == "Is Camera Ray" and use.owner.kind == "material" else 0.0
    return constant(value), f"{value:g} as its {output.name}"


def _object_info(use: NodeUse, output: Any) -> Neutral:
    values = {"Color": 1.0, "Alpha": 1.0, "Random": 0.5}
    value = values.get(output.name, 0.0)
    return constant(value), f"{value:g} as its {output.name}"


def _noise(use: NodeUse, output: Any) -> Neutral:
    """From 0 to 1, or on both sides of 0 where it is not normalized."""
    return _its_mean(0.5 if getattr(use.node, "normalize", True) else 0.0)(use, output)


def _light_falloff(use: NodeUse, output: Any) -> Neutral:
    return read(use, "Strength"), f"its strength, as for Quadratic, instead of {output.name}"


def _sky(use: NodeUse, _output: Any) -> Neutral:
    return constant(mean_radiance(use.node)), "the mean of its light over all directions"


NEUTRAL: dict[str, Callable[[NodeUse, Any], Neutral]] = {
    "ShaderNodeAmbientOcclusion": _ambient_occlusion,
    "ShaderNodeAttribute": _attribute,
    "ShaderNodeVertexColor": _attribute,
    "ShaderNodeBevel": _number(0.0),
    "ShaderNodeBump": _number(0.0),
    "ShaderNodeNormalMap": _number(0.0),
    "ShaderNodeNormal": _outputs(0.0, Dot=0.5),
    "ShaderNodeTangent": _number(0.0),
    "ShaderNodeCameraData": _outputs(1.0, View_Vector=0.0),
    "ShaderNodeDisplacement": _number(0.0),
    "ShaderNodeVectorDisplacement": _number(0.0),
    "ShaderNodeFresnel": _fresnel,
    "ShaderNodeLayerWeight": _layer_weight,
    "ShaderNodeNewGeometry": _outputs(0.0, Pointiness=0.5, Random_Per_Island=0.5),
    "ShaderNodeHairInfo": _outputs(0.0, Intercept=0.5, Random=0.5),
    "ShaderNodeParticleInfo": _outputs(0.0, Random=0.5),
    "ShaderNodePointInfo": _outputs(0.0, Random=0.5),
    "ShaderNodeVolumeInfo": _number(0.0),
    "ShaderNodeLightFalloff": _light_falloff,
    "ShaderNodeLightPath": _light_path,
    "ShaderNodeObjectInfo": _object_info,
    "ShaderNodeTexCoord": _outputs(0.0, Generated=0.5, UV=0.5, Window=0.5),
    "ShaderNodeUVMap": _number(0.5),
    "ShaderNodeRadialTiling": _number(0.5),
    "ShaderNodeRaycast": _number(0.0),
    "ShaderNodeTexBrick": _brick,
    "ShaderNodeTexChecker": _checker,
    "ShaderNodeTexGabor": _its_mean(0.5),
    "ShaderNodeTexGradient": _its_mean(0.5),
    "ShaderNodeTexIES": _input("Strength"),
    "ShaderNodeTexMagic": _its_mean(0.5),
    "ShaderNodeTexMusgrave": _its_mean(0.0),
    "ShaderNodeTexNoise": _noise,
    "ShaderNodeTexPointDensity": _number(0.0),
    "ShaderNodeTexSky": _sky,
    "ShaderNodeTexVoronoi": _outputs(0.5, Position=0.0, W=0.0),
    "ShaderNodeTexWave": _its_mean(0.5),
    "ShaderNodeTexWhiteNoise": _its_mean(0.5),
    "ShaderNodeMapping": _input("Vector"),
    "ShaderNodeVectorRotate": _input("Vector"),
    "ShaderNodeVectorTransform": _input("Vector"),
    "ShaderNodeVectorCurve": _input("Vector"),
    "ShaderNodeWireframe": _number(0.0),
}
