# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lights, in watts, -> radiance, intensity or irradiance as Cycles of the same version renders them.

Cycles before 4.0 normalised area lights by 1/4 where later ones use 1/pi, dimmed spots by the cosine to their axis, did not scale
their cones, and took a sun's disk for a flat one. Blender's scene unit scale does not enter.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from mathutils import Vector

from .. import compat
from .context import ExportContext, ExportError
from .model import LARGEST, LightData
from .program.closures import BLACK
from .program.emission import Light, emission
from .program.lamp import LampObject, lamp_of, sides
from .program.reader import Reader
from .socket_value import NotFinite
from .tree import Owner, output_use

SHEARED = 1e-3  # the cosine between an area light's sides, from which on they count as not orthogonal
WIDE = 1e-4  # a spread that is nearer to 180 degrees is none


@compat.deep_recursion()
def export_light(
    light: Any,
    name: str,
    matrix: np.ndarray,
    hidden_from: frozenset[str],
    context: ExportContext,
    found: LampObject | None = None,
) -> LightData | None:
    """None for a light that gives no light, and for Cycles' light portals, which are hints only. `found`: what its nodes may ask for."""
    if light.type == "AREA" and getattr(getattr(light, "cycles", None), "is_portal", False):
        return None
    nodes = _nodes(light, matrix, context, found or LampObject()) if compat.uses_nodes(light) else None
    node_factor = nodes.factor if nodes else (1.0, 1.0, 1.0)
    power = light.energy * compat.light_exposure(light)
    temperature = compat.light_temperature_color(light)
    color = tuple(c * t * n for c, t, n in zip(light.color, temperature, node_factor))
    if not (np.abs((power, *color, power * max(color))) <= LARGEST).all():
        raise ExportError(f"light '{light.name}': its power or colour is not a finite number; correct it")
    if power == 0 or not any(color):
        return None
    data = LightData(name, light.type.lower(), matrix, color, 0.0, hidden_from=hidden_from)
    data.shadow = compat.light_casts_shadow(light)
    data.max_bounces = compat.max_bounces(light)
    data.met = compat.light_is_met(light)
    if nodes:
        data.program, data.result = nodes.program, nodes.result
    {"AREA": _area, "POINT": _point, "SPOT": _spot, "SUN": _sun}[light.type](light, power, data, context)
    if math.isinf(data.emission):
        context.note(f"light '{light.name}': its area is zero, so that it gives no light; set a size or a scale")
        return None
    context.check_finite(data, f"light '{light.name}'")
    if data.emission == 0:
        context.note(f"light '{light.name}': a sun as wide as the sky gives no light in this Blender; lower its angle")
        return None
    return data


def _nodes(light: Any, matrix: np.ndarray, context: ExportContext, found: LampObject) -> Light:
    """What the light's nodes multiply the light by."""
    owner = Owner("light", f"light '{light.name}'", context)
    output = output_use(light.node_tree, "Surface", owner)
    p = Reader("light")
    p.lamp = lamp_of(light, matrix, found)
    try:
        if output is None or output.source("Surface").is_nothing:
            context.note(f"{owner.place}: no node is connected to its output; it gives no light")
        else:
            return Light(p, emission(p, output), owner)
    except RecursionError:
        context.note(f"{owner.place} has nodes that are linked in a circle, or in too long a chain; it gives no light")
    except NotFinite:
        pass  # noted where it was found
    return Light(p, BLACK, owner)


def _area(light: Any, power: float, data: LightData, context: ExportContext) -> None:
    data.shape = "ellipse" if light.shape in {"DISK", "ELLIPSE"} else "rectangle"
    data.size = sides(light)
    data.spread = light.spread
    x, y = data.matrix[:3, 0] * data.size[0], data.matrix[:3, 1] * data.size[1]
    shape = math.pi / 4 if data.shape == "ellipse" else 1.0
    area = float(np.linalg.norm(np.cross(x, y))) * shape
    if area == 0:
        data.emission = math.inf
        return
    if abs(float(x @ y)) > SHEARED * float(np.linalg.norm(x) * np.linalg.norm(y)) and _is_of_no_shape(data):
        context.note(
            f"light '{light.name}': its parents shear it, so that its axes are not at right angles; Cycles' picture is not that of "
            "this shape. Clear the shear to compare them"
        )
    # Cycles takes the axes for orthogonal, and what it so calls the area for that of the light
    power *= 1.0 if compat.light_is_normalized(light) else float(np.linalg.norm(x) * np.linalg.norm(y)) * shape
    data.emission = power / (area * (math.pi if compat.LIGHTS_OF_4_0 else 4.0))


def _is_of_no_shape(sheared: LightData) -> bool:
    """Whether Cycles takes a sheared lamp's points by axes that it holds for orthogonal: they then lie elsewhere for each point that is lit."""
    return sheared.shape == "rectangle" or (compat.LIGHTS_OF_4_0 and sheared.spread < math.pi - WIDE)


def _point(light: Any, power: float, data: LightData, _context: ExportContext) -> None:
    data.radius = light.shadow_soft_size
    data.facing = compat.light_has_soft_falloff(light)
    data.emission = power / (4 * math.pi)
    if data.radius > 0 and not compat.light_is_normalized(light):
        data.emission *= math.pi * data.radius**2


def _spot(light: Any, power: float, data: LightData, context: ExportContext) -> None:
    _point(light, power, data, context)
    data.angle = light.spot_size
    data.blend = light.spot_blend
    data.cosine = not compat.LIGHTS_OF_4_0
    if not compat.LIGHTS_OF_4_0:  # the cone was always a round one
        data.matrix = data.matrix.copy()
        data.matrix[:3, :3] = Vector(data.matrix[:3, 2]).to_track_quat("Z", "Y").to_matrix()


def _sun(light: Any, power: float, data: LightData, _context: ExportContext) -> None:
    data.angle = light.angle
    data.emission = power
    half = light.angle / 2
    if half > 0 and not compat.light_is_normalized(light):
        data.emission *= math.pi * math.sin(half) ** 2
    elif not compat.LIGHTS_OF_4_0:
        data.flat = half > 0
        cosine = max(0.0, math.cos(half))  # of 90 degrees it may be just below
        data.emission *= 2 * cosine / (1 + cosine)  # what a surface that faces it gets
