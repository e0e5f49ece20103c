# SPDX-License-Identifier: GPL-3.0-or-later
"""The attributes of meshes and objects that programs read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import compat
from .blender_pixels import decode_srgb, encode_srgb
from .spectrum import of_bytes

GENERATED = "GENERATED"  # Generated coordinates of each point, where no map makes them
DEFAULT_COLOR = "color:"  # the name of a mesh's colours that are active for rendering
OF_OBJECT = ("object:", "instancer:", "layer:", "instance:")  # how names of attributes begin that are not the mesh's
OF_CYCLES = "cycles:"  # how those begin that Cycles makes
# what the nodes Curves Info and Point Info tell: names of attributes that no file can have by chance
STRAND, INTERCEPT, LENGTH, DIAMETER, RANDOM = (
    f"curves info:{name}" for name in ("strand", "intercept", "length", "diameter", "random")
)
CENTER, RADIUS, POINT_RANDOM = (f"point info:{name}" for name in ("position", "radius", "random"))

# how Blender calls the values of each type that Cycles reads, and how many numbers they are
TYPES = {
    "FLOAT": ("value", 1),
    "INT": ("value", 1),
    "BOOLEAN": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
}
if compat.ATTRIBUTES_ARE_BLENDERS:
    TYPES |= {"INT8": ("value", 1), "QUATERNION": ("value", 4)}


@dataclass(frozen=True)
class MeshAttribute:
    values: np.ndarray  # (n,) or (n, 2 to 4) float32
    by_corner: bool  # else by vertex


def read_attribute(mesh: Any, name: str, obj: Any = None) -> MeshAttribute | None:
    """None where the mesh has none of the name that Cycles reads. `obj`: that has the mesh; it knows the names of vertex groups."""
    if name.startswith(OF_OBJECT):
        return None
    if name.startswith(OF_CYCLES):
        return _of_cycles(mesh, name[len(OF_CYCLES) :])
    if name != DEFAULT_COLOR and name in mesh.uv_layers:
        uvs = compat.uvs(mesh, name)
        return None if uvs is None else MeshAttribute(uvs, True)
    if name == DEFAULT_COLOR:
        index = mesh.color_attributes.render_color_index
        attribute = mesh.color_attributes[index] if 0 <= index < len(mesh.color_attributes) else None
    else:
        attribute = mesh.attributes.get(name)
    if attribute is None:
        return _vertex_group(mesh, name, obj)
    if attribute.data_type not in TYPES or attribute.domain not in {"POINT", "EDGE", "FACE", "CORNER"}:
        return None
    values = compat.attribute_values(attribute, *TYPES[attribute.data_type])
    if attribute.domain == "EDGE":
        values = _at_vertices(mesh, values, attribute.data_type)
    if attribute.data_type == "BYTE_COLOR":
        values[:, :3] = of_bytes(values[:, :3], compat.CYCLES)
    if attribute.domain == "FACE":
        values = values.take(compat.corner_faces(mesh), axis=0)
    by_corner = attribute.domain in {"CORNER", "FACE"}
    return MeshAttribute(np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0), by_corner)


def _of_cycles(mesh: Any, name: str) -> MeshAttribute | None:
    if name == "N":  # smooth, however the mesh is shaded
        return MeshAttribute(compat.vertex_normals(mesh), False)
    if name == "Ng":
        return MeshAttribute(compat.face_normals(mesh).take(compat.corner_faces(mesh), axis=0), True)
    return None


def _vertex_group(mesh: Any, name: str, obj: Any) -> MeshAttribute | None:
    group = obj.vertex_groups.get(name) if obj is not None and compat.ATTRIBUTES_ARE_BLENDERS else None
    return None if group is None else MeshAttribute(compat.vertex_weights(mesh, group.index), False)


def _at_vertices(mesh: Any, values: np.ndarray, kind: str) -> np.ndarray:
    """The mean of what the edges of each vertex have, (n,) or (n, width) float32, 0 where it has none.

    Where Blender makes it, it is of the attribute's type: whether any is true, a whole number, bytes as an image has them.
    """
    is_bytes = kind == "BYTE_COLOR" and compat.ATTRIBUTES_ARE_BLENDERS
    if is_bytes:
        values = values.copy()
        values[:, :3] = encode_srgb(values[:, :3])
        values = np.rint(255 * values)
    ends, count = compat.edge_vertices(mesh), len(mesh.vertices)
    edges = np.maximum(np.bincount(ends.ravel(), minlength=count), 1)
    columns = values.reshape(len(values), -1).repeat(2, axis=0).T
    mean = np.stack([np.bincount(ends.ravel(), column, count) / edges for column in columns], axis=-1)
    if compat.ATTRIBUTES_ARE_BLENDERS:
        if kind == "BOOLEAN":
            mean = np.ceil(mean)
        elif kind in {"INT", "INT8"}:
            mean = np.trunc(mean + np.copysign(0.5, mean))
        elif is_bytes:
            mean = np.floor(mean) / 255
            mean[:, :3] = decode_srgb(mean[:, :3])
    return mean.reshape((count, *values.shape[1:])).astype(np.float32)


def texture_space(mesh: Any) -> tuple[np.ndarray, np.ndarray]:
    """The scale, (3,), and offset, (3,), that make Generated coordinates of those of an object."""
    location, size = np.array(mesh.texspace_location), np.array(mesh.texspace_size)
    scale = np.divide(0.5, size, out=size.copy(), where=size != 0)
    return scale, 0.5 - location * scale


def generated(mesh: Any, positions: np.ndarray) -> tuple[tuple[float, ...], np.ndarray | None]:
    """The map from object space to Generated coordinates, and these for each vertex where modifiers have moved them."""
    scale, offset = texture_space(mesh)
    matrix = np.column_stack([np.diag(scale), offset])
    undeformed = compat.undeformed_positions(mesh)
    size = np.array(mesh.texspace_size)
    if np.allclose(undeformed, positions, rtol=0, atol=1e-6 * max(1e-30, float(np.abs(size).max()))):
        return tuple(matrix.reshape(-1).tolist()), None
    return tuple(matrix.reshape(-1).tolist()), (undeformed * scale + offset).astype(np.float32)


NOWHERE = (0.0, 0.0, 0.0, 0.0)  # the attribute of an object that does not have it; what one has has an alpha, as a rule


def object_attributes(names: Iterable[str], owners: dict[str, Any]) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Of these names those that begin as OF_OBJECT, each with what `owners`, by how it begins, have."""
    return tuple((name, object_attribute(name, owners)) for name in sorted(names) if name.startswith(OF_OBJECT))


def object_attribute(name: str, owners: dict[str, Any]) -> tuple[float, float, float, float]:
    """A colour, as Blender makes one of a custom property, or one of their own, of the first that has one; 0 where none has."""
    prefix = next(p for p in OF_OBJECT if name.startswith(p))
    for owner in owners[prefix]:
        values = _property(owner, name[len(prefix) :])
        if values is not None:
            r, g, b = (*values * 3,)[:3] if len(values) == 1 else (*values, 0.0)[:3]
            return r, g, b, values[3] if len(values) == 4 else 1.0
    return NOWHERE


def _property(owner: Any, name: str) -> tuple[float, ...] | None:
    """Of one number or up to four."""
    try:
        value = owner[name] if name in owner else owner.path_resolve(name)
    except (AttributeError, TypeError, ValueError, KeyError):
        return None
    try:
        numbers = [float(v) for v in (value if hasattr(value, "__len__") else [value])]
    except (TypeError, ValueError):
        return None
    return tuple(numbers) if 1 <= len(numbers) <= 4 and np.isfinite(numbers).all() else None
