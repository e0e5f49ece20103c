# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world -> a constant radiance, or an equirectangular image times a factor."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import compat
from .context import ExportContext
from .emission import MISSING, constant_color, note_unsupported, source, strength, surface
from .image import deviations, missing
from .model import WorldData, not_finite


def export_world(world: Any, context: ExportContext) -> WorldData:
    if world is None:
        return WorldData()
    data = _translate(world, context)
    wrong = not_finite(data)
    if wrong is not None:
        context.note(f"world '{world.name}': its {wrong} is not a finite number; magenta is shown instead")
        return WorldData(MISSING)
    if min(data.radiance) < 0:
        context.note(f"world '{world.name}': negative light is not supported; none is used instead")
        r, g, b = (max(0.0, c) for c in data.radiance)
        data.radiance = (r, g, b)
    return data


def _translate(world: Any, context: ExportContext) -> WorldData:
    if not compat.uses_nodes(world):
        return WorldData(tuple(world.color))
    _note_settings(world, context)
    shader = surface(world, "world", context)
    if shader is None:
        return WorldData()
    node = shader.node
    if node.bl_idname != "ShaderNodeBackground":
        note_unsupported(node, world, "world", context, "the world's viewport colour is used instead")
        return WorldData(tuple(world.color))
    factor = strength(node, world, "world", context)
    origin = source(node.inputs["Color"])
    if factor == 0:
        return WorldData()
    if origin is None or origin.node.bl_idname != "ShaderNodeTexEnvironment":
        r, g, b = constant_color(node, world, "world", context)
        return WorldData((r * factor, g * factor, b * factor))
    return _environment(origin.node, factor, world, context)


def _note_settings(world: Any, context: ExportContext) -> None:
    output = world.node_tree.get_output_node("CYCLES")
    if output is not None and source(output.inputs["Volume"]) is not None:
        context.note(f"world '{world.name}': volumes are not supported; the air is clear")
    visibility = getattr(world, "cycles_visibility", None)
    if visibility is not None and not (visibility.camera and visibility.diffuse and visibility.glossy):
        context.note(f"world '{world.name}': its ray visibility is not supported; all rays see it")


def _environment(node: Any, factor: float, world: Any, context: ExportContext) -> WorldData:
    where = f"world '{world.name}': node '{node.name}'"
    if node.image is None or missing(node.image):
        reason = "" if node.image is None else f": {missing(node.image)}"
        context.note(f"{where} has no image{reason}; magenta is shown instead")
        r, g, b = MISSING
        return WorldData((r * factor, g * factor, b * factor))
    for deviation in deviations(node.image):
        context.note(f"{where}: {deviation}")
    if node.projection != "EQUIRECTANGULAR":
        context.note(
            f"{where}: the projection {node.projection.title()} is not supported; the image is read as equirectangular"
        )
    texture = context.texture(node.image, node.interpolation, "REPEAT")
    return WorldData((factor, factor, factor), texture, _rotation(node, where, context))


def _rotation(node: Any, where: str, context: ExportContext) -> np.ndarray:
    """The matrix from a direction of the world to the one that is looked up in the image."""
    origin = source(node.inputs["Vector"])
    if origin is None:
        return np.eye(3)
    matrix = np.eye(3)
    mapping = origin.node
    if mapping.bl_idname == "ShaderNodeMapping":
        matrix = _mapping_matrix(mapping, where, context)
        origin = source(mapping.inputs["Vector"])
    if origin is None or (origin.node.bl_idname, origin.name) != ("ShaderNodeTexCoord", "Generated"):
        context.note(
            f"{where}: its vector must come from Texture Coordinate (Generated), by itself or through a Mapping; it is left out"
        )
        return np.eye(3)
    return matrix


def _mapping_matrix(mapping: Any, where: str, context: ExportContext) -> np.ndarray:
    """The linear part of a Mapping node; an image of directions can be turned and mirrored, nothing else."""
    values: dict[str, Any] = {}
    for name in ("Location", "Rotation", "Scale"):
        socket = mapping.inputs.get(name)  # a Mapping of type Vector has no location
        if socket is not None and source(socket) is not None:
            context.note(f"{where}: the {name.lower()} of node '{mapping.name}' must be a constant; it is left out")
            return np.eye(3)
        values[name] = socket.default_value if socket is not None else None
    scale = np.array(values["Scale"])
    rotation = np.array(values["Rotation"].to_matrix())
    if not np.allclose(np.abs(scale), np.abs(scale[0])) or not scale.all() or any(values["Location"] or ()):
        context.note(f"{where}: only the rotation of node '{mapping.name}' is used, not its location or uneven scale")
        scale = np.ones(3)
    mirror = np.diag(np.sign(scale))
    # Texture is the inverse of Point; Vector and Normal turn as Point does
    return mirror @ rotation.T if mapping.vector_type == "TEXTURE" else rotation @ mirror
