# SPDX-License-Identifier: GPL-3.0-or-later
"""Image and environment nodes -> a look-up, with the mappings of coordinates before it."""

from __future__ import annotations

from typing import Any

import numpy as np
from mathutils import Euler, Matrix, Vector

from .image import MISSING, Picture, picture_of
from .lookup import IDENTITY, Lookup
from .tree import NodeUse
from .value import Value, constant

UNKNOWN_LIGHT = 0.5  # of a sky or a lamp whose image cannot be shown


def image_texture(use: NodeUse, output: Any) -> Value:
    node = use.node
    picture = _picture(use)
    if picture is None:
        return _missing(use)
    if node.projection != "FLAT":
        use.note(f"has the projection {node.projection.title()}, which is not supported; the image is mapped by UVs")
    if use.owner.kind != "material":
        use.note(f"is mapped by UVs, which a {use.owner.kind} has not; its mean is used everywhere")
        return _shown(Lookup(picture, node.interpolation, node.extension, IDENTITY), output).mean()
    return _shown(Lookup(picture, node.interpolation, node.extension, *_coordinates(use)), output)


def environment_texture(use: NodeUse, output: Any) -> Value:
    node = use.node
    picture = _picture(use)
    if picture is None:
        return _missing(use)
    turn = _directions(use) if use.owner.kind == "world" else np.eye(3)
    projection = "mirror-ball" if node.projection == "MIRROR_BALL" else "equirectangular"
    transform = tuple(turn.reshape(-1).tolist())
    value = _shown(Lookup(picture, node.interpolation, "REPEAT", transform, projection=projection), output)
    if use.owner.kind == "world":
        return value
    use.note(f"is looked up by direction, which a {use.owner.kind} cannot; its mean is used everywhere")
    return value.mean()


def _shown(lookup: Lookup, output: Any) -> Value:
    if output.name == "Alpha":
        return Value(np.ones(3), (lookup,), lambda t: np.repeat(t[lookup][..., 3:], 3, axis=-1), f"alpha of {lookup}")
    return Value(np.ones(3), (lookup,))


def _picture(use: NodeUse) -> Picture | None:
    """None, and a note, where there is nothing to show."""
    node = use.node
    instead = "magenta is" if use.owner.kind == "material" else "grey light is"
    if node.image is None:
        use.note(f"has no image; {instead} shown instead")
        return None
    alpha = node.outputs.get("Alpha")
    picture = picture_of(node.image, alpha is not None and alpha.is_linked, node.image_user, use.owner.context.frame)
    reason = picture.missing()
    if reason is not None:
        use.note(f"needs an image; {reason}; {instead} shown instead")
        return None
    for deviation in picture.deviations():
        use.note(f"shows {deviation}")
    return picture


def _missing(use: NodeUse) -> Value:
    return constant(MISSING if use.owner.kind == "material" else UNKNOWN_LIGHT)


# ---- coordinates ---------------------------------------------------------------------------------------------------


def _coordinates(use: NodeUse) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The affine map from the mesh's UVs to those of an image, and the warp before it, as in Lookup."""
    matrices = _own_mapping(use.node.texture_mapping)
    origin = use.source("Vector")
    while origin.use is not None and origin.use.node.bl_idname == "ShaderNodeMapping":
        matrices = _joined(matrices, _affine(origin.use.node.vector_type, *_mapping_inputs(origin.use)))
        origin = origin.use.source("Vector")
    if origin.use is not None and origin.use.node.bl_idname == "ShaderNodeUVMap":
        name = origin.use.node.uv_map
        if name:
            origin.use.note(f"names the UV map '{name}'; the one that is active for rendering is used")
    elif origin.use is not None and (origin.use.node.bl_idname, origin.socket.name) != ("ShaderNodeTexCoord", "UV"):
        origin.use.note(f"gives coordinates ({origin.socket.name}) that are not supported; UVs are used instead")
    if len(matrices) > 1:
        if len(matrices) > 2:
            use.note("has several mappings of type Normal, which is not supported; the last one counts")
        return IDENTITY, tuple(float(x) for matrix in reversed(matrices[:2]) for row in matrix[:3] for x in row)
    (a, b, _, c), (d, e, _, f) = matrices[0][0], matrices[0][1]
    return (a, b, c, d, e, f), ()


def _joined(after: list[Matrix], before: list[Matrix]) -> list[Matrix]:
    """Maps one after the other, the last one first; between two of a list the vector is made a unit one."""
    return [*after[:-1], after[-1] @ before[0], *before[1:]]


def _directions(use: NodeUse) -> np.ndarray:
    """The matrix from a direction of the world to the one that is looked up in the image."""
    own = use.node.texture_mapping
    matrix = _linear_part(use, own.vector_type, own.translation, own.rotation, own.scale) @ _axes(own).to_3x3()
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


def _own_mapping(mapping: Any) -> list[Matrix]:
    """An image node's own Mapping, a panel of its own. Cycles minds neither its limits nor the node's own colours."""
    scale = Vector(mapping.scale)
    if mapping.vector_type in {"TEXTURE", "NORMAL"}:  # kept invertible, as in Cycles
        scale = Vector([s if abs(s) >= 1e-5 else np.copysign(1e-5, s) for s in scale])
    kind, turn = mapping.vector_type, mapping.rotation
    return _joined(_affine(kind, mapping.translation, turn, scale), [_axes(mapping)])


def _axes(mapping: Any) -> Matrix:
    """Which coordinate is taken for which."""
    matrix = Matrix.Diagonal((0.0, 0.0, 0.0, 1.0))
    for row, name in enumerate((mapping.mapping_x, mapping.mapping_y, mapping.mapping_z)):
        if name != "NONE":
            matrix[row]["XYZ".index(name)] = 1.0
    return matrix


def _affine(kind: str, location: Any, rotation: Any, scale: Any) -> list[Matrix]:
    """The maps of a Mapping node, as in _joined()."""
    turn = Euler(rotation).to_matrix().to_4x4()
    inverse_scale = Matrix.Diagonal([1.0 / s if s else 0.0 for s in (*scale, 1.0)])  # a scale of 0 gives 0
    if kind == "NORMAL":
        return [Matrix.Identity(4), turn @ inverse_scale]
    if kind == "TEXTURE":
        return [inverse_scale @ turn.transposed() @ Matrix.Translation(-Vector(location))]
    moved = Matrix.Translation(Vector(location)) if kind == "POINT" else Matrix.Identity(4)
    return [moved @ turn @ Matrix.Diagonal((*scale, 1.0))]
