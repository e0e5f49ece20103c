# SPDX-License-Identifier: GPL-3.0-or-later
"""Image and environment nodes of worlds and lights -> a look-up, with the mappings of coordinates before it."""

from __future__ import annotations

from typing import Any

import numpy as np
from mathutils import Euler, Matrix

from .folding import Folding
from .image import MISSING, Picture, picture_of
from .lookup import IDENTITY, Lookup
from .mapping import axes
from .tree import NodeUse
from .value import Value, constant

UNKNOWN_LIGHT = 0.5  # of a sky or a lamp whose image cannot be shown


def image_texture(use: NodeUse, output: Any) -> Value:
    node = use.node
    found = picture(use, use.owner.kind != "material")
    if found is None:
        return _missing(use)
    use.note(f"is mapped by UVs, which a {use.owner.kind} has not; its mean is used everywhere")
    return _shown(Lookup(found, node.interpolation, node.extension, IDENTITY), output).mean()


def environment_texture(use: NodeUse, output: Any) -> Value:
    node = use.node
    found = picture(use, use.owner.kind != "material")
    if found is None:
        return _missing(use)
    turn = _directions(use) if use.owner.kind == "world" else np.eye(3)
    projection = "mirror-ball" if node.projection == "MIRROR_BALL" else "equirectangular"
    transform = tuple(turn.reshape(-1).tolist())
    value = _shown(Lookup(found, node.interpolation, "REPEAT", transform, projection=projection), output)
    if use.owner.kind == "world":
        return value
    use.note(f"is looked up by direction, which a {use.owner.kind} cannot; its mean is used everywhere")
    return value.mean()


def _shown(lookup: Lookup, output: Any) -> Value:
    if output.name == "Alpha":
        return Value(np.ones(3), (lookup,), lambda t: np.repeat(t[lookup][..., 3:], 3, axis=-1), f"alpha of {lookup}")
    return Value(np.ones(3), (lookup,))


def picture(use: NodeUse, is_light: bool) -> Picture | None:
    """None, and a note, where there is nothing to show. `is_light`: it colours light."""
    node = use.node
    instead = "grey light is" if is_light else "magenta is"
    if node.image is None:
        use.note(f"has no image; {instead} shown instead")
        return None
    found = picture_of(node.image, _shows_alpha(use), node.image_user, use.owner.context.frame)
    reason = found.missing()
    if reason is not None:
        use.note(f"needs an image; {reason}; {instead} shown instead")
        return None
    for deviation in found.deviations():
        use.note(f"shows {deviation}")
    return found


def _shows_alpha(use: NodeUse) -> bool:
    """Whether Cycles finds the node's Alpha used; of an environment it does not ask."""
    if use.node.bl_idname != "ShaderNodeTexImage" or use.node.image.alpha_mode not in {"STRAIGHT", "PREMUL"}:
        return False
    tree = (use.groups[0] if use.groups else use.node).id_data
    foldings, key = use.owner.context.foldings, (use.owner.place, tree.as_pointer())
    if key not in foldings:
        foldings[key] = Folding(use.owner, tree)
    return bool(foldings[key].shows_alpha(use))


def _missing(use: NodeUse) -> Value:
    return constant(MISSING if use.owner.kind == "material" else UNKNOWN_LIGHT)


def _directions(use: NodeUse) -> np.ndarray:
    """The matrix from a direction of the world to the one that is looked up in the image."""
    own = use.node.texture_mapping
    matrix = _linear_part(use, own.vector_type, own.translation, own.rotation, own.scale) @ axes(own).to_3x3()
    origin = use.source("Vector")
    while origin.use is not None and origin.use.node.bl_idname == "ShaderNodeMapping":
        matrix = matrix @ _linear_part(origin.use, origin.use.node.vector_type, *_mapping_inputs(origin.use))
        origin = origin.use.source("Vector")
    if origin.use is not None and (origin.use.node.bl_idname, origin.socket.name) != (
        "ShaderNodeTexCoord",
        "Generated",
    ):
        origin.use.note(
            f"gives coordinates ({origin.socket.name}) that are not supported; those of Texture Coordinate (Generated) are used instead"
        )
    return np.array(matrix)


def _linear_part(use: NodeUse, kind: str, location: Any, rotation: Any, scale: Any) -> Matrix:
    """An image of directions can be turned, mirrored and stretched, not moved, nor flattened."""
    if kind in {"POINT", "TEXTURE"} and any(location):
        use.note("moves the sky; only its rotation and scale are used")
    if not all(scale):
        use.note("flattens the sky; its scale is left out")
        scale = (1.0, 1.0, 1.0)
    turn = Euler(rotation).to_matrix()
    if kind == "TEXTURE":
        return Matrix.Diagonal([1 / s for s in scale]) @ turn.transposed()
    return turn @ Matrix.Diagonal([1 / s if kind == "NORMAL" else s for s in scale])


def _mapping_inputs(use: NodeUse) -> list[Any]:
    """Location, rotation and scale; a Mapping of type Vector or Normal has no location."""
    # late, since what an input receives may itself come from a texture
    from .converters import read

    values = []
    for name, default in (("Location", 0.0), ("Rotation", 0.0), ("Scale", 1.0)):
        used = use.has(name) and use.node.inputs[name].enabled
        value = read(use, name) if used else constant(default)
        if value.lookup is not None:
            use.note(f"needs a constant as its '{name}'; the mean of the texture is used instead")
        values.append(value.mean().factor.tolist())
    return values
